#include "qhull.hpp"

#include <algorithm>

#ifdef CULLHULL_HAVE_QHULL
#include <libqhull_r/qhull_ra.h>

#include <chrono>
#include <cstdio>
#include <memory>
#endif

namespace cullhull::bench {

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

#ifdef CULLHULL_HAVE_QHULL

std::optional<QhullRun> run_qhull(const PointView& points, unsigned repeat) {
  QhullRun run;
  std::vector<double> times;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> nowhere(std::fopen("/dev/null", "w"),
                                                                std::fclose);
  if (nowhere == nullptr) return std::nullopt;
  bool done = true;
  for (unsigned k = 0; k < repeat; ++k) {
    qhT q;
    qh_zero(&q, nowhere.get());
    char command[] = "qhull Qt";
    // Qhull reads the points where they are and does not change them without QJ or Qz.
    auto* data = reinterpret_cast<coordT*>(const_cast<std::byte*>(points.data));
    const auto start = std::chrono::steady_clock::now();
    const int code =
        qh_new_qhull(&q, static_cast<int>(points.dimension), static_cast<int>(points.count), data,
                     0, command, nowhere.get(), nowhere.get());
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    times.push_back(took.count());
    if (code == 0) {
      qh_getarea(&q, q.facet_list);
      run.volume = q.totvol;
      run.vertices = static_cast<std::uint64_t>(q.num_vertices);
    }
    done = done && code == 0;
    qh_freeqhull(&q, !qh_ALL);
    int short_memory = 0, long_memory = 0;
    qh_memfreeshort(&q, &short_memory, &long_memory);
  }
  run.seconds = median(times);
  return done ? std::optional(run) : std::nullopt;
}

#else

std::optional<QhullRun> run_qhull(const PointView&, unsigned) { return std::nullopt; }

#endif

}  // namespace cullhull::bench
