// LAS files of generated points, for the stream suite and for tests.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "cullhull/placement.hpp"
#include "parallel/byte_order.hpp"

namespace cullhull::bench {

/// A LAS 1.2 file of point format 0, three numbers per point; point i has class i % classes.
/// Without a placement the numbers are the coordinates.
inline std::string las_bytes(const std::vector<std::int32_t>& numbers,
                             const Placement& placement = {{1, 1, 1}, {0, 0, 0}, {}},
                             std::size_t classes = 1) {
  constexpr std::size_t header = 227, record = 20;
  std::string bytes(header + numbers.size() / 3 * record, '\0');
  const auto put = [&](std::size_t at, auto value) {
    value = internal::little_endian(value);
    std::memcpy(bytes.data() + at, &value, sizeof value);
  };
  bytes.replace(0, 4, "LASF");
  put(24, std::uint8_t{1});
  put(25, std::uint8_t{2});
  put(94, static_cast<std::uint16_t>(header));
  put(96, static_cast<std::uint32_t>(header));
  put(105, static_cast<std::uint16_t>(record));
  put(107, static_cast<std::uint32_t>(numbers.size() / 3));
  for (std::size_t j = 0; j < placement.scale.size(); ++j) {
    put(131 + 8 * j, placement.scale[j]);
    put(155 + 8 * j, placement.offset[j]);
  }
  for (std::size_t i = 0; i < numbers.size(); ++i)
    put(header + i / 3 * record + i % 3 * 4, numbers[i]);
  for (std::size_t i = 0; i < numbers.size() / 3; ++i)
    put(header + i * record + 15, static_cast<std::uint8_t>(i % classes | 0x40));
  return bytes;
}

}  // namespace cullhull::bench
