#include "streaming.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <system_error>

#include "checkpoint.hpp"
#include "converted.hpp"
#include "cullhull/error.hpp"
#include "measure.hpp"
#include "parallel/memory/memory.hpp"
#include "parallel/paths.hpp"
#include "signals.hpp"
#include "system.hpp"
#include "terminal.hpp"

namespace app {
namespace {

using cullhull::BlockPosition;
using cullhull::Error;
using cullhull::ErrorCode;

bool is_state(const std::string& file) { return ending_of(file) == ".hullstate"; }

/// What a checkpoint must match to be continued: the same files, read with the same options.
std::string identity_of(const InputArguments& input, const std::vector<std::string>& files,
                        const StreamArguments& stream) {
  std::string text = fmt::format("{} {} {} {} {} {} {}{}\n", input.raw, input.format,
                                 input.dimension, input.type, input.columns, stream.first_id,
                                 stream.global_ids, input.skip_nan ? " skip-nan" : "");
  if (!stream.part.empty()) text += "part " + stream.part + "\n";
  if (!input.decimal.empty()) text += "decimal " + input.decimal + "\n";
  for (const std::string& file : files) {
    const system::FileIdentity found = system::identify(cullhull::file_of_input(file));
    if (!found.regular)
      throw Error(ErrorCode::invalid_argument, "--checkpoint ", stream.checkpoint, ": ",
                  input_name(file), " is not a file that could be read from its middle");
    text += fmt::format("{} {} {}\n", file, found.bytes, found.changed);
  }
  return text;
}

std::optional<Checkpoint> checkpoint_of(const StreamArguments& stream, const std::string& inputs) {
  if (stream.checkpoint.empty()) return std::nullopt;
  std::optional<Checkpoint> found = read_checkpoint(stream.checkpoint);
  if (found && found->inputs != inputs)
    throw Error(ErrorCode::invalid_argument, "--checkpoint ", stream.checkpoint,
                ": is of other inputs, or of some that have changed; remove it to begin anew");
  return found;
}

cullhull::BlockOptions block_options(const InputArguments& input, const RunArguments& run,
                                     const cullhull::Options& options) {
  cullhull::BlockOptions blocks;
  blocks.read = read_options(input, run.threads, run.memory_bytes());
  // A block for each reading thread, together at most an eighth of the limit.
  const std::uint64_t limit = cullhull::internal::resolve_budget(run.memory_bytes());
  constexpr std::uint64_t least = std::uint64_t{1} << 16;
  blocks.readers = threads_used(run.threads) + 1;
  blocks.block_bytes =
      std::clamp(limit / 8 / blocks.readers, least, std::max(least, blocks.block_bytes));
  blocks.read.stop = options.stop;
  return blocks;
}

/// Whether all inputs are states, and one has ids beyond its number of points: a part of a set,
/// numbered as in that.
bool are_numbered_parts(const std::vector<std::string>& files) {
  if (!std::all_of(files.begin(), files.end(), is_state)) return false;
  return std::any_of(files.begin(), files.end(), [](const std::string& file) {
    try {
      const cullhull::HullState state = cullhull::read_state(file);
      return !state.ids().empty() && state.ids().back() >= state.point_count();
    } catch (const Error&) {
      return false;  // said where it is read
    }
  });
}

/// Of "K/N": two numbers, 1 <= K <= N.
cullhull::RowRange rows_of(const std::string& part, const std::vector<std::string>& files,
                           const cullhull::BlockOptions& blocks) {
  std::uint64_t k = 0, n = 0;
  const char* const end = part.data() + part.size();
  const auto of_k = std::from_chars(part.data(), end, k);
  const bool slash = of_k.ec == std::errc() && of_k.ptr < end && *of_k.ptr == '/';
  const auto of_n = std::from_chars(slash ? of_k.ptr + 1 : end, end, n);
  if (!slash || of_n.ec != std::errc() || of_n.ptr != end || k < 1 || k > n)
    throw Error(ErrorCode::invalid_argument, "--part ", part,
                ": is to be K/N, part K of N, with K from 1 to N, as 3/16");
  try {
    return cullhull::rows_of_part(files, k - 1, n, blocks);
  } catch (const Error& e) {
    throw Error(e.code(), e.code() == ErrorCode::invalid_argument ? "--part " + part + ": " : "",
                e.what());
  }
}

}  // namespace

void StreamArguments::add_to(Parser& command, bool states) {
  command.group("Streaming and partial results");
  allow_words(
      *command.add_option("--stream", stream,
                          "Read in blocks, so that memory does not grow with the number of\n"
                          "points; auto (default): several inputs, compressed inputs, pipes\n"
                          "of more than 2 MiB, and files larger than half of the memory limit"),
      {"auto", "on", "off"});
  if (!states) return;
  needs_value(*command.add_option("--partial", partial,
                                  "Write a mergeable partial result: .hullstate, which may be an\n"
                                  "INPUT, or .npz for NumPy"))
      .type_name("OUT.hullstate");
  command.add_flag("--global-ids", global_ids,
                   "Keep the ids stored in .hullstate inputs (default: of parts made with\n"
                   "--part or --first-id; else renumber). Inputs must not share ids; an\n"
                   "overlap is only detected if two extreme points have the same id");
  add_first_id_to(command);
  needs_value(*command.add_option("--checkpoint", checkpoint,
                                  "Save progress to FILE, every minute and on Ctrl-C; resume from\n"
                                  "it if it exists"))
      .type_name("FILE");
  allow_range(
      *command.add_option("--checkpoint-every", every, "Seconds between checkpoints (default: 60)"),
      0, 86400);
}

void StreamArguments::add_first_id_to(Parser& command) {
  command.add_option("--first-id", first_id, "Id of the first point (default: 0)")->type_name("N");
}

void StreamArguments::add_part_to(Parser& command) {
  needs_value(*command.add_option("--part", part,
                                  "Read only part K (from 1) of N equal parts of the rows, with\n"
                                  "the ids they have in the whole: for jobs that share files.\n"
                                  "-o OUT.hullstate; 'cullhull hull *.hullstate' merges them"))
      .type_name("K/N");
}

void StreamArguments::take_state(std::vector<std::string>& outputs) {
  const auto state = [](const std::string& path) {
    const auto endings = cullhull::internal::output_endings({OutputKind::state});
    return std::find(endings.begin(), endings.end(), ending_of(path)) != endings.end();
  };
  for (auto it = outputs.begin(); (it = std::find_if(it, outputs.end(), state)) != outputs.end();) {
    if (!partial.empty())
      throw Error(ErrorCode::invalid_argument, "-o ", *it, ": one state is written, and ",
                  partial_option, " ", partial, " is it");
    partial = *it;
    partial_option = "-o";
    it = outputs.erase(it);
  }
}

void StreamArguments::check_ids() const {
  if (first_id <= greatest_id) return;
  throw Error(ErrorCode::invalid_argument,
              fmt::format("--first-id {}: ids go up to {}", first_id, greatest_id));
}

void StreamArguments::plan(FilePlan& plan) const {
  check_ids();
  plan.writes(partial_option, partial, {OutputKind::state});
  if (!checkpoint.empty()) plan.writes_any("--checkpoint", checkpoint);
}

bool StreamArguments::wanted(const std::vector<std::string>& files, const RunArguments& run,
                             const std::string& why_not) const {
  const bool states = std::any_of(files.begin(), files.end(), is_state);
  std::string what = stream == "on"        ? "--stream on"
                     : !part.empty()       ? "--part"
                     : !partial.empty()    ? partial_option
                     : !checkpoint.empty() ? "--checkpoint"
                     : first_id > 0        ? "--first-id"
                     : states              ? "a .hullstate among the inputs"
                                           : "";
  if (!what.empty() && stream == "off")
    throw Error(ErrorCode::invalid_argument, what, " reads in blocks, which --stream off forbids");
  if (!what.empty() && !why_not.empty())
    throw Error(ErrorCode::invalid_argument, what, " reads in blocks, but ", why_not,
                " needs all points in memory");
  if (!what.empty()) return true;
  if (stream == "off" || !why_not.empty()) return false;
  return files.size() > 1 || cullhull::worth_streaming(files, run.options());
}

std::string StreamArguments::hint(const std::string& why_not) {
  return why_not.empty() ? "--stream on reads it in blocks"
                         : "without " + why_not + " it is read in blocks";
}

std::string first_pipe(const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    const system::FileIdentity found = system::identify(cullhull::file_of_input(file));
    if (file == "-" || (found.exists && !found.regular && !found.folder)) return file;
  }
  return "";
}

