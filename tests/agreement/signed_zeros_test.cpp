// In whatever layout a -0 comes, by whatever door and path, the result has the same bits.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "agreement/all_paths.hpp"
#include "agreement/general_outcome.hpp"
#include "agreement/point_sets.hpp"
#include "cullhull/batch.hpp"
#include "cullhull/growing_hull.hpp"
#include "cullhull/stream.hpp"
#include "cullhull/track.hpp"
#include "io/json/json.hpp"

namespace cullhull::testing_support::signed_zeros_test {

/// Every other door that points come in by, against convex_hull of rows.
void expect_same_by_all_doors(const PointSet& s) {
  const PointView view = view_of(s);
  const std::string expected = outcome([&] { return convex_hull(view); });
  const auto same = [&](const char* door, const std::function<Hull()>& hull) {
    EXPECT_EQ(outcome(hull), expected) << s.name << ", " << door;
  };
  same("a batch", [&] {
    const std::uint64_t offsets[] = {0, s.count()};
    return convex_hulls(view, offsets).hull(0);
  });
  same("a batch of columns", [&] {
    const std::vector<double> columns = transposed(s.coordinates, s.dimension);
    const std::uint64_t offsets[] = {0, s.count()};
    return convex_hulls(PointView::column_major(columns.data(), s.count(), s.dimension), offsets)
        .hull(0);
  });
  same("a stream", [&] {
    HullStream stream;
    stream.push(view, 0);
    return stream.hull();
  });
  same("a tracker", [&] {
    HullTracker tracker;
    return tracker.update(view);
  });
  same("a growing hull", [&] {
    GrowingHull growing(s.dimension);
    growing.add(view);
    return growing.hull();
  });
}

void expect_same_everywhere(const PointSet& s) {
  SCOPED_TRACE(s.name);
  AllPaths(s).run();
  expect_same_by_all_doors(s);
}

/// The set with -0 in the places of its zeros that `mask` has, in turn.
PointSet signed_zeros(const PointSet& s, std::uint64_t mask) {
  PointSet out = s;
  out.name += ", zeros " + std::to_string(mask);
  for (double& v : out.coordinates) {
    if (v != 0) continue;
    v = (mask & 1) != 0 ? -0.0 : 0.0;
    mask >>= 1;
  }
  return out;
}

std::size_t zeros(const PointSet& s) {
  return static_cast<std::size_t>(std::count(s.coordinates.begin(), s.coordinates.end(), 0.0));
}

PointSet set_of(const char* name, unsigned d, const std::vector<std::vector<double>>& points) {
  PointSet s = named(name, d);
  for (const auto& p : points) s.add(p);
  return s;
}

const std::vector<PointSet>& small_sets() {
  static const std::vector<PointSet> sets = {
      set_of("point", 2, {{0, 0}, {0, 0}}),
      set_of("segment", 2, {{0, 0}, {0, 1}}),
      set_of("segment across", 2, {{-1, 0}, {1, 0}, {0, 0}}),
      set_of("triangle", 2, {{0, 0}, {0, 1}, {1, 0}}),
      set_of("triangle around", 2, {{-1, 0}, {0, -1}, {0, 2}, {1, 0}}),
      set_of("square", 2, {{0, 0}, {0, 1}, {1, 0}, {1, 1}, {0, 0}}),
      set_of("tetrahedron", 3, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}),
      set_of("triangle in space", 3, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}),
  };
  return sets;
}

TEST(SignedZeros, InEveryPositionOfSmallSets) {
  for (const PointSet& s : small_sets()) {
    const std::size_t n = zeros(s);
    ASSERT_LE(n, 12U);
    // All choices of few zeros; of many every single one, all, and some others.
    for (std::uint64_t mask = 0; mask < std::uint64_t{1} << n; ++mask) {
      const bool single = (mask & (mask - 1)) == 0, all = mask + 1 == std::uint64_t{1} << n;
      if (n > 6 && !single && !all && mask % 97 != 5) continue;
      expect_same_everywhere(signed_zeros(s, mask));
    }
  }
}

/// Of sizes that every way through the library takes: the few, the thinned, the filtered.
TEST(SignedZeros, AmongManyPoints) {
  for (const unsigned n : {20U, 60U, 300U, 3000U})
    for (unsigned d = 2; d <= 4; ++d)
      for (const bool round : {false, true}) {
        PointSet s = round ? random_set("sphere", n, d, n + d) : random_grid(n, d, 5, -2, n + d);
        Random r(n * d);
        for (double& v : s.coordinates)
          if (std::fabs(v) < 0.1) v = r.integer(0, 1) == 0 ? -0.0 : 0.0;
        s.name += " with zeros";
        expect_same_everywhere(s);
      }
}

/// Files have the coordinates of vertices, too.
TEST(SignedZeros, InResultFiles) {
  for (const PointSet& s : small_sets()) {
    const PointSet all = signed_zeros(s, ~std::uint64_t{0});
    HullStream stream;
    stream.push(view_of(all), 0);
    const HullState state = stream.state();
    const Hull hull = convex_hull(view_of(all));
    std::string of_points, of_state;
    internal::write_result_json(view_of(all), hull, [&](const std::string& t) { of_points += t; });
    internal::write_result_json(state, hull, [&](const std::string& t) { of_state += t; });
    EXPECT_EQ(of_points, of_state) << all.name;
  }
}

}  // namespace cullhull::testing_support::signed_zeros_test
