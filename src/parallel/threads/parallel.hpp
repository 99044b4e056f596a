// Data-parallel loops, with cancellation and progress. Everything is deterministic: work is cut
// into chunks by size alone, never by thread count, and results are combined in chunk order.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <thread>

#include "cullhull/error.hpp"
#include "cullhull/options.hpp"

namespace cullhull::internal::inline parallel {

/// Threads that will be used for a request (0: all the machine offers).
unsigned resolve_threads(unsigned requested);

/// Runs body(chunk, begin, end) for every chunk of `chunk_size` items of [0, count) on at most
/// `threads` threads; serial and in order for threads == 1. The caller works too, and does all
/// chunks where no helper is free (helpers.hpp). Asking for helpers takes a few
/// microseconds; taking a chunk 3 ns on one thread and 14 to 100 ns on two (measured with empty
/// bodies). So chunks of ten to a hundred microseconds cost nothing that can be measured, share the
/// work evenly from a millisecond on, and let a call stop at once: any size in between serves, and
/// none is tuned further. Exceptions pass through.
void for_each_chunk(
    std::uint64_t count, std::uint64_t chunk_size, unsigned threads,
    const std::function<void(std::uint64_t chunk, std::uint64_t begin, std::uint64_t end)>& body);

inline std::uint64_t chunk_count(std::uint64_t count, std::uint64_t chunk_size) {
  return (count + chunk_size - 1) / chunk_size;
}

/// Cancellation and progress, handed down to long loops.
class Control {
 public:
  /// Made on the calling thread; views the options, which must outlive it.
  explicit Control(const Options& options)
      : progress_(&options.progress),
        poll_(options.poll ? &options.poll : nullptr),
        stop_(options.stop) {
    if (poll_ != nullptr) caller_ = std::this_thread::get_id();
  }
  /// Throws Error{cancelled} if the caller asked to stop. Cheap: call it every few thousand steps.
  void check() const {
    if (poll_ != nullptr && std::this_thread::get_id() == caller_) (*poll_)();
    if (stop_.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
  }
  /// From the calling thread only.
  void report(const char* phase, double share) const {
    if (*progress_) (*progress_)(phase, share);
  }

 private:
  const Progress* progress_;
  const Poll* poll_;
  std::thread::id caller_;
  std::stop_token stop_;
};

/// How long something takes.
using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace cullhull::internal::inline parallel
