// The hull of the points on the ranks of an MPI job: each rank makes a HullState of its points; the
// states are merged up a binomial tree, and the whole is sent down it.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <new>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/mpi.hpp"
#include "parallel/memory/memory.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {
namespace {

using Bytes = std::vector<std::byte>;

void check_mpi(int code) {
  if (code == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING];
  int length = 0;
  if (MPI_Error_string(code, text, &length) != MPI_SUCCESS) length = 0;
  throw Error(ErrorCode::io,
              "MPI: ", std::string(text, static_cast<std::size_t>(std::max(length, 0))));
}

/// Waits asleep: another rank may be computing, and there may be more ranks than processors.
void finish(MPI_Request request) {
  int micros = 10;
  for (int done = 0;;) {
    check_mpi(MPI_Test(&request, &done, MPI_STATUS_IGNORE));
    if (done != 0) return;
    std::this_thread::sleep_for(std::chrono::microseconds(micros));
    micros = std::min(2 * micros, 500);
  }
}

/// The ranks in one call, whose messages do not mix with the caller's. What throws on one rank is
/// kept, so that the rank still takes part in every message, until agree() throws it on all.
class Ranks {
 public:
  Ranks(MPI_Comm parent, int root) {
    MPI_Request request;
    check_mpi(MPI_Comm_idup(parent, &comm_, &request));
    finish(request);
    check_mpi(MPI_Comm_rank(comm_, &rank_));
    check_mpi(MPI_Comm_size(comm_, &size_));
    int roots[2] = {root, -root};
    check_mpi(MPI_Iallreduce(MPI_IN_PLACE, roots, 2, MPI_INT, MPI_MIN, comm_, &request));
    finish(request);
    const bool same = roots[0] == -roots[1], exists = root >= 0 && root < size_;
    attempt([&] {
      if (!same) throw Error(ErrorCode::invalid_argument, "the ranks differ in their root");
      if (!exists && root != mpi::every_rank)
        throw Error(ErrorCode::invalid_argument, "root ", root, " is no rank of ", size_);
    });
    everywhere_ = !same || !exists;
    root_ = everywhere_ ? 0 : root;
  }
  ~Ranks() { MPI_Comm_free(&comm_); }
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  /// Whether this rank gets the result, and whether it alone.
  bool here() const { return everywhere_ || rank_ == root_; }
  bool alone() const { return !everywhere_; }

  /// Options with this rank's share of its machine.
  Options share(Options options) const {
    MPI_Comm machine;
    int ranks = 1;
    check_mpi(MPI_Comm_split_type(comm_, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &machine));
    check_mpi(MPI_Comm_size(machine, &ranks));
    check_mpi(MPI_Comm_free(&machine));
    const auto parts = static_cast<unsigned>(ranks);
    if (options.threads == 0) options.threads = std::max(1U, resolve_threads(0) / parts);
    if (options.memory_budget == 0) options.memory_budget = resolve_budget(0) / parts;
    return options;
  }

  /// Does this rank's work unless it has failed before.
  template <class Work>
  void attempt(const Work& work) {
    if (!failure_) try {
        work();
      } catch (...) {
        failure_ = std::current_exception();
      }
  }

  /// Where any rank has failed, all throw: an Error of the lowest such rank. That rank itself
  /// rethrows what is no Error, as it comes from the caller's own functions.
  void agree() {
    int lowest = failure_ ? rank_ : size_;
    MPI_Request request;
    check_mpi(MPI_Iallreduce(MPI_IN_PLACE, &lowest, 1, MPI_INT, MPI_MIN, comm_, &request));
    finish(request);
    if (lowest == size_) return;
    int code[2] = {static_cast<int>(ErrorCode::internal), 0};
    std::string message;
    bool foreign = false;
    if (lowest == rank_) try {
        std::rethrow_exception(failure_);
      } catch (const Error& e) {
        code[0] = static_cast<int>(e.code());
        message = e.what();
      } catch (const std::bad_alloc&) {
        code[0] = static_cast<int>(ErrorCode::out_of_budget);
        message = "out of memory";
      } catch (const std::exception& e) {
        code[0] = static_cast<int>(ErrorCode::cancelled);
        message = e.what();
        foreign = true;
      } catch (...) {
        code[0] = static_cast<int>(ErrorCode::cancelled);
        message = "an exception of the caller's";
        foreign = true;
      }
    code[1] = static_cast<int>(message.size());
    broadcast(code, 2, MPI_INT, lowest);
    message.resize(static_cast<std::size_t>(code[1]));
    broadcast(message.data(), code[1], MPI_CHAR, lowest);
    if (foreign) std::rethrow_exception(failure_);
    throw Error(static_cast<ErrorCode>(code[0]), "rank ", lowest, ": ", message);
  }

