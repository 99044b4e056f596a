#include <algorithm>

#include "cuda/kernels/coordinate.cuh"
#include "cuda/kernels/device_subset.hpp"
#include "cuda/kernels/executor.cuh"
#include "cuda/kernels/pseudo_hull.hpp"
#include "cullhull/error.hpp"
#include "filter/pseudo_hull/pseudo_hull_growth.hpp"

namespace cullhull::internal {
namespace {

/// Pseudo-hulls of subsets of points in the device's memory, and the ids that each keeps.
template <unsigned D, class T>
class SubsetFilter {
 public:
  explicit SubsetFilter(const DevicePointView& points)
      : view_(as_point_view(points)),
        growth_(CudaExecutor(static_cast<cudaStream_t>(points.stream))) {}

  /// The ids of the subset's points that survive, in the device's memory.
  DeviceIds run(const PseudoSubset& subset, unsigned max_rounds, const Control& control,
                std::vector<PseudoHullRound>& rounds) {
    control.check();
    const auto size = static_cast<std::uint32_t>(subset.size());
    growth_.run(rows_in_place<D, T>(view_, subset), size, max_rounds, control, rounds);
    CudaExecutor& executor = growth_.executor();
    DeviceIds left{{growth_.left(), executor.stream()}, growth_.left()};
    if (executor.select(size, NotCulled{growth_.culled()}, EmitId{subset, left.ids.data()}) !=
        left.count)
      throw Error(ErrorCode::internal, "the device lost count of the survivors");
    return left;
  }

 private:
  PointView view_;
  PseudoHullGrowth<D, CudaExecutor, RowsInPlace<D, T>> growth_;
};

std::vector<std::uint64_t> survivors_of(const DevicePointView& points, unsigned subsets,
                                        unsigned max_rounds, const Control& control,
                                        std::vector<PseudoHullRound>& rounds) {
  rounds.clear();
  return with_point_types<2, 6>(points, [&]<unsigned D, class T>() {
    SubsetFilter<D, T> filter(points);
    std::vector<std::vector<std::uint64_t>> kept(subsets);
    for (unsigned s = 0; s < subsets; ++s) {
      const PseudoSubset subset{points.count, s, subsets};
      const DeviceIds left = filter.run(subset, max_rounds, control, rounds);
      left.append_to(kept[s], 0, cuda_stream_of(points));
    }
    return merge_subsets(std::move(kept));
  });
}

}  // namespace

std::vector<std::uint64_t> pseudo_hull_survivors_cuda(const DevicePointView& points,
                                                      const PseudoHullSettings& settings,
                                                      const Control& control,
                                                      std::vector<PseudoHullRound>* rounds) {
  // The rounds of a smaller subset would not occupy a device (a guess).
  constexpr std::uint64_t least_points = std::uint64_t{1} << 17;
  std::vector<PseudoHullRound> unread;
  std::vector<PseudoHullRound>& report = rounds != nullptr ? *rounds : unread;
  const std::uint64_t needed =
      std::max<std::uint64_t>(1, chunk_count(points.count, pseudo_hull_most_points));
  if (needed > (settings.subsets != 0 ? settings.subsets : 1U << 20))
    throw Error(ErrorCode::out_of_budget,
                "too many points for so few pseudo-hulls; use more subsets");
  if (settings.subsets != 0)
    return survivors_of(points, settings.subsets, settings.max_rounds, control, report);
  for (auto subsets = static_cast<unsigned>(needed);; subsets *= 4) {
    try {
      return survivors_of(points, subsets, settings.max_rounds, control, report);
    } catch (const OutOfMemory&) {
      if (points.count / subsets < 4 * least_points) throw;
    }
  }
}

DeviceIds pseudo_hull_survivors_there(const DevicePointView& points, unsigned max_rounds,
                                      const Control& control) {
  std::vector<PseudoHullRound> unread;
  return with_point_types<2, 6>(points, [&]<unsigned D, class T>() {
    return SubsetFilter<D, T>(points).run({points.count, 0, 1}, max_rounds, control, unread);
  });
}

}  // namespace cullhull::internal
