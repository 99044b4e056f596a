// From a polytope to the GaugeMap's table, and to its cones.
#pragma once

#include <memory>

#include "filter/gauge/gauge_map.hpp"
#include "filter/gauge/gauge_table.hpp"

namespace cullhull::internal::inline filter {

/// The polytope and the cones over its facets, to test points one by one.
class GaugeCones {
 public:
  virtual ~GaugeCones() = default;
  /// True only if x (in the points' coordinates, exact doubles) is strictly inside. Thread safe.
  virtual bool inside(const double* x) const = 0;
};

/// Fills `table` and, where `settings` ask for them, `cones`; false when no useful map exists. See
/// GaugeMap::build.
bool build_gauge_table(InnerPolytope&& polytope, const GaugeSettings& settings, GaugeTable& table,
                       std::unique_ptr<GaugeCones>* cones);

}  // namespace cullhull::internal::inline filter
