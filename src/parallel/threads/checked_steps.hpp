// Checks for cancellation within a loop that one thread runs, such as a sort.
#pragma once

#include <cstdint>

#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// Counts steps of a serial loop, each of at most some tens of nanoseconds, and checks for
/// cancellation every 65,536 of them: every few milliseconds. A comparison of std::sort may call
/// next(), as the order of the items does not matter once it throws.
class CheckedSteps {
 public:
  explicit CheckedSteps(const Run& run) : run_(run) {}
  CheckedSteps(const CheckedSteps&) = delete;
  CheckedSteps& operator=(const CheckedSteps&) = delete;

  static constexpr std::uint32_t between_checks = 1U << 16;

  /// Counts a step that takes as long as `steps`. Throws Error{cancelled}.
  void next(std::uint32_t steps = 1) {
    left_ -= steps < left_ ? steps : left_;
    if (left_ > 0) return;
    left_ = between_checks;
    run_.check();
  }

 private:
  const Run& run_;
  std::uint32_t left_ = between_checks;
};

}  // namespace cullhull::internal
