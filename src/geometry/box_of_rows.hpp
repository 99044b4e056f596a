// Bounding boxes of rows, on all threads.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "parallel/dispatch.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

struct BoxOfRows {
  std::vector<double> low, high;
};

/// The box of the first `axes` numbers of n > 0 rows: row(i) is the address of row i.
template <class Row>
BoxOfRows box_of_rows(std::uint64_t n, unsigned axes, const Row& row, const Run& run) {
  constexpr std::uint64_t grain = 4096;
  std::vector<BoxOfRows> boxes(chunk_count(n, grain));
  run.each_chunk(n, grain, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    const double* const first = row(begin);
    boxes[c].low.assign(first, first + axes);
    boxes[c].high = boxes[c].low;
    double *const low = boxes[c].low.data(), *const high = boxes[c].high.data();
    with_dimension<2, 4, 0>(axes, [&](auto known) {
      const unsigned d = known() != 0 ? known() : axes;
      for (std::uint64_t i = begin; i < end; ++i)
        for (unsigned j = 0; j < d; ++j) {
          const double v = row(i)[j];
          low[j] = std::min(low[j], v);
          high[j] = std::max(high[j], v);
        }
    });
  });
  for (const BoxOfRows& box : boxes)
    for (unsigned j = 0; j < axes; ++j) {
      boxes[0].low[j] = std::min(boxes[0].low[j], box.low[j]);
      boxes[0].high[j] = std::max(boxes[0].high[j], box.high[j]);
    }
  return std::move(boxes[0]);
}

}  // namespace cullhull::internal
