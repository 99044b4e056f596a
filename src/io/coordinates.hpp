// Coordinates by point id, for writers: of all points, or of a state's extreme points only.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/placement.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/stream.hpp"
#include "io/source.hpp"

namespace cullhull::internal {

/// Views the points or the state.
class Coordinates {
 public:
  Coordinates(const PointView& all)  // implicit, for most callers
      : count(all.count), dimension(all.dimension), scalar(all.scalar), rows_(all) {}
  Coordinates(const HullState& state)  // NOLINT
      : count(state.point_count()),
        dimension(state.dimension()),
        scalar(state.scalar()),
        rows_(state.points()),
        ids_(&state.ids()) {}

  /// Throws unless the hull is one of these points: a stream's has ids of its own.
  void require_hull(const Hull& hull) const {
    const auto is_here = [&](std::uint64_t id) {
      return ids_ == nullptr ? id < count : std::binary_search(ids_->begin(), ids_->end(), id);
    };
    if (count != hull.point_count || dimension != hull.dimension ||
        !std::all_of(hull.vertices.begin(), hull.vertices.end(), is_here))
      throw Error(ErrorCode::invalid_argument, "the hull is not that of these points");
  }
  /// Whether all points are available, not only the extreme ones.
  bool complete() const noexcept { return ids_ == nullptr; }

  double at(std::uint64_t id, std::uint32_t j) const noexcept { return rows_.at(row(id), j); }
  const std::byte* address(std::uint64_t id, std::uint32_t j) const noexcept {
    return rows_.address(row(id), j);
  }

  const std::uint64_t count;  ///< of points, available or not
  const std::uint32_t dimension;
  const ScalarType scalar;
  std::ptrdiff_t coordinate_stride() const noexcept { return rows_.coordinate_stride; }

 private:
  std::uint64_t row(std::uint64_t id) const noexcept {
    if (ids_ == nullptr) return id;
    return static_cast<std::uint64_t>(std::lower_bound(ids_->begin(), ids_->end(), id) -
                                      ids_->begin());
  }
  PointView rows_;
  const std::vector<std::uint64_t>* ids_ = nullptr;
};

// From the whole numbers of a scan to coordinates: in the world, or on a grid.

/// Along each axis of a placement the grid position of a number is number * step + origin, exactly.
struct Multiples {
  std::vector<double> step, origin;
};

/// None where the axes do not lie on the grid, or their numbers of 32 bits might need more than 50
/// there.
std::optional<Multiples> multiples_of(const Placement& placement, const Grid& grid);

/// What a hull state says of its grid; members as in HullState.
struct GridOfState {
  int decimals = -1, places = -1, bits = 0;
};

/// The common grid of files with these placements and of these states, as of all the files that the
/// states were computed from. Empty if a state has no grid.
Grid grid_of_all(const std::vector<Placement>& placements, const std::vector<GridOfState>& states);

/// Replaces the points of a file that has a placement by what `options.numbers` asks for, as
/// doubles, and sets `data.grid`.
void place(PointData& data, const ReadOptions& options);

/// The grid on which place() will put points of this placement; empty for the world and for a
/// file's own numbers.
Grid grid_of(const Placement& placement, const ReadOptions& options);

}  // namespace cullhull::internal
