// A small simulation in several processes: each has particles that move, and every step the hull of
// all of them is taken where they are. Run as: mpirun -n 4 example_in_situ_mpi
#include <cmath>
#include <cstdio>
#include <vector>

#include "cullhull/generate.hpp"
#include "cullhull/mpi.hpp"

namespace {

/// Particles of one rank, pulled towards the origin.
struct Particles {
  std::vector<double> places, speeds;

  explicit Particles(int rank)
      : places(cullhull::generate("ball", 50000, 3, 1 + static_cast<unsigned>(rank))),
        speeds(places.size(), 0.0) {}

  void step(double seconds) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      speeds[i] -= seconds * places[i];
      places[i] += seconds * speeds[i];
    }
  }
};

int run() {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  Particles mine(rank);
  double before = INFINITY;
  bool shrinks = true;
  for (int step = 0; step < 10; ++step) {
    const auto points =
        cullhull::PointView::row_major(mine.places.data(), mine.places.size() / 3, 3);
    // Every rank gets the hull; the particles stay where they are.
    const cullhull::Hull hull = cullhull::mpi::hull(points, MPI_COMM_WORLD);
    shrinks = shrinks && hull.volume < before;
    before = hull.volume;
    if (rank == 0)
      std::printf("step %d: %zu vertices, volume %.4f\n", step, hull.vertices.size(), hull.volume);
    mine.step(0.1);
  }
  return shrinks ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  int level = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  const int status = run();
  MPI_Finalize();
  return status;
}
