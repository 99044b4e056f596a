// Threads that help callers with their work, as far as they come in time: whoever asks goes on with
// the work itself, and waits at the end for nothing but what a helper has begun.
#pragma once

#include <memory>

namespace cullhull::internal {

/// Processors this process may run on; asked once.
unsigned machine_threads();

/// Work that helpers can join.
class SharedWork {
 public:
  virtual ~SharedWork() = default;
  /// Does of the work what nobody else has begun. `k` tells apart who joined: from 1 on. May begin
  /// when the caller is gone: then there must be nothing left to do.
  virtual void join(unsigned k) noexcept = 0;
};

/// Work that helpers may join while this lives.
class OpenWork {
 public:
  /// Asks for `helpers` of them. Fewer come where the machine has no more processors than there are
  /// calls at work (CallScope), or while they help others: perhaps none. On a crowded machine only
  /// `lasting` work, which looks at crowded() itself, is opened.
  OpenWork(unsigned helpers, const std::shared_ptr<SharedWork>& work, bool lasting = false);
  /// Nobody joins any more; those who did may still be there.
  ~OpenWork();
  OpenWork(const OpenWork&) = delete;
  OpenWork& operator=(const OpenWork&) = delete;

 private:
  const SharedWork* open_ = nullptr;
};

/// A call at work. While there are as many as processors, nobody helps: all are busy.
class CallScope {
 public:
  CallScope();
  ~CallScope();
  CallScope(const CallScope&) = delete;
  CallScope& operator=(const CallScope&) = delete;
};

/// Waits for another thread: awake at first, then offering the processor, then in short sleeps, so
/// that a thread that has no processor gets this one.
class Patience {
 public:
  void wait_a_little();

 private:
  unsigned turns_ = 0;
};

}  // namespace cullhull::internal
