// Point sets with known traps. All are functions of their arguments alone.
#pragma once

#include <cmath>
#include <random>

#include "cullhull/generate.hpp"
#include "oracles.hpp"

namespace cullhull::testing_support {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// In [0, 1).
  double unit() { return std::ldexp(static_cast<double>(engine_() >> 11), -53); }
  double between(double a, double b) { return a + (b - a) * unit(); }
  int integer(int low, int high) {
    return low + static_cast<int>(engine_() % static_cast<std::uint64_t>(high - low + 1));
  }
  double normal() {
    return std::sqrt(-2 * std::log(1 - unit())) * std::cos(6.283185307179586 * unit());
  }

 private:
  std::mt19937_64 engine_;
};

inline PointSet named(std::string name, unsigned d) {
  PointSet s;
  s.name = std::move(name) + " " + std::to_string(d) + "D";
  s.dimension = d;
  return s;
}

/// "ball", "cube", "octahedron", "gauss" or "sphere": general position, all but surely.
inline PointSet random_set(const std::string& shape, unsigned n, unsigned d, std::uint64_t seed) {
  PointSet s = named(shape + " seed " + std::to_string(seed), d);
  Random r(seed);
  std::vector<double> p(d);
  for (unsigned i = 0; i < n; ++i) {
    double two = 0, one = 0;
    for (double& v : p) {
      v = shape == "cube" ? r.between(-1, 1) : r.normal();
      two += v * v;
    }
    double factor = 1;
    if (shape == "sphere") factor = 1 / std::sqrt(two);
    if (shape == "ball") factor = std::pow(r.unit(), 1.0 / d) / std::sqrt(two);
    if (shape == "octahedron") {
      // Exponential variables, one of them left out, are uniform in the simplex; signs unfold it.
      one = -std::log(1 - r.unit());
      for (double& v : p) {
        v = std::copysign(-std::log(1 - r.unit()), v);
        one += std::fabs(v);
      }
      factor = 1 / one;
    }
    for (double& v : p) v *= factor;
    s.add(p);
  }
  return s;
}

/// What `cullhull generate` makes.
inline PointSet generated(const char* shape, std::uint64_t n, unsigned d, std::uint64_t seed = 1) {
  PointSet s = named(shape, d);
  s.coordinates = generate(shape, n, d, seed);
  return s;
}

/// As `two-circles` of the benchmarks: facets are as long as the body and as narrow as neighbours
/// are near. `generate` rounds, so that some points of a circle are not extreme.
inline PointSet two_circles(std::uint64_t n, std::uint64_t seed) {
  PointSet s = named("two circles of " + std::to_string(n), 3);
  const std::vector<double> circle = generate("sphere", n, 2, seed);
  for (std::size_t i = 0; i < n; ++i)
    s.add({circle[2 * i], circle[2 * i + 1], i % 2 == 0 ? -1.0 : 1.0});
  return s;
}

/// About two axes; rounding makes faces that were flat nearly so.
inline PointSet turned(PointSet s) {
  s.name = "turned " + s.name;
  for (std::size_t i = 0; i < s.coordinates.size(); i += 3) {
    double* p = s.coordinates.data() + i;
    const double x = 0.8 * p[0] - 0.6 * p[1], y = 0.6 * p[0] + 0.8 * p[1], z = p[2];
    p[0] = x;
    p[1] = y * 5 / 13 - z * 12 / 13;
    p[2] = y * 12 / 13 + z * 5 / 13;
  }
  return s;
}

/// Integer points of {0 .. side-1}^d, each coordinate plus `shift`.
inline PointSet random_grid(unsigned n, unsigned d, int side, double shift, std::uint64_t seed) {
  PointSet s = named("grid " + std::to_string(side) + (shift != 0 ? " shifted" : ""), d);
  Random r(seed);
  for (unsigned i = 0; i < n * d; ++i) s.coordinates.push_back(shift + r.integer(0, side - 1));
  return s;
}

/// All points of the grid; the hull is its corners.
inline PointSet full_grid(unsigned d, unsigned side, double shift) {
  PointSet s = named("full grid " + std::to_string(side) + (shift != 0 ? " shifted" : ""), d);
  std::uint64_t n = 1;
  for (unsigned j = 0; j < d; ++j) n *= side;
  for (std::uint64_t i = 0; i < n; ++i)
    for (std::uint64_t j = 0, rest = i; j < d; ++j, rest /= side)
      s.coordinates.push_back(shift + static_cast<double>(rest % side));
  return s;
}

