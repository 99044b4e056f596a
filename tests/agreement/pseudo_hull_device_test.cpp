// The PseudoHull as a device runs it, without a device: points read where they lie, kernel bodies
// in loops over blocks and threads. It must equal the host's, bit for bit, in every round.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "cullhull/options.hpp"
#include "filter/pseudo_hull/pseudo_hull.hpp"
#include "filter/pseudo_hull/pseudo_hull_growth.hpp"
#include "parallel/threads/run.hpp"
#include "reference/emulated_executor.hpp"
#include "tests/made_sets.hpp"

namespace cullhull::internal::pseudo_hull_device_test {

using testing_support::normal_points;

struct Grown {
  std::vector<std::uint64_t> survivors;
  std::vector<PseudoHullRound> rounds;
};

template <unsigned D, class T>
Grown grow_emulated(const PointView& view, unsigned subsets, unsigned max_rounds) {
  using Rows = RowsInPlace<D, T>;
  Grown result;
  PseudoHullGrowth<D, EmulatedExecutor, Rows> growth(EmulatedExecutor(5, 32));
  std::vector<bool> kept(view.count, true);
  for (std::uint64_t s = 0; s < subsets; ++s) {
    const PseudoSubset subset{view.count, s, subsets};
    growth.run(rows_in_place<D, T>(view, subset), static_cast<std::uint32_t>(subset.size()),
               max_rounds, Control(Options{}), result.rounds);
    for (std::uint64_t i = 0; i < subset.size(); ++i)
      kept[subset.point(i)] = growth.culled()[i] == 0;
  }
  for (std::uint64_t i = 0; i < view.count; ++i)
    if (kept[i]) result.survivors.push_back(i);
  return result;
}

template <unsigned D, class T>
void expect_as_on_the_host(const PointView& view, const std::string& name) {
  for (const unsigned subsets : {1U, 3U})
    for (const unsigned max_rounds : {0U, 2U, 100U}) {
      const Grown device = grow_emulated<D, T>(view, subsets, max_rounds);
      std::vector<PseudoHullRound> rounds;
      EXPECT_EQ(device.survivors,
                pseudo_hull_survivors(view, {subsets, max_rounds}, internal::short_run(), &rounds))
          << name << ", " << D << "D, " << subsets << " subsets";
      ASSERT_EQ(device.rounds.size(), rounds.size()) << name;
      for (std::size_t r = 0; r < rounds.size(); ++r) {
        EXPECT_EQ(device.rounds[r].facets, rounds[r].facets) << name << ", round " << r;
        EXPECT_EQ(device.rounds[r].exterior, rounds[r].exterior);
        EXPECT_EQ(device.rounds[r].culled, rounds[r].culled);
        EXPECT_EQ(device.rounds[r].kept, rounds[r].kept);
      }
    }
}

template <unsigned D, class T>
void expect_agreement() {
  const std::size_t n = D <= 4 ? 6000 : 2500;
  for (const double step : {0.0, 0.5}) {  // on a grid ties and duplicates are the rule
    const std::vector<T> p = normal_points<T>(n, D, 41 * D, step);
    expect_as_on_the_host<D, T>(PointView::row_major(p.data(), n, D), "rows");
    expect_as_on_the_host<D, T>(PointView::column_major(p.data(), n / 2, D), "columns");
    PointView backwards = PointView::row_major(p.data() + (n - 1) * D, n / 3, D);
    backwards.point_stride = -2 * backwards.point_stride;
    expect_as_on_the_host<D, T>(backwards, "every second point, backwards");
  }
}

TEST(PseudoHullOnADevice, EqualsTheHostInEveryRound) {
  expect_agreement<2, float>();
  expect_agreement<2, double>();
  expect_agreement<3, float>();
  expect_agreement<3, double>();
  expect_agreement<4, float>();
  expect_agreement<4, double>();
  expect_agreement<5, float>();
  expect_agreement<5, double>();
  expect_agreement<6, float>();
  expect_agreement<6, double>();
}

TEST(PseudoHullOnADevice, FlatTinyHugeAndNotFinite) {
  const std::size_t n = 1500;
  std::vector<double> flat = normal_points<double>(n, 3, 1, 0);
  for (std::size_t i = 0; i < n; ++i) flat[3 * i + 2] = flat[3 * i] + flat[3 * i + 1];
  expect_as_on_the_host<3, double>(PointView::row_major(flat.data(), n, 3), "flat");
  const std::vector<double> equal(3 * n, 0.1);
  expect_as_on_the_host<3, double>(PointView::row_major(equal.data(), n, 3), "equal");
  expect_as_on_the_host<3, double>(PointView::row_major(equal.data(), 0, 3), "none");
  for (const double scale : {1e-322, 1e-300, 1e307}) {
    std::vector<double> v = normal_points<double>(n, 3, 2, 0);
    for (double& x : v) x *= scale;
    expect_as_on_the_host<3, double>(PointView::row_major(v.data(), n, 3), std::to_string(scale));
  }
  for (const float scale : {1e-44F, 1e-38F, 1e37F}) {
    std::vector<float> v = normal_points<float>(n, 3, 3, 0);
    for (float& x : v) x *= scale;
    expect_as_on_the_host<3, float>(PointView::row_major(v.data(), n, 3), std::to_string(scale));
  }
  std::vector<float> bad = normal_points<float>(n, 3, 4, 0);
  for (std::size_t i = 7; i < bad.size(); i += 97)
    bad[i] = i % 2 != 0 ? NAN : std::numeric_limits<float>::infinity();
  expect_as_on_the_host<3, float>(PointView::row_major(bad.data(), n, 3), "not finite");
}

}  // namespace cullhull::internal::pseudo_hull_device_test
