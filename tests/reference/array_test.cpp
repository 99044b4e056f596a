#include "cullhull/array.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "cullhull/hull.hpp"
#include "parallel/memory/pages.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/threads/thread_memory.hpp"
#include "sanitized.hpp"

namespace cullhull::array_test {

TEST(Array, GrowsAsAVectorDoes) {
  Array<std::uint64_t> a{7};
  for (std::uint64_t i = 1; i < 2'000'000; ++i) a.push_back(i);  // past the size of small blocks
  a.resize(3'000'000, 5);
  EXPECT_EQ(a[0], 7U);
  for (std::uint64_t i = 1; i < 2'000'000; ++i) ASSERT_EQ(a[i], i);
  EXPECT_EQ(a[2'000'000], 5U);
  EXPECT_EQ(a.back(), 5U);
  const Array<std::uint64_t> copy = a;
  EXPECT_EQ(copy, a);
  a = {};
  EXPECT_TRUE(a.empty());
}

TEST(Array, RefusesImpossibleSizes) {
  internal::ArrayAllocator<std::uint64_t> allocator;
  EXPECT_THROW(static_cast<void>(allocator.allocate(~std::size_t{0} / 4)), std::bad_alloc);
  EXPECT_THROW(static_cast<void>(allocator.allocate(~std::size_t{0} / 8)), std::bad_alloc);
}

/// Blocks in use never overlap, whatever was freed and split before.
TEST(Pages, BlocksInUseAreApart) {
  const internal::PageScope outer;
  constexpr std::size_t mega = std::size_t{1} << 20;
  const auto work = [](unsigned seed) {
    const internal::PageScope inner;
    std::vector<std::pair<unsigned char*, std::size_t>> live;
    const auto release = [&](std::size_t at) {
      const auto [p, bytes] = live[at];
      for (std::size_t i = 0; i < bytes; i += 4096) ASSERT_EQ(p[i], p[0]);
      ASSERT_EQ(p[bytes - 1], p[0]);
      internal::free_block(p, bytes);
      live.erase(live.begin() + static_cast<std::ptrdiff_t>(at));
    };
    for (unsigned i = 0; i < 60; ++i) {
      seed = seed * 1664525 + 1013904223;
      const std::size_t bytes = (3 + seed / 65536 % 10) * mega + seed % 4096;
      auto* p = static_cast<unsigned char*>(internal::allocate_block(bytes));
      for (std::size_t at = 0; at < bytes; at += 4096)
        p[at] = static_cast<unsigned char>(seed >> 8);
      p[bytes - 1] = p[0];
      live.emplace_back(p, bytes);
      if (live.size() > 6) release(seed / 7 % live.size());
    }
    while (!live.empty()) release(live.size() - 1);
  };
  std::thread other(work, 1);
  work(2);
  other.join();
}

TEST(Pages, KeepNothingFreesTheScratchOfSmallCalls) {
  const auto hull_of_parabola = [] {
    std::vector<double> xy;
    for (int i = 0; i < 50; ++i) xy.insert(xy.end(), {i - 25.0, i * (50.0 - i)});
    return convex_hull(PointView::row_major(xy.data(), 50, 2)).vertices.size();
  };
  ASSERT_EQ(hull_of_parabola(), 50U);
  EXPECT_GT(internal::thread_memories(), 0U);
  keep_memory(0);
  EXPECT_EQ(internal::thread_memories(), 0U);
  EXPECT_EQ(hull_of_parabola(), 50U);  // made anew
  EXPECT_EQ(internal::thread_memories(), 1U);
  keep_memory(std::size_t{1} << 30);
}

/// Sizes around each step from which on blocks are rounded up, kept, and mapped.
TEST(Pages, BlocksOfMiddleSizesAreKeptAlignedAndTheirOwn) {
  constexpr std::size_t most = std::size_t{16} << 20;
  keep_memory(0);
  keep_memory(std::size_t{1} << 30);
  std::vector<std::pair<std::uint8_t*, std::size_t>> live;
  for (std::size_t octave = internal::kept_block; octave < internal::mapped_block; octave *= 2)
    for (std::size_t quarter = 0; quarter < 4; ++quarter)
      for (const std::size_t bytes :
           {octave + quarter * octave / 4, octave + quarter * octave / 4 + 1,
            octave + (quarter + 1) * octave / 4 - 1}) {
        auto* p = static_cast<std::uint8_t*>(internal::allocate_block(bytes));
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(p) % 64, 0U);
        std::memset(p, static_cast<int>(live.size() % 251), bytes);
        live.emplace_back(p, bytes);
      }
  for (std::size_t i = 0; i < live.size(); ++i) {
    const auto [p, bytes] = live[i];
    for (const std::size_t at : {std::size_t{0}, bytes / 2, bytes - 1}) ASSERT_EQ(p[at], i % 251);
  }
  for (const auto& [p, bytes] : live) internal::free_block(p, bytes);
  EXPECT_GT(kept_memory(), most / 2);
  EXPECT_LE(kept_memory(), most);
  // What was freed last of a size comes first.
  void* again = internal::allocate_block(100'000);
  internal::free_block(again, 100'000);
  EXPECT_EQ(internal::allocate_block(99'000), again);
  internal::free_block(again, 99'000);
  keep_memory(std::size_t{1} << 20);
  EXPECT_LE(kept_memory(), std::size_t{1} << 20);
  keep_memory(0);
  EXPECT_EQ(kept_memory(), 0U);
  keep_memory(std::size_t{1} << 30);
}

#if defined(__linux__)
TEST(Pages, BetweenCallsNoMoreIsKeptThanTheLimit) {
  constexpr std::size_t mega = std::size_t{1} << 20;
  keep_memory(0);
  ASSERT_EQ(kept_memory(), 0U);
  {
    const internal::PageScope scope;
    { const internal::BigArray<std::uint8_t> block(20 * mega); }
    EXPECT_EQ(kept_memory(), 20 * mega);  // a call is at work: the limit waits for its end
    keep_memory(12 * mega);
    EXPECT_EQ(kept_memory(), 20 * mega);
  }
  EXPECT_EQ(kept_memory(), 12 * mega);
  {
    // Freed outside of calls, as results are: kept while the limit allows.
    const internal::BigArray<std::uint8_t> from_kept(8 * mega), fresh(30 * mega);
    EXPECT_EQ(kept_memory(), 4 * mega);
  }
  EXPECT_EQ(kept_memory(), 12 * mega);
  keep_memory(6 * mega);
  EXPECT_EQ(kept_memory(), 6 * mega);
  keep_memory(0);
  EXPECT_EQ(kept_memory(), 0U);
  keep_memory(std::size_t{1} << 30);
}

/// Bytes of this process that the system cannot take back without storing them.
std::size_t held_bytes() {
  std::ifstream in("/proc/self/smaps_rollup");
  std::map<std::string, std::size_t> kilobytes;
  for (std::string line, name; std::getline(in, line);) {
    std::istringstream words(line);
    std::size_t number = 0;
    if (words >> name >> number) kilobytes[name] = number;
  }
  return (kilobytes["Anonymous:"] - kilobytes["LazyFree:"]) << 10;
}

/// The end of a call offers what the call wrote, wherever it lies among memory offered before.
TEST(Pages, TheSystemMayReclaimAllThatIsKept) {
  constexpr std::size_t mega = std::size_t{1} << 20;
  const auto filled = [](std::size_t bytes) {
    Array<std::uint8_t> block(bytes);
    std::fill(block.begin(), block.end(), std::uint8_t{1});
    return block;
  };
  if (testing::sanitized || held_bytes() == 0)
    GTEST_SKIP() << "the system does not tell, or a sanitizer holds memory of its own";
  keep_memory(0);
  const std::size_t before = held_bytes();
  keep_memory(std::size_t{1} << 30);
  std::uint32_t seed = 1;
  const auto next = [&seed](std::uint32_t below) {
    seed = seed * 1664525 + 1013904223;
    return (seed >> 16) % below;
  };
  for (unsigned call = 0; call < 20; ++call) {
    {
      const internal::PageScope scope;
      std::vector<Array<std::uint8_t>> blocks;
      for (unsigned i = 0; i < 6; ++i)
        blocks.push_back(filled((call == 0 ? 16 : 2 * (1 + next(6))) * mega));
      EXPECT_GE(held_bytes(), before + 6 * 2 * mega);
      while (!blocks.empty()) blocks.erase(blocks.begin() + next(6) % blocks.size());
    }
    EXPECT_GE(kept_memory(), 96 * mega);
    EXPECT_LE(held_bytes(), before + mega) << "after call " << call;
  }
  keep_memory(0);
  keep_memory(std::size_t{1} << 30);
}

/// Contents move along, whether memory is new or kept, aligned or not.
TEST(Pages, RawArraysKeepTheirContentsAsTheyGrow) {
  for (const std::size_t limit : {std::size_t{0}, std::size_t{1} << 30}) {
    keep_memory(limit);
    const internal::PageScope scope;
    for (unsigned round = 0; round < 3; ++round) {
      internal::RawArray<std::uint32_t> a, between;
      std::size_t filled = 0;
      for (std::size_t n = 1000; n < 20'000'000; n = n * 7 / 3 + round) {
        a.reserve(n);
        ASSERT_GE(a.capacity(), n);
        for (std::size_t i = 0; i < filled; i += 997) ASSERT_EQ(a[i], i ^ round);
        for (; filled < n; ++filled) a[filled] = static_cast<std::uint32_t>(filled ^ round);
        between.reserve(n / 2);
        between[n / 2 - 1] = 0;
      }
      a.release();
      EXPECT_EQ(a.capacity(), 0U);
    }
  }
}
#endif

TEST(Pages, FreedPagesServeAgainWithinAScopeOnly) {
  constexpr std::size_t bytes = std::size_t{8} << 20;
  const internal::PageScope scope;
  internal::BigArray<std::uint32_t> first(bytes / 4);
  const void* const place = first.get();
  first = {};
  const internal::BigArray<std::uint32_t> second(bytes / 4);
#if defined(__linux__)
  EXPECT_EQ(static_cast<const void*>(second.get()), place);
#else
  EXPECT_NE(second.get(), nullptr);
  static_cast<void>(place);
#endif
}

}  // namespace cullhull::array_test
