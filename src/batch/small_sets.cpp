#include <algorithm>
#include <array>
#include <numeric>

#include "batch/batch_maker.hpp"
#include "few/small_3d.hpp"
#include "few/small_hull.hpp"
#include "few/small_measures.hpp"
#include "few/small_surface.hpp"

namespace cullhull::internal {
namespace {

/// Appends `count` items, of which the caller removes those it does not need; returns the first.
template <class T>
T* extend(Array<T>& to, std::size_t count) {
  const std::size_t size = to.size();
  to.resize(size + count);
  return to.data() + size;
}

/// Appends `count` numbers, written a vector at a time.
template <class T>
void append_bytes(Array<T>& to, const std::uint8_t* from, std::size_t count) {
  constexpr std::size_t room = 64 / sizeof(T);
  const std::size_t size = to.size();
  widen(from, count, extend(to, count + room));
  to.resize(size + count);
}

/// Appends the offsets of `count` lists of three items.
void append_threes(EvenArray<std::uint64_t>& offsets, std::size_t count) {
  const std::uint64_t* step = offsets.step();
  if (step != nullptr && (*step == 3 || offsets.size() == 1)) {
    offsets = EvenArray<std::uint64_t>::of_step(offsets.size() + count, 3);
    return;
  }
  std::uint64_t at = offsets.back();
  for (std::size_t i = 0; i < count; ++i) offsets.push_back(at += 3);
}

/// Appends the offsets of a list for each facet; returns the lists' total length.
std::uint64_t append_sizes(EvenArray<std::uint64_t>& offsets, const SmallHull3D& hull) {
  const std::uint64_t begin = offsets.back();
  std::uint64_t at = begin;
  Array<std::uint64_t>& items = offsets.edit();
  for (unsigned i = 0; i < hull.facet_count; ++i) items.push_back(at += hull.facet_size[i]);
  return at - begin;
}

void write(const PointView& set, const SmallHull3D& hull, const SmallMeasures& measures,
           HullBatch& to) {
  constexpr auto numbers = [] {
    std::array<std::uint8_t, SmallHull3D::max_facets + 64> n{};
    std::iota(n.begin(), n.begin() + SmallHull3D::max_facets, std::uint8_t{0});
    return n;
  }();
  to.point_counts.push_back(set.count);
  to.affine_dimensions.push_back(3);
  to.volumes.push_back(measures.volume);
  to.areas.push_back(measures.area);
  to.centroids.insert(to.centroids.end(), measures.centroid, measures.centroid + 3);
  append_bytes(to.vertices.items, hull.ids, hull.vertex_count);
  to.vertices.offsets.push_back(to.vertices.items.size());

  const std::size_t n = hull.count;
  to.facet_starts.push_back(to.facet_starts.back() + hull.facet_count);
  append_bytes(to.simplices.items, hull.vertices, 3 * n);
  append_bytes(to.simplex_neighbours.items, hull.opposite, 3 * n);
  if (hull.simplicial()) {
    append_threes(to.facets.offsets, n);
    append_threes(to.facet_neighbours.offsets, n);
    append_bytes(to.facets.items, hull.vertices, 3 * n);
    append_bytes(to.facet_neighbours.items, hull.beside, 3 * n);
    append_bytes(to.simplex_facets.items, numbers.data(), n);
  } else {
    const std::uint64_t size = append_sizes(to.facets.offsets, hull);
    append_sizes(to.facet_neighbours.offsets, hull);
    append_bytes(to.facets.items, hull.corners, size);
    append_bytes(to.facet_neighbours.items, hull.beside, size);
    append_bytes(to.simplex_facets.items, hull.facet_of, n);
  }
  to.simplices.offsets.push_back(to.simplices.items.size());
  to.simplex_neighbours.offsets.push_back(to.simplex_neighbours.items.size());
  to.simplex_facets.offsets.push_back(to.simplex_facets.items.size());
}

/// False, with `to` unchanged, where a measure needs more than doubles.
bool measure_and_write(const PointView& set, const SmallPoints3D& points, const SmallHull3D& hull,
                       HullBatch& to) {
  const std::size_t planes = to.facet_planes.size();
  SmallMeasures measures;
  SmallShares<SmallHull3D::max_facets> shares;
  const bool done =
      SmallMeasurer(set, nullptr, points, hull, shares)
          .run(extend(to.facet_planes, std::size_t{4} * ((hull.count + 7) / 8 * 8)), measures);
  to.facet_planes.resize(done ? planes + std::size_t{4} * hull.facet_count : planes);
  if (done) write(set, hull, measures, to);
  return done;
}

}  // namespace

bool append_small_3d(const PointView& set, HullBatch& to) {
  if (set.dimension != 3 || set.count < 4 || set.count > SmallHull3D::max_points) return false;
  SmallPoints3D points;
  SmallHull3D hull;
  load_small(set, nullptr, static_cast<unsigned>(set.count), points);
  if (!small_hull_3d(points, static_cast<unsigned>(set.count), hull)) return false;
  return measure_and_write(set, points, hull, to);
}

bool append_simplices_3d(const FoundHull& found, HullBatch& to) {
  const auto n = static_cast<unsigned>(found.rows.count);
  SmallPoints3D points;
  load_small(found.rows, nullptr, n, points);
  TableSurface surface;
  surface.top = found.simplex_count;
  for (unsigned f = 0; f < surface.top; ++f) {
    const std::uint8_t* const v = found.simplices + std::size_t{3} * f;
    surface.set(f, v[0], v[1], v[2]);
  }
  SmallHull3D hull;
  order_small<TableSurface>(surface, n, nullptr, hull);
  for (unsigned c = 0; c < 3; ++c) {
    const auto [low, high] = std::minmax_element(points.axes[c], points.axes[c] + n);
    hull.low[c] = *low;
    hull.high[c] = *high;
  }
  return measure_and_write(found.rows, points, hull, to);
}

}  // namespace cullhull::internal
