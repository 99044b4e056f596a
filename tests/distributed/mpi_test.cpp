// Points on several ranks against all of them in one process: the same bits, whatever the shares;
// and an error on one rank is the same error on all of them, and none of them waits for ever.
// CULLHULL_RANDOM_RUNS (40 if unset) says how many random runs, CULLHULL_RANDOM_SEED which.
#include "cullhull/mpi.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <stop_token>

#include "agreement/all_paths.hpp"
#include "agreement/canonical_hash.hpp"
#include "agreement/sets_in_pieces.hpp"
#include "distributed/ranks.hpp"

namespace cullhull::testing_support {
namespace {

// ------------------------------------------------------------------------------- the same bits

/// Where the shares of the ranks begin, and their end: even, uneven, some or most of them empty.
std::vector<std::uint64_t> random_shares(std::uint64_t n, int ranks, Random& r) {
  std::vector<std::uint64_t> cuts{0};
  const int style = r.integer(0, 3);
  for (int k = 1; k < ranks; ++k) {
    const auto even = n * static_cast<std::uint64_t>(k) / static_cast<std::uint64_t>(ranks);
    const auto anywhere = static_cast<std::uint64_t>(r.unit() * static_cast<double>(n + 1));
    cuts.push_back(style == 0   ? even
                   : style == 1 ? std::min(n, anywhere)
                   : style == 2 ? std::min<std::uint64_t>(n, static_cast<std::uint64_t>(k))
                                : (r.integer(0, 1) ? n : 0));
  }
  cuts.push_back(n);
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

/// A set, the shares of the ranks, and which of them have floats.
struct Case {
  PointSet set;
  std::vector<float> floats;  ///< where the set is exact in them
  std::vector<std::uint64_t> cuts;
  bool mixed = false;  ///< ranks of odd number have floats
  bool all_floats = false;
  int root = mpi::every_rank;

  PointView whole(bool in_floats) const {
    return in_floats ? PointView::row_major(floats.data(), set.count(), set.dimension)
                     : view_of(set);
  }
  PointView share(int rank) const {
    const auto k = static_cast<std::size_t>(rank);
    return part_of(whole(mixed ? rank % 2 == 1 : all_floats), cuts[k], cuts[k + 1]);
  }
  /// The scalar type that one process would have had: f64 where ranks differ.
  bool floats_together(int ranks) const {
    if (!mixed) return all_floats;
    for (std::size_t k = 0; k + 1 < cuts.size(); k += 2)
      if (cuts[k + 1] > cuts[k]) return false;
    return ranks > 1 && cuts.back() > 0;
  }
};

Case random_case(Random& r, int ranks) {
  Case c;
  c.set = stream_set(r);
  c.cuts = random_shares(static_cast<std::uint64_t>(c.set.count()), ranks, r);
  const int scalars = r.integer(0, 3);
  if (converted(c.set, c.floats)) {
    c.mixed = scalars == 0;
    c.all_floats = scalars == 1;
  }
  if (r.integer(0, 1)) c.root = r.integer(0, ranks - 1);
  return c;
}

struct Expected {
  std::uint64_t hull = 0;
  ScalarType scalar = ScalarType::f64;
};

/// What rank 0 finds alone; the others are told.
Expected expected(const Case& c, bool floats) {
  std::vector<std::uint64_t> words(2);
  if (world_rank() == 0) {
    const Hull hull = convex_hull(c.whole(floats));
    words = {canonical_hash(hull), static_cast<std::uint64_t>(hull.scalar)};
  }
  tell_all(words);
  return {words[0], static_cast<ScalarType>(words[1])};
}

TEST(Mpi, RandomSharesGiveTheBitsOfOneProcess) {
  const std::uint64_t runs = number_from_environment("CULLHULL_RANDOM_RUNS", 40);
  const std::uint64_t seed = number_from_environment("CULLHULL_RANDOM_SEED", 1);
  for (std::uint64_t run = 0; run < runs; ++run) {
    Random r(seed + run);
    const int ranks = r.integer(1, world_size());
    const Case c = random_case(r, ranks);
    SCOPED_TRACE("CULLHULL_RANDOM_SEED=" + std::to_string(seed + run) + " ranks " +
                 std::to_string(ranks) + ": " + c.set.name);
    const Expected e = expected(c, c.floats_together(ranks));
    const FirstRanks first(ranks);
    if (first.comm == MPI_COMM_NULL) continue;
    const int rank = world_rank();
    const bool here = c.root == mpi::every_rank || c.root == rank;
    const Hull hull = mpi::hull(c.share(rank), first.comm, {}, c.root);
    const auto first_id = c.cuts[static_cast<std::size_t>(rank)];
    const HullState state = mpi::merge(HullState(c.share(rank), first_id), first.comm, {}, c.root);
    if (here) {
      EXPECT_EQ(canonical_hash(hull), e.hull);
      EXPECT_EQ(hull.scalar, e.scalar);
      EXPECT_EQ(state.point_count(), c.set.count());
      EXPECT_EQ(canonical_hash(state.hull()), e.hull);
    } else {
      EXPECT_EQ(hull.point_count, 0U);
      EXPECT_EQ(state.dimension(), 0U);
    }
  }
}

TEST(Mpi, NoPointsAtAll) {
  const PointView none{nullptr, ScalarType::f32, 3, 0, 0, 0};
  const Hull hull = mpi::hull(world_rank() % 2 == 0 ? none : PointView{}, MPI_COMM_WORLD);
  EXPECT_EQ(canonical_hash(hull), canonical_hash(convex_hull(none)));
}

// ------------------------------------------------------------------------------- errors

constexpr std::uint64_t points_a_rank = 5000;

std::vector<double> own_points(const char* shape = "ball") {
  return generate(shape, points_a_rank, 3, 100 + static_cast<std::uint64_t>(world_rank()));
}
PointView view_of_rows(const std::vector<double>& rows) {
  return PointView::row_major(rows.data(), rows.size() / 3, 3);
}
std::string error_of_hull(const PointView& points, const Options& options = {},
                          int root = mpi::every_rank) {
  return error_of([&] { (void)mpi::hull(points, MPI_COMM_WORLD, options, root); });
}
/// Whether the error on this rank, and so on all, begins so.
void expect_error(const std::string& found, ErrorCode code, const std::string& text) {
  EXPECT_EQ(found.find(error_text(code, text)), 0U) << found;
}

TEST(Mpi, NotANumberOnOneRankIsNamedOnAll) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    std::vector<double> rows = own_points();
    if (world_rank() == 3)
      for (std::size_t i = 3 * 17; i < rows.size(); i += 3) rows[i + 1] = bad;
    if (world_rank() > 3) rows[0] = bad;
    expect_error(error_of_hull(view_of_rows(rows)), ErrorCode::not_finite,
                 "rank 3: point " + std::to_string(3 * points_a_rank + 17) + ", coordinate 1");
  }
}

TEST(Mpi, ABudgetRefusedOnOneRankIsRefusedOnAll) {
  const std::vector<double> rows = own_points("sphere");
  for (int poor = 0; poor < world_size(); ++poor) {
    Options options;
    if (world_rank() == poor) options.memory_budget = 100000;
    expect_error(error_of_hull(view_of_rows(rows), options), ErrorCode::out_of_budget,
                 "rank " + std::to_string(poor) + ": ");
  }
}

// Enough for its own points, too little for those of others: refused while states travel.
TEST(Mpi, NoRoomForOthersPoints) {
  const std::vector<double> rows =
      world_rank() == 0 ? generate("sphere", 10, 3, 1) : own_points("sphere");
  Options options;
  if (world_rank() == 0) options.memory_budget = 100000;
  expect_error(error_of_hull(view_of_rows(rows), options), ErrorCode::out_of_budget, "rank 0: ");
}

TEST(Mpi, ARankThatIsStoppedEndsTheCallOnAll) {
  std::stop_source stop;
  Options options;
  options.stop = stop.get_token();
  if (world_rank() == 2) stop.request_stop();
  expect_error(error_of_hull(view_of_rows(own_points()), options), ErrorCode::cancelled,
               "rank 2: cancelled");
}

TEST(Mpi, AnExceptionOfTheCallersPassesThroughThere) {
  Options options;
  if (world_rank() == 1)
    options.progress = [](const char*, double) { throw std::runtime_error("mine"); };
  std::string found;
  try {
    (void)mpi::hull(view_of_rows(own_points()), MPI_COMM_WORLD, options);
  } catch (const Error& e) {
    found = error_text(e.code(), e.what());
  } catch (const std::runtime_error& e) {
    found = e.what();
  }
  EXPECT_EQ(found, world_rank() == 1 ? "mine" : error_text(ErrorCode::cancelled, "rank 1: mine"));
}

TEST(Mpi, ArgumentsThatDoNotFitTogether) {
  const std::vector<double> rows = own_points();
  const PointView mine = view_of_rows(rows);
  const bool is_last = world_rank() == world_size() - 1;
  expect_error(error_of_hull(is_last ? PointView::row_major(rows.data(), 10, 2) : mine),
               ErrorCode::invalid_argument, "rank ");
  expect_error(error_of_hull(PointView{}), ErrorCode::invalid_argument, "rank 0: ");
  expect_error(error_of_hull(mine, {}, is_last ? 1 : 0), ErrorCode::invalid_argument,
               "rank 0: the ranks differ in their root");
  for (const int root : {world_size(), -2})
    expect_error(error_of_hull(mine, {}, root), ErrorCode::invalid_argument,
                 "rank 0: root " + std::to_string(root) + " is no rank of ");
  PointView null = mine;
  if (is_last) null.data = nullptr;
  expect_error(error_of_hull(null), ErrorCode::invalid_argument,
               "rank " + std::to_string(world_size() - 1) + ": points.data is null");
  // Of ids that two ranks share, all learn.
  expect_error(error_of([&] { (void)mpi::merge(HullState(mine), MPI_COMM_WORLD); }),
               ErrorCode::invalid_argument, "rank ");
  // After all of these the communicator is as good as before.
  EXPECT_EQ(mpi::hull(mine, MPI_COMM_WORLD).point_count,
            points_a_rank * static_cast<std::uint64_t>(world_size()));
}

}  // namespace
}  // namespace cullhull::testing_support

int main(int argc, char** argv) { return cullhull::testing_support::run_on_all_ranks(argc, argv); }
