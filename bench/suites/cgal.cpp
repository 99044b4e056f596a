#include "cgal.hpp"

#include <algorithm>
#include <cstring>

#include "cullhull/io.hpp"

namespace cullhull::bench {
namespace {

/// Pointers to the rows in lexicographic order; -0 equals 0.
std::vector<const double*> sorted_rows(const std::vector<double>& rows, unsigned d) {
  std::vector<const double*> order;
  for (std::size_t i = 0; i + d <= rows.size(); i += d) order.push_back(rows.data() + i);
  std::sort(order.begin(), order.end(), [d](const double* a, const double* b) {
    return std::lexicographical_compare(a, a + d, b, b + d);
  });
  return order;
}

}  // namespace

std::string cgal_program() { return program_beside("cullhull-rival-cgal"); }

std::optional<CgalRun> run_cgal(const std::string& program, const std::vector<double>& rows,
                                unsigned d, const ChildLimits& limits) {
  if (program.empty() || d < 2 || d > 3) return std::nullopt;
  const Scratch file;
  write_npy_points(file.path, rows.data(), rows.size() / d, d, ScalarType::f64);
  const std::optional<ChildRun> child = run_program({program, file.path}, limits);
  if (!child) return std::nullopt;
  if (child->timed_out) return CgalRun{limits.seconds, false, {}};
  // The seconds, then rows, as doubles.
  const std::size_t bytes = child->output.size();
  if (bytes < sizeof(double) || (bytes - sizeof(double)) % (d * sizeof(double)) != 0)
    return std::nullopt;
  CgalRun run;
  std::memcpy(&run.seconds, child->output.data(), sizeof(double));
  run.extreme.resize(bytes / sizeof(double) - 1);
  std::memcpy(run.extreme.data(), child->output.data() + sizeof(double), bytes - sizeof(double));
  return run;
}

Difference difference(const std::vector<double>& first, const std::vector<double>& second,
                      unsigned d) {
  const std::vector<const double*> a = sorted_rows(first, d), b = sorted_rows(second, d);
  Difference found;
  std::size_t i = 0, j = 0;
  while (i < a.size() || j < b.size()) {
    const bool left = j == b.size() || (i < a.size() && std::lexicographical_compare(
                                                            a[i], a[i] + d, b[j], b[j] + d));
    const bool right =
        !left && (i == a.size() || std::lexicographical_compare(b[j], b[j] + d, a[i], a[i] + d));
    found.first += left ? 1 : 0;
    found.second += right ? 1 : 0;
    if (!right) ++i;
    if (!left) ++j;
  }
  return found;
}

}  // namespace cullhull::bench
