// Finds the facet through which the ray from the centre to a point leaves, and the point's side of
// it, for single points and, by cells of directions, for many; and the plane with the largest value
// at a point.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "cullhull/hull_fwd.hpp"
#include "cullhull/query.hpp"
#include "geometry/facet_cells.hpp"
#include "parallel/index.hpp"
#include "parallel/threads/parallel.hpp"
#include "query/direction_cube.hpp"

namespace cullhull::internal {

struct Run;
/// The hull's vertices, and their projections to k axes, which map its flat one to one.
struct QueryPoints {
  unsigned dimension = 0, k = 0;
  std::vector<unsigned> axes;
  std::vector<std::uint64_t> ids;  // ascending
  bool plain = false;              // ids are 0, 1, 2, ...
  std::vector<double> full;        // vertices x dimension, exact
  std::vector<double> on_axes;     // vertices x k, exact
  std::vector<double> low, high;   // of every axis of `full`
  /// k + 1 vertices that span the flat of a flat hull (k < dimension).
  std::vector<std::uint32_t> basis;
  std::vector<std::uint32_t> corners;  // of the simplices, by index; for construction only

  std::size_t count() const { return ids.size(); }
  const double* row(std::uint32_t v) const { return on_axes.data() + std::size_t{v} * k; }
  std::uint32_t index_of(std::uint64_t id) const {
    if (plain) return static_cast<std::uint32_t>(id);
    return static_cast<std::uint32_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
  }
};

/// `points`: those of the hull, or nullptr: the coordinates that the hull carries.
QueryPoints make_query_points(const PointView* points, const Hull& hull, const Control& control);

/// Facets as linear functions that are 1 on the facet and less than 1 beneath it, relative to a
/// centre inside, and the graph of neighbours to climb on. k >= 2.
///
/// value(f, x) = N . x / N . (v0 - c) for x = q - c, where N is the cofactor normal; q is outside
/// exactly if the largest value exceeds 1. The value is a linear objective on the vertices of the
/// dual polytope, whose vertices above any level are connected. So all facets that may have the
/// largest value, given their error bounds, are reached from some facet through such facets alone.
class FacetSearch {
 public:
  static constexpr double least_denominator = 0x1p-900, value_tiny = FacetCellFrame::value_tiny;

  FacetSearch(const QueryPoints& points, const Hull& hull, const Control& control);

  /// `q`: k coordinates on the axes, within the box of the vertices.
  Side side(const double* q) const;
  /// All facets that q is strictly above, ascending. `q`: k coordinates on the axes, anywhere.
  std::vector<std::uint32_t> visible(const double* q) const;
  /// True for k > 8 and where doubles found no centre inside: every facet is tested exactly, and
  /// values are undefined.
  bool exhaustive() const { return exhaustive_; }

  std::size_t count() const { return neighbour_start_.size() - 1; }
  unsigned k() const { return k_; }
  /// Scales q and subtracts the centre. False where that overflows.
  bool localise(const double* q, double* x) const;
  void localise_direction(const double* direction, double* x) const;
  /// The value of facet f's function at a localised point.
  template <unsigned K>
  double value(std::uint32_t f, const double* x) const;
  /// The error bound of a value computed at x, max|x| = reach.
  static double value_error(double factor, double reach, double value) {
    return factor * (reach + std::fabs(value)) + value_tiny;
  }
  double error_factor(std::uint32_t f) const { return planes_[f * stride() + k_]; }
  std::span<const std::uint32_t> neighbours(std::uint32_t f) const {
    return {neighbours_.data() + neighbour_start_[f], neighbours_.data() + neighbour_start_[f + 1]};
  }
  const double* normal(std::uint32_t f) const { return planes_.data() + f * stride(); }
  /// localise() is q[j] * factor[j] - centre[j].
  void copy_frame(double* factor, double* centre) const {
    std::copy(factor_.begin(), factor_.end(), factor);
    std::copy(centre_.begin(), centre_.end(), centre);
  }
  /// A facet to start climbing from.
  std::uint32_t start(const double* x) const;
  /// The facet of largest value at x, up to rounding, from `start`, by steepest ascent.
  std::uint32_t climb(std::uint32_t start, const double* x) const;

