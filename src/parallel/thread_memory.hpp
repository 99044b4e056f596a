// Memory for the length of one step, kept by each thread for the next: where a call of microseconds
// needs more than belongs on a stack, asking for it anew would take as long as the work.
#pragma once

#include <memory>

namespace cullhull::internal {

/// This thread's own T, with whatever the last user left in it. Who uses it must not call anything
/// that might use the same T on the same thread.
template <class T>
T& thread_memory() {
  thread_local const std::unique_ptr<T> memory(new T);
  return *memory;
}

}  // namespace cullhull::internal
