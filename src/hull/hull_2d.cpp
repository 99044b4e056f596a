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
#include "parallel/parallel.hpp"
#include "predicates/orientation.hpp"

namespace cullhull::internal {
namespace {

struct Point {
  double x, y;
};

constexpr std::uint32_t block = 1024;  // points between two looks at the stop token
constexpr std::uint32_t sample_size = 1U << 16, discard_from = 1U << 14;

/// A point at its exact coordinates, with the local id and a key that ascends with x.
struct Entry {
  double x, y;
  std::uint32_t id, key;
};

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
  int operator()(const Entry& a, const Entry& b, const Entry& c) {
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
  void add_counts(const Turn& other) {
    for (int i = 0; i < 3; ++i) counts_[i] += other.counts_[i];
  }

 private:
  int slow(const Entry& a, const Entry& b, const Entry& c) {
    const double* p[3] = {&a.x, &b.x, &c.x};
    Rung rung = Rung::exact;
    const Sign s = scaled_ ? orientation(2, p, &rung) : orientation_exact(2, p);
    ++counts_[static_cast<int>(rung)];
    return static_cast<int>(s);
  }

  bool lattice_, scaled_;
  std::uint64_t counts_[3] = {0, 0, 0};
};

bool before(const Entry& a, const Entry& b) {
  return a.x < b.x || (a.x == b.x && (a.y < b.y || (a.y == b.y && a.id < b.id)));
}
bool equal(const Entry& a, const Entry& b) { return a.x == b.x && a.y == b.y; }

/// Points in lexicographic order (x, then y, then id).
struct Sorted {
  std::uint32_t count = 0;
  BigArray<Entry> entries;

  const Entry& operator[](std::uint32_t i) const { return entries[i]; }
};

/// Sorts points by x quantised to 32 bits (a monotone map, so ties alone need a comparison): one
/// pass deals them to buckets by the leading bits, then every bucket, now in the cache, is dealt
/// out by further bits and finished by comparisons.
class Sorter {
 public:
  /// `ids` ascending; nullptr: all points.
  Sorter(const LocalPoints& points, const std::uint32_t* ids, std::uint32_t count, unsigned threads,
         const Control& control)
      : points_(points), ids_(ids), count_(count), threads_(threads), control_(control) {}

  Sorted run() {
    Sorted s;
    s.count = count_;
    s.entries = BigArray<Entry>(count_);
    if (count_ <= few) {
      for (std::uint32_t i = 0; i < count_; ++i) s.entries[i] = entry(id(i), 0);
      std::sort(s.entries.get(), s.entries.get() + count_, before);
      return s;
    }
    measure();
    bits_ = std::min(max_bits, static_cast<unsigned>(std::bit_width(count_ / bucket_size)));
    deal(s.entries.get());
    for_each_chunk(std::uint64_t{1} << bits_, 16, threads_,
                   [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                     control_.check();
                     std::vector<Entry> scratch;
                     std::vector<std::uint32_t> next;
                     for (std::uint64_t b = begin; b < end; ++b)
                       sort_bucket(s.entries.get() + start_[b], s.entries.get() + start_[b + 1],
                                   scratch, next);
                   });
    return s;
  }

 private:
  static constexpr std::uint32_t few = 128, bucket_size = 1024;
  static constexpr unsigned max_bits = 12;
  static constexpr std::uint64_t chunk = std::uint64_t{1} << 16;

  std::uint32_t id(std::uint64_t i) const {
    return ids_ != nullptr ? ids_[i] : static_cast<std::uint32_t>(i);
  }
  Entry entry(std::uint32_t id, std::uint32_t key) const {
    const double* p = points_.exact_row(id);
    return {p[0], p[1], id, key};
  }

