// Random sets, each run as it is under random thread counts, filters and layouts, and once more
// with its points in another order. The first must give the same bits, the second the same
// polytope; both are certified. Hard sets (hard_sets.hpp) go by every other way to the same answer,
// too. CULLHULL_RANDOM_RUNS (120 if unset) says how many sets of either kind, CULLHULL_RANDOM_SEED
// which: a failure prints the seed that repeats it alone with CULLHULL_RANDOM_RUNS=1.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "agreement/all_paths.hpp"
#include "agreement/hard_sets.hpp"
#include "agreement/point_sets.hpp"
#include "agreement/random_seeds.hpp"
#include "call_options.hpp"
#include "cullhull/batch.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/growing_hull.hpp"
#include "cullhull/query.hpp"
#include "exact/orientation/orientation.hpp"
#include "thrown.hpp"

namespace cullhull::testing_support::random_runs_test {

/// The polytope itself: its facets as sets of coordinates, whatever the ids and their order.
std::uint64_t polytope_hash(const PointSet& s, const Hull& h) {
  std::vector<std::uint64_t> of_point(s.count());
  for (const std::uint64_t v : h.vertices) {
    Fnv f;
    for (unsigned j = 0; j < s.dimension; ++j) f.add(s.row(v)[j] + 0.0);  // -0 is 0
    of_point[v] = f.value();
  }
  std::vector<std::uint64_t> facets;
  for (std::size_t i = 0; i < h.facet_count(); ++i) {
    std::vector<std::uint64_t> points;
    for (const std::uint64_t v : h.facets[i]) points.push_back(of_point[v]);
    std::sort(points.begin(), points.end());
    Fnv f;
    f.add(points);
    facets.push_back(f.value());
  }
  std::sort(facets.begin(), facets.end());
  Fnv f;
  f.add(facets);
  f.word(h.vertices.size());
  f.word(static_cast<std::uint64_t>(h.affine_dimension + 1));
  return f.value();
}

/// A shape, a size for its dimension, and sometimes copies, a shift that costs bits, one axis made
/// thin, or rounding to a few values.
PointSet any_set(Random& r) {
  constexpr const char* shapes[] = {"ball",       "sphere",  "cube",   "cube-surface",
                                    "octahedron", "gauss",   "shell",  "cylinder",
                                    "cone",       "simplex", "cyclic", "bumpy"};
  constexpr double most[] = {0, 0, 60000, 40000, 3000, 500, 120, 50};
  const unsigned d = static_cast<unsigned>(std::min(r.integer(2, 9), 7));
  const unsigned dimension = d > 6 ? 3 : d;  // space is what most people have
  const auto n = static_cast<unsigned>(std::exp(r.between(std::log(3), std::log(most[dimension]))));
  std::string shape = shapes[r.integer(0, 11)];
  if (shape == "bumpy" && dimension != 3) shape = "ball";
  if ((shape == "cylinder" || shape == "cone") && dimension < 3) shape = "sphere";
  PointSet s = named(shape + " of " + std::to_string(n), dimension);
  s.coordinates = generate(shape, n, dimension, static_cast<std::uint64_t>(r.integer(0, 1 << 30)));
  const int twist = r.integer(0, 7);
  if (twist == 0)
    for (double& v : s.coordinates) v = std::floor(v * r.integer(2, 40));
  if (twist == 1)
    for (double& v : s.coordinates) v += 0x1p30;
  if (twist == 2)
    for (std::size_t i = dimension - 1; i < s.coordinates.size(); i += dimension)
      s.coordinates[i] *= 1e-9;
  if (twist == 3) {
    const std::size_t half = s.count() / 2 * dimension;
    s.coordinates.insert(s.coordinates.end(), s.coordinates.begin(),
                         s.coordinates.begin() + static_cast<std::ptrdiff_t>(half));
  }
  s.name += " twist " + std::to_string(twist);
  return s;
}

PointSet in_another_order(const PointSet& s, Random& r) {
  std::vector<std::uint32_t> order(s.count());
  std::iota(order.begin(), order.end(), 0U);
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[static_cast<std::size_t>(r.integer(0, static_cast<int>(i) - 1))]);
  PointSet out = named(s.name + ", permuted", s.dimension);
  for (const std::uint32_t i : order)
    out.coordinates.insert(out.coordinates.end(), s.row(i), s.row(i) + s.dimension);
  return out;
}

