// What the tests on the emulated device share: balls of points, their memory on a device, plain
// results to hold against.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/cullhull.hpp"
#include "tests/agreement/canonical_hash.hpp"
#include "tests/gpu/device.hpp"
#include "tests/made_sets.hpp"

namespace cullhull::testing {

template <class T = float>
std::vector<T> ball(unsigned d, std::size_t n, std::uint64_t seed) {
  return testing_support::made<T>("ball", n, d, seed);
}

/// Of the CPU, without a filter.
template <class T>
std::uint64_t plain_hash(const std::vector<T>& rows, unsigned d) {
  Options options;
  options.cull = CullMethod::none;
  options.backend = Backend::cpu;
  return testing_support::canonical_hash(
      convex_hull(PointView::row_major(rows.data(), rows.size() / d, d), options));
}

inline Options on_device(CullMethod method = CullMethod::gauge) {
  Options options;
  options.backend = Backend::cuda;
  options.cull = method;
  return options;
}

}  // namespace cullhull::testing