 private:
  struct Doubt {
    std::vector<std::uint32_t> facets;  // those not certainly above the point
    std::uint32_t certain = no_index;   // one that is certainly below it
  };

  std::size_t stride() const { return std::size_t{k_} + 1; }
  void scale_points();
  void choose_simplices(const Hull& hull, const Control& control);
  void set_plane(std::uint32_t f, const std::uint32_t* corners);
  bool centre_inside() const;
  void fill_hints(const Control& control);
  template <unsigned K>
  std::uint32_t climb_as(std::uint32_t f, const double* x) const;
  template <unsigned K>
  bool explore(const double* x, Doubt& doubt) const;
  Side exact_side(std::uint32_t f, const double* q) const;
  Side side_of_all(const double* q) const;
  bool gather_doubt(const double* q, Doubt& doubt) const;

  const QueryPoints* points_;
  unsigned k_;
  bool exhaustive_ = false;
  bool scaled_exactly_ = true;
  std::vector<double> factor_, centre_;
  std::vector<double> scaled_;          // vertices x k, in [-1, 1]
  std::vector<std::uint32_t> corners_;  // facets x k: the simplex the plane was taken from
  std::vector<double> planes_;          // facets x (k normal, error factor)
  std::vector<std::uint32_t> neighbour_start_, neighbours_;
  DirectionCube cube_;
  std::vector<std::uint32_t> hints_;  // by cell: a facet near it
};

template <unsigned K>
inline double FacetSearch::value(std::uint32_t f, const double* x) const {
  const unsigned k = K ? K : k_;
  const double* n = planes_.data() + std::size_t{f} * (k + 1);
  double sum = n[0] * x[0];
  for (unsigned j = 1; j < k; ++j) sum += n[j] * x[j];
  return sum;
}

// The plane with the largest value at a point: for distances from inside.

/// Planes n . x + o in a tree of bounding boxes of their coefficients; a box bounds the value from
/// above. Finding the nearest facet from inside is not a linear program (its cells are those of the
/// medial axis), so the tree is searched by branch and bound.
class PlaneTree {
 public:
  /// `planes`: count x (d + 1), as in Hull::facet_planes; copied.
  PlaneTree(const std::vector<double>& planes, unsigned d, const Control& control);

  /// Index of a plane with the largest value at x, and the value. `start`: a plane to begin with.
  std::uint32_t largest(const double* x, std::uint32_t start, double& value) const;

 private:
  static constexpr std::uint32_t leaf = 8;  // planes: fewer nodes against more tests; untested
  struct Node {
    std::uint32_t begin, end, right;  // right child, 0 for a leaf; the left child is the next node
  };
  std::uint32_t grow(std::uint32_t begin, std::uint32_t end, const Control& control);
  double plane_value(std::uint32_t i, const double* x) const;
  double bound(std::uint32_t node, const double* x) const;
  void search(std::uint32_t node, const double* x, std::uint32_t& best, double& value) const;

  unsigned d_;
  std::vector<double> planes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
  std::vector<double> boxes_;  // nodes x 2 x (d + 1): low, high
};

// For each cell of directions, the facets through which a ray in it may leave: in batches, points
// are tested against these few facets instead of climbing.

class FacetCells {
 public:
  /// Points of one call of sides().
  static constexpr std::uint32_t block = 256;

  /// Null where it would gain nothing: k above 4, or no centre inside (exhaustive()).
  static std::unique_ptr<FacetCells> build(const FacetSearch& search, const QueryPoints& points,
                                           const Run& run);
  /// The least number of points for which the cells save more time than building them takes: four
  /// per cell.
  static std::uint64_t worthwhile(const FacetSearch& search);
  /// The number of cells that build() makes; 0 where it returns null.
  static std::uint64_t count(const FacetSearch& search);

  /// For `count` <= block points, coordinate j of point i at columns[j * block + i]: -1 for
  /// certainly inside, 1 for certainly outside, 0 for undecided. False if some coordinate is not
  /// finite. Overwrites the columns from `count` to `block`.
  bool sides(double* columns, std::uint32_t count, std::int8_t* out) const;

  const FacetCellTable& table() const { return table_; }

 private:
  FacetCells() = default;
  FacetCellTable table_;
};

}  // namespace cullhull::internal
