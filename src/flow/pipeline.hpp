// The steps of the flow, which its drivers share: the filter, what an engine is given, and the
// hull of the survivors.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/hull.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "hull/engine.hpp"
#include "hull/plane/polygon.hpp"
#include "hull/space/triangle_mesh.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline flow {

// The filter stage of the pipeline: a sample's exact hull becomes the map that culls the rest.

/// The survivors of an input, with their coordinates where those have been gathered.
struct Filtered {
  Survivors survivors;
  Array<double> rows;                ///< packed rows of the survivors; empty: not gathered yet
  std::uint64_t pass_survivors = 0;  ///< how many the pass over the whole input left
};

/// Up to so many points in space the filter is a map of the outermost points, which takes little
/// more than a pass. With more points a larger sample and a finer map pay.
inline constexpr std::uint64_t most_by_outermost = 1 << 16;

/// Runs the filter the options ask for. Points that are not finite always survive, so that
/// gathering the survivors reports them; `rows` has been checked. A sample whose hull would exceed
/// the budget gives no map; survivors that exceed it are Error{out_of_budget}.
Filtered run_filter(const PointView& points, const Run& run);

/// One filter each, which run_filter chooses among. The paper's two levels: the subsets'
/// pseudo-hulls, then one of all their survivors.
Filtered run_pseudo_hull(const PointView& points, const Run& run);
/// A map of the outermost points, for some thousand points in space; false where it would not pay.
bool cull_by_outermost(const PointView& points, const Run& run, Filtered& result);
/// The map of a sample's hull, and a second one of what it leaves. Keeps all where it would not
/// pay.
void filter_by_sample(const PointView& points, const Run& run, Filtered& result);

/// The same by the map of a given polytope, whose vertices are points of a larger set: a dropped
/// point lies strictly inside it. Keeps all points where there is no map.
Filtered filter_by(InnerPolytope polytope, const PointView& points, const Run& run);

/// The rows of the survivors, which have been gathered.
inline PointView view_of_rows(const Filtered& result, unsigned d) {
  return PointView::row_major(result.rows.data(), result.survivors.ids.size(), d);
}

/// Why the gauge map is not tried; empty if it is.
std::string why_no_filter(CullMethod method, std::uint64_t count, unsigned d);

/// Culls the survivors of a first map, whose rows have been gathered, by a second map if it pays.
void refine_survivors(Filtered& result, unsigned d, const Run& run);

/// Gathers the coordinates of the survivors of a first pass unless that was done. Throws
/// Error{not_finite} for the first bad point.
void gather_survivors(const PointView& points, Filtered& result, const Run& run);

/// Keeps of the survivors those at the given positions. `rows`: their rows, where gathered.
void keep_of_survivors(Filtered& result, unsigned d, const std::vector<std::uint64_t>& kept,
                       Array<double>&& rows = {});

// The filter stage for points in a device's memory: what run_filter does, transferring only samples
// and survivors.

/// As run_filter, but `rows` always holds the exact coordinates of the survivors (of all points
/// where `all`). Throws Error{not_finite} naming the lowest id with a NaN or an infinity,
/// Error{backend_unavailable} where there is no device or the view is not in its memory.
Filtered run_device_filter(const DevicePointView& points, const Run& run);

/// Throws Error{invalid_argument} for null data, no dimension, or a scalar other than f32 and f64.
void check_arguments(const DevicePointView& points);

/// The hull of the survivors of run_device_filter, with the ids of `points` (of which only count,
/// dimension and scalar are read). Fills the statistics except the times of the filter and of the
/// whole.
Hull hull_of_rows(const Filtered& filtered, const DevicePointView& points, const Options& options);

// From the survivors of a filter to the input of an engine.

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

/// Throws Error for null data, no dimension, a backend or an engine missing from this build.
void check_arguments(const PointView& points, const Options& options);
/// The check of the engine alone.
void check_engine(const Options& options);

/// Runs the filter, and sets run.threads to the number that pays for the hull of the survivors.
Filtered filter_and_plan(const PointView& points, Run& run);

/// Whether few points are hulled directly or by frame and engine; both give the same bits.
enum class Few { at_once, by_engine };

/// A hull of the same points at other places, whose triangles are tried before an engine is.
struct KnownHull {
  const Hull* hull = nullptr;              ///< none
  const NearbyNumbers* numbers = nullptr;  ///< of it; or none
  bool tried = false, holds = false;
};

/// The hull of what a filter kept of `points`: thins lattices; frame, engine, result. Fills the
/// statistics except the times of the filter and of the whole. `known` is tried where it has the
/// survivors as vertices; the result is the same, bit for bit.
Hull hull_of_survivors(const PointView& points, Filtered&& filtered, const Run& run,
                       Few few = Few::at_once, KnownHull* known = nullptr);

}  // namespace cullhull::internal::inline flow
