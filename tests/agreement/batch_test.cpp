// Many hulls in one call against one call each.
#include "cullhull/batch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "agreement/canonical_hash.hpp"
#include "agreement/point_sets.hpp"
#include "call_options.hpp"
#include "cullhull/error.hpp"
#include "made_sets.hpp"
#include "thrown.hpp"

namespace cullhull::batch_test {

using namespace testing_support;

struct Sets {
  std::vector<double> coordinates;
  std::vector<std::uint64_t> offsets{0};
  unsigned d;
  explicit Sets(unsigned dimension) : d(dimension) {}
  void add(const PointSet& s) {
    coordinates.insert(coordinates.end(), s.coordinates.begin(), s.coordinates.end());
    offsets.push_back(coordinates.size() / d);
  }
  PointView view() const { return PointView::row_major(coordinates.data(), offsets.back(), d); }
  PointView set(std::size_t i) const {
    return PointView::row_major(coordinates.data() + offsets[i] * d, offsets[i + 1] - offsets[i],
                                d);
  }
  std::size_t size() const { return offsets.size() - 1; }
};

Sets mixed(unsigned d) {
  Sets sets(d);
  PointSet nothing = named("nothing", d);
  for (unsigned i = 0; i < 100; ++i) {
    sets.add(random_set("gauss", 5 + i, d, i));
    sets.add(random_grid(20, d, 3, 0, i));
    sets.add(full_grid(d, 3, 0.5));
    if (d > 1) sets.add(flat(20, d - 1, d, 5, i));
    PointSet same = named("equal points", d);
    for (int j = 0; j < 4; ++j) same.add(std::vector<double>(d, i + 0.1));
    sets.add(same);
    if (i % 7 == 0) sets.add(nothing);
  }
  return sets;
}

TEST(Batch, equals_one_call_a_set_for_any_number_of_threads) {
  for (unsigned d = 1; d <= 4; ++d) {
    const Sets sets = mixed(d);
    for (const unsigned threads : {1U, 3U}) {
      const HullBatch batch = convex_hulls(sets.view(), sets.offsets, options_of(threads));
      ASSERT_EQ(batch.size(), sets.size());
      for (std::size_t i = 0; i < sets.size(); ++i)
        ASSERT_EQ(canonical_hash(batch.hull(i)), canonical_hash(convex_hull(sets.set(i))))
            << d << "D, set " << i;
    }
  }
}

TEST(Batch, any_scalar_and_layout) {
  constexpr std::uint64_t n = 4000;
  for (const unsigned d : {2U, 3U}) {
    std::vector<float> floats;
    std::vector<double> rows;
    std::vector<std::uint64_t> offsets{0};
    std::mt19937_64 g(d);
    for (std::uint64_t i = 0; i < n; ++i) {
      for (unsigned j = 0; j < d; ++j) {
        const double v = g() % 5 == 0 ? -0.0 : static_cast<double>(g() % 2001) / 1000 - 1;
        floats.push_back(static_cast<float>(v));
        rows.push_back(v);
      }
      if (g() % 40 == 0) offsets.push_back(i);
    }
    const std::vector<double> columns = transposed(rows, d);
    for (const PointView& view : {PointView::row_major(floats.data(), n, d),
                                  PointView::column_major(columns.data(), n, d)}) {
      const HullBatch batch = convex_hulls(view, offsets);
      for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
        PointView set = view;
        set.data += static_cast<std::ptrdiff_t>(offsets[i]) * view.point_stride;
        set.count = offsets[i + 1] - offsets[i];
        ASSERT_EQ(canonical_hash(batch.hull(i)), canonical_hash(convex_hull(set)))
            << d << "D, set " << i;
      }
    }
  }
}

/// Sets about as large as the batch's own engine takes, in and out of general position, of every
/// magnitude, and in other layouts.
TEST(Batch, small_sets_in_space_equal_one_call_each) {
  Sets sets(3);
  for (unsigned i = 0; i < 40; ++i)
    for (const char* shape : {"ball", "sphere", "cube", "gauss"}) {
      PointSet s = random_set(shape, i < 20 ? 4 + i : 110 + i, 3, i);
      sets.add(s);
      PointSet moved = s, again = s, thin = s, far = s;
      for (std::size_t j = 0; j < s.coordinates.size(); ++j) {
        moved.coordinates[j] = std::ldexp(s.coordinates[j], static_cast<int>(11 * i) - 200);
        far.coordinates[j] += 1e9 * static_cast<double>(i % 3);
        if (j % 3 == 2) thin.coordinates[j] *= 1e-13;
        if (j % 21 > 17) again.coordinates[j] = s.coordinates[j % 21 - 18];
      }
      for (const PointSet& other : {moved, again, thin, far}) sets.add(other);
    }
  const std::vector<double> columns = transposed(sets.coordinates, 3);
  std::vector<float> floats(sets.coordinates.begin(), sets.coordinates.end());
  for (float& v : floats)
    if (!std::isfinite(v)) v = 0;
  const std::uint64_t n = sets.offsets.back();
  const PointView views[] = {sets.view(), PointView::column_major(columns.data(), n, 3),
                             PointView::row_major(floats.data(), n, 3)};
  for (const PointView& view : views) {
    const HullBatch batch = convex_hulls(view, sets.offsets);
    for (std::size_t i = 0; i < sets.size(); ++i) {
      PointView one = view;
      one.count = sets.offsets[i + 1] - sets.offsets[i];
      one.data += static_cast<std::ptrdiff_t>(sets.offsets[i]) * view.point_stride;
      ASSERT_EQ(canonical_hash(batch.hull(i)), canonical_hash(convex_hull(one))) << "set " << i;
    }
  }
}

TEST(Batch, sets_may_leave_points_out_and_may_be_none) {
  const Sets sets = mixed(2);
  const std::uint64_t offsets[] = {7, 30, 30, 41};
  const HullBatch batch = convex_hulls(sets.view(), offsets);
  EXPECT_EQ(batch.hull(0).point_count, 23U);
  EXPECT_EQ(batch.hull(1).affine_dimension, -1);
  EXPECT_EQ(batch.vertices.size(), 3U);
  EXPECT_EQ(convex_hulls(sets.view(), std::span(offsets, 1)).size(), 0U);
  EXPECT_THROW(batch.hull(3), Error);
}

TEST(Batch, errors_name_the_first_bad_set) {
  Sets sets = mixed(3);
  sets.coordinates[(sets.offsets[300] + 2) * 3] = std::numeric_limits<double>::quiet_NaN();
  sets.coordinates[(sets.offsets[20] + 1) * 3] = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(has(error_of(ErrorCode::not_finite, [&] { convex_hulls(sets.view(), sets.offsets); }),
                  "set 20: point 1, coordinate 0"));
  const std::uint64_t descending[] = {5, 3}, beyond[] = {0, 1U << 30};
  EXPECT_THROW(convex_hulls(sets.view(), descending), Error);
  EXPECT_THROW(convex_hulls(sets.view(), beyond), Error);
  EXPECT_THROW(convex_hulls(sets.view(), std::span<const std::uint64_t>()), Error);
  const Options options = stopped();
  error_of(ErrorCode::cancelled, [&] { convex_hulls(sets.view(), sets.offsets, options); });
}

}  // namespace cullhull::batch_test