Options any_options(Random& r) {
  constexpr CullMethod culls[] = {CullMethod::none, CullMethod::gauge, CullMethod::pseudo_hull,
                                  CullMethod::automatic};
  return options_of(static_cast<unsigned>(r.integer(1, 8)), culls[r.integer(0, 3)]);
}

Hull certified_hull(const PointSet& s, const Options& options) {
  Hull h = convex_hull(view_of(s), options);
  const Certificate c = certify(view_of(s), h, options);
  EXPECT_TRUE(c.valid) << s.name << ", threads " << options.threads << ": " << c.reason;
  return h;
}

TEST(RandomRuns, AnyThreadsFilterLayoutAndOrder) {
  for_random_seeds(120, [&](std::uint64_t seed) {
    Random r(seed);
    const PointSet s = any_set(r);
    SCOPED_TRACE(s.name + ", CULLHULL_RANDOM_SEED=" + std::to_string(seed));
    const Hull one = certified_hull(s, options_of(1, CullMethod::none));
    for (int k = 0; k < 2; ++k)
      EXPECT_EQ(canonical_hash(convex_hull(view_of(s), any_options(r))), canonical_hash(one));
    const std::vector<double> columns = transposed(s.coordinates, s.dimension);
    EXPECT_EQ(canonical_hash(convex_hull(
                  PointView::column_major(columns.data(), s.count(), s.dimension), any_options(r))),
              canonical_hash(one));
    const PointSet other = in_another_order(s, r);
    EXPECT_EQ(polytope_hash(other, certified_hull(other, any_options(r))), polytope_hash(s, one));
  });
}

/// Rows from the last to the first in memory, coordinates too, with gaps of NaNs.
class Backwards {
 public:
  explicit Backwards(const PointSet& s)
      : memory_((s.count() * s.dimension + 1) * 2, std::numeric_limits<double>::quiet_NaN()) {
    const std::size_t last = memory_.size() - 1;
    for (std::size_t i = 0; i < s.coordinates.size(); ++i) memory_[last - 2 * i] = s.coordinates[i];
    constexpr std::ptrdiff_t step = 2 * sizeof(double);
    view_ = {reinterpret_cast<const std::byte*>(&memory_[last]),
             ScalarType::f64,
             s.dimension,
             s.count(),
             -step * static_cast<std::ptrdiff_t>(s.dimension),
             -step};
  }
  const PointView& view() const { return view_; }

 private:
  std::vector<double> memory_;
  PointView view_;
};

/// Points on, one step off, and about as near to the boundary as doubles come.
PointSet near_boundary(const PointSet& s, const Hull& hull, Random& r) {
  PointSet out = named("near " + s.name, s.dimension);
  const auto vertex = [&] {
    return s.row(hull.vertices[static_cast<std::size_t>(
        r.integer(0, static_cast<int>(hull.vertices.size()) - 1))]);
  };
  for (unsigned i = 0; i < 60; ++i) {
    const double *a = vertex(), *b = i % 3 == 0 ? a : vertex(), *c = i % 3 == 1 ? a : vertex();
    std::vector<double> p(s.dimension);
    for (unsigned j = 0; j < s.dimension; ++j) {
      p[j] = i % 3 == 0 ? a[j] : a[j] / 4 + b[j] / 4 + c[j] / 2;
      if (i % 2) p[j] = shaken(p[j], r);
    }
    if (std::all_of(p.begin(), p.end(), [](double v) { return std::isfinite(v); })) out.add(p);
  }
  return out;
}

/// By the exact sign at every simplex of a full-dimensional hull.
Side slow_side(const PointSet& s, const Hull& hull, const double* p) {
  const unsigned d = s.dimension;
  Side side = Side::inside;
  for (std::size_t i = 0; i < hull.simplices.size(); i += d) {
    std::vector<const double*> rows;
    for (unsigned j = 0; j < d; ++j) rows.push_back(s.row(hull.simplices[i + j]));
    rows.push_back(p);
    const internal::Sign sign = internal::orientation_exact(d, rows.data());
    if (sign == internal::Sign::positive) return Side::outside;
    if (sign == internal::Sign::zero) side = Side::boundary;
  }
  return side;
}

