// The hull in the plane: points are distributed to buckets by x; chains of consecutive buckets are
// built in the cache, and joined from left to right.
//
// All decisions are exact: comparisons of coordinates, and signs of exact determinants
// (planar.hpp). How points are divided depends on their number alone, not on threads.
#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>

#include "filter/plane_filter.hpp"
#include "hull/engine.hpp"
#include "hull/plane/polygon.hpp"
#include "hull/plane/quadrilateral.hpp"
#include "parallel/memory/pages.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/prefetch.hpp"
#include "parallel/scan.hpp"
#include "parallel/threads/parallel.hpp"
#include "parallel/threads/thread_memory.hpp"

namespace cullhull::internal {
namespace {

constexpr std::uint32_t block = PlanarSource::block;
constexpr std::uint64_t chunk = std::uint64_t{1} << 16;  // tens of us of work

// -------------------------------------------------------------------------------- the box

Box box_of(const double* p, std::uint64_t count) {
  // Four points at a time in independent accumulators, so that comparisons do not wait for one
  // another.
  constexpr std::uint64_t lanes = 8;
  double low[lanes], high[lanes];
  for (std::uint64_t j = 0; j < lanes; ++j) low[j] = high[j] = p[j % 2];
  const std::uint64_t values = 2 * count;
  std::uint64_t i = 0;
  for (; i + lanes <= values; i += lanes)
    for (std::uint64_t j = 0; j < lanes; ++j) {
      low[j] = p[i + j] < low[j] ? p[i + j] : low[j];
      high[j] = p[i + j] > high[j] ? p[i + j] : high[j];
    }
  for (; i < values; ++i) {
    low[i % 2] = std::min(low[i % 2], p[i]);
    high[i % 2] = std::max(high[i % 2], p[i]);
  }
  Box box;
  for (std::uint64_t j = 0; j < 2; ++j) {
    box.low[j] = std::min({low[j], low[j + 2], low[j + 4], low[j + 6]});
    box.high[j] = std::max({high[j], high[j + 2], high[j + 4], high[j + 6]});
  }
  return box;
}

void widen(Box& box, const Box& more) {
  for (unsigned j = 0; j < 2; ++j) {
    box.low[j] = std::min(box.low[j], more.low[j]);
    box.high[j] = std::max(box.high[j], more.high[j]);
  }
}

struct Extent {
  Box box;
  Chord chord;  ///< of equal points the lowest row
};

/// Moves the ends of the chord to a point that lies beyond one.
void widen(Chord& chord, const Entry& e) {
  const Entry &first = chord.first, &last = chord.last;
  if (e.x < first.x || (e.x == first.x && e.y < first.y)) chord.first = e;
  if (last.x < e.x || (last.x == e.x && last.y < e.y)) chord.last = e;
}

/// Finds the bounding box in a pass over all points, and the chord in a second pass over the chunks
/// that reach its left or right side.
Extent measure(const PlanarSource& source, const Run& run) {
  const std::uint64_t n = source.count();
  std::vector<Box> boxes(chunk_count(n, chunk));
  std::atomic<bool> bad{false};
  run.each_chunk(n, chunk, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    double room[2 * block];
    for (std::uint64_t b = begin; b < end; b += block) {
      const std::uint64_t size = std::min<std::uint64_t>(block, end - b);
      const double* p = source.rows(b, b + size, room);
      if (!all_finite(p, 2 * size)) bad = true;
      const Box box = box_of(p, size);
      if (b == begin)
        boxes[c] = box;
      else
        widen(boxes[c], box);
    }
  });
  if (bad) check_finite(source.view(), nullptr, run);  // names the first bad point
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const Chord none{{infinite, infinite, 0, 0}, {-infinite, -infinite, 0, 0}};
  Extent extent{boxes[0], none};
  Box& all = extent.box;
  for (const Box& box : boxes) widen(all, box);
  std::vector<Chord> chords(boxes.size(), none);
  run.each_chunk(n, chunk, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    if (boxes[c].low[0] != all.low[0] && boxes[c].high[0] != all.high[0]) return;
    run.check();
    double room[2 * block];
    for (std::uint64_t b = begin; b < end; b += block) {
      const std::uint64_t size = std::min<std::uint64_t>(block, end - b);
      const double* p = source.rows(b, b + size, room);
      for (std::uint64_t i = 0; i < size; ++i)
        if (p[2 * i] == all.low[0] || p[2 * i] == all.high[0])
          widen(chords[c], {p[2 * i], p[2 * i + 1], static_cast<std::uint32_t>(b + i), 0});
    }
  });
  for (const Chord& chord : chords) {
    if (chord.first.x == infinite) continue;  // the chunk reaches neither side
    widen(extent.chord, chord.first);
    widen(extent.chord, chord.last);
  }
  return extent;
}

