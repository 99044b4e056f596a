// Sets of points for batches on a device, and what is expected of them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "cuda/set_hulls.hpp"
#include "cullhull/cullhull.hpp"
#include "parallel/threads/parallel.hpp"
#include "tests/gpu/device.hpp"

namespace cullhull::testing {

template <class T>
struct Sets {
  explicit Sets(unsigned dimension) : d(dimension) {}

  std::size_t count() const { return offsets.size() - 1; }
  void end_set() { offsets.push_back(rows.size() / d); }
  void add_ball(std::size_t n, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> unit;
    for (std::size_t i = 0; i < n; ++i) {
      double x[8], square = 0;
      for (unsigned j = 0; j < d; ++j) x[j] = normal(random), square += x[j] * x[j];
      const double scale = std::pow(unit(random), 1.0 / d) / std::sqrt(square);
      for (unsigned j = 0; j < d; ++j) rows.push_back(static_cast<T>(x[j] * scale));
    }
    end_set();
  }
  void add_lattice(std::size_t n, unsigned side, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (std::size_t i = 0; i < n * d; ++i) rows.push_back(static_cast<T>(random() % side));
    end_set();
  }
  /// On a sphere around `middle` (of every axis), within `cap` of the last axis's pole: 2 is the
  /// whole sphere. Rounding moves points off it, and at a far middle gives some the same place.
  void add_sphere(std::size_t n, std::uint64_t seed, double cap = 2, double middle = 0) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> height(1 - cap, 1);
    for (std::size_t i = 0; i < n; ++i) {
      double x[8], square = 0;
      for (unsigned j = 0; j + 1 < d; ++j) x[j] = normal(random), square += x[j] * x[j];
      const double h = height(random), scale = std::sqrt((1 - h * h) / square);
      for (unsigned j = 0; j + 1 < d; ++j) x[j] *= scale;
      x[d - 1] = h;
      for (unsigned j = 0; j < d; ++j) rows.push_back(static_cast<T>(middle + x[j]));
    }
    end_set();
  }
  /// Of the last `n` points every fifth loses a coordinate: it becomes -0, or at times +0.
  void zero_last(std::size_t n) {
    for (std::size_t i = rows.size() / d - n, k = 0; i < rows.size() / d; ++i, ++k)
      if (k % 5 == 0) rows[i * d + k / 5 % d] = k % 3 == 0 ? T(0) : -T(0);
  }
  /// Copies of the last `n` points join their set.
  void repeat_last_points(std::size_t n) {
    for (std::size_t i = 0; i < n * d; ++i) rows.push_back(rows[rows.size() - n * d]);
    offsets.back() = rows.size() / d;
  }
  /// Coordinate j of the last `n` points times a number.
  void stretch_last(std::size_t n, unsigned j, double by) {
    for (std::size_t i = rows.size() / d - n; i < rows.size() / d; ++i)
      rows[i * d + j] = static_cast<T>(rows[i * d + j] * by);
  }

  /// The last `n` points come so near to a plane across all axes.
  void flatten_last(std::size_t n, double by) {
    for (std::size_t i = rows.size() / d - n; i < rows.size() / d; ++i) {
      double sum = rows[i * d + d - 1] * by;
      for (unsigned j = 0; j + 1 < d; ++j) sum -= rows[i * d + j];
      rows[i * d + d - 1] = static_cast<T>(sum);
    }
  }

  unsigned d;
  std::vector<T> rows;
  std::vector<std::uint64_t> offsets{0};
};

/// Of the same length and bits.
template <class A>
void expect_same_bits(const A& a, const A& b, const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  using T = typename A::value_type;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const T x = a[i], y = b[i];
    ASSERT_EQ(std::memcmp(&x, &y, sizeof(T)), 0) << what << ", item " << i << ": " << x << " " << y;
  }
}

