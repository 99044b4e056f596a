// std::stop_token, also where the standard library does not have it (libc++ before 20).
#pragma once

#include <version>

#include "cullhull/version.hpp"

#ifdef __cpp_lib_jthread

#include <stop_token>

namespace cullhull {
using std::stop_source;
using std::stop_token;
}  // namespace cullhull

#else

#include <atomic>
#include <memory>
#include <utility>

#pragma GCC visibility push(default)
namespace cullhull {

/// Whether a stop was requested of the source that it came from. Copies share the state; thread
/// safe. A default one has no source and is never stopped.
class stop_token {
 public:
  stop_token() noexcept = default;
  bool stop_requested() const noexcept { return state_ && state_->load(); }
  bool stop_possible() const noexcept { return state_ != nullptr; }

 private:
  friend class stop_source;
  explicit stop_token(std::shared_ptr<std::atomic<bool> > state) : state_(std::move(state)) {}
  std::shared_ptr<std::atomic<bool> > state_;
};

class stop_source {
 public:
  stop_source() : state_(std::make_shared<std::atomic<bool> >(false)) {}
  stop_token get_token() const noexcept { return stop_token(state_); }
  /// True if this call was the first to request it.
  bool request_stop() noexcept { return !state_->exchange(true); }
  bool stop_requested() const noexcept { return state_->load(); }

 private:
  std::shared_ptr<std::atomic<bool> > state_;
};

}  // namespace cullhull
#pragma GCC visibility pop

#endif
