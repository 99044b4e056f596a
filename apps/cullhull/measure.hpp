// Times and memory of a run.
#pragma once

#include <chrono>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "arguments.hpp"
#include "cullhull/point_view.hpp"
#include "signals.hpp"
#include "terminal.hpp"
#include "timing.hpp"

namespace app {

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Reads every page of a mapped input into memory; returns the seconds that took, which count as
/// reading, not computing. Skipped where it would fill more than half of the memory.
double warm_pages(const cullhull::PointView& points);

/// Largest resident set of this process so far, mapped input included.
std::uint64_t peak_bytes();

/// The number of threads that a request gets; 0: all the machine offers.
unsigned threads_used(unsigned requested);

using cullhull::bench::median;

/// Index of the run whose time is the median (the lower one of an even number).
std::size_t median_run(const std::vector<double>& seconds);

/// The last of several results, and the time of each.
template <class Result>
struct Repeated {
  Result result;
  std::vector<double> seconds;
};

/// Runs compute(options) `times` times, with progress, until a signal, as `arguments` say.
template <class Compute>
auto repeat(const RunArguments& arguments, unsigned times, const Compute& compute) {
  Repeated<std::invoke_result_t<Compute, const cullhull::Options&>> done;
  cullhull::Options options = arguments.options();
  TerminalProgress progress(arguments.quiet);
  options.progress = progress.callback();
  cancellable([&] {
    naming_held(arguments.held, [&] {
      for (unsigned k = 0; k < times; ++k) {
        done.result = {};  // one result in memory at a time
        const Stopwatch watch;
        done.result = compute(options);
        done.seconds.push_back(watch.seconds());
      }
    });
  });
  return done;
}

}  // namespace app
