#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cuda/device_rows.hpp"
#include "cuda/kernels/device_subset.hpp"
#include "cuda/kernels/executor.cuh"
#include "cuda/kernels/star_hull.hpp"
#include "cullhull/error.hpp"
#include "hull/engine.hpp"
#include "parallel/memory/memory.hpp"
#include "result/write/star_result.hpp"

namespace cullhull::internal {
namespace {

template <class T>
using StarHullOf = StarHull<CudaExecutor, RowsInPlace<3, T>>;

template <class T>
struct LastSurfaceOf final : LastSurface {
  StarHullOf<T> hull{CudaExecutor(stream.get())};
};

/// Writes the hull where it is wanted, if doubles decided it. What reads the points is done then.
template <class T>
void write_result(StarHullOf<T>& hull, const RowsInPlace<3, T>& rows, const Run& run,
                  const StarRequest& request, StarHullThere& there) {
  const auto result = std::make_shared<StarResult<CudaExecutor, RowsInPlace<3, T>>>();
  if (!result->compute(hull, rows, static_cast<std::uint32_t>(rows.subset.total), there.counts))
    return;
  if (request.rows) require_room_for_survivors(there.counts.left, 3, run);
  require_budget(run.budget, there.counts.end.facets * result_bytes_per_facet(3, 3),
                 std::to_string(there.counts.end.facets) + " facets");
  const auto fetch = [&](StarWanted wanted) {
    std::optional<StarLists> lists = result->fetch(hull.executor(), run, wanted);
    if (lists) there.lists = std::move(*lists);
    return lists.has_value();
  };
  Hull measured;
  if (request.place == HullPlace::device) {
    if (!fetch(StarWanted::sums)) return;
    if (write_measures(there.lists.triangles, measured)) {
      there.vertices = result->vertices();
      there.neighbours = result->neighbours();
      there.planes = result->planes();
      there.left = result;
      return;
    }
  }
  fetch(request.rows ? StarWanted::vertices : StarWanted::triangles);
}

template <class T>
StarHullThere star_hull_of(const DevicePointView& points, const Run& run,
                           const StarRequest& request, StarHullOf<T>& hull) {
  std::vector<PseudoHullRound> unread;
  // Points in a ball take 15 rounds, points on a sphere 18 to 22.
  constexpr unsigned most_rounds = 64;
  const PseudoSubset all{points.count, 0, 1};
  const auto count = static_cast<std::uint32_t>(points.count);
  StarHullThere there;
  const auto rows = rows_in_place<3, T>(as_point_view(points), all);
  there.counts = hull.run(rows, count, most_rounds, run.control,
                          request.rounds != nullptr ? *request.rounds : unread, request.begin);
  there.ids.count = there.counts.left;
  there.ids.ids = DeviceArray<std::uint64_t>(there.ids.count, hull.executor().stream());
  const CudaExecutor::Count listed =
      hull.executor().select(count, NotCulled{hull.culled()}, EmitId{all, there.ids.ids.data()});
  hull.executor().send_counts();
  try {
    if (request.place != HullPlace::nowhere) write_result(hull, rows, run, request, there);
  } catch (const OutOfMemory&) {
    const Settled settled(hull.executor().stream());  // what was begun reads the points
    there.lists = {};                                 // what is left is hulled on the host
  }
  if (listed != there.counts.left)
    throw Error(ErrorCode::internal, "the device lost count of the survivors");
  return there;
}

template <class T>
StarHullThere star_hull_after(const DevicePointView& points, const Run& run,
                              const StarRequest& request) {
  if (request.last == nullptr) {
    StarHullOf<T> hull(CudaExecutor(static_cast<cudaStream_t>(points.stream)));
    return star_hull_of<T>(points, run, request, hull);
  }
  // Taken away first: an error leaves none.
  std::shared_ptr<LastSurface> surface = std::move(*request.last);
  const int device = this_device().ordinal;
  if (surface == nullptr || surface->device != device || surface->scalar != points.scalar) {
    surface = {new LastSurfaceOf<T>, [device](LastSurface* last) {
                 std::optional<DeviceScope> scope;  // of the memory that is freed
                 try {
                   scope.emplace(device, Unread::ignored);
                 } catch (const Error&) {
                   // The context is lost, and its memory with it.
                 }
                 delete last;
               }};
    surface->device = device;
    surface->scalar = points.scalar;
  }
  StarHullOf<T>& hull = static_cast<LastSurfaceOf<T>&>(*surface).hull;
  run_after(surface->stream.get(), static_cast<cudaStream_t>(points.stream));
  StarHullThere there;
  try {
    there = star_hull_of<T>(points, run, request, hull);
  } catch (...) {
    const Settled settled(surface->stream.get());  // what was begun reads the points
    throw;
  }
  surface->kept = false;
  try {
    if (there.counts.whole()) hull.keep(there.counts);
    surface->kept = there.counts.whole();
  } catch (const OutOfMemory&) {
    // The next frame begins anew.
  }
  *request.last = std::move(surface);  // in any case: the ids are freed on its stream
  return there;
}

}  // namespace

void name_corners(const std::uint32_t* corners, const DeviceIds& ids, std::uint32_t count,
                  std::int64_t* named, cudaStream_t stream) {
  CudaExecutor(stream).for_each(count, NameCorner{corners, ids.ids.data(), named});
}

StarHullThere star_hull_there(const DevicePointView& points, const Run& run,
                              const StarRequest& request) {
  if (points.dimension != 3 || points.count > pseudo_hull_most_points)
    throw Error(ErrorCode::invalid_argument,
                "a star-shaped surface needs points in space, 2^28 at most");
  return points.scalar == ScalarType::f32 ? star_hull_after<float>(points, run, request)
                                          : star_hull_after<double>(points, run, request);
}

}  // namespace cullhull::internal
