// Hulls of a few points in 9 to 30 dimensions against a slow reference that is exact and shares
// nothing with the engine: Gale's diagram. With A the points in homogeneous coordinates and g_i the
// rows of a basis of its null space, the points on a facet are those outside a minimal set J for
// which the g_j, j in J, have a vanishing combination with positive weights (Gruenbaum, "Convex
// Polytopes", 5.4).
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <vector>

#include "agreement/canonical_hash.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/point_view.hpp"
#include "geometry/gather.hpp"
#include "geometry/local_frame.hpp"
#include "hull/engine.hpp"
#include "parallel/threads/run.hpp"
#include "result/build_hull.hpp"
#include "result/measures/simplex_measures.hpp"
#include "slow_elimination.hpp"

namespace cullhull::many_dimensions_test {

using Points = std::vector<std::vector<double>>;
using Matrix = std::vector<testing_support::Rationals>;
using Ids = std::vector<std::uint64_t>;

/// Rows: a basis of the vectors x with m x = 0.
Matrix null_space(Matrix m, std::size_t columns) {
  const std::vector<unsigned> pivots = testing_support::echelon(m);
  Matrix basis;
  for (std::size_t c = 0; c < columns; ++c) {
    if (std::find(pivots.begin(), pivots.end(), c) != pivots.end()) continue;
    std::vector<mpq_class> x(columns);
    x[c] = 1;
    for (std::size_t r = 0; r < pivots.size(); ++r) x[pivots[r]] = -m[r][c] / m[r][pivots[r]];
    basis.push_back(x);
  }
  return basis;
}

class GaleReference {
 public:
  explicit GaleReference(const Points& points) : n_(points.size()) {
    Matrix a(points[0].size() + 1, std::vector<mpq_class>(n_));
    for (std::size_t i = 0; i < n_; ++i) {
      a[0][i] = 1;
      for (std::size_t j = 0; j < points[i].size(); ++j) a[j + 1][i] = mpq_class(points[i][j]);
    }
    diagram_ = null_space(a, n_);
    for (std::size_t size = 1; size <= diagram_.size() + 1; ++size) extend({}, 0, size);
    for (std::size_t i = 0; i < n_; ++i) {
      // Extreme: all facets of i together leave nothing but i and its equals.
      std::set<std::uint64_t> common;
      bool any = false;
      for (const Ids& facet : facets_) {
        if (!std::binary_search(facet.begin(), facet.end(), i)) continue;
        std::set<std::uint64_t> kept;
        for (const std::uint64_t v : facet)
          if (!any || common.count(v) != 0) kept.insert(v);
        common = kept;
        any = true;
      }
      if (any && std::all_of(common.begin(), common.end(),
                             [&](std::uint64_t v) { return points[v] == points[i] && v >= i; }))
        vertices_.push_back(i);
    }
  }

  const Ids& vertices() const { return vertices_; }
  /// Vertices of each facet, ascending.
  std::set<Ids> facets() const {
    std::set<Ids> all;
    for (const Ids& facet : facets_) {
      Ids kept;
      std::set_intersection(facet.begin(), facet.end(), vertices_.begin(), vertices_.end(),
                            std::back_inserter(kept));
      all.insert(kept);
    }
    return all;
  }

 private:
  void extend(Ids chosen, std::uint64_t from, std::size_t size) {
    if (chosen.size() == size) return consider(chosen);
    for (std::uint64_t i = from; i < n_; ++i) {
      chosen.push_back(i);
      extend(chosen, i + 1, size);
      chosen.pop_back();
    }
  }

  void consider(const Ids& j) {
    for (const Ids& smaller : found_)
      if (std::includes(j.begin(), j.end(), smaller.begin(), smaller.end())) return;
    Matrix m;
    for (const auto& row : diagram_) {
      m.emplace_back();
      for (const std::uint64_t i : j) m.back().push_back(row[i]);
    }
    const Matrix weights = null_space(m, j.size());
    if (weights.size() != 1) return;
    const auto sign = [](const mpq_class& v) { return sgn(v); };
    const int first = sign(weights[0][0]);
    for (const mpq_class& w : weights[0])
      if (sign(w) == 0 || sign(w) != first) return;
    found_.push_back(j);
    Ids facet;
    for (std::uint64_t i = 0; i < n_; ++i)
      if (!std::binary_search(j.begin(), j.end(), i)) facet.push_back(i);
    facets_.push_back(facet);
  }

