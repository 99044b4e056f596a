// The hull in the plane: discard below a sampled inner hull, sort, one scan for both chains.
//
// Everything that decides is exact. The sort compares coordinates, the scan asks for the sign of
// the exact determinant, and the discard drops a point only when it is strictly between two chains
// of hull points by more than the rounding of their evaluation.
#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <utility>

#include "hull/engine.hpp"
#include "parallel/big_array.hpp"
#include "predicates/orientation.hpp"

namespace cullhull::internal {
namespace {

struct Point {
  double x, y;
};

constexpr std::uint32_t block = 1024;  // points between two looks at the stop token
constexpr unsigned digit_bits = 11;    // 2048 counters stay in the first-level cache
constexpr std::uint32_t sample_size = 1U << 16, discard_from = 1U << 14;

/// Sign of the turn a, b, c: rungs 2 and 3.
class Turn {
 public:
  explicit Turn(const LocalPoints& points)
      : lattice_(points.small_lattice && points.coordinates == points.exact),
        scaled_(points.coordinates != points.exact) {}

  /// With u = 2^-53 the differences and products are off by the factor (1 + u)^3 at most, the last
  /// subtraction and the evaluation of the bound itself by 1 + u each: (3 + 16u) u (|l| + |r|)
  /// covers them (Shewchuk 1997, ccwerrboundA); the doubled second term covers the sum with `tiny`.
  /// |coordinates| <= 1 excludes overflow. A product may underflow by 2^-1075: `tiny` is far above.
  int operator()(const Point& a, const Point& b, const Point& c) {
    constexpr double u = 0x1p-53, bound = (3 + 32 * u) * u, tiny = 0x1p-1060;
    if (!scaled_) {
      const double l = (a.x - c.x) * (b.y - c.y);
      const double r = (a.y - c.y) * (b.x - c.x);
      const double det = l - r;
      const double error = bound * (std::fabs(l) + std::fabs(r)) + tiny;
      if (lattice_ || std::fabs(det) > error) {
        ++counts_[static_cast<int>(Rung::filter)];
        return det > 0 ? 1 : det < 0 ? -1 : 0;
      }
    }
    return slow(a, b, c);
  }

  const std::uint64_t* counts() const { return counts_; }

 private:
  int slow(const Point& a, const Point& b, const Point& c) {
    const double* p[3] = {&a.x, &b.x, &c.x};
    Rung rung = Rung::exact;
    const Sign s = scaled_ ? orientation(2, p, &rung) : orientation_exact(2, p);
    ++counts_[static_cast<int>(rung)];
    return static_cast<int>(s);
  }

  bool lattice_, scaled_;
  std::uint64_t counts_[3] = {0, 0, 0};
};

/// Points in lexicographic order (x, then y, then id), at their exact coordinates.
struct Sorted {
  std::uint32_t count = 0;
  BigArray<std::uint64_t> keys;  // low half: local id
  BigArray<std::byte> room;      // of the points; before them, of the sort's second buffer
  Point* points = nullptr;

