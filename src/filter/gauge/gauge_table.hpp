// The data that the GaugeMap's kernels read: the node values and the constants of the map.
//
// The threshold 1 - delta, delta = (d + 6) 2^-23. A computed value is at least the true one times
// (1 - w)^(d + 2): each weight is one rounded difference of non-negative numbers, each term one
// product, then d - 1 sums and the product with a. So a computed value below 1 - delta proves a
// true one below 1 - (d + 5) w. Example, 3D: the threshold is 0.9999989.
//
// The counts of docs/exactness.md, G4 and G6. The place stays on the face. |y~_k fl(1/a)| <= 1 + 2
// w + w^2; times h <= (m/2)(1 - 2^-20)(1 + w), rounded: at most (m/2)(1 - 2^-20 + 2^-22). So the
// sum lies in [m 2^-21 (3/4), m - m 2^-21 (3/4)] before and, as f32 numbers up to m are at most
// 2^-23 m apart there, strictly inside (0, m) after rounding: 0 <= i_k <= m - 1 without any clamp.
// Node numbers are sums of integers below 2^23, exact in f32.
//
// Special values. Absolute values are compared as integers, where finite < inf < NaN; so a is NaN
// or inf if any coordinate is, a Sum lambda G is NaN or inf (or NaN from inf * 0), and the
// comparison "< 1 - delta" fails: such points survive. Node numbers are bounded as unsigned
// integers, so that even then every look-up is in the table. Doubles beyond f32's range become inf
// or the largest float; since |q| <= 1 (16 where sigma is clamped to 2^+-1020), every G > 1/17 and
// any a >= 32 survives, however its reciprocal was rounded. For a < 2^-100 the divisor is 2^-100
// instead: |y - a z|_1 <= 2 d 2^-100, again within delta; y = 0 is inside.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "cullhull/point_view.hpp"

namespace cullhull::internal {

/// A map in scaled coordinates y_j = (x_j - centre_j) * scale_j, where scale_j is a power of two
/// and the polytope is within |y_j| <= 1. Face 2 * axis + (1 if negative) of the cube |y| = 1 has
/// (cells + 1)^(d - 1) nodes; the other axes, ascending, are its grid axes, the first one fastest.
/// docs/exactness.md, "GaugeMap", proves every constant.
struct GaugeTable {
  static constexpr unsigned max_dimension = 6;

  unsigned dimension = 0;
  unsigned cells = 0;
  /// Upper bounds of the gauge at the nodes, rounding allowance included.
  std::vector<float> nodes;
  double scale[max_dimension] = {};
  double offset[max_dimension] = {};  ///< centre_j * scale_j, exact
  /// Whether the same constants are exact in f32, so that f32 input needs no double.
  bool single_precision = false;
  float scale_f32[max_dimension] = {};
  float offset_f32[max_dimension] = {};

  float half_cells = 0;                  ///< cells / 2, shrunk by a few ulps
  float middle = 0;                      ///< cells / 2
  float stride[max_dimension - 1] = {};  ///< nodes from one grid line to the next, per grid axis
  float face_stride = 0;                 ///< nodes per face
  std::uint32_t last_corner = 0;         ///< no cell has its lowest corner beyond this node
  float threshold = 0;                   ///< 1 - delta
};

struct GaugeCore;

/// The most points of one call of the kernel; the ids it writes are relative to `begin`.
inline constexpr std::uint32_t gauge_chunk = 16384;

/// Writes begin-relative ids of the points of [begin, end) that are not provably inside, ascending,
/// to `ids` (room for all) and returns their number. `core`, made from this table, speeds up the
/// test where few points survive and does not change the ids.
std::size_t gauge_survivors(const GaugeTable& table, const PointView& points, std::uint64_t begin,
                            std::uint64_t end, std::uint32_t* ids, const GaugeCore* core = nullptr);

/// `bounds` and `corners` need room for 16 more.
inline constexpr std::uint32_t gauge_room = 16;

/// Writes what the test compares with the threshold for `count` packed rows: upper bounds of their
/// gauges, up to rounding; NaN or infinite for points that are not finite.
void gauge_bounds(const GaugeTable& table, const double* rows, std::uint32_t count, float* bounds);

/// Writes the lowest corner's node of the cell of each row's direction; any node for rows that are
/// not finite. Reads no node.
void gauge_corners(const GaugeTable& table, const double* rows, std::uint32_t count,
                   std::uint32_t* corners);

}  // namespace cullhull::internal
