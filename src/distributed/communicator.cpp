#include "distributed/communicator.hpp"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <new>
#include <string>
#include <thread>

#include "cullhull/error.hpp"

namespace cullhull::internal {
namespace {

constexpr int tag = 1;  // messages between two ranks arrive in the order in which they were sent

double clock_seconds(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void check_mpi(int code) {
  if (code == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING];
  int length = 0;
  if (MPI_Error_string(code, text, &length) != MPI_SUCCESS) length = 0;
  throw Error(ErrorCode::io,
              "MPI: ", std::string(text, static_cast<std::size_t>(std::max(length, 0))));
}

/// The steps of a wait: first calls return at once, later ones yield, still later ones sleep for
/// growing times of at most 0.5 ms. A rank may wait while another computes a hull, and there may be
/// more ranks than processors. The counts are guesses, not tuned.
class Pause {
 public:
  void take() {
    ++turns_;
    if (turns_ < 200) return;
    if (turns_ < 1000) return std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::microseconds(micros_));
    micros_ = std::min(2 * micros_, 500);
  }

 private:
  int turns_ = 0, micros_ = 10;
};

/// An exception as data that can be sent.
struct Failure {
  ErrorCode code = ErrorCode::internal;
  std::string message;
};

Failure described(const std::exception_ptr& failure) {
  try {
    std::rethrow_exception(failure);
  } catch (const Error& e) {
    return {e.code(), e.what()};
  } catch (const std::bad_alloc&) {
    return {ErrorCode::out_of_budget, "out of memory"};
  } catch (const std::exception& e) {
    return {ErrorCode::cancelled, e.what()};
  } catch (...) {
    return {ErrorCode::cancelled, "an exception of the caller's"};
  }
}

/// Whether the exception is neither an Error nor std::bad_alloc: then a function of the caller's
/// options threw it.
bool foreign(const std::exception_ptr& failure) {
  try {
    std::rethrow_exception(failure);
  } catch (const Error&) {
    return false;
  } catch (const std::bad_alloc&) {
    return false;
  } catch (...) {
    return true;
  }
}

}  // namespace

/// The duplicate of a caller's communicator. It keeps our messages apart from the caller's. The
/// first call attaches it to the caller's communicator, and it is freed with that. Exceptions that
/// all ranks throw leave no unreceived message in it, so later calls can use it.
struct Communicator::Kept {
  MPI_Comm comm = MPI_COMM_NULL;
  int machine_ranks = 1;
  bool in_use = false;  ///< by a call whose `poll` function makes another call
};

namespace {

/// MPI calls this when the caller's communicator is freed: frees the duplicate.
int forget(MPI_Comm, int, void* kept, void*) {
  std::unique_ptr<Communicator::Kept> k(static_cast<Communicator::Kept*>(kept));
  int finalized = 0;
  MPI_Finalized(&finalized);
  if (finalized != 0 || k->comm == MPI_COMM_NULL) return MPI_SUCCESS;
  return MPI_Comm_free(&k->comm);
}

/// The MPI attribute key under which a communicator holds its duplicate.
int key_of_kept() {
  static const int key = [] {
    int made = MPI_KEYVAL_INVALID;
    check_mpi(MPI_Comm_create_keyval(MPI_COMM_NULL_COPY_FN, forget, &made, nullptr));
    return made;
  }();
  return key;
}

}  // namespace

double process_work() { return clock_seconds(CLOCK_PROCESS_CPUTIME_ID); }

Communicator::Communicator(MPI_Comm parent, const Options& options, std::uint64_t piece_bytes)
    : options_(options), piece_bytes_(piece_bytes) {
  check_mpi(MPI_Comm_rank(parent, &rank_));
  check_mpi(MPI_Comm_size(parent, &size_));
  void* found = nullptr;
  int there = 0;
  check_mpi(MPI_Comm_get_attr(parent, key_of_kept(), &found, &there));
  if (there != 0 && !static_cast<Kept*>(found)->in_use) {
    kept_ = static_cast<Kept*>(found);
  } else {
    own_ = std::make_unique<Kept>();
    duplicate(parent, *own_);
    kept_ = own_.get();
    if (there == 0) {
      check_mpi(MPI_Comm_set_attr(parent, key_of_kept(), kept_));
      static_cast<void>(own_.release());
    }
  }
  kept_->in_use = true;
  comm_ = kept_->comm;
}

void Communicator::duplicate(MPI_Comm parent, Kept& kept) {
  MPI_Request request;
  check_mpi(MPI_Comm_idup(parent, &kept.comm, &request));
  finish(request);
  if (size_ == 1) return;
  MPI_Comm machine;
  check_mpi(MPI_Comm_split_type(kept.comm, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &machine));
  check_mpi(MPI_Comm_size(machine, &kept.machine_ranks));
  check_mpi(MPI_Comm_free(&machine));
}

int Communicator::machine_ranks() const { return kept_->machine_ranks; }

// The ranks must not wait for each other here, since one may have been lost. MPI_Comm_free does not
// wait.
Communicator::~Communicator() {
  kept_->in_use = false;
  if (own_ && own_->comm != MPI_COMM_NULL) MPI_Comm_free(&own_->comm);
}

void Communicator::finish(MPI_Request request) {
  const double before = clock_seconds(CLOCK_THREAD_CPUTIME_ID);
  Pause pause;
  for (int done = 0;;) {
    check_mpi(MPI_Test(&request, &done, MPI_STATUS_IGNORE));
    if (done != 0) break;
    if (options_.poll) options_.poll();
    pause.take();
  }
  traffic_.waiting_work += clock_seconds(CLOCK_THREAD_CPUTIME_ID) - before;
}

void Communicator::send(const void* data, std::uint64_t bytes, int to) {
  const auto* at = static_cast<const std::byte*>(data);
  for (std::uint64_t piece; bytes > 0; at += piece, bytes -= piece) {
    piece = std::min(bytes, piece_bytes_);
    MPI_Request request;
    check_mpi(MPI_Isend(at, static_cast<int>(piece), MPI_BYTE, to, tag, comm_, &request));
    finish(request);
    count(piece);
  }
}

void Communicator::receive(void* data, std::uint64_t bytes, int from) {
  auto* at = static_cast<std::byte*>(data);
  for (std::uint64_t piece; bytes > 0; at += piece, bytes -= piece) {
    piece = std::min(bytes, piece_bytes_);
    MPI_Request request;
    check_mpi(MPI_Irecv(at, static_cast<int>(piece), MPI_BYTE, from, tag, comm_, &request));
    finish(request);
  }
}

void Communicator::broadcast(void* data, std::uint64_t bytes, int root) {
  if (bytes == 0) return;
  const int me = (rank_ - root + size_) % size_;
  const auto real = [&](int place) { return (place + root) % size_; };
  int step = 1;
  while (step < size_ && (me & step) == 0) step *= 2;
  if (me != 0) receive(data, bytes, real(me - step));
  for (step /= 2; step > 0; step /= 2)
    if (me + step < size_) send(data, bytes, real(me + step));
}

void Communicator::least(std::span<std::uint64_t> values) {
  MPI_Request request;
  check_mpi(MPI_Iallreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()),
                           MPI_UINT64_T, MPI_MIN, comm_, &request));
  finish(request);
  count(values.size_bytes());
}

