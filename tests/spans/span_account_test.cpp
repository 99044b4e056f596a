// The account of spans, compiled for these tests whatever the build's option says. No time is held
// against a limit: what is tested is what the account says of loops whose times are its own.
#include "parallel/threads/span_account.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace span_account_test {

using namespace cullhull::internal;

/// Work that takes some time that the clock sees.
void spin() {
  volatile unsigned sum = 0;
  for (unsigned i = 0; i < 20000; ++i) sum = sum + i;
}

const SpanStretch* stretch_like(const SpanAccount& account, const std::string& part) {
  for (const SpanStretch& s : account.stretches)
    if (s.name.find(part) != std::string::npos) return &s;
  return nullptr;
}

TEST(SpanAccount, NothingCountsWithoutOne) {
  EXPECT_FALSE(counting_spans());
  EXPECT_FALSE(counts_loop());
}

TEST(SpanAccount, ALoopRunsInOrderAndIsDividedAmongWorkers) {
  std::vector<std::uint64_t> order;
  const SpanAccount account = account_of_spans(4, [&] {
    EXPECT_TRUE(counts_loop());
    run_counted_loop(64, 4, CodePlace::current(), [&](std::uint64_t i) {
      EXPECT_TRUE(counting_spans());
      EXPECT_FALSE(counts_loop());  // a loop within it is part of the chunk
      order.push_back(i);
      spin();
    });
  });
  EXPECT_FALSE(counting_spans());
  ASSERT_EQ(order.size(), 64U);
  for (std::uint64_t i = 0; i < 64; ++i) EXPECT_EQ(order[i], i);
  const SpanStretch* loop = stretch_like(account, "span_account_test.cpp");
  ASSERT_NE(loop, nullptr);
  EXPECT_EQ(loop->calls, 1U);
  EXPECT_EQ(loop->chunks, 64U);
  EXPECT_FALSE(loop->serial);
  EXPECT_GE(4 * loop->span, loop->work);  // never less than a quarter
  EXPECT_LE(loop->longest, loop->span);
  EXPECT_LT(account.predicted, account.work);
  EXPECT_NEAR(account.predicted, account.serial + loop->span, 1e-9);
}

TEST(SpanAccount, OneThreadsWorkIsNamedByTheLoopsAroundIt) {
  const SpanAccount account = account_of_spans(16, [&] {
    spin();
    for (int i = 0; i < 3; ++i)
      run_counted_loop(2, 16, CodePlace::current(), [](std::uint64_t) { spin(); });
    spin();
  });
  const SpanStretch* first = stretch_like(account, "from begin to ");
  const SpanStretch* last = stretch_like(account, " to end");
  ASSERT_NE(first, nullptr);
  ASSERT_NE(last, nullptr);
  EXPECT_TRUE(first->serial && last->serial);
  EXPECT_EQ(first->work, first->span);
  EXPECT_GE(account.serial, first->span + last->span);
  EXPECT_EQ(account.stretches.size(), 4U);  // these, the loop, and from loop to loop
}

TEST(SpanAccount, ALockThatIsHeldAllTheTimeLeavesNothingToDivide) {
  const int lock = 0;
  const auto account_with = [&](bool locked) {
    return account_of_spans(8, [&] {
      run_counted_loop(32, 8, CodePlace::current(), [&](std::uint64_t) {
        if (!locked) return spin();
        const LockSpan held(&lock);
        spin();
      });
    });
  };
  const auto span_share = [](const SpanAccount& account) {
    const SpanStretch* loop = stretch_like(account, "span_account_test.cpp");
    return loop == nullptr ? 0 : loop->span / loop->work;
  };
  EXPECT_GT(span_share(account_with(true)), 2 * span_share(account_with(false)));
}

TEST(SpanAccount, AnExceptionEndsTheLoop) {
  EXPECT_THROW(account_of_spans(
                   2,
                   [] {
    run_counted_loop(4, 2, CodePlace::current(), [](std::uint64_t i) {
      if (i == 2) throw std::runtime_error("stop");
    });
                   }),
               std::runtime_error);
  EXPECT_FALSE(counting_spans());
  const SpanAccount next = account_of_spans(2, [] { EXPECT_TRUE(counts_loop()); });
  EXPECT_EQ(next.stretches.size(), 1U);
}

}  // namespace span_account_test
