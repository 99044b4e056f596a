// A simple body inside the GaugeMap's pseudo-hull: a test without look-ups, for most of the points.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "filter/gauge/gauge_table.hpp"

namespace cullhull::internal::inline filter {

/// A body inside the region that the map drops. In the map's frame an ellipsoid around the centre,
/// or a box around it with cut edges and corners: both with the frame's axes.
struct GaugeCore {
  enum class Kind {
    round,  ///< the sum of weight_j y_j^2 is below radius[0]
    cut     ///< with z_j = weight_j |y_j|: all z, the sum but the least of them, the sum of all are
            ///< below radius[0], [1], [2]
  };
  static constexpr unsigned norms = 3;

  Kind kind = Kind::round;
  float weight[GaugeTable::max_dimension] = {};
  float radius[norms] = {};
};

/// The body that holds most of `probes` (columns of `count` coordinates in the map's frame), if it
/// holds enough of them to pay. docs/exactness.md, G9, proves that the map drops every point of the
/// body. Does not depend on the number of threads.
std::optional<GaugeCore> make_core(const GaugeTable& table, const std::vector<float>& probes,
                                   std::uint32_t count, unsigned threads);

}  // namespace cullhull::internal::inline filter
