// Sets for tests of points that come in pieces or lie on several ranks.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "agreement/hard_sets.hpp"
#include "agreement/point_sets.hpp"
#include "agreement/random_seeds.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::testing_support {

inline PointView part_of(const PointView& whole, std::uint64_t begin, std::uint64_t end) {
  PointView part = whole;
  part.data = whole.address(begin, 0);
  part.count = end - begin;
  return part;
}

/// Sets large enough for filters, others hard or tiny, of dimension 1 to 8.
inline PointSet stream_set(Random& r) {
  static constexpr const char* shapes[] = {"ball",       "sphere", "cube",
                                           "octahedron", "gauss",  "shell"};
  static constexpr int most[] = {0, 20000, 60000, 40000, 12000, 3000, 800, 60};
  const int kind = r.integer(0, 3);
  if (kind == 0) return hard_set(r);
  const auto d = static_cast<unsigned>(r.integer(1, 7));
  const double least = kind == 2 ? most[d] / 4 : 1;  // large ones lay maps
  const auto n = static_cast<unsigned>(std::exp(r.between(std::log(least), std::log(most[d]))));
  if (kind == 1 || d == 1) return random_grid(n, d, r.integer(2, 60), 0, n + d);
  PointSet s = named(std::string(shapes[r.integer(0, 5)]) + " of " + std::to_string(n), d);
  s.coordinates = generate(s.name.substr(0, s.name.find(' ')), n, d,
                           static_cast<std::uint64_t>(r.integer(0, 1 << 30)));
  if (r.integer(0, 4) == 0 && d > 1)  // a flat, perhaps but for its last points
    for (std::size_t i = d - 1; i < s.coordinates.size(); i += d)
      if (i + 3 * d < s.coordinates.size() || r.integer(0, 1)) s.coordinates[i] = 1;
  if (r.integer(0, 4) == 0)  // again from the start, so that copies lie in other blocks
    s.coordinates.insert(s.coordinates.end(), s.coordinates.begin(),
                         s.coordinates.begin() + static_cast<std::ptrdiff_t>(n / 2 * d));
  if (r.integer(0, 4) == 0) {  // as scans are: in order along an axis
    std::vector<std::size_t> order(s.count());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return s.row(a)[0] < s.row(b)[0]; });
    PointSet sorted = named(s.name + " in order", d);
    for (const std::size_t i : order)
      sorted.coordinates.insert(sorted.coordinates.end(), s.row(i), s.row(i) + d);
    return sorted;
  }
  return s;
}

}  // namespace cullhull::testing_support
