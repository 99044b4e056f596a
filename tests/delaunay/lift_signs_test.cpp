// In-sphere and power tests by elimination, by lanes of double-doubles and by stored planes: right
// wherever they tell, and nearly always telling.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "cullhull/triangulation.hpp"
#include "delaunay/brute_triangulation.hpp"
#include "delaunay/cell_planes.hpp"
#include "delaunay/common_sphere.hpp"
#include "delaunay/lifted_sets.hpp"
#include "exact/insphere/eliminated_sign.hpp"
#include "exact/insphere/lift_filter.hpp"
#include "exact/insphere/lift_sides.hpp"

namespace cullhull {
namespace lift_signs_test {

using namespace testing_support;
using internal::LiftedPoints;
using internal::Sign;

LiftedPoints lifted(const LiftedSet& s, unsigned base) {
  LiftedPoints p;
  p.base = base;
  p.width = s.dimension;
  p.weighted = !s.weights.empty();
  p.stride = s.dimension + (p.weighted ? 1 : 0);
  p.count = static_cast<std::uint32_t>(s.count());
  p.filtered = true;
  p.rows.resize(std::size_t{p.count} * p.stride);
  for (std::uint64_t i = 0; i < s.count(); ++i) {
    std::copy_n(s.rows.data() + i * s.dimension, s.dimension, p.rows.data() + i * p.stride);
    if (p.weighted) p.rows[i * p.stride + s.dimension] = s.weights[i];
  }
  return p;
}

/// By its definition, in rational numbers.
Sign slow_side(const LiftedPoints& s, const double* const* c, const double* p) {
  std::vector<Rationals> m;
  for (unsigned i = 0; i <= s.base; ++i) {
    const double* q = i < s.base ? c[i + 1] : p;
    Rationals row;
    mpq_class lift = 0;
    for (unsigned j = 0; j < s.width; ++j) {
      const mpq_class v = mpq_class(q[j]) - mpq_class(c[0][j]);
      if (j < s.base) row.push_back(v);
      lift += v * v;
    }
    if (s.weighted) lift -= mpq_class(q[s.width]) - mpq_class(c[0][s.width]);
    row.push_back(lift);
    m.push_back(row);
  }
  mpq_class determinant;
  echelon(m, &determinant);
  return internal::sign_of(sgn(determinant));
}

struct Told {
  int known = 0, asked = 0;
};

/// Cells of random points of the set, and a point of it; `distinct`: no point twice.
Told check_signs(const LiftedSet& set, unsigned base, int trials, bool distinct = false) {
  const LiftedPoints s = lifted(set, base);
  std::mt19937_64 random(base);
  Told told;
  std::vector<const double*> c(base + 1);
  std::vector<std::uint32_t> order(s.count);
  std::iota(order.begin(), order.end(), 0U);
  for (int t = 0; t < trials; ++t) {
    for (unsigned i = 0; i <= base + 1; ++i)
      std::swap(order[i], order[i + random() % (s.count - i)]);
    const auto drawn = [&](unsigned i) {
      return s.row(distinct ? order[i] : static_cast<std::uint32_t>(random() % s.count));
    };
    for (unsigned i = 0; i <= base; ++i) c[i] = drawn(i);
    const double* p = drawn(base + 1);
    Sign sign = Sign::zero;
    ++told.asked;
    if (internal::lift_side_eliminated(s, c.data(), p, sign)) {
      ++told.known;
      EXPECT_EQ(sign, slow_side(s, c.data(), p)) << set.name << " trial " << t;
      EXPECT_EQ(sign, internal::lift_side_exact(s, c.data(), p)) << set.name << " trial " << t;
    }
    c.push_back(p);
    if (internal::base_orientation_eliminated(base, c.data(), sign)) {
      EXPECT_EQ(sign, internal::orientation_exact(base, c.data())) << set.name << " trial " << t;
    }
    c.pop_back();
  }
  return told;
}

/// Columns multiplied by powers of two from 2^-`by` on, which no determinant's sign depends on but
/// for the lift.
LiftedSet stretched(LiftedSet s, int by) {
  for (std::size_t i = 0; i < s.rows.size(); ++i)
    s.rows[i] = std::ldexp(s.rows[i], -static_cast<int>(i % s.dimension) * by);
  s.name += " stretched by 2^" + std::to_string(by);
  return s;
}

/// As many points off a common sphere by as little as doubles can tell.
LiftedSet nearly_cospherical(unsigned d, unsigned n, std::uint64_t seed) {
  LiftedSet s = random_points(d, n, seed);
  for (std::uint64_t i = 0; i < n; ++i) {
    double square = 0;
    for (unsigned j = 0; j < d; ++j) square += std::pow(s.rows[i * d + j] -= 0.5, 2);
    for (unsigned j = 0; j < d; ++j) s.rows[i * d + j] /= std::sqrt(square);
  }
  s.name = "nearly cospherical";
  return s;
}

TEST(EliminatedSign, IsRightWhereItTells) {
  for (const unsigned d : {7U, 8U, 9U, 12U}) {
    std::vector<LiftedSet> sets = large_lifted_sets(d, 40);
    sets.push_back(nearly_cospherical(d, 60, 1));
    sets.push_back(stretched(random_points(d, 60, 2), 8));
    sets.push_back(stretched(random_points(d, 60, 3), 70));   // to 1e-150 and beyond
    sets.push_back(stretched(random_points(d, 60, 4), 140));  // squares underflow
    LiftedSet doubled = random_points(d, 20, 4);
    doubled.rows.insert(doubled.rows.end(), doubled.rows.begin(), doubled.rows.end());
    sets.push_back(doubled);
    LiftedSet far = random_points(d, 40, 5);
    for (double& x : far.rows) x += 0x1p40;
    sets.push_back(far);
    for (const LiftedSet& s : sets) check_signs(s, d, 120);
    if (d > 7) check_signs(random_points(d, 60, 6), d - 1, 120);  // a flat's squares have more axes
  }
}

TEST(EliminatedSign, TellsOfRandomPoints) {
  for (const unsigned d : {7U, 8U, 9U, 12U, 20U}) {
    const LiftedSet s = random_points(d, 60, 1);
    for (const LiftedSet& set : {s, with_weights(s, 0.02, 2, false)}) {
      const Told told = check_signs(set, d, 100, true);
      EXPECT_EQ(told.known, told.asked) << set.name;
    }
  }
}

TEST(EliminatedSign, RefusesWhatIsOutsideItsProof) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, 1e300, 1e-300}) {
    std::vector<double> m(64, 0.0), doubt(8, 0.0);
    for (unsigned i = 0; i < 8; ++i) m[9 * i] = 1;
    m[0] = bad;
    Sign sign = Sign::zero;
    EXPECT_FALSE(internal::eliminated_sign(8, m.data(), doubt.data(), sign)) << bad;
  }
  std::vector<double> m(64, 1.0), doubt(8, 0.0);
  Sign sign = Sign::zero;
  EXPECT_FALSE(internal::eliminated_sign(8, m.data(), doubt.data(), sign));  // of rank 1
  EXPECT_FALSE(internal::eliminated_sign(0, m.data(), doubt.data(), sign));
}