/// Every other way to the answer: extreme points alone, a batch, a hull that grows, questions.
void expect_other_ways(const PointSet& s, const Hull& hull, Random& r) {
  const Ids vertices = sorted_vertices(hull);
  EXPECT_EQ(extreme_points(view_of(s), any_options(r)).ids, vertices);
  if (s.count() * s.dimension <= 150) {
    EXPECT_EQ(exact_extreme_points(s), vertices);
  }

  const std::uint64_t n = s.count(), middle = n / 3, offsets[] = {0, n, n, n};
  const HullBatch batch = convex_hulls(view_of(s), offsets, any_options(r));
  EXPECT_EQ(canonical_hash(batch.hull(0)), canonical_hash(hull)) << "batch";

  GrowingHull growing(s.dimension);
  growing.add(PointView::row_major(s.coordinates.data(), middle, s.dimension), any_options(r));
  growing.add(
      PointView::row_major(s.coordinates.data() + middle * s.dimension, n - middle, s.dimension),
      any_options(r));
  EXPECT_EQ(canonical_hash(growing.hull()), canonical_hash(hull)) << "growing";

  const HullQuery query(view_of(s), hull);
  std::vector<Side> sides(n);
  query.sides(view_of(s), sides.data(), any_options(r));
  EXPECT_EQ(std::count(sides.begin(), sides.end(), Side::outside), 0);
  for (const std::uint64_t v : vertices) {
    EXPECT_EQ(hull.affine_dimension > 0 ? sides[v] : Side::boundary, Side::boundary) << v;
    EXPECT_TRUE(query.visible_facets(s.row(v)).empty());
  }
  if (hull.affine_dimension != static_cast<int>(s.dimension) || hull.simplex_count() > 2000) return;
  const PointSet near = near_boundary(s, hull, r);
  sides.resize(near.count());
  query.sides(view_of(near), sides.data(), any_options(r));
  for (std::uint64_t i = 0; i < near.count(); ++i) {
    EXPECT_EQ(sides[i], slow_side(s, hull, near.row(i))) << i;
    EXPECT_EQ(query.side(near.row(i)), sides[i]) << i;
    EXPECT_EQ(query.visible_facets(near.row(i)).empty(), sides[i] != Side::outside) << i;
  }
}

TEST(RandomRuns, HardSetsByEveryWay) {
  for_random_seeds(120, [&](std::uint64_t seed) {
    Random r(seed);
    const PointSet s = hard_set(r);
    SCOPED_TRACE(s.name + " of " + std::to_string(s.count()) +
                 ", CULLHULL_RANDOM_SEED=" + std::to_string(seed));
    const Hull one = certified_hull(s, options_of(1, CullMethod::none));
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(canonical_hash(convex_hull(view_of(s), any_options(r))), canonical_hash(one));
    const Backwards backwards(s);
    EXPECT_EQ(canonical_hash(convex_hull(backwards.view(), any_options(r))), canonical_hash(one));
    const PointSet other = in_another_order(s, r);
    EXPECT_EQ(polytope_hash(other, certified_hull(other, any_options(r))), polytope_hash(s, one));
    expect_other_ways(s, one, r);
  });
}

/// A NaN or an infinity anywhere is named, whatever the path.
TEST(RandomRuns, NotFiniteIsNamed) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for_random_seeds(120, [&](std::uint64_t seed) {
    Random r(seed);
    PointSet s = hard_set(r);
    std::size_t lowest = s.coordinates.size();
    for (int k = r.integer(1, 3); k > 0; --k) {
      const auto at =
          static_cast<std::size_t>(r.integer(0, static_cast<int>(s.coordinates.size()) - 1));
      s.coordinates[at] = r.integer(0, 2)   ? std::numeric_limits<double>::quiet_NaN()
                          : r.integer(0, 1) ? infinity
                                            : -infinity;
      lowest = std::min(lowest, at);
    }
    SCOPED_TRACE(s.name + ", CULLHULL_RANDOM_SEED=" + std::to_string(seed));
    const std::string where = "point " + std::to_string(lowest / s.dimension) + ", coordinate " +
                              std::to_string(lowest % s.dimension);
    for (int k = 0; k < 3; ++k)
      EXPECT_TRUE(
          has(error_of(ErrorCode::not_finite, [&] { convex_hull(view_of(s), any_options(r)); }),
              where));
  });
}

}  // namespace cullhull::testing_support::random_runs_test