Streamed stream_state(const InputArguments& input, const std::vector<std::string>& files,
                      const StreamArguments& stream, const RunArguments& run) {
  const Stopwatch watch;
  const std::string inputs = stream.checkpoint.empty() ? "" : identity_of(input, files, stream);
  std::optional<Checkpoint> from = checkpoint_of(stream, inputs);
  cullhull::Options options = run.options();
  cullhull::BlockOptions blocks = block_options(input, run, options);
  const bool keep_ids = stream.global_ids || are_numbered_parts(files);
  // With a checkpoint, each block must be completed.
  if (!stream.checkpoint.empty()) options.stop = {};
  cullhull::HullStream hull(options);
  if (from) {
    hull.push(from->state);
    blocks.from = from->position;
    from.reset();
  }
  TerminalProgress progress(run.quiet, "read", static_cast<double>(cullhull::input_bytes(files)));
  blocks.progress = progress.callback();
  blocks.position = progress.bytes_callback();
  if (!stream.part.empty()) cancellable([&] { blocks.rows = rows_of(stream.part, files, blocks); });
  cullhull::BlockVisitor visitor;
  visitor.points = [&](const cullhull::PointView& block, std::uint64_t first) {
    const std::uint64_t id = stream.first_id + first;
    if (block.count > 0 && block.count - 1 > greatest_id - id)
      throw Error(
          ErrorCode::invalid_argument,
          fmt::format("--first-id {}: ids of the points exceed {}", stream.first_id, greatest_id));
    hull.push(block, id);
  };
  visitor.skipped = [&](std::uint64_t first, std::uint64_t count) {
    hull.skip(stream.first_id + first, count);
  };
  visitor.state = [&](const cullhull::HullState& state, std::uint64_t first) {
    if (keep_ids) return hull.push(state);
    if (!state.ids().empty() && state.ids().back() >= state.point_count())
      throw Error(ErrorCode::invalid_argument,
                  "a state with ids beyond its number of points is a part that was numbered as "
                  "one: give --global-ids");
    cullhull::HullState shifted = state;
    shifted.shift_ids(stream.first_id + first);
    hull.push(shifted);
  };
  if (!stream.checkpoint.empty()) {
    visitor.pause_seconds = stream.every;
    visitor.pause = [&](const BlockPosition& at) {
      write_checkpoint(stream.checkpoint, {at, hull.state(), inputs});
    };
  }
  Streamed result;
  result.input = input;
  cancellable([&] {
    result.read = cullhull::visit_blocks(files, visitor, blocks);
    input.check_raw(result.read.format);
    result.state = hull.state();
  });
  result.read.format = users_format(files[0], result.read.format);
  remark_on_shape(input.path.empty() ? files[0] : input_name(input.path),
                  result.state.point_count(), result.state.dimension());
  result.report = hull.report();
  result.seconds = watch.seconds();
  return result;
}

