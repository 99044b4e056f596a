#include "measure.hpp"

#include <algorithm>
#include <numeric>
#include <thread>

#include "system.hpp"

namespace app {

double warm_pages(const cullhull::PointView& points) {
  const Stopwatch watch;
  if (points.count == 0 || points.dimension == 0) return 0;
  const std::byte* ends[] = {points.address(0, 0), points.address(points.count - 1, 0),
                             points.address(0, points.dimension - 1),
                             points.address(points.count - 1, points.dimension - 1)};
  const auto [first, last] = std::minmax_element(std::begin(ends), std::end(ends));
  const auto page = static_cast<std::ptrdiff_t>(system::page_bytes());
  // A file that does not fit beside the work would be evicted before it is used.
  if (static_cast<std::uint64_t>(*last - *first) > system::memory_bytes() / 2) return 0;
  unsigned sum = 0;
  for (std::ptrdiff_t offset = 0; offset < *last - *first; offset += page)
    sum += static_cast<unsigned>((*first)[offset]);
  sum += static_cast<unsigned>(**last);
  [[maybe_unused]] static volatile unsigned sink;
  sink = sum;  // keeps the compiler from removing the reads
  return watch.seconds();
}

std::uint64_t peak_bytes() { return system::peak_bytes(); }

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
