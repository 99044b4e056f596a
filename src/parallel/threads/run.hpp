// Run: how one call runs, that is its threads, cancellation, progress and memory budget. Every step
// of the call receives a Run.
#pragma once

#include <cstdint>
#include <optional>
#include <type_traits>

#include "parallel/memory/memory.hpp"
#include "parallel/memory/pages.hpp"
#include "parallel/threads/helpers.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

/// Items in a chunk, for loops that take a few nanoseconds an item. A chunk then takes some 50
/// microseconds, long compared with the microsecond of handing a chunk to another thread.
inline constexpr std::uint64_t light_grain = std::uint64_t{1} << 15;

/// The memory that work on few points is known to stay below: then no budget need be asked of the
/// system, which takes some 30 microseconds in the first call of a process.
inline constexpr std::uint64_t little_memory = std::uint64_t{1} << 26;

/// The resolved options of one call. Refers to the options, which must outlive it.
struct Run {
  explicit Run(const Options& o, bool little = false)
      : options(o),
        control(o),
        threads(resolve_threads(o.threads)),
        budget(little && o.memory_budget == 0 ? little_memory : resolve_budget(o.memory_budget)) {}
  explicit Run(Options&&) = delete;  ///< a temporary would be destroyed before the Run

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

  /// Throws Error{cancelled} if the caller requested a stop (Control::check).
  void check() const { control.check(); }
  void report(const char* phase, double share) const { control.report(phase, share); }

  /// Runs body(begin, end) for each chunk of `grain` items of [0, count), as run_chunks does, and
  /// checks for cancellation before each chunk.
  template <class Body>
  void each(std::uint64_t count, std::uint64_t grain, const Body& body,
            CodePlace where = CodePlace::current()) const {
    each_piece(
        count, grain, [&](const Chunk& c) { body(c.begin, c.end); }, where);
  }
  /// The same with the chunk's number, body(chunk, begin, end), for results that are combined in
  /// the order of chunks.
  template <class Body>
  void each_chunk(std::uint64_t count, std::uint64_t grain, const Body& body,
                  CodePlace where = CodePlace::current()) const {
    each_piece(
        count, grain, [&](const Chunk& c) { body(c.number, c.begin, c.end); }, where);
  }
  /// The same with the thread's lane, body(lane, begin, end), for scratch memory of threads.
  template <class Body>
  void each_in_lane(std::uint64_t count, std::uint64_t grain, const Body& body,
                    CodePlace where = CodePlace::current()) const {
    each_piece(
        count, grain, [&](const Chunk& c) { body(c.lane, c.begin, c.end); }, where);
  }
  /// Runs body(i) for every i below `count`, each as a chunk of its own.
  template <class Body>
  void each_item(std::uint64_t count, const Body& body,
                 CodePlace where = CodePlace::current()) const {
    each_piece(
        count, 1, [&](const Chunk& c) { body(c.begin); }, where);
  }

  const Options& options;
  Control control;
  unsigned threads;
  std::uint64_t budget;  ///< bytes

 private:
  template <class Body>
  void each_piece(std::uint64_t count, std::uint64_t grain, const Body& body,
                  CodePlace where) const {
    run_chunks(
        count, grain, threads,
        [&](const Chunk& chunk) {
      control.check();
      body(chunk);
        },
        where);
  }
};

/// One call of a public function: its Run, the registration with the helpers (CallScope) and the
/// reuse of memory pages (PageScope).
class Call {
 public:
  explicit Call(const Options& options) : run(options) {}
  /// `little`: the call takes less than little_memory.
  template <class Others>
  explicit Call(const Others& options, bool little = false)
      : options_(options_as<Options>(options)), run(*options_, little) {}
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

/// A Run for short work on the calling thread that need not be cancelled and takes little memory.
inline const Run& short_run() {
  static const Options options{.threads = 1};
  static const Run run(options, true);
  return run;
}

}  // namespace cullhull::internal
