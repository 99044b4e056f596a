// Points on several ranks against all of them in one process: the same bits, whatever the shares.
// CULLHULL_RANDOM_RUNS (60 if unset) says how many random runs, CULLHULL_RANDOM_SEED which.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "agreement/all_paths.hpp"
#include "agreement/canonical_hash.hpp"
#include "agreement/sets_in_pieces.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/mpi.hpp"
#include "distributed/ranks.hpp"

namespace cullhull::testing_support {
namespace {

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

/// A rank's points: of its share in one view, or cut into blocks that any rank may get.
struct Case {
  PointSet set;
  std::vector<float> floats;  ///< where the set is exact in them and this rank is to have floats
  std::vector<std::uint64_t> cuts;
  std::vector<int> owner;  ///< of the piece between two cuts; empty: the rank of that number
  bool mixed = false;      ///< ranks of odd number have floats
  bool all_floats = false;
  int root = mpi::every_rank;
};

Case random_case(Random& r, int ranks) {
  Case c;
  c.set = stream_set(r);
  const auto n = static_cast<std::uint64_t>(c.set.count());
  const bool blocks = r.integer(0, 2) == 0;
  c.cuts = random_shares(n, blocks ? r.integer(1, 20) : ranks, r);
  if (blocks)
    for (std::size_t i = 0; i + 1 < c.cuts.size(); ++i) c.owner.push_back(r.integer(0, ranks - 1));
  const int scalars = r.integer(0, 3);
  if (converted(c.set, c.floats)) {
    c.mixed = scalars == 0;
    c.all_floats = scalars == 1;
  }
  if (r.integer(0, 1)) c.root = r.integer(0, ranks - 1);
  return c;
}

PointView whole(const Case& c, bool floats) {
  return floats ? PointView::row_major(c.floats.data(), c.set.count(), c.set.dimension)
                : view_of(c.set);
}

/// The scalar type that one process would have had: f64 where ranks differ.
bool floats_together(const Case& c, int ranks) {
  if (!c.mixed) return c.all_floats;
  for (std::size_t i = 0; i + 1 < c.cuts.size(); ++i) {
    const int rank = c.owner.empty() ? static_cast<int>(i) : c.owner[i];
    if (c.cuts[i + 1] > c.cuts[i] && rank % 2 == 0) return false;
  }
  return ranks > 1 && c.cuts.back() > 0;
}

template <class Call>
auto with_share(const Case& c, int rank, const Call& call) {
  const PointView all = whole(c, c.mixed ? rank % 2 == 1 : c.all_floats);
  if (c.owner.empty()) {
    const auto k = static_cast<std::size_t>(rank);
    return call(part_of(all, c.cuts[k], c.cuts[k + 1]));
  }
  std::vector<mpi::Block> blocks;
  for (std::size_t i = 0; i < c.owner.size(); ++i)
    if (c.owner[i] == rank) blocks.push_back({part_of(all, c.cuts[i], c.cuts[i + 1]), c.cuts[i]});
  if (blocks.empty()) blocks.push_back({{nullptr, all.scalar, all.dimension, 0, 0, 0}, 0});
  return call(std::span<const mpi::Block>(blocks));
}

struct Expected {
  std::uint64_t hull = 0;
  std::vector<std::uint64_t> extreme;
  ScalarType scalar = ScalarType::f64;
  int affine = 0;
};

/// What rank 0 finds alone; the others are told.
Expected expected(const Case& c, bool floats) {
  Expected e;
  std::vector<std::uint64_t> words(4);
  if (world_rank() == 0) {
    const Hull hull = convex_hull(whole(c, floats));
    e.extreme = sorted_vertices(hull);
    words = {canonical_hash(hull), e.extreme.size(), static_cast<std::uint64_t>(hull.scalar),
             static_cast<std::uint64_t>(hull.affine_dimension + 1)};
  }
  tell_all(words);
  e.extreme.resize(words[1]);
  tell_all(e.extreme);
  e.hull = words[0];
  e.scalar = static_cast<ScalarType>(words[2]);
  e.affine = static_cast<int>(words[3]) - 1;
  return e;
}

/// All extreme points of this rank's share, and all points equal to any extreme one, are left.
void check_survivors(const Case& c, int rank, const Expected& e, const Survivors& left) {
  const auto k = static_cast<std::size_t>(rank);
  const std::uint64_t begin = c.cuts[k], count = c.cuts[k + 1] - begin;
  std::set<std::vector<double>> corners;
  for (const std::uint64_t v : e.extreme)
    corners.insert({c.set.row(v), c.set.row(v) + c.set.dimension});
  EXPECT_TRUE(std::is_sorted(left.ids.begin(), left.ids.end()));
  EXPECT_TRUE(left.ids.empty() || left.ids.back() < count);
  if (left.all) return;
  for (std::uint64_t i = 0; i < count; ++i) {
    const double* row = c.set.row(begin + i);
    const bool corner = corners.count({row, row + c.set.dimension}) > 0;
    EXPECT_TRUE(!corner || std::binary_search(left.ids.begin(), left.ids.end(), i)) << begin + i;
  }
}

void check_case(const Case& c, MPI_Comm comm, int ranks) {
  const Expected e = expected(c, floats_together(c, ranks));
  if (comm == MPI_COMM_NULL) return;
  const int rank = world_rank();
  mpi::Report report;
  mpi::JobOptions options;
  options.root = c.root;
  options.report = &report;
  const bool here = c.root == mpi::every_rank || c.root == rank;
  const Hull hull =
      with_share(c, rank, [&](const auto& mine) { return mpi::convex_hull(comm, mine, options); });
  EXPECT_EQ(report.points, c.set.count());
  if (here) {
    EXPECT_EQ(canonical_hash(hull), e.hull);
    EXPECT_EQ(hull.scalar, e.scalar);
  } else {
    EXPECT_EQ(hull.point_count, 0U);
  }
  const ExtremePoints extreme = with_share(
      c, rank, [&](const auto& mine) { return mpi::extreme_points(comm, mine, options); });
  EXPECT_EQ(extreme.ids, here ? e.extreme : std::vector<std::uint64_t>());
  EXPECT_EQ(extreme.affine_dimension, here ? e.affine : -1);
  const HullState state =
      with_share(c, rank, [&](const auto& mine) { return mpi::hull_state(comm, mine, options); });
  EXPECT_EQ(state.ids(), here ? e.extreme : std::vector<std::uint64_t>());
  if (here) {
    EXPECT_EQ(state.point_count(), c.set.count());
    EXPECT_EQ(canonical_hash(state.hull()), e.hull);
  }
  if (c.owner.empty()) {
    const PointView all = whole(c, c.mixed ? rank % 2 == 1 : c.all_floats);
    const auto k = static_cast<std::size_t>(rank);
    check_survivors(c, rank, e, mpi::cull(comm, part_of(all, c.cuts[k], c.cuts[k + 1]), options));
  }
}

TEST(MpiRuns, RandomSharesGiveTheBitsOfOneProcess) {
  const std::uint64_t runs = number_from_environment("CULLHULL_RANDOM_RUNS", 60);
  const std::uint64_t seed = number_from_environment("CULLHULL_RANDOM_SEED", 1);
  for (std::uint64_t run = 0; run < runs; ++run) {
    Random r(seed + run);
    const int ranks = r.integer(1, world_size());
    const Case c = random_case(r, ranks);
    SCOPED_TRACE("CULLHULL_RANDOM_SEED=" + std::to_string(seed + run) + " ranks " +
                 std::to_string(ranks) + ": " + c.set.name);
    const FirstRanks first(ranks);
    check_case(c, first.comm, ranks);
  }
}

/// A small ball, and every tenth point a corner of the cube around it, so that a sample has some of
/// each and few points are extreme in any dimension.
PointSet ball_in_corners(unsigned n, unsigned d) {
  PointSet s = named("ball in corners", d);
  s.coordinates = generate("ball", n, d, 5);
  for (unsigned i = 0; i < n; ++i)
    for (unsigned j = 0; j < d; ++j) {
      double& v = s.coordinates[std::size_t{i} * d + j];
      v = i % 10 != 0 ? v / 4 : i / 10 >> j & 1 ? 1 : -1;
    }
  return s;
}

// Large enough for the common map in each dimension that has one.
TEST(MpiRuns, TheCommonMapIsLaidAndChangesNothing) {
  for (unsigned d = 2; d <= 6; ++d)
    for (const bool corners : {false, true}) {
      if (!corners && d > 3) continue;
      Case c;
      c.set = corners ? ball_in_corners(60000, d) : random_set("ball", 60000, d, 5);
      Random r(d);
      const int ranks = std::min(world_size(), 4);
      c.cuts = random_shares(c.set.count(), ranks, r);
      const Expected e = expected(c, false);
      const FirstRanks first(ranks);
      if (first.comm == MPI_COMM_NULL) continue;
      mpi::Report report;
      mpi::JobOptions options;
      options.report = &report;
      const Hull hull = with_share(c, world_rank(), [&](const auto& mine) {
        return mpi::convex_hull(first.comm, mine, options);
      });
      EXPECT_EQ(canonical_hash(hull), e.hull) << d;
      EXPECT_EQ(report.common > d, ranks > 1) << d;
      EXPECT_EQ(report.ranks, ranks);
    }
}

TEST(MpiRuns, BytesSentAreFew) {
  const int ranks = std::min(world_size(), 4);
  const FirstRanks first(ranks);
  if (first.comm == MPI_COMM_NULL) return;
  constexpr std::uint64_t n = 1000000;  // a rank
  const std::vector<double> rows =
      generate("ball", n, 3, 7 + static_cast<std::uint64_t>(world_rank()));
  mpi::Report report;
  mpi::JobOptions options;
  options.report = &report;
  options.root = 0;
  (void)mpi::convex_hull(first.comm, PointView::row_major(rows.data(), n, 3), options);
  const auto input = static_cast<std::uint64_t>(ranks) * rows.size() * sizeof(double);
  EXPECT_LE(report.bytes, input / 100);
  EXPECT_GE(report.bytes, ranks > 1 ? report.contributed * 32 / 4 : 0);
}

TEST(MpiRuns, NoPointsAtAll) {
  mpi::JobOptions options;
  const PointView none{nullptr, ScalarType::f32, 3, 0, 0, 0};
  const Hull hull =
      mpi::convex_hull(MPI_COMM_WORLD, world_rank() % 2 == 0 ? none : PointView{}, options);
  EXPECT_EQ(canonical_hash(hull), canonical_hash(convex_hull(none)));
  EXPECT_EQ(hull.scalar, ScalarType::f32);
}

TEST(MpiRuns, IdsAreAsGiven) {
  // Rank k has the k-th point from the end; all but two lie on a segment.
  const int ranks = world_size(), rank = world_rank();
  const double point[2] = {static_cast<double>(rank), rank == 1 ? 5.0 : 0.0};
  mpi::JobOptions options;
  options.first_id = static_cast<std::uint64_t>(1000 - 3 * rank);
  const ExtremePoints found =
      mpi::extreme_points(MPI_COMM_WORLD, PointView::row_major(point, 1, 2), options);
  std::vector<double> rows;
  for (int k = ranks - 1; k >= 0; --k) {
    rows.push_back(k);
    rows.push_back(k == 1 ? 5 : 0);
  }
  ExtremePoints alone =
      extreme_points(PointView::row_major(rows.data(), static_cast<std::uint64_t>(ranks), 2));
  for (std::uint64_t& id : alone.ids) id = 1000 - 3 * (static_cast<std::uint64_t>(ranks) - 1 - id);
  EXPECT_EQ(found.ids, alone.ids);
}

TEST(MpiRuns, CertifiedByEachRankForItself) {
  const std::uint64_t n = 5000;
  std::vector<double> rows = generate("ball", n, 3, 3);
  const PointView all = PointView::row_major(rows.data(), n, 3);
  const auto rank = static_cast<std::uint64_t>(world_rank());
  const auto ranks = static_cast<std::uint64_t>(world_size());
  const mpi::Block mine{part_of(all, n * rank / ranks, n * (rank + 1) / ranks), n * rank / ranks};
  const std::span<const mpi::Block> blocks{&mine, 1};
  mpi::JobOptions options;
  options.root = static_cast<int>(ranks) - 1;
  const Hull hull = mpi::convex_hull(MPI_COMM_WORLD, blocks, options);
  std::vector<double> corners;
  for (const std::uint64_t v : hull.vertices)
    corners.insert(corners.end(), rows.begin() + static_cast<std::ptrdiff_t>(3 * v),
                   rows.begin() + static_cast<std::ptrdiff_t>(3 * v + 3));
  Certificate found = mpi::certify(MPI_COMM_WORLD, blocks, hull, corners, options);
  EXPECT_TRUE(found.valid) << found.reason;
  EXPECT_EQ(found.points_checked, n);
  EXPECT_GT(found.ridges_checked, 100U);
  // A point of the last rank leaves the hull, then a point of the first as well.
  rows[3 * (n - 1)] = 9;
  found = mpi::certify(MPI_COMM_WORLD, blocks, hull, corners, options);
  EXPECT_FALSE(found.valid);
  EXPECT_NE(found.reason.find("4999"), std::string::npos) << found.reason;
  rows[3] = 9;
  found = mpi::certify(MPI_COMM_WORLD, blocks, hull, corners, options);
  EXPECT_NE(found.reason.find("point 1 "), std::string::npos) << found.reason;
}

}  // namespace
}  // namespace cullhull::testing_support

int main(int argc, char** argv) { return cullhull::testing_support::run_on_all_ranks(argc, argv); }
