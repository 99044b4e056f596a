// Divides the rows of all inputs: counts them, and finds the blocks where a part begins and ends.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/point_blocks.hpp"
#include "io/blocks/block_source.hpp"
#include "io/blocks/read_ahead.hpp"
#include "io/source.hpp"

namespace cullhull::internal {
namespace {

/// The rows of an input, and where each of its blocks begins; of records any row may begin one.
struct CountedInput {
  std::uint64_t rows = 0;
  bool records = false;
  std::vector<BlockPosition> blocks;  ///< behind each block: file_points, file_bytes, file_lines
};

CountedInput counted(const std::string& file, const BlockOptions& options) {
  if (is_pipe(file_of_input(file)))
    throw Error(ErrorCode::invalid_argument, display_name(file),
                ": a part needs the number of rows first, and a pipe can be read only once");
  const std::unique_ptr<BlockSource> source = open_source(file, options);
  CountedInput input;
  input.records = source->count().has_value();
  input.rows = source->count().value_or(0);
  if (input.records) return input;
  BlockMemory memory;
  for (BlockTask task; source->next(task, memory);) {
    if (options.read.stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
    input.rows += task.count ? *task.count : task.count_points();
    BlockPosition behind;
    behind.file_points = input.rows;
    behind.file_bytes = task.file_bytes;
    behind.file_lines = task.file_lines;
    input.blocks.push_back(behind);
  }
  source->finish();
  return input;
}

/// The last position at or before `row` where a block begins, or the first at or behind it where
/// one ends.
BlockPosition position_of(const std::vector<std::string>& files,
                          const std::vector<CountedInput>& inputs, std::uint64_t row, bool ends) {
  std::uint64_t before = 0, file = 0;
  for (; file + 1 < inputs.size(); ++file) {
    const std::uint64_t behind = before + inputs[file].rows;
    if (ends ? behind >= row : behind > row) break;
    before = behind;
  }
  const CountedInput& input = inputs[file];
  BlockPosition at;
  if (input.records) at.file_points = row - before;
  for (const BlockPosition& behind : input.blocks) {
    if (ends ? at.file_points >= row - before : behind.file_points > row - before) break;
    at = behind;
  }
  at.file = file;
  at.bytes = input_bytes({files.begin(), files.begin() + static_cast<std::ptrdiff_t>(file)});
  at.points = before + at.file_points;
  return at;
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

RowRange rows_of_part(const std::vector<std::string>& files, std::uint64_t part,
                      std::uint64_t parts, const BlockOptions& options) {
  if (part >= parts)
    throw Error(ErrorCode::invalid_argument, "part ", part, " of ", parts,
                ": parts are numbered from 0");
  if (parts == 1) return {};
  BlockOptions counting = options;
  counting.read.remark = {};  // which visit_blocks has
  std::vector<internal::CountedInput> inputs;
  std::uint64_t rows = 0;
  for (const std::string& file : files) {
    inputs.push_back(internal::counted(file, counting));
    rows += inputs.back().rows;
  }
  if (parts > rows)
    throw Error(ErrorCode::invalid_argument, parts, " parts of ", rows,
                rows == 1 ? " row" : " rows", ": some would be empty");
  RowRange range;
  range.begin = rows / parts * part + std::min(part, rows % parts);
  range.end = range.begin + rows / parts + (part < rows % parts ? 1 : 0);
  range.from = internal::position_of(files, inputs, range.begin, false);
  range.to = internal::position_of(files, inputs, range.end, true);
  return range;
}

}  // namespace cullhull
