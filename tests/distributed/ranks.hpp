// What the tests that run as MPI jobs share. Every rank runs every test, in step: a test that ends
// early on one rank would leave the others waiting, so only EXPECT is used.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/mpi.hpp"

namespace cullhull::testing_support {

inline int world_rank() {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}
inline int world_size() {
  int size = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size;
}

/// Waits asleep: MPI's own waits take turns on the processor, which where ranks are more than
/// processors, or other programs run beside them, is taken from the rank that all wait for.
inline void wait_asleep(MPI_Request request) {
  for (int done = 0;;) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done != 0) return;
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
}

/// A barrier of all ranks at which they sleep.
inline void wait_for_all() {
  MPI_Request request;
  MPI_Ibarrier(MPI_COMM_WORLD, &request);
  wait_asleep(request);
}

/// Gives every rank rank 0's values; all know the length.
inline void tell_all(std::vector<std::uint64_t>& values) {
  MPI_Request request;
  MPI_Ibcast(values.data(), static_cast<int>(values.size()), MPI_UINT64_T, 0, MPI_COMM_WORLD,
             &request);
  wait_asleep(request);
}

/// The first `count` ranks, MPI_COMM_NULL on the others.
class FirstRanks {
 public:
  explicit FirstRanks(int count) {
    wait_for_all();
    MPI_Comm_split(MPI_COMM_WORLD, world_rank() < count ? 0 : MPI_UNDEFINED, 0, &comm);
  }
  ~FirstRanks() {
    if (comm != MPI_COMM_NULL) MPI_Comm_free(&comm);
  }
  FirstRanks(const FirstRanks&) = delete;
  FirstRanks& operator=(const FirstRanks&) = delete;
  MPI_Comm comm = MPI_COMM_NULL;
};

/// "out_of_budget: rank 3: ..." as a number and what(); "-1: none" where nothing is thrown.
template <class Work>
std::string error_of(const Work& work) {
  try {
    work();
  } catch (const Error& e) {
    return std::to_string(static_cast<int>(e.code())) + ": " + e.what();
  }
  return "-1: none";
}
inline std::string error_text(ErrorCode code, const std::string& text) {
  return std::to_string(static_cast<int>(code)) + ": " + text;
}

/// Failures of the ranks that do not print everything.
class FailurePrinter : public testing::EmptyTestEventListener {
  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (!result.failed()) return;
    std::fprintf(stderr, "rank %d: %s:%d\n%s\n", world_rank(),
                 result.file_name() != nullptr ? result.file_name() : "", result.line_number(),
                 result.summary());
  }
};

inline int run_on_all_ranks(int argc, char** argv) {
  int level = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  testing::InitGoogleTest(&argc, argv);
  if (world_rank() > 0) {
    auto& listeners = testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new FailurePrinter);
  }
  const int status = RUN_ALL_TESTS();
  MPI_Finalize();
  return status;
}

}  // namespace cullhull::testing_support