  void measure() {
    const std::uint64_t chunks = chunk_count(count_, chunk);
    std::vector<std::pair<double, double>> ranges(chunks);
    for_each_chunk(
        count_, chunk, threads_, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
          control_.check();
          // Four chains of comparisons, so that none waits for the other.
          double low[4], high[4];
          std::fill(low, low + 4, points_.row(id(begin))[0]);
          std::copy(low, low + 4, high);
          for (std::uint64_t i = begin; i < end; ++i) {
            const double x = points_.row(id(i))[0];
            low[i % 4] = std::min(low[i % 4], x);
            high[i % 4] = std::max(high[i % 4], x);
          }
          ranges[c] = {*std::min_element(low, low + 4), *std::max_element(high, high + 4)};
        });
    low_ = ranges[0].first;
    double high = ranges[0].second;
    for (const auto& [l, h] : ranges) {
      low_ = std::min(low_, l);
      high = std::max(high, h);
    }
    const double range = high - low_;
    scale_ = range > 0x1p-900 ? top / range : 0;  // 0: one run, still sorted exactly
  }

  std::uint32_t key(std::uint32_t id) const {
    const double q = std::min((points_.row(id)[0] - low_) * scale_, top);
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(q));
  }

  /// Stable: within a bucket points keep their order, so ids ascend.
  void deal(Entry* out) {
    const std::size_t buckets = std::size_t{1} << bits_;
    const std::uint64_t chunks = chunk_count(count_, chunk);
    std::vector<std::uint32_t> next(chunks * buckets, 0);
    const unsigned shift = 32 - bits_;
    for_each_chunk(count_, chunk, threads_,
                   [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                     control_.check();
                     std::uint32_t* counts = next.data() + c * buckets;
                     for (std::uint64_t i = begin; i < end; ++i)
                       ++counts[std::uint64_t{key(id(i))} >> shift];
                   });
    start_.resize(buckets + 1);
    std::uint32_t sum = 0;
    for (std::size_t b = 0; b < buckets; ++b) {
      start_[b] = sum;
      for (std::uint64_t c = 0; c < chunks; ++c) sum += std::exchange(next[c * buckets + b], sum);
    }
    start_[buckets] = sum;
    for_each_chunk(count_, chunk, threads_,
                   [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                     control_.check();
                     std::uint32_t* at = next.data() + c * buckets;
                     for (std::uint64_t i = begin; i < end; ++i) {
                       const std::uint32_t p = id(i), k = key(p);
                       out[at[std::uint64_t{k} >> shift]++] = entry(p, k);
                     }
                   });
  }

  /// Once more by the bits that follow, about one point a cell, then the cells by comparison.
  void sort_bucket(Entry* begin, Entry* end, std::vector<Entry>& scratch,
                   std::vector<std::uint32_t>& next) const {
    const auto n = static_cast<std::size_t>(end - begin);
    if (n < 2) return;
    if (n > 16) {
      const auto cell_bits = std::min(32 - bits_, static_cast<unsigned>(std::bit_width(n - 1)));
      const unsigned shift = 32 - bits_ - cell_bits;
      const std::uint32_t mask = static_cast<std::uint32_t>((std::uint64_t{1} << cell_bits) - 1);
      scratch.assign(begin, end);
      next.assign((std::size_t{1} << cell_bits), 0);
      for (const Entry& e : scratch) ++next[(e.key >> shift) & mask];
      std::uint32_t sum = 0;
      for (std::uint32_t& c : next) sum += std::exchange(c, sum);
      for (const Entry& e : scratch) begin[next[(e.key >> shift) & mask]++] = e;
    }
    // Keys ascend now but for their last bits; runs of equal cells are short unless x repeats.
    for (std::size_t i = 0; i < n;) {
      std::size_t last = i + 1;
      if (n > 16) {
        const unsigned shift = cell_shift(n);
        while (last < n && begin[last].key >> shift == begin[i].key >> shift) ++last;
      } else {
        last = n;
      }
      if (last - i > 1 && !std::is_sorted(begin + i, begin + last, before)) {
        if (last - i > block) control_.check();
        std::sort(begin + i, begin + last, before);
      }
      i = last;
    }
  }
  unsigned cell_shift(std::size_t n) const {
    return 32 - bits_ - std::min(32 - bits_, static_cast<unsigned>(std::bit_width(n - 1)));
  }

  static constexpr double top = 0x1p32 - 1;
  const LocalPoints& points_;
  const std::uint32_t* ids_;
  const std::uint32_t count_;
  const unsigned threads_;
  const Control& control_;
  double low_ = 0, scale_ = 0;
  unsigned bits_ = 0;
  std::vector<std::uint32_t> start_;  // of the buckets
};

