// Inner polytopes and sets that the tests of a CPU path and of its device twin both make.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "cullhull/generate.hpp"

namespace cullhull::internal {
struct InnerPolytope;
}  // namespace cullhull::internal

namespace cullhull::testing_support {

/// The cross polytope with half axes `radius`, around `centre`.
template <class Polytope = internal::InnerPolytope>
Polytope cross_polytope(unsigned d, double centre, double radius) {
  Polytope p;
  p.dimension = d;
  for (unsigned j = 0; j < 2 * d; ++j)
    for (unsigned k = 0; k < d; ++k)
      p.vertices.push_back(k != j / 2 ? centre : j % 2 ? centre - radius : centre + radius);
  for (unsigned s = 0; s < 1U << d; ++s) {
    for (unsigned j = 0; j < d; ++j) {
      p.facets.push_back(2 * j + (s >> j & 1));
      p.neighbours.push_back(s ^ (1U << j));
    }
  }
  return p;
}

/// Normally distributed; with a step, rounded to its multiples, so that ties and copies are many.
template <class T>
std::vector<T> normal_points(std::size_t n, unsigned d, std::uint64_t seed, double step) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<T> v(n * d);
  for (T& x : v) {
    const double value = normal(random);
    x = static_cast<T>(step > 0 ? std::round(value / step) : value);
  }
  return v;
}

/// What `cullhull generate` makes, as T.
template <class T>
std::vector<T> made(const char* shape, std::uint64_t n, unsigned d, std::uint64_t seed) {
  const std::vector<double> rows = generate(shape, n, d, seed);
  return {rows.begin(), rows.end()};
}

/// n points of the cube of half the side `reach` around `centre`.
template <class T = double>
std::vector<T> uniform_points(unsigned d, std::size_t n, double centre, double reach,
                              std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-reach, reach);
  std::vector<T> rows(n * d);
  for (T& v : rows) v = static_cast<T>(centre + unit(random));
  return rows;
}

/// Rows of d numbers as columns.
template <class T>
std::vector<T> transposed(const std::vector<T>& rows, unsigned d) {
  const std::size_t n = rows.size() / d;
  std::vector<T> out(rows.size());
  for (std::size_t i = 0; i < n; ++i)
    for (unsigned j = 0; j < d; ++j) out[j * n + i] = rows[i * d + j];
  return out;
}

/// Calls expect(rows, name) for sets of n points in space: in a plane, all equal, tiny, huge, not
/// finite.
template <class Expect>
void each_awkward_set(std::size_t n, const Expect& expect) {
  std::vector<double> flat = normal_points<double>(n, 3, 1, 0);
  for (std::size_t i = 0; i < n; ++i) flat[3 * i + 2] = flat[3 * i] + flat[3 * i + 1];
  expect(flat, "flat");
  expect(std::vector<double>(3 * n, 0.1), "equal");
  for (const double scale : {1e-322, 1e-300, 1e307}) {
    std::vector<double> v = normal_points<double>(n, 3, 2, 0);
    for (double& x : v) x *= scale;
    expect(v, std::to_string(scale));
  }
  for (const float scale : {1e-44F, 1e-38F, 1e37F}) {  // subnormal floats count, too
    std::vector<float> v = normal_points<float>(n, 3, 3, 0);
    for (float& x : v) x *= scale;
    expect(v, std::to_string(scale));
  }
  std::vector<float> bad = normal_points<float>(n, 3, 4, 0);
  for (std::size_t i = 7; i < bad.size(); i += 97)
    bad[i] = i % 2 != 0 ? NAN : std::numeric_limits<float>::infinity();
  expect(bad, "not finite");
}

/// All frames of `generate --motion`.
inline std::vector<std::vector<double>> moving_frames(const char* shape, const char* motion,
                                                      std::uint64_t n, unsigned d,
                                                      std::uint64_t frames) {
  const MovingPoints points(shape, motion, n, d, frames, 7);
  std::vector<std::vector<double>> all(frames, std::vector<double>(n * d));
  for (std::uint64_t f = 0; f < frames; ++f) points.frame(f, all[f].data());
  return all;
}

}  // namespace cullhull::testing_support