/// The same and `n` points that are anywhere in the ball's box, in turn with the others.
LiftedSet with_others(const LiftedSet& s, unsigned n, std::uint64_t seed) {
  const LiftedSet others = random_points(s.dimension, n, seed);
  LiftedSet all{s.name + " and others", s.dimension, {}, {}};
  const std::uint64_t d = s.dimension;
  for (std::uint64_t i = 0; i < std::max(s.count(), others.count()); ++i) {
    for (std::uint64_t j = i * d; j < (i + 1) * d && j < s.rows.size(); ++j)
      all.rows.push_back(s.rows[j]);
    for (std::uint64_t j = i * d; j < (i + 1) * d && j < others.rows.size(); ++j)
      all.rows.push_back(2 * others.rows[j] - 1);
  }
  return all;
}

void find_sphere(LiftedPoints& s) {
  const Options options;
  const internal::Run run(options);
  std::vector<std::uint32_t> simplex;
  for (std::uint32_t i = 0; i <= s.base; ++i) simplex.push_back(2 * i);  // as with_others() has it
  internal::find_common_sphere(s, simplex, run);
}

/// As check_signs(), for lift_sides_double_double() and CellPlanes, a block of cells at a time:
/// what the lanes tell and what the planes tell.
template <unsigned K>
std::pair<Told, Told> check_lanes(const LiftedPoints& s, const std::string& name, int trials) {
  constexpr std::size_t block = internal::sides_block;
  std::mt19937_64 random(K);
  std::pair<Told, Told> told;
  internal::PlaneArray<K> room;
  internal::CellPlanes<K> planes(s);
  EXPECT_TRUE(planes.used());
  planes.set_room(room, block + 1);
  planes.set_none(block);
  const auto below_plane = [&](std::uint32_t c, const double* p, bool& below) {
    return planes.on_sphere() ? planes.template decides<true>(c, p, below)
                              : planes.template decides<false>(c, p, below);
  };
  for (int t = 0; t < trials; ++t) {
    std::vector<double> rows((K + 1) * K * block);
    std::vector<std::vector<const double*>> cells(block);
    const auto origin = static_cast<std::uint32_t>(random() % s.count);
    planes.set_point(origin);
    for (std::size_t c = 0; c < block; ++c) {
      std::uint32_t v[K + 1];
      const auto slot = static_cast<unsigned>(random() % (K + 1));
      for (unsigned i = 0; i <= K; ++i) {
        v[i] = i == slot ? origin : static_cast<std::uint32_t>(random() % s.count);
        cells[c].push_back(s.row(v[i]));
        for (unsigned j = 0; j < K; ++j) rows[(i * K + j) * block + c] = s.row(v[i])[j];
      }
      planes.add(static_cast<std::uint32_t>(c), v, slot);
    }
    planes.flush();
    const auto query = static_cast<std::uint32_t>(random() % s.count);
    const double* const p = s.row(query);
    planes.set_point(query);
    double signs[block];
    internal::lift_sides_double_double(K, rows.data(), p, s.tiny, signs);
    for (std::uint32_t c = 0; c < block; ++c) {
      const Sign exact = internal::lift_side_exact(s, cells[c].data(), p);
      ++told.first.asked;
      ++told.second.asked;
      if (signs[c] != 0) {
        ++told.first.known;
        EXPECT_EQ(internal::sign_of(signs[c]), exact) << name << " trial " << t;
      }
      bool below = false;
      Sign side = Sign::zero;
      if (below_plane(c, p, below)) {
        ++told.second.known;
        EXPECT_EQ(below ? Sign::negative : Sign::positive, exact) << name << " trial " << t;
      } else if (!planes.on_sphere() && planes.decides_on_lattice(c, side)) {
        ++told.second.known;
        EXPECT_EQ(side, exact) << name << " trial " << t;
      }
    }
    bool below = false;
    EXPECT_FALSE(below_plane(block, p, below));
    EXPECT_FALSE(planes.known(block));
  }
  return told;
}
template <unsigned K>
std::pair<Told, Told> check_lanes(const LiftedSet& set, int trials) {
  return check_lanes<K>(lifted(set, K), set.name, trials);
}

