#include "delaunay/parts.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/error.hpp"
#include "delaunay/final_cells.hpp"
#include "delaunay/plane_insertion.hpp"

namespace cullhull::internal {
namespace {

/// Places of points in the order of insertion, ascending.
using Places = std::vector<std::uint32_t>;

// Parts of the plane, in one example. Points left of x = 0 are part A, the others part B, each
// triangulated alone. A triangle of A whose circle stays left of B's box is final: no point of B is
// in its circle, so it is Delaunay in the whole set. The rest, a strip along x = 0 and what has a
// large circle, is found by triangulating the corners S of all triangles that are not final, once
// more: every triangle of the whole set that is not final has all of its corners in S
// (docs/exactness.md, "Parts"). S grows with the square root of the number of points where these
// fill an area.
class Parts {
 public:
  Parts(const LiftedPoints& s, const Run& run) : s_(s), run_(run) {}

  std::unique_ptr<CellStore<2>> triangulate(unsigned levels, InsertionTotals& totals) {
    std::vector<Part> parts(1);
    parts[0].places.resize(s_.count);
    for (std::uint32_t i = 0; i < s_.count; ++i) parts[0].places[i] = i;
    if (!sample_fits()) return nullptr;
    for (unsigned l = 0; l < levels; ++l) split(parts);
    fit_ = true;
    run_.each_item(parts.size(), [&](std::uint64_t i) { fill(parts[i]); });
    needed_.assign(s_.count, 0);
    while (parts.size() > 1 && fit_) {
      run_.report("join", 0);
      std::vector<Part> joined(parts.size() / 2);
      run_.each_item(joined.size(), [&](std::uint64_t i) {
        const bool last = joined.size() == 1;
        const Run inner = last ? run_ : run_.with_threads(1);
        join(parts[2 * i], parts[2 * i + 1], joined[i], inner);
      });
      parts = std::move(joined);
    }
    for (const Part& p : parts) totals.add(p.totals.counts, p.totals.created);
    if (!fit_) return nullptr;
    return std::move(parts[0].cells);
  }

 private:
  struct Part {
    Places places;
    PartBox box;
    std::unique_ptr<CellStore<2>> cells;
    InsertionTotals totals;
  };
  /// The facets of final cells whose neighbours are not final: for each, by its edge as seen from
  /// the neighbour, its code in the joined numbering.
  using Borders = std::unordered_map<std::uint64_t, std::uint32_t>;

  // Why a sample decides: parts help if few points belong to the seam. Points of an area have a
  // seam of about sqrt(n) points, points of a curve (a river, a contour line) have triangles that
  // reach across everything, so that nearly every circle meets the other part's box. Both show on
  // 1,024 points.

  /// Tries two parts of the first points, which are a random sample; false if too many points
  /// belong to the seam. For points that fill an area the seam has a tenth to a sixth of the
  /// sample; for points on a curve it has nearly all, and would have nearly all of the whole set.
  bool sample_fits() {
    constexpr std::uint32_t sample = 1024;
    if (s_.count < 8 * sample) return true;
    std::vector<Part> parts(1);
    parts[0].places.resize(sample);
    std::iota(parts[0].places.begin(), parts[0].places.end(), 0U);
    split(parts);
    fit_ = true;
    for (Part& p : parts) fill(p);
    if (!fit_) return false;
    needed_.assign(sample, 0);
    mark_final(parts[0], parts[1].box);
    mark_final(parts[1], parts[0].box);
    return std::count(needed_.begin(), needed_.end(), 1) < sample / 2;
  }

  void measure(Part& p) const {
    const double* first = s_.row(p.places[0]);
    std::copy_n(first, 2, p.box.low.begin());
    std::copy_n(first, 2, p.box.high.begin());
    for (const std::uint32_t i : p.places)
      for (unsigned a = 0; a < 2; ++a) {
        p.box.low[a] = std::min(p.box.low[a], s_.row(i)[a]);
        p.box.high[a] = std::max(p.box.high[a], s_.row(i)[a]);
      }
  }

  // Points at the pivot's coordinate all go to the high part, so a part's box holds all points of a
  // coordinate, and the two boxes are disjoint. The box is compared with circles; were the boxes to
  // overlap, circles would hardly ever miss.

