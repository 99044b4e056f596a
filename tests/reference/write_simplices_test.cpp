// From 4D on the result made in canonical order is the one that the fallback gives, bit for bit,
// whatever of a simplex fits into its key, and a surface that is not a hull's is refused.
#include "result/write/write_simplices.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/generate.hpp"
#include "hull/engine.hpp"
#include "parallel/sort_few.hpp"
#include "result/facets/facet_keys.hpp"
#include "tests/reference/framed_points.hpp"

namespace cullhull::internal::write_simplices_test {

using Rows = std::vector<double>;

/// A frame and an engine's surface.
struct Case : FramedPoints {
  Case(const Rows& rows, unsigned d, unsigned threads = 1)
      : FramedPoints(rows, d),
        surface(hull_nd(frame.points(), frame.simplex().data(),
                        run.with_budget(std::uint64_t{1} << 40).with_threads(threads))) {
    sort_simplices(surface, frame.points(), run.with_threads(threads));
  }

  bool short_way(unsigned threads, unsigned key_bits, Hull& hull) const {
    VertexList vertices =
        list_vertices(surface, frame.points().count, nullptr, run.with_threads(threads));
    const Frame measures = make_frame(view, vertices.ids, frame.axes().data(), view.dimension,
                                      run.with_threads(threads));
    if (measures.wild || !write_simplices(input(), surface, vertices, measures,
                                          run.with_threads(threads), hull, key_bits))
      return false;
    hull.vertices = std::move(vertices.ids);
    return true;
  }

  Boundary surface;
};

/// Whether the short way can be gone; then its result is that of the general one.
bool same_both_ways(const Rows& rows, unsigned d) {
  Case general(rows, d);
  const std::uint64_t expected = general.the_general_way(std::move(general.surface));
  for (const unsigned threads : {1U, 2U, 5U})
    for (const unsigned key_bits : {128U, 70U, 40U}) {
      const Case c(rows, d, threads);
      Hull hull = c.empty_hull();
      if (!c.short_way(threads, key_bits, hull)) return false;
      EXPECT_EQ(testing_support::canonical_hash(hull), expected)
          << "threads " << threads << ", bits " << key_bits;
    }
  return true;
}

TEST(WriteSimplices, AsTheFallback) {
  const std::uint64_t most[] = {6000, 900, 250, 90, 40};
  for (unsigned d = 4; d <= 8; ++d)
    for (const char* shape : {"sphere", "ball", "gauss"})
      for (const std::uint64_t n : {std::uint64_t{d + 1}, std::uint64_t{d + 2}, most[d - 4]}) {
        SCOPED_TRACE(std::string(shape) + " " + std::to_string(n) + " in " + std::to_string(d));
        EXPECT_TRUE(same_both_ways(generate(shape, n, d), d));
      }
}

TEST(WriteSimplices, OtherFrames) {
  const Rows rows = generate("sphere", 1000, 4);
  const auto changed = [&](const std::function<double(double, unsigned)>& change) {
    Rows other = rows;
    for (std::size_t i = 0; i < rows.size(); ++i)
      other[i] = change(rows[i], static_cast<unsigned>(i % 4));
    return other;
  };
  EXPECT_TRUE(same_both_ways(changed([](double v, unsigned c) { return v + 3 * c; }), 4));
  EXPECT_TRUE(same_both_ways(changed([](double v, unsigned) { return v * 1e-300; }), 4));
  // Normals that need more bits.
  EXPECT_TRUE(
      same_both_ways(changed([](double v, unsigned c) { return c == 2 ? v * 1e-9 : v; }), 4));
}

TEST(WriteSimplices, EqualPoints) {
  Rows rows = generate("sphere", 2000, 5);
  for (std::size_t i = 0; i < 2000; i += 3)
    std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>(5 * ((7 * i + 1) % 2000)), 5,
                rows.begin() + static_cast<std::ptrdiff_t>(5 * i));
  EXPECT_TRUE(same_both_ways(rows, 5));
}

