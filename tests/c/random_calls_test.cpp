#include "random_calls.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

namespace random_calls_test {

/// CULLHULL_CALL_ROUNDS: how often some 100 calls are made.
std::size_t rounds() {
  const char* given = std::getenv("CULLHULL_CALL_ROUNDS");
  return given == nullptr ? 100 : std::strtoul(given, nullptr, 10);
}

TEST(RandomCalls, GiveAStatusAndALineAndNothingElse) {
  const std::size_t runs = rounds();
  std::size_t made = 0, failed = 0;
  std::mt19937_64 random(20261130);
  std::vector<std::uint8_t> bytes(8192);
  for (std::size_t i = 0; i < runs; ++i) {
    for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random());
    random_calls::Calls calls(bytes.data(), bytes.size());
    made += calls.run(1000);
    failed += calls.failures();
  }
  std::printf("%zu calls, %zu refused\n", made, failed);
  // Both kinds are many, or the calls test nothing.
  EXPECT_GT(made, 20 * runs);
  EXPECT_GT(failed, made / 20);
  EXPECT_LT(failed, made * 9 / 10);
}

}  // namespace random_calls_test