Placing placing_of(const cullhull::BlockSummary& read, const InputArguments& input) {
  Placing placing{read.placement, read.grid, read.any_placed, input.raw, input.crs};
  placing.note_columns(read.columns, read.format, input.columns);
  if (input.skip_nan) placing.skipped = read.end.skipped;
  return placing;
}

void write_partial(const StreamArguments& stream, const cullhull::HullState& state,
                   const cullhull::Grid& grid) {
  if (stream.partial.empty()) return;
  if (grid.empty()) return cullhull::write_state(stream.partial, state);
  cullhull::HullState placed = state;
  cullhull::to_world(placed, grid);
  cullhull::write_state(stream.partial, placed);
}

cullhull::BlockSummary stream_blocks(
    const InputArguments& input, const std::vector<std::string>& files, const RunArguments& run,
    const std::function<void(const cullhull::PointView&, std::uint64_t first_id)>& points,
    const std::function<void(std::uint64_t count)>& skipped) {
  TerminalProgress progress(run.quiet, "read", static_cast<double>(cullhull::input_bytes(files)));
  cullhull::Options options = run.options();
  cullhull::BlockOptions blocks = block_options(input, run, options);
  blocks.progress = progress.callback();
  blocks.position = progress.bytes_callback();
  cullhull::BlockVisitor visitor;
  visitor.points = [&](const cullhull::PointView& block, std::uint64_t first) {
    points(block, first);
  };
  if (skipped) visitor.skipped = [&](std::uint64_t, std::uint64_t count) { skipped(count); };
  cullhull::BlockSummary summary;
  cancellable([&] { summary = cullhull::visit_blocks(files, visitor, blocks); });
  input.check_raw(summary.format);
  summary.format = users_format(files[0], summary.format);
  remark_on_shape(input.path.empty() ? files[0] : input_name(input.path), summary.end.points,
                  summary.dimension);
  return summary;
}

void remove_checkpoint(const StreamArguments& stream) {
  std::error_code not_there;
  if (!stream.checkpoint.empty())
    std::filesystem::remove(cullhull::internal::native_path(stream.checkpoint), not_there);
}

std::string streamed_points_line(const Streamed& streamed, std::size_t files) {
  const cullhull::HullState& state = streamed.state;
  return fmt::format("points     {} x {} {}, {}, {} block{} of {} input{}\n",
                     grouped(state.point_count()), state.dimension(),
                     cullhull::scalar_name(state.scalar()), streamed.read.format,
                     grouped(streamed.read.blocks), streamed.read.blocks == 1 ? "" : "s", files,
                     files == 1 ? "" : "s");
}

}  // namespace app
