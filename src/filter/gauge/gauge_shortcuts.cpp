#include "filter/gauge/gauge_shortcuts.hpp"

#include <algorithm>
#include <vector>

#include "geometry/gather.hpp"

namespace cullhull::internal::inline filter {
namespace {

/// Estimates the share of points that a shortcut drops to some 2 % (one standard deviation).
constexpr std::uint32_t probe_count = 512;

/// Points from all over the view, in the map's frame, as columns. They only serve to estimate how
/// much a shortcut saves: which points they are, and their rounding, does not affect results.
std::vector<float> probe(const GaugeTable& t, const PointView& points) {
  const unsigned d = t.dimension;
  const std::uint64_t stretch = points.count / probe_count;
  std::vector<float> columns(std::size_t{probe_count} * d);
  for (std::uint64_t i = 0; i < probe_count; ++i) {
    double x[GaugeTable::max_dimension];
    load_row(points, i * stretch + i * 0x9E3779B97F4A7C15ULL % stretch, x);
    for (unsigned j = 0; j < d; ++j)
      columns[j * probe_count + i] = static_cast<float>(x[j] * t.scale[j] - t.offset[j]);
  }
  return columns;
}

}  // namespace

GaugeShortcuts make_shortcuts(const GaugeTable& t, const PointView& points, std::uint64_t count,
                              unsigned threads) {
  // Building a shortcut takes a fraction of a millisecond, and it saves up to a nanosecond a point:
  // at 2 million points, one for the core, at 4 million for the levels, it pays even where it saves
  // half of that.
  constexpr std::uint64_t worth_core = std::uint64_t{1} << 21, worth_levels = worth_core << 1;
  GaugeShortcuts s;
  if (count >= worth_core) s.core = make_core(t, probe(t, points), probe_count, threads);
  if (count >= worth_levels) s.levels = make_levels(t, threads);
  return s;
}

}  // namespace cullhull::internal::inline filter
