// Whatever the PseudoHull drops lies strictly inside the hull, by exact arithmetic that shares no
// code with it: points on facets and ridges, one step in and out, far from the origin, of tiny and
// huge scale, on grids, copies of extreme points.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "cullhull/options.hpp"
#include "filter/pseudo_hull/pseudo_hull.hpp"
#include "parallel/threads/run.hpp"
#include "reference/slow_hull.hpp"

namespace cullhull::internal {
namespace pseudo_hull_soundness_test {

const Options defaults;

class Points {
 public:
  Points(unsigned d, std::uint64_t seed) : d_(d), random_(seed) {}

  double unit() { return std::ldexp(static_cast<double>(random_() >> 11), -53); }
  std::size_t count() const { return rows_.size() / d_; }
  const std::vector<double>& rows() const { return rows_; }

  /// In the ball of radius 1/2, uniform up to 4D; beyond, crowded about the centre, or no point
  /// would be inside. Perhaps rounded to a grid with so many steps.
  void add_ball(std::size_t n, int steps = 0) {
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<double> p(d_);
      double square = 0;
      for (double& v : p) {
        v = normal(random_);
        square += v * v;
      }
      const double radius = 0.5 * std::pow(unit(), d_ <= 4 ? 1.0 / d_ : 3.0);
      for (double& v : p) {
        v *= radius / std::sqrt(square);
        if (steps > 0) v = std::round(v * steps);
      }
      rows_.insert(rows_.end(), p.begin(), p.end());
    }
  }
  /// x -> (x + shift) scale, rounded.
  void move(double shift, double scale) {
    for (double& v : rows_) v = (v + shift) * scale;
  }
  /// Rounded convex combinations of 1 ... d of the outer points, and each one step in and out: on
  /// facets, ridges and vertices of whatever simplices the filter builds of them.
  void add_adversaries(std::size_t n) {
    const std::size_t outer = std::min<std::size_t>(count(), 2 * d_ + 2);
    std::vector<std::size_t> order(count());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::vector<double> centre(d_, 0);
    for (std::size_t i = 0; i < rows_.size(); ++i)
      centre[i % d_] += rows_[i] / static_cast<double>(count());
    const auto far = [&](std::size_t i) {
      double most = 0;
      for (unsigned k = 0; k < d_; ++k)
        most = std::max(most, std::fabs(rows_[i * d_ + k] - centre[k]));
      return most;
    };
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return far(a) > far(b); });
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<double> p(d_, 0);
      const std::size_t corners = 1 + i % d_;
      std::size_t at = random_() % outer;
      double left = 1;
      for (std::size_t c = 0; c < corners; ++c, at = (at + 1) % outer) {
        const double weight = c + 1 == corners ? left : left * unit();
        left -= weight;
        for (unsigned k = 0; k < d_; ++k) p[k] += weight * rows_[order[at] * d_ + k];
      }
      if (i % 3 != 0) {
        const double to = i % 3 == 1 ? -std::numeric_limits<double>::infinity()
                                     : std::numeric_limits<double>::infinity();
        for (unsigned k = 0; k < d_; ++k)
          if (random_() % 2 != 0) p[k] = std::nextafter(p[k], to);
      }
      extra_.insert(extra_.end(), p.begin(), p.end());
    }
    rows_.insert(rows_.end(), extra_.begin(), extra_.end());
    extra_.clear();
  }

 private:
  unsigned d_;
  std::mt19937_64 random_;
  std::vector<double> rows_, extra_;
};

/// Every dropped point is strictly inside; returns how many were dropped.
std::size_t expect_sound(const PointView& view, const std::vector<double>& rows,
                         const std::string& name) {
  const unsigned d = view.dimension;
  const reference::SlowHull hull(rows, d);
  std::size_t dropped = 0;
  for (const unsigned subsets : {1U, 2U}) {
    const auto kept = pseudo_hull_survivors(view, {subsets, 1000},
                                            internal::Run(defaults).with_threads(1 + subsets % 2));
    dropped += view.count - kept.size();
    if (hull.affine_dimension() < static_cast<int>(d)) {
      EXPECT_EQ(kept.size(), view.count) << name;
      continue;
    }
    for (std::uint64_t i = 0, k = 0; i < view.count; ++i) {
      if (k < kept.size() && kept[k] == i)
        ++k;
      else
        EXPECT_EQ(hull.locate(hull.point(static_cast<std::uint32_t>(i))), -1)
            << name << ": point " << i << " of " << view.count;
    }
  }
  return dropped;
}

std::size_t expect_sound(const Points& points, unsigned d, const std::string& name) {
  return expect_sound(PointView::row_major(points.rows().data(), points.count(), d), points.rows(),
                      name);
}

std::string label(const char* what, unsigned d, std::uint64_t seed) {
  return std::string(what) + " " + std::to_string(d) + "D seed " + std::to_string(seed);
}

// Few points in high dimensions: the exact hull is slow.
constexpr std::size_t ball_points[] = {0, 0, 600, 500, 120, 60, 40, 40};
constexpr unsigned highest = 7;

TEST(PseudoHullSoundness, OnFacetsAndRidgesOneStepInAndOut) {
  for (unsigned d = 2; d <= highest; ++d)
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      Points p(d, 100 * d + seed);
      p.add_ball(ball_points[d]);
      p.add_adversaries(d <= 3 ? 300 : d <= 5 ? 120 : 30);
      EXPECT_GT(expect_sound(p, d, label("adversaries", d, seed)), 0U) << d;
    }
}