inline void expect_same(const HullBatch& a, const HullBatch& b) {
  EXPECT_EQ(a.dimension, b.dimension);
  EXPECT_EQ(a.scalar, b.scalar);
  expect_same_bits(a.point_counts, b.point_counts, "point counts");
  expect_same_bits(a.affine_dimensions, b.affine_dimensions, "affine dimensions");
  expect_same_bits(a.volumes, b.volumes, "volumes");
  expect_same_bits(a.areas, b.areas, "areas");
  expect_same_bits(a.centroids, b.centroids, "centroids");
  expect_same_bits(a.vertices.offsets, b.vertices.offsets, "offsets of vertices");
  expect_same_bits(a.vertices.items, b.vertices.items, "vertices");
  expect_same_bits(a.facet_starts, b.facet_starts, "facets");
  expect_same_bits(a.facets.offsets, b.facets.offsets, "offsets of facets");
  expect_same_bits(a.facets.items, b.facets.items, "facets");
  expect_same_bits(a.facet_neighbours.offsets, b.facet_neighbours.offsets, "neighbours");
  expect_same_bits(a.facet_neighbours.items, b.facet_neighbours.items, "neighbours");
  expect_same_bits(a.facet_planes, b.facet_planes, "planes");
  expect_same_bits(a.simplices.offsets, b.simplices.offsets, "offsets of simplices");
  expect_same_bits(a.simplices.items, b.simplices.items, "simplices");
  expect_same_bits(a.simplex_neighbours.items, b.simplex_neighbours.items, "neighbours");
  expect_same_bits(a.simplex_facets.items, b.simplex_facets.items, "facets of simplices");
}

/// A copy of an array of the device.
template <class T>
std::vector<T> fetched(const T* there, std::uint64_t count) {
  std::vector<T> here(count);
  check(cudaMemcpy(here.data(), there, count * sizeof(T), cudaMemcpyDeviceToHost));
  return here;
}

/// The lists of all sets end to end, or each filled up to a row of `width` items.
template <class T>
struct Rows {
  std::vector<T> items;
  std::vector<std::int64_t> offsets{0};
  std::vector<std::int32_t> counts;

  void end_list(std::uint64_t width, std::size_t item, T filler) {
    const std::size_t begin = width * item * counts.size();
    const std::size_t length = items.size() - (width != 0 ? begin : offsets.back() * item);
    if (width != 0) items.resize(begin + width * item, filler);
    counts.push_back(static_cast<std::int32_t>(length / item));
    offsets.push_back(offsets.back() + counts.back());
  }
};

/// What is in the device's memory is what the CPU's batch has, bit for bit.
inline void expect_same_lists(const DeviceHullBatch& there, const HullBatch& b) {
  ASSERT_EQ(there.dimension, b.dimension);
  ASSERT_EQ(there.sets, b.size());
  const std::size_t d = b.dimension;
  const bool padded = there.vertex_offsets == nullptr;
  Rows<std::int32_t> vertices, simplices;
  Rows<double> planes;
  for (std::size_t i = 0; i < b.size(); ++i) {
    for (const std::uint64_t id : b.vertices[i])
      vertices.items.push_back(static_cast<std::int32_t>(id));
    if (b.affine_dimensions[i] == static_cast<std::int32_t>(d)) {
      for (const std::uint64_t id : b.simplices[i])
        simplices.items.push_back(static_cast<std::int32_t>(id));
      for (const std::uint32_t f : b.simplex_facets[i])
        for (std::size_t c = 0; c <= d; ++c)
          planes.items.push_back(b.facet_planes[(b.facet_starts[i] + f) * (d + 1) + c]);
    }
    vertices.end_list(there.vertex_width, 1, -1);
    simplices.end_list(there.simplex_width, d, -1);
    planes.end_list(there.simplex_width, d + 1, 0);
  }
  EXPECT_EQ(there.vertex_count, static_cast<std::uint64_t>(vertices.offsets.back()));
  EXPECT_EQ(there.simplex_count, static_cast<std::uint64_t>(simplices.offsets.back()));
  const auto same = [](const auto* found, const auto& expected, const char* what) {
    if (!expected.empty()) expect_same_bits(fetched(found, expected.size()), expected, what);
  };
  if (padded) {
    same(there.vertex_counts, vertices.counts, "numbers of vertices");
    same(there.simplex_counts, simplices.counts, "numbers of simplices");
  } else {
    same(there.vertex_offsets, vertices.offsets, "offsets");
    same(there.simplex_offsets, simplices.offsets, "offsets");
  }
  same(there.vertices, vertices.items, "vertices");
  same(there.simplices, simplices.items, "simplices");
  same(there.affine_dimensions, b.affine_dimensions, "affine dimensions");
  if (there.planes != nullptr) same(there.planes, planes.items, "planes");
  if (there.volumes == nullptr) return;
  same(there.volumes, b.volumes, "volumes");
  same(there.areas, b.areas, "areas");
  same(there.centroids, b.centroids, "centroids");
}

}  // namespace cullhull::testing
