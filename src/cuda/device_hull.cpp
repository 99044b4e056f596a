// Hulls that are left in a device's memory.
#include "cullhull/device_hull.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>
#include <vector>

#include "cuda/device_rows.hpp"
#include "cuda/kernels/star_hull.hpp"
#include "cuda/runtime.hpp"
#include "flow/pipeline.hpp"

namespace cullhull::internal {
namespace {

struct ListsThere {
  std::int64_t *vertices, *simplices;
  double* planes;
  std::int32_t* neighbours;
};
/// Makes room for the lists of a hull whose sizes are known, in the current device's memory.
ListsThere room_for(DeviceHull& hull, cudaStream_t stream) {
  const std::size_t corners = hull.simplex_count * std::max(hull.affine_dimension, 0),
                    numbers = hull.simplex_count * (hull.dimension + 1);
  // At least a byte, so that no list is null.
  const std::shared_ptr<std::byte> memory =
      result_memory(8 * (hull.vertex_count + corners + numbers) + 4 * corners + 1, stream);
  ListsThere to;
  to.vertices = reinterpret_cast<std::int64_t*>(memory.get());
  to.simplices = to.vertices + hull.vertex_count;
  to.planes = reinterpret_cast<double*>(to.simplices + corners);
  to.neighbours = reinterpret_cast<std::int32_t*>(to.planes + numbers);
  hull.device = this_device().ordinal;
  hull.vertices = to.vertices;
  hull.simplices = to.simplices;
  hull.neighbours = to.neighbours;
  hull.planes = to.planes;
  hull.memory = memory;
  return to;
}

}  // namespace

void leave_there(const StarHullThere& found, const DeviceIds& ids, cudaStream_t stream,
                 DeviceHull& left) {
  DeviceHull hull;  // what is left is whole
  hull.dimension = 3;
  hull.affine_dimension = 3;
  hull.vertex_count = ids.count;
  hull.simplex_count = 2 * ids.count - 4;
  const ListsThere to = room_for(hull, stream);
  const auto copy = [stream](auto* into, const auto* from, std::size_t count) {
    static_assert(sizeof *into == sizeof *from);
    check(cudaMemcpyAsync(into, from, count * sizeof *into, cudaMemcpyDeviceToDevice, stream),
          "copying a hull on the device");
  };
  const std::size_t corners = 3 * hull.simplex_count;
  copy(to.vertices, ids.ids.data(), ids.count);
  name_corners(found.vertices, ids, static_cast<std::uint32_t>(corners), to.simplices, stream);
  copy(to.neighbours, found.neighbours, corners);
  copy(to.planes, found.planes, 4 * hull.simplex_count);
  synchronise(stream, "writing a hull on the device");
  left = std::move(hull);
}

DeviceHull copied_to_device(const Hull& hull, const DevicePointView& points,
                            const Options& options) {
  const DeviceScope scope(points.count > 0 ? device_of(points) : this_device().ordinal, options);
  const cudaStream_t stream = cuda_stream_of(points);
  DeviceHull there;
  there.dimension = hull.dimension;
  there.affine_dimension = hull.affine_dimension;
  there.vertex_count = hull.vertices.size();
  there.simplex_count = hull.simplex_count();
  const ListsThere to = room_for(there, stream);
  const auto copy = [stream](auto* into, const auto& list) {
    using Item = std::remove_pointer_t<decltype(into)>;
    upload(into, reinterpret_cast<const Item*>(list.data()), list.size(), stream);
  };
  copy(to.vertices, hull.vertices);
  copy(to.simplices, hull.simplices);
  copy(to.neighbours, hull.simplex_neighbours);
  std::vector<double> planes;
  for (std::uint64_t i = 0; i < there.simplex_count; ++i) {
    const auto plane = hull.plane(hull.simplex_facets[i]);
    planes.insert(planes.end(), plane.begin(), plane.end());
  }
  copy(to.planes, planes);
  return there;
}

}  // namespace cullhull::internal
