// Random sets, each run as it is under random thread counts, filters and layouts, and once more
// with its points in another order. The first must give the same bits, the second the same
// polytope; both are certified. CULLHULL_RANDOM_RUNS (120 if unset) says how many sets,
// CULLHULL_RANDOM_SEED which: a failure prints the seed that repeats it alone with
// CULLHULL_RANDOM_RUNS=1.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "agreement/all_paths.hpp"
#include "agreement/point_sets.hpp"
#include "cullhull/generate.hpp"

namespace cullhull::testing_support {
namespace {

std::uint64_t number_from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

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
  Options o;
  o.threads = static_cast<unsigned>(r.integer(1, 8));
  o.cull = culls[r.integer(0, 3)];
  return o;
}

Hull certified_hull(const PointSet& s, const Options& options) {
  Hull h = convex_hull(view_of(s), options);
  const Certificate c = certify(view_of(s), h, options);
  EXPECT_TRUE(c.valid) << s.name << ", threads " << options.threads << ": " << c.reason;
  return h;
}

TEST(RandomRuns, AnyThreadsFilterLayoutAndOrder) {
  const std::uint64_t runs = number_from_environment("CULLHULL_RANDOM_RUNS", 120);
  const std::uint64_t first = number_from_environment("CULLHULL_RANDOM_SEED", 1);
  for (std::uint64_t seed = first; seed < first + runs && !HasFailure(); ++seed) {
    Random r(seed);
    const PointSet s = any_set(r);
    SCOPED_TRACE(s.name + ", CULLHULL_RANDOM_SEED=" + std::to_string(seed));
    Options plain;
    plain.threads = 1;
    plain.cull = CullMethod::none;
    const Hull one = certified_hull(s, plain);
    for (int k = 0; k < 2; ++k)
      EXPECT_EQ(canonical_hash(convex_hull(view_of(s), any_options(r))), canonical_hash(one));
    const std::vector<double> columns = transposed(s.coordinates, s.dimension);
    EXPECT_EQ(canonical_hash(convex_hull(
                  PointView::column_major(columns.data(), s.count(), s.dimension), any_options(r))),
              canonical_hash(one));
    const PointSet other = in_another_order(s, r);
    EXPECT_EQ(polytope_hash(other, certified_hull(other, any_options(r))), polytope_hash(s, one));
  }
}

}  // namespace
}  // namespace cullhull::testing_support
