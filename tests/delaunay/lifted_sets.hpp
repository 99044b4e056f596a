// Point sets on which triangulations go wrong: cospherical, flat, shifted far away, weighted.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "cullhull/triangulation.hpp"

namespace cullhull::testing_support {

struct LiftedSet {
  std::string name;
  unsigned dimension = 0;
  std::vector<double> rows, weights;

  std::uint64_t count() const { return rows.size() / dimension; }
};

inline PointView view_of(const LiftedSet& s) {
  return PointView::row_major(s.rows.data(), s.count(), s.dimension);
}

inline Triangulation triangulate(const LiftedSet& s, const TriangulationOptions& o = {}) {
  return s.weights.empty() ? delaunay(view_of(s), o)
                           : regular_triangulation(view_of(s), s.weights, o);
}

/// Whole numbers 0 .. width - 1 of each axis, drawn n times, in units of `step` from `shift`.
inline LiftedSet drawn_grid(unsigned d, unsigned n, unsigned width, double step, double shift,
                            std::uint64_t seed) {
  LiftedSet s{"grid", d, {}, {}};
  std::mt19937_64 random(seed);
  for (unsigned i = 0; i < n * d; ++i)
    s.rows.push_back(shift + step * static_cast<double>(random() % width));
  s.name += " " + std::to_string(d) + "D seed " + std::to_string(seed);
  return s;
}

inline LiftedSet random_points(unsigned d, unsigned n, std::uint64_t seed) {
  LiftedSet s{"random " + std::to_string(d) + "D", d, {}, {}};
  std::mt19937_64 random(seed);
  for (unsigned i = 0; i < n * d; ++i)
    s.rows.push_back(std::ldexp(static_cast<double>(random() >> 11), -53));
  return s;
}

/// No points, one and so on up to d + 3, of whole coordinates below `width`.
inline std::vector<LiftedSet> few_points(unsigned d, unsigned width = 5) {
  std::vector<LiftedSet> sets{{"no points", d, {}, {}}};
  std::mt19937_64 random(d);
  for (unsigned n = 1; n <= d + 3; ++n) {
    sets.push_back(sets.back());
    sets.back().name = std::to_string(n) + " points in " + std::to_string(d) + "D";
    for (unsigned j = 0; j < d; ++j)
      sets.back().rows.push_back(static_cast<double>(random() % width));
  }
  return sets;
}

/// Points with whole coordinates on a sphere: signed permutations of one vector.
inline LiftedSet on_a_sphere(unsigned d, unsigned n, std::uint64_t seed) {
  LiftedSet s{"sphere " + std::to_string(d) + "D", d, {}, {}};
  std::mt19937_64 random(seed);
  for (unsigned i = 0; i < n; ++i) {
    std::vector<double> x(d);
    for (unsigned j = 0; j < d; ++j) x[j] = j + 1.0;
    std::shuffle(x.begin(), x.end(), random);
    for (double& v : x) s.rows.push_back(random() % 2 == 0 ? v : -v);
  }
  return s;
}

/// In a flat of k < d dimensions that is slanted, by whole numbers.
inline LiftedSet in_a_flat(unsigned d, unsigned k, unsigned n, std::uint64_t seed) {
  LiftedSet s{"flat of " + std::to_string(k) + " in " + std::to_string(d) + "D", d, {}, {}};
  std::mt19937_64 random(seed);
  std::vector<double> basis;
  for (unsigned i = 0; i < k * d; ++i) basis.push_back(static_cast<double>(random() % 7) - 3);
  for (unsigned i = 0; i < n; ++i) {
    std::vector<double> x(d, 1.0);
    for (unsigned b = 0; b < k; ++b) {
      const double t = static_cast<double>(random() % 9);
      for (unsigned j = 0; j < d; ++j) x[j] += t * basis[b * d + j];
    }
    s.rows.insert(s.rows.end(), x.begin(), x.end());
  }
  return s;
}

inline LiftedSet with_weights(LiftedSet s, double range, std::uint64_t seed, bool whole) {
  std::mt19937_64 random(seed);
  for (std::uint64_t i = 0; i < s.count(); ++i) {
    const double w = range * std::ldexp(static_cast<double>(random() >> 11), -53);
    s.weights.push_back(whole ? std::floor(w) : w);
  }
  s.name += " weighted";
  return s;
}

/// Few enough for brute force.
inline std::vector<LiftedSet> small_lifted_sets(unsigned d, std::uint64_t seed) {
  const unsigned n = d <= 2 ? 13 : d == 3 ? 11 : d == 4 ? 10 : 9;
  std::vector<LiftedSet> sets;
  sets.push_back(random_points(d, n, seed));
  sets.push_back(drawn_grid(d, n, 2, 1, 0, seed));
  sets.push_back(drawn_grid(d, n, 3, 1, 0, seed + 1));
  sets.push_back(drawn_grid(d, n, 3, 0.25, std::ldexp(1.0, 40), seed + 2));
  sets.push_back(drawn_grid(d, n, 4, 0.1, 0.3, seed + 3));
  sets.push_back(on_a_sphere(d, n, seed));
  for (unsigned k = 0; k < d; ++k) sets.push_back(in_a_flat(d, k, n, seed + k));
  LiftedSet wild = random_points(d, n, seed + 4);
  for (std::size_t i = 0; i < wild.rows.size(); ++i)
    wild.rows[i] *= i % 3 == 0 ? 1e308 : i % 3 == 1 ? 1e-308 : 1;
  wild.name = "1e308 beside 1e-308";
  sets.push_back(wild);
  LiftedSet far = random_points(d, n, seed + 5);
  far.rows[0] = 1e15;
  far.name = "one far away";
  sets.push_back(far);
  if (d <= 3) {  // products of differences underflow in doubles
    LiftedSet tiny = random_points(d, n, seed + 7);
    for (std::size_t i = 0; i < tiny.rows.size() - d; ++i)
      tiny.rows[i] = std::ldexp(tiny.rows[i], -380);
    tiny.name = "2^-380 beside 1";
    sets.push_back(tiny);
  }
  LiftedSet line = drawn_grid(d, n, 5, 1, 0, seed + 6);  // part of it on a line
  for (unsigned i = 0; i < n / 2; ++i)
    for (unsigned j = 0; j < d; ++j) line.rows[i * d + j] = i;
  line.name = "partly on a line";
  sets.push_back(line);
  const std::size_t plain = sets.size();
  for (std::size_t i = 0; i < plain; ++i) {
    sets.push_back(with_weights(sets[i], 3, seed + i, true));
    sets.push_back(with_weights(sets[i], 1, seed + i, false));
  }
  for (LiftedSet& s : sets) s.name += " (" + std::to_string(d) + "D)";
  return sets;
}

inline LiftedSet random_lifted_set(unsigned d, std::uint64_t seed) {
  std::mt19937_64 random(seed * 8 + d);
  const auto n = static_cast<unsigned>(1 + random() % (d == 4 ? 10 : 13));
  LiftedSet s = drawn_grid(d, n, static_cast<unsigned>(2 + random() % 5), 1, 0, random());
  if (random() % 3 == 0) s = with_weights(s, 4, random(), true);
  s.name += " " + std::to_string(n) + " points";
  return s;
}

inline std::vector<LiftedSet> large_lifted_sets(unsigned d, unsigned n) {
  std::vector<LiftedSet> sets;
  sets.push_back(random_points(d, n, 1));
  const auto width = static_cast<unsigned>(std::ceil(std::pow(n, 1.0 / d)));
  sets.push_back(drawn_grid(d, n, width, 1, 0, 2));
  sets.push_back(drawn_grid(d, n, width, 1, std::ldexp(1.0, 40), 3));
  sets.push_back(drawn_grid(d, n, width, 0.1, 0.3, 4));
  sets.push_back(on_a_sphere(d, n, 5));
  if (d > 1) sets.push_back(in_a_flat(d, d - 1, n, 6));
  sets.push_back(with_weights(random_points(d, n, 7), 0.02, 8, false));
  sets.push_back(with_weights(drawn_grid(d, n, width, 1, 0, 9), 3, 10, true));
  LiftedSet clustered = random_points(d, n, 11);
  for (std::size_t i = d; i < clustered.rows.size(); ++i)
    clustered.rows[i] = std::ldexp(clustered.rows[i], -static_cast<int>(i / d % 40));
  clustered.name = "clustered";
  sets.push_back(clustered);
  for (LiftedSet& s : sets) s.name += " (" + std::to_string(d) + "D, large)";
  return sets;
}

}  // namespace cullhull::testing_support
