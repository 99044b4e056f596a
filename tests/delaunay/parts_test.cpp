// Triangulations put together from parts are those of one insertion: same cells, same neighbours.
#include "delaunay/parts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "cullhull/options.hpp"
#include "delaunay/cell_insertion.hpp"
#include "delaunay/final_cells.hpp"
#include "delaunay/lifted_sets.hpp"
#include "delaunay/prepare.hpp"
#include "delaunay/stored_cells.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace parts_test {

using namespace testing_support;

void check(const LiftedSet& s) {
  Options options;
  for (const unsigned threads : {1U, 2U, 3U, 16U, 64U}) {
    options.threads = threads;
    const Run run(options);
    const Prepared p =
        prepare_points(PointView::row_major(s.rows.data(), s.count(), 2), {}, false, {}, run);
    if (p.points.base != 2) return;
    CellInsertion<2> engine(p.points, run);
    engine.start(p.simplex.data(), p.points.count);
    for (std::uint32_t i = 0; i < p.points.count; ++i)
      if (std::count(p.simplex.begin(), p.simplex.end(), i) == 0) engine.insert(i);
    const auto expected = cells_of(engine.store());
    unsigned put_together = 0;
    for (unsigned levels = 0; levels <= 4; ++levels) {
      InsertionTotals totals;
      const auto store = triangulate_in_parts(p, levels, totals, run);
      if (store == nullptr) continue;
      ++put_together;
      EXPECT_TRUE(cells_of(*store) == expected) << s.name << ", " << levels << " levels";
    }
    if (s.name.find("random") == 0) {
      EXPECT_GT(put_together, 0U) << s.name;
    }
  }
}

TEST(Parts, AreThoseOfOneInsertion) {
  for (LiftedSet& s : large_lifted_sets(2, 4000)) {
    s.weights.clear();
    check(s);
  }
}

TEST(Parts, BallsThatMissABoxDoSoByMore) {
  LiftedPoints s;
  s.base = s.width = s.stride = 2;
  s.rows.assign({0.0, 0.0, 0.5, 0.0, 0.25, 0.25});  // centre (0.25, 0), radius 0.25
  const std::uint32_t cell[] = {0, 1, 2};
  EXPECT_TRUE(surely_misses(s, cell, PartBox{{0.5 + 0x1p-40, -1}, {1, 1}}));
  EXPECT_FALSE(surely_misses(s, cell, PartBox{{0.5, -1}, {1, 1}}));
  EXPECT_FALSE(surely_misses(s, cell, PartBox{{0.5 - 0x1p-40, 0}, {1, 1}}));
  EXPECT_TRUE(surely_misses(s, cell, PartBox{{0.4, 0.25}, {1, 1}}));
  s.rows.assign({0.0, 0.0, 0.5, 0.0, 0.25, 0.0});  // on a line: all of one side
  EXPECT_FALSE(surely_misses(s, cell, PartBox{{0.9, 0.9}, {1, 1}}));
}

}  // namespace parts_test
}  // namespace cullhull::internal
