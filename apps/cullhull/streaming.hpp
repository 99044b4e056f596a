// Reading points block by block: when, with which progress, and from where an interrupted run
// continues.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "cullhull/point_blocks.hpp"
#include "cullhull/stream.hpp"
#include "outputs.hpp"

namespace app {

/// Ids are written as signed numbers of 64 bits.
inline constexpr std::uint64_t greatest_id = std::numeric_limits<std::int64_t>::max();

struct StreamArguments {
  std::string stream = "auto";
  std::string checkpoint;
  std::string partial;
  unsigned every = 60;      ///< seconds from checkpoint to checkpoint
  bool global_ids = false;  ///< states among the inputs keep their ids
  std::string part;         ///< "K/N", from 1; empty: all rows
  /// How the state's file was named: "--partial", or "-o".
  std::string partial_option = "--partial";
  std::uint64_t first_id = 0;

  /// `states`: with the options for writing and reading states.
  void add_to(Parser& command, bool states);
  void add_first_id_to(Parser& command);
  void add_part_to(Parser& command);
  /// Among the outputs, takes the name of a state from them. Error{invalid_argument} for a second.
  void take_state(std::vector<std::string>& outputs);
  /// Refuses a --first-id beyond the greatest id: Error{invalid_argument}.
  void check_ids() const;
  /// Whether any option differs from its default.
  bool any() const {
    return stream != "auto" || !checkpoint.empty() || !partial.empty() || global_ids ||
           !part.empty() || first_id > 0;
  }
  /// Adds the outputs to the plan.
  void plan(FilePlan& plan) const;
  /// Whether to read in blocks. `why_not`: the option that needs all points in memory; empty if
  /// there is none: then `auto` chooses by the inputs. Error{invalid_argument} for contradictory
  /// options.
  bool wanted(const std::vector<std::string>& files, const RunArguments& run,
              const std::string& why_not) const;
  /// How to have the points read in blocks where wanted() is false: for errors of those that do not
  /// fit.
  static std::string hint(const std::string& why_not);
};

/// What the coordinates of inputs that were read in blocks are.
Placing placing_of(const cullhull::BlockSummary& read, const InputArguments& input);

struct Streamed {
  cullhull::HullState state;
  cullhull::BlockSummary read;
  cullhull::StreamReport report;
  double seconds = 0;
  InputArguments input;  ///< of which they were read

  Placing placing() const { return placing_of(read, input); }
};

/// The state of all points of the inputs; with checkpoints and progress as requested.
Streamed stream_state(const InputArguments& input, const std::vector<std::string>& files,
                      const StreamArguments& stream, const RunArguments& run);

/// The state as --partial has it, in the world; nothing without that option.
void write_partial(const StreamArguments& stream, const cullhull::HullState& state,
                   const cullhull::Grid& grid);

/// Passes each block to `points`, with progress; from several threads at once. With --skip-nan
/// these are the points between those left out, whose number `skipped` is told.
cullhull::BlockSummary stream_blocks(
    const InputArguments& input, const std::vector<std::string>& files, const RunArguments& run,
    const std::function<void(const cullhull::PointView&, std::uint64_t first_id)>& points,
    const std::function<void(std::uint64_t count)>& skipped = {});

/// The first of the files that can be read only once; empty if there is none.
std::string first_pipe(const std::vector<std::string>& files);

/// The rest of the work is done: removes the checkpoint.
void remove_checkpoint(const StreamArguments& stream);

/// "points     20,000 x 3 f64, npy, 12 blocks of 3 inputs\n"
std::string streamed_points_line(const Streamed& streamed, std::size_t files);

}  // namespace app
