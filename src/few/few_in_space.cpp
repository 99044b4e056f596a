#include "few/few_in_space.hpp"

#include <algorithm>

#include "few/small_3d_surface.hpp"
#include "filter/ways.hpp"
#include "geometry/gather.hpp"
#include "parallel/threads/thread_memory.hpp"
#include "result/write/few_triangles.hpp"

namespace cullhull::internal {
namespace {

template <class Points>
void load(const PointView& view, const std::uint64_t* ids, unsigned count, Points& points) {
  load_axes_3d(view, ids, 0, count, points.axes[0], points.axes[1], points.axes[2]);
  for (auto& axis : points.axes) std::fill(axis + count, axis + (count + 15) / 16 * 16, axis[0]);
}

/// The hull of `count` points with its measures; points, small and shares are working memory.
/// False, and `target` unchanged, where doubles do not suffice.
template <class Points, class Small, class Target>
bool write_hull(const PointView& view, const std::uint64_t* names, unsigned count, Points& points,
                Small& small, SmallShares<Small::max_facets>& shares, Target& target) {
  load(view, names, count, points);
  return small_hull_3d(points, count, small) &&
         write_few_triangles(view, names, points, small, shares, target);
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
  return write_few_triangles(rows, nullptr, points, hull, shares, to);
}

}  // namespace cullhull::internal