TEST(PseudoHullSoundness, FarFromTheOriginAndOfAnyScale) {
  const double moves[][2] = {{1e6, 1},     {-1e13, 1}, {0, 1e-320}, {0.25, 1e-308},
                             {0, 1.5e308}, {3, 4e307}, {0x1p50, 1}, {0, 0x1p-1000}};
  for (unsigned d = 2; d <= 4; ++d)
    for (const auto& m : moves) {
      Points p(d, 7 * d);
      p.add_ball(ball_points[d] / 2);
      p.move(m[0], m[1]);
      p.add_adversaries(60);
      expect_sound(p, d, label("moved", d, 7 * d) + " by " + std::to_string(m[0]));
    }
}

TEST(PseudoHullSoundness, Grids) {
  for (unsigned d = 2; d <= 5; ++d)
    for (const int steps : {4, 9, 30}) {
      Points p(d, 31 * d);
      p.add_ball(ball_points[d], steps);
      expect_sound(p, d, label("grid", d, 31 * d));
    }
}

// Thin slabs: one axis, and one direction across the axes, far shorter than the others.
TEST(PseudoHullSoundness, Slabs) {
  std::size_t dropped = 0;
  for (unsigned d = 2; d <= 4; ++d)
    for (const double thickness : {1e-3, 1e-9, 1e-14, 1e-16, 1e-30}) {
      Points p(d, 5 * d);
      p.add_ball(ball_points[d] / 2);
      std::vector<double> axis = p.rows(), across = p.rows();
      for (std::size_t i = 0; i < p.count(); ++i) {
        axis[i * d] *= thickness;
        double sum = 0;
        for (unsigned k = 1; k < d; ++k) sum += across[i * d + k];
        across[i * d] = sum + thickness * across[i * d];
      }
      dropped += expect_sound(PointView::row_major(axis.data(), p.count(), d), axis, "slab");
      expect_sound(PointView::row_major(across.data(), p.count(), d), across, "slant slab");
    }
  EXPECT_GT(dropped, 0U);
}

TEST(PseudoHullSoundness, CopiesOfExtremePointsSurvive) {
  for (unsigned d = 2; d <= 5; ++d) {
    Points p(d, 11 * d);
    p.add_ball(ball_points[d] / 2);
    std::vector<double> rows = p.rows();
    const reference::SlowHull hull(rows, d);
    const auto extreme = hull.extreme_points();
    const std::size_t n = p.count();
    for (const std::uint32_t v : extreme) rows.insert(rows.end(), hull.point(v), hull.point(v) + d);
    const auto kept = pseudo_hull_survivors(PointView::row_major(rows.data(), rows.size() / d, d),
                                            {}, internal::Run(defaults).with_threads(2));
    for (std::size_t k = 0; k < extreme.size(); ++k) {
      EXPECT_TRUE(std::binary_search(kept.begin(), kept.end(), extreme[k])) << d << "D";
      EXPECT_TRUE(std::binary_search(kept.begin(), kept.end(), n + k)) << d << "D";
    }
    EXPECT_LT(kept.size(), rows.size() / d);
  }
}

TEST(PseudoHullSoundness, FloatsAreTakenAtTheirExactValue) {
  for (unsigned d = 2; d <= 4; ++d) {
    Points p(d, 13 * d);
    p.add_ball(ball_points[d] / 2);
    p.move(1000, 1);
    const std::vector<float> single(p.rows().begin(), p.rows().end());
    const std::vector<double> exact(single.begin(), single.end());
    EXPECT_GT(expect_sound(PointView::row_major(single.data(), p.count(), d), exact,
                           label("floats", d, 13 * d)),
              0U);
  }
}

// Layout and threads change nothing.
TEST(PseudoHullSoundness, SurvivorsDependOnThePointsAlone) {
  for (unsigned d = 2; d <= 8; ++d) {
    Points p(d, 17 * d);
    p.add_ball(d <= 4 ? 20000 : 3000);
    const std::size_t n = p.count();
    const auto view = PointView::row_major(p.rows().data(), n, d);
    std::vector<double> columns(n * d);
    for (std::size_t i = 0; i < n; ++i)
      for (unsigned k = 0; k < d; ++k) columns[k * n + i] = p.rows()[i * d + k];
    for (const unsigned subsets : {1U, 5U}) {
      std::vector<PseudoHullRound> rounds, other;
      const auto kept = pseudo_hull_survivors(view, {subsets, 1000},
                                              internal::Run(defaults).with_threads(1), &rounds);
      EXPECT_LT(kept.size(), n) << d;
      for (const unsigned threads : {2U, 3U})
        EXPECT_EQ(
            pseudo_hull_survivors(PointView::column_major(columns.data(), n, d), {subsets, 1000},
                                  internal::Run(defaults).with_threads(threads), &other),
            kept)
            << d << "D, " << subsets << " subsets, " << threads << " threads";
      ASSERT_EQ(other.size(), rounds.size());
      std::uint64_t culled = 0, left = 0;
      for (std::size_t r = 0; r < rounds.size(); ++r) {
        EXPECT_EQ(other[r].facets, rounds[r].facets);
        EXPECT_EQ(other[r].culled, rounds[r].culled);
        culled += rounds[r].culled;
        left += rounds[r].kept;
      }
      EXPECT_EQ(rounds[0].exterior, n);
      EXPECT_EQ(left, kept.size());
      EXPECT_EQ(culled, n - kept.size());
    }
  }
}

}  // namespace pseudo_hull_soundness_test
}  // namespace cullhull::internal
