// Several threads that insert into one triangulation come to the cells that one comes to.
#include "delaunay/insert_together.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/options.hpp"
#include "delaunay/lifted_sets.hpp"
#include "delaunay/prepare.hpp"
#include "delaunay/stored_cells.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace insert_together_test {

using namespace testing_support;

struct Set {
  Prepared points;
  std::vector<std::uint32_t> places;  ///< but those of the first simplex
};

Set prepared(const LiftedSet& s, const Run& run) {
  Set p{prepare_points(PointView::row_major(s.rows.data(), s.count(), s.dimension), s.weights,
                       false, {}, run),
        {}};
  const auto& simplex = p.points.simplex;
  for (std::uint32_t i = 0; i < p.points.points.count; ++i)
    if (std::find(simplex.begin(), simplex.end(), i) == simplex.end()) p.places.push_back(i);
  return p;
}

/// `alone`: points that one thread inserts first; `spare` as InsertTogether has it.
template <unsigned K>
void check(const LiftedSet& s, std::size_t alone, std::uint64_t spare) {
  const Run& one = short_run();
  const Set p = prepared(s, one);
  if (p.points.points.base != K) return;
  CellInsertion<K> expected(p.points.points, one);
  expected.start(p.points.simplex.data(), p.points.points.count);
  for (const std::uint32_t i : p.places) expected.insert(i);
  const auto cells = cells_of(expected.store());
  for (const unsigned threads : {1U, 2U, 3U, 8U}) {
    Options options;
    options.threads = threads;
    const Run run(options);
    CellInsertion<K> engine(p.points.points, run);
    engine.start(p.points.simplex.data(), p.points.points.count);
    const std::size_t first = std::min(alone, p.places.size());
    for (std::size_t i = 0; i < first; ++i) engine.insert(p.places[i]);
    InsertTogether<K> together(p.points.points, run, engine, spare);
    together.insert(std::span(p.places).subspan(first), static_cast<std::uint32_t>(first));
    EXPECT_TRUE(cells_of(engine.store()) == cells) << s.name << ", " << threads << " threads";
    EXPECT_EQ(engine.store().living(), expected.store().living()) << s.name;
  }
}

template <unsigned K>
void check_sets(unsigned n) {
  for (const LiftedSet& s : large_lifted_sets(K, n)) {
    check<K>(s, 100, 1 << 14);
    check<K>(s, 0, 0);  // every lane in every other's way, and soon without cells
  }
}

TEST(InsertTogether, InThePlane) { check_sets<2>(3000); }
TEST(InsertTogether, InSpace) { check_sets<3>(3000); }
TEST(InsertTogether, In4D) { check_sets<4>(400); }
TEST(InsertTogether, In5D) { check_sets<5>(120); }

TEST(InsertTogether, HardlyAnyPoints) {
  for (unsigned n = 4; n < 12; ++n) check<3>(random_points(3, n, n), 0, 0);
}

// A budget that has no room for twice the cells is one for a thread alone all the same.
TEST(InsertTogether, KeepsTheBudget) {
  const LiftedSet s = random_points(3, 3000, 2);
  Options options;
  options.threads = 2;
  const std::uint64_t cells = 3000 * 7 + 64;  // what one thread has room for
  options.memory_budget = cells * bytes_per_cell(3);
  const internal::Run run(options);
  const Set p = prepared(s, run);
  CellInsertion<3> engine(p.points.points, run);
  engine.start(p.points.simplex.data(), p.points.points.count);
  InsertTogether<3> together(p.points.points, run, engine);
  together.insert(p.places, 0);
  EXPECT_LE(engine.store().capacity(), cells);
  EXPECT_GT(engine.store().living(), 18000U);
}

TEST(InsertTogether, StopsWhenAsked) {
  const LiftedSet s = random_points(3, 20000, 1);
  std::stop_source source;
  Options options;
  options.threads = 2;
  options.stop = source.get_token();
  const internal::Run run(options);
  const Set p = prepared(s, run);
  CellInsertion<3> engine(p.points.points, run);
  engine.start(p.points.simplex.data(), p.points.points.count);
  InsertTogether<3> together(p.points.points, run, engine);
  source.request_stop();
  EXPECT_THROW(together.insert(p.places, 0), Error);
}

}  // namespace insert_together_test
}  // namespace cullhull::internal
