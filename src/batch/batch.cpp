// Many small hulls: runs the pipeline once per set, on all threads, and concatenates the results.
#include "cullhull/batch.hpp"

#include <stdexcept>

#include "batch/batch_maker.hpp"
#include "cullhull/hull.hpp"
#include "geometry/gather.hpp"

namespace cullhull::internal {

void check_offsets(std::uint64_t points, const std::uint64_t* offsets, std::uint64_t sets) {
  if (offsets == nullptr) throw Error(ErrorCode::invalid_argument, "offsets is null");
  for (std::uint64_t i = 0; i <= sets; ++i)
    if (offsets[i] > points || (i > 0 && offsets[i] < offsets[i - 1]))
      throw Error(ErrorCode::invalid_argument, "offset ", i, " is ", offsets[i],
                  "; offsets must ascend and not exceed the ", points, " points");
}

}  // namespace cullhull::internal

namespace cullhull {

using namespace internal;

namespace {

template <class T, class To>
void copy_list(const Lists<T>& lists, std::size_t i, To& to) {
  to.assign(lists.items.begin() + static_cast<std::ptrdiff_t>(lists.offsets[i]),
            lists.items.begin() + static_cast<std::ptrdiff_t>(lists.offsets[i + 1]));
}

/// Copies lists [begin, end), with offsets from 0.
template <class T, class Items>
void copy_run(const Lists<T>& lists, std::uint64_t begin, std::uint64_t end, Lists<T, Items>& out) {
  const std::uint64_t base = lists.offsets[begin];
  for (std::uint64_t i = begin + 1; i <= end; ++i) out.offsets.push_back(lists.offsets[i] - base);
  out.items = Array<T>(lists.items.begin() + static_cast<std::ptrdiff_t>(base),
                       lists.items.begin() + static_cast<std::ptrdiff_t>(lists.offsets[end]));
}

}  // namespace

Hull HullBatch::hull(std::size_t i) const {
  if (i >= size())
    throw Error(ErrorCode::invalid_argument, "there is no set ", i, " in a batch of ", size());
  Hull h;
  h.dimension = dimension;
  h.scalar = scalar;
  h.point_count = point_counts[i];
  h.affine_dimension = affine_dimensions[i];
  h.volume = volumes[i];
  h.area = areas[i];
  if (h.affine_dimension >= 0) {
    const auto c = centroids.begin() + static_cast<std::ptrdiff_t>(i * dimension);
    h.centroid.assign(c, c + dimension);
  }
  copy_list(vertices, i, h.vertices);
  const std::uint64_t begin = facet_starts[i], end = facet_starts[i + 1];
  copy_run(facets, begin, end, h.facets);
  copy_run(facet_neighbours, begin, end, h.facet_neighbours);
  const std::uint64_t width = dimension + std::uint64_t{1};
  h.facet_planes.assign(facet_planes.begin() + static_cast<std::ptrdiff_t>(begin * width),
                        facet_planes.begin() + static_cast<std::ptrdiff_t>(end * width));
  copy_list(simplices, i, h.simplices.edit());
  copy_list(simplex_neighbours, i, h.simplex_neighbours);
  copy_list(simplex_facets, i, h.simplex_facets.edit());
  return h;
}

HullBatch convex_hulls(const PointView& points, std::span<const std::uint64_t> offsets,
                       const Options& options) {
  const std::uint64_t set_count = offsets.empty() ? 0 : offsets.size() - 1;
  check_offsets(points.count, offsets.empty() ? nullptr : offsets.data(), set_count);
  if (points.count > 0) require_points(points);
  const Run run(options);
  BatchMaker maker(points.dimension, points.scalar, set_count, offsets[set_count] - offsets[0],
                   run);
  maker.add(set_count, [&](SetHuller& huller, std::uint64_t i, HullBatch& part) {
    PointView set = points;
    set.count = offsets[i + 1] - offsets[i];
    set.data += static_cast<std::ptrdiff_t>(offsets[i]) * points.point_stride;
    huller.append(set, part);
  });
  return std::move(maker).finish();
}

}  // namespace cullhull
