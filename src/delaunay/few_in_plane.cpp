// Delaunay triangulations of few points in the plane.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "delaunay/plane_insertion.hpp"
#include "delaunay/triangulate.hpp"
#include "delaunay/write_triangulation.hpp"
#include "exact/numbers/double_parts.hpp"
#include "exact/orientation/orientation.hpp"
#include "geometry/gather.hpp"
#include "geometry/simplex.hpp"
#include "parallel/threads/parallel.hpp"
#include "parallel/threads/run.hpp"
#include "parallel/threads/thread_memory.hpp"

namespace cullhull::internal {
namespace {

constexpr std::uint32_t most_points = 16384;
/// Points of one cell of the curve are in no order, so walks are long where many share cells: with
/// more than the first number in an average point's cell, the cells become smaller, with more than
/// the second the general path is faster.
constexpr std::uint32_t fair_sharing = 5, most_sharing = 64;
/// Up to this many rows are sorted by counting those that are less.
constexpr std::uint32_t few_rows = 24;

/// The places of a square's cells along a Hilbert curve. A curve through fewer, larger cells has
/// the same beginning bits.
class CurveTable {
 public:
  static constexpr unsigned bits = 7;

  /// Four copies of a curve, the first and the last of them turned, make the next finer one.
  constexpr CurveTable() {
    for (unsigned s = 1; s < side; s *= 2) {
      const unsigned quarter = s * s;
      for (unsigned y = 0; y < s; ++y)
        for (unsigned x = 0; x < s; ++x) {
          const unsigned p = at(x, y);
          at(x, s + y) = static_cast<std::uint16_t>(quarter + p);
          at(s + x, s + y) = static_cast<std::uint16_t>(2 * quarter + p);
          at(2 * s - 1 - y, s - 1 - x) = static_cast<std::uint16_t>(3 * quarter + p);
        }
      for (unsigned y = 1; y < s; ++y)
        for (unsigned x = 0; x < y; ++x) std::swap(at(x, y), at(y, x));
    }
  }
  /// The place of a cell of a square of 2^used x 2^used cells.
  std::uint32_t operator()(std::uint32_t x, std::uint32_t y, unsigned used) const {
    return places_[(y * side + x) << (bits - used)] >> 2 * (bits - used);
  }

 private:
  static constexpr unsigned side = 1U << bits;
  constexpr std::uint16_t& at(unsigned x, unsigned y) { return places_[y * side + x]; }

  std::array<std::uint16_t, side * side> places_{};
};
constexpr CurveTable curve;

// Why a path of its own for up to 16,384 points: the general path keeps ids of 64 bits, looks for
// flats, weights and lattices of several axes and allocates per call. Here all arrays are kept by
// the thread, keys are 14 bits of a table, and equal points share a cell of the curve. Results are
// the same bits.

/// Holds at most about 2.5 MB. Calls take a few milliseconds at most and cannot be cancelled.
class FewInPlane {
 public:
  bool triangulate(const PointView& view, Triangulation& out) {
    n_ = static_cast<std::uint32_t>(view.count);
    const double* const rows = rows_as_given(view, loaded_);
    duplicates_.clear();  // an exception may have left some
    if (!measure(rows) || !order(rows) || !insert()) return false;
    out.dimension = 2;
    out.point_count = n_;
    out.scalar = view.scalar;
    write(out);
    return true;
  }

 private:
  /// Finds the box, and the power of two that scales it to [-1, 1]; false for points that are not
  /// finite, all equal or of extreme magnitude.
  bool measure(const double* rows) {
    double zero[2] = {0, 0};  // x * 0 is NaN exactly for NaN and infinities
    for (unsigned a = 0; a < 2; ++a) low_[a] = high_[a] = rows[a];
    for (std::uint32_t i = 0; i < n_; ++i)
      for (unsigned a = 0; a < 2; ++a) {
        const double v = rows[2 * std::size_t{i} + a];
        zero[a] += v * 0.0;
        low_[a] = std::min(low_[a], v);
        high_[a] = std::max(high_[a], v);
      }
    if (zero[0] + zero[1] != 0) return false;
    const double most = std::max({-low_[0], high_[0], -low_[1], high_[1]});
    if (!(most >= 0x1p-500 && most <= 0x1p500)) return false;
    up_ = std::ilogb(most) + 1;
    widest_ = std::max(high_[0] - low_[0], high_[1] - low_[1]);
    return widest_ >= 0x1p-600;  // below that on a line; quotients would overflow
  }

