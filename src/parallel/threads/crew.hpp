// Threads for algorithms of very many short parallel phases, each of some tens of microseconds.
// Helpers spin while they wait for the next phase, so that beginning and ending a phase takes about
// a microsecond.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "parallel/threads/span_account.hpp"

namespace cullhull::internal {

/// The calling thread and the helpers that join it for a session, a sequence of parallel phases.
class Crew {
 public:
  /// At most `threads` threads work, including the caller.
  explicit Crew(unsigned threads);
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  /// The greatest number of threads that work. Each has a lane, a number below lanes(); the
  /// caller's is 0.
  unsigned lanes() const { return lanes_; }

  /// Runs main() on the calling thread. While main() runs, helpers join as far as the machine has
  /// idle processors, and take part in the phases that main() starts with run(). Passes on
  /// exceptions of main.
  void session(const std::function<void()>& main);

  /// Runs one phase: calls body(item, lane) once for every item of [0, count), count < 2^20, never
  /// twice at the same time with the same lane, and returns when all calls have returned. May be
  /// called only from main() of a session. If calls throw, rethrows one of their exceptions after
  /// all items are done.
  void run(std::uint32_t count, const std::function<void(std::uint32_t, unsigned)>& body,
           spans::Where where = spans::Where::current());

 private:
  class Phases;

  unsigned lanes_;
  std::shared_ptr<Phases> phases_;  // of the current session
};

}  // namespace cullhull::internal
