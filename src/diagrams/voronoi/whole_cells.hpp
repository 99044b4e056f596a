// The unclipped cells of a diagram, from its ridges and vertices.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "cullhull/error.hpp"
#include "diagrams/dual.hpp"
#include "exact/planes/halfspace.hpp"

namespace cullhull::internal {

/// Throws Error{invalid_argument} if the diagram cannot be that of `t`: checks sizes and indices,
/// so that a wrong diagram cannot cause out-of-range reads. `vertices`: how many it should have.
inline void require_diagram_of(const Triangulation& t, std::uint64_t vertices,
                               const Voronoi& diagram) {
  const auto below = [](const Array<std::uint32_t>& list, std::uint64_t end) {
    return std::all_of(list.begin(), list.end(),
                       [&](std::uint32_t v) { return v < end || v == at_infinity; });
  };
  const auto& offsets = diagram.ridges.offsets;
  if (diagram.dimension != t.dimension || diagram.point_count != t.point_count ||
      diagram.affine_dimension != t.affine_dimension || diagram.furthest_site != t.furthest_site ||
      diagram.vertex_count() != vertices || offsets.size() != diagram.ridge_count() + 1 ||
      offsets.front() != 0 || offsets.back() != diagram.ridges.items.size() ||
      !std::is_sorted(offsets.begin(), offsets.end()) || !below(diagram.ridges.items, vertices) ||
      std::any_of(diagram.ridge_points.begin(), diagram.ridge_points.end(),
                  [&](std::uint32_t p) { return p >= t.point_count; }))
    throw Error(ErrorCode::invalid_argument, "the diagram is not that of the triangulation");
}

/// The vertices and ridges of a diagram, for each site.
class DiagramCells {
 public:
  /// `known`: the diagram if the caller has it, else null. Throws Error{invalid_argument} if it
  /// cannot be the diagram of `t`.
  DiagramCells(const DualPoints& points, const Triangulation& t, const Voronoi* known,
               const Run& run)
      : points_(points),
        t_(t),
        diagram_(known != nullptr ? *known : own_),
        first_(first_cells(t)),
        is_site_(t.point_count, false) {
    for (const std::uint32_t v : t.cells) is_site_[v] = true;
    if (known != nullptr) {
      const std::uint64_t groups = first_.empty() ? t.size() : first_.size();
      require_diagram_of(t, t.corners() < 2 ? 0 : groups, *known);
    }
    if (known == nullptr && t.corners() > 1) {
      own_.dimension = t.dimension;
      write_vertices(points, t, own_, run);
      write_ridges(points, t, t.corners() == 3 ? Adjacency<std::uint32_t>() : stars_of(t, run),
                   own_, run);
    }
    ridges_ = Adjacency<Item>(t.point_count, [&](const auto& add) {
      if (t.corners() < 2) return;
      // The pairs are sorted, so the sites across ascend: first the lower ones, then the higher.
      for (const unsigned end : {1U, 0U})
        for (std::uint32_t r = 0; r < diagram_.ridge_count(); ++r) {
          const std::uint32_t* pair = diagram_.ridge_points.data() + 2 * std::uint64_t{r};
          add(pair[end], Item{pair[1 - end], r});
        }
    });
  }

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
  /// furthest-site diagrams, whose ridges have the opposite orientation.
  bool start(const DiagramCells& cells, std::uint32_t site) {
    const auto around = cells.of(site);
    const Triangulation& t = cells.triangulation();
    if (t.corners() != D + 1 || t.furthest_site || around.size() < D + 1) return false;
    if (D == 1 && around.size() > 2) return false;
    for (const auto& item : around) {
      const auto ridge = cells.ridge(item.ridge);
      if (std::find(ridge.begin(), ridge.end(), at_infinity) != ridge.end()) return false;
    }
    vertices.clear();
    across.clear();
    if constexpr (D == 1) {
      set_ends(cells, site);
      return true;
    } else if constexpr (D == 2) {
      return set_polygon(cells, site);
    } else {
      set_faces(cells, site);
      return true;
    }
  }

