// An MPI communicator for one call: messages of any length, waits that yield the processor,
// statistics of the messages, and exceptions that all ranks throw together.
#pragma once

#include <cstdint>
#include <exception>
#include <memory>
#include <span>
#include <vector>

#include "cullhull/extreme_points.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/mpi.hpp"

namespace cullhull::internal {

/// Statistics of one rank's communication in one call.
struct Traffic {
  std::uint64_t messages = 0, bytes = 0;
  double waiting_work = 0;  ///< processor seconds that this thread spent waiting for MPI
};

/// Processor seconds that all threads of this process have used so far.
double process_work();

class Communicator {
 public:
  /// Bytes. Longer messages are split, since MPI counts bytes in an int.
  static constexpr std::uint64_t longest_message = std::uint64_t{1} << 30;

  /// Collective. Communicates over a duplicate of `parent`, which the first call makes and which is
  /// kept with `parent` until that is freed. Refers to the options, which must outlive it. `poll`
  /// of the options is called during waits.
  Communicator(MPI_Comm parent, const Options& options,
               std::uint64_t piece_bytes = longest_message);
  ~Communicator();
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }
  /// The number of ranks on this machine, including this one.
  int machine_ranks() const;
  const Traffic& traffic() const { return traffic_; }
  struct Kept;

  // Messages between two ranks. Both must know the length.
  void send(const void* data, std::uint64_t bytes, int to);
  void receive(void* data, std::uint64_t bytes, int from);

  // Collective functions.
  /// Copies the data of `root` to all ranks along a binomial tree. All ranks must know the length.
  void broadcast(void* data, std::uint64_t bytes, int root);
  /// Replaces each value by its minimum over all ranks.
  void least(std::span<std::uint64_t> values);
  /// Replaces each value by its sum over all ranks.
  void sum(std::span<std::uint64_t> values);
  /// Returns the sum of the values of the ranks below this one.
  std::uint64_t sum_before(std::uint64_t value);

  /// If `failure` is an exception on any rank, all ranks throw: an Error with the code and message
  /// of the lowest such rank. That rank itself rethrows an exception of the caller's own functions.
  void agree(const std::exception_ptr& failure);
  /// Runs `work`, which must not communicate, on each rank. If it throws on any rank, all ranks
  /// throw.
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
  /// Makes a duplicate and counts the ranks on this machine.
  void duplicate(MPI_Comm parent, Kept& kept);
  /// Waits until the request is complete.
  void finish(MPI_Request request);
  void count(std::uint64_t bytes) {
    ++traffic_.messages;
    traffic_.bytes += bytes;
  }

  const Options& options_;
  Kept* kept_ = nullptr;
  std::unique_ptr<Kept> own_;  ///< used while another call uses the kept duplicate
  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1;
  std::uint64_t piece_bytes_;
  Traffic traffic_;
};

// Copies a result from `root` to all ranks, field by field and bit for bit. If memory is exhausted
// on one rank, all throw.
void broadcast(Communicator& ranks, int root, Hull& hull);
void broadcast(Communicator& ranks, int root, ExtremePoints& points);
void broadcast(Communicator& ranks, int root, std::vector<double>& numbers);

}  // namespace cullhull::internal
