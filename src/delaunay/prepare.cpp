#include "delaunay/prepare.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "cullhull/error.hpp"
#include "delaunay/insertion_order.hpp"
#include "exact/numbers/double_parts.hpp"
#include "exact/orientation/orientation.hpp"
#include "geometry/gather.hpp"
#include "geometry/local_frame.hpp"

namespace cullhull::internal {
namespace {

/// Places of k + 1 affinely independent of the points, and the axes of their flat. A few tuples
/// that are spread over the order suffice nearly always, where the points span all of space.
void find_flat(const Array<double>& rows, std::uint32_t n, unsigned d, Prepared& out,
               const Run& run) {
  out.axes.resize(d);
  std::iota(out.axes.begin(), out.axes.end(), 0U);
  constexpr std::uint32_t tries = 16;  // simplices; in general position the first is one
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
  int lowest_bit = std::numeric_limits<int>::max();

  /// `limit`: lowest bits below it are of no use.
  void add(double v, int limit) {
    const double m = std::abs(v);
    if (m == 0) return;
    least = std::min(least, m);
    most = std::max(most, m);
    if (lowest_bit > limit) lowest_bit = std::min(lowest_bit, lowest_bit_exponent(v));
  }
  void add(const Range& o) {
    least = std::min(least, o.least);
    most = std::max(most, o.most);
    lowest_bit = std::min(lowest_bit, o.lowest_bit);
  }
  /// Multiplied by 2^by, what stays above 2^-1022 loses nothing.
  bool safe(int by) const { return most == 0 || by >= 0 || std::ldexp(least, by) >= 0x1p-1021; }
};

/// Of coordinates and weights.
void measure(const LiftedPoints& s, Range& x, Range& w, const Run& run) {
  std::vector<Range> xs(chunk_count(s.count, light_grain)), ws(xs.size());
  run.each_chunk(s.count, light_grain,
                 [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    // A lattice of fewer than 2^-52 of a number of the chunk is none.
    const double first = std::abs(s.row(static_cast<std::uint32_t>(begin))[0]);
    const int limit = first > 0 ? std::ilogb(first) - 60 : std::numeric_limits<int>::min();
    for (std::uint64_t i = begin; i < end; ++i) {
      const double* r = s.row(static_cast<std::uint32_t>(i));
      for (unsigned j = 0; j < s.width; ++j) xs[c].add(r[j], limit);
      if (s.weighted) ws[c].add(r[s.width], std::numeric_limits<int>::min());
    }
  });
  for (std::size_t c = 0; c < xs.size(); ++c) {
    x.add(xs[c]);
    w.add(ws[c]);
  }
}

/// Multiplies coordinates by 2^e and weights by 2^(2 e) so that none exceeds 1, and finds a
/// lattice, if no bit is lost; else all stay as they are, of no lattice, and bounds allow for the
/// size.
void scale(LiftedPoints& s, const Run& run) {
  Range x, w;
  measure(s, x, w, run);
  int up = 0, weight_up = 0;
  if (x.most > 0) std::frexp(x.most, &up);
  if (w.most > 0) std::frexp(w.most, &weight_up);
  int e = x.most > 0 ? -up : 0;
  if (w.most > 0 && (x.most == 0 || 2 * e + weight_up > 0)) e = -((weight_up + 1) >> 1);
  if (!x.safe(e) || !w.safe(2 * e)) {
    // Left as they are. With at most 6 axes a determinant has degree 8: it stays below 2^600. With
    // more, elimination sees to its range itself.
    constexpr int most_unscaled = 64;
    s.filtered = -e <= most_unscaled;
    s.tiny = std::ldexp(0x1p-1000, static_cast<int>(s.base + 2) * std::min(-e, most_unscaled));
    return;
  }
  s.filtered = true;
  // In two steps, as 2^e itself may be no double.
  const auto half = [](int by) { return std::ldexp(1.0, by / 2); };
  const auto rest = [](int by) { return std::ldexp(1.0, by - by / 2); };
  const int weight_e = w.most > 0 ? 2 * e : 0;
  const double half_x = half(e), rest_x = rest(e), half_w = half(weight_e), rest_w = rest(weight_e);
  run.each(s.count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      double* r = s.rows.data() + i * s.stride;
      for (unsigned j = 0; j < s.width; ++j) r[j] = r[j] * half_x * rest_x;
      if (s.weighted) r[s.width] = r[s.width] * half_w * rest_w;
    }
  });
  // Differences of multiples of 2^unit up to 2 are exact where that is at least 2^-51.
  int unit = 0;
  if (x.most > 0) unit = x.lowest_bit + e;
  if (w.most > 0) unit = std::min(unit, (w.lowest_bit + 2 * e) >> 1);
  if (unit < -51) return;
  s.exact_limit = std::ldexp(1.0, 53 + unit * static_cast<int>(s.base + 2));
}

/// Rows of the points that are inserted, in order: the flat's axes first, the weight last.
void gather_rows(const Array<double>& rows, std::span<const double> weights, Prepared& out,
                 const Run& run) {
  LiftedPoints& s = out.points;
  const unsigned d = s.width;
  const std::vector<std::uint32_t> columns = flat_columns(out.axes, d);
  Array<double> sorted(std::size_t{s.count} * s.stride);
  run.each(s.count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      double* r = sorted.data() + i * s.stride;
      for (unsigned j = 0; j < d; ++j) r[j] = rows[i * d + columns[j]];
      if (s.weighted) r[d] = weights[s.ids[i]];
    }
  });
  s.rows = std::move(sorted);
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
  run.each(s.count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i)
      for (unsigned j = 0; j < d; ++j) sorted[i * d + j] = rows[std::size_t{s.ids[i]} * d + j];
  });
  find_flat(sorted, s.count, d, out, run);
  s.base = static_cast<unsigned>(out.axes.size());
  if (s.base == d && !weighted)
    s.rows = std::move(sorted);
  else
    gather_rows(sorted, weights, out, run);
  scale(s, run);
  return out;
}

}  // namespace cullhull::internal
