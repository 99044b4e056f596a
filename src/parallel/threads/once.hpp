// What is made when it is first asked for.
#pragma once

#include <atomic>
#include <mutex>

namespace cullhull::internal {

/// Calls a function once, whichever thread asks first; all wait for its end. Where it throws, the
/// next call calls its function again. std::call_once would do, but under MinGW-w64 an exception
/// leaves its lock held, and the next call waits for ever.
class Once {
 public:
  template <class Make>
  void call(Make&& make) {
    if (done_.load(std::memory_order_acquire)) return;
    const std::lock_guard lock(mutex_);
    if (done_.load(std::memory_order_relaxed)) return;
    make();
    done_.store(true, std::memory_order_release);
  }

 private:
  std::mutex mutex_;
  std::atomic<bool> done_ = false;
};

}  // namespace cullhull::internal
