#include "delaunay/cell_boundary.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace cullhull::internal::inline delaunay {
namespace {

/// Facets before they are ordered.
struct Boundary {
  std::vector<std::uint32_t> ids, cells;
};

Boundary boundary_of(const Triangulation& t, const Array<std::uint8_t>& kept) {
  Boundary b;
  const unsigned k = t.corners() - 1;
  for (std::uint32_t c = 0; c < t.size(); ++c) {
    if (kept[c] == 0) continue;
    for (unsigned j = 0; j <= k; ++j) {
      const std::uint32_t o = t.neighbours_of(c)[j];
      if (o != no_cell && kept[o] != 0) continue;
      const std::size_t at = b.ids.size();
      for (unsigned i = 0; i <= k; ++i)
        if (i != j) b.ids.push_back(t.cell(c)[i]);
      // The boundary of a positive cell without corner j has the sign (-1)^j; ascending but for the
      // last two, which may have to change places.
      const auto row = b.ids.begin() + static_cast<std::ptrdiff_t>(at);
      bool odd = j % 2 == 1;
      for (unsigned i = 1; i < k; ++i)
        for (unsigned n = i; n > 0 && row[n] < row[n - 1]; --n) {
          std::swap(row[n], row[n - 1]);
          odd = !odd;
        }
      if (odd && k > 1) std::swap(row[k - 1], row[k - 2]);
      b.cells.push_back(c);
    }
  }
  return b;
}

}  // namespace

void write_boundary(const Triangulation& t, const Array<std::uint8_t>& kept,
                    Array<std::uint32_t>& facets, Array<std::uint32_t>& facet_cells) {
  if (t.corners() < 2) return;
  const Boundary b = boundary_of(t, kept);
  const unsigned k = t.corners() - 1;
  std::vector<std::uint32_t> order(b.cells.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t x, std::uint32_t y) {
    const std::uint32_t *p = b.ids.data() + std::size_t{x} * k,
                        *q = b.ids.data() + std::size_t{y} * k;
    return std::lexicographical_compare(p, p + k, q, q + k);
  });
  for (const std::uint32_t f : order) {
    const std::uint32_t* row = b.ids.data() + std::size_t{f} * k;
    facets.insert(facets.end(), row, row + k);
    facet_cells.push_back(b.cells[f]);
  }
}

}  // namespace cullhull::internal::inline delaunay
