// Bytes to a few small sets of points: a batch must give the hulls of one call a set.
#include <algorithm>

#include "cullhull/batch.hpp"
#include "cullhull/error.hpp"
#include "fuzz_points.hpp"
#include "tests/agreement/canonical_hash.hpp"

namespace {

using namespace cullhull;
using fuzz::fail;

/// The first bytes: dimension, kind of coordinates, threads, sizes of the sets; then coordinates.
struct Sets {
  unsigned dimension = 0, threads = 1;
  std::vector<double> rows;
  std::vector<std::uint64_t> offsets{0};

  Sets(const std::uint8_t* data, std::size_t size) {
    dimension = 1 + data[0] % 4;
    threads = 1 + data[0] / 4 % 3;
    const unsigned kind = data[0] / 12 % fuzz::kinds, count = 1 + data[1] % 6;
    if (size < 2 + count) return;
    rows = fuzz::coordinates_of(data + 2 + count, size - 2 - count, kind);
    const std::uint64_t n = rows.size() / dimension;
    for (unsigned i = 0; i < count; ++i)  // sizes around the limit of what small sets take
      offsets.push_back(std::min<std::uint64_t>(n, offsets.back() + data[2 + i] % 140));
  }
  PointView set(std::size_t i) const {
    return PointView::row_major(rows.data() + offsets[i] * dimension, offsets[i + 1] - offsets[i],
                                dimension);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2 || size > 3000) return 0;
  const Sets sets(data, size);
  Options options;
  options.threads = sets.threads;
  try {
    const std::size_t count = sets.offsets.size() - 1;
    const HullBatch batch = convex_hulls(
        PointView::row_major(sets.rows.data(), sets.rows.size() / sets.dimension, sets.dimension),
        sets.offsets, options);
    for (std::size_t i = 0; i < count; ++i)
      if (testing_support::canonical_hash(batch.hull(i)) !=
          testing_support::canonical_hash(convex_hull(sets.set(i))))
        fail("differs", "set " + std::to_string(i));
  } catch (const Error& e) {
    if (e.code() != ErrorCode::out_of_budget) fail("error", e.what());
  }
  return 0;
}
