#include "lifting_rivals.hpp"

#include <cstring>

#include "cullhull/io.hpp"

namespace cullhull::bench {

std::optional<LiftedRun> lifted_run(const std::optional<ChildRun>& child,
                                    const ChildLimits& limits) {
  if (!child) return std::nullopt;
  if (child->timed_out) return LiftedRun{limits.seconds, false, 0};
  double figures[2];
  if (child->output.size() != sizeof figures) return std::nullopt;
  std::memcpy(figures, child->output.data(), sizeof figures);
  if (!(figures[0] >= 0 && figures[1] >= 0 && figures[1] < 0x1p53)) return std::nullopt;
  return LiftedRun{figures[0], true, static_cast<std::uint64_t>(figures[1])};
}

std::optional<LiftedRun> run_lifting_program(const std::string& program, const char* word,
                                             const PointView& points, const ChildLimits& limits) {
  const Scratch file;
  write_npy_points(file.path, reinterpret_cast<const double*>(points.data), points.count,
                   points.dimension, ScalarType::f64);
  return lifted_run(run_program({program, file.path, word}, limits), limits);
}

}  // namespace cullhull::bench
