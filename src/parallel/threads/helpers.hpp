// Helpers: the process's own threads, which join the work of a caller when they are idle. The
// caller does the work too, and at the end waits only for items that helpers have begun.
#pragma once

#include <memory>

namespace cullhull::internal {

/// The number of the machine's hardware threads, at least 1; determined once.
unsigned machine_threads();

/// Work that helpers can join.
class SharedWork {
 public:
  virtual ~SharedWork() = default;
  /// Does items that no thread has begun, until there are none. `k` numbers the helpers that join,
  /// from 1 on. A helper may call it after the caller has returned; it must then find no item.
  virtual void join(unsigned k) noexcept = 0;
};

/// Lets helpers join a SharedWork during the lifetime of this object.
class OpenWork {
 public:
  /// Requests `helpers` helpers. Fewer or none join if other calls (CallScope) need the processors
  /// or if helpers are at work for other callers. On a busy machine (crowded()) none does.
  OpenWork(unsigned helpers, const std::shared_ptr<SharedWork>& work);
  /// Ends joining. Helpers that have joined may still be running.
  ~OpenWork();
  OpenWork(const OpenWork&) = delete;
  OpenWork& operator=(const OpenWork&) = delete;

 private:
  const SharedWork* open_ = nullptr;
};

/// Counts a running call of the library during its lifetime. While there are as many calls as
/// processors, no helper joins any of them, since all processors are busy. Has no effect within
/// another CallScope of the same thread.
class CallScope {
 public:
  CallScope();
  ~CallScope();
  CallScope(const CallScope&) = delete;
  CallScope& operator=(const CallScope&) = delete;

 private:
  const bool outermost_;
};

/// The steps of waiting for another thread: the first calls of wait_a_little() spin, later ones
/// yield, still later ones sleep briefly, so that a thread without a processor gets this one.
class Patience {
 public:
  void wait_a_little();

 private:
  unsigned turns_ = 0;
};

}  // namespace cullhull::internal