/// Positions (in a Sorted) of the strictly convex chains from the first point to the last.
struct Chains {
  std::vector<std::uint32_t> lower, upper;
};

/// Adds point i to a chain that turns `side` at every vertex (+1 left, -1 right).
void extend(const Sorted& s, std::vector<std::uint32_t>& chain, std::uint32_t i, int side,
            Turn& turn) {
  while (chain.size() >= 2) {
    const std::size_t m = chain.size();
    if (turn(s[chain[m - 2]], s[chain[m - 1]], s[i]) * side > 0) break;
    chain.pop_back();
  }
  chain.push_back(i);
}

/// The same for a whole chain to the right of it: from where a point stays on the one before it,
/// the rest follows as it is.
void join(const Sorted& s, std::vector<std::uint32_t>& chain,
          const std::vector<std::uint32_t>& more, int side, Turn& turn) {
  for (std::size_t i = 0; i < more.size(); ++i) {
    extend(s, chain, more[i], side, turn);
    const std::size_t m = chain.size();
    if (i == 0 || chain[m - 2] != more[i - 1]) continue;
    chain.insert(chain.end(), more.begin() + static_cast<std::ptrdiff_t>(i) + 1, more.end());
    return;
  }
}

/// Chains of the points [begin, end) that may be on them. A block's points are first divided by the
/// chord from the first point of all to the last, without branches, since in general nothing
/// predicts the side; a point too near the chord to tell goes to both, which is always right.
Chains scan_run(const Sorted& s, std::uint32_t begin, std::uint32_t run_end, Turn& turn,
                const Control& control) {
  Chains chains;
  const Entry a = s[0], b = s[s.count - 1];
  std::uint32_t low[block], high[block];
  for (; begin < run_end; begin += std::min(block, run_end - begin)) {
    control.check();
    const std::uint32_t end = begin + std::min(block, run_end - begin);
    std::uint32_t lows = 0, highs = 0;
    for (std::uint32_t i = begin; i < end; ++i) {
      const Entry& p = s[i];
      const double l = (a.x - p.x) * (b.y - p.y);
      const double r = (a.y - p.y) * (b.x - p.x);
      // As in Turn, rounded up; where coordinates are not in [-1, 1] a NaN or infinity may come of
      // overflow, and both comparisons are false then.
      const double error = 0x1p-51 * (std::fabs(l) + std::fabs(r)) + 0x1p-1060;
      const bool above = l - r > error, below = r - l > error, fresh = !equal(s[i - 1], p);
      low[lows] = i;
      lows += fresh && !above;
      high[highs] = i;
      highs += fresh && !below;
    }
    for (std::uint32_t i = 0; i < lows; ++i) extend(s, chains.lower, low[i], 1, turn);
    for (std::uint32_t i = 0; i < highs; ++i) extend(s, chains.upper, high[i], -1, turn);
  }
  return chains;
}

