#include "cuda/kernels/device_subset.hpp"
#include "cuda/kernels/executor.cuh"
#include "cuda/kernels/star_hull.hpp"
#include "cullhull/error.hpp"

namespace cullhull::internal {
namespace {

template <class T>
StarHullThere star_hull_of(const DevicePointView& points, const Run& run,
                           std::vector<PseudoHullRound>& rounds) {
  require_aligned<T>(points);
  // Points in a ball take 15 rounds, points on a sphere 18 to 22.
  constexpr unsigned most_rounds = 64;
  const PseudoSubset all{points.count, 0, 1};
  const auto count = static_cast<std::uint32_t>(points.count);
  StarHull<CudaExecutor, RowsInPlace<3, T>> hull(
      CudaExecutor(static_cast<cudaStream_t>(points.stream)));
  StarHullThere there;
  there.counts = hull.run(rows_in_place<3, T>(as_point_view(points), all), count, most_rounds,
                          run.control, rounds);
  there.ids.count = there.counts.left;
  there.ids.ids = DeviceArray<std::uint64_t>(there.ids.count, hull.executor().stream());
  const std::uint32_t listed =
      hull.executor().select(count, NotCulled{hull.culled()}, EmitId{all, there.ids.ids.data()});
  if (listed != there.counts.left)
    throw Error(ErrorCode::internal, "the device lost count of the survivors");
  if (there.counts.whole()) there.triangles = hull.triangles(there.counts, run);
  return there;
}

}  // namespace

StarHullThere star_hull_there(const DevicePointView& points, const Run& run,
                              std::vector<PseudoHullRound>* rounds) {
  std::vector<PseudoHullRound> unread;
  std::vector<PseudoHullRound>& report = rounds != nullptr ? *rounds : unread;
  if (points.dimension != 3 || points.count > pseudo_hull_most_points)
    throw Error(ErrorCode::invalid_argument,
                "a star-shaped surface needs points in space, 2^28 at most");
  return points.scalar == ScalarType::f32 ? star_hull_of<float>(points, run, report)
                                          : star_hull_of<double>(points, run, report);
}

}  // namespace cullhull::internal
