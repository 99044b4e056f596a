#include "qhull.hpp"

#ifdef CULLHULL_HAVE_QHULL
#include <libqhull_r/qhull_ra.h>

#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "timing.hpp"
#endif

namespace cullhull::bench {

#ifdef CULLHULL_HAVE_QHULL
namespace {

struct Figures {
  double seconds, volume;
  std::uint64_t vertices;
};

template <class T>
std::string bytes_of(const T& figures) {
  std::string bytes(sizeof figures, '\0');
  std::memcpy(bytes.data(), &figures, sizeof figures);
  return bytes;
}

/// The seconds and the number of simplices, as the bytes of doubles. For a process that ends
/// afterwards, so nothing is freed. Qz and Qbb change the points, but only in the forked process.
std::string triangulate_once(const PointView& points) {
  std::FILE* nowhere = std::fopen("/dev/null", "w");
  if (nowhere == nullptr) throw std::runtime_error("/dev/null");
  auto q = std::make_unique<qhT>();
  qh_zero(q.get(), nowhere);
  std::string command = points.dimension < 5 ? "qhull d Qbb Qc Qz Q12" : "qhull d Qbb Qc Qz Qx Q12";
  std::vector<double> rows(points.count * points.dimension);
  std::memcpy(rows.data(), points.data, rows.size() * sizeof(double));
  int code = 0;
  double figures[2] = {0, 0};
  figures[0] = seconds_of([&] {
    code = qh_new_qhull(q.get(), static_cast<int>(points.dimension), static_cast<int>(points.count),
                        rows.data(), 0, command.data(), nowhere, nowhere);
    if (code == 0) qh_triangulate(q.get());
  });
  if (code != 0) throw std::runtime_error("qhull");
  for (const facetT* f = q->facet_list; f != nullptr && f->next != nullptr; f = f->next)
    figures[1] += f->upperdelaunay ? 0 : 1;
  return bytes_of(figures);
}

/// The bytes of Figures. For a process that ends afterwards, so nothing is freed.
std::string hull_once(const PointView& points) {
  std::FILE* nowhere = std::fopen("/dev/null", "w");
  if (nowhere == nullptr) throw std::runtime_error("/dev/null");
  auto q = std::make_unique<qhT>();
  qh_zero(q.get(), nowhere);
  char command[] = "qhull Qt";
  // Qhull reads the points in place and does not change them without QJ or Qz.
  auto* data = reinterpret_cast<coordT*>(const_cast<std::byte*>(points.data));
  int code = 0;
  Figures figures{};
  figures.seconds = seconds_of([&] {
    code = qh_new_qhull(q.get(), static_cast<int>(points.dimension), static_cast<int>(points.count),
                        data, 0, command, nowhere, nowhere);
  });
  if (code != 0) throw std::runtime_error("qhull");
  qh_getarea(q.get(), q->facet_list);
  figures.volume = q->totvol;
  figures.vertices = static_cast<std::uint64_t>(q->num_vertices);
  return bytes_of(figures);
}

}  // namespace

std::optional<QhullRun> run_qhull(const PointView& points, const ChildLimits& limits) {
  const std::optional<ChildRun> child = run_forked([&] { return hull_once(points); }, limits);
  if (!child) return std::nullopt;
  if (child->timed_out) return QhullRun{limits.seconds, 0, 0, false};
  Figures figures{};
  if (child->output.size() != sizeof figures) return std::nullopt;
  std::memcpy(&figures, child->output.data(), sizeof figures);
  return QhullRun{figures.seconds, figures.volume, figures.vertices, true};
}

std::optional<LiftedRun> run_qhull_delaunay(const PointView& points, const ChildLimits& limits) {
  return lifted_run(run_forked([&] { return triangulate_once(points); }, limits), limits);
}

bool has_qhull() { return true; }

double qhull_seconds(const PointView& points) {
  static std::FILE* const nowhere = std::fopen("/dev/null", "w");
  auto* data = reinterpret_cast<coordT*>(const_cast<std::byte*>(points.data));
  char command[] = "qhull Qt";
  return seconds_of([&] {
    qhT qh;
    qh_zero(&qh, nowhere);
    qh_new_qhull(&qh, static_cast<int>(points.dimension), static_cast<int>(points.count), data, 0,
                 command, nowhere, nowhere);
    int blocks = 0, bytes = 0;
    qh_freeqhull(&qh, !qh_ALL);
    qh_memfreeshort(&qh, &blocks, &bytes);
  });
}

#else

std::optional<QhullRun> run_qhull(const PointView&, const ChildLimits&) { return std::nullopt; }
std::optional<LiftedRun> run_qhull_delaunay(const PointView&, const ChildLimits&) {
  return std::nullopt;
}
bool has_qhull() { return false; }
double qhull_seconds(const PointView&) { return 0; }

#endif

}  // namespace cullhull::bench
