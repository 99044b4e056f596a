#include "few/few_in_space.hpp"

#include <algorithm>
#include <numeric>

#include "few/small_3d_measures.hpp"
#include "few/small_3d_surface.hpp"
#include "filter/ways.hpp"
#include "geometry/gather.hpp"
#include "parallel/threads/thread_memory.hpp"
#include "result/write/hull_lists.hpp"

namespace cullhull::internal {
namespace {

template <class Points>
void load(const PointView& view, const std::uint64_t* ids, unsigned count, Points& points) {
  load_axes_3d(view, ids, 0, count, points.axes[0], points.axes[1], points.axes[2]);
  for (auto& axis : points.axes) std::fill(axis + count, axis + (count + 15) / 16 * 16, axis[0]);
}

/// Writes ids as the caller counts them: those with the given names, which ascend; nullptr: 0, 1,
/// ...
template <class Number>
void put_ids(const Number* from, std::size_t count, const std::uint64_t* names, std::uint64_t* to) {
  if (names == nullptr) return widen(from, count, to);
  for (std::size_t i = 0; i < count; ++i) to[i] = names[from[i]];
}

/// Appends planes, measures and lists of the hull of `points`, those of the view with the given
/// names, to a Hull or a HullBatch; `shares` is working memory. False, with the target unchanged,
/// where a measure needs more than doubles.
template <class Points, class Small, class Target>
bool measure_and_write(const PointView& view, const std::uint64_t* names, const Points& points,
                       const Small& small, SmallShares<Small::max_facets>& shares, Target& target) {
  const std::size_t n = small.count;
  std::size_t corners = 3 * n;
  if (!small.simplicial())
    corners =
        std::accumulate(small.facet_size, small.facet_size + small.facet_count, std::size_t{0});
  NewLists<Target> to({3, small.vertex_count, n, small.facet_count, corners, corners}, target,
                      256);  // seven planes
  Measures measures;
  if (!SmallMeasurer(view, names, points, small, shares).run(to.planes, measures)) return false;
  write_measures(3, view.count, measures.volume, measures.area, measures.centroid, target);
  std::uint64_t* const vertices = to.vertices();
  for (unsigned i = 0; i < small.vertex_count; ++i)
    vertices[i] = names != nullptr ? names[small.ids[i]] : small.ids[i];
  put_ids(small.vertices, 3 * n, names, to.simplices);
  widen(small.opposite, 3 * n, to.simplex_neighbours);
  widen(small.beside, corners, to.facet_neighbours);
  if (to.facets != nullptr)
    put_ids(small.simplicial() ? small.vertices : small.corners, corners, names, to.facets);
  if (!small.simplicial()) widen(small.facet_of, n, to.simplex_facets);
  const auto size = [&](std::size_t i) { return small.facet_size[i]; };
  to.keep(size, size);
  return true;
}

/// The hull of `count` points with its measures; points, small and shares are working memory.
/// False, and `target` unchanged, where doubles do not suffice.
template <class Points, class Small, class Target>
bool write_hull(const PointView& view, const std::uint64_t* names, unsigned count, Points& points,
                Small& small, SmallShares<Small::max_facets>& shares, Target& target) {
  load(view, names, count, points);
  return small_hull_3d(points, count, small) &&
         measure_and_write(view, names, points, small, shares, target);
}

/// Does this for up to SmallHull3D::max_points points, on the stack.
template <class Target>
bool write_small(const PointView& view, const std::uint64_t* names, unsigned count,
                 Target& target) {
  SmallPoints3D points;
  SmallHull3D small;
  SmallShares<SmallHull3D::max_facets> shares;
  return write_hull(view, names, count, points, small, shares, target);
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
  if (view.dimension < 3 || !takes_few({.dimension = view.dimension, .count = count, .left = true}))
    return false;
  if (view.dimension > 3) return hull_of_few_nd(view, ids, count, hull);
  static_assert(row_of(Way::few_in_space).most_left <= MediumHull3D::max_points);
  const auto n = static_cast<unsigned>(count);
  if (count <= SmallHull3D::max_points) return write_small(view, ids, n, hull);
  struct Memory {
    MediumPoints3D points;
    MediumHull3D hull;
    SmallShares<MediumHull3D::max_facets> shares;
  };
  Memory& memory = thread_memory<Memory>();
  return write_hull(view, ids, n, memory.points, memory.hull, memory.shares, hull);
}

bool append_small_3d(const PointView& set, HullBatch& to) {
  return set.dimension == 3 && takes_few({.dimension = 3, .count = set.count}) &&
         set.count <= SmallHull3D::max_points &&
         write_small(set, nullptr, static_cast<unsigned>(set.count), to);
}

bool append_simplices_3d(const PointView& rows, const std::uint8_t* simplices, unsigned count,
                         HullBatch& to) {
  const auto n = static_cast<unsigned>(rows.count);
  SmallPoints3D points;
  load(rows, nullptr, n, points);
  TableSurface surface;
  surface.top = count;
  for (unsigned f = 0; f < count; ++f, simplices += 3)
    surface.set(f, simplices[0], simplices[1], simplices[2]);
  SmallHull3D hull;
  order_small<TableSurface>(surface, n, nullptr, hull);
  for (unsigned c = 0; c < 3; ++c) {
    const auto [low, high] = std::minmax_element(points.axes[c], points.axes[c] + n);
    hull.low[c] = *low;
    hull.high[c] = *high;
  }
  SmallShares<SmallHull3D::max_facets> shares;
  return measure_and_write(rows, nullptr, points, hull, shares, to);
}

}  // namespace cullhull::internal