  std::size_t n_;
  Matrix diagram_;
  std::vector<Ids> found_, facets_;
  Ids vertices_;
};

std::vector<double> rows_of(const Points& points) {
  std::vector<double> rows;
  for (const auto& p : points) rows.insert(rows.end(), p.begin(), p.end());
  return rows;
}

void expect_reference(const Points& points) {
  const auto d = static_cast<std::uint32_t>(points[0].size());
  const std::vector<double> rows = rows_of(points);
  const PointView view = PointView::row_major(rows.data(), points.size(), d);
  const Hull hull = convex_hull(view);
  const GaleReference reference(points);
  EXPECT_EQ(Ids(hull.vertices.begin(), hull.vertices.end()), reference.vertices());
  std::set<Ids> facets;
  for (std::size_t f = 0; f < hull.facet_count(); ++f) {
    Ids facet;
    for (std::uint64_t i = hull.facets.offsets[f]; i < hull.facets.offsets[f + 1]; ++i)
      facet.push_back(hull.facets.items[i]);
    std::sort(facet.begin(), facet.end());
    facets.insert(facet);
  }
  EXPECT_EQ(facets, reference.facets());
  const Certificate certificate = certify(view, hull);
  EXPECT_TRUE(certificate.valid) << certificate.reason;
}

Points made(std::size_t count, unsigned d, const std::function<double()>& coordinate) {
  Points p(count, std::vector<double>(d));
  for (auto& x : p)
    for (auto& c : x) c = coordinate();
  return p;
}

TEST(ManyDimensions, RandomPoints) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const auto& [d, more] : {std::pair{9U, 6U},
                                {13U, 2U},
                                {13U, 4U},
                                {16U, 3U},
                                {20U, 3U},
                                {24U, 3U},
                                {30U, 2U},
                                {30U, 3U}})
    expect_reference(made(d + more, d, [&] { return uniform(random); }));
}

TEST(ManyDimensions, Lattices) {
  std::mt19937_64 random(2);
  for (const auto& [d, more] : {std::pair{9U, 5U}, {10U, 4U}, {13U, 3U}, {16U, 3U}, {20U, 3U}})
    for (const unsigned size : {2U, 3U})
      expect_reference(made(d + more, d, [&] { return static_cast<double>(random() % size); }));
}

TEST(ManyDimensions, Duplicates) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const unsigned d : {9U, 14U, 20U}) {
    Points p = made(d + 2, d, [&] { return uniform(random); });
    p.push_back(p[1]);
    p.insert(p.begin(), p[4]);
    expect_reference(p);
  }
}

/// Points of a 12-dimensional flat that fills no plane across an axis of 20-space.
TEST(ManyDimensions, Flats) {
  std::mt19937_64 random(4);
  for (const unsigned k : {9U, 12U}) {
    constexpr unsigned d = 20;
    Points p = made(k + 3, d, [&] { return static_cast<double>(random() % 4096); });
    for (auto& x : p)
      for (unsigned j = k; j < d; ++j) x[j] = x[j % k] + 3 * x[(j + 1) % k] - x[(j * 5) % k];
    expect_reference(p);
  }
}

/// Points on a sphere with small rational coordinates, which no plane but axes' ones has many of.
TEST(ManyDimensions, Cospherical) {
  for (const unsigned d : {9U, 11U}) {
    Points p;  // some corners of the cross-polytope: facets of many shapes
    for (unsigned j = 0; j < d; ++j) {
      p.emplace_back(d, 0.0);
      p.back()[j] = 1;
      if (j >= 4) continue;
      p.emplace_back(d, 0.0);
      p.back()[j] = -1;
    }
    expect_reference(p);
  }
}

