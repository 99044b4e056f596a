// Bytes to points in the plane, a few or, as sums of a few with a lattice's points, enough for
// buckets, runs and samples: the polygon must be that of a sort and a scan.
#include <algorithm>

#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "exact/orientation/orientation.hpp"
#include "fuzz_points.hpp"
#include "tests/agreement/canonical_hash.hpp"

namespace {

using namespace cullhull;
using fuzz::fail;
using Ids = std::vector<std::uint64_t>;

/// Andrew's scan, with the exact predicate alone: lowest ids of extreme points, counter-clockwise
/// from the lowest.
Ids slow_polygon(const std::vector<double>& p) {
  Ids order(p.size() / 2);
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto equal = [&](std::uint64_t a, std::uint64_t b) {
    return p[2 * a] == p[2 * b] && p[2 * a + 1] == p[2 * b + 1];
  };
  std::sort(order.begin(), order.end(), [&](std::uint64_t a, std::uint64_t b) {
    if (p[2 * a] != p[2 * b]) return p[2 * a] < p[2 * b];
    if (p[2 * a + 1] != p[2 * b + 1]) return p[2 * a + 1] < p[2 * b + 1];
    return a < b;
  });
  order.erase(std::unique(order.begin(), order.end(), equal), order.end());
  if (order.size() < 2) return order;
  Ids polygon;
  for (int half = 0; half < 2; ++half) {
    const std::size_t base = polygon.size();
    for (const std::uint64_t i : order) {
      for (; polygon.size() >= base + 2; polygon.pop_back()) {
        const double* rows[] = {&p[2 * polygon[polygon.size() - 2]], &p[2 * polygon.back()],
                                &p[2 * i]};
        if (internal::orientation(2, rows) == internal::Sign::positive) break;
      }
      polygon.push_back(i);
    }
    polygon.pop_back();
    std::reverse(order.begin(), order.end());
  }
  std::rotate(polygon.begin(), std::min_element(polygon.begin(), polygon.end()), polygon.end());
  return polygon;
}

/// Every point plus the points of a lattice of `side` by `side`, in an order that mixes them.
std::vector<double> spread(const std::vector<double>& few, std::size_t side, double step) {
  std::vector<double> out;
  for (std::size_t k = 0; k < side * side; ++k)
    for (std::size_t i = 0; i + 1 < few.size(); i += 2)
      for (std::size_t j = 0; j < 2; ++j) {
        const auto at = static_cast<double>(j == 0 ? k / side : k * 7 % side);
        const double v = few[i + j] + at * step;
        out.push_back(std::isfinite(v) ? v : few[i + j]);
      }
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2 || size > 1200) return 0;
  std::vector<double> rows = fuzz::coordinates_of(data + 2, size - 2, data[0] % fuzz::kinds);
  rows.resize(rows.size() / 2 * 2);
  if (data[0] / 4 % 8 == 0)
    rows = spread(rows, 2 + data[1] % 16, std::ldexp(1, 8 * (data[0] / 32) - 60));
  const std::size_t n = rows.size() / 2;
  try {
    Options options;
    options.threads = 1;
    options.cull = CullMethod::none;
    const auto view = PointView::row_major(rows.data(), n, 2);
    const Hull hull = convex_hull(view, options);
    if (n > 0 && hull.vertices != slow_polygon(rows)) fail("differs", "from the slow polygon");
    options.threads = 1 + data[1] / 16 % 4;
    options.cull = CullMethod::automatic;
    if (testing_support::canonical_hash(convex_hull(view, options)) !=
        testing_support::canonical_hash(hull))
      fail("differs", std::to_string(options.threads) + " threads");
  } catch (const Error& e) {
    fail("error", e.what());
  }
  return 0;
}
