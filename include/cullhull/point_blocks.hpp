// Points of any number of files as one sequence of blocks: no more than a few blocks are in memory.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/io.hpp"
#include "cullhull/options.hpp"
#include "cullhull/stream.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// The position of a reading: all blocks before it have been visited.
struct BlockPosition {
  std::uint64_t file = 0;    ///< inputs that are done
  std::uint64_t points = 0;  ///< of all inputs
  /// Within the next input, as far as it was read: points, and for text bytes and lines.
  std::uint64_t file_points = 0, file_bytes = 0, file_lines = 0;
  std::uint64_t bytes = 0;        ///< of all inputs, for progress
  std::uint64_t input_bytes = 0;  ///< of those in the input that comes next

  friend bool operator==(const BlockPosition&, const BlockPosition&) = default;
};

/// What ReadOptions::key holds for each point of a block, one after the other.
struct PointKeys {
  std::string text;
  std::vector<std::uint64_t> ends;  ///< of each in `text`

  std::size_t size() const noexcept { return ends.size(); }
  std::string_view operator[](std::size_t i) const {
    const std::uint64_t begin = i > 0 ? ends[i - 1] : 0;
    return std::string_view(text).substr(begin, ends[i] - begin);
  }
  void add(std::string_view key) {
    text += key;
    ends.push_back(text.size());
  }
};

/// What to do with the blocks. Where a function throws, reading ends and the error of the lowest
/// block passes through; not_finite then names the file, too.
struct BlockVisitor {
  /// A block: its first point is the point `first_id` of all inputs. Called from several threads at
  /// once. The view is valid during the call.
  std::function<void(const PointView& block, std::uint64_t first_id)> points;
  /// Called instead of `points` where ReadOptions::key names a column.
  std::function<void(const PointView& block, std::uint64_t first_id, const PointKeys& keys)> keyed;
  /// An input that is a hull state (.hullstate), which stands for the points from first_id on.
  /// Without this function such an input is refused. From several threads at once.
  std::function<void(const HullState& state, std::uint64_t first_id)> state;
  /// Called by the calling thread of visit_blocks while no block is being visited: every
  /// `pause_seconds`, and when reading was cancelled.
  std::function<void(const BlockPosition&)> pause;
  double pause_seconds = 60;
};

/// What was read.
struct BlockSummary {
  BlockPosition end;
  std::uint64_t blocks = 0;
  std::uint32_t dimension = 0;  ///< 0: no block
  /// Of the first input that had points; f64 if others had another one.
  ScalarType scalar = ScalarType::f64;
  std::string format;       ///< of the first input
  Placement placement;      ///< of the first input's numbers
  Grid grid;                ///< of all inputs, as PointFile::grid()
  bool any_placed = false;  ///< whether one has a placement
};

struct BlockOptions {
  ReadOptions read;
  /// Threads that read and visit; 0: one more than the processors, so that one may wait for a disk.
  unsigned readers = 0;
  std::uint64_t block_bytes = std::uint64_t{2} << 20;  ///< about, of the file
  BlockPosition from;                                  ///< where to go on
  Progress progress;                                   ///< "read" and the share of the bytes
  Poll poll;
};

/// The files that such words stand for, in order: a file, "-" (standard input), a folder (its
/// files, without hidden ones), a pattern with * ? [ ], or `@LIST`, a text with one of these a
/// line. Files of folders and patterns are ordered by name, numbers in names by value (2 before
/// 10). Of a folder's files those with an unknown extension are skipped as open_sequence does.
/// Throws Error{io}, Error{invalid_argument}.
std::vector<std::string> input_files(const std::vector<std::string>& words,
                                     const ReadOptions& options = {});

/// The file that such a word names: FILE.npz for FILE.npz:NAME, else itself.
std::string file_of_input(const std::string& word);

/// The sum of the files' sizes; 0 where one is no regular file, so that the size is unknown.
std::uint64_t input_bytes(const std::vector<std::string>& files);

/// Whether these are larger than half of the memory that the options allow
/// (Options::memory_budget), or compressed, so that their size is unknown.
bool worth_streaming(const std::vector<std::string>& files, const Options& options);

/// Reads the files one after the other, each once, and visits their points block by block, in
/// memory O(readers * block). Formats of records (.npy, .ply in binary, raw, ...) and text come in
/// blocks; the others (.obj, .stl, ...) are read whole, one file at a time.
///
/// Errors: io, bad_file (points of another dimension than the first input's, too),
/// out_of_budget for a file that has to be read whole and does not fit, cancelled
/// (options.read.stop).
BlockSummary visit_blocks(const std::vector<std::string>& files, const BlockVisitor& visitor,
                          const BlockOptions& options = {});

/// HullState as a file: .hullstate (docs/formats.md), or .npz with the arrays ids, points and
/// point_count, for NumPy; the library does not read the latter as a state. The file appears whole
/// or not at all.
void write_state(const std::string& path, const HullState& state);
HullState read_state(const std::string& path);

}  // namespace cullhull
#pragma GCC visibility pop
