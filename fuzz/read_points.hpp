// What every reader must keep to, whatever the bytes.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "cullhull/error.hpp"
#include "io/source.hpp"

namespace cullhull::fuzz {

/// Refusals are Error{bad_file} with one printable line, or Error{invalid_argument} where columns
/// are asked for that are not there; anything else ends the fuzzer.
inline void check_refusal(const Error& error, bool columns = false) {
  if (error.code() != ErrorCode::bad_file &&
      !(columns && error.code() == ErrorCode::invalid_argument))
    std::abort();
  for (const char* c = error.what(); *c != 0; ++c)
    if (*c < ' ' || *c > '~') std::abort();
}

/// Reads `data` and then every coordinate. The bytes are copied, so that the sanitizer sees the
/// smallest step beyond their end.
inline void read_all(const std::uint8_t* data, std::size_t size, ReadOptions options) {
  const std::vector<char> bytes(data, data + size);
  options.threads = 1;
  unsigned remarks = 0;
  options.remark = [&](const std::string& line) {  // at most one, printable
    if (++remarks > 1) std::abort();
    for (const char c : line)
      if (c < ' ' || c > '~') std::abort();
  };
  try {
    const internal::PointData points =
        internal::read_points({"input", bytes.data(), bytes.size()}, options);
    const PointView& view = points.view;
    if (view.dimension == 0) std::abort();
    // No reader may conjure points: each coordinate takes a bit of the file at least.
    if (view.count > 0 && view.dimension > size) std::abort();
    volatile double sink = 0;
    for (std::uint64_t i = 0; i < view.count; ++i)
      for (std::uint32_t j = 0; j < view.dimension; ++j) sink = view.at(i, j);
    (void)sink;
  } catch (const Error& error) {
    check_refusal(error, !options.columns.empty());
  }
}

}  // namespace cullhull::fuzz
