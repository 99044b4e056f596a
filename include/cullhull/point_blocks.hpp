// Points of any number of files as one sequence of blocks, of which only a few are in memory.
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

/// A position in the inputs: all blocks before it have been visited.
struct BlockPosition {
  std::uint64_t file = 0;    ///< number of inputs read completely
  std::uint64_t points = 0;  ///< of all inputs
  /// Position in the next input: points, and for text bytes and lines.
  std::uint64_t file_points = 0, file_bytes = 0, file_lines = 0;
  std::uint64_t bytes = 0;        ///< of all inputs, for progress
  std::uint64_t input_bytes = 0;  ///< of those, bytes in the next input
  std::uint64_t skipped = 0;      ///< of `points`, those that ReadOptions::skip_nan left out

  friend bool operator==(const BlockPosition&, const BlockPosition&) = default;
};

/// Consecutive rows of all inputs; see rows_of_part().
struct RowRange {
  std::uint64_t begin = 0;
  std::uint64_t end = std::uint64_t(-1);  ///< one more than the last; default: all
  BlockPosition from, to;                 ///< positions at or before `begin` and behind `end`

  friend bool operator==(const RowRange&, const RowRange&) = default;
};

/// Functions that receive the blocks. If one throws, reading ends and the error of the lowest block
/// is thrown; not_finite then also names the file.
struct BlockVisitor {
  /// Receives a block, whose first point is point `first_id` of all inputs. Called from several
  /// threads at once. The view is valid only during the call.
  std::function<void(const PointView& block, std::uint64_t first_id)> points{};
  /// Called instead of `points` if ReadOptions::key selects a column.
  std::function<void(const PointView& block, std::uint64_t first_id, const PointKeys& keys)>
      keyed{};
  /// Receives an input that is a hull state (.hullstate), which stands for the points from first_id
  /// on. If not set, such an input is an error. Called from several threads at once.
  std::function<void(const HullState& state, std::uint64_t first_id)> state{};
  /// Receives, with ReadOptions::skip_nan, each run of points that are left out: their number and
  /// the first id. May be empty. Called from several threads at once.
  std::function<void(std::uint64_t first_id, std::uint64_t count)> skipped{};
  /// Called by the thread that called visit_blocks, while no block is being visited: every
  /// `pause_seconds`, and when reading is cancelled.
  std::function<void(const BlockPosition&)> pause{};
  double pause_seconds = 60;
};

/// Summary of visit_blocks.
struct BlockSummary {
  BlockPosition end;
  std::uint64_t blocks = 0;
  std::uint32_t dimension = 0;  ///< 0: there was no block
  /// That of the first input that had points; f64 if inputs differ.
  ScalarType scalar = ScalarType::f64;
  std::string format;                ///< of the first input
  std::vector<std::string> columns;  ///< as PointFile::columns(), of the first input with points
  Placement placement;               ///< of the first input's numbers
  Grid grid;                         ///< of all inputs, as in PointFile::grid()
  bool any_placed = false;           ///< whether an input has a placement
};

struct BlockOptions {
  ReadOptions read{};
  /// Threads that read and visit; 0: one more than processors, because one may wait for a disk.
  unsigned readers = 0;
  std::uint64_t block_bytes = std::uint64_t{2} << 20;  ///< approximate, in the file
  BlockPosition from{};                                ///< position to resume from
  RowRange rows{};                                     ///< the rows to visit
  Progress progress{};                                 ///< "read" and the fraction of bytes read
  Poll poll{};
  /// Called with the position about every 50 ms, by the thread that called visit_blocks: progress
  /// of inputs whose size is unknown (pipes), of which `progress` reports none.
  std::function<void(const BlockPosition&)> position{};
};

/// The files that these words stand for, in order: a file, "-" (standard input), a folder (its
/// files, without hidden ones), a pattern with * ? [ ], or `@LIST`, a text file with one of these
/// per line. Files of folders and patterns are sorted by name, numbers in names by value (2 before
/// 10). Files of a folder with an unknown extension are skipped as open_sequence does. Throws
/// Error{io}, Error{invalid_argument}.
std::vector<std::string> input_files(const std::vector<std::string>& words,
                                     const ReadOptions& options = {});

/// The file that such a word names: FILE.npz for FILE.npz:NAME, else the word itself.
std::string file_of_input(const std::string& word);

/// The sum of the files' sizes in bytes; 0 (unknown) if one of them is not a regular file.
std::uint64_t input_bytes(const std::vector<std::string>& files);

/// Whether the files should be read in blocks: they are larger than half of the memory budget
/// (Options::memory_budget), or compressed, so that their size is unknown, or a pipe that delivers
/// more than one block. Waits for the first block of a pipe, which this process's next reader of
/// the same path receives. Options used: memory_budget, stop. Throws Error{io}, Error{cancelled}.
bool worth_streaming(const std::vector<std::string>& files, const Options& options);

/// Part `part` (from 0) of `parts` nearly equal parts of the rows of all files. Counts them: a
/// text, and what is compressed or read whole, is read for that. Throws what visit_blocks throws,
/// and Error{invalid_argument} for more parts than rows, for a pipe and for a hull state; 1 part
/// has all.
RowRange rows_of_part(const std::vector<std::string>& files, std::uint64_t part,
                      std::uint64_t parts, const BlockOptions& options = {});

/// Reads the files one after the other, each once, and visits their points block by block, in
/// memory O(readers * block). Record formats (.npy, binary .ply, raw, ...) and text are read in
/// blocks; the others (.obj, .stl, ...) are read whole, one file at a time.
///
/// Errors: io, bad_file (also for points of another dimension than the first input's),
/// out_of_budget for a file that must be read whole and does not fit, cancelled
/// (options.read.stop).
BlockSummary visit_blocks(const std::vector<std::string>& files, const BlockVisitor& visitor,
                          const BlockOptions& options = {});

/// Writes a HullState as .hullstate (docs/formats.md), or as .npz with the arrays ids, points and
/// point_count, for NumPy; read_state reads only the former. The file appears complete or not at
/// all.
void write_state(const std::string& path, const HullState& state);
HullState read_state(const std::string& path);

}  // namespace cullhull
#pragma GCC visibility pop
