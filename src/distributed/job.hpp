// One collective call: the ranks agree on the arguments, share a filter map, filter their points,
// gather the survivors, and fill in the report.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/mpi.hpp"
#include "distributed/communicator.hpp"
#include "distributed/parts.hpp"
#include "parallel/threads/parallel.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull::internal {

/// The state of one collective call on one rank.
class Job {
 public:
  /// Refers to the options, which must outlive it. The constructor and the functions that
  /// communicate (agree, share_samples, gather_parts, on_root, finish) are collective.
  Job(MPI_Comm comm, const mpi::JobOptions& options);

  /// Checks the arguments of all ranks and agrees on dimension, scalar type, root and ids.
  /// `blocks`: this rank's points. `numbered`: each block has ids of its own; otherwise a rank's
  /// ids continue those of the ranks below. Throws on all ranks if an argument is invalid on any.
  void agree(std::vector<mpi::Block> blocks, bool numbered);

  std::uint32_t dimension() const { return dimension_; }
  std::uint64_t point_count() const { return total_; }
  const std::vector<mpi::Block>& blocks() const { return blocks_; }
  /// The rank that computes the final hull.
  int root() const { return options_.root == mpi::every_rank ? 0 : options_.root; }
  bool is_root() const { return ranks_.rank() == root(); }
  /// Whether every rank receives the result.
  bool everywhere() const { return options_.root == mpi::every_rank; }
  Communicator& ranks() { return ranks_; }
  /// Options for work that all ranks of a machine do at the same time: their threads and memory
  /// budget are this rank's share of the machine, unless the caller has set them.
  const Options& beside() const { return beside_; }
  /// Options for work that one rank does while the others wait.
  const Options& alone() const { return alone_; }

  /// Takes a sample of all ranks' points and returns its extreme points, the same on every rank,
  /// for the filter map. Empty if a map would not be worthwhile.
  const Part& share_samples();
  /// Filters this rank's points and gathers the survivors of all ranks on the root, sorted by id.
  /// The root's part may contain points that are not extreme; it is empty on other ranks.
  Part gather_parts();
  /// Runs `work` on the root alone. If it throws, all ranks throw.
  template <class Work>
  void on_root(const Work& work) {
    ranks_.together([&] {
      if (is_root()) work();
    });
  }
  /// Adds up the ranks' statistics and fills in the caller's report.
  void finish();

 private:
  Part local_sample();
  Part local_part() const;
  void check_local(bool numbered) const;
  void agree_on_points();
  NumberedPoints sampled(std::uint64_t size) const;
  void reduce(Part& part) const;
  void check_room(std::uint64_t bytes) const;

  Clock::time_point start_ = Clock::now();
  double work_before_ = process_work();
  const mpi::JobOptions& options_;
  Communicator ranks_;
  Options beside_, alone_;
  std::uint64_t budget_;
  std::vector<mpi::Block> blocks_;
  std::uint32_t dimension_ = 0;
  ScalarType scalar_ = ScalarType::f64;
  std::uint64_t local_ = 0, total_ = 0;
  Part common_;
  mpi::Report report_;
};

// The filter of one rank.

/// Discards the points of a block that are provably strictly inside the hull of `common` (points of
/// all ranks) or, if that discards nothing, of the block's own points, and returns the others.
/// Throws Error{not_finite}, which names the first point that is not finite by its id.
NumberedPoints survivors_of(const NumberedPoints& common, const mpi::Block& block,
                            const Options& options);

}  // namespace cullhull::internal