/// Points on the moment curve, rounded: facets so thin that doubles bound no plane of the first
/// simplex. A plane was computed from such a one.
TEST(ManyDimensions, MomentCurve) {
  constexpr unsigned d = 9, count = 17;
  std::vector<double> rows;
  for (unsigned i = 0; i < count; ++i)
    for (double t = i / double{count}, p = t; rows.size() < std::size_t{i + 1} * d; p *= t)
      rows.push_back(p);
  const PointView view = PointView::row_major(rows.data(), count, d);
  const Hull hull = convex_hull(view);
  EXPECT_EQ(hull.facet_count(), 990U);  // a cyclic polytope: the most that 17 points can have
  const Certificate certificate = certify(view, hull);
  EXPECT_TRUE(certificate.valid) << certificate.reason;
}

/// The engine has proved most ridges strictly convex. Where all of them are decided by elimination
/// instead, the result has the same bits, on one thread and on three.
TEST(ManyDimensions, ManyFacetsWithTheBitsOfAnUnprovedBoundary) {
  using namespace internal;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (const auto& [d, count] : {std::pair{9U, 30U}, {10U, 20U}, {13U, 19U}, {20U, 24U}}) {
    const Points points = made(count, d, [&] { return normal(random); });
    const std::vector<double> rows = rows_of(points);
    const PointView view = PointView::row_major(rows.data(), count, d);
    Options options;
    options.threads = 1;
    const internal::Run run(options);
    const LocalFrame frame(gather_points(view, nullptr, count, run), count, d, run);
    Boundary boundary = hull_nd(frame.points(), frame.simplex().data(), run);
    EXPECT_FALSE(boundary.doubtful.empty());
    boundary.doubtful.clear();
    Hull unproved;
    unproved.dimension = d;
    unproved.point_count = count;
    unproved.affine_dimension = static_cast<int>(d);
    build_hull({&view, &frame.points(), nullptr, frame.axes().data()}, std::move(boundary), run,
               unproved);
    const std::uint64_t expected = testing_support::canonical_hash(unproved);
    for (const unsigned threads : {1U, 3U}) {
      options.threads = threads;
      EXPECT_EQ(testing_support::canonical_hash(convex_hull(view, options)), expected)
          << d << "D, " << threads << " threads";
    }
  }
}

/// What the measures of a simplex are: with the edges from point 0 as the rows of E and G = E E',
/// the volume's square is det G / (k!)^2, and the facet beyond point i has a plane along the row i
/// of G^-1 E.
struct SimplexReference {
  explicit SimplexReference(const Points& p) {
    const std::size_t k = p.size() - 1, d = p[0].size();
    Matrix m(k, std::vector<mpq_class>(2 * k));
    std::vector<std::vector<mpq_class>> edges(k, std::vector<mpq_class>(d));
    for (std::size_t i = 0; i < k; ++i)
      for (std::size_t c = 0; c < d; ++c) edges[i][c] = mpq_class(p[i + 1][c]) - mpq_class(p[0][c]);
    for (std::size_t i = 0; i < k; ++i) {
      m[i][k + i] = 1;
      for (std::size_t j = 0; j < k; ++j)
        for (std::size_t c = 0; c < d; ++c) m[i][j] += edges[i][c] * edges[j][c];
    }
    testing_support::echelon(m, &squared_volume);  // G is positive definite: no pivot is zero
    gradients.assign(k + 1, std::vector<mpq_class>(d));
    for (std::size_t i = 0; i < k; ++i)
      for (std::size_t c = 0; c < d; ++c) {
        for (std::size_t j = 0; j < k; ++j)
          gradients[i + 1][c] += m[i][k + j] / m[i][i] * edges[j][c];
        gradients[0][c] -= gradients[i + 1][c];
      }
  }
  mpq_class squared_volume;
  std::vector<std::vector<mpq_class>> gradients;
};

