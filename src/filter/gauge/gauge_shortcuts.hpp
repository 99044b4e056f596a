// Tests that run before the GaugeMap's own and decide most points at a lower cost.
#pragma once

#include <optional>

#include "filter/gauge/gauge_core.hpp"
#include "filter/gauge/gauge_levels.hpp"
#include "filter/gauge/gauge_table.hpp"

namespace cullhull::internal::inline filter {

struct GaugeShortcuts {
  std::optional<GaugeCore> core;
  std::optional<GaugeLevels> levels;
  bool any() const { return core || levels; }
};

/// The shortcuts that pay for a pass over `count` points, judged by a sample of them (all of them
/// if fewer than 512).
GaugeShortcuts make_shortcuts(const GaugeTable& table, const PointView& points, std::uint64_t count,
                              unsigned threads);

}  // namespace cullhull::internal::inline filter
