// Sets made to break an exact hull code: nearly or exactly coplanar, cospherical, collinear, of
// every magnitude, of few distinct points. All are functions of the random numbers alone.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "agreement/point_sets.hpp"

namespace cullhull::testing_support {

/// v, or one of the doubles beside it.
inline double shaken(double v, Random& r) {
  const int k = r.integer(-1, 1);
  return k == 0 ? v : std::nextafter(v, k * 1e300);
}

/// Two axes of each point turned by `angle`, and rounded.
inline void turn_axes(PointSet& s, unsigned a, unsigned b, double angle) {
  const double c = std::cos(angle), n = std::sin(angle);
  for (std::size_t i = 0; i < s.coordinates.size(); i += s.dimension) {
    double &x = s.coordinates[i + a], &y = s.coordinates[i + b];
    const double turned = c * x - n * y;
    y = n * x + c * y;
    x = turned;
  }
}

/// A lattice of three to five points an axis, turned by less than its coordinates can tell or by
/// more: planes of points become nearly planes.
inline PointSet turned_lattice(unsigned d, Random& r) {
  PointSet s = full_grid(d, d < 4 ? static_cast<unsigned>(r.integer(3, 5)) : 3, 0);
  s.name += ", turned";
  const double centre = r.integer(0, 2) * 0.5;
  for (double& v : s.coordinates) v -= centre;
  for (unsigned k = 0; k + 1 < d; ++k)
    turn_axes(s, k, k + 1, std::ldexp(r.between(1, 2), -r.integer(0, 60)));
  return s;
}

/// Points (x, sum of squares): coplanar wherever points of the lattice below are cospherical.
inline PointSet lifted_lattice(unsigned d, Random& r) {
  const int side = d <= 3 ? r.integer(3, 9) : 3;
  PointSet s = named("lifted lattice " + std::to_string(side), d);
  const PointSet base = full_grid(d - 1, static_cast<unsigned>(side), -r.integer(0, 3));
  for (std::uint64_t i = 0; i < base.count(); ++i) {
    std::vector<double> p(base.row(i), base.row(i) + d - 1);
    double square = 0;
    for (const double v : p) square += v * v;
    p.push_back(square);
    s.add(p);
  }
  return s;
}

/// On a sphere as nearly as doubles can be, around a centre that costs bits.
inline PointSet shaken_sphere(unsigned n, unsigned d, Random& r) {
  PointSet s = random_set("sphere", n, d, static_cast<std::uint64_t>(r.integer(0, 1 << 20)));
  s.name = "shaken " + s.name;
  const double shift = r.integer(0, 1) ? std::ldexp(1, r.integer(0, 45)) : 0;
  for (double& v : s.coordinates) v = shaken(shift + v, r);
  return s;
}

/// Axes of very different size, up to the ends of what doubles hold.
inline PointSet mixed_axes(unsigned n, unsigned d, Random& r) {
  PointSet s = random_set(r.integer(0, 1) ? "ball" : "sphere", n, d, 3);
  s.name = "mixed axes, " + s.name;
  for (unsigned j = 0; j < d; ++j) {
    const int e = r.integer(0, 2) == 0 ? -1060 : r.integer(0, 1) ? 1020 : r.integer(-1000, 1000);
    for (std::size_t i = j; i < s.coordinates.size(); i += d)
      s.coordinates[i] = std::ldexp(s.coordinates[i], e);
  }
  return s;
}

/// Small integers times the least double.
inline PointSet denormals(unsigned n, unsigned d, Random& r) {
  PointSet s = random_grid(n, d, r.integer(2, 30), 0, static_cast<std::uint64_t>(n));
  s.name = "denormal " + s.name;
  for (double& v : s.coordinates) v = std::ldexp(v - 5, -1074);
  return s;
}

/// Few points, each many times, in any order, zeros of both signs among them.
inline PointSet many_copies(unsigned n, unsigned d, Random& r) {
  const PointSet few = random_grid(static_cast<unsigned>(r.integer(1, 40)), d, r.integer(2, 9), -1,
                                   static_cast<std::uint64_t>(n));
  PointSet s = named("copies of " + few.name, d);
  for (unsigned i = 0; i < n; ++i) {
    const auto k = static_cast<std::uint64_t>(r.integer(0, static_cast<int>(few.count()) - 1));
    std::vector<double> p(few.row(k), few.row(k) + d);
    for (double& v : p)
      if (v == 0 && r.integer(0, 1)) v = -0.0;
    s.add(p);
  }
  return s;
}

/// General position but for zeros: some coordinates are zero, those of a facet across an axis among
/// them, and points come twice and more, with zeros of either sign. Of equal points the one with
/// the lowest id has to stand in, to the bit: normals get their zeros from there.
inline PointSet signed_zeros(unsigned n, unsigned d, Random& r) {
  PointSet s = named("signed zeros", d);
  const PointSet once = random_set("sphere", n, d, n);
  std::vector<std::vector<double>> rows;
  for (std::uint64_t i = 0; i < once.count(); ++i) {
    std::vector<double> p(once.row(i), once.row(i) + d);
    p[0] = i < d ? 0 : std::fabs(p[0]);
    if (r.integer(0, 2) == 0)
      p[static_cast<std::size_t>(r.integer(0, static_cast<int>(d) - 1))] = 0;
    for (int copies = r.integer(1, 3); copies > 0; --copies) {
      for (double& v : p)
        if (v == 0) v = r.integer(0, 1) ? 0.0 : -0.0;
      rows.push_back(p);
    }
  }
  for (std::size_t i = rows.size(); i > 1; --i)
    std::swap(rows[i - 1], rows[static_cast<std::size_t>(r.integer(0, static_cast<int>(i) - 1))]);
  for (const auto& p : rows) s.add(p);
  return s;
}

/// a + t b, rounded: on a line exactly, or as nearly as doubles can be.
inline PointSet line(unsigned n, unsigned d, Random& r) {
  PointSet s = named("line", d);
  const bool exact = r.integer(0, 1);
  std::vector<double> a(d), b(d);
  for (double& v : a) v = exact ? r.integer(-9, 9) : r.normal();
  for (double& v : b) v = exact ? r.integer(-9, 9) : r.normal();
  for (unsigned i = 0; i < n; ++i) {
    const double t = exact ? r.integer(-1000, 1000) : r.normal();
    std::vector<double> p(d);
    for (unsigned j = 0; j < d; ++j) p[j] = a[j] + t * b[j];
    s.add(p);
  }
  return s;
}

/// A base of dimension d - 1 below and above, and between: facets that are no simplices.
inline PointSet prism(unsigned n, unsigned d, Random& r) {
  const PointSet base =
      random_set("sphere", std::max(2U, n / 2), d - 1, static_cast<std::uint64_t>(n));
  PointSet s = named("prism over " + base.name, d);
  for (std::uint64_t i = 0; i < base.count(); ++i)
    for (const double z : {0.0, 1.0, 0.5}) {
      std::vector<double> p(base.row(i), base.row(i) + d - 1);
      p.push_back(z);
      s.add(p);
    }
  if (r.integer(0, 2) == 0) turn_axes(s, 0, d - 1, r.between(0, 3));
  return s;
}

/// Points of the moment curve, perhaps shaken; parameters are whole, so without it all is exact.
inline PointSet shaken_cyclic(unsigned n, unsigned d, Random& r) {
  PointSet s = cyclic(n, d);
  if (r.integer(0, 1)) {
    s.name = "shaken " + s.name;
    for (double& v : s.coordinates) v = shaken(v, r);
  }
  return s;
}

/// In a flat of dimension k < d but for the last bit of some coordinates.
inline PointSet nearly_flat(unsigned n, unsigned d, Random& r) {
  const auto k = static_cast<unsigned>(r.integer(1, static_cast<int>(d) - 1));
  PointSet s = flat(n, k, d, 9, static_cast<std::uint64_t>(n));
  s.name = "nearly " + s.name;
  const double scale = r.integer(0, 1) ? 1 : 0.1;
  const int one_in = r.integer(1, 30);
  for (double& v : s.coordinates) v = r.integer(1, one_in) == 1 ? shaken(v * scale, r) : v * scale;
  return s;
}

/// Random points of the faces of a simplex, and its corners.
inline PointSet faces_of_simplex(unsigned n, unsigned d, Random& r) {
  PointSet s = named("faces of a simplex", d);
  const PointSet corners = random_grid(d + 1, d, 64, 0, static_cast<std::uint64_t>(n));
  for (unsigned i = 0; i < n; ++i) {
    // Weights are sixteenths of few corners: exact.
    std::vector<double> p(d, 0);
    for (unsigned k = 0; k < 16; ++k) {
      const auto c = static_cast<std::uint64_t>(r.integer(0, r.integer(0, static_cast<int>(d))));
      for (unsigned j = 0; j < d; ++j) p[j] += corners.row(c)[j] / 16;
    }
    s.add(p);
  }
  for (std::uint64_t i = 0; i <= d; ++i) s.add({corners.row(i), corners.row(i) + d});
  return s;
}

/// Sums of some of a few vectors: many parallel faces.
inline PointSet zonotope(unsigned d, Random& r) {
  PointSet s = named("zonotope", d);
  const unsigned k = d + static_cast<unsigned>(r.integer(0, d <= 3 ? 6 : 2));
  const PointSet vectors = random_grid(k, d, 7, -3, k);
  for (unsigned mask = 0; mask < 1U << k; ++mask) {
    std::vector<double> p(d, 0);
    for (unsigned i = 0; i < k; ++i)
      if (mask >> i & 1)
        for (unsigned j = 0; j < d; ++j) p[j] += vectors.row(i)[j];
    s.add(p);
  }
  return s;
}

/// Two clusters as far apart as doubles allow, each as small as it may be there.
inline PointSet far_clusters(unsigned n, unsigned d, Random& r) {
  PointSet s = random_set("ball", n, d, 9);
  s.name = "far clusters, " + s.name;
  const double far = std::ldexp(1, r.integer(20, 1000));
  for (std::uint64_t i = 0; i < n; ++i)
    if (i % 2)
      for (unsigned j = 0; j < d; ++j) s.coordinates[i * d + j] += far;
  return s;
}

/// One of the above, of a dimension from 2 to 8, or random integers, or hardly any points at all.
inline PointSet hard_set(Random& r) {
  constexpr int most[] = {0, 0, 4000, 3000, 300, 80, 40, 25, 18};
  const auto d = static_cast<unsigned>(r.integer(2, 8));
  const auto n = static_cast<unsigned>(
      std::exp(r.between(std::log(d + 1.0), std::log(static_cast<double>(most[d])))));
  const unsigned lattice_d = std::min(d, 4U);
  const std::function<PointSet()> makers[] = {[&] {
    return turned_lattice(lattice_d, r);
                                              },
                                              [&] {
    return lifted_lattice(std::min(d, 5U), r);
  },
                                  [&] {
    return shaken_sphere(n, d, r);
  },
      [&] { return mixed_axes(n, d, r); }, [&] { return denormals(n, d, r); },
      [&] { return many_copies(100 * n, d, r); }, [&] { return line(n, d, r); },
      [&] { return prism(n, d, r); }, [&] { return shaken_cyclic(std::min(n, 1000U), d, r); },
      [&] { return nearly_flat(n, d, r); }, [&] { return faces_of_simplex(n, d, r); },
      [&] { return zonotope(std::min(d, 6U), r); }, [&] { return far_clusters(n, d, r); },
      [&] { return all_magnitudes(std::min(n, 400U), d, n); },
      [&] {  // as many points as the dimension, one more or one less
    return random_grid(
        static_cast<unsigned>(r.integer(static_cast<int>(d) - 1, static_cast<int>(d) + 2)), d,
        r.integer(2, 5), r.integer(0, 1) * 0x1p45, n);
      }, [&] { return signed_zeros(n, d, r); },
      [&] { return random_grid(n, d, r.integer(2, d <= 4 ? 30 : 5), 0, n); }};
  return makers[r.integer(0, 16)]();
}

}  // namespace cullhull::testing_support