  std::uint32_t id(std::uint32_t i) const { return static_cast<std::uint32_t>(keys[i]); }
};

bool before(const Point& a, const Point& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }
bool equal(const Point& a, const Point& b) { return a.x == b.x && a.y == b.y; }

/// Stable radix sort of the high halves: `passes` digits from bit 32 up. The sorted keys end in
/// `keys`; `spare` is as large.
void radix_sort(BigArray<std::uint64_t>& keys, std::uint64_t* spare, std::uint32_t count,
                unsigned passes) {
  constexpr std::uint32_t radix = 1U << digit_bits;
  std::vector<std::uint32_t> histogram(std::size_t{radix} * passes, 0);
  for (std::uint32_t i = 0; i < count; ++i)
    for (unsigned p = 0; p < passes; ++p)
      ++histogram[p * radix + (keys[i] >> (32 + p * digit_bits)) % radix];
  std::uint64_t* from = keys.get();
  std::uint64_t* to = spare;
  for (unsigned p = 0; p < passes; ++p) {
    std::uint32_t* next = &histogram[p * radix];
    std::uint32_t sum = 0;
    for (std::uint32_t d = 0; d < radix; ++d) sum += std::exchange(next[d], sum);
    for (std::uint32_t i = 0; i < count; ++i)
      to[next[(from[i] >> (32 + p * digit_bits)) % radix]++] = from[i];
    std::swap(from, to);
  }
  if (from != keys.get()) std::copy(from, from + count, keys.get());
}

/// Puts a run of equal keys in order by the coordinates themselves.
void sort_run(Sorted& s, std::uint32_t begin, std::uint32_t end,
              std::vector<std::pair<Point, std::uint64_t>>& scratch) {
  const auto less = [](const auto& a, const auto& b) {
    return before(a.first, b.first) || (equal(a.first, b.first) && a.second < b.second);
  };
  // Ids ascend already, so equal points are in order.
  bool sorted = true;
  for (std::uint32_t i = begin + 1; sorted && i < end; ++i)
    sorted = !before(s.points[i], s.points[i - 1]);
  if (sorted) return;
  if (end - begin == 2) {
    std::swap(s.points[begin], s.points[begin + 1]);
    std::swap(s.keys[begin], s.keys[begin + 1]);
    return;
  }
  scratch.clear();
  for (std::uint32_t i = begin; i < end; ++i) scratch.emplace_back(s.points[i], s.keys[i]);
  std::sort(scratch.begin(), scratch.end(), less);
  for (std::uint32_t i = begin; i < end; ++i) {
    s.points[i] = scratch[i - begin].first;
    s.keys[i] = scratch[i - begin].second;
  }
}

/// Least and greatest x, by four independent chains of comparisons.
std::pair<double, double> range_of_x(const LocalPoints& points, const std::uint32_t* ids,
                                     std::uint32_t count) {
  double low[4], high[4];
  std::fill(low, low + 4, points.row(ids ? ids[0] : 0)[0]);
  std::copy(low, low + 4, high);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double x = points.row(ids ? ids[i] : i)[0];
    low[i % 4] = std::min(low[i % 4], x);
    high[i % 4] = std::max(high[i % 4], x);
  }
  return {*std::min_element(low, low + 4), *std::max_element(high, high + 4)};
}

/// Lexicographic order of the points `ids` (ascending; nullptr: all). The radix sort is on x
/// quantised by a monotone map, so only points with equal keys remain to be compared.
Sorted sort_points(const LocalPoints& points, const std::uint32_t* ids, std::uint32_t count,
                   const Control& control) {
  Sorted s;
  s.count = count;
  s.keys = BigArray<std::uint64_t>(count);
  s.room = BigArray<std::byte>(std::size_t{count} * sizeof(Point));
  const auto id_of = [&](std::uint32_t i) { return ids ? ids[i] : i; };

  const auto [low, high] = range_of_x(points, ids, count);
  // With more bits than the count has, few keys are equal; the third digit is short of 32.
  const unsigned passes = count <= (1U << (digit_bits - 2))       ? 1
                          : count <= (1U << (2 * digit_bits - 2)) ? 2
                                                                  : 3;
  const double top = std::ldexp(1.0, static_cast<int>(std::min(32U, passes * digit_bits))) - 1;
  const double range = high - low;
  const double scale = range > 0x1p-900 ? top / range : 0;  // 0: one run, still sorted exactly
  control.check();
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t id = id_of(i);
    const double q = std::min((points.row(id)[0] - low) * scale, top);
    s.keys[i] = static_cast<std::uint64_t>(static_cast<std::int64_t>(q)) << 32 | id;
  }
  control.check();
  radix_sort(s.keys, reinterpret_cast<std::uint64_t*>(s.room.get()), count, passes);
  control.check();
  s.points = reinterpret_cast<Point*>(s.room.get());
  for (std::uint32_t i = 0; i < count; ++i) {
    const double* p = points.exact_row(s.id(i));
    s.points[i] = {p[0], p[1]};
  }
  std::vector<std::pair<Point, std::uint64_t>> scratch;
  for (std::uint32_t i = 0; i < count;) {
    std::uint32_t end = i + 1;
    while (end < count && s.keys[end] >> 32 == s.keys[i] >> 32) ++end;
    if (end - i > 1) {
      sort_run(s, i, end, scratch);
      if (end - i > block) control.check();
    }
    i = end;
  }
  return s;
}

/// Positions (in a Sorted) of the strictly convex chains from the first point to the last.
struct Chains {
  std::vector<std::uint32_t> lower, upper;
};

