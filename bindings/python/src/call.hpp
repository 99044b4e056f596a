// How a call from Python runs: options, the GIL, progress, Ctrl-C, exceptions.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "cullhull/error.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

namespace binding {

/// The settings of a long function besides its own arguments; made once a call in Python.
struct Settings {
  cullhull::Options options;
  nanobind::object progress;  ///< None, or called as progress(phase, share) on the calling thread

  bool shows_progress() const { return progress.is_valid() && !progress.is_none(); }
};

/// Functions take a pointer, which is null for None, the default.
const Settings& settings_or_default(const Settings* settings);

/// How long a call may take, judged by its sizes.
enum class Length {
  tiny,      ///< a microsecond or two
  brief,     ///< well below a millisecond
  moderate,  ///< usually some tens of milliseconds; more in the worst case
  long_,     ///< perhaps seconds
};

/// For work whose time these points decide, as that of a hull or of a pass over them.
Length length_of(const cullhull::PointView& points) noexcept;
/// For a hull of these points and nothing else.
Length length_of_hull(const cullhull::PointView& points) noexcept;
/// For so many queries to a hull of so many simplices.
Length length_of(const cullhull::PointView& points, std::uint64_t simplices) noexcept;

/// Runs `work` without the GIL; an exception from a signal handler (KeyboardInterrupt, say) or from
/// `progress` stops the work and is thrown when it has stopped. Tiny work keeps the GIL: handing it
/// over and getting it back takes as long, several times that where other threads wait. Brief work
/// simply runs: starting a thread, or looking up a signal handler, takes longer. Moderate work runs
/// on this thread, which checks for signals now and then (Options::poll). Long work, and any with
/// `progress`, runs on another thread while this one waits.
void run(const Settings* settings, Length length,
         const std::function<void(const cullhull::Options&)>& work);
/// The same for work that returns its result.
template <class Work>
auto computed(const Settings* settings, Length length, const Work& work) {
  std::optional<std::invoke_result_t<const Work&, const cullhull::Options&>> result;
  run(settings, length, [&](const cullhull::Options& options) { result.emplace(work(options)); });
  return std::move(*result);
}

/// For objects that only one thread at a time may use: a second thread gets an error instead of a
/// data race.
class Busy {
 public:
  /// Throws Error{invalid_argument} where another thread uses the object; `doing` completes
  /// "another thread is ...".
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
