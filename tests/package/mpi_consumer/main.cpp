// A job of one rank: the hull of a cube.
#include <cullhull/mpi.hpp>
#include <vector>

int main(int argc, char** argv) {
  int level = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  std::vector<double> cube;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 3; ++j) cube.push_back(i >> j & 1);
  const cullhull::PointView points = cullhull::PointView::row_major(cube.data(), 8, 3);
  const cullhull::Hull hull = cullhull::mpi::hull(points, MPI_COMM_WORLD);
  const bool right = hull.volume == 1 && hull.facets.size() == 6;
  MPI_Finalize();
  return right ? 0 : 1;
}
