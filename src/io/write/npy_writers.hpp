// NumPy arrays that are written piece by piece.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "cullhull/point_view.hpp"

namespace cullhull::internal {

/// Writes an array (count, dimension) in pieces; the file appears once the last point is written.
/// Throws as the other writers do.
class NpyPointsWriter {
 public:
  NpyPointsWriter(const std::string& path, std::uint64_t count, std::uint32_t dimension,
                  ScalarType type);
  ~NpyPointsWriter();
  /// Writes the next points: count x dimension doubles.
  void write(const double* coordinates, std::uint64_t count);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes an array (frames, count, dimension) frame by frame; the file appears once the last frame
/// is written. Throws as the other writers do.
class NpySequenceWriter {
 public:
  NpySequenceWriter(const std::string& path, std::uint64_t frames, std::uint64_t count,
                    std::uint32_t dimension, ScalarType type);
  ~NpySequenceWriter();
  /// Writes the next frame: count x dimension doubles.
  void write(const double* coordinates);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cullhull::internal