inline Ids full_grid_corners(unsigned d, unsigned side) {
  Ids ids;
  for (std::uint64_t corner = 0; corner < (1ULL << d); ++corner) {
    std::uint64_t id = 0, stride = 1;
    for (unsigned j = 0; j < d; ++j, stride *= side)
      if (corner >> j & 1) id += stride * (side - 1);
    ids.push_back(id);
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

/// The centre and the centres of facets, then the corners of [-1, 1]^d.
inline PointSet cube_with_centres(unsigned d) {
  PointSet s = named("cube with centres", d);
  s.add(std::vector<double>(d, 0.0));
  for (unsigned j = 0; j < d; ++j)
    for (double sign : {-1.0, 1.0}) {
      std::vector<double> p(d, 0.0);
      p[j] = sign;
      s.add(p);
    }
  for (unsigned i = 0; i < 1U << d; ++i) {
    std::vector<double> p(d);
    for (unsigned j = 0; j < d; ++j) p[j] = i >> j & 1 ? 1 : -1;
    s.add(p);
  }
  return s;
}

/// The middles of all edges, then the corners of the cross-polytope |x_1| + ... + |x_d| <= 2.
inline PointSet cross_polytope_with_middles(unsigned d) {
  PointSet s = named("cross-polytope with edge middles", d);
  for (unsigned i = 0; i < d; ++i)
    for (unsigned j = i + 1; j < d; ++j)
      for (int k = 0; k < 4; ++k) {
        std::vector<double> p(d, 0.0);
        p[i] = k & 1 ? 1 : -1;
        p[j] = k & 2 ? 1 : -1;
        s.add(p);
      }
  for (unsigned i = 0; i < d; ++i)
    for (double v : {-2.0, 2.0}) {
      std::vector<double> p(d, 0.0);
      p[i] = v;
      s.add(p);
    }
  return s;
}

/// Points (t, t^2, ..., t^d): every one is extreme, and facets are as many as can be.
inline PointSet cyclic(unsigned n, unsigned d) {
  PointSet s = named("cyclic", d);
  for (unsigned i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) - n / 2;
    for (double j = 0, power = t; j < d; ++j, power *= t) s.coordinates.push_back(power);
  }
  return s;
}

/// Two rings of rounded doubles joined by coplanar and nearly coplanar strips, and points between.
inline PointSet cylinder(unsigned n, std::uint64_t seed) {
  PointSet s = named("cylinder", 3);
  Random r(seed);
  for (unsigned i = 0; i < n; ++i) {
    const double t = 6.283185307179586 * r.unit();
    const double z = i % 3 == 0 ? -1 : i % 3 == 1 ? 1 : r.between(-1, 1);
    s.add({std::cos(t), std::sin(t), z});
  }
  return s;
}

inline PointSet cone(unsigned n, std::uint64_t seed) {
  PointSet s = named("cone", 3);
  Random r(seed);
  s.add({0, 0, 1});
  for (unsigned i = 1; i < n; ++i) {
    const double t = 6.283185307179586 * r.unit(), h = i % 2 ? 0 : r.unit();
    s.add({(1 - h) * std::cos(t), (1 - h) * std::sin(t), h});
  }
  return s;
}

/// Every integer point with |x|^2 = norm: cospherical exactly, with many coplanar groups.
inline PointSet cospherical(unsigned d, int norm) {
  PointSet s = named("cospherical " + std::to_string(norm), d);
  const int side = static_cast<int>(std::floor(std::sqrt(norm)));
  std::vector<int> v(d, -side);
  for (;;) {
    int sum = 0;
    for (int x : v) sum += x * x;
    if (sum == norm) s.add(std::vector<double>(v.begin(), v.end()));
    unsigned j = 0;
    while (j < d && v[j] == side) v[j++] = -side;
    if (j == d) return s;
    ++v[j];
  }
}

/// Random integer combinations of k random integer vectors about a random centre: a flat of
/// dimension at most k in R^d.
inline PointSet flat(unsigned n, unsigned k, unsigned d, int size, std::uint64_t seed) {
  PointSet s = named("flat of dimension " + std::to_string(k) + " in", d);
  Random r(seed);
  std::vector<std::vector<int>> axes(k, std::vector<int>(d));
  for (auto& a : axes)
    for (int& v : a) v = r.integer(-9, 9);
  for (unsigned j = 0; j < k; ++j) axes[j][(2 * j + 1) % d] += 40;  // independent
  for (unsigned i = 0; i < n; ++i) {
    std::vector<double> p(d, 1000);
    for (const auto& a : axes) {
      const int c = r.integer(0, size - 1);
      for (unsigned j = 0; j < d; ++j) p[j] += c * a[j];
    }
    s.add(p);
  }
  return s;
}

/// Coordinates of every magnitude, of both signs, zeros of both signs and denormals among them.
inline PointSet all_magnitudes(unsigned n, unsigned d, std::uint64_t seed) {
  PointSet s = named("all magnitudes seed " + std::to_string(seed), d);
  Random r(seed);
  for (unsigned i = 0; i < n * d; ++i) {
    double v = std::ldexp(r.between(1, 2), r.integer(-1022, 1023));
    if (r.integer(0, 9) == 0) v = std::ldexp(r.integer(0, 7), -1074);
    if (r.integer(0, 9) == 0) v = r.integer(0, 1) ? 1e308 : 1e-308;
    s.coordinates.push_back(r.integer(0, 1) ? v : -v);
  }
  return s;
}

}  // namespace cullhull::testing_support
