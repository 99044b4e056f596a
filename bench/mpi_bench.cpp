// The cost of points on several ranks compared with all points in one process: work and bytes.
//   mpirun -n 4 mpi_bench COUNT [SHAPE [DIMENSION [REPEAT]]]
// Each rank generates its share; rank 0 also generates all points, for convex_hull. Both run REPEAT
// times in turn; medians are printed. Work is processor seconds, for ranks without waiting for
// messages. Exit status 1 if the two results differ.
#include <time.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "agreement/canonical_hash.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/mpi.hpp"
#include "distributed/communicator.hpp"
#include "timing.hpp"

namespace {

using cullhull::PointView;
using cullhull::bench::median;

struct Set {
  std::uint64_t count = 1000000;  ///< on all ranks together
  std::string shape = "ball";
  std::uint32_t dimension = 3;
};

std::vector<double> share(const Set& set, int rank, int ranks) {
  const auto k = static_cast<std::uint64_t>(rank), n = static_cast<std::uint64_t>(ranks);
  const std::uint64_t count = set.count * (k + 1) / n - set.count * k / n;
  return cullhull::generate(set.shape, count, set.dimension, 1 + k);
}

PointView view(const Set& set, const std::vector<double>& rows) {
  return PointView::row_major(rows.data(), rows.size() / set.dimension, set.dimension);
}

/// A barrier at which ranks sleep, so that they do not disturb the rank that is measured.
void wait_for_all() {
  MPI_Request request;
  MPI_Ibarrier(MPI_COMM_WORLD, &request);
  for (int done = 0;;) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done != 0) return;
    const timespec pause{0, 1000000};
    nanosleep(&pause, nullptr);
  }
}

int run(const Set& set, int repeat) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  const std::vector<double> mine = share(set, rank, ranks);
  std::vector<double> all;
  if (rank == 0)
    for (int k = 0; k < ranks; ++k) {
      const std::vector<double> part = share(set, k, ranks);
      all.insert(all.end(), part.begin(), part.end());
    }
  std::vector<double> work, seconds, alone_work, alone_seconds;
  cullhull::mpi::Report report;
  std::uint64_t hash = 0, alone_hash = 0, vertices = 0;
  for (int k = 0; k < repeat; ++k) {
    wait_for_all();
    cullhull::mpi::JobOptions options;
    options.root = 0;
    options.report = &report;
    const cullhull::Hull hull =
        cullhull::mpi::convex_hull(MPI_COMM_WORLD, view(set, mine), options);
    hash = cullhull::testing_support::canonical_hash(hull);
    vertices = hull.vertices.size();
    work.push_back(report.work_seconds);
    seconds.push_back(report.seconds);
    wait_for_all();
    if (rank != 0) continue;
    const double before = cullhull::internal::process_work();
    cullhull::Hull alone;
    alone_seconds.push_back(
        cullhull::bench::seconds_of([&] { alone = cullhull::convex_hull(view(set, all)); }));
    alone_work.push_back(cullhull::internal::process_work() - before);
    alone_hash = cullhull::testing_support::canonical_hash(alone);
  }
  wait_for_all();
  if (rank != 0) return 0;
  const double input = static_cast<double>(all.size()) * sizeof(double);
  std::printf("%s %uD, %llu points on %d ranks, medians of %d\n", set.shape.c_str(), set.dimension,
              static_cast<unsigned long long>(set.count), ranks, repeat);
  std::printf("bytes sent  %llu, %.3f %% of the input, in %llu messages\n",
              static_cast<unsigned long long>(report.bytes),
              100 * static_cast<double>(report.bytes) / input,
              static_cast<unsigned long long>(report.messages));
  std::printf("map         %llu extreme of %llu sampled; %llu points left their ranks\n",
              static_cast<unsigned long long>(report.common),
              static_cast<unsigned long long>(report.sampled),
              static_cast<unsigned long long>(report.contributed));
  std::printf("hull        %llu vertices\n", static_cast<unsigned long long>(vertices));
  std::printf("work        %.4f s, one process %.4f s, ratio %.3f\n", median(work),
              median(alone_work), median(work) / median(alone_work));
  std::printf("clock       %.4f s, one process %.4f s\n", median(seconds), median(alone_seconds));
  if (hash != alone_hash) std::printf("THE RESULTS DIFFER\n");
  return hash == alone_hash ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  int level = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  Set set;
  if (argc > 1) set.count = static_cast<std::uint64_t>(std::strtod(argv[1], nullptr));
  if (argc > 2) set.shape = argv[2];
  if (argc > 3) set.dimension = static_cast<std::uint32_t>(std::atoi(argv[3]));
  const int status = run(set, argc > 4 ? std::atoi(argv[4]) : 5);
  MPI_Finalize();
  return status;
}
