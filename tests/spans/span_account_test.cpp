// The account of spans, compiled for these tests whatever the build's option says. No time is held
// against a limit: what is tested is what the account says of loops whose times are its own.
#include "parallel/threads/span_account.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace span_account_test {

namespace spans = cullhull::internal::spans;

/// Work that takes some time that the clock sees.
void spin() {
  volatile unsigned sum = 0;
  for (unsigned i = 0; i < 20000; ++i) sum = sum + i;
}

const spans::Stretch* stretch_like(const spans::Account& account, const std::string& part) {
  for (const spans::Stretch& s : account.stretches)
    if (s.name.find(part) != std::string::npos) return &s;
  return nullptr;
}

TEST(SpanAccount, NothingCountsWithoutOne) {
  EXPECT_FALSE(spans::counting());
  EXPECT_FALSE(spans::counts());
}

TEST(SpanAccount, ALoopRunsInOrderAndIsDividedAmongWorkers) {
  std::vector<std::uint64_t> order;
  const spans::Account account = spans::account_of(4, [&] {
    EXPECT_TRUE(spans::counts());
    spans::run_counted(64, 4, spans::Where::current(), [&](std::uint64_t i) {
      EXPECT_TRUE(spans::counting());
      EXPECT_FALSE(spans::counts());  // a loop within it is part of the chunk
      order.push_back(i);
      spin();
    });
  });
  EXPECT_FALSE(spans::counting());
  ASSERT_EQ(order.size(), 64U);
  for (std::uint64_t i = 0; i < 64; ++i) EXPECT_EQ(order[i], i);
  const spans::Stretch* loop = stretch_like(account, "span_account_test.cpp");
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
  const spans::Account account = spans::account_of(16, [&] {
    spin();
    for (int i = 0; i < 3; ++i)
      spans::run_counted(2, 16, spans::Where::current(), [](std::uint64_t) { spin(); });
    spin();
  });
  const spans::Stretch* first = stretch_like(account, "from begin to ");
  const spans::Stretch* last = stretch_like(account, " to end");
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
    return spans::account_of(8, [&] {
      spans::run_counted(32, 8, spans::Where::current(), [&](std::uint64_t) {
        if (!locked) return spin();
        const spans::Locked held(&lock);
        spin();
      });
    });
  };
  const auto span_share = [](const spans::Account& account) {
    const spans::Stretch* loop = stretch_like(account, "span_account_test.cpp");
    return loop == nullptr ? 0 : loop->span / loop->work;
  };
  EXPECT_GT(span_share(account_with(true)), 2 * span_share(account_with(false)));
}

TEST(SpanAccount, AnExceptionEndsTheLoop) {
  EXPECT_THROW(spans::account_of(
                   2,
                   [] {
    spans::run_counted(4, 2, spans::Where::current(), [](std::uint64_t i) {
      if (i == 2) throw std::runtime_error("stop");
    });
                   }),
               std::runtime_error);
  EXPECT_FALSE(spans::counting());
  const spans::Account next = spans::account_of(2, [] { EXPECT_TRUE(spans::counts()); });
  EXPECT_EQ(next.stretches.size(), 1U);
}

}  // namespace span_account_test
