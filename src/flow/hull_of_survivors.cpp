// The second half of the flow, from survivors to the result: thin lattices, frame, engine, result.
#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "few/few_in_space.hpp"
#include "filter/ways.hpp"
#include "flow/pipeline.hpp"
#include "geometry/local_frame.hpp"
#include "geometry/unflattened.hpp"
#include "hull/space/triangle_mesh.hpp"
#include "parallel/dispatch.hpp"
#include "result/build_hull.hpp"
#include "result/write/write_polygon.hpp"
#include "result/write/write_simplices.hpp"

namespace cullhull::internal {
namespace {

Boundary run_engine(const LocalFrame& frame, const Run& run) {
  const LocalPoints& points = frame.points();
  if (points.dimension == 1) return ends_of_line(points);
  if (plane_only || points.dimension == 2) return hull_2d(points, run);
  if (points.dimension > 8) return hull_nd(points, frame.simplex().data(), run);
  return hull_nd(Unflattened(frame, run).points(), frame.simplex().data(), run);
}

/// Tells the way that found the hull; returns true.
bool add_way(Way way, Hull& hull) {
  std::string& reason = hull.statistics.cull_reason;
  reason += (reason.empty() ? "" : "; then ") + std::string(row_of(way).name);
  return true;
}

/// Hulls 2D points without a frame. Returns false if `points` is not 2D; also for flats and
/// polygons of extreme aspect ratio, after reducing `filtered` to the polygon's corners, which have
/// the same hull.
bool hull_in_plane(const PointView& points, Filtered& filtered, const Run& run, Hull& hull) {
  if (points.dimension != 2) return false;
  const PlanarRows rows(points, filtered);
  const Polygon polygon = rows.hull(run);
  const std::uint64_t edges = polygon.corners.size();
  require_budget(run.budget, edges * 160, std::to_string(edges) + " facets");
  PolygonMemory memory;
  if (edges >= 3 && write_polygon(points,
                                  PolygonOfRows<std::uint64_t>{polygon.corners, polygon.rows,
                                                               rows.ids, polygon.box},
                                  run, memory, hull)) {
    polygon.rung_counts.add_to(hull.statistics.rung_counts);
    return add_way(Way::plane_engine, hull);
  }
  filtered.survivors.ids =
      ascending_ids(polygon.corners.data(), edges, polygon.rows, rows.ids, run);
  filtered.survivors.all = false;
  filtered.rows = {};
  return false;
}

/// Hulls few points from 3D on directly from their coordinates. Returns false where the engine is
/// needed.
bool hull_few(const PointView& points, const Survivors& survivors, const Run& run, Hull& hull) {
  const std::uint64_t count = survivors.size(points.count);
  // Of all points small_hull() had the choice: a failed attempt can take milliseconds.
  if (survivors.all && takes_few(way_question(points, run.options))) return false;
  return takes_few({.dimension = points.dimension,
                    .count = count,
                    .left = !survivors.all,
                    .budget = run.budget}) &&
         hull_of_few(points, survivors.all ? nullptr : survivors.ids.data(), count, hull) &&
         add_way(few_way(points.dimension), hull);
}

/// The known triangles at the points' positions; nothing if they are of other points.
std::optional<TriangleMesh> known_surface(const ResultInput& from, const std::uint32_t* simplex,
                                          const Run& run, KnownHull& known) {
  if (known.hull == nullptr) return {};
  const auto order = vertices_first(known.hull->vertices, from.ids, from.local->count, run);
  known.tried = order.has_value();
  if (!known.tried) return {};
  return moved_surface(*known.hull, known.numbers, *order, *from.local, simplex, run);
}

/// Writes the hull with known triangles. If they do not form the points' hull at their positions,
/// returns the surface that they can be mended to, if there is one.
std::optional<TriangleMesh> hull_by_known(const ResultInput& from, const std::uint32_t* simplex,
                                          const Run& run, KnownHull& known, Hull& hull) {
  std::optional<TriangleMesh> surface = known_surface(from, simplex, run, known);
  if (!surface) return {};
  if (surface->live + 4 == 2 * std::uint64_t{from.local->count}) {
    require_budget(run.budget, surface->live * result_bytes_per_facet(3, 3),
                   std::to_string(surface->live) + " facets");
    known.holds = write_triangles(from, *surface, run, hull);
    if (known.holds) return {};
  }
  known.mended = mend_surface(*surface, *from.local, simplex, run);
  if (!known.mended) surface.reset();
  return surface;
}

/// Computes frame, engine and result: for all that the fast paths above refuse.
void hull_by_engine(const PointView& points, Filtered&& filtered, const Run& run, KnownHull* known,
                    Hull& hull) {
  EngineInput input = engine_input(points, std::move(filtered), run);
  std::optional<LocalFrame> found;
  find_frame(points, input, run, found);
  const LocalFrame& frame = *found;
  run.check();
  hull.affine_dimension = frame.affine_dimension();
  const Way way = engine_way(static_cast<std::uint32_t>(hull.affine_dimension));
  if (hull.affine_dimension == 0) {
    add_way(way, hull);
    hull.vertices = {input.all ? 0 : input.ids[0]};
    for (unsigned j = 0; j < points.dimension; ++j)
      hull.centroid.push_back(points.at(hull.vertices[0], j));
  } else {
    const ResultInput from{&points, &frame.points(), input.all ? nullptr : input.ids.data(),
                           frame.axes().data()};
    const auto finish = [&](auto&& boundary, std::uint64_t facets) {
      add_way(way, hull);
      boundary.rung_counts.add_to(hull.statistics.rung_counts);
      const auto k = static_cast<std::uint64_t>(hull.affine_dimension);
      require_budget(run.budget, facets * result_bytes_per_facet(k, points.dimension),
                     std::to_string(facets) + " facets");
      // From 4D on, writing a facet takes about 150 ns: below 16,384 facets (2.5 ms) threads cost
      // more than they save.
      constexpr std::uint64_t worth_threads = std::uint64_t{1} << 14;
      build_hull(from, std::move(boundary),
                 k > 3 && facets < worth_threads ? run.with_threads(1) : run, hull);
    };
    if (!plane_only && hull.affine_dimension == 3) {
      std::optional<TriangleMesh> surface;
      if (known != nullptr)
        surface = hull_by_known(from, frame.simplex().data(), run, *known, hull);
      if (known != nullptr && known->holds) return;
      if (!surface) surface = triangle_mesh(frame.points(), frame.simplex().data(), run);
      finish(std::move(*surface), surface->live);
    } else {
      Boundary boundary = run_engine(frame, run);
      finish(std::move(boundary), boundary.facet_count());
    }
  }
}

}  // namespace

void tell_found(const Survivors& s, std::uint64_t vertices, unsigned threads, Statistics& to) {
  to.cull_reason = s.reason + " and which is the hull";
  to.rung_counts[0] = 3 * vertices - 6;  // the ridges
  to.threads = threads;
  to.survivors = vertices;
  to.filter = s.filter;
  to.backend = s.backend;
}

Hull hull_of_lists(Filtered&& filtered, const PointView& rows, std::uint64_t count,
                   const Run& run) {
  const Clock::time_point start = Clock::now();
  const Survivors& s = filtered.survivors;
  const std::uint64_t facets = filtered.triangles.count();
  require_budget(run.budget, facets * result_bytes_per_facet(3, 3),
                 std::to_string(facets) + " facets");
  Hull hull;
  hull.dimension = 3;
  hull.point_count = count;
  write_lists(std::move(filtered.triangles), rows, s.all ? nullptr : s.ids.data(), run, hull);
  tell_found(s, s.size(count), run.threads, hull.statistics);
  hull.statistics.hull_seconds = seconds_since(start);
  return hull;
}

Hull hull_of_survivors(const PointView& points, Filtered&& filtered, const Run& run,
                       KnownHull* known) {
  if (!plane_only && !filtered.triangles.empty()) {
    const Survivors& s = filtered.survivors;
    if (filtered.rows.empty() && !s.all) gather_survivors(points, s.ids, filtered, run);
    const Array<double> rows = std::move(filtered.rows);
    Hull hull = hull_of_lists(
        std::move(filtered), s.all ? points : PointView::row_major(rows.data(), rows.size() / 3, 3),
        points.count, run);
    hull.scalar = points.scalar;
    return hull;
  }
  const Clock::time_point start = Clock::now();
  Hull hull;
  hull.dimension = points.dimension;
  hull.point_count = points.count;
  hull.scalar = points.scalar;
  hull.statistics.threads = run.threads;
  hull.statistics.survivors = filtered.survivors.size(points.count);
  hull.statistics.filter = filtered.survivors.filter;
  hull.statistics.cull_reason = filtered.survivors.reason;
  hull.statistics.backend = filtered.survivors.backend;
  if (points.count > 0 && !hull_in_plane(points, filtered, run, hull) &&
      (plane_only || !hull_few(points, filtered.survivors, run, hull)))
    hull_by_engine(points, std::move(filtered), run, known, hull);
  hull.statistics.hull_seconds = seconds_since(start);
  return hull;
}

}  // namespace cullhull::internal
