// NearestPoint against its definition in integers, bit for bit, and TriangulationQuery's
// batches, which ask the same tree.
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <utility>

#include "cullhull/error.hpp"
#include "cullhull/triangulation_query.hpp"
#include "thrown.hpp"

namespace cullhull {
namespace nearest_point_test {

using namespace testing_support;

using Coordinate = std::function<double(std::mt19937_64&)>;

double unit(std::mt19937_64& random) { return std::uniform_real_distribution<double>()(random); }

PointView rows_of(const std::vector<double>& rows, unsigned d) {
  return PointView::row_major(rows.data(), rows.size() / d, d);
}

std::vector<double> drawn(unsigned d, unsigned count, std::uint64_t seed, const Coordinate& x) {
  std::mt19937_64 random(seed);
  std::vector<double> rows(std::size_t{count} * d);
  for (double& v : rows) v = x(random);
  return rows;
}

/// Multiples of the least double.
std::vector<mpz_class> integers(const std::vector<double>& rows) {
  std::vector<mpz_class> all;
  for (const double x : rows) {
    int exponent = 0;
    mpz_class z(std::ldexp(std::frexp(x, &exponent), 53));
    const int shift = exponent - 53 + 1074;
    if (shift >= 0)
      z <<= static_cast<mp_bitcnt_t>(shift);
    else
      z >>= static_cast<mp_bitcnt_t>(-shift);
    all.push_back(z);
  }
  return all;
}

/// The first of the nearest points for each query, by integers.
std::vector<std::uint32_t> slow_nearest_points(const std::vector<double>& points,
                                               const std::vector<double>& queries, unsigned d) {
  const std::vector<mpz_class> all = integers(points), asked = integers(queries);
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < asked.size(); i += d) {
    std::size_t best = 0;
    mpz_class least = -1;
    for (std::size_t p = 0; p < all.size(); p += d) {
      mpz_class square = 0;
      for (unsigned j = 0; j < d; ++j) {
        const mpz_class away = all[p + j] - asked[i + j];
        square += away * away;
      }
      if (least >= 0 && square >= least) continue;
      best = p / d;
      least = square;
    }
    found.push_back(static_cast<std::uint32_t>(best));
  }
  return found;
}

/// All ways to ask give what the definition gives.
void check(const std::vector<double>& points, const std::vector<double>& queries, unsigned d,
           const char* name) {
  const NearestPoint nearest(rows_of(points, d));
  const std::size_t n = queries.size() / d;
  const std::vector<std::uint32_t> wanted = slow_nearest_points(points, queries, d);
  std::vector<std::uint32_t> found(n);
  for (const unsigned threads : {1U, 4U}) {
    RunOptions o;
    o.threads = threads;
    nearest.nearest(rows_of(queries, d), found.data(), o);
    ASSERT_EQ(found, wanted) << name << " in " << d << " dimensions";
  }
  for (std::size_t i = 0; i < n; i += 3)
    ASSERT_EQ(nearest.nearest(queries.data() + i * d), wanted[i]) << name << " in " << d;
}

struct Kind {
  const char* name;
  Coordinate point, query;
};

const std::vector<Kind> kinds{
    {"random", unit, [](auto& r) { return 1.5 * unit(r) - 0.25; }},
    {"lattice with ties", [](auto& r) { return static_cast<double>(r() % 4); },
     [](auto& r) { return static_cast<double>(r() % 9) / 2; }},
    {"tenths with ties", [](auto& r) { return static_cast<double>(r() % 4) * 0.1; },
     [](auto& r) { return static_cast<double>(r() % 9) * 0.05; }},
    {"a last bit apart", [](auto& r) { return 1 + static_cast<double>(r() % 2) * 0x1p-52; },
     [](auto& r) { return 1 + (static_cast<double>(r() % 7) - 3) * 0x1p-53; }},
    {"far from zero", [](auto& r) { return 0x1p52 + static_cast<double>(r() % 4); },
     [](auto& r) { return 0x1p52 + static_cast<double>(r() % 4); }},
    {"queries far away", unit, [](auto& r) { return (unit(r) - 0.5) * 1e18; }},
    {"queries at the ends", unit,
     [](auto& r) { return r() % 2 == 0 ? 1.7e308 : -1.7e308 * unit(r); }},
    {"huge", [](auto& r) { return (2 * unit(r) - 1) * 1.7e308; },
     [](auto& r) { return (2 * unit(r) - 1) * 1.7e308; }},
    {"huge or not", [](auto& r) { return r() % 2 == 0 ? unit(r) : (2 * unit(r) - 1) * 1.7e308; },
     [](auto& r) { return r() % 2 == 0 ? unit(r) : (2 * unit(r) - 1) * 1.7e308; }},
    {"huge or subnormal",
     [](auto& r) { return r() % 2 == 0 ? 1e308 : static_cast<double>(r() % 3) * 5e-324; },
     [](auto& r) { return r() % 2 == 0 ? 1e308 : static_cast<double>(r() % 5) * 5e-324; }},
    {"small", [](auto& r) { return unit(r) * 1e-307; }, [](auto& r) { return unit(r) * 1e-307; }},
    {"small, queries not", [](auto& r) { return unit(r) * 1e-307; }, unit},
    {"subnormal", [](auto& r) { return static_cast<double>(r() % 5) * 5e-324; },
     [](auto& r) { return static_cast<double>(r() % 9) * 5e-324; }},
    {"small or not", [](auto& r) { return r() % 2 == 0 ? unit(r) : unit(r) * 1e-200; },
     [](auto& r) { return unit(r) * 1e-200; }},
};

TEST(NearestPoint, IsAsDefined) {
  for (unsigned d = 1; d <= 8; ++d)
    for (const Kind& kind : kinds)
      check(drawn(d, 100, d, kind.point), drawn(d, 30, 99, kind.query), d, kind.name);
}

TEST(NearestPoint, FewPoints) {
  for (unsigned d = 1; d <= 8; ++d)
    for (const Kind& kind : kinds)
      for (const unsigned count : {1U, 2U, 9U})
        check(drawn(d, count, count, kind.point), drawn(d, 9, 98, kind.query), d, kind.name);
}

/// Of equal points the first one is told, however many there are.
TEST(NearestPoint, EqualPoints) {
  for (unsigned d = 1; d <= 8; ++d) {
    for (const Kind& kind : kinds) {
      const std::vector<double> some = drawn(d, 7, 3, kind.point);
      std::vector<double> points;
      std::mt19937_64 random(d);
      for (unsigned i = 0; i < 120; ++i) {
        const std::size_t from = i % 3 == 0 ? 0 : random() % 7;
        points.insert(points.end(), some.begin() + static_cast<std::ptrdiff_t>(from * d),
                      some.begin() + static_cast<std::ptrdiff_t>((from + 1) * d));
      }
      check(points, some, d, kind.name);
      check(points, drawn(d, 20, 97, kind.query), d, kind.name);
    }
    check(std::vector<double>(100 * d, 0.5), drawn(d, 9, 96, unit), d, "one point");
  }
  const std::vector<double> zeros{0, -0.0, -0.0, 0}, query{0, 0};
  check(zeros, query, 2, "zeros of either sign");
}

/// Enough for parts that threads build and for several chunks of queries; every point finds itself.
TEST(NearestPoint, ManyPoints) {
  for (const unsigned d : {1U, 2U, 3U, 6U}) {
    const unsigned count = 20'000;
    const std::vector<double> points = drawn(d, count, d, unit);
    std::vector<double> queries = drawn(d, 5000, 95, unit);
    std::vector<std::uint32_t> own(count), found(5000), again(5000);
    RunOptions one, four;
    one.threads = 1;
    four.threads = 4;
    const NearestPoint by_one(rows_of(points, d), one), by_four(rows_of(points, d), four);
    by_one.nearest(rows_of(points, d), own.data(), four);
    for (std::uint32_t i = 0; i < count; ++i) ASSERT_EQ(own[i], i) << d;
    by_one.nearest(rows_of(queries, d), found.data(), one);
    by_four.nearest(rows_of(queries, d), again.data(), four);
    ASSERT_EQ(found, again) << d;
    const std::vector<double> first(queries.begin(), queries.begin() + 5 * d);
    found.resize(5);
    ASSERT_EQ(found, slow_nearest_points(points, first, d)) << d;
  }
}

TEST(NearestPoint, ScalarTypesAndStridesOfEqualValueAgree) {
  const std::vector<double> points = drawn(3, 300, 1, [](auto& r) { return double(r() % 90); });
  const std::vector<double> queries = drawn(3, 300, 2, [](auto& r) { return double(r() % 90); });
  const std::vector<std::uint8_t> bytes(queries.begin(), queries.end());
  const std::vector<float> floats(points.begin(), points.end());
  std::vector<double> columns(900);
  for (std::size_t i = 0; i < 900; ++i) columns[i % 3 * 300 + i / 3] = queries[i];
  std::vector<std::uint32_t> a(300), b(300), c(300);
  NearestPoint(rows_of(points, 3)).nearest(rows_of(queries, 3), a.data());
  NearestPoint made(PointView::row_major(floats.data(), 300, 3));
  const NearestPoint moved = std::move(made);
  moved.nearest(PointView::row_major(bytes.data(), 300, 3), b.data());
  moved.nearest(PointView::column_major(columns.data(), 300, 3), c.data());
  EXPECT_EQ(a, b);
  EXPECT_EQ(a, c);
}

TEST(NearestPoint, RefusesWhatIsNone) {
  const std::vector<double> points{0, 0, 1, 0, 0, 1};
  const NearestPoint nearest(rows_of(points, 2));
  const std::vector<double> bad{0, 0, 0.5, std::nan(""), std::numeric_limits<double>::infinity(),
                                0};
  std::vector<std::uint32_t> out(3, 7);
  EXPECT_NE(error_of(ErrorCode::not_finite, [&] { nearest.nearest(rows_of(bad, 2), out.data()); })
                .find("point 1"),
            std::string::npos);
  EXPECT_EQ(error_of(ErrorCode::not_finite, [&] { nearest.nearest(bad.data() + 2); }),
            "coordinate 1 is NaN");
  EXPECT_EQ(error_of(ErrorCode::not_finite, [&] { nearest.nearest(bad.data() + 4); }),
            "coordinate 0 is infinite");
  EXPECT_NE(error_of(ErrorCode::not_finite, [&] { NearestPoint(rows_of(bad, 2)); }).find("point 1"),
            std::string::npos);
  EXPECT_EQ(error_of(ErrorCode::invalid_argument,
                     [&] { nearest.nearest(rows_of(points, 3), out.data()); }),
            "points of dimension 3 asked of points in dimension 2");
  EXPECT_EQ(error_of(ErrorCode::invalid_argument,
                     [&] { NearestPoint(PointView::row_major(points.data(), 0, 2)); }),
            "there are no points of which one could be the nearest");
  const std::vector<double> nine(9);
  EXPECT_EQ(error_of(ErrorCode::invalid_argument, [&] { NearestPoint(rows_of(nine, 9)); }),
            "nearest points are found in up to 8 dimensions, not in 9");
  nearest.nearest(PointView::row_major(points.data(), 0, 2), out.data());
  EXPECT_EQ(out, std::vector<std::uint32_t>(3, 7));
  RunOptions tight;
  tight.memory_budget = 1000;
  const std::vector<double> many(5000);
  error_of(ErrorCode::out_of_budget, [&] { NearestPoint(rows_of(many, 2), tight); });
}

TEST(NearestPoint, CanBeStopped) {
  const std::vector<double> points = drawn(2, 100, 1, unit);
  const NearestPoint nearest(rows_of(points, 2));
  std::stop_source stop;
  stop.request_stop();
  RunOptions o;
  o.stop = stop.get_token();
  std::vector<std::uint32_t> out(100);
  error_of(ErrorCode::cancelled, [&] { nearest.nearest(rows_of(points, 2), out.data(), o); });
  error_of(ErrorCode::cancelled, [&] { NearestPoint(rows_of(points, 2), o); });
  // While it runs: the poll is called again and again.
  RunOptions polled;
  polled.threads = 1;
  unsigned polls = 0;
  polled.poll = [&] {
    if (++polls == 5) throw std::runtime_error("enough");
  };
  const std::vector<double> queries = drawn(2, 50'000, 2, unit);
  out.resize(50'000);
  EXPECT_THROW(nearest.nearest(rows_of(queries, 2), out.data(), polled), std::runtime_error);
  EXPECT_EQ(polls, 5U);
}

/// From 3D on they ask a tree, in the plane they walk, as they do for queries that are too far away
/// for a tree; one that has been asked single questions, and one that has not.
TEST(NearestPoint, TriangulationsAgree) {
  for (unsigned d = 1; d <= 4; ++d)
    for (const Kind& kind : kinds) {
      const std::vector<double> points = drawn(d, 50, d, kind.point);
      std::vector<double> queries = drawn(d, 40, 94, kind.query);
      for (const double far : {1e12, -1e300, 1.7e308}) queries.insert(queries.end(), d, far);
      const std::size_t n = queries.size() / d;
      std::vector<std::uint32_t> found(n), wanted(n);
      NearestPoint(rows_of(points, d)).nearest(rows_of(queries, d), wanted.data());
      const Triangulation t = delaunay(rows_of(points, d));
      const TriangulationQuery query(rows_of(points, d), t);
      for (const unsigned threads : {1U, 4U}) {
        RunOptions o;
        o.threads = threads;
        query.nearest(rows_of(queries, d), found.data(), o);
        ASSERT_EQ(found, wanted) << kind.name << " in " << d;
        for (std::size_t i = 0; i < n; i += 4)
          ASSERT_EQ(query.nearest(queries.data() + i * d), wanted[i]) << kind.name << " in " << d;
      }
      const TriangulationQuery other(rows_of(points, d), t);
      for (std::size_t i = 0; i < n; i += 4)
        ASSERT_EQ(other.nearest(queries.data() + i * d), wanted[i]) << kind.name << " in " << d;
      // In a flat, whose columns are taken in another order.
      std::vector<double> flat, asked;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (i % d == 0) flat.push_back(0.25);
        flat.push_back(points[i]);
      }
      for (std::size_t i = 0; i < queries.size(); ++i) {
        if (i % d == 0) asked.push_back(queries[i]);
        asked.push_back(queries[i]);
      }
      NearestPoint(rows_of(flat, d + 1)).nearest(rows_of(asked, d + 1), wanted.data());
      const TriangulationQuery in_flat(rows_of(flat, d + 1), delaunay(rows_of(flat, d + 1)));
      in_flat.nearest(rows_of(asked, d + 1), found.data());
      ASSERT_EQ(found, wanted) << kind.name << " in a flat of " << d;
    }
}

}  // namespace nearest_point_test
}  // namespace cullhull
