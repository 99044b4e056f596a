// Bytes to points in 1D to 5D, perhaps with weights: the triangulation must be certified, and the
// same on several threads and for float copies of equal value.
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/triangulation.hpp"
#include "fuzz_points.hpp"

namespace {

using namespace cullhull;
using fuzz::fail;

void expect_same(const Triangulation& a, const Triangulation& b, const char* what) {
  if (a.cells != b.cells || a.neighbours != b.neighbours || a.cell_groups != b.cell_groups ||
      a.hull_facets != b.hull_facets || a.hull_cells != b.hull_cells || a.hidden != b.hidden ||
      a.duplicates != b.duplicates || a.axes != b.axes)
    fail("differs", what);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 3 || size > 600) return 0;
  const unsigned d = 1 + data[0] % 5;
  std::vector<double> rows = fuzz::coordinates_of(data + 2, size - 2, data[1] % fuzz::kinds);
  const std::size_t most = d <= 2 ? 200 : d == 3 ? 60 : d == 4 ? 24 : 14;
  const std::size_t n = std::min(rows.size() / d, most);
  rows.resize(n * d);
  std::vector<double> weights;
  if (data[1] / 8 % 2 == 1)  // small whole ones: many points lie on faces of the lower hull
    for (std::size_t i = 0; i < n; ++i) weights.push_back(data[2 + i % (size - 2)] % 4);
  TriangulationOptions options;
  options.furthest_site = data[1] / 16 % 4 == 0;
  try {
    const auto view = PointView::row_major(rows.data(), n, d);
    const auto triangulate = [&] {
      return weights.empty() ? delaunay(view, options)
                             : regular_triangulation(view, weights, options);
    };
    options.threads = 1;
    const Triangulation t = triangulate();
    const Certificate c = weights.empty() ? certify(view, t) : certify(view, weights, t);
    if (!c.valid) fail("certificate", c.reason);
    options.threads = 3;
    expect_same(triangulate(), t, "on three threads");
  } catch (const Error& e) {
    fail("error", e.what());
  }
  return 0;
}
