#include <algorithm>
#include <string>
#include <utility>

#include "cullhull/error.hpp"
#include "filter/lattice/lattice_cull.hpp"
#include "filter/ways.hpp"
#include "flow/pipeline.hpp"
#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

void thin_lattice(EngineInput& input, unsigned d, const Run& run) {
  std::vector<std::uint32_t> kept;
  if (plane_only || !takes(Way::lattice, {.dimension = d, .count = input.count, .left = true}) ||
      !lattice_cull(input.rows, static_cast<std::uint32_t>(input.count), d, run, kept) ||
      kept.size() == input.count)
    return;
  Array<double> rows(kept.size() * d);
  std::vector<std::uint64_t> ids(kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    std::copy_n(input.rows.data() + std::size_t{kept[i]} * d, d, rows.data() + i * d);
    ids[i] = input.all ? kept[i] : input.ids[kept[i]];
  }
  input.rows = std::move(rows);
  input.ids = std::move(ids);
  input.all = false;
  input.count = kept.size();
}

void require_engine_room(std::uint64_t count, unsigned dimension, const Run& run) {
  if (count > most_of_engine)
    throw Error(ErrorCode::out_of_budget, count,
                " points survive the filter; an engine takes 2^32 - 2");
  // Bytes needed: coordinates, a copy in the engine's order, and keys with ids to sort them by.
  // Half as much again is reserved for facets: an engine uses at most a third of its budget for
  // them before it refuses.
  require_budget(run.budget, count * (2 * dimension * sizeof(double) + 24) / 2 * 3,
                 std::to_string(count) + " points that survive the filter");
}

}  // namespace

EngineInput engine_input(const PointView& points, Filtered&& filtered, const Run& run) {
  EngineInput input;
  input.all = filtered.survivors.all;
  input.count = filtered.survivors.size(points.count);
  require_engine_room(input.count, points.dimension, run);
  input.rows = std::move(filtered.rows);
  if (input.rows.empty())
    input.rows = gather_points(points, input.all ? nullptr : filtered.survivors.ids.data(),
                               input.count, run);
  input.ids = std::move(filtered.survivors.ids);
  thin_lattice(input, points.dimension, run);
  return input;
}

void find_frame(const PointView& points, EngineInput& input, const Run& run,
                std::optional<LocalFrame>& frame) {
  const auto make = [&] {
    frame.emplace(std::move(input.rows), static_cast<std::uint32_t>(input.count), points.dimension,
                  run);
  };
  make();
  if (frame->affine_dimension() < 2) return;
  const auto k = static_cast<unsigned>(frame->affine_dimension());
  if (k == points.dimension) return;
  const std::vector<std::uint64_t> kept =
      run_filter(PointView::row_major(frame->points().exact, input.count, k), run).survivors.ids;
  if (kept.empty()) return;  // all
  std::vector<std::uint64_t> ids(kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) ids[i] = input.all ? kept[i] : input.ids[kept[i]];
  input.ids = std::move(ids);
  input.all = false;
  input.count = kept.size();
  input.rows = gather_points(points, input.ids.data(), input.count, run);
  make();
}

Boundary ends_of_line(const LocalPoints& points) {
  std::uint32_t low = 0, high = 0;
  for (std::uint32_t i = 1; i < points.count; ++i) {
    if (points.exact_row(i)[0] < points.exact_row(low)[0]) low = i;
    if (points.exact_row(i)[0] > points.exact_row(high)[0]) high = i;
  }
  Boundary ends;
  ends.dimension = 1;
  ends.vertices = {low, high};
  ends.neighbours = {1, 0};
  return ends;
}

Polygon PlanarRows::hull(const Run& run) const {
  require_engine_room(rows.count, 2, run);
  // A filter's survivors have been checked for being finite.
  return ids != nullptr ? polygon_by_sample(rows, false, run) : polygon_of(rows, false, run);
}

}  // namespace cullhull::internal
