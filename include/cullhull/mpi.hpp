// Hulls of points that are distributed over the ranks of an MPI job; the points stay on their
// ranks. Part of a separate library, cullhull::mpi; see docs/clusters.md.
#pragma once

// Only the C interface, which all MPI libraries provide.
#ifndef OMPI_SKIP_MPICXX
#define OMPI_SKIP_MPICXX 1
#endif
#ifndef MPICH_SKIP_MPICXX
#define MPICH_SKIP_MPICXX 1
#endif
#include <mpi.h>

#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/stream.hpp"

#pragma GCC visibility push(default)
namespace cullhull {
namespace mpi {

inline constexpr int every_rank = -1;

// Both functions are collective: every rank of the communicator calls them, with the same `root`.
// MPI must be initialised with at least MPI_THREAD_FUNNELED; only the calling thread calls MPI, and
// it sleeps while it waits. Options are this rank's: `threads` 0 and `memory_budget` 0 mean its
// share of the machine, by the number of ranks on it; of a rank that alone computes the hull
// (`root`), all threads.
//
// An error on one rank is thrown on all of them: the Error of the lowest rank that had one, its
// message beginning "rank 3: ". The communicator remains usable. Error{io} if MPI fails and its
// error handler returns.

/// convex_hull() of the points of all ranks, with the same bits as from all points in one process
/// (except for `statistics`), on `root` or on every rank; other ranks get an empty hull. Ids count
/// through the ranks in their order. A rank without points need not know the dimension
/// (PointView{}). Errors as of convex_hull(), with global ids.
///
/// Each rank finds the extreme points of its points (HullState); these are merged up a binomial
/// tree. Bytes sent: O(extreme points of each rank * log ranks).
Hull hull(const PointView& local, MPI_Comm comm, const Options& options = {},
          int root = every_rank);

/// The state of the points of all ranks' states, whose ids are global: for points that come to a
/// rank in blocks (HullStream). Errors as of HullState::merge().
HullState merge(const HullState& local, MPI_Comm comm, const Options& options = {},
                int root = every_rank);

}  // namespace mpi
}  // namespace cullhull
#pragma GCC visibility pop
