#include "lifting/prepare.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "cullhull/error.hpp"
#include "geometry/double_parts.hpp"
#include "geometry/gather.hpp"
#include "geometry/local_frame.hpp"
#include "geometry/orientation.hpp"
#include "lifting/insertion_order.hpp"

namespace cullhull::internal {
namespace {

/// Places of k + 1 affinely independent of the points, and the axes of their flat. A few tuples
/// that are spread over the order suffice nearly always, where the points span all of space.
void find_flat(const Array<double>& rows, std::uint32_t n, unsigned d, Prepared& out,
               const Run& run) {
  out.axes.resize(d);
  std::iota(out.axes.begin(), out.axes.end(), 0U);
  constexpr std::uint32_t tries = 16;
  std::vector<const double*> p(d + 1);
  for (std::uint32_t t = 0; n > d && t < tries && t < n; ++t) {
    out.simplex.clear();
    for (unsigned i = 0; i <= d; ++i)
      out.simplex.push_back(static_cast<std::uint32_t>(
          (t + std::uint64_t{i} * (n - 1) * (tries - t) / (std::uint64_t{d} * tries)) % n));
    for (unsigned i = 0; i <= d; ++i) p[i] = rows.data() + std::size_t{out.simplex[i]} * d;
    std::sort(out.simplex.begin(), out.simplex.end());
    if (std::adjacent_find(out.simplex.begin(), out.simplex.end()) != out.simplex.end()) continue;
    if (orientation(d, p.data()) != Sign::zero) return;
  }
  const LocalFrame frame(Array<double>(rows), n, d, run);
  out.simplex = frame.simplex();
  out.axes.assign(frame.axes().begin(), frame.axes().end());
}

/// Of numbers that are not zero.
struct Range {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  int lowest_bit = std::numeric_limits<int>::max();  ///< down to a limit

  void add(double v, int limit) {
    const double m = std::abs(v);
    if (m == 0) return;
    least = std::min(least, m);
    most = std::max(most, m);
    if (lowest_bit > limit) lowest_bit = std::min(lowest_bit, lowest_bit_exponent(v));
  }
};

/// Multiplies coordinates by 2^e and weights by 2^(2 e) so that none exceeds 1, if no bit is lost;
/// finds a lattice.
void scale(LiftedPoints& s) {
  Range x, w;
  int limit = std::numeric_limits<int>::min();
  for (std::uint32_t i = 0; i < s.count; ++i) {
    const double* r = s.row(i);
    for (unsigned j = 0; j < s.width; ++j) x.add(r[j], limit);
    if (s.weighted) w.add(r[s.width], limit);
  }
  int up = 0, weight_up = 0;
  if (x.most > 0) std::frexp(x.most, &up);
  if (w.most > 0) std::frexp(w.most, &weight_up);
  int e = x.most > 0 ? -up : 0;
  if (w.most > 0 && (x.most == 0 || 2 * e + weight_up > 0)) e = -((weight_up + 1) >> 1);
  // What stays above 2^-1022 loses nothing.
  const auto safe = [](const Range& r, int by) {
    return r.most == 0 || by >= 0 || std::ldexp(r.least, by) >= 0x1p-1021;
  };
  if (!safe(x, e) || !safe(w, 2 * e)) return;
  s.filtered = true;
  for (std::uint32_t i = 0; i < s.count; ++i) {
    double* r = s.rows.data() + std::size_t{i} * s.stride;
    for (unsigned j = 0; j < s.width; ++j) r[j] = std::ldexp(r[j], e);
    if (s.weighted) r[s.width] = std::ldexp(r[s.width], 2 * e);
  }
  // Differences of multiples of 2^unit up to 2 are exact where that is at least 2^-51.
  int unit = 0;
  if (x.most > 0) unit = x.lowest_bit + e;
  if (w.most > 0) unit = std::min(unit, (w.lowest_bit + 2 * e) >> 1);
  if (unit < -51) return;
  s.exact_limit = std::ldexp(1.0, 53 + unit * static_cast<int>(s.base + 2));
}

void check_weights(std::span<const double> weights) {
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (!std::isfinite(weights[i]))
      throw Error(ErrorCode::not_finite,
                  "the weight of point " + std::to_string(i) + " is not finite");
}

}  // namespace

Prepared prepare_points(const PointView& view, std::span<const double> weights, bool furthest,
                        const std::vector<std::uint32_t>& left_out, const Run& run) {
  const unsigned d = view.dimension;
  const auto n = static_cast<std::uint32_t>(view.count);
  const bool weighted = !weights.empty();
  const Array<double> rows = gather_points(view, nullptr, n, run);
  check_weights(weights);
  Prepared out;
  InsertionOrder order =
      insertion_order(rows.data(), n, d, weighted ? weights.data() : nullptr, run);
  out.duplicates = std::move(order.duplicates);
  if (!left_out.empty())
    std::erase_if(order.ids, [&](std::uint32_t id) {
      return std::binary_search(left_out.begin(), left_out.end(), id);
    });
  LiftedPoints& s = out.points;
  s.count = static_cast<std::uint32_t>(order.ids.size());
  s.ids = std::move(order.ids);
  s.width = d;
  s.stride = d + (weighted ? 1 : 0);
  s.weighted = weighted;
  s.furthest = furthest;
  s.may_hide = weighted || furthest;
  if (n == 0) return out;
  Array<double> sorted(std::size_t{s.count} * d);
  for (std::uint32_t i = 0; i < s.count; ++i)
    std::copy_n(rows.data() + std::size_t{s.ids[i]} * d, d, sorted.data() + std::size_t{i} * d);
  find_flat(sorted, s.count, d, out, run);
  s.base = static_cast<unsigned>(out.axes.size());
  if (s.base == d && !weighted) {
    s.rows = std::move(sorted);
  } else {
    std::vector<unsigned> columns(out.axes.begin(), out.axes.end());
    for (unsigned j = 0; j < d; ++j)
      if (!std::count(out.axes.begin(), out.axes.end(), j)) columns.push_back(j);
    s.rows.resize(std::size_t{s.count} * s.stride);
    for (std::uint32_t i = 0; i < s.count; ++i) {
      double* r = s.rows.data() + std::size_t{i} * s.stride;
      for (unsigned j = 0; j < d; ++j) r[j] = sorted[std::size_t{i} * d + columns[j]];
      if (weighted) r[d] = weights[s.ids[i]];
    }
  }
  scale(s);
  return out;
}

}  // namespace cullhull::internal
