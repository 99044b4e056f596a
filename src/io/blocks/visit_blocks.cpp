// visit_blocks: threads that take the next block, read it, and hand it to the visitor.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <list>
#include <mutex>
#include <system_error>
#include <thread>

#include "cullhull/error.hpp"
#include "cullhull/point_blocks.hpp"
#include "io/blocks/block_source.hpp"
#include "io/records.hpp"
#include "io/skip_nan.hpp"
#include "io/text/lines.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {
namespace {

using Clock = std::chrono::steady_clock;

/// An input with blocks in work.
struct ActiveInput {
  std::unique_ptr<BlockSource> source;
  std::uint64_t file = 0;           ///< its index among the inputs
  std::uint64_t points_before = 0;  ///< of all inputs before it; known with its first block's id
  std::uint64_t under_way = 0;
  bool begun = false, ended = false;
};

using InputPlace = std::list<ActiveInput>::iterator;

/// A block from being taken to having been visited. Blocks are numbered in order.
struct Taken {
  BlockTask task;
  InputPlace input;
  std::uint64_t number = 0, first_id = 0;
};

/// The dimension of a block, and its file.
struct DimensionOf {
  std::uint64_t number = 0;
  std::uint32_t dimension = 0;
  std::string file;
};

/// Thrown where a block is skipped because another one has failed.
struct Dropped {};

class Reading {
 public:
  Reading(const std::vector<std::string>& files, const BlockVisitor& visitor,
          const BlockOptions& options)
      : files_(files),
        visitor_(visitor),
        options_(options),
        total_bytes_(input_bytes(files)),
        next_file_(options.from.file),
        named_points_(options.from.points),
        bytes_before_(options.from.bytes),
        skipped_(options.from.skipped) {
    if (options.read.numbers == Numbers::grid && options.read.grid)
      summary_.grid = *options.read.grid;
  }

  BlockSummary run() {
    std::vector<std::thread> threads = start();
    std::exception_ptr of_caller;
    try {
      watch(threads.empty());
    } catch (...) {
      of_caller = std::current_exception();
      const std::lock_guard lock(mutex_);
      stop_ = true;
      paused_ = false;
      changed_.notify_all();
    }
    for (std::thread& t : threads) t.join();
    if (of_caller != nullptr) std::rethrow_exception(of_caller);
    if (failed_) tell_error();
    summary_.end = position();
    if (cancelled_) {
      if (visitor_.pause) visitor_.pause(summary_.end);
      throw Error(ErrorCode::cancelled, "cancelled");
    }
    return summary_;
  }

 private:
  // ----------------------------------------------------------------- the thread that asked

  std::vector<std::thread> start() {
    const unsigned readers =
        options_.readers > 0 ? options_.readers : resolve_threads(options_.read.threads) + 1;
    std::vector<std::thread> threads;
    working_ = readers;
    for (unsigned t = 0; t < readers; ++t) try {
        threads.emplace_back([this] { read_blocks(); });
      } catch (const std::system_error&) {  // as many threads as the system allows
        const std::lock_guard lock(mutex_);
        if (working_ > 1 || !threads.empty()) --working_;
      }
    return threads;
  }

  /// Reports progress, checks for cancellation and pauses, until the threads are done. Reads itself
  /// where there are none.
  void watch(bool alone) {
    Clock::time_point last_pause = Clock::now();
    const auto wait = std::chrono::milliseconds(50);
    const auto ended = [&] { return working_ == 0; };
    std::unique_lock lock(mutex_);
    BlockMemory memory;
    const auto read = [&] {
      lock.unlock();
      const bool more = read_block(memory);
      lock.lock();
      return more;
    };
    while (alone ? read() : !done_.wait_for(lock, wait, ended)) {
      if (options_.read.stop.stop_requested()) {
        stop_ = cancelled_ = true;
        continue;
      }
      const std::chrono::duration<double> since = Clock::now() - last_pause;
      const bool pause = visitor_.pause && since.count() >= visitor_.pause_seconds;
      if (pause) {
        paused_ = true;
        changed_.wait(lock, [&] { return under_way_ == 0 || stop_; });
      }
      const bool quiet = pause && !stop_;
      const BlockPosition at = position();
      lock.unlock();
      tell(at);
      if (quiet) {
        visitor_.pause(at);
        last_pause = Clock::now();
      }
      lock.lock();
      paused_ = false;
      changed_.notify_all();
    }
  }

