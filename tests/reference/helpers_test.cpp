// Helpers that come late are not waited for; a forked process has its own.
#include "parallel/threads/helpers.hpp"

#include <gtest/gtest.h>
#if !defined(_WIN32)
#include <sys/wait.h>
#include <unistd.h>
#endif

#include <atomic>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

#include "parallel/threads/once.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal::helpers_test {

/// Work that keeps whoever joins it.
struct Blocking : SharedWork {
  std::atomic<unsigned> joined{0};
  std::atomic<bool> over{false};
  void join(unsigned) noexcept override {
    ++joined;
    while (!over) std::this_thread::yield();
  }
};

std::uint64_t sum_by_chunks(std::uint64_t count, unsigned threads) {
  std::vector<std::uint64_t> parts(chunk_count(count, 10));
  for_each_chunk(count, 10, threads, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) parts[c] += i;
  });
  return std::accumulate(parts.begin(), parts.end(), std::uint64_t{0});
}

TEST(Helpers, NobodyWaitsForThoseWhoDoNotCome) {
  const auto blocking = std::make_shared<Blocking>();
  const OpenWork open(machine_threads(), blocking);  // more than there are
  while (machine_threads() > 1 && blocking->joined + 1 < machine_threads())
    std::this_thread::yield();
  EXPECT_EQ(sum_by_chunks(1000, 8), 499'500U);
  blocking->over = true;
}

TEST(Helpers, LoopsWithinLoops) {
  std::atomic<std::uint64_t> sum{0};
  for_each_chunk(
      50, 1, 4, [&](std::uint64_t, std::uint64_t, std::uint64_t) { sum += sum_by_chunks(100, 4); });
  EXPECT_EQ(sum, 50U * 4950U);
}

TEST(Helpers, ManyCallersAtOnce) {
  std::vector<std::thread> callers;
  std::atomic<unsigned> right{0};
  for (unsigned t = 0; t < 8; ++t)
    callers.emplace_back([&] {
      const CallScope call;
      for (unsigned k = 0; k < 500; ++k) right += sum_by_chunks(200, 4) == 19'900U;
    });
  for (std::thread& t : callers) t.join();
  EXPECT_EQ(right, 4000U);
}

TEST(Helpers, AnExceptionEndsTheLoop) {
  for (unsigned k = 0; k < 200; ++k) {
    std::atomic<unsigned> begun{0};
    EXPECT_THROW(for_each_chunk(
                     1000, 1, 4,
                     [&](std::uint64_t c, std::uint64_t, std::uint64_t) {
      ++begun;
      if (c >= 3) throw std::runtime_error("three");
                     }),
                 std::runtime_error);
    EXPECT_LT(begun, 100U);
  }
}

TEST(Once, WhatThrewIsCalledAgain) {
  for (unsigned k = 0; k < 3; ++k) {  // flags at one address
    Once once;
    EXPECT_THROW(once.call([] { throw std::runtime_error("first"); }), std::runtime_error);
    std::atomic<unsigned> calls{0};
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < 4; ++t)
      threads.emplace_back([&] {
        once.call([&] { ++calls; });
        EXPECT_EQ(calls, 1U);
      });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(calls, 1U);
  }
}

#if !defined(_WIN32)
TEST(Helpers, AForkedProcessHasItsOwn) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "ThreadSanitizer ends a forked child that starts threads";
#endif
  EXPECT_EQ(sum_by_chunks(1000, 4), 499'500U);
  const pid_t child = ::fork();
  if (child == 0) {
    bool right = true;
    for (unsigned k = 0; k < 100; ++k) right = right && sum_by_chunks(1000, 4) == 499'500U;
    ::_exit(right ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}
#endif

}  // namespace cullhull::internal::helpers_test