void Communicator::sum(std::span<std::uint64_t> values) {
  MPI_Request request;
  check_mpi(MPI_Iallreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()),
                           MPI_UINT64_T, MPI_SUM, comm_, &request));
  finish(request);
  count(values.size_bytes());
}

std::uint64_t Communicator::sum_before(std::uint64_t value) {
  std::uint64_t before = 0;
  MPI_Request request;
  check_mpi(MPI_Iexscan(&value, &before, 1, MPI_UINT64_T, MPI_SUM, comm_, &request));
  finish(request);
  count(sizeof value);
  return rank_ == 0 ? 0 : before;
}

void Communicator::agree(const std::exception_ptr& failure) {
  const auto none = static_cast<std::uint64_t>(size_);
  std::uint64_t lowest = failure ? static_cast<std::uint64_t>(rank_) : none;
  least({&lowest, 1});
  if (lowest == none) return;
  const auto speaker = static_cast<int>(lowest);
  Failure told;
  if (rank_ == speaker) told = described(failure);
  std::uint64_t head[2] = {static_cast<std::uint64_t>(told.code), told.message.size()};
  broadcast(head, sizeof head, speaker);
  told.message.resize(head[1]);
  broadcast(told.message.data(), head[1], speaker);
  if (rank_ == speaker && foreign(failure)) std::rethrow_exception(failure);
  throw Error(static_cast<ErrorCode>(head[0]), "rank ", speaker, ": ", told.message);
}

}  // namespace cullhull::internal
