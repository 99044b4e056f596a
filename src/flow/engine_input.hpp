// From the survivors of a filter to the input of an engine.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/array.hpp"
#include "flow/filter_stage.hpp"
#include "hull/engine.hpp"
#include "hull/plane/polygon.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline flow {

/// The points the engine works on: survivors, thinned once more where they lie on a lattice.
struct EngineInput {
  std::vector<std::uint64_t> ids;  // empty and `all`: every point of the view
  bool all = false;
  Array<double> rows;
  std::uint64_t count = 0;
};

/// Gathers the coordinates that `filtered` lacks. Throws Error{not_finite} for the first bad point,
/// Error{out_of_budget}.
EngineInput engine_input(const PointView& points, Filtered&& filtered, const Run& run);

/// The hull of points on a line: the two ends.
Boundary ends_of_line(const LocalPoints& points);

/// The survivors of points of the plane: they need no frame, and are hulled in the caller's memory.
struct PlanarRows {
  PlanarRows(const PointView& points, const Filtered& filtered)
      : rows(filtered.survivors.all
                 ? points
                 : PointView::row_major(filtered.rows.data(), filtered.survivors.ids.size(), 2)),
        ids(filtered.survivors.all ? nullptr : filtered.survivors.ids.data()) {}

  /// Throws Error{not_finite} for the first bad point, Error{out_of_budget}.
  Polygon hull(const Run& run) const;

  PointView rows;
  const std::uint64_t* ids;
};

}  // namespace cullhull::internal::inline flow
