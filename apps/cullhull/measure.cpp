#include "measure.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <thread>

namespace app {

double warm_pages(const cullhull::PointView& points) {
  const Stopwatch watch;
  if (points.count == 0 || points.dimension == 0) return 0;
  const std::byte* ends[] = {points.address(0, 0), points.address(points.count - 1, 0),
                             points.address(0, points.dimension - 1),
                             points.address(points.count - 1, points.dimension - 1)};
  const auto [first, last] = std::minmax_element(std::begin(ends), std::end(ends));
  const auto page = static_cast<std::ptrdiff_t>(::sysconf(_SC_PAGESIZE));
  // What does not fit beside the work would be pushed out again before it is used.
  if ((*last - *first) / page > ::sysconf(_SC_PHYS_PAGES) / 2) return 0;
  unsigned sum = 0;
  for (std::ptrdiff_t offset = 0; offset < *last - *first; offset += page)
    sum += static_cast<unsigned>((*first)[offset]);
  sum += static_cast<unsigned>(**last);
  [[maybe_unused]] static volatile unsigned sink;
  sink = sum;  // the reads must happen
  return watch.seconds();
}

std::uint64_t peak_bytes() {
  // getrusage would count what the parent held before it became us.
  if (std::FILE* file = std::fopen("/proc/self/status", "re")) {
    char line[256];
    unsigned long long kilobytes = 0;
    bool found = false;
    while (!found && std::fgets(line, sizeof line, file) != nullptr)
      found = std::sscanf(line, "VmHWM: %llu kB", &kilobytes) == 1;
    std::fclose(file);
    if (found) return kilobytes * 1024;
  }
  rusage usage = {};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

unsigned threads_used(unsigned requested) {
  return requested != 0 ? requested : std::max(1U, std::thread::hardware_concurrency());
}

std::size_t median_run(const std::vector<double>& seconds) {
  std::vector<std::size_t> order(seconds.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return seconds[a] < seconds[b]; });
  return order[(order.size() - 1) / 2];
}

}  // namespace app
