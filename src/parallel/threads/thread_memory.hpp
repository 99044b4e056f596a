// Scratch memory that each thread keeps for its next calls. In a call of a few microseconds that
// needs more memory than fits on the stack, allocating would take as long as the work.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace cullhull::internal {

/// Owner of one thread's scratch object of one type; registers itself in that thread's list.
class ThreadMemory {
 public:
  ThreadMemory() { all().push_back(this); }
  virtual ~ThreadMemory() { std::erase(all(), this); }
  ThreadMemory(const ThreadMemory&) = delete;
  ThreadMemory& operator=(const ThreadMemory&) = delete;

  /// Destroys the scratch object.
  virtual void drop() noexcept = 0;
  virtual bool empty() const noexcept = 0;

  /// All owners of the calling thread.
  static std::vector<ThreadMemory*>& all() {
    thread_local std::vector<ThreadMemory*> list;
    return list;
  }
};

/// The calling thread's scratch object of type T, with the contents that its last user left. While
/// using it, do not call functions that may use the same T on the same thread.
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

/// Frees the calling thread's scratch objects. None of them may be in use.
inline void drop_thread_memory() noexcept {
  for (ThreadMemory* kept : ThreadMemory::all()) kept->drop();
}

/// The number of scratch objects that the calling thread keeps.
inline std::size_t thread_memories() noexcept {
  std::size_t count = 0;
  for (const ThreadMemory* kept : ThreadMemory::all()) count += kept->empty() ? 0 : 1;
  return count;
}

}  // namespace cullhull::internal
