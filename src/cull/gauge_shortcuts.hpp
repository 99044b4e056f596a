// Tests that come before the GaugeMap's own and spare most points the latter.
#pragma once

#include <optional>

#include "cull/gauge_core.hpp"
#include "cull/gauge_levels.hpp"
#include "cull/gauge_table.hpp"

namespace cullhull::internal {

struct GaugeShortcuts {
  std::optional<GaugeCore> core;
  std::optional<GaugeLevels> levels;
  bool any() const { return core || levels; }
};

/// Those that pay for a pass over `count` points like these, which are 512 or more where `count` is
/// large; a few of them decide.
GaugeShortcuts make_shortcuts(const GaugeTable& table, const PointView& points, std::uint64_t count,
                              unsigned threads);

}  // namespace cullhull::internal
