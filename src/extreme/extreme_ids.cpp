// After Clarkson (More output-sensitive geometric algorithms, 1994): a point is tested against a
// working set; if it is inside that set's hull, it is not extreme. If a direction separates the
// two, the point farthest in that direction joins the working set; if that is the point itself, it
// is extreme. Points are tested in blocks, outermost first, against the working set of the blocks
// before.
#include "extreme/extreme_ids.hpp"

#include <algorithm>
#include <numeric>

#include "extreme/hull_membership.hpp"
#include "geometry/norm_order.hpp"
#include "geometry/unflattened.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {
namespace {

/// Returns the lowest id of each set of equal points.
std::vector<std::uint32_t> distinct(const LocalPoints& points, const Control& control) {
  const unsigned d = points.dimension;
  std::vector<std::uint32_t> ids(points.count);
  std::iota(ids.begin(), ids.end(), 0U);
  const auto compare = [&](std::uint32_t a, std::uint32_t b) {
    const double* x = points.exact_row(a);
    const double* y = points.exact_row(b);
    for (unsigned j = 0; j < d; ++j)
      if (x[j] != y[j]) return x[j] < y[j] ? -1 : 1;
    return 0;
  };
  std::uint32_t compared = 0;
  std::sort(ids.begin(), ids.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (++compared % 65536 == 0) control.check();
    const int c = compare(a, b);
    return c != 0 ? c < 0 : a < b;
  });
  ids.erase(std::unique(ids.begin(), ids.end(),
                        [&](std::uint32_t a, std::uint32_t b) { return compare(a, b) == 0; }),
            ids.end());
  return ids;
}

}  // namespace

std::vector<std::uint32_t> extreme_ids(const LocalFrame& frame, const Run& run) {
  const Unflattened unflattened(frame, run);
  const LocalPoints& points = unflattened.points();
  constexpr std::uint64_t chunk = 32;
  std::vector<std::uint8_t> present(points.count, 0);
  for (const std::uint32_t i : distinct(points, run.control)) present[i] = 1;
  // Outermost first: the hull of the first points contains most others.
  std::vector<std::uint32_t> order, ends;
  NormOrder(points, {}, run).take_rounds(points.count, order, ends);
  order.erase(std::remove_if(order.begin(), order.end(), [&](auto i) { return !present[i]; }),
              order.end());

  std::vector<std::uint32_t> extreme;
  const PointColumns others(points, order, run.control);
  PointColumns working(points);
  for (std::size_t begin = 0, size = 64; begin < order.size(); begin += size) {
    size = std::clamp<std::size_t>(std::max(working.ids().size() / 4, begin / 8), 64, 8192);
    const std::size_t count = std::min(size, order.size() - begin);
    std::vector<std::uint8_t> inside(count, 0);
    std::vector<std::vector<std::uint32_t>> useful(chunk_count(count, chunk));
    run.each_chunk(count, chunk, [&](std::uint64_t c, std::uint64_t from, std::uint64_t to) {
      HullMembership membership(points, run.control);
      for (std::uint64_t i = from; i < to; ++i)
        inside[i] = membership.inside(order[begin + i], others, working, useful[c]);
    });
    const auto join = [&](std::uint32_t i) {
      if (!working.contains(i)) working.add(i);
    };
    for (std::size_t i = 0; i < count; ++i) {
      if (inside[i]) continue;
      extreme.push_back(order[begin + i]);
      join(order[begin + i]);
    }
    for (const auto& list : useful)
      for (const std::uint32_t i : list) join(i);
    run.report("extreme points",
               static_cast<double>(begin + count) / static_cast<double>(order.size()));
  }
  std::sort(extreme.begin(), extreme.end());
  return extreme;
}

}  // namespace cullhull::internal