  /// Sets the points' keys and counts them. Returns the sum of, for each point, those in its cell.
  std::uint64_t set_keys(const double* rows, unsigned bits) {
    counts_.assign(std::size_t{1} << 2 * bits, 0);
    keys_.resize(n_);
    const double across = std::ldexp(1.0, static_cast<int>(bits)) / widest_;
    const double top = std::ldexp(1.0, static_cast<int>(bits)) - 1;
    for (std::uint32_t i = 0; i < n_; ++i) {
      const double x = std::min((rows[2 * std::size_t{i}] - low_[0]) * across, top),
                   y = std::min((rows[2 * std::size_t{i} + 1] - low_[1]) * across, top);
      const std::uint32_t key =
          curve(static_cast<std::uint32_t>(static_cast<std::int32_t>(x)),
                static_cast<std::uint32_t>(static_cast<std::int32_t>(y)), bits);
      keys_[i] = static_cast<std::uint16_t>(key);
      ++counts_[key];
    }
    std::uint64_t sharing = 0;
    for (const std::uint32_t count : counts_) sharing += std::uint64_t{count} * count;
    return sharing;
  }

  /// Sorts the points along the curve, equal points by id, and scales them. False if too many
  /// points share cells, or if scaling would not be exact.
  bool order(const double* rows) {
    unsigned bits = std::clamp<unsigned>((std::bit_width(n_) + 1U) / 2, 2, CurveTable::bits);
    std::uint64_t sharing = set_keys(rows, bits);
    if (sharing > std::uint64_t{fair_sharing} * n_ && bits < CurveTable::bits) {
      bits = std::min(bits + 2, CurveTable::bits);
      sharing = set_keys(rows, bits);
    }
    if (sharing > std::uint64_t{most_sharing} * n_) return false;
    std::uint32_t all = 0;
    for (std::uint32_t& count : counts_) all += std::exchange(count, all);
    LiftedPoints& s = points_;
    s.base = s.width = s.stride = 2;
    s.count = n_;
    s.filtered = true;
    s.rows.resize(2 * std::size_t{n_});
    s.ids.resize(n_);
    const double scale = std::ldexp(1.0, -up_), back = std::ldexp(1.0, up_);
    bool exact = true;
    for (std::uint32_t i = 0; i < n_; ++i) {
      const std::uint32_t place = counts_[keys_[i]]++;
      s.ids[place] = i;
      for (unsigned a = 0; a < 2; ++a) {
        const double v = rows[2 * std::size_t{i} + a], scaled = v * scale;
        s.rows[2 * std::size_t{place} + a] = scaled;
        exact &= scaled * back == v;
      }
    }
    find_lattice();
    return exact;
  }

  /// Sets the limits up to which doubles are exact by the lowest bit of all coordinates.
  void find_lattice() {
    LiftedPoints& s = points_;
    constexpr int least = -51;  // differences of coordinates up to 1 are then exact
    int lowest = 0;
    for (std::size_t i = 0; i < s.rows.size() && lowest >= least; ++i)
      if (s.rows[i] != 0) lowest = std::min(lowest, lowest_bit_exponent(s.rows[i]));
    s.exact_limit = lowest < least ? 0 : std::ldexp(1.0, 53 + 4 * lowest);
    s.exact_orientation_limit = lowest < least ? 0 : std::ldexp(1.0, 53 + 2 * lowest);
  }

  // Equal points have equal keys, so they are in one run of the order; within it each point is
  // compared with the first ones of the run until an equal one is found, itself at the latest.
  // Cells hold few points (most_sharing), so the comparisons are few.

  /// Finds equal points, which share a cell of the curve; the first in the order has the lowest id.
  /// The others are its duplicates, all first ones places_.
  void find_duplicates() {
    const LiftedPoints& s = points_;
    places_.resize(n_);
    std::uint32_t first = 0, kept = 0;  // of the cell, of places_
    for (std::uint32_t i = 0; i < n_; ++i) {
      if (keys_[s.ids[i]] != keys_[s.ids[first]]) first = i;
      std::uint32_t j = first;
      while (s.row(j)[0] != s.row(i)[0] || s.row(j)[1] != s.row(i)[1]) ++j;
      if (j < i)
        duplicates_.push_back({s.ids[i], s.ids[j]});
      else
        places_[kept++] = i;
    }
    places_.resize(kept);
  }

