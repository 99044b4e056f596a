// NumPy arrays of moving points, written frame by frame.
#pragma once

#include <cstdint>
#include <string>

#include "cullhull/point_view.hpp"
#include "io/write/output_file.hpp"

namespace cullhull::internal {

/// Writes an array (frames, count, dimension) frame by frame; the file appears once the last frame
/// is written. Throws as the other writers do.
class NpySequenceWriter {
 public:
  NpySequenceWriter(const std::string& path, std::uint64_t frames, std::uint64_t count,
                    std::uint32_t dimension, ScalarType type);
  /// Writes the next frame: count x dimension doubles.
  void write(const double* coordinates);

 private:
  OutputFile out_;
  std::uint64_t frames_, values_;  ///< frames that are missing, numbers of each
  ScalarType type_;
};

}  // namespace cullhull::internal
