// Scratch memory that each thread keeps from one step to the next: in a call of microseconds that
// needs more than fits a stack, allocating would take as long as the work.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace cullhull::internal::inline parallel {

/// One thread's object of one type.
class ThreadMemory {
 public:
  ThreadMemory() { all().push_back(this); }
  virtual ~ThreadMemory() { std::erase(all(), this); }
  ThreadMemory(const ThreadMemory&) = delete;
  ThreadMemory& operator=(const ThreadMemory&) = delete;

  virtual void drop() noexcept = 0;
  virtual bool empty() const noexcept = 0;

  /// Those of the calling thread.
  static std::vector<ThreadMemory*>& all() {
    thread_local std::vector<ThreadMemory*> list;
    return list;
  }
};

/// This thread's own T, with the contents that the last user left. Its user must not call anything
/// that may use the same T on the same thread.
template <class T>
T& thread_memory() {
  struct Kept final : ThreadMemory {
    ~Kept() override = default;
    void drop() noexcept override { memory.reset(); }
    bool empty() const noexcept override { return memory == nullptr; }
    std::unique_ptr<T> memory;
  };
  thread_local Kept kept;
  if (kept.memory == nullptr) kept.memory.reset(new T);
  return *kept.memory;
}

/// Frees what thread_memory() keeps for the calling thread, outside of any use of it.
inline void drop_thread_memory() noexcept {
  for (ThreadMemory* kept : ThreadMemory::all()) kept->drop();
}

/// Number of types the calling thread keeps.
inline std::size_t thread_memories() noexcept {
  std::size_t count = 0;
  for (const ThreadMemory* kept : ThreadMemory::all()) count += kept->empty() ? 0 : 1;
  return count;
}

}  // namespace cullhull::internal::inline parallel