  void tell(const BlockPosition& at) const {
    if (options_.poll) options_.poll();
    if (options_.position) options_.position(at);
    if (options_.progress && total_bytes_ > 0)
      options_.progress("read", static_cast<double>(at.bytes) / static_cast<double>(total_bytes_));
  }

  /// After the last block taken; requires `mutex_` or that all threads have ended.
  BlockPosition position() const {
    BlockPosition at;
    at.file = next_file_;
    at.points = named_points_;
    at.skipped = skipped_;
    at.bytes = bytes_before_ + last_.taken;
    if (current_ == active_.end()) return at;
    at.file = current_->file;
    at.file_points = current_->begun ? named_points_ - current_->points_before : 0;
    at.file_bytes = last_.file_bytes;
    at.file_lines = last_.file_lines;
    at.input_bytes = last_.taken;
    return at;
  }

  // ----------------------------------------------------------------- threads that read

  void read_blocks() {
    BlockMemory memory;
    while (read_block(memory)) {
    }
  }

  /// False where none is left.
  bool read_block(BlockMemory& memory) {
    Taken taken;
    if (!take(taken, memory)) {
      const std::lock_guard lock(mutex_);
      --working_;
      done_.notify_all();
      return false;
    }
    try {
      LoadedBlock block = taken.task.load();
      name(taken, block);
      cut(taken, block);
      visit(taken, block);
      pass_on(taken);
    } catch (const Dropped&) {
      const std::lock_guard lock(mutex_);
      leave();
    } catch (...) {
      note_error(taken.number);
    }
    return true;
  }

