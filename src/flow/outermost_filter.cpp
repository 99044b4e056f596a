
#include "few/few_in_space.hpp"
#include "few/small_3d.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "filter/outermost.hpp"
#include "filter/ways.hpp"
#include "flow/pipeline.hpp"
#include "parallel/threads/run.hpp"
#include "parallel/threads/thread_memory.hpp"

namespace cullhull::internal {
namespace {

constexpr std::uint64_t most_hulled = row_of(Way::few_in_space).most_left;

/// Returns the hull of the points with these ids; of dimension 0 if there are too many for
/// small_hull_3d or it fails.
InnerPolytope polytope_of(const PointView& points, const std::vector<std::uint64_t>& ids) {
  struct Memory {
    MediumPoints3D points;
    MediumHull3D hull;
  };
  InnerPolytope polytope;
  if (ids.size() < 4 || ids.size() > most_hulled) return polytope;
  Memory& m = thread_memory<Memory>();
  const auto count = static_cast<unsigned>(ids.size());
  load_small(points, ids.data(), count, m.points);
  if (!small_hull_3d(m.points, count, m.hull)) return polytope;
  MediumHull3D::Number place[MediumHull3D::max_points];
  for (unsigned v = 0; v < m.hull.vertex_count; ++v) {
    const unsigned id = m.hull.ids[v];
    place[id] = static_cast<MediumHull3D::Number>(v);
    for (const auto& axis : m.points.axes) polytope.vertices.push_back(axis[id]);
  }
  polytope.dimension = 3;
  const std::size_t corners = std::size_t{3} * m.hull.count;
  polytope.facets.resize(corners);
  for (std::size_t i = 0; i < corners; ++i) polytope.facets[i] = place[m.hull.vertices[i]];
  polytope.neighbours.assign(m.hull.opposite, m.hull.opposite + corners);
  return polytope;
}

/// The resolution of a map of the outermost points: number of cones and of grid cells along each
/// edge of the cube of directions.
struct Fineness {
  unsigned cones, cells;
};

/// Lists the positions of the points that are not inside the hull of the outermost points. Returns
/// false if a map is not worthwhile.
bool kept_by_outermost(const PointView& points, Fineness fine, double most_outside, const Run& run,
                       std::vector<std::uint64_t>& kept) {
  const OutermostSettings settings{.cells = fine.cones, .most_outside = most_outside};
  const std::vector<std::uint64_t> outermost = outermost_points(points, settings);
  if (outermost.empty()) return false;
  const InnerPolytope polytope = polytope_of(points, outermost);
  if (polytope.dimension == 0) return false;
  run.check();
  const auto map = GaugeMap::of_few_facets(polytope, fine.cells);
  if (map == nullptr) return false;
  const Array<std::uint64_t> left = map->survivors(points, run.with_threads(1));
  kept.assign(left.begin(), left.end());
  return true;
}

}  // namespace

/// More directions leave fewer points to the engine, but their map takes longer. Measured on balls,
/// per call: 10,000 points take 330 us with 96 directions, 213 with 216, 255 with 384; 2,000 points
/// take 75, 107 and 127 us.
bool cull_by_outermost(const PointView& points, const Run& run, Filtered& result) {
  const Fineness first = points.count <= 8192    ? Fineness{4, 8}
                         : points.count <= 32768 ? Fineness{6, 12}
                                                 : Fineness{8, 16};
  // The largest share of points outside: with more, discarding the rest saves less than the map
  // costs. Without this test spheres of 2,000 points take 1.8 times as long, of 10,000 1.4 times;
  // the test costs balls and Gaussian sets 7 to 12 % at 2,000 points, 0 to 4 % at 10,000. The
  // values 0.5 and 0.9 differ by less than 2 %.
  constexpr double most_outside = 0.75;
  Survivors& survivors = result.survivors;
  if (!kept_by_outermost(points, first, most_outside, run, survivors.ids)) return false;
  survivors.all = false;
  survivors.filter = UsedFilter::gauge;
  survivors.reason = "a map of the outermost points in " +
                     std::to_string(6 * first.cones * first.cones) + " directions";
  gather_survivors(points, result.survivors.ids, result, run);
  std::vector<std::uint64_t> kept;
  if (survivors.ids.size() > most_hulled &&
      kept_by_outermost(view_of_rows(result, 3), {12, 16}, 1, run, kept)) {
    keep_of_survivors(result, 3, kept);
    survivors.filter = UsedFilter::gauge_twice;
  }
  return true;
}

}  // namespace cullhull::internal