  /// Splits each part across its widest axis at the median of a sample of its points.
  void split(std::vector<Part>& parts) {
    std::vector<Part> halves(2 * parts.size());
    run_.each_item(parts.size(), [&](std::uint64_t i) {
      Part &whole = parts[i], &low = halves[2 * i], &high = halves[2 * i + 1];
      if (whole.places.empty()) return;
      measure(whole);
      const auto &low_of = whole.box.low, &high_of = whole.box.high;
      const unsigned axis = high_of[1] - low_of[1] > high_of[0] - low_of[0] ? 1 : 0;
      std::vector<double> sample;
      const std::size_t step = std::max<std::size_t>(1, whole.places.size() / 1021);
      for (std::size_t j = 0; j < whole.places.size(); j += step)
        sample.push_back(s_.row(whole.places[j])[axis]);
      std::nth_element(sample.begin(), sample.begin() + sample.size() / 2, sample.end());
      const double pivot = sample[sample.size() / 2];
      low.places.reserve(whole.places.size() / 2 + whole.places.size() / 8);
      high.places.reserve(whole.places.size() / 2 + whole.places.size() / 8);
      for (const std::uint32_t p : whole.places)
        (s_.row(p)[axis] < pivot ? low : high).places.push_back(p);
    });
    parts = std::move(halves);
  }

  void fill(Part& p) {
    std::uint32_t simplex[3];
    constexpr std::size_t few = 512;
    if (!find_triangle(s_, p.places, few, simplex)) {
      fit_ = false;
      return;
    }
    measure(p);
    PlaneInsertion engine(s_, run_);
    engine.start(simplex, static_cast<std::uint32_t>(p.places.size()));
    for (const std::uint32_t i : p.places) {
      if (std::find(simplex, simplex + 3, i) != simplex + 3) continue;
      if (!fit_.load(std::memory_order_relaxed)) return;
      engine.insert(i);
    }
    p.totals.add(engine.counts(), engine.store().created());
    p.cells = std::make_unique<CellStore<2>>(std::move(engine.store()));
  }

  static constexpr std::uint32_t final_mark = 1, open_mark = 0;

  /// Marks a part's cells as final or open, and the vertices of open cells as needed by the seam.
  void mark_final(Part& p, const PartBox& other) {
    CellStore<2>& cells = *p.cells;
    for (std::uint32_t c = 0; c < cells.count(); ++c) {
      if ((c & 0xffff) == 0) run_.check();
      if (cells.dead(c)) continue;
      const std::uint32_t* v = cells.vertices(c);
      const unsigned g = cells.ghost_slot(c);
      const bool stays = g <= 2 ? other.within(s_, v, g) : surely_misses(s_, v, other);
      cells.mark(c) = stays ? final_mark : open_mark;
      if (stays) continue;
      for (unsigned i = 0; i <= 2; ++i)
        if (v[i] != infinite) needed_[v[i]] = 1;
    }
  }

  void join(Part& a, Part& b, Part& out, const Run& run) {
    if (!fit_) return;
    for (Part* p : {&a, &b}) out.totals.add(p->totals.counts, p->totals.created);
    out.places.resize(a.places.size() + b.places.size());
    std::merge(a.places.begin(), a.places.end(), b.places.begin(), b.places.end(),
               out.places.begin());
    run.each_item(2, [&](std::uint64_t i) {
      if (i == 0)
        mark_final(a, b.box);
      else
        mark_final(b, a.box);
    });
    Part seam;
    for (const std::uint32_t i : out.places)
      if (std::exchange(needed_[i], 0) != 0) seam.places.push_back(i);
    if (seam.places.size() > out.places.size() * 2 / 5) fit_ = false;
    if (!fit_) return;
    fill(seam);
    if (!fit_) return;
    out.totals.add(seam.totals.counts, seam.totals.created);
    if (std::uint64_t{a.cells->count()} + b.cells->count() + seam.cells->count() >
        seam.cells->limit())
      fit_ = false;
    if (!fit_) return;
    measure(out);
    out.cells = std::make_unique<CellStore<2>>(2, run.budget);
    assemble(*a.cells, *b.cells, *seam.cells, *out.cells, run);
  }

  /// The edge opposite to a slot of a cell, counterclockwise or as seen from the other side.
  static std::uint64_t edge_of(const std::uint32_t* v, unsigned slot, bool from_outside) {
    const std::uint32_t from = v[(slot + 1) % 3], to = v[(slot + 2) % 3];
    return from_outside ? std::uint64_t{to} << 32 | from : std::uint64_t{from} << 32 | to;
  }

