// The unclipped cells of a diagram, from its ridges and vertices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "diagrams/dual.hpp"
#include "diagrams/voronoi/clip_corners.hpp"

namespace cullhull::internal {

/// The vertices and ridges of a diagram, for each site.
class DiagramCells {
 public:
  /// `known`: the diagram if the caller has it, else null. Throws Error{invalid_argument} if it
  /// cannot be the diagram of `t`.
  DiagramCells(const DualPoints& points, const Triangulation& t, const Voronoi* known,
               const Run& run);

  struct Item {
    std::uint32_t other, ridge;
  };
  /// The ridges of a site's cell and the sites across them, ascending.
  std::span<const Item> of(std::uint32_t site) const { return ridges_[site]; }
  std::span<const std::uint32_t> ridge(std::uint32_t r) const { return diagram_.ridge(r); }
  const double* vertex(std::uint32_t v) const {
    return diagram_.vertices.data() + std::uint64_t{v} * t_.dimension;
  }
  bool is_site(std::uint32_t i) const { return is_site_[i]; }
  /// Any site; requires that the triangulation has cells.
  std::uint32_t some_site() const { return t_.cells[0]; }

  const DualPoints& points() const { return points_; }
  const Triangulation& triangulation() const { return t_; }
  /// A cell of the triangulation whose circumcentre is vertex v.
  std::span<const std::uint32_t> dual_cell(std::uint32_t v) const {
    return t_.cell(first_.empty() ? v : first_[v]);
  }

 private:
  const DualPoints& points_;
  const Triangulation& t_;
  Voronoi own_;
  const Voronoi& diagram_;  ///< the known diagram, or own_
  Array<std::uint32_t> first_;
  Adjacency<Item> ridges_;
  std::vector<bool> is_site_;
};

/// A bounded, unclipped cell.
template <unsigned D>
class WholeCell {
 public:
  /// Sets the cell of a site. False if it is unbounded, if the sites are in a flat, or for
  /// furthest-site diagrams.
  bool start(const DiagramCells& cells, std::uint32_t site);

  /// As in ClipShape: 1D both ends, 2D counterclockwise; 3D: `items` has for each face indices into
  /// `vertices`.
  std::vector<std::uint32_t> vertices;  ///< vertices of the diagram
  std::vector<std::uint32_t> across;    ///< the site across each face, edge or end
  std::vector<std::uint32_t> starts, items;

  /// The vertices relative to the site. Real: BoundedDouble, BoundedDoubleDouble or rationals.
  template <class Real>
  void place(const DiagramCells& cells, std::uint32_t site,
             std::vector<std::array<Real, D>>& at) const;
};

}  // namespace cullhull::internal
