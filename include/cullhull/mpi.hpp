// Hulls of points that are distributed over the ranks of an MPI job; the points stay on their
// ranks. Part of a separate library, cullhull::mpi; see docs/mpi.md.
#pragma once

// Only the C interface, which all MPI libraries provide.
#ifndef OMPI_SKIP_MPICXX
#define OMPI_SKIP_MPICXX 1
#endif
#ifndef MPICH_SKIP_MPICXX
#define MPICH_SKIP_MPICXX 1
#endif
#include <mpi.h>

#include <cstdint>
#include <optional>
#include <span>

#include "cullhull/certify.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/stream.hpp"

#pragma GCC visibility push(default)
namespace cullhull {
namespace mpi {

/// Cost of a call; the same on every rank, except for `seconds`.
struct Report {
  int ranks = 0;
  std::uint64_t points = 0;       ///< of all ranks
  std::uint64_t sampled = 0;      ///< points sampled on all ranks for the common filter
  std::uint64_t common = 0;       ///< their extreme points, sent to every rank; 0: no filter
  std::uint64_t contributed = 0;  ///< points sent by their ranks as possibly extreme
  std::uint64_t messages = 0;     ///< sent by all ranks, including parts of collective calls
  std::uint64_t bytes = 0;        ///< bytes in these messages
  double work_seconds = 0;        ///< processor seconds of all ranks, without waiting for messages
  double greatest_work_seconds = 0;  ///< of the rank with the most work
  double seconds = 0;                ///< elapsed time
};

inline constexpr int every_rank = -1;

/// How the ranks work together. `root` must be the same on all of them.
struct JobOptions {
  /// Options of this rank's work. `threads` 0: its share of the machine, and all of the machine for
  /// the final hull, while the other ranks wait. `memory_budget` 0: its share of the default of a
  /// single call. `stop`, `poll` and `progress` may be set on any rank; a stop on one rank ends the
  /// call on all.
  Options run{};
  /// The rank that computes the final hull and gets the result; others get an empty one.
  /// every_rank: rank 0 computes it and sends it to all.
  int root = every_rank;
  /// Id of this rank's first point, set on all ranks or on none. Not set: ids count through the
  /// ranks in rank order.
  std::optional<std::uint64_t> first_id{};
  /// Receives the report, if not null.
  Report* report = nullptr;
};

/// Points with the ids first_id, first_id + 1, ...
struct Block {
  PointView points;
  std::uint64_t first_id = 0;
};

// All functions are collective: every rank of the communicator calls them with its own points:
// none, one or many. A rank without points need not know the dimension (PointView{}). The first
// call on a communicator duplicates it, so that the library's messages do not mix with the
// caller's, and keeps the duplicate as an attribute until the communicator is freed. MPI must be
// initialised with at least MPI_THREAD_FUNNELED, as a call starts threads; only the calling thread
// calls MPI, and it sleeps while it waits.
//
// An error on one rank is thrown on all of them: the Error of the lowest rank that had one, its
// message beginning "rank 3: ", with the global id of a point that is not finite. Errors as of the
// functions of the same names; besides, Error{invalid_argument} if dimension or root differ, and
// Error{io} if MPI fails and its error handler returns.

/// convex_hull() of the points of all ranks: the same bits as from all points in one process,
/// except for `statistics`, which describe the final hull.
///
/// Each rank computes the hull of a sample of its points; the hull of all samples filters every
/// rank's points; each rank finds the extreme points of its survivors, which are merged up a
/// binomial tree. Bytes sent: O(extreme points of each rank * log ranks); memory of a rank: O(its
/// extreme points and those of the ranks below it in the tree).
Hull convex_hull(MPI_Comm comm, const PointView& local, const JobOptions& options = {});
/// The same for blocks with their own ids; each id is on one rank. options.first_id is ignored.
Hull convex_hull(MPI_Comm comm, std::span<const Block> local, const JobOptions& options = {});

/// extreme_points() of the points of all ranks.
ExtremePoints extreme_points(MPI_Comm comm, const PointView& local, const JobOptions& options = {});
ExtremePoints extreme_points(MPI_Comm comm, std::span<const Block> local,
                             const JobOptions& options = {});

/// The HullState of the points of all ranks.
HullState hull_state(MPI_Comm comm, const PointView& local, const JobOptions& options = {});
HullState hull_state(MPI_Comm comm, std::span<const Block> local, const JobOptions& options = {});

/// The filter alone: the indices in `local` of the points that may be extreme points of all ranks'
/// points. All extreme points are among them, and all their duplicates on any rank. Only
/// coordinates of samples are sent; `root` and `first_id` are used for ids in errors.
Survivors cull(MPI_Comm comm, const PointView& local, const JobOptions& options = {});

/// certify() where each rank checks its own points: valid on all ranks or on none. The rank `root`
/// (every_rank: rank 0) provides `hull` and its `vertex_coordinates` (a row for each of
/// hull.vertices, in that order), and sends them to the others.
Certificate certify(MPI_Comm comm, std::span<const Block> local, const Hull& hull,
                    const std::vector<double>& vertex_coordinates, const JobOptions& options = {});

}  // namespace mpi
}  // namespace cullhull
#pragma GCC visibility pop
