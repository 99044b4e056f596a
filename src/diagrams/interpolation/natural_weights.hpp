// Sibson's coordinates: the shares that a new point's Voronoi cell takes from its neighbours.
#pragma once

#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/interpolate.hpp"
#include "cullhull/triangulation.hpp"
#include "exact/points/local_points.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline diagrams {

/// A triangulation made by delaunay(), kept for the question.
class NaturalTriangulation {
 public:
  NaturalTriangulation(const PointView& points, const Triangulation& t, const Run& run);

  unsigned dimension() const { return d_; }
  /// k.
  unsigned base() const { return k_; }
  const std::uint32_t* cell(std::uint32_t c) const {
    return cells_.data() + std::size_t{c} * (k_ + 1);
  }
  const std::uint32_t* neighbours(std::uint32_t c) const {
    return neighbours_.data() + std::size_t{c} * (k_ + 1);
  }
  /// Coordinates, the k axes first; scaled by a power of two.
  const double* row(std::uint32_t v) const { return rows_.data() + std::size_t{v} * d_; }
  /// Without the scale.
  void copy_plain(std::uint32_t v, double* out) const;
  /// A point's coordinates as rows have them; false, and without the scale, if that is not exact.
  bool scaled(const double* point, double* out) const;
  const LiftedPoints& frame() const { return frame_; }

 private:
  unsigned d_, k_;
  int exponent_ = 0;
  std::vector<std::uint32_t> columns_;
  Array<std::uint32_t> cells_, neighbours_;
  Array<double> rows_;
  LiftedPoints frame_;  ///< for predicates; without rows
};

/// A thread's questions.
class NaturalWeights {
 public:
  explicit NaturalWeights(const NaturalTriangulation& t) : t_(t), query_(t.dimension()) {}

  /// Of a point in the cell, with its barycentric coordinates there. See Interpolator. k <= 3.
  void find(const double* point, std::uint32_t cell, const double* barycentric,
            NaturalNeighbours& out);

 private:
  struct HullFacet {
    std::uint32_t cell;
    unsigned slot;  ///< the corner it is opposite to
  };
  const double* row(std::uint32_t v);
  std::vector<const double*> rows_of(std::uint32_t cell);
  bool in_sphere(std::uint32_t cell);
  void find_cavity(std::uint32_t cell);
  std::vector<HullFacet> hull_facets_at_query();
  template <unsigned K>
  void share_cavity(NaturalNeighbours& out);
  bool share_face(const std::vector<HullFacet>& facets, NaturalNeighbours& out);

  const NaturalTriangulation& t_;
  std::vector<double> query_;
  bool plain_ = false;  ///< rows without the scale
  std::deque<std::vector<double>> plain_rows_;
  std::vector<std::uint32_t> cells_;  ///< in whose spheres the query is
};

}  // namespace cullhull::internal::inline diagrams
