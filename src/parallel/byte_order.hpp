// Conversion of numbers between this machine's byte order and the little-endian order of files.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace cullhull::internal {

inline constexpr bool little_endian_machine = std::endian::native == std::endian::little;
static_assert(little_endian_machine || std::endian::native == std::endian::big);

/// v with the order of its bytes reversed.
template <class T>
T reverse_bytes(T v) {
  static_assert(std::is_arithmetic_v<T>);
  auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(v);
  std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

/// Converts between a number of this machine and its little-endian representation, either way.
template <class T>
T little_endian(T v) {
  if constexpr (little_endian_machine) return v;
  return reverse_bytes(v);
}

/// Reads the number whose little-endian bytes begin at `from`, which need not be aligned.
template <class T>
T load_little_endian(const void* from) {
  T v;
  std::memcpy(&v, from, sizeof v);
  return little_endian(v);
}

/// Converts an array between native and little-endian order, in place and in either direction. The
/// array takes `bytes` bytes; each item takes `size` bytes.
inline void little_endian_items(void* items, std::size_t bytes, std::size_t size) {
  if constexpr (little_endian_machine) return;
  auto* const p = static_cast<std::byte*>(items);
  for (std::size_t i = 0; i < bytes && size > 1; i += size) std::reverse(p + i, p + i + size);
}

}  // namespace cullhull::internal
