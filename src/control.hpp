// Cancellation and progress, handed down to long loops.
#pragma once

#include "cullhull/error.hpp"
#include "cullhull/options.hpp"

namespace cullhull::internal {

class Control {
 public:
  explicit Control(const Options& options) : progress_(&options.progress), stop_(options.stop) {}
  /// Throws Error{cancelled} if the caller asked to stop. Cheap: call it every few thousand steps.
  void check() const {
    if (stop_.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
  }
  /// From the calling thread only.
  void report(const char* phase, double share) const {
    if (*progress_) (*progress_)(phase, share);
  }

 private:
  const Progress* progress_;
  std::stop_token stop_;
};

}  // namespace cullhull::internal
