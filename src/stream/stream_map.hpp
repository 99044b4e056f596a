// The filter of a stream: a gauge map of the hull of earlier blocks, applied to later ones.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "filter/gauge/gauge_build.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull::internal {

/// A gauge map with exact tests behind it. Thread safe once built.
class StreamMap {
 public:
  /// Builds the map from extreme points; null if there is no useful map: in a flat, beyond 6D, for
  /// too few points, or if the hull exceeds the budget.
  static std::unique_ptr<StreamMap> lay(const NumberedPoints& extreme, const Run& run);

  /// Appends to `kept` the points of a block that are not provably strictly inside; points that are
  /// not finite are kept. `kept` must have the block's dimension and scalar type.
  void cull(const PointView& block, std::uint64_t first_id, const Run& run,
            NumberedPoints& kept) const;

 private:
  explicit StreamMap(std::unique_ptr<GaugeMap> map) : map_(std::move(map)) {}
  const GaugeCore* core(const PointView& block, unsigned threads) const;
  std::size_t cull_chunk(const PointView& block, std::uint64_t begin, std::uint64_t end,
                         const GaugeCore* core, std::uint32_t* positions) const;

  std::unique_ptr<GaugeMap> map_;
  mutable std::mutex mutex_;
  mutable bool core_sought_ = false;
  mutable std::optional<GaugeCore> core_;
};

}  // namespace cullhull::internal
