// One collective call: the agreement of the ranks, the common map and its filter, this rank's part,
// and the report.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/mpi.hpp"
#include "distributed/communicator.hpp"
#include "distributed/parts.hpp"
#include "parallel/threads/parallel.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull::internal::inline distributed {

class Job {
 public:
  /// Collective, as all functions below. Views the options.
  Job(MPI_Comm comm, const mpi::JobOptions& options);

  /// Agrees on dimension, scalar type, root and ids. `blocks` are this rank's; `numbered`: they
  /// name their ids, else ids continue from those of the ranks below.
  void agree(std::vector<mpi::Block> blocks, bool numbered);

  std::uint32_t dimension() const { return dimension_; }
  std::uint64_t point_count() const { return total_; }
  const std::vector<mpi::Block>& blocks() const { return blocks_; }
  /// The rank that computes the last hull.
  int root() const { return options_.root == mpi::every_rank ? 0 : options_.root; }
  bool is_root() const { return ranks_.rank() == root(); }
  bool everywhere() const { return options_.root == mpi::every_rank; }
  Communicator& ranks() { return ranks_; }
  /// Options for work that all ranks of a machine do at once, and for work that the others wait
  /// for.
  const Options& beside() const { return beside_; }
  const Options& alone() const { return alone_; }

  /// Exchanges samples and returns their extreme points; none where no map would pay.
  const Part& share_samples();
  /// Gathers on the root the points that all ranks contribute, sorted by id, not reduced.
  Part gather_parts();
  /// Runs `work` on the root alone; where it throws, all ranks throw.
  template <class Work>
  void on_root(const Work& work) {
    ranks_.together([&] {
      if (is_root()) work();
    });
  }
  /// Fills in the report.
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

/// The points of a block that are not provably strictly inside the hull of `common` (points of all
/// ranks) or of the block itself. Error{not_finite} names the first bad point by its id.
NumberedPoints survivors_of(const NumberedPoints& common, const mpi::Block& block,
                            const Options& options);

}  // namespace cullhull::internal::inline distributed
