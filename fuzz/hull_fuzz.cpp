// Bytes to a small set of points: the hull must be certified, and the same with the filter and by
// columns. Errors other than an exceeded budget are failures too. The first
// byte is the dimension and the kind of coordinates.
#include <algorithm>

#include "cullhull/certify.hpp"
#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "fuzz_points.hpp"
#include "tests/agreement/canonical_hash.hpp"

namespace {

using namespace cullhull;
using fuzz::fail;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1 || size > 1200) return 0;
  const unsigned d = 1 + data[0] % 6, kind = data[0] / 6 % fuzz::kinds;
  std::vector<double> rows = fuzz::coordinates_of(data + 1, size - 1, kind);
  // High dimensions have many facets: fewer points keep a run short.
  const std::size_t limit[] = {0, 200, 200, 120, 60, 30, 20};
  const std::size_t n = std::min(rows.size() / d, limit[d]);
  rows.resize(n * d);
  std::vector<double> columns(rows.size());
  for (std::size_t i = 0; i < n; ++i)
    for (unsigned j = 0; j < d; ++j) columns[j * n + i] = rows[i * d + j];

  try {
    Options options;
    options.threads = 1;
    options.cull = CullMethod::none;
    const auto by_row = PointView::row_major(rows.data(), n, d);
    const Hull hull = convex_hull(by_row, options);
    const Certificate c = certify(by_row, hull, options);
    if (!c.valid) fail("not certified", c.reason);
    options.cull = CullMethod::gauge;
    const Hull filtered = convex_hull(by_row, options);
    const Hull by_column = convex_hull(PointView::column_major(columns.data(), n, d), options);
    const auto hash = testing_support::canonical_hash(hull);
    if (testing_support::canonical_hash(filtered) != hash) fail("differs", "cull gauge");
    options.cull = CullMethod::pseudo_hull;
    if (testing_support::canonical_hash(convex_hull(by_row, options)) != hash)
      fail("differs", "cull pseudo-hull");
    if (testing_support::canonical_hash(by_column) != hash) fail("differs", "columns");
  } catch (const Error& e) {
    if (e.code() != ErrorCode::out_of_budget) fail("error", e.what());
  }
  return 0;
}
