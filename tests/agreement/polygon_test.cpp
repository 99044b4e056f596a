// The 2D result written from the polygon against the fallback, bit for bit; extreme points of
// the plane; cancelling.
#include "hull/plane/polygon.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "agreement/canonical_hash.hpp"
#include "call_options.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/generate.hpp"
#include "geometry/local_frame.hpp"
#include "hull/engine.hpp"
#include "made_sets.hpp"
#include "result/build_hull.hpp"
#include "result/write/write_polygon.hpp"
#include "thrown.hpp"

namespace cullhull::internal::polygon_test {

using namespace testing_support;

using Points = std::vector<double>;

PointView view_of(const Points& p) { return PointView::row_major(p.data(), p.size() / 2, 2); }

/// Frame, surface, general result: none of what is tested here but the engine.
Hull general(const PointView& view, unsigned threads) {
  const internal::Run& run = internal::short_run();
  const LocalFrame frame(gather_points(view, nullptr, view.count, run),
                         static_cast<std::uint32_t>(view.count), 2, run);
  Hull hull;
  build_hull({&view, &frame.points(), nullptr, frame.axes().data()},
             hull_2d(frame.points(), run.with_threads(threads)), run.with_threads(threads), hull);
  return hull;
}

void expect_general_result(const PointView& view) {
  const Hull expected = general(view, 1);
  std::vector<std::uint64_t> ascending = expected.vertices;
  std::sort(ascending.begin(), ascending.end());
  for (const unsigned threads : {1U, 2U, 5U})
    for (const CullMethod cull : {CullMethod::automatic, CullMethod::none}) {
      const Options options = options_of(threads, cull);
      EXPECT_EQ(canonical_hash(convex_hull(view, options)), canonical_hash(expected));
      const ExtremePoints extreme = extreme_points(view, options);
      EXPECT_EQ(extreme.ids, ascending);
      EXPECT_EQ(extreme.affine_dimension, 2);
    }
}

TEST(PolygonResult, GeneratedSets) {
  for (const char* shape : {"sphere", "ball", "gauss", "cube", "grid", "grid:1048576"})
    for (const std::uint64_t n : {5U, 33U, 100U, 3000U, 120'000U}) {
      SCOPED_TRACE(std::string(shape) + " " + std::to_string(n));
      const Points p = generate(shape, n, 2);
      expect_general_result(view_of(p));
    }
}

TEST(PolygonResult, AnyLayoutAndScalar) {
  constexpr std::uint64_t n = 50'000;
  const Points p = generate("sphere", n, 2, 3);
  std::vector<float> f(p.begin(), p.end());
  std::vector<std::int16_t> s;
  const std::vector<double> columns = transposed(p, 2);
  std::vector<double> gaps(5 * n, 7.0);
  for (std::uint64_t i = 0; i < n; ++i)
    for (unsigned j = 0; j < 2; ++j) {
      s.push_back(static_cast<std::int16_t>(p[2 * i + j] * 32767));
      gaps[5 * i + 2 * j] = p[2 * i + j];
    }
  expect_general_result(PointView::row_major(f.data(), n, 2));
  expect_general_result(PointView::row_major(s.data(), n, 2));
  expect_general_result(PointView::column_major(columns.data(), n, 2));
  PointView strided = PointView::row_major(gaps.data(), n, 2);
  strided.point_stride = 40;
  strided.coordinate_stride = 16;
  expect_general_result(strided);
  // Doubles that are not aligned.
  std::vector<std::byte> bytes(16 * n + 1);
  std::memcpy(bytes.data() + 1, p.data(), 16 * n);
  PointView odd = view_of(p);
  odd.data = bytes.data() + 1;
  expect_general_result(odd);
  // Backwards.
  PointView back = view_of(p);
  back.data += 16 * (n - 1);
  back.point_stride = -16;
  expect_general_result(back);
}

TEST(PolygonResult, NegativeZerosKeepTheirBits) {
  const Points p = {-0.0, -0.0, 1.0, -0.0, 1.0, 1.0, -0.0, 1.0, 0.5, 0.25};
  expect_general_result(view_of(p));
  const Points q = {1.0, -0.0, -0.0, 1.0, -1.0, -0.0, -0.0, -1.0};
  expect_general_result(view_of(q));
}

TEST(PolygonResult, Magnitudes) {
  // Far from the origin, large, small, and what must take the fallback: thin, or of unlike ranges.
  std::mt19937_64 g(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  const double tables[][4] = {{1, 1, 1e6, -1e6},      {1e200, 1e200, 0, 0},
                              {1e-200, 1e-200, 0, 0}, {1e307, 1e307, 0, 0},
                              {1e-307, 1e-307, 0, 0}, {1e150, 1e-150, 0, 0},
                              {1, 1e-9, 0, 0},        {1, 1e-15, 1, 1},
                              {1e-12, 1, 1000, 0},    {5e-324 * 1000, 5e-324 * 1000, 0, 0},
                              {1e300, 1e-300, 0, 0},  {1e308, 1, 0, 0}};
  for (const auto& t : tables)
    for (const unsigned n : {6U, 200U, 20'000U}) {
      SCOPED_TRACE(std::to_string(t[0]) + " x " + std::to_string(t[1]) + ", " + std::to_string(n));
      Points p;
      for (unsigned i = 0; i < n; ++i) {
        p.push_back(unit(g) * t[0] + t[2]);
        p.push_back(unit(g) * t[1] + t[3]);
      }
      expect_general_result(view_of(p));
    }
}

TEST(PolygonResult, NearlyOnALine) {
  // Thin beyond what the plain sums can tell.
  std::mt19937_64 g(12);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const double slope : {0.0, 1.0, 0.3, 1e-8}) {
    Points p;
    for (unsigned i = 0; i < 1000; ++i) {
      const double t = unit(g);
      p.push_back(t);
      p.push_back(slope * t + 0x1p-52 * static_cast<double>(g() % 3));
    }
    SCOPED_TRACE(slope);
    expect_general_result(view_of(p));
  }
}

/// Two places that single precision takes for one each, and many copies of few points: the map
/// keeps nearly all, and the engine sorts them.
TEST(PolygonResult, CrowdedPoints) {
  std::mt19937_64 g(13);
  std::uniform_real_distribution<double> unit(-1, 1);
  Points clusters, copies;
  for (unsigned i = 0; i < 60'000; ++i) {
    clusters.push_back((i % 2 ? 0.75 : -0.75) + 0x1p-30 * unit(g));
    clusters.push_back(i % 10'000 == 7 ? unit(g) : 0x1p-40 * unit(g));
    // Whole numbers would be thinned by columns before.
    copies.push_back(0.3 * static_cast<double>(g() % 2));
    copies.push_back(0.7 * static_cast<double>(g() % 3));
  }
  for (const Points* p : {&clusters, &copies}) {
    expect_general_result(view_of(*p));
    const Hull hull = convex_hull(view_of(*p));
    EXPECT_NE(hull.statistics.cull_reason.find("it kept nearly all"), std::string::npos)
        << hull.statistics.cull_reason;
    EXPECT_EQ(hull.statistics.survivors, 60'000U);
    EXPECT_TRUE(cull(view_of(*p)).all);
  }
}

TEST(Polygon, LinesAndPoints) {
  const internal::Run& run = internal::short_run();
  const auto corners = [&](const Points& p) {
    const auto c = polygon_of(view_of(p), false, run.with_threads(2)).corners;
    return std::vector<std::uint32_t>(c.begin(), c.end());
  };
  using Rows = std::vector<std::uint32_t>;
  EXPECT_EQ(corners({1, 2}), (Rows{0}));
  EXPECT_EQ(corners({1, 2, 1, 2, 1, 2}), (Rows{0}));
  EXPECT_EQ(corners({1, 2, 0, 5, 1, 2}), (Rows{1, 0}));
  EXPECT_EQ(corners({0, 2, 0, 5, 0, 3, 0, 5}), (Rows{0, 1}));
  Points line, vertical, horizontal, same;
  for (int i = 0; i < 100'000; ++i) {
    const double t = static_cast<double>((i * 7919LL) % 100'003);
    line.insert(line.end(), {t, t / 4});
    vertical.insert(vertical.end(), {0.1, t});
    horizontal.insert(horizontal.end(), {t, 0.1});
    same.insert(same.end(), {0.1, -0.3});
  }
  line.insert(line.end(), {200'000, 50'000, -4, -1, 200'000, 50'000});
  vertical.insert(vertical.end(), {0.1, -1, 0.1, 1e9, 0.1, -1});
  EXPECT_EQ(corners(line), (Rows{100'001, 100'000}));
  EXPECT_EQ(corners(vertical), (Rows{100'000, 100'001}));
  // Chunks of points without an end of the line.
  horizontal.insert(horizontal.end(), {-1, 0.1, 1e9, 0.1, -1, 0.1});
  EXPECT_EQ(corners(horizontal), (Rows{100'000, 100'001}));
  EXPECT_EQ(corners(same), (Rows{0}));
  EXPECT_EQ(extreme_points(view_of(line)).affine_dimension, 1);
  EXPECT_EQ(extreme_points(view_of(line)).ids, (std::vector<std::uint64_t>{100'000, 100'001}));
  EXPECT_EQ(extreme_points(view_of(same)).affine_dimension, 0);
}

TEST(Polygon, SeriesIsTheSame) {
  const internal::Run& run = internal::short_run();
  PolygonSeries series(run.control);
  for (unsigned seed = 1; seed <= 200; ++seed) {
    std::mt19937_64 g(seed);
    const auto n = static_cast<std::uint32_t>(1 + g() % (seed % 10 == 0 ? 3000 : 70));
    const std::uint64_t side = seed % 3 == 0 ? 6 : 1'000'000;
    Points p;
    for (std::uint32_t i = 0; i < 2 * n; ++i) p.push_back(static_cast<double>(g() % side));
    const Polygon expected = polygon_of(view_of(p), false, run);
    EXPECT_EQ(series.corners(p.data(), n),
              (std::vector<std::uint32_t>(expected.corners.begin(), expected.corners.end())));
    for (unsigned j = 0; j < 2; ++j) {
      EXPECT_EQ(series.box().low[j], expected.box.low[j]);
      EXPECT_EQ(series.box().high[j], expected.box.high[j]);
    }
  }
}

TEST(Polygon, BadPointsAreNamed) {
  Points p = generate("sphere", 200'000, 2);
  p[2 * 150'000] = std::nan("");
  p[2 * 70'000 + 1] = HUGE_VAL;
  for (const unsigned threads : {1U, 2U}) {
    const Options options = options_of(threads, CullMethod::none);
    const auto expect_named = [](const auto& call) {
      EXPECT_TRUE(has(error_of(ErrorCode::not_finite, call), "point 70000, coordinate 1"));
    };
    expect_named([&] { convex_hull(view_of(p), options); });
    expect_named([&] { extreme_points(view_of(p), options); });
  }
}

TEST(Polygon, StopsAtEveryStage) {
  const Points p = generate("sphere", 300'000, 2);
  // A run that reports `stages` times, stopped at each.
  int stages = 0;
  for (int stop_at = 0; stop_at == 0 || stop_at <= stages; ++stop_at) {
    std::stop_source source;
    Options options = options_of(2);
    options.stop = source.get_token();
    int seen = 0;
    std::string last;
    options.progress = [&](const char* phase, double) {
      last = phase;
      if (++seen == stop_at) source.request_stop();
    };
    try {
      const Hull hull = convex_hull(view_of(p), options);
      EXPECT_TRUE(stop_at == 0 || last == "done") << "not stopped at " << stop_at;
      if (stop_at == 0) stages = seen;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled);
      EXPECT_GT(stop_at, 0);
    }
  }
  EXPECT_GT(stages, 3);
}

// Points are divided by the chord from the leftmost to the rightmost, so that a circle takes one
// turn a point. Without the chord every point would be on both sides, and its turns thrice as many.
TEST(Polygon, ACircleTakesOneTurnAPoint) {
  constexpr std::uint64_t n = 300'000;
  const std::vector<double> rows = generate("sphere", n, 2, 7);
  Options options;
  options.cull = CullMethod::none;
  const Hull hull = convex_hull(PointView::row_major(rows.data(), n, 2), options);
  ASSERT_GT(hull.vertices.size(), n - 10);
  std::uint64_t turns = 0;
  for (const std::uint64_t count : hull.statistics.rung_counts) turns += count;
  EXPECT_LT(turns, n + n / 10);
}

}  // namespace cullhull::internal::polygon_test
