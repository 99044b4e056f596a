// Every layout of points at every border of words, tiles, blocks and pieces, as the kernels are
// really launched, against the CPU's survivors.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "cuda/gauge.hpp"
#include "cuda/kernels/gauge_kernel.hpp"
#include "cuda/runtime.hpp"
#include "device_sets.hpp"
#include "emulation.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "tests/made_sets.hpp"

namespace cullhull::testing {
namespace emulated_layouts_test {

using internal::GaugeMap;
using testing_support::cross_polytope;

/// Some of them no numbers, huge or tiny: those survive.
template <class T>
std::vector<T> strewn_rows(unsigned d, std::size_t n) {
  std::vector<T> rows = testing_support::uniform_points<T>(d, n, 0.125, 1.2 / d + 0.2, 31 * n + d);
  const double odd[] = {NAN,     INFINITY, -INFINITY, 1e38,  -3e38,  0x1p126,
                        0x1p127, 0,        -0.0,      1e-44, -1e-40, 3.4e38};
  for (std::size_t e = 0; e * 7 < rows.size() / 2; ++e)
    rows[e * 7] = static_cast<T>(odd[e % std::size(odd)]);
  return rows;
}

/// One memory layout of the rows.
template <class T>
struct Layout {
  std::string name;
  std::vector<T> memory;
  std::size_t first;
  std::ptrdiff_t point_stride, coordinate_stride;  // in values
};

template <class T>
std::vector<Layout<T>> layouts_of(const std::vector<T>& rows, unsigned d, std::size_t n) {
  const auto step = static_cast<std::ptrdiff_t>(d);
  std::vector<Layout<T>> all{{"packed", rows, 0, step, 1}};
  for (std::size_t shift = 1; shift < 16 / sizeof(T); ++shift) {
    std::vector<T> memory(n * d + shift);
    std::copy(rows.begin(), rows.end(), memory.begin() + static_cast<std::ptrdiff_t>(shift));
    all.push_back({"shifted", std::move(memory), shift, step, 1});
  }
  std::vector<T> records(n * (d + 3) + 2, T(NAN)), backwards(n * d);
  for (std::size_t i = 0; i < n; ++i)
    for (unsigned j = 0; j < d; ++j) {
      const T value = rows[i * d + j];
      records[i * (d + 3) + 2 + j] = value;
      backwards[(n - 1 - i) * d + (d - 1 - j)] = value;
    }
  all.push_back(
      {"columns", testing_support::transposed(rows, d), 0, 1, static_cast<std::ptrdiff_t>(n)});
  all.push_back({"records", records, 2, step + 3, 1});
  if (n > 0) all.push_back({"backwards", backwards, n * d - 1, -step, -1});
  return all;
}

template <class T>
void expect_all_layouts(const GaugeMap& map, unsigned d, std::size_t n) {
  const Options options;
  const internal::Run run(options);
  const std::vector<T> rows = strewn_rows<T>(d, n);
  const auto here = PointView::row_major(rows.data(), n, d);
  const auto expected = n > 0 ? map.survivors(here, run.with_threads(1)) : Array<std::uint64_t>{};
  for (const Layout<T>& layout : layouts_of(rows, d, n)) {
    const std::string what = layout.name + " " + std::to_string(d) + "D " +
                             std::to_string(sizeof(T)) + " bytes, " + std::to_string(n);
    const OnDevice there(layout.memory);
    DevicePointView view = DevicePointView::row_major(there.data<T>() + layout.first, n, d);
    view.point_stride = layout.point_stride * static_cast<std::ptrdiff_t>(sizeof(T));
    view.coordinate_stride = layout.coordinate_stride * static_cast<std::ptrdiff_t>(sizeof(T));
    const auto found = internal::survivors_of_device_points(map.table(), view);
    Array<std::uint64_t> ids(found.count);
    internal::download(ids.data(), found.ids.data(), found.count, nullptr);
    ASSERT_EQ(ids, expected) << what;
    ASSERT_EQ(internal::survivors_by_pieces(map.table(), view, run.control), expected) << what;
    if (ids.empty()) continue;
    const auto fetched = internal::download_points(view, ids.data(), ids.size(), run);
    for (std::size_t k = 0; k < ids.size() * d; ++k) {
      const auto value = static_cast<double>(rows[ids[k / d] * d + k % d]);
      ASSERT_TRUE(fetched[k] == value || value != value) << what;
    }
  }
  ASSERT_EQ(internal::survivors_there(map.table(), here, run.with_threads(2)), expected);
}

TEST(EmulatedLayouts, EveryBorderInEveryDimension) {
  for (unsigned d = 2; d <= 6; ++d) {
    const auto map = GaugeMap::build(cross_polytope(d, 0.125, 1), 0, internal::most_map_nodes());
    for (const std::size_t n : {0U, 1U, 31U, 32U, 33U, 63U, 65U, 127U, 129U, 255U, 257U, 511U, 513U,
                                1023U, 1025U, 2047U, 2049U}) {
      emulation::restart(n + d);
      expect_all_layouts<float>(*map, d, n);
      expect_all_layouts<double>(*map, d, n);
    }
  }
  for (const unsigned d : {2U, 3U})
    expect_all_layouts<float>(*GaugeMap::build(cross_polytope(d, 0.125, 1)), d, 32769);
}

TEST(EmulatedLayouts, ATableBeyondSharedMemory) {
  const auto map = GaugeMap::build(cross_polytope(3, 0.125, 1), 200);
  for (const std::size_t n : {1U, 33U, 5000U}) {
    expect_all_layouts<float>(*map, 3, n);
    expect_all_layouts<double>(*map, 3, n);
  }
}

// Only the last blocks of each launch are run, and most of the mask's memory is never touched.
TEST(EmulatedLayouts, MoreThan2To32WordsOfAMask) {
  emulation::settings().memory = std::size_t{1} << 36;
  emulation::settings().most_blocks = 3;
  const auto map = GaugeMap::build(cross_polytope(3, 0.125, 1));
  const internal::GaugeTable& table = map->table();
  internal::Device device = internal::this_device();
  device.multiprocessors = 1U << 30;  // as many blocks at a time as the points need
  constexpr std::uint64_t tail = 70, words = (std::uint64_t{1} << 32) + tail;
  const std::vector<float> outside{9, 9, 9};
  {
    const OnDevice nodes(table.nodes), point(outside);
    auto view = DevicePointView::row_major(point.data<float>(), 32 * words, 3);
    view.point_stride = 0;  // the same one for all ids
    const internal::DeviceArray<std::uint32_t> mask(internal::mask_room(32 * words), nullptr);
    check(internal::gauge_mask(table, nodes.data<float>(), view, mask.data(), device, nullptr));
    std::vector<std::uint32_t> last(tail);
    internal::download(last.data(), mask.data() + words - tail, tail, nullptr);
    EXPECT_EQ(last, std::vector<std::uint32_t>(tail, ~0U));

    emulation::settings().most_blocks = 1;  // tiles before the last one of the mask are garbage
    const internal::DeviceIds ids = internal::list_bits(mask.data(), words, nullptr);
    std::vector<std::uint64_t> listed(ids.count), expected(32 * tail);
    std::iota(expected.begin(), expected.end(), 32 * (words - tail));
    internal::download(listed.data(), ids.ids.data(), listed.size(), nullptr);
    EXPECT_EQ(listed, expected);
  }
  emulation::settings() = {};
}

}  // namespace emulated_layouts_test
}  // namespace cullhull::testing