// -------------------------------------------------------------------------------- buckets

/// All points as entries, distributed to buckets that ascend by x. Within a bucket entries keep
/// their order, so rows ascend.
class Buckets {
 public:
  /// At most 2^11 buckets: a thread writes to one cache line of each, 128 KB in all. The 512 points
  /// of a bucket take 12 KB, which fit L1 while they are sorted.
  static constexpr unsigned max_bits = 11;
  static constexpr std::uint32_t wanted_size = 512;

  Buckets(const PlanarSource& source, const Box& box, const Run& run)
      : source_(source),
        map_(box.low[0], box.high[0]),
        bits_(std::min(max_bits,
                       static_cast<unsigned>(std::bit_width(source.count() / wanted_size)))),
        entries_(source.count()) {
    const std::size_t buckets = std::size_t{1} << bits_;
    const std::uint64_t n = source.count();
    std::vector<std::uint32_t> next(chunk_count(n, chunk) * buckets, 0);
    run.each_chunk(n, chunk, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      std::uint32_t* const counts = next.data() + c * buckets;
      each(begin, end, [&](const Entry& e) { ++counts[bucket(e.key)]; });
    });
    scan_buckets(next, buckets, &start_);
    clear_pages_early(entries_.get(), n * sizeof(Entry), run.threads, [&] { run.check(); });
    run.each_chunk(n, chunk, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      std::uint32_t* const at = next.data() + c * buckets;
      each(begin, end, [&](const Entry& e) {
        Entry* const to = entries_.get() + at[bucket(e.key)]++;
        *to = e;
        // Saves 30 % of this loop's time: stores queue up behind one that misses the cache.
        prefetch_line_to_write(to + 3);
      });
    });
  }

  std::size_t size() const { return start_.size() - 1; }
  unsigned low_bits() const { return 32 - bits_; }
  const Entry* begin(std::size_t b) const { return entries_.get() + start_[b]; }
  std::uint32_t count(std::size_t b) const { return start_[b + 1] - start_[b]; }

 private:
  std::size_t bucket(std::uint32_t key) const { return std::uint64_t{key} >> (32 - bits_); }

  template <class Use>
  void each(std::uint64_t begin, std::uint64_t end, Use&& use) const {
    double room[2 * block];
    for (std::uint64_t b = begin; b < end; b += block) {
      const std::uint64_t size = std::min<std::uint64_t>(block, end - b);
      const double* p = source_.rows(b, b + size, room);
      for (std::uint64_t i = 0; i < size; ++i)
        use(Entry{p[2 * i], p[2 * i + 1], static_cast<std::uint32_t>(b + i), map_.key(p[2 * i])});
    }
  }

  const PlanarSource& source_;
  const KeyMap map_;
  const unsigned bits_;
  BigArray<Entry> entries_;
  std::vector<std::uint32_t> start_;
};

// -------------------------------------------------------------------------------- chains

/// Rows of the chains of consecutive buckets.
struct Stretch {
  Array<std::uint32_t> lower, upper;
};

Array<std::uint32_t> rows_of(const Entry* chain, std::uint32_t count) {
  Array<std::uint32_t> rows(count);
  for (std::uint32_t i = 0; i < count; ++i) rows[i] = chain[i].row;
  return rows;
}

