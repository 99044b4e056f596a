// Short parallel phases: every item once, lanes apart, exceptions through.
#include "parallel/threads/crew.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace cullhull::internal::crew_test {

TEST(Crew, EveryItemOncePerPhase) {
  for (const unsigned threads : {1U, 2U, 3U, 8U}) {
    Crew crew(threads);
    std::vector<std::uint32_t> hits(1000, 0);
    std::vector<std::atomic<int>> busy(crew.lanes());
    crew.session([&] {
      for (std::uint32_t phase = 0; phase < 2000; ++phase)
        crew.run(phase % 7 * 20, [&](std::uint32_t item, unsigned lane) {
          EXPECT_EQ(busy[lane].fetch_add(1), 0);
          ++hits[item];
          busy[lane].fetch_sub(1);
        });
    });
    for (std::uint32_t i = 0; i < 1000; ++i) {
      std::uint32_t expected = 0;
      for (std::uint32_t phase = 0; phase < 2000; ++phase) expected += i < phase % 7 * 20;
      EXPECT_EQ(hits[i], expected) << "item " << i;
    }
  }
}

TEST(Crew, ExceptionsPassThrough) {
  for (const unsigned threads : {1U, 2U, 4U}) {
    Crew crew(threads);
    EXPECT_THROW(crew.session([&] {
      crew.run(10, [](std::uint32_t item, unsigned) {
        if (item == 7) throw std::runtime_error("seven");
      });
    }),
                 std::runtime_error);
    EXPECT_THROW(crew.session([] { throw std::logic_error("main"); }), std::logic_error);
    int sum = 0;  // and the crew can be used again
    crew.session([&] { crew.run(1, [&](std::uint32_t, unsigned) { ++sum; }); });
    EXPECT_EQ(sum, 1);
  }
}

}  // namespace cullhull::internal::crew_test
