// Hulls of points that are distributed over the ranks of an MPI job; points stay on their ranks. A
// library of its own, cullhull::mpi; docs/mpi.md.
#pragma once

// The C interface alone, which all MPI libraries share.
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
namespace cullhull::inline v1 {
namespace mpi {

/// What a call cost; the same on every rank, but for `seconds`.
struct Report {
  int ranks = 0;
  std::uint64_t points = 0;       ///< of all ranks
  std::uint64_t sampled = 0;      ///< points of the samples behind the common map
  std::uint64_t common = 0;       ///< their extreme points, which every rank was sent; 0: no map
  std::uint64_t contributed = 0;  ///< points that left their ranks as perhaps extreme
  std::uint64_t messages = 0;     ///< sent by all ranks, parts of collective calls included
  std::uint64_t bytes = 0;        ///< in them
  double work_seconds = 0;        ///< processor seconds of all ranks, waiting for messages left out
  double greatest_work_seconds = 0;  ///< of the rank that had the most
  double seconds = 0;                ///< on the clock
};

inline constexpr int every_rank = -1;

/// How the ranks work together. `root` is to be the same on all of them.
struct JobOptions {
  /// Of this rank's work. `threads` 0: its share of the machine, and all of it for the last hull,
  /// while the other ranks wait. `memory_budget` 0: its share of a single call's default. `stop`,
  /// `poll`, `progress` may be set on any rank; a rank that is stopped ends the call on all.
  Options run;
  /// The rank that computes the last hull and gets the result; others get an empty one. every_rank:
  /// rank 0 computes it and sends it to all.
  int root = every_rank;
  /// Id of this rank's first point: given on all ranks or on none. On none: ids are numbered on
  /// from rank to rank.
  std::optional<std::uint64_t> first_id;
  /// Filled in where given.
  Report* report = nullptr;
};

/// Points with the ids first_id, first_id + 1, ...
struct Block {
  PointView points;
  std::uint64_t first_id = 0;
};

// All functions are collective: every rank of the communicator calls them, with its own points:
// none, one or many. A rank without points need not know the dimension (PointView{}). The
// communicator is duplicated at its first call, so that messages of the caller do not mix with its
// own, and the duplicate kept with it (an attribute) until it is freed. MPI has to be initialised
// with MPI_THREAD_FUNNELED at least, as a call starts threads; only the calling thread calls MPI,
// and it sleeps while it waits.
//
// An error on one rank is thrown on all of them: the same Error, beginning "rank 3: ", of the
// lowest rank that had one, with the global id of a point that is not finite. Errors as of the
// functions of the same names; besides, Error{invalid_argument} where dimension or root differ, and
// Error{io} where MPI fails and its error handler returns.

/// convex_hull() of the points of all ranks: the same bits as that of all of them in one process
/// but for `statistics`, which describe the last hull.
///
/// Each rank hulls a sample of its points; their common hull filters every rank's points; each rank
/// finds the extreme points of its survivors, and these are merged up a binomial tree. Bytes sent
/// are O(extreme points of each rank * log ranks); a rank's memory is O(its extreme points and
/// those of the ranks below it in the tree).
Hull convex_hull(MPI_Comm comm, const PointView& local, const JobOptions& options = {});
/// Of blocks that name their ids, each id on one rank; options.first_id is ignored.
Hull convex_hull(MPI_Comm comm, std::span<const Block> local, const JobOptions& options = {});

/// extreme_points() of the points of all ranks.
ExtremePoints extreme_points(MPI_Comm comm, const PointView& local, const JobOptions& options = {});
ExtremePoints extreme_points(MPI_Comm comm, std::span<const Block> local,
                             const JobOptions& options = {});

/// HullState of the points of all ranks.
HullState hull_state(MPI_Comm comm, const PointView& local, const JobOptions& options = {});
HullState hull_state(MPI_Comm comm, std::span<const Block> local, const JobOptions& options = {});

/// The filter alone: the indices in `local` of those of a rank's points that may be extreme points
/// of the whole. All extreme points, and all their duplicates on any rank, are among them. No
/// coordinates but those of the samples are sent; `root` and `first_id` are used for ids in errors.
Survivors cull(MPI_Comm comm, const PointView& local, const JobOptions& options = {});

/// certify() where each rank checks its own points: valid on all ranks or on none. `hull` and its
/// `vertex_coordinates` (a row for each of hull.vertices, in that order) are needed on the rank
/// `root` (every_rank: on rank 0), which sends them to the others.
Certificate certify(MPI_Comm comm, std::span<const Block> local, const Hull& hull,
                    const std::vector<double>& vertex_coordinates, const JobOptions& options = {});

}  // namespace mpi
}  // namespace cullhull::inline v1
#pragma GCC visibility pop
