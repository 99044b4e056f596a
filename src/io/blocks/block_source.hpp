// One input as a sequence of blocks: what is done in order, and what any thread may do then.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "cullhull/point_blocks.hpp"
#include "io/coordinates.hpp"
#include "io/source.hpp"

namespace cullhull::internal {

/// Memory that a reading thread keeps from block to block.
class BlockMemory {
 public:
  /// Returns room for `bytes` bytes, keeping the first `keep` of its contents.
  char* room(std::size_t bytes, std::size_t keep = 0);
  std::size_t size() const { return size_; }

 private:
  Buffer buffer_;
  std::size_t size_ = 0;
};

struct LoadedBlock {
  PointData data;
  std::optional<HullState> state;  ///< instead of points

  std::uint64_t count() const { return state ? state->point_count() : data.view.count; }
  std::uint32_t dimension() const { return state ? state->dimension() : data.view.dimension; }
  ScalarType scalar() const { return state ? state->scalar() : data.view.scalar; }
};

struct BlockTask {
  std::optional<std::uint64_t> count;  ///< of points, where it is known before loading
  /// Counts the points where `count` is unknown; in place of load(), as cheaply as it can.
  std::function<std::uint64_t()> count_points;
  /// Callable from any thread; uses the memory that next() was given.
  std::function<LoadedBlock()> load;
  /// The input's position after this block; of points only where `count` is known.
  std::uint64_t file_points = 0, file_bytes = 0, file_lines = 0;
  std::uint64_t taken = 0;  ///< of the input's bytes on disk, up to here
};

struct RecordLayout;

class BlockSource {
 public:
  virtual ~BlockSource() = default;
  /// The next block, false at the end. Called by one thread at a time, in order; may read into
  /// `memory`, which must not change until the task has been loaded and visited.
  virtual bool next(BlockTask& task, BlockMemory& memory) = 0;
  /// Skips what was visited before; called before next().
  virtual void go_on_from(const BlockPosition& from) = 0;
  /// Leaves out what lies behind this position; called before next().
  virtual void end_at(const BlockPosition& end) = 0;
  /// The number of points, where the header says it.
  virtual std::optional<std::uint64_t> count() const { return std::nullopt; }
  /// After all tasks were loaded or counted: checks that the input was as long as its header
  /// promised.
  virtual void finish() const {}
  const std::string& name() const { return name_; }
  const std::string& format() const { return format_; }
  /// Placement of the file's numbers; for a state on a grid, its unit on each axis.
  const Placement& placement() const { return placement_; }
  /// The grid of a hull state.
  const GridOfState& of_state() const { return of_state_; }
  /// The grid whose units the blocks count in; empty for world coordinates.
  const Grid& grid() const { return grid_; }

 protected:
  /// Takes what a source says of itself from the file and the layout of its records.
  void describe(const std::string& name, const RecordLayout& layout);

  std::string name_, format_;
  Placement placement_;
  GridOfState of_state_;
  Grid grid_;
};

/// Opens an input and finds its format.
std::unique_ptr<BlockSource> open_source(const std::string& path, const BlockOptions& options);

/// Whether open_source would divide an input that begins with these bytes into blocks; false if its
/// format has to be in memory as a whole. `unknown`: the answer for formats that the bytes do not
/// show, as those of raw numbers.
bool comes_in_blocks(const Source& head, const ReadOptions& options, bool unknown = false) noexcept;

}  // namespace cullhull::internal
