// Threads for algorithms of many short parallel phases: the same workers over and over, without
// setting up an arena each time.
#pragma once

#include <functional>
#include <memory>

namespace cullhull::internal {

class Crew {
 public:
  /// At most `threads` workers, the caller being one of them.
  explicit Crew(unsigned threads);
  ~Crew();
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  /// Number of lanes of run().
  unsigned lanes() const { return lanes_; }

  /// body(lane) for every lane of [0, lanes()), in parallel as far as workers are free. Exceptions
  /// pass through, one of them.
  void run(const std::function<void(unsigned lane)>& body);

 private:
  struct Arena;
  unsigned lanes_;
  std::unique_ptr<Arena> arena_;
};

}  // namespace cullhull::internal
