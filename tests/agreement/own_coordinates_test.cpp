// A hull that carries its vertices' coordinates answers, is verified and written as with its
// points.
#include <gtest/gtest.h>

#include "agreement/all_paths.hpp"
#include "agreement/point_sets.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/io.hpp"
#include "cullhull/query.hpp"
#include "cullhull/simplify.hpp"
#include "cullhull/stream.hpp"
#include "cullhull/track.hpp"
#include "io_fixtures.hpp"

namespace cullhull::testing_support::own_coordinates_test {

using testing::slurp;
using testing::TemporaryFolder;

Options carrying() {
  Options options;
  options.with_coordinates = true;
  return options;
}

std::vector<PointSet> some_sets() {
  std::vector<PointSet> sets;
  for (unsigned d = 1; d <= 5; ++d)
    for (const unsigned n : {1U, 2U, 7U, 60U, 3000U}) {
      if (d > 3 && n > 100) continue;
      for (const char* shape : {"ball", "sphere", "cube"})
        sets.push_back(random_set(shape, n, d, n));
      sets.push_back(random_grid(n, d, 4, 0, n));
    }
  return sets;
}

TEST(OwnCoordinates, AreThoseOfTheVertices) {
  for (const PointSet& s : some_sets()) {
    const PointView view = view_of(s);
    const Hull plain = convex_hull(view), hull = convex_hull(view, carrying());
    EXPECT_EQ(canonical_hash(hull), canonical_hash(plain)) << s.name;
    EXPECT_TRUE(plain.vertex_coordinates.empty());
    ASSERT_TRUE(hull.has_coordinates()) << s.name;
    for (std::size_t i = 0; i < hull.vertices.size(); ++i)
      for (unsigned j = 0; j < s.dimension; ++j)
        ASSERT_EQ(hull.coordinates(i)[j], view.at(hull.vertices[i], j)) << s.name;
  }
}

TEST(OwnCoordinates, OtherDoors) {
  const PointSet s = random_set("ball", 5000, 3, 1);
  const Hull expected = convex_hull(view_of(s), carrying());
  HullTracker tracker(carrying());
  EXPECT_EQ(tracker.update(view_of(s)).vertex_coordinates, expected.vertex_coordinates);
  EXPECT_EQ(tracker.update(view_of(s)).vertex_coordinates, expected.vertex_coordinates);
  HullStream stream(carrying());
  stream.push(view_of(s));
  EXPECT_EQ(stream.hull().vertex_coordinates, expected.vertex_coordinates);
  EXPECT_EQ(HullState(view_of(s)).hull(carrying()).vertex_coordinates, expected.vertex_coordinates);
  EXPECT_EQ(HullState(expected), HullState(view_of(s)));
}

TEST(OwnCoordinates, QuestionsNeedNoPoints) {
  for (const PointSet& s : some_sets()) {
    const PointView view = view_of(s);
    const Hull hull = convex_hull(view, carrying());
    const HullQuery with(view, hull), without(hull);
    for (std::uint64_t i = 0; i < std::min<std::uint64_t>(s.count(), 40); ++i) {
      std::vector<double> q(s.dimension);
      for (unsigned j = 0; j < s.dimension; ++j) q[j] = view.at(i, j) * (i % 3 == 0 ? 1.5 : 1);
      EXPECT_EQ(with.side(q.data()), without.side(q.data())) << s.name;
      EXPECT_EQ(with.support(q.data()), without.support(q.data())) << s.name;
      EXPECT_EQ(with.signed_distance(q.data()), without.signed_distance(q.data())) << s.name;
    }
  }
  const Hull bare = convex_hull(view_of(random_set("ball", 50, 3, 1)));
  EXPECT_THROW(HullQuery{bare}, Error);
}

TEST(OwnCoordinates, Certificate) {
  for (const PointSet& s : some_sets()) {
    Hull hull = convex_hull(view_of(s), carrying());
    const Certificate good = certify(hull);
    EXPECT_TRUE(good.valid) << s.name << ": " << good.reason;
    if (hull.affine_dimension < 2) continue;
    Hull moved = hull;  // a vertex at the place of another one
    std::copy_n(moved.vertex_coordinates.begin() + s.dimension, s.dimension,
                moved.vertex_coordinates.begin());
    EXPECT_FALSE(certify(moved).valid) << s.name;
    Hull foreign = hull;
    foreign.simplices.edit()[0] = s.count() + 5;
    EXPECT_FALSE(certify(foreign).valid) << s.name;
  }
  EXPECT_THROW(certify(convex_hull(view_of(random_set("ball", 50, 3, 1)))), Error);
}

TEST(OwnCoordinates, FilesHaveTheSameBytes) {
  const TemporaryFolder folder;
  const std::string a = folder.file("a"), b = folder.file("b");
  for (const unsigned d : {2U, 3U}) {
    const PointSet s = random_set("sphere", 200, d, 1);
    const Hull hull = convex_hull(view_of(s), carrying());
    for (const char* format : {"ply", "obj", "off", "json", "txt", "i", "n", "p", "Fx", "FV"}) {
      write_hull(a, view_of(s), hull, format);
      write_hull(b, hull, format);
      EXPECT_EQ(slurp(a), slurp(b)) << d << "D " << format;
    }
    EXPECT_THROW(write_hull(b, hull, "o"), Error);  // lists every point
    EXPECT_THROW(write_hull(b, convex_hull(view_of(s)), "ply"), Error);
    write_hull(a, view_of(s), hull, "json");
    EXPECT_EQ(hull_from_json(a, nullptr, carrying()).vertex_coordinates, hull.vertex_coordinates);
    EXPECT_TRUE(hull_from_json(a).vertex_coordinates.empty());
  }
}

// A hull of a stream has as many points as it has seen, and their own ids.
TEST(OwnCoordinates, PointsWithOtherIdsAreRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a");
  const PointSet s = random_set("sphere", 200, 3, 1);
  const Hull hull = HullState(view_of(s), 1000, carrying()).hull();
  EXPECT_THROW(HullQuery(view_of(s), hull), Error);
  EXPECT_THROW(simplify(view_of(s), hull, 0.1), Error);
  EXPECT_FALSE(certify(view_of(s), hull).valid);
  for (const char* format : {"ply", "json", "p"})
    EXPECT_THROW(write_hull(path, view_of(s), hull, format), Error) << format;
  for (const char* words : {"p", "FV", "Fa"})
    EXPECT_THROW(hull_to_qhull_text(view_of(s), hull, words), Error) << words;
}

}  // namespace cullhull::testing_support::own_coordinates_test
