// The filter in front of other code: here, the point farthest in a direction is among the
// survivors.
#include <cstdio>

#include "cullhull/cullhull.hpp"

namespace {

// Stands for any code whose answer depends on the hull alone.
std::uint64_t farthest(const std::vector<double>& p, const std::vector<std::uint64_t>& ids) {
  std::uint64_t best = ids.front();
  for (const std::uint64_t i : ids)
    if (p[3 * i] + 2 * p[3 * i + 1] > p[3 * best] + 2 * p[3 * best + 1]) best = i;
  return best;
}

}  // namespace

int main() {
  const std::vector<double> points = cullhull::generate("gauss", 200000, 3);
  std::vector<std::uint64_t> all(200000);
  for (std::uint64_t i = 0; i < all.size(); ++i) all[i] = i;

  const cullhull::Survivors kept =
      cullhull::cull(cullhull::PointView::row_major(points.data(), all.size(), 3));
  const std::vector<std::uint64_t>& ids = kept.all ? all : kept.ids;
  std::printf("%zu of %zu points are left\n", ids.size(), all.size());
  return farthest(points, ids) == farthest(points, all) ? 0 : 1;
}
