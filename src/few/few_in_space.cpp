#include <algorithm>
#include <cstring>
#include <numeric>
#include <utility>

#include "few/small_hull.hpp"
#include "few/small_measures.hpp"
#include "parallel/threads/thread_memory.hpp"

namespace cullhull::internal {
namespace {

template <class T, class Points>
void load_scalars(const PointView& view, const std::uint64_t* ids, unsigned count, Points& points) {
  for (unsigned i = 0; i < count; ++i) {
    const std::byte* from = view.address(ids != nullptr ? ids[i] : i, 0);
    for (unsigned c = 0; c < 3; ++c) {
      T value;
      std::memcpy(&value, from + c * view.coordinate_stride, sizeof value);
      points.axes[c][i] = static_cast<double>(value);
    }
  }
}

template <class Points>
void load(const PointView& view, const std::uint64_t* ids, unsigned count, Points& points) {
  if (view.scalar == ScalarType::f64)
    load_scalars<double>(view, ids, count, points);
  else if (view.scalar == ScalarType::f32)
    load_scalars<float>(view, ids, count, points);
  else
    for (unsigned i = 0; i < count; ++i)
      for (unsigned c = 0; c < 3; ++c) points.axes[c][i] = view.at(ids != nullptr ? ids[i] : i, c);
  for (auto& axis : points.axes) std::fill(axis + count, axis + (count + 15) / 16 * 16, axis[0]);
}

template <class T, class Short>
Array<T> widened(const Short* from, std::size_t count) {
  Array<T> to(count + 64 / sizeof(T));
  widen(from, count, to.data());
  to.resize(count);
  return to;
}

template <class Number>
Array<std::uint64_t> named(const Number* from, std::size_t count, const std::uint64_t* ids) {
  if (ids == nullptr) return widened<std::uint64_t>(from, count);
  Array<std::uint64_t> to(count);
  for (std::size_t i = 0; i < count; ++i) to[i] = ids[from[i]];
  return to;
}

template <class Small>
void write_lists(const Small& from, const std::uint64_t* ids, Hull& hull) {
  using Ids = SharedArray<std::uint64_t>;
  const std::size_t n = from.count;
  hull.vertices.resize(from.vertex_count);
  for (unsigned i = 0; i < from.vertex_count; ++i)
    hull.vertices[i] = ids != nullptr ? ids[from.ids[i]] : from.ids[i];
  hull.simplices = Ids(named(from.vertices, 3 * n, ids));
  hull.simplex_neighbours = widened<std::uint32_t>(from.opposite, 3 * n);
  if (from.simplicial()) {
    hull.facets = Lists<std::uint64_t, Ids>::of_length(3, hull.simplices);
    hull.facet_neighbours =
        Lists<std::uint32_t>::of_length(3, widened<std::uint32_t>(from.beside, 3 * n));
    hull.simplex_facets = EvenArray<std::uint32_t>::of_step(n, 1);
    return;
  }
  EvenArray<std::uint64_t> offsets{0};
  std::uint64_t size = 0;
  for (unsigned i = 0; i < from.facet_count; ++i) offsets.push_back(size += from.facet_size[i]);
  hull.facets.items = Ids(named(from.corners, size, ids));
  hull.facets.offsets = offsets;
  hull.facet_neighbours.items = widened<std::uint32_t>(from.beside, size);
  hull.facet_neighbours.offsets = std::move(offsets);
  hull.simplex_facets = widened<std::uint32_t>(from.facet_of, n);
}

/// The hull of `count` points with its measures; points, small and shares are working memory.
/// False, and `hull` unchanged, where doubles do not suffice.
template <class Points, class Small>
bool write_hull(const PointView& view, const std::uint64_t* ids, unsigned count, Points& points,
                Small& small, SmallShares<Small::max_facets>& shares, Hull& hull) {
  load(view, ids, count, points);
  if (!small_hull_3d(points, count, small)) return false;
  SmallMeasures measures;
  // Room for a plane (four numbers) per triangle, up to a multiple of eight for the measurer.
  Array<double> planes(std::size_t{4} * ((small.count + 7) / 8 * 8));
  if (!SmallMeasurer(view, ids, points, small, shares).run(planes.data(), measures)) return false;
  planes.resize(std::size_t{4} * small.facet_count);
  hull.facet_planes = std::move(planes);
  hull.affine_dimension = 3;
  hull.volume = measures.volume;
  hull.area = measures.area;
  hull.centroid.assign(measures.centroid, measures.centroid + 3);
  write_lists(small, ids, hull);
  return true;
}

}  // namespace

void load_small(const PointView& view, const std::uint64_t* ids, unsigned count,
                SmallPoints3D& points) {
  load(view, ids, count, points);
}
void load_small(const PointView& view, const std::uint64_t* ids, unsigned count,
                MediumPoints3D& points) {
  load(view, ids, count, points);
}

bool hull_of_few(const PointView& view, const std::uint64_t* ids, std::uint64_t count, Hull& hull) {
  if (view.dimension > 3) return hull_of_few_nd(view, ids, count, hull);
  if (view.dimension != 3 || count < 4 || count > MediumHull3D::max_points) return false;
  const auto n = static_cast<unsigned>(count);
  if (count > SmallHull3D::max_points) {
    struct Memory {
      MediumPoints3D points;
      MediumHull3D hull;
      SmallShares<MediumHull3D::max_facets> shares;
    };
    Memory& memory = thread_memory<Memory>();
    return write_hull(view, ids, n, memory.points, memory.hull, memory.shares, hull);
  }
  SmallPoints3D points;
  SmallHull3D small;
  SmallShares<SmallHull3D::max_facets> shares;
  return write_hull(view, ids, n, points, small, shares, hull);
}

}  // namespace cullhull::internal