void expect_simplex(const Points& points, const Hull& h) {
  const std::size_t k = points.size() - 1, d = points[0].size();
  ASSERT_EQ(h.affine_dimension, static_cast<int>(k));
  ASSERT_EQ(h.facet_count(), k + 1);
  const SimplexReference reference(points);
  mpf_class volume = sqrt(mpf_class(reference.squared_volume, 2048)), area(0, 2048),
            factorial(1, 2048);
  for (std::size_t i = 2; i < k; ++i) factorial *= static_cast<unsigned long>(i);
  for (std::size_t f = 0; f <= k; ++f) {
    const auto facet = h.facets[f];
    std::size_t apex = 0;
    while (std::find(facet.begin(), facet.end(), apex) != facet.end()) ++apex;
    mpq_class square = 0;
    for (const mpq_class& g : reference.gradients[apex]) square += g * g;
    const mpf_class length = sqrt(mpf_class(square, 2048));
    area += volume * length;
    double offset = 0, size = 0;
    for (std::size_t c = 0; c < d; ++c) {
      const double n = h.facet_planes[f * (d + 1) + c];
      const double exact =
          mpf_class(-mpf_class(reference.gradients[apex][c], 2048) / length).get_d();
      EXPECT_NEAR(n, exact, std::abs(exact) * 0x1p-52) << k << " " << f << " " << c;
      offset -= n * points[facet[0]][c];
      size += std::abs(n * points[facet[0]][c]);
    }
    EXPECT_NEAR(h.facet_planes[f * (d + 1) + d], offset, size * 1e-14);
  }
  const double exact_area = mpf_class(area / factorial).get_d(),
               exact_volume =
                   mpf_class(volume / (factorial * static_cast<unsigned long>(k))).get_d();
  EXPECT_NEAR(h.area / exact_area, 1, 0x1p-51) << k;
  EXPECT_NEAR(h.volume / exact_volume, 1, 0x1p-51) << k;
  for (std::size_t c = 0; c < d; ++c) {
    mpq_class mean = 0;
    for (const auto& p : points) mean += mpq_class(p[c]);
    mean /= static_cast<unsigned long>(k + 1);
    EXPECT_NEAR(h.centroid[c], mean.get_d(), std::abs(mean.get_d()) * 0x1p-52);
  }
}

Points simplex_of(std::mt19937_64& random, std::size_t count, std::size_t d, int kind) {
  Points points(count, std::vector<double>(d));
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t c = 0; c < d; ++c) {
      double& x = points[i][c];
      x = std::ldexp(static_cast<double>(random() >> 11), -53);
      if (kind == 1) x = std::ldexp(x, static_cast<int>(c % 40) - 20);  // columns of a table
      if (kind == 2) x = i == c ? 1 : 0;                                // a standard simplex
      if (kind == 3) x = 1e5 + std::round(x * 100) / 100;
      if (kind == 4) x = std::ldexp(x, static_cast<int>(i * 7 % 90) - 45);
    }
  return points;
}

/// The arithmetic for large simplices, on those that rationals can follow.
TEST(ManyDimensions, MeasuresOfSimplicesAreThoseOfRationals) {
  std::mt19937_64 random(3);
  for (const std::size_t k : {1U, 2U, 5U, 9U, 14U})
    for (const std::size_t more : {0U, 1U, 3U})
      for (int kind = 0; kind < 5; ++kind) {
        const std::size_t d = k + more;
        const Points points = simplex_of(random, k + 1, d, kind);
        if (kind == 2 && more == 0) continue;
        const std::vector<double> rows = rows_of(points);
        const PointView view =
            PointView::row_major(rows.data(), k + 1, static_cast<std::uint32_t>(d));
        Hull h;
        h.dimension = static_cast<std::uint32_t>(d);
        h.affine_dimension = static_cast<int>(k);
        std::vector<std::uint64_t> ids;
        std::vector<std::uint32_t> index;
        Array<std::uint64_t> facets;
        for (std::uint32_t f = 0; f <= k; ++f) {
          ids.push_back(f);
          for (std::uint32_t v = 0; v <= k; ++v)
            if (v != f) {
              index.push_back(v);
              facets.push_back(v);
            }
        }
        using Corners = SharedArray<std::uint64_t>;
        h.facets = Lists<std::uint64_t, Corners>::of_length(k, Corners(std::move(facets)));
        const Options options;
        const internal::Run run(options);
        internal::measure_simplex(
            internal::make_unscaled_frame(view, ids, static_cast<unsigned>(k)), index, run, h);
        expect_simplex(points, h);
      }
}

