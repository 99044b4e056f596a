#include "cullhull/alpha_shape.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "cells/circumcentre.hpp"
#include "cells/dual.hpp"
#include "cullhull/error.hpp"
#include "parallel/helpers.hpp"

namespace cullhull {
namespace internal {
namespace {

/// Facets of kept cells towards others, before they are ordered.
struct Boundary {
  std::vector<std::uint32_t> ids, cells;
};

Boundary boundary_of(const Triangulation& t, const Array<std::uint8_t>& kept) {
  Boundary b;
  const unsigned k = t.corners() - 1;
  for (std::uint32_t c = 0; c < t.size() && k > 0; ++c) {
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

void write_boundary(const Triangulation& t, const Boundary& b, AlphaShape& out) {
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
    out.facets.insert(out.facets.end(), row, row + k);
    out.facet_cells.push_back(b.cells[f]);
  }
}

}  // namespace
}  // namespace internal

AlphaShape alpha_shape(const PointView& points, const Triangulation& triangulation, double alpha,
                       const Options& options) {
  using namespace internal;
  const Triangulation& t = triangulation;
  if (!(alpha >= 0))
    throw Error(ErrorCode::invalid_argument, "alpha must be a number that is not negative");
  if (t.furthest_site)
    throw Error(ErrorCode::invalid_argument,
                "alpha shapes are of Delaunay triangulations, not of the furthest site");
  const Run run(options);
  const CallScope call;
  const DualPoints p(points, t, {}, run);
  AlphaShape out;
  if (t.corners() == 0) return out;
  const unsigned k = t.corners() - 1;
  Array<std::uint8_t> kept(t.size());
  run.each(t.size(), light_grain / 64, [&](std::uint64_t begin, std::uint64_t end) {
    std::vector<const double*> rows(k + 1);
    for (std::uint64_t c = begin; c < end; ++c) {
      for (unsigned i = 0; i <= k; ++i) rows[i] = p.row(t.cell(c)[i]);
      kept[c] = k == 0 || std::isinf(alpha) || radius_at_most(t.dimension, k, rows.data(), alpha);
    }
  });
  for (std::uint32_t c = 0; c < t.size(); ++c)
    if (kept[c] != 0) out.cells.push_back(c);
  if (k > 0) write_boundary(t, boundary_of(t, kept), out);
  return out;
}

}  // namespace cullhull
