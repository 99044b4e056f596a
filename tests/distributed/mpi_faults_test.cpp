// An error on one rank is the same error on all of them, and none of them waits for ever.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stop_token>

#include "agreement/point_sets.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/mpi.hpp"
#include "distributed/communicator.hpp"
#include "distributed/ranks.hpp"

namespace {
int duplicates = 0, freed_communicators = 0;  // that were made and freed through MPI's functions
}

// In the place of the library's own, which have a second name for that.
extern "C" int MPI_Comm_idup(MPI_Comm comm, MPI_Comm* made, MPI_Request* request) {
  ++duplicates;
  return PMPI_Comm_idup(comm, made, request);
}
extern "C" int MPI_Comm_free(MPI_Comm* comm) {
  ++freed_communicators;
  return PMPI_Comm_free(comm);
}

namespace cullhull::testing_support {
namespace {

constexpr std::uint64_t points_a_rank = 20000;

std::vector<double> own_points() {
  return generate("ball", points_a_rank, 3, 100 + static_cast<std::uint64_t>(world_rank()));
}
PointView view_of_rows(const std::vector<double>& rows) {
  return PointView::row_major(rows.data(), rows.size() / 3, 3);
}

/// Every way in says the same.
void expect_error(const std::vector<double>& rows, const mpi::JobOptions& options, ErrorCode code,
                  const std::string& text) {
  const PointView mine = view_of_rows(rows);
  const std::string expected = error_text(code, text);
  EXPECT_EQ(error_of([&] { mpi::convex_hull(MPI_COMM_WORLD, mine, options); }), expected);
  EXPECT_EQ(error_of([&] { mpi::extreme_points(MPI_COMM_WORLD, mine, options); }), expected);
  EXPECT_EQ(error_of([&] { mpi::hull_state(MPI_COMM_WORLD, mine, options); }), expected);
}

TEST(MpiFaults, NotANumberOnOneRankIsNamedOnAll) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    std::vector<double> rows = own_points();
    if (world_rank() == 3) rows[3 * 17 + 1] = bad;
    // A later one that the sample may well meet, and one on a later rank.
    if (world_rank() == 3)
      for (std::size_t i = 3 * 18; i < rows.size(); i += 3) rows[i] = bad;
    if (world_rank() == world_size() - 1 && world_size() > 4)
      for (double& v : rows) v = bad;
    const std::string text = "rank 3: point " + std::to_string(3 * points_a_rank + 17) + ", coord";
    const std::string found =
        error_of([&] { mpi::convex_hull(MPI_COMM_WORLD, view_of_rows(rows), {}); });
    EXPECT_EQ(found.find(error_text(ErrorCode::not_finite, text)), 0U) << found;
    EXPECT_EQ(error_of([&] { mpi::cull(MPI_COMM_WORLD, view_of_rows(rows), {}); }), found);
    expect_error(rows, {}, ErrorCode::not_finite, found.substr(found.find("rank")));
  }
}

TEST(MpiFaults, ABudgetRefusedOnOneRankIsRefusedOnAll) {
  const std::vector<double> rows =
      generate("sphere", points_a_rank, 3, 100 + static_cast<std::uint64_t>(world_rank()));
  for (int poor = 0; poor < world_size(); ++poor) {
    mpi::JobOptions options;
    if (world_rank() == poor) options.run.memory_budget = 100000;
    const std::string found =
        error_of([&] { mpi::convex_hull(MPI_COMM_WORLD, view_of_rows(rows), options); });
    const std::string wanted =
        error_text(ErrorCode::out_of_budget, "rank " + std::to_string(poor) + ": ");
    EXPECT_EQ(found.substr(0, wanted.size()), wanted) << found;
  }
}

// Enough for its own points, too little for those of others: refused while parts travel.
TEST(MpiFaults, NoRoomForOthersPoints) {
  const std::vector<double> rows =
      world_rank() == 0
          ? generate("sphere", 10, 3, 1)
          : generate("sphere", points_a_rank, 3, 100 + static_cast<std::uint64_t>(world_rank()));
  mpi::JobOptions options;
  if (world_rank() == 0) options.run.memory_budget = 1000000;
  const std::string found =
      error_of([&] { mpi::hull_state(MPI_COMM_WORLD, view_of_rows(rows), options); });
  EXPECT_NE(found.find("rank 0: points of other ranks that may be extreme need about"),
            std::string::npos)
      << found;
}

TEST(MpiFaults, ARankThatIsStoppedEndsTheCallOnAll) {
  const std::vector<double> rows = own_points();
  std::stop_source stop;
  mpi::JobOptions options;
  options.run.stop = stop.get_token();
  if (world_rank() == 2) stop.request_stop();
  expect_error(rows, options, ErrorCode::cancelled, "rank 2: cancelled");
}

