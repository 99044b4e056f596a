// Threads for algorithms of very many short parallel phases (tens of microseconds): helpers wait
// for the next phase awake, so that a phase costs about a microsecond to begin and to end.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>

namespace cullhull::internal {

class Crew {
 public:
  /// At most `threads` workers, the caller being one of them.
  explicit Crew(unsigned threads);
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  /// Numbers of workers, the caller's being 0, are below this.
  unsigned lanes() const { return lanes_; }

  /// main() on the calling thread; during it run() has helpers, as far as the machine has threads
  /// to spare. Exceptions of main pass through.
  void session(const std::function<void()>& main);

  /// body(item, lane) for every item of [0, count), count < 2^20, each once; no two at a time with
  /// the same lane. Only from main() of a session. An exception of body passes through when all
  /// items are done.
  void run(std::uint32_t count, const std::function<void(std::uint32_t, unsigned)>& body);

 private:
  void help(unsigned lane);
  bool work(unsigned lane);

  unsigned lanes_;
  /// Phase, number of items, next item: one word, so that nobody takes an item of a phase that is
  /// over.
  alignas(64) std::atomic<std::uint64_t> ticket_{0};
  alignas(64) std::atomic<std::uint32_t> done_{0};
  std::atomic<bool> over_{false};
  const std::function<void(std::uint32_t, unsigned)>* body_ = nullptr;
  std::exception_ptr error_;
  std::atomic<bool> failed_{false};
};

}  // namespace cullhull::internal
