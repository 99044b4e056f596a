// How many random sets a test runs, and from which seed on: CULLHULL_RANDOM_RUNS,
// CULLHULL_RANDOM_SEED, and for all tests at once CULLHULL_TEST_SHARE, with which `make test` asks
// for a tenth (0.1). The tests that follow it are in tests/sampled.txt.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <utility>

namespace cullhull::testing_support {

inline std::uint64_t number_from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

/// Above 0 and at most 1.
inline double test_share() {
  const char* text = std::getenv("CULLHULL_TEST_SHARE");
  const double share = text == nullptr ? 1 : std::strtod(text, nullptr);
  return share > 0 && share < 1 ? share : 1;
}

/// That share of as many sets as a test usually runs, at least one.
inline std::uint64_t share_of(std::uint64_t usual) {
  const double share = std::round(static_cast<double>(usual) * test_share());
  return std::max<std::uint64_t>(static_cast<std::uint64_t>(share), 1);
}

/// That share of the sets: the first, and others at even distances.
template <class Sets>
Sets sampled(Sets all) {
  const std::size_t kept = all.empty() ? 0 : share_of(all.size());
  Sets some;
  for (std::size_t i = 0; i < kept; ++i) some.push_back(std::move(all[i * all.size() / kept]));
  return some;
}

/// body(seed) for one seed after the other, until something fails.
template <class Body>
void for_random_seeds(std::uint64_t usual, const Body& body) {
  const std::uint64_t runs = number_from_environment("CULLHULL_RANDOM_RUNS", share_of(usual));
  const std::uint64_t first = number_from_environment("CULLHULL_RANDOM_SEED", 1);
  for (std::uint64_t seed = first; seed < first + runs; ++seed) {
    body(seed);
    if (::testing::Test::HasFailure()) return;
  }
}

}  // namespace cullhull::testing_support
