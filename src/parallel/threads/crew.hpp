// Threads for algorithms of very many short parallel phases (tens of microseconds): helpers spin
// while they wait for the next phase, so that a phase costs about a microsecond to begin and to
// end.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

namespace cullhull::internal::inline parallel {

class Crew {
 public:
  /// At most `threads` workers, the caller being one of them.
  explicit Crew(unsigned threads);
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  /// Numbers of workers, the caller's being 0, are below this.
  unsigned lanes() const { return lanes_; }

  /// Runs main() on the calling thread; meanwhile run() has helpers, as many as the machine has
  /// idle threads, from when they arrive. Exceptions of main pass through.
  void session(const std::function<void()>& main);

  /// body(item, lane) for every item of [0, count), count < 2^20, each once; no two at a time with
  /// the same lane. Only from main() of a session. An exception of body passes through when all
  /// items are done.
  void run(std::uint32_t count, const std::function<void(std::uint32_t, unsigned)>& body);

 private:
  class Phases;

  unsigned lanes_;
  std::shared_ptr<Phases> phases_;  // of the session
};

}  // namespace cullhull::internal::inline parallel
