// Bytes to coordinates that are hard for a hull code.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace cullhull::fuzz {

constexpr unsigned kinds = 4;

inline std::vector<double> coordinates_of(const std::uint8_t* data, std::size_t size,
                                          unsigned kind) {
  std::vector<double> out;
  if (kind == 0) {  // a small grid: coplanar groups and duplicates
    for (std::size_t i = 0; i < size; ++i) out.push_back(data[i] % 5);
  } else if (kind == 1) {  // signed bytes, perhaps far from the origin
    for (std::size_t i = 0; i < size; ++i)
      out.push_back(0x1p40 + static_cast<std::int8_t>(data[i]));
  } else if (kind == 2) {  // a grid with one-ulp disturbances
    for (std::size_t i = 0; i < size; ++i) {
      double v = data[i] & 7;
      if (data[i] & 8) v = std::nextafter(v, data[i] & 16 ? 1e9 : -1e9);
      out.push_back(v);
    }
  } else {  // any doubles
    for (std::size_t i = 0; i + 8 <= size; i += 8) {
      double v;
      std::memcpy(&v, data + i, 8);
      out.push_back(std::isfinite(v) ? v : 0.0);
    }
  }
  return out;
}

[[noreturn]] inline void fail(const char* what, const std::string& detail) {
  std::fprintf(stderr, "%s: %s\n", what, detail.c_str());
  std::abort();
}

}  // namespace cullhull::fuzz