  /// Gets the next block; false at the end, or when reading has to stop.
  bool take(Taken& taken, BlockMemory& memory) {
    const std::lock_guard turn(taking_);  // one thread at a time calls next(), in order
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return !paused_ || stop_; });
      if (stop_ || ended_) return false;
      ++under_way_;
    }
    try {
      taken.task = {};
      while (current_ == active_.end() || !current_->source->next(taken.task, memory))
        if (!open_next()) return false;
      const std::lock_guard lock(mutex_);
      taken.number = next_number_++;
      taken.input = current_;
      ++current_->under_way;
      last_ = taken.task;
      last_.load = nullptr;
      // Where the counts of all blocks before are known, so is the first id.
      if (taken.task.count && taken.number == next_named_) assign(taken, *taken.task.count);
      return true;
    } catch (const Error& e) {
      if (e.code() == ErrorCode::cancelled)
        end_cancelled();
      else
        note_error(next_number_);
    } catch (...) {
      note_error(next_number_);
    }
    return false;
  }

  /// Opening or waiting for an input heard of the cancellation before watch() did. No block was
  /// taken, so that the position is right.
  void end_cancelled() {
    const std::lock_guard lock(mutex_);
    stop_ = cancelled_ = true;
    changed_.notify_all();
    leave();
  }

  bool open_next() {
    std::unique_ptr<BlockSource> source;
    if (next_file_ < files_end()) source = open_source(files_[next_file_], options_);
    if (source != nullptr) note_placement(*source);
    const std::lock_guard lock(mutex_);
    if (current_ != active_.end()) {
      bytes_before_ += std::max(last_.taken, input_bytes({files_[current_->file]}));
      last_ = {};
      current_->ended = true;
      finish(std::exchange(current_, active_.end()));
    }
    if (source == nullptr) {
      ended_ = true;
      leave();
      return false;
    }
    active_.push_back({std::move(source), next_file_, 0, 0, false, false});
    current_ = std::prev(active_.end());
    if (summary_.format.empty()) summary_.format = current_->source->format();
    if (options_.rows.end != RowRange().end && next_file_ == options_.rows.to.file)
      current_->source->end_at(options_.rows.to);
    if (next_file_ == options_.from.file) {
      current_->source->go_on_from(options_.from);
      // Ids continue from there; bytes are counted from the beginning of the input again.
      current_->begun = options_.from.file_points > 0;
      current_->points_before = options_.from.points - options_.from.file_points;
      bytes_before_ -= std::min(bytes_before_, options_.from.input_bytes);
    }
    ++next_file_;
    return true;
  }

  /// Behind the last input that has rows to visit.
  std::uint64_t files_end() const {
    const BlockPosition& to = options_.rows.to;
    if (options_.rows.end == RowRange().end) return files_.size();
    return to.file + (to.file_points > 0 ? 1 : 0);
  }

  /// Called by one thread at a time, in order.
  void note_placement(const BlockSource& source) {
    // The stored numbers of a scan are such even if its header gives them no place.
    const bool raw_scan =
        options_.read.numbers == Numbers::raw && source.format().starts_with("las");
    summary_.any_placed = summary_.any_placed || !source.placement().empty() || raw_scan;
    if (std::exchange(any_opened_, true)) return;
    summary_.placement = source.placement();
    if (!options_.read.grid) summary_.grid = source.grid();
  }

  /// Requires `mutex_`.
  void assign(Taken& taken, std::uint64_t count) {
    taken.first_id = named_points_;
    if (!std::exchange(taken.input->begun, true)) taken.input->points_before = named_points_;
    named_points_ += count;
    next_named_ = taken.number + 1;
    changed_.notify_all();
  }

  /// Gives a block its first id, once all before have theirs, and compares its dimension with
  /// theirs.
  void name(Taken& taken, const LoadedBlock& block) {
    std::unique_lock lock(mutex_);
    if (next_named_ <= taken.number) {
      changed_.wait(lock, [&] {
        return next_named_ == taken.number || (failed_ && error_at_ < taken.number);
      });
      if (next_named_ != taken.number) throw Dropped();
      assign(taken, block.count());
    }
    if (block.dimension() == 0) return;
    note_columns(taken, block);
    compare_dimension({taken.number, block.dimension(), taken.input->source->name()});
    if (block.count() == 0) return;
    if (!std::exchange(any_points_, true)) summary_.scalar = block.scalar();
    if (summary_.scalar != block.scalar()) summary_.scalar = ScalarType::f64;
  }

  /// Keeps the columns of the lowest block with points. Requires `mutex_`.
  void note_columns(const Taken& taken, const LoadedBlock& block) {
    if (block.state || (!summary_.columns.empty() && taken.number > columns_of_)) return;
    columns_of_ = taken.number;
    const std::string& format = block.data.format;
    summary_.columns = block.data.columns.empty()
                           ? all_columns(format.empty() ? taken.input->source->format() : format,
                                         block.dimension())
                           : block.data.columns;
  }

  [[noreturn]] void tell_error() const {
    if (error_ != nullptr) std::rethrow_exception(error_);
    throw Error(ErrorCode::bad_file, odd_.file, ": points of dimension ", odd_.dimension,
                ", but of ", lowest_.dimension, " in ", lowest_.file);
  }

  /// Blocks arrive in any order but are compared with the lowest, and the error is that of the
  /// lowest that differs. Requires `mutex_`.
  void compare_dimension(DimensionOf block) {
    if (summary_.dimension == 0) {
      summary_.dimension = block.dimension;
      lowest_ = std::move(block);
      return;
    }
    if (block.number < lowest_.number) {
      summary_.dimension = block.dimension;
      std::swap(block, lowest_);
    }
    if (block.dimension == lowest_.dimension) return;
    if (odd_.dimension == 0 || block.number < odd_.number) odd_ = std::move(block);
    keep_error(odd_.number, nullptr);
    throw Dropped();
  }

  /// Leaves the rows that options_.rows asks for.
  void cut(Taken& taken, LoadedBlock& block) const {
    const std::uint64_t first = taken.first_id, count = block.count();
    const std::uint64_t begin = std::clamp(options_.rows.begin, first, first + count) - first;
    const std::uint64_t end = std::clamp(options_.rows.end, first, first + count) - first;
    if (block.state || end - begin == count) return;
    PointData& data = block.data;
    if (end > begin) data.view.data = data.view.address(begin, 0);
    data.view.count = end - begin;
    data.not_finite.point -= begin;
    if (!options_.read.key.empty()) data.keys = part_of(data.keys, begin, end);
    taken.first_id += begin;
  }

  static PointKeys part_of(const PointKeys& keys, std::uint64_t begin, std::uint64_t end) {
    PointKeys part;
    for (std::uint64_t i = begin; i < end; ++i) part.add(keys[i]);
    return part;
  }

  void visit(const Taken& taken, const LoadedBlock& block) const {
    const std::string& file = taken.input->source->name();
    if (block.state) {
      if (!visitor_.state)
        throw Error(ErrorCode::invalid_argument, file,
                    ": holds the extreme points of a part, which are not all its points");
      visitor_.state(*block.state, taken.first_id);
      return;
    }
    const PointView& view = block.data.view;
    try {
      if (!options_.read.skip_nan)
        visit_rows(taken, block, 0, view.count);
      else
        for_runs_without_nan(
            view,
            [&](std::uint64_t begin, std::uint64_t end) { visit_rows(taken, block, begin, end); },
            [&](std::uint64_t begin, std::uint64_t end) {
          skipped_ += end - begin;
          if (visitor_.skipped) visitor_.skipped(taken.first_id + begin, end - begin);
            });
    } catch (const Error& e) {
      if (e.code() != ErrorCode::not_finite) throw;
      // Visitors name the first such point of a block, by ids of their own.
      const PointLine& at = block.data.not_finite;
      const bool named = at.line > 0 && std::string_view(e.what()).starts_with("point ") &&
                         first_not_finite(view) == at.point &&
                         !(options_.read.skip_nan && has_nan(view, at.point));
      throw Error(e.code(), file, named ? ":" + std::to_string(at.line) : "", ": ", e.what());
    }
  }

  /// Passes on the points [begin, end) of a block.
  void visit_rows(const Taken& taken, const LoadedBlock& block, std::uint64_t begin,
                  std::uint64_t end) const {
    PointView rows = block.data.view;
    const PointKeys& keys = block.data.keys;
    const bool all = begin == 0 && end == rows.count;
    if (!all) rows.data = rows.address(begin, 0);
    rows.count = end - begin;
    if (options_.read.key.empty()) return visitor_.points(rows, taken.first_id + begin);
    if (all) return visitor_.keyed(rows, taken.first_id, keys);
    visitor_.keyed(rows, taken.first_id + begin, part_of(keys, begin, end));
  }

  void pass_on(const Taken& taken) {
    const std::lock_guard lock(mutex_);
    ++summary_.blocks;
    --taken.input->under_way;
    finish(taken.input);
    leave();
  }

  /// Requires `mutex_`.
  void finish(InputPlace input) {
    if (!input->ended || input->under_way > 0) return;
    input->source->finish();
    active_.erase(input);
  }
  void leave() {
    --under_way_;
    changed_.notify_all();
  }

  void note_error(std::uint64_t number) {
    const std::lock_guard lock(mutex_);
    keep_error(number, std::current_exception());
    leave();
  }
  /// Keeps the error of the lowest block, whichever came first; null: that its dimension differs.
  /// Requires `mutex_`.
  void keep_error(std::uint64_t number, std::exception_ptr error) {
    if (!std::exchange(failed_, true) || number < error_at_) {
      error_ = std::move(error);
      error_at_ = number;
    }
    stop_ = true;
  }

  const std::vector<std::string>& files_;
  const BlockVisitor& visitor_;
  const BlockOptions& options_;
  const std::uint64_t total_bytes_;

  std::mutex taking_;  ///< locked before `mutex_`

  mutable std::mutex mutex_;
  std::condition_variable changed_, done_;
  unsigned working_ = 0;  ///< threads
  bool stop_ = false, cancelled_ = false, ended_ = false, paused_ = false;
  std::uint64_t under_way_ = 0;  ///< blocks
  std::list<ActiveInput> active_;
  InputPlace current_ = active_.end();
  std::uint64_t next_file_, next_number_ = 0;
  std::uint64_t next_named_ = 0, named_points_;
  std::uint64_t bytes_before_;
  mutable std::atomic<std::uint64_t> skipped_;
  BlockTask last_;  ///< the last one taken
  std::exception_ptr error_;
  bool failed_ = false;
  std::uint64_t error_at_ = 0;
  bool any_points_ = false, any_opened_ = false;
  std::uint64_t columns_of_ = 0;  ///< the block that summary_.columns is of
  DimensionOf lowest_, odd_;      ///< the lowest block so far; the lowest with another dimension
  BlockSummary summary_;
};

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

BlockSummary visit_blocks(const std::vector<std::string>& files, const BlockVisitor& visitor,
                          const BlockOptions& options) {
  BlockOptions reading = options;
  if (reading.from == BlockPosition()) reading.from = reading.rows.from;
  // Before the first input is opened: what was visited before may have been all of them.
  const bool many = files.size() > 1 || options.from != BlockPosition();
  if (many && reading.read.numbers == Numbers::grid && !reading.read.grid)
    reading.read.grid = common_grid(files, reading.read);
  return internal::Reading(files, visitor, reading).run();
}

}  // namespace cullhull