/// A strictly convex chain that grows to the right by appending chains; `side` as in ChainBuilder.
class JoinedChain {
 public:
  /// Rows [begin, end) of a chain.
  struct Piece {
    const Array<std::uint32_t>* rows;
    std::size_t begin, end;
    std::size_t size() const { return end - begin; }
  };

  JoinedChain(const PlanarSource& source, int side) : source_(source), side_(side) {}

  /// The chain of the union is the beginning of this one and the end of `next`, joined by their
  /// common tangent: both ends are cut in turn until neither changes.
  void join(const Array<std::uint32_t>& next, Turn& turn) {
    if (next.empty()) return;
    std::size_t first = 0;
    for (;;) {
      cut(entry(next[first]), turn);
      const std::size_t better = tangent(next, first, turn);
      if (better == first) break;
      first = better;
    }
    pieces_.push_back({&next, first, next.size()});
  }

  const std::vector<Piece>& pieces() const { return pieces_; }

 private:
  Entry entry(std::uint32_t row) const { return source_.entry(row); }

  /// Removes the end of the chain that is not on the hull of chain and p, a point to the right: all
  /// from the first vertex on at which the turn towards p is wrong. Where the turn is right at a
  /// vertex, it is right at all earlier ones, which a binary search uses.
  void cut(const Entry& p, Turn& turn) {
    while (!pieces_.empty()) {
      Piece& piece = pieces_.back();
      const bool alone = pieces_.size() == 1;
      const auto keeps = [&](std::size_t i) {
        const std::uint32_t previous =
            i > piece.begin
                ? (*piece.rows)[i - 1]
                : (*pieces_[pieces_.size() - 2].rows)[pieces_[pieces_.size() - 2].end - 1];
        return turn(entry(previous), entry((*piece.rows)[i]), p) == side_;
      };
      // Usually nothing is removed.
      if (piece.size() > (alone ? 1 : 0) && keeps(piece.end - 1)) return;
      std::size_t low = piece.begin + (alone ? 1 : 0), high = piece.end;
      if (low >= high) return;  // only the chain's first vertex is left
      --high;                   // known to be wrong
      while (low < high) {
        const std::size_t middle = low + (high - low) / 2;
        if (keeps(middle))
          low = middle + 1;
        else
          high = middle;
      }
      piece.end = low;
      if (piece.size() > 0) return;
      pieces_.pop_back();
    }
  }

  /// The vertex of `next`, from `first` on, where the tangent from the chain's last vertex touches:
  /// the last vertex at which the turn from its predecessor is wrong.
  std::size_t tangent(const Array<std::uint32_t>& next, std::size_t first, Turn& turn) const {
    if (pieces_.empty()) return first;
    const Piece& piece = pieces_.back();
    const Entry from = entry((*piece.rows)[piece.end - 1]);
    const auto wrong = [&](std::size_t i) {
      return turn(from, entry(next[i - 1]), entry(next[i])) != side_;
    };
    if (first + 1 >= next.size() || !wrong(first + 1)) return first;
    std::size_t low = first + 1, high = next.size() - 1;
    while (low < high) {
      const std::size_t middle = low + (high - low + 1) / 2;
      if (wrong(middle))
        low = middle;
      else
        high = middle - 1;
    }
    return low;
  }

  const PlanarSource& source_;
  const int side_;
  std::vector<Piece> pieces_;
};