  /// As in ClipShape: 1D both ends, 2D counterclockwise; 3D: `items` has for each face indices into
  /// `vertices`.
  std::vector<std::uint32_t> vertices;  ///< vertices of the diagram
  std::vector<std::uint32_t> across;    ///< the site across each face, edge or end
  std::vector<std::uint32_t> starts, items;

  /// The vertices relative to the site. Real: BoundedDouble, BoundedDoubleDouble or rationals. If
  /// a vertex's dual cell contains the site, the vertex is the intersection of the site's bisectors
  /// with the other corners. Otherwise it is computed relative to the cell's first corner, and the
  /// difference of that corner and the site is added.
  template <class Real>
  void place(const DiagramCells& cells, std::uint32_t site,
             std::vector<std::array<Real, D>>& at) const {
    const DualPoints& points = cells.points();
    at.resize(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const auto cell = cells.dual_cell(vertices[i]);
      const bool has_site = std::find(cell.begin(), cell.end(), site) != cell.end();
      const std::uint32_t from = has_site ? site : cell[0];
      Halfspace<D, Real> planes[D];
      std::array<const Halfspace<D, Real>*, D> meet{};
      unsigned n = 0;
      for (const std::uint32_t other : cell)
        if (other != from) {
          planes[n] = bisector<D, Real>(points.row(from), points.row(other), points.weighted());
          meet[n] = &planes[n];
          ++n;
        }
      at[i] = meeting<Real>(meet);
      for (unsigned j = 0; j < D && from != site; ++j)
        at[i][j] = at[i][j] + exact_difference<Real>(points.row(from)[j], points.row(site)[j]);
    }
  }

 private:
  /// The lower end comes first; it is towards the site of smaller coordinate.
  void set_ends(const DiagramCells& cells, std::uint32_t site) {
    const auto around = cells.of(site);
    const bool in_order =
        cells.points().row(around[0].other)[0] < cells.points().row(around[1].other)[0];
    for (const unsigned i : {in_order ? 0U : 1U, in_order ? 1U : 0U}) {
      vertices.push_back(cells.ridge(around[i].ridge)[0]);
      across.push_back(around[i].other);
    }
  }
  /// A ridge lists its left vertex first, seen from the lower site towards the other.
  /// Counterclockwise around the lower site, the right vertex comes before the left one. False if
  /// the ridges do not fit together.
  bool set_polygon(const DiagramCells& cells, std::uint32_t site) {
    const auto around = cells.of(site);
    const auto ends = [&](const DiagramCells::Item& item) {
      const auto ridge = cells.ridge(item.ridge);
      return site < item.other ? std::pair(ridge[1], ridge[0]) : std::pair(ridge[0], ridge[1]);
    };
    for (std::uint32_t at = ends(around[0]).first; vertices.size() < around.size();) {
      const auto item = std::find_if(around.begin(), around.end(),
                                     [&](const auto& i) { return ends(i).first == at; });
      if (item == around.end()) return false;
      vertices.push_back(at);
      across.push_back(item->other);
      at = ends(*item).second;
    }
    return true;
  }
  /// A ridge's vertices are counterclockwise about the direction from the lower site (right-hand
  /// rule), so for the lower site counterclockwise from outside.
  void set_faces(const DiagramCells& cells, std::uint32_t site) {
    items.clear();
    starts.assign(1, 0);
    for (const auto& item : cells.of(site)) {
      const auto ridge = cells.ridge(item.ridge);
      items.insert(items.end(), ridge.begin(), ridge.end());
      if (site > item.other)
        std::reverse(items.begin() + static_cast<std::ptrdiff_t>(starts.back()), items.end());
      starts.push_back(static_cast<std::uint32_t>(items.size()));
      across.push_back(item.other);
    }
    vertices = items;
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (std::uint32_t& v : items)
      v = static_cast<std::uint32_t>(std::lower_bound(vertices.begin(), vertices.end(), v) -
                                     vertices.begin());
  }
};

}  // namespace cullhull::internal