/// Tables of as many rows as columns: a simplex.
TEST(ManyDimensions, SimplicesOfFiftyToAHundredDimensions) {
  std::mt19937_64 random(5);
  for (const std::size_t d : {51U, 60U, 100U})
    for (int kind = 0; kind < (d == 60 ? 5 : 1); ++kind) {
      const Points points = simplex_of(random, d, d, kind);
      const std::vector<double> rows = rows_of(points);
      const PointView view = PointView::row_major(rows.data(), d, static_cast<std::uint32_t>(d));
      const Hull h = convex_hull(view);
      EXPECT_EQ(h.affine_dimension, static_cast<int>(d) - 1);
      EXPECT_EQ(h.facet_count(), d);
      EXPECT_GT(h.volume, 0);
      if (d > 60) continue;
      const Certificate proof = certify(view, h);
      EXPECT_TRUE(proof.valid) << kind << ": " << proof.reason;
      EXPECT_EQ(proof.ridges_checked, d * (d - 1) / 2);
    }
}

/// Of a simplex every fault of its lists is seen, though no side is compared but one.
TEST(ManyDimensions, FaultsOfSimplicesAreSeen) {
  std::mt19937_64 random(7);
  for (const std::size_t k : {2U, 3U, 4U, 9U, 14U}) {
    const Points points = simplex_of(random, k + 1, k, 0);
    const std::vector<double> rows = rows_of(points);
    const PointView view = PointView::row_major(rows.data(), k + 1, static_cast<std::uint32_t>(k));
    const Hull right = convex_hull(view);
    ASSERT_TRUE(certify(view, right).valid);
    const auto refused = [&](const char* what, const auto& spoil) {
      Hull h = right;
      Array<std::uint64_t> simplices(h.simplices.begin(), h.simplices.end());
      spoil(h, simplices.data(), h.simplex_neighbours.data());
      h.simplices = SharedArray<std::uint64_t>(std::move(simplices));
      EXPECT_FALSE(certify(view, h).valid) << k << "D: " << what;
    };
    const auto turn = [&](auto* simplices, auto* neighbours, std::size_t f) {
      std::swap(simplices[f * k + k - 2], simplices[f * k + k - 1]);
      std::swap(neighbours[f * k + k - 2], neighbours[f * k + k - 1]);
    };
    refused("turned inside out", [&](Hull&, auto* simplices, auto* neighbours) {
      for (std::size_t f = 0; f <= k; ++f) turn(simplices, neighbours, f);
    });
    for (const std::size_t f : {std::size_t{0}, k / 2, k}) {
      refused("one simplex turned",
              [&](Hull&, auto* simplices, auto* neighbours) { turn(simplices, neighbours, f); });
      refused("neighbours exchanged", [&](Hull&, auto*, auto* neighbours) {
        std::swap(neighbours[f * k], neighbours[f * k + k - 1]);
      });
      refused("its own neighbour", [&](Hull&, auto*, auto* neighbours) {
        neighbours[f * k] = static_cast<std::uint32_t>(f);
      });
      refused("two simplices of a facet", [&](Hull& h, auto*, auto*) {
        Array<std::uint32_t> facets(k + 1);
        for (std::uint32_t g = 0; g <= k; ++g) facets[g] = h.simplex_facets[g];
        facets[f] = facets[f == 0];
        h.simplex_facets = EvenArray<std::uint32_t>(std::move(facets));
      });
    }
    refused("a vertex twice", [&](Hull&, auto* simplices, auto*) { simplices[0] = simplices[1]; });
    refused("another plane", [&](Hull& h, auto*, auto*) { h.facet_planes[0] += 1e-3; });
    refused("another volume", [&](Hull& h, auto*, auto*) { h.volume *= 1 + 1e-6; });
  }
}

}  // namespace cullhull::many_dimensions_test
