#include "parallel/threads/fork_guard.hpp"

#if (defined(__unix__) || defined(__APPLE__)) && !defined(__EMSCRIPTEN__)
#define CULLHULL_FORKS
#include <pthread.h>
#endif

namespace cullhull::internal {

/// All guards, in one linked list for each order. The heads are initialised at compile time, so
/// that guards of any source file can be added before main.
class ForkGuards {
 public:
  static ForkGuard* add(ForkGuard::Order order, ForkGuard* guard) {
    if (outer == nullptr && inner == nullptr) handle_forks();
    ForkGuard*& head = order == ForkGuard::Order::outer ? outer : inner;
    ForkGuard* const next = head;
    head = guard;
    return next;
  }

 private:
  static void handle_forks() {
#ifdef CULLHULL_FORKS
    pthread_atfork(
        [] {
      for (const ForkGuard* g = outer; g != nullptr; g = g->next_) g->lock_();
      for (const ForkGuard* g = inner; g != nullptr; g = g->next_) g->lock_();
        },
        [] {
      for (const ForkGuard* g = inner; g != nullptr; g = g->next_) g->unlock_();
      for (const ForkGuard* g = outer; g != nullptr; g = g->next_) g->unlock_();
    },
        [] {
      for (const ForkGuard* g = inner; g != nullptr; g = g->next_) g->unlock_in_child_();
      for (const ForkGuard* g = outer; g != nullptr; g = g->next_) g->unlock_in_child_();
        });
#endif
  }

  static constinit inline ForkGuard* outer = nullptr;
  static constinit inline ForkGuard* inner = nullptr;
};

ForkGuard::ForkGuard(Order order, void (*lock)(), void (*unlock)(), void (*unlock_in_child)())
    : lock_(lock),
      unlock_(unlock),
      unlock_in_child_(unlock_in_child),
      next_(ForkGuards::add(order, this)) {}

}  // namespace cullhull::internal
