// Bytes to a small set of points: the hull must be certified, and the same with the filter and by
// columns. Errors other than an exceeded budget are failures too.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "cullhull/certify.hpp"
#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "tests/agreement/canonical_hash.hpp"

namespace {

using namespace cullhull;

/// First byte: dimension and kind of coordinates; the rest: coordinates.
std::vector<double> coordinates_of(const std::uint8_t* data, std::size_t size, unsigned kind) {
  std::vector<double> out;
  if (kind == 0) {  // a small grid: coplanar groups and duplicates
    for (std::size_t i = 0; i < size; ++i) out.push_back(data[i] % 5);
  } else if (kind == 1) {  // signed bytes, perhaps far from the origin
    for (std::size_t i = 0; i < size; ++i)
      out.push_back(0x1p40 + static_cast<std::int8_t>(data[i]));
  } else if (kind == 2) {  // a grid with one-ulp disturbances
    for (std::size_t i = 0; i < size; ++i) {
      double v = data[i] & 7;
      if (data[i] & 8) v = std::nextafter(v, data[i] & 16 ? 1e9 : -1e9);
      out.push_back(v);
    }
  } else {  // any doubles
    for (std::size_t i = 0; i + 8 <= size; i += 8) {
      double v;
      std::memcpy(&v, data + i, 8);
      out.push_back(std::isfinite(v) ? v : 0.0);
    }
  }
  return out;
}

[[noreturn]] void fail(const char* what, const std::string& detail) {
  std::fprintf(stderr, "%s: %s\n", what, detail.c_str());
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1 || size > 1200) return 0;
  const unsigned d = 1 + data[0] % 6, kind = data[0] / 6 % 4;
  std::vector<double> rows = coordinates_of(data + 1, size - 1, kind);
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
