// Points without an address, through every public function that reads points.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cullhull/alpha_shape.hpp"
#include "cullhull/batch.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/constrained.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/growing_hull.hpp"
#include "cullhull/halfspaces.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/interpolate.hpp"
#include "cullhull/proximity_graphs.hpp"
#include "cullhull/query.hpp"
#include "cullhull/simplify.hpp"
#include "cullhull/stream.hpp"
#include "cullhull/track.hpp"
#include "cullhull/triangulation_query.hpp"
#include "cullhull/voronoi.hpp"
#include "thrown.hpp"

namespace cullhull::null_points_test {

using testing_support::error_of;
using testing_support::has;

constexpr std::uint64_t count = 50;

class NullPoints : public ::testing::Test {
 protected:
  template <class Call>
  void refused(const Call& call) {
    const std::string line = error_of(ErrorCode::invalid_argument, call);
    EXPECT_TRUE(has(line, "points.data is null")) << line;
  }

  const std::vector<double> rows = generate("ball", count, 2, 1);
  const PointView points = PointView::row_major(rows.data(), count, 2);
  const PointView null = PointView::row_major<double>(nullptr, count, 2);
  const Hull hull = convex_hull(points);
  const Triangulation mesh = delaunay(points);
  std::vector<double> numbers = std::vector<double>(4 * count);
  std::vector<std::uint32_t> ids = std::vector<std::uint32_t>(count);
  const std::vector<std::uint64_t> offsets{0, count}, later{7, count};
  const std::vector<double> low{-1, -1}, high{1, 1};
};

TEST_F(NullPoints, GiveNoHull) {
  refused([&] { convex_hull(null); });
  refused([&] { cull(null); });
  refused([&] { extreme_points(null); });
  refused([&] { convex_hulls(null, later); });
  refused([&] { intersect_halfspaces(PointView::row_major<double>(nullptr, count, 3)); });
  refused([&] { GrowingHull(2).add(null); });
  refused([&] { HullState s(null); });
  refused([&] { HullStream().push(null); });
  refused([&] { HullTracker().update(null); });
  refused([&] { simplify(null, hull, 0.1); });
  refused([&] { shared_planes(null, hull, 0.1); });
  refused([&] { rounding_distance(null, hull); });
  refused([&] { certify(null, hull); });
}

TEST_F(NullPoints, AskAHullNothing) {
  refused([&] { HullQuery query(null, hull); });
  const HullQuery query(points, hull);
  std::vector<std::uint8_t> inside(count);
  std::vector<Side> sides(count);
  std::vector<std::uint64_t> vertices(count);
  std::vector<NearestFacet> facets(count);
  std::vector<RayHit> hits(count);
  refused([&] { query.contains(null, inside.data()); });
  refused([&] { query.sides(null, sides.data()); });
  refused([&] { query.supports(null, vertices.data()); });
  refused([&] { query.nearest_facets(null, facets.data()); });
  refused([&] { query.signed_distances(null, numbers.data()); });
  refused([&] { query.rays(null, points, hits.data()); });
  refused([&] { query.rays(points, null, hits.data()); });
}

TEST_F(NullPoints, GiveNoTriangulationAndNothingMadeOfOne) {
  refused([&] { delaunay(null); });
  refused([&] { regular_triangulation(null, std::vector<double>(count)); });
  refused([&] { constrained_delaunay(null, std::vector<std::uint32_t>{0, 1}); });
  refused([&] { certify(null, mesh); });
  refused([&] { voronoi(null, mesh); });
  refused([&] { clip_voronoi(null, mesh, low, high); });
  refused([&] { clip_voronoi(points, mesh, null); });
  refused([&] { clip_voronoi(points, mesh, null, offsets); });
  refused([&] { alpha_shape(null, mesh, 0.1); });
  refused([&] { alpha_radii(null, mesh); });
  refused([&] { critical_alpha(null, mesh, true); });
  refused([&] { concave_hull(null, mesh, 0.1); });
  refused([&] { concave_length(null, mesh, 0.5); });
  refused([&] { without_long_edges(null, mesh, 0.1); });
  refused([&] { minimum_spanning_tree(null, mesh); });
  refused([&] { gabriel_graph(null, mesh); });
  refused([&] { relative_neighbourhood_graph(null, mesh); });
  refused([&] { Interpolator(null, mesh, numbers.data(), 1); });
}

TEST_F(NullPoints, AskATriangulationNothing) {
  refused([&] { TriangulationQuery query(null, mesh); });
  refused([&] { NearestPoint nearest(null); });
  const TriangulationQuery query(points, mesh);
  refused([&] { query.find(null, ids.data()); });
  refused([&] { query.barycentric(null, ids.data(), numbers.data()); });
  refused([&] { query.nearest(null, ids.data()); });
  refused([&] { query.interpolate(null, numbers.data(), 1, low, numbers.data()); });
  refused([&] { NearestPoint(points).nearest(null, ids.data()); });
  const Interpolator values(points, mesh, numbers.data(), 1);
  refused([&] { values.linear(null, numbers.data()); });
  refused([&] { values.nearest(null, numbers.data()); });
  refused([&] { values.natural(null, numbers.data()); });
}

}  // namespace cullhull::null_points_test
