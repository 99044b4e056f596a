// Threads that share a caller's work where they are free: the caller goes on with the work itself,
// and waits at the end for nothing but what a helper has begun.
#pragma once

#include <memory>

namespace cullhull::internal::inline parallel {

/// Processors this process may run on; asked once.
unsigned machine_threads();

/// Work that helpers can join.
class SharedWork {
 public:
  virtual ~SharedWork() = default;
  /// Does the items that nobody has begun. `k` numbers those who join, from 1 on. May run after the
  /// caller has returned: then no item may be left.
  virtual void join(unsigned k) noexcept = 0;
};

/// Work that helpers may join while this lives.
class OpenWork {
 public:
  /// Asks for `helpers` of them. Fewer join where as many calls are at work as the machine has
  /// processors (CallScope), or while they help others: perhaps none. On a busy machine (crowded())
  /// only `lasting` work, which checks that itself, is opened.
  OpenWork(unsigned helpers, const std::shared_ptr<SharedWork>& work, bool lasting = false);
  /// Nobody can join any more; those who did may still be running.
  ~OpenWork();
  OpenWork(const OpenWork&) = delete;
  OpenWork& operator=(const OpenWork&) = delete;

 private:
  const SharedWork* open_ = nullptr;
};

/// A call at work. While there are as many calls as processors, no helper joins any: all processors
/// are busy. Within another call of the same thread it has no effect.
class CallScope {
 public:
  CallScope();
  ~CallScope();
  CallScope(const CallScope&) = delete;
  CallScope& operator=(const CallScope&) = delete;

 private:
  const bool outermost_;
};

/// Waits for another thread: spins at first, then yields, then sleeps briefly, so that a thread
/// without a processor gets this one.
class Patience {
 public:
  void wait_a_little();

 private:
  unsigned turns_ = 0;
};

}  // namespace cullhull::internal::inline parallel