/// Adds point i to a chain that turns `side` at every vertex (+1 left, -1 right).
void extend(const Point* p, std::vector<std::uint32_t>& chain, std::uint32_t i, int side,
            Turn& turn) {
  while (chain.size() >= 2) {
    const std::size_t m = chain.size();
    if (turn(p[chain[m - 2]], p[chain[m - 1]], p[i]) * side > 0) break;
    chain.pop_back();
  }
  chain.push_back(i);
}

/// Both chains in one sweep over the sorted points. The points of a block are first divided by the
/// chord from the first point to the last, without branches, since in general nothing predicts the
/// side; a point too near the chord to tell goes to both, which is always right.
Chains scan(const Sorted& s, Turn& turn, const Control& control) {
  Chains chains;
  const Point* p = s.points;
  const std::uint32_t last = s.count - 1;
  const Point a = p[0], b = p[last];
  chains.lower.push_back(0);
  chains.upper.push_back(0);
  std::uint32_t low[block], high[block];
  for (std::uint32_t begin = 1; begin < last; begin += std::min(block, last - begin)) {
    control.check();
    if (begin / block % 1024 == 1) control.report("hull", double(begin) / s.count);
    const std::uint32_t end = begin + std::min(block, last - begin);
    std::uint32_t lows = 0, highs = 0;
    for (std::uint32_t i = begin; i < end; ++i) {
      const double l = (a.x - p[i].x) * (b.y - p[i].y);
      const double r = (a.y - p[i].y) * (b.x - p[i].x);
      // As in Turn, rounded up; where coordinates are not in [-1, 1] a NaN or infinity may come of
      // overflow, and both comparisons are false then.
      const double error = 0x1p-51 * (std::fabs(l) + std::fabs(r)) + 0x1p-1060;
      const bool above = l - r > error, below = r - l > error, fresh = !equal(p[i - 1], p[i]);
      low[lows] = i;
      lows += fresh && !above;
      high[highs] = i;
      highs += fresh && !below;
    }
    for (std::uint32_t i = 0; i < lows; ++i) extend(p, chains.lower, low[i], 1, turn);
    for (std::uint32_t i = 0; i < highs; ++i) extend(p, chains.upper, high[i], -1, turn);
  }
  // Of points equal to the last the lowest id, which the sweep met first, must be the vertex.
  std::uint32_t end = last;
  while (end > 0 && equal(p[end - 1], b)) --end;
  if (chains.lower.back() != end) extend(p, chains.lower, end, 1, turn);
  if (chains.upper.back() != end) extend(p, chains.upper, end, -1, turn);
  return chains;
}

/// What lies between two chains of input points, over buckets of x: a point of bucket i with
/// floor[i] < y < ceiling[i] is in their hull and no vertex of it.
class Strip {
 public:
  static constexpr unsigned buckets = 1024;

  /// Positions of `chains` refer to `s`. False if the points are too narrow for the bounds below.
  bool build(const LocalPoints& points, const Sorted& s, const Chains& chains) {
    const auto gather = [&](const std::vector<std::uint32_t>& chain) {
      std::vector<Point> out;
      for (std::uint32_t i : chain) {
        const double* p = points.row(s.id(i));
        // Without vertical pieces: of points with one x the innermost counts, which is the later at
        // the left end and the earlier at the right one.
        if (!out.empty() && out.back().x == p[0]) {
          if (out.size() == 1) out.back().y = p[1];
          continue;
        }
        out.push_back({p[0], p[1]});
      }
      return out;
    };
    const std::vector<Point> lower = gather(chains.lower), upper = gather(chains.upper);
    if (lower.size() < 2 || upper.size() < 2) return false;
    left_ = lower.front().x;
    const double right = lower.back().x, range = right - left_;
    if (!(range >= 0x1p-10)) return false;
    scale_ = buckets / range;
    const double width = range / buckets;
    std::size_t l = 0, u = 0;
    for (unsigned i = 0; i < buckets; ++i) {
      // The bucket of x is (x - left) * scale, truncated. Its two roundings and those of the next
      // lines come to less than 8 * buckets * 2^-53 widths plus 2^-53; a width is at least 2^-20,
      // so 2^-10 widths more on either side cover them.
      const double x0 = std::max(left_, left_ + (i - 0x1p-10) * width);
      const double x1 = std::min(right, left_ + (i + 1 + 0x1p-10) * width);
      // A chain's height at x is off by 12 * 2^-53 at most (five roundings of a term below 2, one
      // of a sum below 2). The lower chain is convex, the upper concave: extremes are at the ends.
      constexpr double margin = 0x1p-48;
      cells_[i].floor = std::max(height(lower, l, x0), height(lower, l, x1)) + margin;
      cells_[i].ceiling = std::min(height(upper, u, x0), height(upper, u, x1)) - margin;
    }
    return true;
  }

