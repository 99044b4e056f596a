#include "delaunay/prepare.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "cullhull/error.hpp"
#include "delaunay/common_sphere.hpp"
#include "exact/numbers/double_parts.hpp"
#include "exact/orientation/orientation.hpp"
#include "geometry/curve_frame.hpp"
#include "geometry/gather.hpp"
#include "geometry/insertion_rounds.hpp"
#include "geometry/local_frame.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/radix_sort.hpp"
#include "parallel/random_stream.hpp"
#include "parallel/scan.hpp"

namespace cullhull::internal {
namespace {

// ----------------------------------------------------------------- the order of insertion

/// Sorts points along Hilbert curves.
class Sorter {
 public:
  Sorter(const double* rows, unsigned d, const Run& run)
      : rows_(rows), d_(d), run_(run), frame_(d) {}

  // Example: a million points of a town and one at (0, 0), a lost GPS fix: the box is thousands of
  // kilometres wide, and all of the town falls into one cell of the curve. These points are sorted
  // once more along a curve over their own box, where they have cells of their own. Each level
  // removes remote points, so it is seldom needed twice.

  /// Sorts items[0, n) along a Hilbert curve over their bounding box; equal points by id. If a few
  /// remote points enlarge the box, many items share a key; these are sorted along a curve over
  /// their own box.
  void sort(KeyedId* items, KeyedId* scratch, std::uint32_t n) {
    if (n < 2) return;
    if (!place(items, n)) return sort_by_coordinates({items, n});
    KeyedId *from = items, *to = scratch;
    radix_sort(from, to, n, frame_.key_bits(), run_);
    if (from != items)
      run_.each(n, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
        std::copy(from + begin, from + end, items + begin);
      });
    // Items with equal keys are found before any of them moves, as others look at them meanwhile.
    std::vector<std::vector<Items>> found(chunk_count(n, light_grain));
    run_.each_chunk(n, light_grain, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      const auto same = [&](std::uint64_t i) { return items[i].key == items[i - 1].key; };
      while (begin > 0 && begin < end && same(begin)) ++begin;
      for (std::uint64_t last = begin; begin < end; begin = last) {
        for (++last; last < n && same(last);) ++last;
        if (last - begin > 1)
          found[c].push_back({items + begin, static_cast<std::uint32_t>(last - begin)});
      }
    });
    run_.each_item(found.size(), [&](std::uint64_t c) {
      for (const Items& list : found[c])
        if (list.size() <= few || list.size() == n) sort_by_coordinates(list);
    });
    for (const auto& lists : found)
      for (const Items& list : lists)
        if (list.size() > few && list.size() < n) {
          run_.check();
          sort(list.data(), scratch, static_cast<std::uint32_t>(list.size()));
        }
  }

  bool equal(std::uint32_t a, std::uint32_t b) const {
    return std::equal(row(a), row(a) + d_, row(b));
  }

 private:
  /// Up to this many points with the same key are sorted by coordinates; radix_sort() counts digits
  /// only from 48 items on.
  static constexpr std::uint32_t few = 48;
  using Items = std::span<KeyedId>;

  const double* row(std::uint32_t i) const { return rows_ + std::size_t{i} * d_; }
  bool less(std::uint32_t a, std::uint32_t b) const {
    for (unsigned j = 0; j < d_; ++j)
      if (row(a)[j] != row(b)[j]) return row(a)[j] < row(b)[j];
    return a < b;
  }

  void sort_by_coordinates(Items items) const {
    std::sort(items.begin(), items.end(),
              [&](const KeyedId& a, const KeyedId& b) { return less(a.id, b.id); });
  }

  /// Computes the items' curve keys; false if the box is a point or too small for keys.
  bool place(KeyedId* items, std::uint32_t n) {
    const auto row_of = [&](std::uint64_t i) { return row(items[i].id); };
    if (!frame_.measure(n, row_of, run_)) return false;
    with_dimension<2, 4, 0>(d_, [&](auto d) {
      run_.each(n, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
        KeyedId* const own = items + begin;
        frame_.keys<d()>(
            end - begin, [&](std::uint64_t i) { return row(own[i].id); },
            [&](std::uint64_t i, std::uint32_t key) { own[i].key = key; });
      });
    });
    return true;
  }

  const double* rows_;
  unsigned d_;
  const Run& run_;
  CurveFrame frame_;
};

// Why rounds: a point of a random order is inserted in constant expected time whatever the points
// are, but jumps about in memory; points along a curve stay in the cache, but a curve alone can
// meet the worst case (a cavity of everything). Rounds have both (Amenta, Choi, Rote 2003).
// Example: the last rounds of a million points have about 14,000, 109,000 and 875,000.

