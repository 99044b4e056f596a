// Sibson's coordinates: the fractions of a new point's Voronoi cell stolen from each neighbour's
// cell.
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

namespace cullhull::internal {

/// A copy of a triangulation made by delaunay(), with its points scaled.
class NaturalTriangulation {
 public:
  NaturalTriangulation(const PointView& points, const Triangulation& t, const Run& run);

  unsigned dimension() const { return d_; }
  /// The affine dimension k.
  unsigned base() const { return k_; }
  const std::uint32_t* cell(std::uint32_t c) const {
    return cells_.data() + std::size_t{c} * (k_ + 1);
  }
  const std::uint32_t* neighbours(std::uint32_t c) const {
    return neighbours_.data() + std::size_t{c} * (k_ + 1);
  }
  /// Coordinates in the order of flat_columns(), scaled by a power of two.
  const double* row(std::uint32_t v) const { return rows_.data() + std::size_t{v} * d_; }
  /// The same, unscaled.
  void copy_plain(std::uint32_t v, double* out) const;
  /// Writes a point's coordinates as row() has them. If scaling is not exact, writes them unscaled
  /// and returns false.
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

/// Answers queries on one thread.
class NaturalWeights {
 public:
  explicit NaturalWeights(const NaturalTriangulation& t) : t_(t), query_(t.dimension()) {}

  /// Computes the natural neighbours of a point in the cell; `barycentric`: its coordinates there.
  /// See Interpolator. Requires k <= 3.
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
  bool plain_ = false;  ///< whether this query uses unscaled rows
  std::deque<std::vector<double>> plain_rows_;
  std::vector<std::uint32_t> cells_;  ///< the cells whose circumspheres contain the query
};

}  // namespace cullhull::internal