TEST(MpiFaults, AnExceptionOfTheCallersPassesThroughThere) {
  const std::vector<double> rows = own_points();
  mpi::JobOptions options;
  if (world_rank() == 1)
    options.run.progress = [](const char*, double) { throw std::runtime_error("mine"); };
  std::string found;
  try {
    (void)mpi::convex_hull(MPI_COMM_WORLD, view_of_rows(rows), options);
  } catch (const Error& e) {
    found = error_text(e.code(), e.what());
  } catch (const std::runtime_error& e) {
    found = e.what();
  }
  EXPECT_EQ(found, world_rank() == 1 ? "mine" : error_text(ErrorCode::cancelled, "rank 1: mine"));
}

TEST(MpiFaults, ArgumentsThatDoNotFitTogether) {
  const std::vector<double> rows = own_points();
  const PointView mine = view_of_rows(rows);
  const auto refused =
      [&](const PointView& points, const mpi::JobOptions& options, const std::string& text) {
    EXPECT_EQ(error_of([&] { mpi::convex_hull(MPI_COMM_WORLD, points, options); }),
              error_text(ErrorCode::invalid_argument, text));
  };
  const int last = world_size() - 1;
  const bool is_last = world_rank() == last;
  refused(is_last ? PointView::row_major(rows.data(), 10, 2) : mine, {},
          "the ranks have points of dimension 2 and 3");
  refused(PointView{}, {}, "points need at least one dimension");
  mpi::JobOptions options;
  options.root = is_last ? 1 : 0;
  refused(mine, options, "the ranks differ in their root");
  options.root = world_size();
  refused(mine, options,
          "rank 0: root " + std::to_string(world_size()) + " is no rank of " +
              std::to_string(world_size()));
  options = {};
  if (is_last) options.first_id = 5;
  refused(mine, options, "some ranks have given a first id, others have not");
  options.first_id = is_last ? ~std::uint64_t{0} : 0;
  refused(mine, options, "rank " + std::to_string(last) + ": ids of the points exceed 2^64");
  PointView null = mine;
  if (is_last) null.data = nullptr;
  refused(null, {}, "rank " + std::to_string(last) + ": points.data is null");
  // After all of these the communicator is as good as before.
  EXPECT_EQ(mpi::convex_hull(MPI_COMM_WORLD, mine).point_count,
            points_a_rank * static_cast<std::uint64_t>(world_size()));
}

// A duplicate costs a round of all ranks: one is made for a communicator, however often it is used,
// also behind errors, and is gone with it.
TEST(MpiFaults, OneDuplicateForACommunicator) {
  const std::vector<double> cube = {0, 0, 0, 1, 1, 1, 0, 1, 0, 1, 0, 0};
  const PointView mine = PointView::row_major(cube.data(), 4, 3);
  MPI_Comm comm;
  PMPI_Comm_dup(MPI_COMM_WORLD, &comm);
  const int made = duplicates;
  for (int k = 0; k < 5; ++k) {
    mpi::JobOptions options;
    options.root = k == 2 ? world_size() : 0;
    error_of([&] { mpi::convex_hull(comm, mine, options); });
  }
  EXPECT_EQ(duplicates - made, 1);
  const int before = freed_communicators;
  MPI_Comm_free(&comm);
  EXPECT_EQ(freed_communicators - before, 2);  // itself, and the duplicate
  // One that is in use, as a Communicator is while it lives, is not shared.
  const Options options;
  PMPI_Comm_dup(MPI_COMM_WORLD, &comm);
  {
    internal::Communicator outer(comm, options), inner(comm, options);
    std::uint64_t one[] = {1};
    inner.sum(one);
    outer.sum(one);
    EXPECT_EQ(one[0],
              static_cast<std::uint64_t>(world_size()) * static_cast<std::uint64_t>(world_size()));
  }
  EXPECT_EQ(duplicates - made, 3);
  PMPI_Comm_free(&comm);
}

// What is longer than MPI counts travels in pieces; here of 1000 bytes.
TEST(MpiFaults, MessagesInPieces) {
  using internal::Communicator;
  const Options options;
  for (const std::uint64_t bytes : {0, 1, 999, 1000, 1001, 123456}) {
    Communicator ranks(MPI_COMM_WORLD, options, 1000);
    std::vector<unsigned char> data(bytes);
    for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<unsigned char>(i * i % 251);
    const std::vector<unsigned char> sent = data;
    const int root = world_size() / 2;
    if (world_rank() != root) std::fill(data.begin(), data.end(), 0);
    ranks.broadcast(data.data(), bytes, root);
    EXPECT_EQ(data, sent);
    const int next = (world_rank() + 1) % world_size();
    const int before = (world_rank() + world_size() - 1) % world_size();
    std::vector<unsigned char> received(bytes);
    const std::uint64_t messages = ranks.traffic().messages;
    if (world_rank() % 2 == 0) {  // so that nobody waits for nobody, buffers or not
      ranks.send(data.data(), bytes, next);
      ranks.receive(received.data(), bytes, before);
    } else {
      ranks.receive(received.data(), bytes, before);
      ranks.send(data.data(), bytes, next);
    }
    EXPECT_EQ(received, sent);
    EXPECT_EQ(ranks.traffic().messages - messages, (bytes + 999) / 1000);
  }
}

}  // namespace
}  // namespace cullhull::testing_support

int main(int argc, char** argv) { return cullhull::testing_support::run_on_all_ranks(argc, argv); }
