// How a call from Python runs: options, the GIL, progress, Ctrl-C, exceptions.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <cstdint>
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

  bool shows_progress() const { return progress.is_valid() && !progress.is_none(); }
};

/// Functions take a pointer, which is null for None: what most callers choose.
const Settings& settings_or_default(const Settings* settings);

/// How long work may take, as far as its size tells.
enum class Length {
  brief,     ///< well below a millisecond
  moderate,  ///< some tens of milliseconds as a rule; more in the worst case
  long_,     ///< perhaps seconds
};

/// Of a hull of these points, or of a look at each of them.
Length length_of(const cullhull::PointView& points) noexcept;
/// Of that many questions to a hull of so many simplices.
Length length_of(const cullhull::PointView& points, std::uint64_t simplices) noexcept;

/// Runs `work` without the GIL; an exception from a signal handler (KeyboardInterrupt, say) or from
/// `progress` stops the work and is thrown when it has stopped. Brief work just runs: who waits
/// for a thread, or for a handler to be looked up, waits longer. Moderate work runs on this thread,
/// which looks for signals now and then (Options::poll). Long work, and any with `progress`, runs
/// on a thread of its own while this one waits.
void run(const Settings* settings, Length length,
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

void bind_call(nanobind::module_& m);

}  // namespace binding