  bool insert() {
    find_duplicates();
    std::uint32_t simplex[3];
    if (!find_triangle(points_, places_, places_.size(), simplex)) return false;
    before_ = engine_.counts();
    cells_.resize(2 * places_.size() - 2);
    engine_.start(simplex, 0);
    for (const std::uint32_t i : places_)
      if (i != simplex[0] && i != simplex[1] && i != simplex[2]) engine_.insert(i);
    return true;
  }

  // 14 bits for each of three corners and 16 for the cell's number are 58 bits: the whole row is
  // one word, sorted by its corners without looking at anything else. Example: the triangle 3, 7,
  // 12, cell 20: ((3 * 2^14 + 7) * 2^14 + 12) * 2^16 + 20.

  /// A cell for sorting, from the high bits: its three corners, its number in the store.
  using Row = std::uint64_t;
  static constexpr unsigned id_bits = std::bit_width(most_points - 1),
                            cell_bits = id_bits + 2;  // fewer than 4 cells a point
  static std::uint32_t cell_of(Row r) {
    return static_cast<std::uint32_t>(r) & ((1U << cell_bits) - 1);
  }
  static std::uint32_t corner_of(Row r, unsigned j) {
    return static_cast<std::uint32_t>(r >> (cell_bits + (2 - j) * id_bits)) & ((1U << id_bits) - 1);
  }

  /// Sorts rows by corner j, stably.
  void sort(const Row* from, Row* to, std::uint32_t rows, unsigned j) {
    counts_.assign(n_, 0);
    for (std::uint32_t i = 0; i < rows; ++i) ++counts_[corner_of(from[i], j)];
    std::uint32_t all = 0;
    for (std::uint32_t& count : counts_) all += std::exchange(count, all);
    for (std::uint32_t i = 0; i < rows; ++i) to[counts_[corner_of(from[i], j)]++] = from[i];
  }

  /// Sorts rows_[0, rows).
  void sort(std::uint32_t rows) {
    Row *const a = rows_.data(), *const b = sorted_.data();
    if (rows <= few_rows) {
      for (std::uint32_t i = 0; i < rows; ++i) {
        std::uint32_t less = 0;
        for (std::uint32_t j = 0; j < rows; ++j) less += a[j] < a[i] ? 1 : 0;
        b[less] = a[i];
      }
      std::swap(rows_, sorted_);
      return;
    }
    sort(a, b, rows, 1);
    sort(b, a, rows, 0);
    for (std::uint32_t i = 1; i < rows; ++i) {  // at most two cells have the same two corners
      const Row x = a[i - 1], y = a[i];
      const bool swap = x > y;
      a[i - 1] = swap ? y : x;
      a[i] = swap ? x : y;
    }
  }

