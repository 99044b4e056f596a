// Keeps the process's global locks usable in a forked child, even if another thread of the parent
// held one of them during fork().
#pragma once

namespace cullhull::internal {

/// Holds a global lock during fork(). The child has none of the parent's other threads, so a lock
/// that one of them held would never be released, and the data behind it could be half changed.
/// fork() therefore waits until it can take the lock; parent and child release it afterwards.
/// Define guards at namespace scope, so that they exist before main. They do nothing on systems
/// without fork().
class ForkGuard {
 public:
  enum class Order {
    outer,  ///< locks held while foreign libraries are called or `inner` locks are taken
    inner,  ///< locks held briefly, without taking another lock
  };

  /// `unlock_in_child` replaces `unlock` in the child, where the calling thread is the only one.
  ForkGuard(Order order, void (*lock)(), void (*unlock)(), void (*unlock_in_child)());
  ForkGuard(Order order, void (*lock)(), void (*unlock)())
      : ForkGuard(order, lock, unlock, unlock) {}
  ForkGuard(const ForkGuard&) = delete;
  ForkGuard& operator=(const ForkGuard&) = delete;

 private:
  friend class ForkGuards;
  void (*const lock_)();
  void (*const unlock_)();
  void (*const unlock_in_child_)();
  ForkGuard* next_;
};

}  // namespace cullhull::internal