  /// Numbers the final cells of a part from `next` on: sets their marks to first_number + number.
  static std::uint32_t number_final(CellStore<2>& cells, std::uint32_t next) {
    for (std::uint32_t c = 0; c < cells.count(); ++c)
      if (!cells.dead(c) && cells.mark(c) == final_mark) cells.mark(c) = first_number + next++;
    return next;
  }
  static constexpr std::uint32_t first_number = 2;

  static void find_borders(CellStore<2>& cells, Borders& borders) {
    for (std::uint32_t c = 0; c < cells.count(); ++c) {
      if (cells.dead(c) || cells.mark(c) == open_mark) continue;
      for (unsigned j = 0; j <= 2; ++j)
        if (cells.mark(cells.cell_of(cells.neighbours(c)[j])) == open_mark)
          borders.emplace(edge_of(cells.vertices(c), j, true),
                          cells.code(cells.mark(c) - first_number, j));
    }
  }

  /// Flood fill that stops at borders: marks the seam's cells that are reached from the borders as
  /// final; all of them if no cell of a part is. Returns the border at facet j of the seam's cell
  /// c, as item 3 c + j.
  static std::vector<std::uint32_t> flood(CellStore<2>& seam, const Borders& borders, bool all) {
    std::vector<std::uint32_t> found, beyond(std::size_t{seam.count()} * 3, no_index);
    // beyond[3 c + j]: the border at facet j of the seam's cell c.
    for (std::uint32_t c = 0; c < seam.count(); ++c) {
      if (seam.dead(c)) continue;
      seam.mark(c) = all ? final_mark : open_mark;
      for (unsigned j = 0; j <= 2; ++j) {
        const auto border = borders.find(edge_of(seam.vertices(c), j, false));
        if (border == borders.end()) continue;
        beyond[std::size_t{c} * 3 + j] = border->second;
        if (std::exchange(seam.mark(c), final_mark) == open_mark) found.push_back(c);
      }
    }
    for (std::size_t i = 0; i < found.size(); ++i)
      for (unsigned j = 0; j <= 2; ++j) {
        const std::uint32_t o = seam.cell_of(seam.neighbours(found[i])[j]);
        if (beyond[std::size_t{found[i]} * 3 + j] != no_index || seam.mark(o) != open_mark)
          continue;
        seam.mark(o) = final_mark;
        found.push_back(o);
      }
    return beyond;
  }

  /// Copies final cells to the places that their marks give. Links across borders are set later.
  static void copy_cells(CellStore<2>& from, CellStore<2>& to, const Run& run) {
    run.each(from.count(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        const auto c = static_cast<std::uint32_t>(i);
        if (from.dead(c) || from.mark(c) == open_mark) continue;
        const std::uint32_t at = from.mark(c) - first_number;
        to.mark(at) = 0;
        std::copy_n(from.vertices(c), 3, to.vertices(at));
        for (unsigned j = 0; j <= 2; ++j) {
          const std::uint32_t code = from.neighbours(c)[j], mark = from.mark(from.cell_of(code));
          to.neighbours(at)[j] =
              mark == open_mark ? no_index : from.code(mark - first_number, from.slot_of(code));
        }
      }
    });
  }

  static void assemble(CellStore<2>& a, CellStore<2>& b, CellStore<2>& seam, CellStore<2>& out,
                       const Run& run) {
    const std::uint32_t count = number_final(b, number_final(a, 0));
    Borders borders;
    find_borders(a, borders);
    find_borders(b, borders);
    const std::vector<std::uint32_t> beyond = flood(seam, borders, count == 0);
    out.resize(number_final(seam, count));
    for (CellStore<2>* from : {&a, &b, &seam}) copy_cells(*from, out, run);
    std::size_t linked = 0;
    for (std::uint32_t c = 0; c < seam.count(); ++c)
      for (unsigned j = 0; j <= 2; ++j)
        if (const std::uint32_t code = beyond[std::size_t{c} * 3 + j]; code != no_index) {
          out.link(out.cell_of(code), out.slot_of(code), out.code(seam.mark(c) - first_number, j));
          ++linked;
        }
    if (linked != borders.size())
      throw Error(ErrorCode::internal, "parts of a triangulation do not fit together");
  }

  const LiftedPoints& s_;
  const Run& run_;
  std::atomic<bool> fit_{true};
  std::vector<std::uint8_t> needed_;
};

}  // namespace

std::unique_ptr<CellStore<2>> triangulate_in_parts(const LiftedPoints& points, unsigned levels,
                                                   InsertionTotals& totals, const Run& run) {
  return Parts(points, run).triangulate(levels, totals);
}

}  // namespace cullhull::internal
