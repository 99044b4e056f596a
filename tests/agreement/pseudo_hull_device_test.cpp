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
#include "tests/reference/same_rounds.hpp"

namespace cullhull::internal::pseudo_hull_device_test {

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
      testing_support::expect_same_rounds(device.rounds, rounds, name);
    }
}

template <unsigned D, class T>
void expect_agreement() {
  const std::size_t n = D <= 4 ? 6000 : 2500;
  testing_support::each_normal_layout<T>(n, D, 41 * D,
                                         [](const auto&, const auto& view, const char* name) {
    expect_as_on_the_host<D, T>(view, name);
  });
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
  testing_support::each_awkward_set(n, [&](const auto& rows, const std::string& name) {
    using Scalar = typename std::decay_t<decltype(rows)>::value_type;
    expect_as_on_the_host<3, Scalar>(PointView::row_major(rows.data(), n, 3), name);
  });
  const double any[3] = {};
  expect_as_on_the_host<3, double>(PointView::row_major(any, 0, 3), "none");
}

}  // namespace cullhull::internal::pseudo_hull_device_test