template <unsigned K>
void check_lanes_of_sets() {
  std::vector<LiftedSet> sets;
  for (const LiftedSet& s : large_lifted_sets(K, 40))
    if (s.weights.empty()) sets.push_back(s);
  sets.push_back(nearly_cospherical(K, 60, 1));
  for (const int by : {8, 70, 140}) sets.push_back(stretched(random_points(K, 60, 2), by));
  LiftedSet far = random_points(K, 40, 5);
  for (double& x : far.rows) x = std::ldexp(x, -40) + 1;
  sets.push_back(far);
  for (const LiftedSet& s : sets) check_lanes<K>(s, 60);
  const auto [lanes, planes] = check_lanes<K>(random_points(K, 4000, 6), 60);
  EXPECT_GT(lanes.known + 8, lanes.asked);  // a point may be drawn twice
  EXPECT_GT(planes.known + 16, planes.asked);
  // Within the last bits of a sphere squared distances do not tell, double-doubles do, and so do
  // powers with respect to the sphere.
  LiftedPoints near = lifted(nearly_cospherical(K, 4000, 7), K);
  const auto [by_lanes, by_squares] = check_lanes<K>(near, "near a sphere", 60);
  EXPECT_GT(by_lanes.known + 8, by_lanes.asked);
  EXPECT_LT(by_squares.known, by_squares.asked / 8);
  find_sphere(near);
  ASSERT_FALSE(near.powers.empty());
  const Told by_powers = check_lanes<K>(near, "near a sphere, by powers", 60).second;
  EXPECT_GT(by_powers.known + 16, by_powers.asked);
  LiftedPoints mixed = lifted(with_others(nearly_cospherical(K, 2500, 8), 1500, 9), K);
  find_sphere(mixed);
  ASSERT_FALSE(mixed.powers.empty());
  const Told by_mixed_powers = check_lanes<K>(mixed, "most near a sphere", 60).second;
  EXPECT_GT(by_mixed_powers.known + 16, by_mixed_powers.asked);
  // On a lattice planes tell every sign, zero among them.
  LiftedPoints grid = lifted(drawn_grid(K, 4000, 8, 1, 0, 10), K);
  grid.exact_limit = 0x1p53;
  const Told on_grid = check_lanes<K>(grid, "lattice", 60).second;
  EXPECT_EQ(on_grid.known, on_grid.asked);
}

