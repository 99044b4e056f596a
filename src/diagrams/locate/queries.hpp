// What queries of all kinds share: the check of a single one, and the order of a batch.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "cullhull/array.hpp"
#include "cullhull/error.hpp"
#include "geometry/gather.hpp"
#include "parallel/radix_sort.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// Throws Error{not_finite} for a NaN or an infinity.
inline void require_finite(double value, unsigned coordinate) {
  if (!std::isfinite(value))
    throw Error(ErrorCode::not_finite, "coordinate ", coordinate, " is ",
                (std::isnan(value) ? "NaN" : "infinite"));
}

/// Queries per chunk, and queries sorted at once, which bound the memory of a batch.
constexpr std::uint64_t queries_per_chunk = std::uint64_t{1} << 10;
constexpr std::uint64_t queries_at_once = std::uint64_t{1} << 22;

/// Visits the points of a batch by key, so that each begins with what the last one read.
/// set_keys(rows, count, put) calls put(i, key) for each of `count` rows, which it may change; keys
/// have `bits` bits. body() creates the work of one thread, which is called with a point's index,
/// its row and its key.
template <class SetKeys, class Body>
void each_query(const PointView& view, unsigned bits, const Run& run, const SetKeys& set_keys,
                const Body& body) {
  const unsigned d = view.dimension;
  for (std::uint64_t first = 0; first < view.count; first += queries_at_once) {
    const auto n = static_cast<std::uint32_t>(std::min(queries_at_once, view.count - first));
    Array<double> rows(std::size_t{n} * d);
    Array<KeyedId> items(n), scratch(n);
    run.each(n, light_grain / 8, [&](std::uint64_t begin, std::uint64_t end) {
      double* const own = rows.data() + begin * d;
      load_rows(view, first + begin, first + end, own);
      set_keys(own, end - begin, [&](std::uint64_t i, std::uint32_t key) {
        items[begin + i] = {key, static_cast<std::uint32_t>(begin + i)};
      });
    });
    KeyedId *order = items.data(), *spare = scratch.data();
    radix_sort(order, spare, n, bits, run);
    run.each(n, queries_per_chunk, [&](std::uint64_t begin, std::uint64_t end) {
      auto work = body();
      for (std::uint64_t i = begin; i < end; ++i)
        work(first + order[i].id, rows.data() + std::size_t{order[i].id} * d, order[i].key);
    });
    run.report("query", static_cast<double>(first + n) / static_cast<double>(view.count));
  }
}

}  // namespace cullhull::internal