  /// Writes the finite cells in their order. No branch depends on ids or on which cells are
  /// finite: an item is written at the end of its list in any case, and counts if it belongs there.
  void write(Triangulation& out) {
    CellStore<2>& store = cells_;
    const LiftCounts& counts = engine_.counts();
    for (unsigned r = 0; r < 3; ++r)
      out.statistics.rung_counts[r] = counts.rungs[r] - before_.rungs[r];
    out.statistics.ties = counts.ties - before_.ties;
    out.statistics.cells_created = engine_.created();
    std::optional<DisjointSets> spheres;
    if (out.statistics.ties > 0) spheres = cells_of_spheres(points_, store, short_run());
    const std::uint32_t* const ids = points_.ids.data();
    const std::uint32_t count = store.count();
    rank_.resize(count);
    rows_.resize(count + 1);
    sorted_.resize(count + 1);
    std::uint32_t finite = 0;
    for (std::uint32_t c = 0; c < count; ++c) {
      std::uint32_t* const v = store.vertices(c);
      rank_[c] = no_index;
      const bool ghost = (v[0] == infinite) | (v[1] == infinite) | (v[2] == infinite);
      for (unsigned j = 0; j < 3; ++j) v[j] = ids[v[j] == infinite ? 0 : v[j]];
      sort_simplex<3, true>(v, store.neighbours(c), 3);
      rows_[finite] = ((Row{v[0]} << id_bits | v[1]) << id_bits | v[2]) << cell_bits | c;
      finite += ghost ? 0 : 1;
    }
    sort(finite);
    out.cells.resize(3 * std::size_t{finite});
    out.neighbours.resize(3 * std::size_t{finite});
    std::uint32_t* to = out.cells.data();
    for (std::uint32_t i = 0; i < finite; ++i) {
      for (unsigned j = 0; j < 3; ++j) *to++ = corner_of(rows_[i], j);
      rank_[cell_of(rows_[i])] = i;
    }
    hull_.resize(count + 1);
    std::uint32_t edges = 0;
    to = out.neighbours.data();
    for (std::uint32_t i = 0; i < finite; ++i) {
      const std::uint32_t* const across = store.neighbours(cell_of(rows_[i]));
      for (unsigned j = 0; j < 3; ++j) {
        const std::uint32_t o = rank_[store.cell_of(across[j])];
        *to++ = o;
        hull_[edges] = {i, j};
        edges += o == no_index ? 1 : 0;
      }
    }
    write_hull(edges, out);
    std::sort(duplicates_.begin(), duplicates_.end(),
              [](const DuplicatePoint& a, const DuplicatePoint& b) { return a.id < b.id; });
    out.duplicates.assign(duplicates_.begin(), duplicates_.end());
    out.axes = {0, 1};
    out.affine_dimension = 2;
    if (spheres) write_groups(*spheres, rank_, out, short_run());
  }

  /// Each vertex begins at most one edge of the hull.
  void write_hull(std::uint32_t edges, Triangulation& out) {
    counts_.assign(n_, no_index);
    for (std::uint32_t i = 0; i < edges; ++i) {
      const auto [cell, slot] = hull_[i];
      counts_[out.cells[3 * std::size_t{cell} + (slot + 1) % 3]] = i;
    }
    out.hull_facets.resize(2 * std::size_t{edges});
    out.hull_cells.resize(edges);
    for (std::uint32_t v = 0, at = 0; at < edges; ++v) {
      const bool begins = counts_[v] != no_index;
      const auto [cell, slot] = hull_[begins ? counts_[v] : 0];
      out.hull_facets[2 * std::size_t{at}] = v;
      out.hull_facets[2 * std::size_t{at} + 1] = out.cells[3 * std::size_t{cell} + (slot + 2) % 3];
      out.hull_cells[at] = cell;
      at += begins ? 1 : 0;
    }
  }

  struct HullEdge {
    std::uint32_t cell;
    unsigned slot;  ///< opposite to the edge
  };

  std::uint32_t n_ = 0;
  int up_ = 0;  ///< coordinates are at most 2^up_
  double low_[2] = {}, high_[2] = {}, widest_ = 0;
  LiftedPoints points_;
  CellStore<2> cells_{2, short_run().budget};
  PlaneInsertion engine_{points_, short_run(), cells_};
  LiftCounts before_;
  std::vector<double> loaded_;
  std::vector<std::uint16_t> keys_;
  std::vector<std::uint32_t> places_;
  std::vector<std::uint32_t> counts_, rank_;
  std::vector<Row> rows_, sorted_;
  std::vector<HullEdge> hull_;
  std::vector<DuplicatePoint> duplicates_;
};

}  // namespace

bool triangulate_few_in_plane(const PointView& points, const TriangulationOptions& options,
                              Triangulation& out) {
  // More bytes than any of these sets takes, so that they need not be counted.
  constexpr std::uint64_t enough = std::uint64_t{1} << 22;
  if (points.dimension != 2 || points.count < 3 || points.count > most_points ||
      points.data == nullptr || options.furthest_site ||
      (options.memory_budget != 0 && options.memory_budget < enough))
    return false;
  const Clock::time_point start = Clock::now();
  const auto run = options_as<Options>(options);
  const Control control(run);
  control.check();
  if (!thread_memory<FewInPlane>().triangulate(points, out)) return false;
  out.statistics.threads = resolve_threads(options.threads);
  out.statistics.insert_seconds = out.statistics.compute_seconds = seconds_since(start);
  control.report("done", 1);
  return true;
}

}  // namespace cullhull::internal
