// A coarse, quick test before the GaugeMap's own in 3D: one look-up a point instead of three.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "filter/gauge/gauge_table.hpp"

namespace cullhull::internal::inline filter {

/// Each cell of the map's faces, or each of s x s parts of it, has one level: the map drops every
/// point of that cone with |y|_inf below the level. Stored as bytes in units of the highest level /
/// 255: 6 cells^2 of them, face by face, grid axis 0 fastest.
struct GaugeLevels {
  std::uint32_t cells = 0;  ///< along an edge of a face
  float half_cells = 0;     ///< cells / 2, shrunk as the map's own is
  float middle = 0;         ///< cells / 2
  float face_stride = 0;    ///< cells^2
  std::uint32_t last = 0;   ///< number of the last cell
  float unit = 0;
  std::vector<std::uint8_t> of_cell;
};

/// Of a map of dimension 3 that is not too fine, else none. docs/exactness.md, G8, proves that the
/// map drops what the levels drop.
std::optional<GaugeLevels> make_levels(const GaugeTable& table, unsigned threads = 1);

/// The values that a map of dimension 3 interpolates, at the corners of parts x parts parts of each
/// cell of a face: (cells * parts + 1)^2 of them.
std::vector<double> values_on_face(const GaugeTable& table, unsigned face, std::uint32_t parts);

}  // namespace cullhull::internal::inline filter