  bool contains(double x, double y) const {
    const double t = (x - left_) * scale_;
    const Cell& c = cells_[static_cast<int>(std::min(std::max(t, 0.0), buckets - 1.0))];
    return (t >= 0) & (t < buckets) & (y > c.floor) & (y < c.ceiling);
  }

 private:
  struct Cell {
    double floor, ceiling;
  };

  /// `from` moves to the piece that x is on; x does not decrease by more than a bucket.
  static double height(const std::vector<Point>& chain, std::size_t& from, double x) {
    while (from > 0 && chain[from].x > x) --from;
    while (from + 2 < chain.size() && chain[from + 1].x < x) ++from;
    const Point &a = chain[from], &b = chain[from + 1];
    return a.y + (b.y - a.y) * ((x - a.x) / (b.x - a.x));
  }

  double left_ = 0, scale_ = 0;
  Cell cells_[buckets];
};

/// Ids of the points that may be extreme, or nothing where a sample says that it does not pay.
std::vector<std::uint32_t> discard(const LocalPoints& points, Turn& turn, const Control& control) {
  std::vector<std::uint32_t> ids;
  // Where scaling lost bits the sample's chains are known only up to them.
  if (points.count < discard_from || points.coordinates != points.exact) return ids;
  const std::uint32_t m = std::min(sample_size, points.count / 32);
  std::vector<std::uint32_t> sample(m);
  for (std::uint32_t i = 0; i < m; ++i)
    sample[i] = static_cast<std::uint32_t>(std::uint64_t{points.count} * i / m);
  const Sorted sorted = sort_points(points, sample.data(), m, control);
  const Chains chains = scan(sorted, turn, control);
  // Efron 1965: the share of points outside a sample's hull is about its vertices' share of it.
  if (chains.lower.size() + chains.upper.size() > m / 2) return ids;
  const auto strip = std::make_unique<Strip>();
  if (!strip->build(points, sorted, chains)) return ids;

  std::uint32_t kept[block];
  for (std::uint32_t begin = 0; begin < points.count;
       begin += std::min(block, points.count - begin)) {
    control.check();
    const std::uint32_t end = begin + std::min(block, points.count - begin);
    std::uint32_t k = 0;
    for (std::uint32_t i = begin; i < end; ++i) {
      const double* p = points.row(i);
      kept[k] = i;
      k += !strip->contains(p[0], p[1]);
    }
    ids.insert(ids.end(), kept, kept + k);
  }
  return ids;
}

}  // namespace

SimplicialHull hull_2d(const LocalPoints& points, const Control& control) {
  Turn turn(points);
  const std::vector<std::uint32_t> ids = discard(points, turn, control);
  const Sorted sorted = ids.empty() ? sort_points(points, nullptr, points.count, control)
                                    : sort_points(points, ids.data(),
                                                  static_cast<std::uint32_t>(ids.size()), control);
  const Chains chains = scan(sorted, turn, control);
  // Both chains hold the first and the last point.
  const std::size_t n = chains.lower.size() + chains.upper.size() - 2;
  if (n < 3) throw Error(ErrorCode::internal, "hull_2d was given collinear points");

  SimplicialHull hull;
  hull.dimension = 2;
  hull.vertices.reserve(2 * n);
  hull.neighbours.reserve(2 * n);
  // Counter-clockwise: the lower chain forwards, the upper one backwards. Edge i runs from corner i
  // to corner i + 1; it is written end first, so that the inside has negative orientation.
  const std::size_t m = chains.lower.size(), last = chains.upper.size() - 1;
  const auto corner = [&](std::size_t i) {
    return sorted.id(i < m ? chains.lower[i] : chains.upper[last - (i - m) - 1]);
  };
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t previous = i == 0 ? n - 1 : i - 1, next = i + 1 == n ? 0 : i + 1;
    hull.vertices.push_back(corner(next));
    hull.vertices.push_back(corner(i));
    hull.neighbours.push_back(static_cast<std::uint32_t>(previous));
    hull.neighbours.push_back(static_cast<std::uint32_t>(next));
  }
  std::copy(turn.counts(), turn.counts() + 3, hull.rung_counts);
  return hull;
}

}  // namespace cullhull::internal