/// Both chains: runs of fixed length each by itself, then joined from left to right.
Chains scan(const Sorted& s, Turn& turn, unsigned threads, const Control& control) {
  constexpr std::uint64_t run = std::uint64_t{1} << 16;
  const std::uint32_t last = s.count - 1;
  const std::uint64_t runs = chunk_count(last - 1, run);
  std::vector<Chains> parts(runs);
  std::vector<Turn> turns(runs, turn);
  for_each_chunk(last - 1, run, threads,
                 [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                   parts[c] = scan_run(s, static_cast<std::uint32_t>(begin) + 1,
                                       static_cast<std::uint32_t>(end) + 1, turns[c], control);
                 });
  Chains chains;
  chains.lower = {0};
  chains.upper = {0};
  for (std::uint64_t c = 0; c < runs; ++c) {
    control.check();
    control.report("hull", static_cast<double>(c) / static_cast<double>(runs));
    join(s, chains.lower, parts[c].lower, 1, turn);
    join(s, chains.upper, parts[c].upper, -1, turn);
    parts[c] = {};
    turn.add_counts(turns[c]);
  }
  // Of points equal to the last the lowest id, which the sweep met first, must be the vertex.
  std::uint32_t end = last;
  while (end > 0 && equal(s[end - 1], s[last])) --end;
  if (chains.lower.back() != end) extend(s, chains.lower, end, 1, turn);
  if (chains.upper.back() != end) extend(s, chains.upper, end, -1, turn);
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
        const double* p = points.row(s[i].id);
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
std::vector<std::uint32_t> discard(const LocalPoints& points, Turn& turn, unsigned threads,
                                   const Control& control) {
  // Where scaling lost bits the sample's chains are known only up to them.
  if (points.count < discard_from || points.coordinates != points.exact) return {};
  const std::uint32_t m = std::min(sample_size, points.count / 32);
  std::vector<std::uint32_t> sample(m);
  for (std::uint32_t i = 0; i < m; ++i)
    sample[i] = static_cast<std::uint32_t>(std::uint64_t{points.count} * i / m);
  const Sorted sorted = Sorter(points, sample.data(), m, threads, control).run();
  const Chains chains = scan(sorted, turn, threads, control);
  // Efron 1965: the share of points outside a sample's hull is about its vertices' share of it.
  if (chains.lower.size() + chains.upper.size() > m / 2) return {};
  const auto strip = std::make_unique<Strip>();
  if (!strip->build(points, sorted, chains)) return {};

  constexpr std::uint64_t chunk = std::uint64_t{1} << 15;
  std::vector<std::vector<std::uint32_t>> kept(chunk_count(points.count, chunk));
  for_each_chunk(points.count, chunk, threads,
                 [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                   control.check();
                   std::vector<std::uint32_t> list(end - begin);
                   std::size_t k = 0;
                   for (std::uint64_t i = begin; i < end; ++i) {
                     const double* p = points.row(static_cast<std::uint32_t>(i));
                     list[k] = static_cast<std::uint32_t>(i);
                     k += !strip->contains(p[0], p[1]);
                   }
                   kept[c].assign(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(k));
                 });
  std::vector<std::uint32_t> ids;
  for (const auto& list : kept) ids.insert(ids.end(), list.begin(), list.end());
  return ids;
}

}  // namespace

SimplicialHull hull_2d(const LocalPoints& points, unsigned threads, const Control& control) {
  Turn turn(points);
  const std::vector<std::uint32_t> ids = discard(points, turn, threads, control);
  const bool all = ids.empty();
  const Sorted sorted =
      Sorter(points, all ? nullptr : ids.data(),
             all ? points.count : static_cast<std::uint32_t>(ids.size()), threads, control)
          .run();
  const Chains chains = scan(sorted, turn, threads, control);
  // Both chains hold the first and the last point.
  const std::size_t n = chains.lower.size() + chains.upper.size() - 2;
  if (n < 3) throw Error(ErrorCode::internal, "hull_2d was given collinear points");

  SimplicialHull hull;
  hull.dimension = 2;
  resize_big(hull.vertices, 2 * n);
  resize_big(hull.neighbours, 2 * n);
  // Counter-clockwise: the lower chain forwards, the upper one backwards. Edge i runs from corner i
  // to corner i + 1; it is written end first, so that the inside has negative orientation.
  const std::size_t m = chains.lower.size(), last = chains.upper.size() - 1;
  const auto corner = [&](std::size_t i) {
    return sorted[i < m ? chains.lower[i] : chains.upper[last - (i - m) - 1]].id;
  };
  for_each_chunk(n, std::uint64_t{1} << 15, threads,
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                   for (std::uint64_t i = begin; i < end; ++i) {
                     const std::uint64_t previous = i == 0 ? n - 1 : i - 1;
                     const std::uint64_t next = i + 1 == n ? 0 : i + 1;
                     hull.vertices[2 * i] = corner(next);
                     hull.vertices[2 * i + 1] = corner(i);
                     hull.neighbours[2 * i] = static_cast<std::uint32_t>(previous);
                     hull.neighbours[2 * i + 1] = static_cast<std::uint32_t>(next);
                   }
                 });
  std::copy(turn.counts(), turn.counts() + 3, hull.rung_counts);
  return hull;
}

}  // namespace cullhull::internal