/// Corners counter-clockwise: the lower chain without its last point, then the upper one from its
/// last to its second. Both begin at the lexicographically first point and end at the last.
Array<std::uint32_t> cycle(const JoinedChain& lower, const JoinedChain& upper, const Run& run) {
  struct Job {
    JoinedChain::Piece piece;
    std::size_t to;
    bool backwards;
  };
  std::vector<Job> jobs;
  std::size_t size = 0;
  const auto add = [&](JoinedChain::Piece piece, bool backwards) {
    jobs.push_back({piece, size, backwards});
    size += piece.size();
  };
  for (const auto& piece : lower.pieces()) add(piece, false);
  --jobs.back().piece.end;
  --size;
  for (std::size_t i = upper.pieces().size(); i-- > 0;) {
    JoinedChain::Piece piece = upper.pieces()[i];
    if (i == 0) ++piece.begin;
    add(piece, true);
  }
  if (size == 0) return {lower.pieces()[0].rows->front()};  // all points are equal
  Array<std::uint32_t> corners(size);
  run.each_item(jobs.size(), [&](std::uint64_t j) {
    const Job& job = jobs[j];
    const std::uint32_t* const from = job.piece.rows->data();
    std::uint32_t* const to = corners.data() + job.to;
    if (job.backwards)
      std::reverse_copy(from + job.piece.begin, from + job.piece.end, to);
    else
      std::copy(from + job.piece.begin, from + job.piece.end, to);
  });
  return corners;
}

/// Consecutive buckets are grouped until they have at least this many points (the last group may
/// have fewer): their entries take 200 KB, which fit L2.
constexpr std::uint64_t run_size = std::uint64_t{1} << 13;

std::vector<std::size_t> cut_into_runs(const Buckets& buckets) {
  std::vector<std::size_t> ends{0};
  std::uint64_t points = 0;
  for (std::size_t b = 0; b < buckets.size(); ++b) {
    points += buckets.count(b);
    if (points < run_size && b + 1 < buckets.size()) continue;
    ends.push_back(b + 1);
    points = 0;
  }
  return ends;
}

Polygon polygon_of_many(const PlanarSource& source, const Extent& extent, const Turn& plain,
                        const Run& run) {
  const Buckets buckets(source, extent.box, run);
  run.report("hull", 0.3);
  const std::vector<std::size_t> ends = cut_into_runs(buckets);
  std::vector<Stretch> runs(ends.size() - 1);
  std::vector<Turn> turns(runs.size(), plain);
  run.each_item(runs.size(), [&](std::uint64_t r) {
    ChainBuilder chains(extent.chord, plain, run.control);
    for (std::size_t b = ends[r]; b < ends[r + 1]; ++b) {
      run.check();
      chains.add(buckets.begin(b), buckets.count(b), buckets.low_bits());
    }
    runs[r] = {rows_of(chains.lower(), chains.lower_count()),
               rows_of(chains.upper(), chains.upper_count())};
    turns[r] = chains.turn();
  });
  run.report("hull", 0.9);
  Turn turn = plain;
  JoinedChain lower(source, 1), upper(source, -1);
  for (std::size_t r = 0; r < runs.size(); ++r) {
    run.check();
    lower.join(runs[r].lower, turn);
    upper.join(runs[r].upper, turn);
    turn.add_counts(turns[r]);
  }
  Polygon polygon;
  polygon.corners = cycle(lower, upper, run);
  polygon.rows = source.count();
  polygon.box = extent.box;
  polygon.rung_counts = turn.counts();
  return polygon;
}

}  // namespace

Polygon polygon_of(const PointView& points, bool lattice, const Run& run) {
  run.check();
  run.report("hull", 0);
  const PlanarSource source(points);
  const Extent extent = measure(source, run);
  if (extent.box.low[0] == extent.box.high[0] || extent.box.low[1] == extent.box.high[1]) {
    Polygon flat;  // on a line along an axis: its two ends, or one point
    flat.corners = {extent.chord.first.row};
    if (!equal(extent.chord.first, extent.chord.last))
      flat.corners.push_back(extent.chord.last.row);
    flat.rows = source.count();
    flat.box = extent.box;
    return flat;
  }
  return polygon_of_many(source, extent, Turn(lattice), run);
}

Polygon polygon_by_sample(const PointView& points, bool lattice, const Run& run) {
  constexpr std::uint64_t worthwhile = 4096, first_sample = 1023;
  struct Memory {
    PlaneFilter filter;
    PolygonSeries series{short_run().control};
  };
  if (points.count < worthwhile) return polygon_of(points, lattice, run);
  auto& [filter, series] = thread_memory<Memory>();
  if (!filter.keep_few(points, series, first_sample)) return polygon_of(points, lattice, run);
  Polygon polygon =
      polygon_of(PointView::row_major(filter.rows(), filter.count(), 2), lattice, run);
  for (std::uint32_t& corner : polygon.corners) corner = filter.ids()[corner];
  polygon.rows = static_cast<std::uint32_t>(points.count);
  return polygon;
}

