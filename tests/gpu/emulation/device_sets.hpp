// What the tests on the emulated device share: balls of points, their memory on a device, plain
// results to hold against.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "cullhull/cullhull.hpp"
#include "tests/agreement/canonical_hash.hpp"
#include "tests/gpu/device.hpp"

namespace cullhull::testing {

template <class T = float>
std::vector<T> ball(unsigned d, std::size_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit;
  std::vector<T> rows(n * d);
  std::vector<double> x(d);
  for (std::size_t i = 0; i < n; ++i) {
    double square = 0;
    for (double& v : x) v = normal(random), square += v * v;
    const double scale = std::pow(unit(random), 1.0 / d) / std::sqrt(square);
    for (unsigned j = 0; j < d; ++j) rows[i * d + j] = static_cast<T>(x[j] * scale);
  }
  return rows;
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
