// The data that the GaugeMap's kernels read: the node values and the constants of the map.
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

}  // namespace cullhull::internal
