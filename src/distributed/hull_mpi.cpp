// The collective calls: the ranks agree on the arguments, discard points with a common filter map,
// gather the survivors, and one rank computes the final hull.
#include <algorithm>
#include <string>
#include <utility>

#include "cullhull/error.hpp"
#include "cullhull/mpi.hpp"
#include "distributed/communicator.hpp"
#include "distributed/job.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull::mpi {

using namespace internal;

namespace {

std::vector<Block> blocks_of(const PointView& local) { return {Block{local, 0}}; }
std::vector<Block> blocks_of(std::span<const Block> local) { return {local.begin(), local.end()}; }

/// Runs a collective call. On the root, finish(part, options) computes the result from the
/// survivors of all ranks.
template <class Result, class Finish>
Result collective(MPI_Comm comm, std::vector<Block> blocks, bool numbered,
                  const JobOptions& options, const Finish& finish) {
  Job job(comm, options);
  job.agree(std::move(blocks), numbered);
  job.share_samples();
  Part part = job.gather_parts();
  Result result{};
  job.on_root([&] { result = finish(std::move(part), job.alone()); });
  if (job.everywhere()) broadcast(job.ranks(), job.root(), result);
  job.finish();
  return result;
}

Hull hull_of(Part&& part, const Options& options) {
  Hull hull = cullhull::convex_hull(part.points.view(), options);
  hull.rename([&](std::uint64_t place) { return part.points.ids[place]; });
  hull.point_count = part.seen;
  return hull;
}

ExtremePoints extreme_of(Part&& part, const Options& options) {
  ExtremePoints found = find_extreme(part.points.view(), options);
  for (std::uint64_t& id : found.ids) id = part.points.ids[id];
  return found;
}

}  // namespace

Hull convex_hull(MPI_Comm comm, const PointView& local, const JobOptions& options) {
  return collective<Hull>(comm, blocks_of(local), false, options, hull_of);
}
Hull convex_hull(MPI_Comm comm, std::span<const Block> local, const JobOptions& options) {
  return collective<Hull>(comm, blocks_of(local), true, options, hull_of);
}

ExtremePoints extreme_points(MPI_Comm comm, const PointView& local, const JobOptions& options) {
  return collective<ExtremePoints>(comm, blocks_of(local), false, options, extreme_of);
}
ExtremePoints extreme_points(MPI_Comm comm, std::span<const Block> local,
                             const JobOptions& options) {
  return collective<ExtremePoints>(comm, blocks_of(local), true, options, extreme_of);
}

namespace {

HullState state_of(MPI_Comm comm, std::vector<Block> blocks, bool numbered,
                   const JobOptions& options) {
  Job job(comm, options);
  job.agree(std::move(blocks), numbered);
  job.share_samples();
  Part part = job.gather_parts();
  job.on_root([&] { keep_extreme(part.points, job.alone()); });
  if (job.everywhere()) broadcast(job.ranks(), job.root(), part, [](std::uint64_t) {});
  job.finish();
  if (!job.everywhere() && !job.is_root()) return {};
  return StateParts::state(part.points, part.seen);
}

}  // namespace

HullState hull_state(MPI_Comm comm, const PointView& local, const JobOptions& options) {
  return state_of(comm, blocks_of(local), false, options);
}
HullState hull_state(MPI_Comm comm, std::span<const Block> local, const JobOptions& options) {
  return state_of(comm, blocks_of(local), true, options);
}

// ------------------------------------------------------------------------------- the filter

namespace {

/// The result of cull() for this rank's points, with ids relative to its first point.
Survivors local_survivors(const Job& job, const Part& common) {
  Survivors found;
  found.reason = "no points on this rank";
  if (job.blocks().empty()) return found;
  const Clock::time_point start = Clock::now();
  const Block& block = job.blocks()[0];
  NumberedPoints left = survivors_of(common.points, block, job.beside());
  found.all = left.size() == block.points.count;
  if (!found.all) found.ids.assign(left.ids.begin(), left.ids.end());
  for (std::uint64_t& id : found.ids) id -= block.first_id;
  if (!found.all) found.filter = UsedFilter::gauge;
  found.reason = common.points.size() == 0 ? "no map of all ranks would pay"
                                           : "a map of " + std::to_string(common.points.size()) +
                                                 " extreme points of samples of all ranks";
  found.seconds = seconds_since(start);
  return found;
}

}  // namespace

Survivors cull(MPI_Comm comm, const PointView& local, const JobOptions& options) {
  Job job(comm, options);
  job.agree(blocks_of(local), false);
  const Part& common = job.share_samples();
  Survivors found;
  job.ranks().together([&] { found = local_survivors(job, common); });
  job.finish();
  return found;
}

// ------------------------------------------------------------------------------- the certificate

Certificate certify(MPI_Comm comm, std::span<const Block> local, const Hull& hull,
                    const std::vector<double>& vertex_coordinates, const JobOptions& options) {
  Job job(comm, options);
  Communicator& ranks = job.ranks();
  job.agree(blocks_of(local), true);
  Hull copy;
  std::vector<double> rows;
  if (job.is_root()) rows = vertex_coordinates;
  // broadcast() needs a variable that it may overwrite, so the root copies the constant hull.
  job.on_root([&] { copy = hull; });
  broadcast(ranks, job.root(), copy);
  broadcast(ranks, job.root(), rows);
  std::unique_ptr<CertifyStream> stream;
  ranks.together([&] {
    stream = std::make_unique<CertifyStream>(copy, std::move(rows), job.beside());
    for (const Block& b : job.blocks()) stream->push(b.points, b.first_id);
  });
  // The ranks send their findings to the root one after another, because their lengths differ. The
  // findings of a rank without a fault are a few words long.
  Certificate result;
  for (int from = 0; from < ranks.size(); ++from) {
    if (from == job.root()) continue;
    CertifiedPart part;
    if (ranks.rank() == from) {
      part = stream->part();
      std::uint64_t head[] = {part.points, part.vertices, part.exact_decisions, part.at,
                              part.reason.size()};
      ranks.send(head, sizeof head, job.root());
      ranks.send(part.reason.data(), part.reason.size(), job.root());
    } else if (job.is_root()) {
      std::uint64_t head[5];
      ranks.receive(head, sizeof head, from);
      part.reason.resize(head[4]);
      ranks.receive(part.reason.data(), head[4], from);
      part.points = head[0];
      part.vertices = head[1];
      part.exact_decisions = head[2];
      part.at = head[3];
      stream->add(part);
    }
  }
  job.on_root([&] { result = stream->finish(); });
  std::uint64_t words[] = {result.valid, result.ridges_checked, result.points_checked,
                           result.exact_decisions, result.reason.size()};
  ranks.broadcast(words, sizeof words, job.root());
  result.reason.resize(words[4]);
  ranks.broadcast(result.reason.data(), words[4], job.root());
  result.valid = words[0] != 0;
  result.ridges_checked = words[1];
  result.points_checked = words[2];
  result.exact_decisions = words[3];
  job.finish();
  return result;
}

}  // namespace cullhull::mpi
