// Cancellation and progress, handed down to long loops.
#pragma once

#include <thread>

#include "cullhull/error.hpp"
#include "cullhull/options.hpp"

namespace cullhull::internal::inline parallel {

class Control {
 public:
  /// Made on the calling thread; views the options, which must outlive it.
  explicit Control(const Options& options)
      : progress_(&options.progress),
        poll_(options.poll ? &options.poll : nullptr),
        stop_(options.stop) {
    if (poll_ != nullptr) caller_ = std::this_thread::get_id();
  }
  /// Throws Error{cancelled} if the caller asked to stop. Cheap: call it every few thousand steps.
  void check() const {
    if (poll_ != nullptr && std::this_thread::get_id() == caller_) (*poll_)();
    if (stop_.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
  }
  /// From the calling thread only.
  void report(const char* phase, double share) const {
    if (*progress_) (*progress_)(phase, share);
  }

 private:
  const Progress* progress_;
  const Poll* poll_;
  std::thread::id caller_;
  std::stop_token stop_;
};

}  // namespace cullhull::internal::inline parallel
