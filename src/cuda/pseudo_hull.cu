#include <algorithm>

#include "cuda/executor.cuh"
#include "cuda/pseudo_hull.hpp"
#include "cullhull/error.hpp"
#include "paper/pseudo_hull_growth.hpp"

namespace cullhull::internal {
namespace {

struct NotCulled {
  const unsigned char* culled;
  CULLHULL_HD bool operator()(std::uint32_t i) const { return culled[i] == 0; }
};
struct EmitId {
  PseudoSubset subset;
  std::uint64_t* ids;
  CULLHULL_HD void operator()(std::uint32_t i, std::uint32_t k) const { ids[k] = subset.point(i); }
};

/// A load that is not aligned would end the device's context.
template <class T>
void require_aligned(const DevicePointView& points) {
  const auto bits = reinterpret_cast<std::uintptr_t>(points.data) |
                    static_cast<std::uintptr_t>(points.point_stride) |
                    static_cast<std::uintptr_t>(points.coordinate_stride);
  if (bits % alignof(T) != 0)
    throw Error(ErrorCode::invalid_argument,
                "points on a device must be aligned to their scalar type");
}

template <unsigned D, class T>
std::vector<std::uint64_t> survivors_of(const DevicePointView& points, unsigned subsets,
                                        unsigned max_rounds, const Control& control,
                                        std::vector<PseudoHullRound>& rounds) {
  require_aligned<T>(points);
  PseudoHullGrowth<D, CudaExecutor, RowsInPlace<D, T>> growth{
      CudaExecutor(static_cast<cudaStream_t>(points.stream))};
  CudaArray<std::uint64_t> ids;
  const PointView view{static_cast<const std::byte*>(points.data),
                       points.scalar,
                       D,
                       points.count,
                       points.point_stride,
                       points.coordinate_stride};
  std::vector<std::vector<std::uint64_t>> kept(subsets);
  for (unsigned s = 0; s < subsets; ++s) {
    control.check();
    const PseudoSubset subset{points.count, s, subsets};
    const auto size = static_cast<std::uint32_t>(subset.size());
    growth.run(rows_in_place<D, T>(view, subset), size, max_rounds, control, rounds);
    CudaExecutor& executor = growth.executor();
    const std::uint64_t left = growth.left();
    kept[s].resize(left);
    const std::uint32_t listed = executor.select(size, NotCulled{growth.culled()},
                                                 EmitId{subset, executor.reserve(ids, left)});
    if (listed != left) throw Error(ErrorCode::internal, "the device lost count of the survivors");
    if (left != 0) executor.fetch(ids.data(), left, kept[s].data());
  }
  return merge_subsets(std::move(kept));
}

template <unsigned D>
std::vector<std::uint64_t> survivors_of(const DevicePointView& points, unsigned subsets,
                                        unsigned max_rounds, const Control& control,
                                        std::vector<PseudoHullRound>& rounds) {
  if (points.scalar == ScalarType::f32)
    return survivors_of<D, float>(points, subsets, max_rounds, control, rounds);
  if (points.scalar == ScalarType::f64)
    return survivors_of<D, double>(points, subsets, max_rounds, control, rounds);
  throw Error(ErrorCode::invalid_argument,
              "the pseudo-hull filter on a device is for f32 and f64 points");
}

std::vector<std::uint64_t> survivors_of(const DevicePointView& points, unsigned subsets,
                                        unsigned max_rounds, const Control& control,
                                        std::vector<PseudoHullRound>& rounds) {
  rounds.clear();
  switch (points.dimension) {
    case 2:
      return survivors_of<2>(points, subsets, max_rounds, control, rounds);
    case 3:
      return survivors_of<3>(points, subsets, max_rounds, control, rounds);
    case 4:
      return survivors_of<4>(points, subsets, max_rounds, control, rounds);
    case 5:
      return survivors_of<5>(points, subsets, max_rounds, control, rounds);
    case 6:
      return survivors_of<6>(points, subsets, max_rounds, control, rounds);
    default:
      throw Error(ErrorCode::invalid_argument,
                  "the pseudo-hull filter on a device is for 2 to 6 dimensions");
  }
}

}  // namespace

std::vector<std::uint64_t> pseudo_hull_survivors_cuda(const DevicePointView& points,
                                                      const PseudoHullSettings& settings,
                                                      const Control& control,
                                                      std::vector<PseudoHullRound>* rounds) {
  // A subset smaller than this is not worth a device's rounds.
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
    } catch (const cuda::OutOfMemory&) {
      if (points.count / subsets < 4 * least_points) throw;
    }
  }
}

}  // namespace cullhull::internal
