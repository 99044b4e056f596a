// The steps of the flow that its drivers share: the filter, the engine's input, and the hull of the
// survivors.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/device_hull.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/hull_fwd.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "geometry/local_frame.hpp"
#include "hull/engine.hpp"
#include "hull/plane/polygon.hpp"
#include "hull/space/triangle_mesh.hpp"
#include "result/write/triangle_lists.hpp"

namespace cullhull::internal {

// The filter stage of the pipeline: the exact hull of a sample becomes the map that culls the rest.

struct LastSurface;

/// The survivors of an input, with their coordinates if those have been gathered.
struct Filtered {
  Survivors survivors;
  Array<double> rows;                   ///< packed rows of the survivors; empty: not gathered yet
  std::uint64_t pass_survivors = 0;     ///< number of survivors of the pass over the whole input
  std::shared_ptr<const GaugeMap> map;  ///< that left them, or none
  TriangleLists triangles;              ///< the survivors' hull, of which all are vertices, or none
  bool moved = false;                   ///< found from the surface of the last frame
  bool on_host = false;  ///< points of a device that the CPU is to filter: `rows` are all of them
};

/// Runs the filter that the options ask for. Points with a NaN or an infinity always survive, so
/// that gathering the survivors reports them; `rows`, if present, has been checked. If a sample's
/// hull would exceed the budget, there is no map; if the survivors exceed it, throws
/// Error{out_of_budget}.
Filtered run_filter(const PointView& points, const Run& run);

/// run_filter chooses among the following filters. This is the paper's, in two levels: the
/// pseudo-hulls of subsets, then one of all their survivors.
Filtered run_pseudo_hull(const PointView& points, const Run& run);
/// Filters some thousand 3D points by a map of the outermost; returns false if not worthwhile.
bool cull_by_outermost(const PointView& points, const Run& run, Filtered& result);
/// Filters by the map of a sample's hull, then by a second map of the survivors. Keeps all points
/// if a map is not worthwhile.
void filter_by_sample(const PointView& points, const Run& run, Filtered& result);

/// Views the rows of the survivors, which must have been gathered.
inline PointView view_of_rows(const Filtered& result, unsigned d) {
  return PointView::row_major(result.rows.data(), result.rows.size() / d, d);
}

/// Culls the survivors of a first map, whose rows must have been gathered, by a second map if that
/// is worthwhile.
void refine_survivors(Filtered& result, unsigned d, const Run& run);

/// Gathers the coordinates of a first pass's survivors `ids`, if that is still to be done. Throws
/// Error{not_finite} for the first bad point.
void gather_survivors(const PointView& points, std::span<const std::uint64_t> ids, Filtered& result,
                      const Run& run);

/// Keeps only the survivors at the given positions.
void keep_of_survivors(Filtered& result, unsigned d, std::span<const std::uint64_t> kept);

// The filter stage for points in a device's memory: like run_filter, but only samples and survivors
// are transferred.

struct DeviceRequest {
  bool hull = true;             ///< whether the hull is wanted, where the filter finds it
  bool rows = true;             ///< whether the host has not the rows of a hull that it finds
  DeviceHull* there = nullptr;  ///< where the lists of that hull are left, without rows and ids
  std::shared_ptr<LastSurface>* last = nullptr;  ///< a tracker's: the surface of its last frame
};

/// Like run_filter, but `rows` always holds the exact coordinates of the survivors (of all points
/// if `all`), and `triangles` their hull where that is asked for and the filter finds it; what is
/// the CPU's to filter is only copied (`on_host`). Throws Error{not_finite} with the lowest id of a
/// point with a NaN or an infinity, Error{backend_unavailable} if there is no device or the view is
/// not in its memory.
Filtered run_device_filter(const DevicePointView& points, const Run& run,
                           const DeviceRequest& request = {});
/// A copy of a hull's lists in the memory of the device that holds the points.
DeviceHull copied_to_device(const Hull& hull, const DevicePointView& points,
                            const Options& options);

/// Filters points of the host on the device that the options name, to which it copies them: by the
/// map and a second filter or, without a map, by the surface of all. Where the device has not the
/// memory, in pieces. Sets survivors without rows, and triangles; `where`: why on the device.
/// Throws OutOfMemory, Failure, Error{not_finite} for any bad point.
void filter_there(const PointView& points, const GaugeMap* map, const std::string& where,
                  const Run& run, Filtered& result);

/// Throws Error{invalid_argument} for null data, no dimension, or a scalar other than f32 and f64.
void check_arguments(const DevicePointView& points);

/// Returns the hull of the survivors of run_device_filter, with the ids of `points` (of which only
/// count, dimension and scalar are read). Fills the statistics except the filter's time and the
/// total time.
Hull hull_of_rows(Filtered&& filtered, const DevicePointView& points, const Options& options);

/// The hull that a filter on a device found; `rows`: its vertices, the survivors of `count` points.
Hull hull_of_lists(Filtered&& filtered, const PointView& rows, std::uint64_t count, const Run& run);
/// What the statistics tell of it, but for times.
void tell_found(const Survivors& s, std::uint64_t vertices, unsigned threads, Statistics& to);

// From the survivors of a filter to the input of an engine.

/// The points that the engine gets: the survivors, thinned once more if they lie on a lattice.
struct EngineInput {
  std::vector<std::uint64_t> ids;  // empty if `all`: every point of the view
  bool all = false;
  Array<double> rows;
  std::uint64_t count = 0;
};

/// Gathers the coordinates that `filtered` lacks. Throws Error{not_finite} for the first bad point,
/// Error{out_of_budget}.
EngineInput engine_input(const PointView& points, Filtered&& filtered, const Run& run);

/// Finds the frame of an engine's input. Points in a flat, which no filter of their own dimension
/// thins, are filtered in the flat's: `input` is then what this leaves.
void find_frame(const PointView& points, EngineInput& input, const Run& run,
                std::optional<LocalFrame>& frame);

/// Returns the hull of points on a line: its two ends.
Boundary ends_of_line(const LocalPoints& points);

/// The survivors of 2D points: they need no frame and are hulled in the caller's memory.
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

/// Throws Error for null data, no dimension, or a backend that this build lacks.
void check_arguments(const PointView& points, const Options& options);

/// Runs the filter, and sets run.threads to the number worthwhile for the hull of the survivors.
Filtered filter_and_plan(const PointView& points, Run& run);

/// A hull of the same points at other positions: its triangles are tried before an engine is.
struct KnownHull {
  const Hull* hull = nullptr;              ///< null: no known hull
  const NearbyNumbers* numbers = nullptr;  ///< of `hull`; may be null
  bool tried = false, holds = false, mended = false;
};

/// Returns the hull of the points of `points` that a filter kept: thins lattices, then computes
/// frame, engine and result. Where no filter ran, the caller has tried small_hull(). Fills the
/// statistics except the filter's time and the total time. Triangles that the filter found are
/// tried first, or those of `known` if its vertices are among the survivors; the result is the
/// same, bit for bit.
Hull hull_of_survivors(const PointView& points, Filtered&& filtered, const Run& run,
                       KnownHull* known = nullptr);

}  // namespace cullhull::internal
