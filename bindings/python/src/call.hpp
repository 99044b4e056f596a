// How a call from Python runs: options, the GIL, progress, Ctrl-C, exceptions.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <functional>
#include <string>

#include "cullhull/error.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

namespace binding {

/// What every long function takes besides its own arguments; built once a call by the Python side.
struct Settings {
  cullhull::Options options;
  nanobind::object progress;  ///< None, or called as progress(phase, share) on the calling thread
};

/// Runs `work` without the GIL. Long work runs on a thread of its own while this one waits, calls
/// `progress` and looks for signals: an exception from either (KeyboardInterrupt, say) stops the
/// work and is thrown when it has stopped. `brief` work (see is_brief) is not worth a thread and
/// runs right here.
void run(const Settings& settings, bool brief,
         const std::function<void(const cullhull::Options&)>& work);

/// For objects that are not for two threads at once: a second one that comes meanwhile is an error
/// rather than a race.
class Busy {
 public:
  /// Throws Error{invalid_argument} where somebody is busy already; `doing` completes "another
  /// thread is ...".
  Busy(std::atomic<bool>& flag, const char* doing) : flag_(flag) {
    if (flag_.exchange(true))
      throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                            std::string("another thread is ") + doing);
  }
  ~Busy() { flag_ = false; }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  std::atomic<bool>& flag_;
};

/// Whether a hull of these points takes a few milliseconds at most, so that nobody waits for it.
bool is_brief(const cullhull::PointView& points) noexcept;

void bind_call(nanobind::module_& m);

}  // namespace binding
