#include "delaunay/parts.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/error.hpp"
#include "delaunay/final_cells.hpp"
#include "delaunay/plane_insertion.hpp"
#include "delaunay/prepare.hpp"
#include "parallel/radix_sort.hpp"

namespace cullhull::internal {
namespace {

// Parts of the plane, in one example. Points left of x = 0 are part A, the others part B, each
// triangulated alone. A triangle of A whose circle stays left of B's box is final: no point of B is
// in its circle, so it is Delaunay in the whole set. The rest, a strip along x = 0 and what has a
// large circle, is found by triangulating the corners S of all triangles that are not final, once
// more: every triangle of the whole set that is not final has all of its corners in S
// (docs/exactness.md, "Parts"). S grows with the square root of the number of points where these
// fill an area.
//
// Why a join touches the strip alone: n points have 2 n - 2 triangles, those at infinity included.
// So all parts have their triangles in one store, each 2 n places for its n points; and those of
// the seam take the places of the triangles that are not final and two that were unused.
class Parts {
 public:
  Parts(const Prepared& p, const Run& run)
      : s_(p.points), simplex_(p.simplex), run_(run), store_(2, run.budget), order_(s_.count) {
    store_.resize(2 * std::uint64_t{s_.count});
  }

  std::unique_ptr<CellStore<2>> triangulate(unsigned levels, InsertionTotals& totals) {
    if (levels > 0) needed_.resize(s_.count);
    if (levels > 0 && !sample_fits()) return nullptr;
    std::vector<Part> parts = cut(s_.count, levels);
    run_.each_item(parts.size(), [&](std::uint64_t i) { fill(parts[i], levels == 0); });
    while (parts.size() > 1 && fit_) {
      run_.report("join", 0);
      run_.each_item(parts.size(), [&](std::uint64_t i) { find_open(parts[i], parts[i ^ 1].box); });
      std::vector<Part> joined(parts.size() / 2);
      run_.each_item(joined.size(),
                     [&](std::uint64_t i) { join(parts[2 * i], parts[2 * i + 1], joined[i]); });
      parts = std::move(joined);
    }
    if (!fit_) return nullptr;
    totals = parts[0].totals;
    store_.resize(2 * std::uint64_t{s_.count} - 2);
    return std::make_unique<CellStore<2>>(std::move(store_));
  }

 private:
  struct Part {
    std::span<const std::uint32_t> places;  ///< in the order of insertion; empty if joined
    std::uint32_t first = 0, points = 0;    ///< its 2 points - 2 cells begin at `first`
    std::uint32_t ghost = 0;                ///< one of its cells at infinity
    PartBox box{};
    std::vector<std::uint32_t> open, corners;  ///< its cells that are not final; their vertices
    InsertionTotals totals;
  };
  /// The facets of final cells whose neighbours are not final: for each, by its edge as seen from
  /// the neighbour, its code.
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
    std::vector<Part> parts = cut(sample, 1);
    for (Part& p : parts) fill(p, false);
    if (!fit_) return false;
    for (unsigned i = 0; i < 2; ++i) find_open(parts[i], parts[1 - i].box);
    return parts[0].corners.size() + parts[1].corners.size() < sample / 2;
  }

  PartBox box_of(std::span<const std::uint32_t> places) const {
    PartBox box{{s_.row(places[0])[0], s_.row(places[0])[1]}, {}};
    box.high = box.low;
    for (const std::uint32_t i : places)
      for (unsigned a = 0; a < 2; ++a) {
        box.low[a] = std::min(box.low[a], s_.row(i)[a]);
        box.high[a] = std::max(box.high[a], s_.row(i)[a]);
      }
    return box;
  }

  // Points at the cut's coordinate all go to the high part, so a part's box holds all points of a
  // coordinate, and the two boxes are disjoint. The box is compared with circles; were the boxes to
  // overlap, circles would hardly ever miss.