Boundary hull_2d(const LocalPoints& points, const Run& run) {
  const bool scaled = points.coordinates != points.exact;
  const Polygon polygon = polygon_by_sample(PointView::row_major(points.exact, points.count, 2),
                                            points.small_lattice && !scaled, run);
  const std::size_t n = polygon.corners.size();
  if (n < 3) throw Error(ErrorCode::internal, "hull_2d was given collinear points");
  Boundary hull;
  hull.dimension = 2;
  resize_big(hull.vertices, 2 * n);
  resize_big(hull.neighbours, 2 * n);
  // Edge i is from corner i to corner i + 1; stored in reverse, so that the inside has negative
  // orientation.
  run.each(n, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      const std::uint64_t previous = i == 0 ? n - 1 : i - 1;
      const std::uint64_t next = i + 1 == n ? 0 : i + 1;
      hull.vertices[2 * i] = polygon.corners[next];
      hull.vertices[2 * i + 1] = polygon.corners[i];
      hull.neighbours[2 * i] = static_cast<std::uint32_t>(previous);
      hull.neighbours[2 * i + 1] = static_cast<std::uint32_t>(next);
    }
  });
  hull.rung_counts = polygon.rung_counts;
  return hull;
}

/// Polygons of small sets: a single bucket each; inner points are discarded before sorting, but not
/// of more than 512 that no filter could thin: most of those are extreme.
PolygonSeries::PolygonSeries(const Control& control) : chains_({}, Turn(), control) {}

const std::vector<std::uint32_t>& PolygonSeries::corners(const double* rows, std::uint32_t count,
                                                         bool thinned) {
  const auto entry = [rows](std::uint32_t i) {
    return Entry{rows[2 * std::size_t{i}], rows[2 * std::size_t{i} + 1], i, 0};
  };
  Chord chord{entry(0), entry(0)};
  Entry lowest = chord.first, highest = lowest;
  for (std::uint32_t i = 1; i < count; ++i) {
    const Entry e = entry(i);
    if (e.y < lowest.y) lowest = e;
    if (e.y > highest.y) highest = e;
    if (before(e, chord.first)) chord.first = e;
    if (before(chord.last, e)) chord.last = e;
  }
  box_ = {{chord.first.x, lowest.y}, {chord.last.x, highest.y}};
  corners_.clear();
  if (equal(chord.first, chord.last)) {
    corners_.push_back(0);
    return corners_;
  }
  const KeyMap map(chord.first.x, chord.last.x);
  if (entries_.size() < count) entries_.resize(std::size_t{2} * count);
  Entry* const e = entries_.data();
  std::uint32_t kept = 0;
  const auto keep = [&](const auto& drops) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const double x = rows[2 * std::size_t{i}], y = rows[2 * std::size_t{i} + 1];
      e[kept] = {x, y, i, map.key(x)};
      kept += !drops(x, y);
    }
  };
  constexpr std::uint32_t most_worth_a_quadrilateral = 512;
  if (thinned || count <= most_worth_a_quadrilateral) {
    const Quadrilateral middle({&chord.first, &lowest, &chord.last, &highest}, box_);
    keep([&](double x, double y) { return middle.contains(x, y); });
  } else {
    keep([](double, double) { return false; });
  }
  chains_.restart(chord);
  chains_.add(e, kept, 32);
  for (std::uint32_t i = 0; i + 1 < chains_.lower_count(); ++i)
    corners_.push_back(chains_.lower()[i].row);
  for (std::uint32_t i = chains_.upper_count() - 1; i > 0; --i)
    corners_.push_back(chains_.upper()[i].row);
  return corners_;
}

}  // namespace cullhull::internal
