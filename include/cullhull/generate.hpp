// Test and benchmark point sets, seeded and reproducible.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/stop_token.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

struct Shape {
  const char* name;
  const char* description;
};

/// The shapes `generate` knows, in the order a help text should list them.
const std::vector<Shape>& shapes();

/// `count` points of dimension `dimension`, row-major. The same arguments give the same bits on
/// every machine and thread count. Throws Error{invalid_argument} for an unknown shape or a
/// dimension the shape does not have, Error{cancelled} soon after `stop` is requested.
std::vector<double> generate(std::string_view shape, std::uint64_t count, std::uint32_t dimension,
                             std::uint64_t seed = 1, const stop_token& stop = {});

/// The motions that MovingPoints knows, in the order a help text should list them.
const std::vector<Shape>& motions();

/// A shape that moves, frame by frame: frame 0 is the shape itself (for the motion "teleport" in
/// another order), and point i of every frame is the same point. All frames are computed in one
/// buffer, so the memory does not depend on the number of frames.
class MovingPoints {
 public:
  /// Throws Error{invalid_argument} for an unknown shape or motion, or a dimension that either
  /// does not have.
  MovingPoints(std::string_view shape, std::string_view motion, std::uint64_t count,
               std::uint32_t dimension, std::uint64_t frames, std::uint64_t seed = 1);
  MovingPoints(MovingPoints&&) noexcept;
  MovingPoints& operator=(MovingPoints&&) noexcept;
  ~MovingPoints();

  /// Writes frame `index` < frames, row-major, to `out` (count x dimension). The same arguments
  /// give the same bits on every machine and thread count, in any order of calls. Throws
  /// Error{cancelled} soon after `stop` is requested.
  void frame(std::uint64_t index, double* out, const stop_token& stop = {}) const;

 private:
  friend const std::vector<Shape>& motions();
  static std::vector<Shape> list();
  struct [[gnu::visibility("hidden")]] Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cullhull
#pragma GCC visibility pop
