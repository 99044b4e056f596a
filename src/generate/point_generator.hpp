// Test points in pieces.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "cullhull/stop_token.hpp"

namespace cullhull::internal {

/// The points of generate() in pieces, for sets larger than memory.
class PointGenerator {
 public:
  /// Throws Error{invalid_argument} as generate() does, and for 2^60 coordinates or more.
  PointGenerator(std::string_view shape, std::uint64_t count, std::uint32_t dimension,
                 std::uint64_t seed = 1);
  PointGenerator(PointGenerator&&) noexcept;
  PointGenerator& operator=(PointGenerator&&) noexcept;
  ~PointGenerator();

  /// Points are generated in runs of this length, by several threads.
  static constexpr std::uint64_t run_length = 4096;

  /// Writes the points [first, first + count), row-major, to `out`: the rows of generate(), in any
  /// order of calls. Throws Error{invalid_argument} if `first` is not a multiple of run_length or
  /// there are fewer points, Error{cancelled} soon after `stop` is requested.
  void rows(std::uint64_t first, std::uint64_t count, double* out,
            const stop_token& stop = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cullhull::internal