  /// The number of points on the ranks below this one.
  std::uint64_t sum_before(std::uint64_t count) const {
    std::uint64_t before = 0;
    MPI_Request request;
    check_mpi(MPI_Iexscan(&count, &before, 1, MPI_UINT64_T, MPI_SUM, comm_, &request));
    finish(request);
    return rank_ == 0 ? 0 : before;
  }

  /// Collective: the state of all ranks' points on those that get the result; on others empty.
  HullState merged(HullState state, const Options& options) {
    const int me = (rank_ - root_ + size_) % size_;
    const auto real = [&](int place) { return (place + root_) % size_; };
    int step = 1;
    for (; step < size_ && (me & step) == 0; step *= 2)
      if (me + step < size_) {
        const Bytes other = receive(real(me + step));
        attempt([&] {
          if (!other.empty()) state.merge(HullState::from_bytes(other), options);
        });
      }
    if (me != 0) send(bytes_of(state), real(me - step));
    agree();
    if (!everywhere_) return me == 0 ? state : HullState();
    const Bytes whole = me == 0 ? bytes_of(state) : receive(real(me - step));
    for (step /= 2; step > 0; step /= 2)
      if (me + step < size_) send(whole, real(me + step));
    attempt([&] {
      if (me != 0) state = whole.empty() ? HullState() : HullState::from_bytes(whole);
    });
    agree();
    return state;
  }

 private:
  /// None of a state that knows no dimension yet, and of a rank that has failed.
  Bytes bytes_of(const HullState& state) {
    Bytes bytes;
    attempt([&] {
      if (state.dimension() > 0) bytes = state.to_bytes();
    });
    return failure_ ? Bytes() : bytes;
  }

  // A message is its length, the receiver's word that it has room, and the bytes.

  void send(const Bytes& bytes, int to) const {
    std::uint64_t size = bytes.size(), room = 0;
    move(&size, sizeof size, to, true);
    move(&room, sizeof room, to, false);
    if (room != 0) move(const_cast<std::byte*>(bytes.data()), size, to, true);  // MPI only reads
  }
  Bytes receive(int from) {
    std::uint64_t size = 0, room = 0;
    move(&size, sizeof size, from, false);
    Bytes bytes;
    attempt([&] {
      bytes.resize(size);
      room = 1;
    });
    move(&room, sizeof room, from, true);
    if (room != 0) move(bytes.data(), size, from, false);
    return bytes;
  }
  /// In pieces, as MPI counts bytes in an int.
  void move(void* data, std::uint64_t size, int other, bool away) const {
    constexpr std::uint64_t most = std::uint64_t{1} << 30;
    constexpr int tag = 1;  // messages between two ranks arrive in the order they were sent in
    for (auto* at = static_cast<std::byte*>(data); size > 0;) {
      const auto piece = static_cast<int>(std::min(size, most));
      MPI_Request request;
      check_mpi(away ? MPI_Isend(at, piece, MPI_BYTE, other, tag, comm_, &request)
                     : MPI_Irecv(at, piece, MPI_BYTE, other, tag, comm_, &request));
      finish(request);
      at += piece;
      size -= static_cast<std::uint64_t>(piece);
    }
  }
  void broadcast(void* data, int count, MPI_Datatype type, int from) const {
    MPI_Request request;
    check_mpi(MPI_Ibcast(data, count, type, from, comm_, &request));
    finish(request);
  }

  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1, root_ = 0;
  bool everywhere_ = true;
  std::exception_ptr failure_;
};

}  // namespace
}  // namespace cullhull::internal

namespace cullhull::mpi {

Hull hull(const PointView& local, MPI_Comm comm, const Options& options, int root) {
  internal::Ranks ranks(comm, root);
  const Options mine = ranks.share(options);
  const std::uint64_t first_id = ranks.sum_before(local.count);
  HullState state;
  ranks.attempt([&] {
    if (local.count > 0 || local.dimension > 0) state = HullState(local, first_id, mine);
  });
  state = ranks.merged(std::move(state), mine);
  Hull result;
  ranks.attempt([&] {
    if (ranks.here()) result = state.hull(ranks.alone() ? options : mine);
  });
  ranks.agree();
  return result;
}

HullState merge(const HullState& local, MPI_Comm comm, const Options& options, int root) {
  internal::Ranks ranks(comm, root);
  return ranks.merged(local, ranks.share(options));
}

}  // namespace cullhull::mpi
