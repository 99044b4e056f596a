// Points block after block: when, with what progress, and from where a run that was cut off goes
// on.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "cullhull/point_blocks.hpp"
#include "cullhull/stream.hpp"
#include "outputs.hpp"

namespace app {

struct StreamArguments {
  std::string stream = "auto";
  std::string checkpoint;
  std::string partial;
  unsigned every = 60;      ///< seconds from checkpoint to checkpoint
  bool global_ids = false;  ///< states among the inputs keep their ids
  std::uint64_t first_id = 0;

  /// `states`: with what makes, keeps and takes in states.
  void add_to(Parser& command, bool states);
  /// Whether anything but the defaults was asked for.
  bool any() const {
    return stream != "auto" || !checkpoint.empty() || !partial.empty() || global_ids ||
           first_id > 0;
  }
  /// Names the outputs to the plan.
  void plan(FilePlan& plan) const;
  /// Whether to read in blocks. `why_not`: what the run needs all points in memory for; empty if
  /// nothing: then `auto` chooses by the inputs. Error{invalid_argument} where that is impossible.
  bool wanted(const std::vector<std::string>& files, const RunArguments& run,
              const std::string& why_not) const;
};

struct Streamed {
  cullhull::HullState state;
  cullhull::BlockSummary read;
  cullhull::StreamReport report;
  double seconds = 0;
};

/// The state of all points of the inputs; with checkpoints and progress as asked for.
Streamed stream_state(const InputArguments& input, const std::vector<std::string>& files,
                      const StreamArguments& stream, const RunArguments& run);

/// Hands each block to `points`, with progress; from several threads at once.
cullhull::BlockSummary stream_blocks(
    const InputArguments& input, const std::vector<std::string>& files, const RunArguments& run,
    const std::function<void(const cullhull::PointView&, std::uint64_t first_id)>& points);

/// Where the state of all points comes from, and who certifies its hull, if not this process alone.
struct Elsewhere {
  /// Whether this process writes and prints; only its state, hull and rows are asked for.
  bool reports = true;
  std::function<Streamed(const InputArguments&, const std::vector<std::string>& files,
                         const RunArguments&)>
      state;
  std::function<cullhull::Certificate(const cullhull::Hull&, std::vector<double> vertex_rows)>
      certify;
};

/// What is left of the work is done: the checkpoint has served.
void remove_checkpoint(const StreamArguments& stream);

/// "points     20,000 x 3 f64, npy, 12 blocks of 3 inputs\n"
std::string streamed_points_line(const Streamed& streamed, std::size_t files);

}  // namespace app