TEST(LiftSides, AreRightWhereTheyTell) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    check_lanes_of_sets<3>();
    check_lanes_of_sets<4>();
    check_lanes_of_sets<5>();
    check_lanes_of_sets<6>();
  }
  hwy::SetSupportedTargetsForTest(0);
}

/// Weights of zero change nothing but the way: squared distances decide, not powers with respect to
/// the sphere.
TEST(Triangulation, NearASphereEqualsThatOfWeightsOfZero) {
  for (const unsigned d : {3U, 4U, 5U}) {
    const unsigned n = d == 3 ? 3000 : d == 4 ? 600 : 300;
    LiftedSet shifted = nearly_cospherical(d, n, 11);
    for (double& x : shifted.rows) x = 3 * x + 1;
    const LiftedSet near = nearly_cospherical(d, n, 12);
    LiftedSet mirrored = nearly_cospherical(d, n / 2, 17);  // each point and its image: ties
    for (std::uint64_t i = 0, end = mirrored.rows.size(); i < end; ++i)
      mirrored.rows.push_back(i % d == 0 ? -mirrored.rows[i] : mirrored.rows[i]);
    LiftedSet rounded = near, tight = random_points(d, n, 18);
    for (double& x : rounded.rows) x = std::ldexp(std::round(std::ldexp(x, 50)), -50);
    for (double& x : tight.rows) x = 0.7 + std::ldexp(x, -20);
    for (const LiftedSet& set : {near, shifted, mirrored, rounded, tight,
                                 with_others(nearly_cospherical(d, n, 13), n / 4, 14),
                                 with_others(nearly_cospherical(d, n / 4, 15), n, 16)}) {
      LiftedSet weighted = set;
      weighted.weights.assign(set.count(), 0.0);
      const Triangulation t = triangulate(set), by_weights = triangulate(weighted);
      EXPECT_EQ(t.cells, by_weights.cells) << set.name << d;
      EXPECT_EQ(t.neighbours, by_weights.neighbours) << set.name << d;
      EXPECT_EQ(t.cell_groups, by_weights.cell_groups) << set.name << d;
    }
    for (const LiftedSet* set : std::initializer_list<const LiftedSet*>{&near, &rounded, &tight}) {
      const auto& rungs = triangulate(*set).statistics.rung_counts;
      EXPECT_LT(20 * rungs[1], rungs[0]) << set->name << d;
    }
  }
}

/// The counter of what was decided by integers: of random points it stays at nearly nothing.
TEST(Triangulation, RandomPointsOfManyDimensionsNeedNoIntegers) {
  for (const auto& [d, n] : {std::pair(7U, 40U), {8U, 26U}, {9U, 20U}, {12U, 18U}}) {
    for (const LiftedSet& s :
         {random_points(d, n, 3), with_weights(random_points(d, n, 4), 0.02, 5, false)}) {
      const Triangulation t = triangulate(s);
      const auto& rungs = t.statistics.rung_counts;
      EXPECT_GT(rungs[0], 200U) << s.name;
      EXPECT_LT((rungs[1] + rungs[2]) * 1000, rungs[0]) << s.name;
    }
  }
}

/// A power of two changes nothing, as far as it goes.
TEST(Triangulation, SizesOfManyDimensionsAgree) {
  const LiftedSet s = random_points(7, 25, 6);
  const Triangulation expected = triangulate(s);
  for (const int by : {-498, 498, -900, 900}) {
    LiftedSet moved = s;
    for (double& x : moved.rows) x = std::ldexp(x, by);
    EXPECT_EQ(triangulate(moved).cells, expected.cells) << by;
  }
}

}  // namespace lift_signs_test
}  // namespace cullhull
