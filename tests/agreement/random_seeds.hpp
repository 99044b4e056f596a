// How many random sets a test runs, from which seed on: CULLHULL_RANDOM_RUNS, CULLHULL_RANDOM_SEED.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>

namespace cullhull::testing_support {

inline std::uint64_t number_from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

/// body(seed) for one seed after the other, until something fails.
template <class Body>
void for_random_seeds(std::uint64_t usual, const Body& body) {
  const std::uint64_t runs = number_from_environment("CULLHULL_RANDOM_RUNS", usual);
  const std::uint64_t first = number_from_environment("CULLHULL_RANDOM_SEED", 1);
  for (std::uint64_t seed = first; seed < first + runs; ++seed) {
    body(seed);
    if (::testing::Test::HasFailure()) return;
  }
}

}  // namespace cullhull::testing_support