/// Facets that share a hyperplane need the fallback, however few they are: a sample is looked at
/// first, then all.
TEST(WriteSimplices, CoplanarFacetsAreSeen) {
  Rows rows = generate("sphere", 3000, 4);
  for (const double x : {-1.5, 1.5})
    for (const double y : {-1.5, 1.5})
      for (const double z : {-1.5, 1.5}) rows.insert(rows.end(), {x, y, z, 2});
  EXPECT_FALSE(same_both_ways(rows, 4));
  EXPECT_FALSE(same_both_ways(generate("grid:4", 200, 4), 4));
}

TEST(WriteSimplices, RefusesWhatIsNoHull) {
  const Rows rows = generate("sphere", 300, 5);
  const auto refused = [&](const std::function<void(Boundary&)>& spoil) {
    Case c(rows, 5);
    spoil(c.surface);
    Hull hull = c.empty_hull();
    try {
      c.short_way(1, 128, hull);
    } catch (const Error& e) {
      return e.code() == ErrorCode::not_exact;
    }
    return false;
  };
  // A facet that is not in the sample that is looked at first, nor beside one that is.
  constexpr std::uint32_t f = 14;
  constexpr std::size_t at = 5 * std::size_t{f};
  EXPECT_FALSE(refused([](Boundary&) {}));
  EXPECT_TRUE(refused([](Boundary& s) { s.odd[f] ^= 1; }));
  EXPECT_TRUE(refused([](Boundary& s) { std::swap(s.neighbours[at], s.neighbours[at + 1]); }));
  EXPECT_TRUE(refused([](Boundary& s) { s.neighbours[at + 1] = s.neighbours[at + 2]; }));
  EXPECT_TRUE(refused([](Boundary& s) { s.neighbours[at + 1] = f; }));
  EXPECT_TRUE(refused([](Boundary& s) { s.neighbours[at + 1] = 0xFFFFFFFF; }));
  EXPECT_TRUE(refused([](Boundary& s) { s.vertices[at + 1] = s.vertices[at]; }));
  EXPECT_TRUE(refused([](Boundary& s) {  // inside out
    for (std::uint8_t& odd : s.odd) odd ^= 1;
  }));
}

TEST(FacetKeys, HoldAsManyVerticesAsFit) {
  const std::uint32_t v[5] = {0x12345, 0x1FFFF, 0, 0x1FFFE, 0x15555};
  for (const unsigned bits : {128U, 90U, 60U, 41U}) {
    const FacetKeys<5> keys(1U << 17, 1U << 24, 6, bits);
    const FacetKey key = keys.key(v, 0xABCDEF);
    EXPECT_EQ(keys.complete(), bits == 128);
    EXPECT_EQ(keys.number(key), 0xABCDEFU);
    EXPECT_EQ(keys.first(key), 0x12345U & 63U);
    EXPECT_TRUE(keys.alike(key, keys.key(v, 7)));
    std::uint32_t next[5], last[5];
    std::copy_n(v, 5, next);
    std::copy_n(v, 5, last);
    ++next[0];
    --last[4];
    EXPECT_FALSE(keys.alike(key, keys.key(next, 0xABCDEF)));
    EXPECT_EQ(keys.alike(key, keys.key(last, 0xABCDEF)), bits != 128);
    EXPECT_EQ(keys.key(last, 0xABCDEF) < key, bits == 128);
    EXPECT_TRUE(key < keys.key(next, 0));
    if (!keys.complete()) continue;
    std::uint32_t out[5];
    keys.unpack(key, 0x12345 & ~63U, out);
    EXPECT_TRUE(std::equal(v, v + 5, out));
  }
}

template <unsigned n>
void every_permutation() {
  std::array<std::uint64_t, n> items;
  std::iota(items.begin(), items.end(), 0U);
  do {
    bool odd = false;
    for (unsigned i = 0; i < n; ++i)
      for (unsigned j = i + 1; j < n; ++j) odd ^= items[j] < items[i];
    std::array<std::uint64_t, n> sorted = items;
    ASSERT_EQ(sort_few<n>(sorted.data()), odd);
    ASSERT_TRUE(std::is_sorted(sorted.begin(), sorted.end()));
  } while (std::next_permutation(items.begin(), items.end()));
}

TEST(SortFew, SortsEveryPermutation) {
  every_permutation<2>();
  every_permutation<3>();
  every_permutation<4>();
  every_permutation<5>();
  every_permutation<6>();
  every_permutation<7>();
  every_permutation<8>();
}

}  // namespace cullhull::internal::write_simplices_test
