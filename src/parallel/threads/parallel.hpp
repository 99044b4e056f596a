// Data-parallel loops, with cancellation and progress. They are deterministic: the chunk size
// alone, never the number of threads, decides how work is cut into chunks, and callers combine
// results in the order of chunks.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <thread>

#include "cullhull/error.hpp"
#include "cullhull/options.hpp"
#include "parallel/threads/span_account.hpp"

namespace cullhull::internal {

/// The number of threads to use for a request: the request, at most 1024; for 0, one thread for
/// each hardware thread of the machine.
unsigned resolve_threads(unsigned requested);

/// A piece of a loop.
struct Chunk {
  std::uint64_t number, begin, end;
  unsigned lane;  ///< of the thread that runs it, below the number of threads
};

/// Cuts [0, count) into chunks of `chunk_size` items and runs body(chunk) for each, on at most
/// `threads` threads. The caller works too, and runs all chunks if no helper is free (helpers.hpp).
/// Two chunks that run at the same time have different lanes; with one thread all have lane 0 and
/// run in order. Returns when every chunk that has begun is done. After an exception of body no
/// further chunk begins, and the first exception is rethrown.
///
/// Requesting helpers takes a few microseconds; taking a chunk 3 ns on one thread and 14 to 100 ns
/// on two (measured with empty bodies). So chunks of ten to a hundred microseconds cost nothing
/// that can be measured, share the work evenly from a millisecond on, and let a call stop at once:
/// any size in between serves, and none is tuned further.
void run_chunks(std::uint64_t count, std::uint64_t chunk_size, unsigned threads,
                const std::function<void(const Chunk&)>& body, CodePlace where);

/// The same with body(number, begin, end).
template <class Body>
void for_each_chunk(std::uint64_t count, std::uint64_t chunk_size, unsigned threads,
                    const Body& body, CodePlace where = CodePlace::current()) {
  run_chunks(
      count, chunk_size, threads,
      [&](const Chunk& chunk) { body(chunk.number, chunk.begin, chunk.end); }, where);
}

/// The number of chunks of `chunk_size` items that hold `count` items; the last may be shorter.
inline std::uint64_t chunk_count(std::uint64_t count, std::uint64_t chunk_size) {
  return (count + chunk_size - 1) / chunk_size;
}

/// A call's cancellation and progress, passed to long loops.
class Control {
 public:
  /// Construct it on the calling thread. It refers to the options, which must outlive it.
  explicit Control(const Options& options)
      : progress_(&options.progress),
        poll_(options.poll ? &options.poll : nullptr),
        stop_(options.stop) {
    if (poll_ != nullptr) caller_ = std::this_thread::get_id();
  }
  /// Throws Error{cancelled} if the caller requested a stop. On the calling thread it first calls
  /// options.poll, whose exceptions pass through. Call it every few thousand steps.
  void check() const {
    if (poll_ != nullptr && std::this_thread::get_id() == caller_) (*poll_)();
    if (stop_.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
  }
  /// Calls options.progress. May be called on the calling thread only.
  void report(const char* phase, double share) const {
    if (*progress_) (*progress_)(phase, share);
  }

 private:
  const Progress* progress_;
  const Poll* poll_;
  std::thread::id caller_;
  stop_token stop_;
};

/// The clock that measures durations.
using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace cullhull::internal
