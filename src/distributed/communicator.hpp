// An MPI communicator for one call: messages of any length, waits that leave the processor to
// others, statistics of what was sent, and errors that all ranks share.
#pragma once

#include <cstdint>
#include <exception>
#include <memory>
#include <span>
#include <vector>

#include "cullhull/extreme_points.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/mpi.hpp"

namespace cullhull::internal::inline distributed {

struct Traffic {
  std::uint64_t messages = 0, bytes = 0;
  double waiting_work = 0;  ///< processor seconds of this thread that went into MPI
};

/// Processor seconds of this process so far, of all threads.
double process_work();

class Communicator {
 public:
  /// Longer messages are split, as MPI counts bytes by int.
  static constexpr std::uint64_t longest_message = std::uint64_t{1} << 30;

  /// A duplicate of `parent`, made at its first call and kept with it until it is freed;
  /// collective. Views the options.
  Communicator(MPI_Comm parent, const Options& options,
               std::uint64_t piece_bytes = longest_message);
  ~Communicator();
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }
  /// Ranks on this machine, this one included.
  int machine_ranks() const;
  const Traffic& traffic() const { return traffic_; }
  struct Kept;

  // Between two ranks, both of which know the length.
  void send(const void* data, std::uint64_t bytes, int to);
  void receive(void* data, std::uint64_t bytes, int from);

  // Collective.
  /// Down a binomial tree from `root`; all ranks know the length.
  void broadcast(void* data, std::uint64_t bytes, int root);
  /// The element-wise minimum over all ranks.
  void least(std::span<std::uint64_t> values);
  /// The element-wise sum over all ranks.
  void sum(std::span<std::uint64_t> values);
  /// The sum over the ranks below this one.
  std::uint64_t sum_before(std::uint64_t value);

  /// If `failure` is an exception on any rank, throws that of the lowest such rank on all.
  void agree(const std::exception_ptr& failure);
  /// Runs `work` on each rank, then agrees on failures. It must send nothing.
  template <class Work>
  void together(const Work& work) {
    std::exception_ptr failure;
    try {
      work();
    } catch (...) {
      failure = std::current_exception();
    }
    agree(failure);
  }

 private:
  void duplicate(MPI_Comm parent, Kept& kept);
  void finish(MPI_Request request);
  void count(std::uint64_t bytes) {
    ++traffic_.messages;
    traffic_.bytes += bytes;
  }

  const Options& options_;
  Kept* kept_ = nullptr;
  std::unique_ptr<Kept> own_;  ///< where that is kept is in use
  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1;
  std::uint64_t piece_bytes_;
  Traffic traffic_;
};

// Sends results from one rank to all: field by field, bit for bit.

// Overwrites the argument by that of `root`. Where memory fails on one rank, all throw.
void broadcast(Communicator& ranks, int root, Hull& hull);
void broadcast(Communicator& ranks, int root, ExtremePoints& points);
void broadcast(Communicator& ranks, int root, std::vector<double>& numbers);

}  // namespace cullhull::internal::inline distributed