/// Distributes ids to rounds; within a round they keep their order. Each round is expected to hold
/// 8 times as many points as the one before. The choice is pseudorandom, the same in every run.
/// `items`, `scratch`: room for as many items.
void sort_into_rounds(Array<std::uint32_t>& ids, KeyedId* items, KeyedId* scratch, const Run& run) {
  const InsertionRounds rounds(ids.size(), 1U << 10, 3);
  if (rounds.count == 1) return;
  run.each(ids.size(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      XorShift random((i + 1) * XorShift::golden);
      random.next();
      items[i] = {rounds.round_of(random.next()), ids[i]};
    }
  });
  radix_sort(items, scratch, static_cast<std::uint32_t>(ids.size()),
             static_cast<unsigned>(std::bit_width(rounds.count - 1)), run);
  run.each(ids.size(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) ids[i] = items[i].id;
  });
}

/// Sets the ids of n points of d finite coordinates each in the order of insertion, and duplicates:
/// rounds of growing size, each sorted along a Hilbert curve (Amenta, Choi, Rote 2003). The sort
/// also finds equal points. `weights`: null, or one per point. The
/// representative of equal points is the one that is lowest in the lift, so of the largest weight;
/// for the upper hull (`furthest`) the highest one, of the smallest weight; then of the lowest id.
/// The order affects the running time, never the triangulation.
void find_order(const double* rows, std::uint32_t n, unsigned d, const double* weights,
                bool furthest, Prepared& out, const Run& run) {
  Array<std::uint32_t>& ids = out.points.ids;
  Array<KeyedId> items(n), scratch(n);
  run.each(n, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) items[i] = {0, static_cast<std::uint32_t>(i)};
  });
  Sorter sorter(rows, d, run);
  sorter.sort(items.data(), scratch.data(), n);
  const auto same = [&](std::uint64_t i) {
    return i > 0 && i < n && items[i].key == items[i - 1].key &&
           sorter.equal(items[i].id, items[i - 1].id);
  };
  // Each chunk writes the representatives of the equal points that begin in it.
  pack(
      n, light_grain, run, [&](std::uint64_t i) { return !same(i); },
      [&](std::uint64_t total) {
    ids.resize(total);
    return true;
      },
      [&](std::uint64_t begin, std::uint64_t place) {
    std::uint32_t best = items[begin].id;
    std::uint64_t end = begin + 1;
    for (; same(end); ++end) {
      const std::uint32_t id = items[end].id;
      const double more = weights == nullptr ? 0 : weights[id] - weights[best];
      if (more == 0 ? id < best : (more > 0) != furthest) best = id;
    }
    for (std::uint64_t i = begin; i < end; ++i) scratch[i].id = best;
    ids[place] = best;
  });
  if (ids.size() < n)
    pack(
        n, light_grain, run, [&](std::uint64_t i) { return items[i].id != scratch[i].id; },
        [&](std::uint64_t total) {
      out.duplicates.resize(total);
      return true;
        },
        [&](std::uint64_t i, std::uint64_t place) {
      out.duplicates[place] = {items[i].id, scratch[i].id};
    });
  std::sort(out.duplicates.begin(), out.duplicates.end(),
            [](const DuplicatePoint& a, const DuplicatePoint& b) { return a.id < b.id; });
  sort_into_rounds(ids, items.data(), scratch.data(), run);
}

// ----------------------------------------------------------------------- flat and scale

// Tuples are spread over the order, which follows a curve in rounds, so their points are far from
// each other and an orientation in doubles decides. Only if all tuples are flat is the rank of all
// points found, exactly. Example: points of a plane in space: every tuple of four has the
// orientation zero; the flat's basis follows from an exact elimination, and its pivot columns are
// the axes to work in.

