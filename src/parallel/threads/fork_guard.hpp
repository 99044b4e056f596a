// Locks of the process, which a forked child must find free whichever thread held them.
#pragma once

namespace cullhull::internal::inline parallel {

/// Keeps the lock of something that the process has one of while it is forked: the child has none
/// of the threads that could release it, and finds what it guards whole. fork() waits for whoever
/// holds it. Made before main, at namespace scope; nothing where processes are not forked.
class ForkGuard {
 public:
  enum class Order {
    outer,  ///< held while foreign libraries are called, or locks of `inner` are taken
    inner,  ///< held briefly, alone
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

}  // namespace cullhull::internal::inline parallel
