#include "cuda/gauge.hpp"
#include "cuda/kernels/device_subset.hpp"
#include "cuda/kernels/executor.cuh"
#include "filter/gauge/outermost_offers.hpp"

namespace cullhull::internal {

DeviceIds outermost_there(const GaugeTable& map, unsigned cells, const DevicePointView& points) {
  CudaExecutor executor(cuda_stream_of(points));
  const auto count = static_cast<std::uint32_t>(points.count);
  const DeviceArray<float> nodes = uploaded(map.nodes, executor.stream());
  DeviceIds found;
  with_types(map, points.scalar, [&]<unsigned D, class T, class C>() {
    if constexpr (D >= 4) {
      const auto rows = rows_in_place<D, T>(as_point_view(points), {points.count, 0, 1});
      GaugeTable grid;
      if (!leader_cells<D>(executor, rows, count, map, cells, grid)) return;
      const auto corners = 2 * D * static_cast<std::uint32_t>(grid.face_stride);
      const DeviceArray<std::uint64_t> best(corners, executor.stream());
      found.ids = DeviceArray<std::uint64_t>(corners, executor.stream());
      const OfferOutermost<D, C, RowsInPlace<D, T>> offer{
          rows, gauge_constants<D, C>(map), gauge_constants<D, C>(grid), nodes.data()};
      found.count = list_outermost(executor, offer, count, corners, best.data(), found.ids.data());
    }
  });
  return found;
}

}  // namespace cullhull::internal
