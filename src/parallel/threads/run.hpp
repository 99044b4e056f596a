// How a call runs: threads, cancellation and progress, memory. Every step is handed one.
#pragma once

#include <cstdint>
#include <optional>
#include <type_traits>

#include "parallel/memory/memory.hpp"
#include "parallel/memory/pages.hpp"
#include "parallel/threads/helpers.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal::inline parallel {

/// Items a chunk for loops of a few nanoseconds an item: some 50 microseconds, long beside the
/// microsecond that handing a chunk to another thread takes.
inline constexpr std::uint64_t light_grain = std::uint64_t{1} << 15;

/// The options of one call, resolved; views them, so they must outlive it.
struct Run {
  explicit Run(const Options& o)
      : options(o),
        control(o),
        threads(resolve_threads(o.threads)),
        budget(resolve_budget(o.memory_budget)) {}
  explicit Run(Options&&) = delete;  ///< a temporary ends before the run

  Run with_threads(unsigned n) const {
    Run run = *this;
    run.threads = n;
    return run;
  }
  Run with_budget(std::uint64_t bytes) const {
    Run run = *this;
    run.budget = bytes;
    return run;
  }

  /// Throws Error{cancelled} if the caller asked to stop.
  void check() const { control.check(); }
  void report(const char* phase, double share) const { control.report(phase, share); }

  /// body(begin, end) for chunks of `grain` items of [0, count), as for_each_chunk; checks for
  /// cancellation before each of them.
  template <class Body>
  void each(std::uint64_t count, std::uint64_t grain, const Body& body) const {
    for_each_chunk(count, grain, threads,
                   [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      control.check();
      body(begin, end);
    });
  }
  /// The same as body(chunk, begin, end): results that are combined in the order of chunks.
  template <class Body>
  void each_chunk(std::uint64_t count, std::uint64_t grain, const Body& body) const {
    for_each_chunk(count, grain, threads,
                   [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
      control.check();
      body(chunk, begin, end);
    });
  }
  /// body(i) for every i below `count`, each worth a chunk.
  template <class Body>
  void each_item(std::uint64_t count, const Body& body) const {
    each(count, 1, [&](std::uint64_t i, std::uint64_t) { body(i); });
  }

  const Options& options;
  Control control;
  unsigned threads;
  std::uint64_t budget;  ///< bytes
};

/// One call of a public function: its run, and the threads and memory that are kept while it lasts.
class Call {
 public:
  explicit Call(const Options& options) : run(options) {}
  explicit Call(const RunOptions& options) : options_(Options{options}), run(*options_) {}
  template <class Temporary>
  requires(!std::is_lvalue_reference_v<Temporary>) explicit Call(Temporary&&) = delete;

 private:
  std::optional<const Options> options_;

 public:
  const Run run;

 private:
  CallScope threads_;
  PageScope pages_;
};

/// For short work on the calling thread that need not be cancelled.
inline const Run& short_run() {
  static const Options options;
  static const Run run = Run(options).with_threads(1);
  return run;
}

}  // namespace cullhull::internal::inline parallel