  /// Cuts the first `count` points into 2^levels parts, each time across the widest axis at the
  /// median of a sample.
  std::vector<Part> cut(std::uint32_t count, unsigned levels) {
    std::vector<Part> parts(std::size_t{1} << levels);
    struct Cut {
      unsigned axis = 0;
      double at = 0;
    };
    std::vector<Cut> cuts(parts.size());  // the first is 1; below cut i are 2 i and 2 i + 1
    std::vector<std::uint32_t> sample(std::min<std::size_t>(count, parts.size() << 10));
    for (std::size_t i = 0; i < sample.size(); ++i)
      sample[i] = static_cast<std::uint32_t>(i * count / sample.size());
    for (std::size_t nodes = 1; nodes < parts.size(); nodes *= 2)
      run_.each_item(nodes, [&](std::uint64_t i) {
        const std::size_t begin = sample.size() * i / nodes, end = sample.size() * (i + 1) / nodes;
        const std::span<std::uint32_t> own(sample.data() + begin, end - begin);
        const PartBox box = box_of(own);
        const unsigned axis = box.high[1] - box.low[1] > box.high[0] - box.low[0] ? 1 : 0;
        const auto middle = own.begin() + static_cast<std::ptrdiff_t>(own.size() / 2);
        std::nth_element(own.begin(), middle, own.end(), [&](std::uint32_t a, std::uint32_t b) {
          return s_.row(a)[axis] < s_.row(b)[axis];
        });
        cuts[nodes + i] = {axis, s_.row(*middle)[axis]};
      });
    Array<KeyedId> items(count), scratch(levels > 0 ? count : 0);
    run_.each(count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
        std::size_t node = 1;
        for (unsigned l = 0; l < levels; ++l)
          node = 2 * node + (s_.row(i)[cuts[node].axis] < cuts[node].at ? 0 : 1);
        items[i] = {static_cast<std::uint32_t>(node - parts.size()), i};
      }
    });
    KeyedId *sorted = items.data(), *other = scratch.data();
    radix_sort(sorted, other, count, levels, run_);
    run_.each(count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) order_[i] = sorted[i].id;
    });
    std::uint32_t begin = 0;
    for (std::uint32_t part = 0; part < parts.size(); ++part) {
      const auto* const end = std::partition_point(
          sorted + begin, sorted + count, [&](const KeyedId& item) { return item.key <= part; });
      parts[part].first = 2 * begin;
      parts[part].points = static_cast<std::uint32_t>(end - sorted) - begin;
      parts[part].places = {order_.data() + begin, parts[part].points};
      begin += parts[part].points;
    }
    return parts;
  }

  /// Triangulates the part's points. `all`: they are all points.
  void fill(Part& p, bool all) {
    std::uint32_t simplex[3];
    constexpr std::size_t few = 512;
    if (all)
      std::copy_n(simplex_.begin(), 3, simplex);
    else if (!find_triangle(s_, p.places, few, simplex))
      fit_ = false;
    if (!fit_.load(std::memory_order_relaxed)) return;
    p.box = box_of(p.places);
    insert(p.places, simplex, store_, p.first, p.totals);
    for (p.ghost = p.first; store_.ghost_slot(p.ghost) == 3;) ++p.ghost;
  }
  /// Triangulates points in the cells of a store from `first` on, unless the points do not fit.
  void insert(std::span<const std::uint32_t> places, const std::uint32_t* simplex,
              CellStore<2>& store, std::uint32_t first, InsertionTotals& totals) {
    PlaneInsertion engine(s_, run_, store);
    engine.start(simplex, first);
    for (const std::uint32_t i : places) {
      if (std::find(simplex, simplex + 3, i) != simplex + 3) continue;
      if (!fit_.load(std::memory_order_relaxed)) return;
      engine.insert(i);
    }
    totals.add(engine.counts(), engine.created());
  }

  static constexpr std::uint32_t final_mark = 0, open_mark = 1;

  // Why a search from infinity finds all: let q be a point of the other part's box that is in the
  // closed ball of a cell. q is outside of this part's hull, as the boxes are disjoint. The cells
  // whose balls contain q are what one sees of the lifted part from a point just below the lifted
  // q. That is connected across facets, and cells at infinity are among it.

  /// Finds and marks the part's open cells, and their vertices. `other`: the other part's box.
  void find_open(Part& p, const PartBox& other) {
    if (!fit_) return;
    const auto add = [&](std::uint32_t c) {
      if (store_.mark(c) == open_mark) return;
      const std::uint32_t* v = store_.vertices(c);
      const unsigned g = store_.ghost_slot(c);
      if (g <= 2 ? other.within(s_, v, g) : surely_misses(s_, v, other)) return;
      store_.mark(c) = open_mark;
      p.open.push_back(c);
      for (unsigned i = 0; i <= 2; ++i)
        if (v[i] != infinite && std::exchange(needed_[v[i]], 1) == 0) p.corners.push_back(v[i]);
    };
    std::uint32_t ghost = p.ghost;
    do {
      add(ghost);
      const unsigned next = (store_.ghost_slot(ghost) + 1) % 3;
      ghost = store_.cell_of(store_.neighbours(ghost)[next]);
    } while (ghost != p.ghost);
    for (std::size_t i = 0; i < p.open.size(); ++i) {
      if (i % 4096 == 0) run_.check();
      for (unsigned j = 0; j <= 2; ++j) add(store_.cell_of(store_.neighbours(p.open[i])[j]));
    }
    for (const std::uint32_t v : p.corners) needed_[v] = 0;
  }

  void join(Part& a, Part& b, Part& out) {
    if (!fit_) return;
    out.first = a.first;
    out.points = a.points + b.points;
    for (unsigned i = 0; i < 2; ++i) {
      out.box.low[i] = std::min(a.box.low[i], b.box.low[i]);
      out.box.high[i] = std::max(a.box.high[i], b.box.high[i]);
    }
    out.totals = a.totals;
    out.totals.add(b.totals.counts, b.totals.created);
    std::vector<std::uint32_t> places = std::move(a.corners);
    places.insert(places.end(), b.corners.begin(), b.corners.end());
    std::sort(places.begin(), places.end());
    std::uint32_t simplex[3];
    if (places.size() > std::size_t{out.points} * 2 / 5 ||
        !find_triangle(s_, places, places.size(), simplex))
      fit_ = false;
    if (!fit_) return;
    CellStore<2> seam(2, run_.budget);
    seam.resize(2 * places.size() - 2);
    insert(places, simplex, seam, 0, out.totals);
    if (!fit_) return;
    std::vector<std::uint32_t> room = std::move(a.open);
    room.insert(room.end(), b.open.begin(), b.open.end());
    Borders borders;
    find_borders(room, borders);
    const bool all = room.size() == 2 * std::size_t{out.points} - 4;
    for (const std::uint32_t c : {0U, 1U}) room.push_back(a.first + 2 * a.points - 2 + c);
    out.ghost = replace(room, seam, borders, all);
  }

  /// The edge opposite to a slot of a cell, counterclockwise or as seen from the other side.
  static std::uint64_t edge_of(const std::uint32_t* v, unsigned slot, bool from_outside) {
    const std::uint32_t from = v[(slot + 1) % 3], to = v[(slot + 2) % 3];
    return from_outside ? std::uint64_t{to} << 32 | from : std::uint64_t{from} << 32 | to;
  }

  void find_borders(const std::vector<std::uint32_t>& open, Borders& borders) {
    for (const std::uint32_t c : open)
      for (unsigned j = 0; j <= 2; ++j) {
        const std::uint32_t code = store_.neighbours(c)[j], o = store_.cell_of(code);
        if (store_.mark(o) != open_mark)
          borders.emplace(edge_of(store_.vertices(o), store_.slot_of(code), true), code);
      }
  }

  /// Replaces the cells `room` by those of the seam that are reached from the borders; by all of
  /// them if no cell of a part is final. Returns one of the new cells at infinity: the hull's edges
  /// from one part to the other are the seam's.
  std::uint32_t replace(const std::vector<std::uint32_t>& room, CellStore<2>& seam,
                        const Borders& borders, bool all) {
    // Of the seam's cells: those that are reached, the number of each in the store, and at each
    // facet the code of the final cell beyond a border.
    std::vector<std::uint32_t> found, number(seam.count(), no_index),
        beyond(std::size_t{seam.count()} * 3, no_index);
    const auto find = [&](std::uint32_t c) {
      if (number[c] != no_index) return;
      number[c] = found.size() < room.size() ? room[found.size()] : 0;
      found.push_back(c);
    };
    for (std::uint32_t c = 0; c < seam.count(); ++c) {
      if (all) find(c);
      for (unsigned j = 0; j <= 2; ++j) {
        const auto border = borders.find(edge_of(seam.vertices(c), j, false));
        if (border == borders.end()) continue;
        beyond[std::size_t{c} * 3 + j] = border->second;
        find(c);
      }
    }
    for (std::size_t i = 0; i < found.size(); ++i)
      for (unsigned j = 0; j <= 2; ++j)
        if (beyond[std::size_t{found[i]} * 3 + j] == no_index)
          find(seam.cell_of(seam.neighbours(found[i])[j]));
    std::size_t linked = 0;
    std::uint32_t ghost = no_index;
    for (std::size_t i = 0; i < std::min(found.size(), room.size()); ++i) {
      const std::uint32_t c = room[i];
      store_.mark(c) = final_mark;
      std::copy_n(seam.vertices(found[i]), 3, store_.vertices(c));
      if (seam.ghost_slot(found[i]) < 3) ghost = c;
      for (unsigned j = 0; j <= 2; ++j) {
        const std::uint32_t code = seam.neighbours(found[i])[j],
                            border = beyond[std::size_t{found[i]} * 3 + j];
        if (border == no_index) {
          store_.neighbours(c)[j] = seam.code(number[seam.cell_of(code)], seam.slot_of(code));
        } else {
          store_.link(c, j, border);
          ++linked;
        }
      }
    }
    if (found.size() != room.size() || linked != borders.size() || ghost == no_index)
      throw Error(ErrorCode::internal, "parts of a triangulation do not fit together");
    return ghost;
  }

  const LiftedPoints& s_;
  const std::vector<std::uint32_t>& simplex_;
  const Run& run_;
  CellStore<2> store_;
  Array<std::uint32_t> order_;  ///< places of the points, part after part
  std::atomic<bool> fit_{true};
  std::vector<std::uint8_t> needed_;  ///< by place: the vertex is among a part's corners
};

}  // namespace

std::unique_ptr<CellStore<2>> triangulate_in_parts(const Prepared& p, unsigned levels,
                                                   InsertionTotals& totals, const Run& run) {
  return Parts(p, run).triangulate(levels, totals);
}

}  // namespace cullhull::internal