/// Finds k + 1 affinely independent points, as places in the order, and the axes of the points'
/// flat. If the points span the whole space, one of a few tuples spread over the order nearly
/// always works.
void find_flat(const Array<double>& rows, std::uint32_t n, unsigned d, Prepared& out,
               const Run& run) {
  out.axes.resize(d);
  std::iota(out.axes.begin(), out.axes.end(), 0U);
  constexpr std::uint32_t tries = 16;  // tuples; in general position the first is independent
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

/// The range of magnitudes of numbers other than zero.
struct Range {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  int lowest_bit = std::numeric_limits<int>::max();

  /// `limit`: a lowest bit below it need not be determined exactly.
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
  /// Whether multiplying the numbers by 2^by is exact because all of them stay normal.
  bool safe(int by) const { return most == 0 || by >= 0 || std::ldexp(least, by) >= 0x1p-1021; }
};

/// The ranges of the coordinates and of the weights.
void measure(const LiftedPoints& s, Range& x, Range& w, const Run& run) {
  std::vector<Range> xs(chunk_count(s.count, light_grain)), ws(xs.size());
  run.each_chunk(s.count, light_grain,
                 [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    // A lattice finer than 2^-52 of a number of the chunk cannot be used.
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

// What a lattice is worth: if all coordinates are multiples of 2^unit, a determinant of k
// coordinates and a lift is a multiple of 2^(unit (k + 2)). While the sum of all products is below
// 2^53 of these, doubles hold every partial result exactly, and a computed zero is a zero. Example:
// a raster of 1,024 x 1,024 pixels is scaled to [0, 1) with unit = -10, exact_limit = 2^(53 - 40) =
// 8192: that is far above any product of magnitudes (6 * 1 * 1 * 2 = 12), so all of its in-circle
// tests, most of them ties, are decided in doubles.
//
// Why unscaled points keep their filters up to 2^64: with x = 2^l y every operation gives 2^(r l)
// times what it gives on y, r being the degree of the result, and rounds alike. So relative bounds
// hold as they are; an underflow of 2^-1074 in a result of degree r is one of 2^(-1074 - r l) on y,
// and 2^(-1000 + (k + 2) l) covers all of them.

/// Multiplies coordinates by 2^e and weights by 2^(2 e) so that none exceeds 1, and finds a lattice
/// that all of them are on. If the product would not be exact, nothing is scaled, there is no
/// lattice, and the error bounds allow for the points' size.
void scale(LiftedPoints& s, const Run& run) {
  Range x, w;
  measure(s, x, w, run);
  int up = 0, weight_up = 0;
  if (x.most > 0) std::frexp(x.most, &up);
  if (w.most > 0) std::frexp(w.most, &weight_up);
  int e = x.most > 0 ? -up : 0;
  if (w.most > 0 && (x.most == 0 || 2 * e + weight_up > 0)) e = -((weight_up + 1) >> 1);
  if (!x.safe(e) || !w.safe(2 * e)) {
    // With at most 6 axes a determinant has degree 8 and stays below 2^600. With more axes,
    // elimination takes care of the range itself.
    constexpr int most_unscaled = 64;
    s.filtered = -e <= most_unscaled;
    s.tiny = std::ldexp(0x1p-1000, static_cast<int>(s.base + 2) * std::min(-e, most_unscaled));
    return;
  }
  s.filtered = true;
  // In two steps, because 2^e itself may not be a double.
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
  // Differences up to 2 of multiples of 2^unit are exact if unit >= -51.
  int unit = 0;
  if (x.most > 0) unit = x.lowest_bit + e;
  if (w.most > 0) unit = std::min(unit, (w.lowest_bit + 2 * e) >> 1);
  if (unit < -51) return;
  s.exact_limit = std::ldexp(1.0, 53 + unit * static_cast<int>(s.base + 2));
  s.exact_orientation_limit = std::ldexp(1.0, 53 + unit * static_cast<int>(s.base));
}

/// The rows of the inserted points, in order: these columns, then the weight if there are weights.
Array<double> rows_of(const LiftedPoints& s, const Array<double>& rows,
                      const std::vector<std::uint32_t>& columns, std::span<const double> weights,
                      const Run& run) {
  const std::size_t d = columns.size(), stride = d + (weights.empty() ? 0 : 1);
  Array<double> sorted(s.count * stride);
  run.each(s.count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      double* r = sorted.data() + i * stride;
      const double* from = rows.data() + s.ids[i] * d;
      for (std::size_t j = 0; j < d; ++j) r[j] = from[columns[j]];
      if (stride > d) r[d] = weights[s.ids[i]];
    }
  });
  return sorted;
}

void check_weights(std::span<const double> weights) {
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (!std::isfinite(weights[i]))
      throw Error(ErrorCode::not_finite, "the weight of point ", i, " is not finite");
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
  LiftedPoints& s = out.points;
  find_order(rows.data(), n, d, weighted ? weights.data() : nullptr, furthest, out, run);
  if (!left_out.empty())
    std::erase_if(s.ids, [&](std::uint32_t id) {
      return std::binary_search(left_out.begin(), left_out.end(), id);
    });
  s.count = static_cast<std::uint32_t>(s.ids.size());
  s.width = d;
  s.stride = d + (weighted ? 1 : 0);
  s.weighted = weighted;
  s.furthest = furthest;
  s.may_hide = weighted || furthest;
  if (n == 0) return out;
  Array<double> sorted = rows_of(s, rows, flat_columns({}, d), {}, run);
  find_flat(sorted, s.count, d, out, run);
  s.base = static_cast<unsigned>(out.axes.size());
  s.rows = s.base == d && !weighted ? std::move(sorted)
                                    : rows_of(s, rows, flat_columns(out.axes, d), weights, run);
  scale(s, run);
  find_common_sphere(s, out.simplex, run);
  return out;
}

}  // namespace cullhull::internal
