#include <vector>

#include "cullhull/error.hpp"
#include "distributed/job.hpp"
#include "flow/pipeline.hpp"
#include "flow/sample_map.hpp"
#include "geometry/gather.hpp"
#include "parallel/threads/helpers.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull::internal {
namespace {

/// Filters the points with a map made from `common`. If that map discards nothing, or there is
/// none, filters them as convex_hull does, with a map of their own: this rank's points may lie
/// outside the region of the common map.
Survivors filtered(const NumberedPoints& common, const PointView& points, const Run& run) {
  const CallScope call;
  if (common.size() > 0) {
    Array<double> rows(common.size() * common.dimension);
    const PointView corners = common.view();
    for (std::uint64_t i = 0; i < corners.count; ++i)
      load_row(corners, i, rows.data() + i * common.dimension);
    Filtered found = filter_by(inner_polytope(std::move(rows), common.dimension, run), points, run);
    if (!found.survivors.all) return std::move(found.survivors);
  }
  return run_filter(points, run).survivors;
}

/// Copies the surviving points of a block.
NumberedPoints rows_of(const mpi::Block& block, const Survivors& left) {
  NumberedPoints kept{block.points.dimension, block.points.scalar, {}, {}};
  if (left.all) {
    kept.append(block.points, 0, nullptr, block.points.count, block.first_id);
    return kept;
  }
  kept.append(block.points, left.ids, block.first_id);
  return kept;
}

}  // namespace

NumberedPoints survivors_of(const NumberedPoints& common, const mpi::Block& block,
                            const Options& options) {
  const Run run(options);
  Survivors left;
  left.all = true;
  try {
    left = filtered(common, block.points, run);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::not_finite) throw;  // refused below with its id
  }
  NumberedPoints kept = rows_of(block, left);
  refuse_not_finite(kept, run.threads);
  return kept;
}

}  // namespace cullhull::internal
