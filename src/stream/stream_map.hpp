// The filter of a stream: a gauge map of points of earlier blocks, applied to later ones.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "filter/gauge/gauge_build.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull::internal {

/// A gauge map, of a hull with exact tests behind it. Thread safe: it does not change.
class StreamMap {
 public:
  /// Builds the map of the points' hull; null if there is no useful map: in a flat, beyond 6D, for
  /// too few points, or if the hull exceeds the budget. `block`: points such as those that it will
  /// be applied to, which choose the test before the map's own; too few give none.
  static std::shared_ptr<const StreamMap> lay(const NumberedPoints& points, const PointView& block,
                                              const Run& run);
  /// Builds the map of the points' leaders (GaugeMap::of_leaders) in a fraction of the time of
  /// their hull, on all threads; null where leaders do not suit. `before`: a map of some of the
  /// points, or null. `tested`: how many points the map will be applied to, at least those given.
  static std::shared_ptr<const StreamMap> of_leaders(const NumberedPoints& points,
                                                     const StreamMap* before,
                                                     const PointView* block, std::uint64_t tested,
                                                     const Run& run);

  /// Appends to `kept` the points of a block that are not provably strictly inside; points that are
  /// not finite are kept. `kept` must have the block's dimension and scalar type.
  void cull(const PointView& block, std::uint64_t first_id, const Run& run,
            NumberedPoints& kept) const;
  /// Drops those of the points that are strictly inside.
  void thin(NumberedPoints& points, const Run& run) const;

 private:
  StreamMap(std::unique_ptr<GaugeMap> map, bool cones, const PointView* block, const Run& run);
  std::size_t cull_chunk(const PointView& block, std::uint64_t begin, std::uint64_t end,
                         std::uint32_t* positions) const;

  const std::unique_ptr<GaugeMap> map_;
  const bool cones_;  ///< of the map's polytope, for exact tests
  std::optional<GaugeCore> core_;
};

}  // namespace cullhull::internal
