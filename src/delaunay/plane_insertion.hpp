// Insertion in the plane without weights: every point becomes a vertex and no vertex is ever
// removed. The cavity of a point is then a tree of triangles. A walk around it visits each edge
// once and needs no marks. The new triangles, in cyclic order, overwrite those of the cavity; two
// more are allocated.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "delaunay/cell_store.hpp"
#include "delaunay/point_signs.hpp"
#include "exact/insphere/lift_side.hpp"
#include "exact/points/local_points.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline delaunay {

class PlaneInsertion {
 public:
  PlaneInsertion(const LiftedPoints& points, const Run& run)
      : s_(points),
        run_(run),
        store_(2, run.budget),
        signs_(points),
        tiny_(points.filtered ? points.tiny : std::numeric_limits<double>::infinity()) {}

  CellStore<2>& store() { return store_; }
  const LiftCounts& counts() {
    counts_ = signs_.counts();
    counts_.rungs[0] += filtered_;
    return counts_;
  }

  /// Starts with three points that are not collinear. `expected`: the approximate number of points.
  void start(const std::uint32_t* simplex, std::uint32_t expected) {
    std::uint32_t v[3] = {simplex[0], simplex[1], simplex[2]};
    if (signs_.orientation(v) == Sign::negative) std::swap(v[1], v[2]);
    store_.start(v, expected);
    last_ = 0;
  }

  /// Inserts point p; always succeeds (true). May throw cancelled.
  bool insert(std::uint32_t p) {
    signs_.set_query(p);
    px_ = s_.row(p)[0];
    py_ = s_.row(p)[1];
    Corner corners[3];
    const std::uint32_t first = locate(corners);
    walk_around(first, corners);
    make_cells(p);
    if ((++inserted_ & 1023) == 0) run_.check();
    return true;
  }

 private:
  /// A vertex, with coordinates and lift relative to the point. `code`: the neighbour across the
  /// edge that ends here.
  struct Corner {
    double x, y, lift;
    std::uint32_t vertex, code;
  };
  /// An edge of the cavity's boundary, from the end of the previous one. `code`: the neighbour
  /// outside the cavity.
  struct Rim {
    std::uint32_t code, to;
  };

  /// The infinite vertex gets NaN coordinates, so that no filter decides.
  Corner corner(std::uint32_t v) const {
    if (v == infinite) {
      constexpr double none = std::numeric_limits<double>::quiet_NaN();
      return {none, none, none, v, 0};
    }
    const double* q = s_.row(v);
    const double x = q[0] - px_, y = q[1] - py_;
    return {x, y, x * x + y * y, v, 0};
  }

  static unsigned next(unsigned slot) { return slot == 2 ? 0 : slot + 1; }
  static unsigned previous(unsigned slot) { return slot == 0 ? 2 : slot - 1; }

  /// Visibility walk to the triangle that contains the point, or to a ghost; sets its corners.
  std::uint32_t locate(Corner* corners) {
    std::uint32_t c = last_;
    if (const unsigned g = store_.ghost_slot(c); g < 3) c = store_.cell_of(store_.neighbours(c)[g]);
    for (unsigned j = 0; j < 3; ++j) corners[j] = corner(store_.vertices(c)[j]);
    for (unsigned from = 3;;) {
      unsigned j = 0;
      while (j < 3 && (j == from || !beyond(c, j, corners[next(j)], corners[previous(j)]))) ++j;
      if (j == 3) return c;
      const std::uint32_t code = store_.neighbours(c)[j];
      const Corner begin = corners[next(j)], end = corners[previous(j)];
      c = store_.cell_of(code);
      from = store_.slot_of(code);
      corners[from] = corner(store_.vertices(c)[from]);
      corners[next(from)] = end;
      corners[previous(from)] = begin;
      if (corners[from].vertex == infinite) return c;
      if ((++steps_ & 4095) == 0) run_.check();
    }
  }

  /// Whether the edge from a to b of the finite triangle c, opposite to corner j, separates the
  /// point from c. Rounds as filtered_by_columns() does.
  bool beyond(std::uint32_t c, unsigned j, const Corner& a, const Corner& b) {
    const double l = a.x * b.y, r = a.y * b.x, det = l - r;
    const double bound = 6 * unit_roundoff * (std::abs(l) + std::abs(r)) + tiny_;
    if (std::abs(det) > bound) return det < 0;
    return signs_.replaced(store_.vertices(c), j) == Sign::negative;
  }

  /// Finds the cavity (cavity_), starting with a triangle and its corners, and its boundary in
  /// cyclic order (rims_), by depth-first search. Edges to be visited are consecutive, so the stack
  /// open_ stores only the end of each.
  void walk_around(std::uint32_t first, const Corner* corners) {
    rims_.clear();
    cavity_.clear();
    cavity_.push_back(first);
    const std::uint32_t* across = store_.neighbours(first);
    Corner* open = open_.data();
    std::size_t depth = 3;
    for (unsigned j = 0, end = 0; j < 3; ++j, end = previous(end)) {  // the first one on top
      open[j] = corners[end];
      open[j].code = across[next(end)];
    }
    Corner from = corners[0];
    while (depth > 0) {
      const Corner to = open[depth - 1];
      const std::uint32_t c = store_.cell_of(to.code);
      const unsigned slot = store_.slot_of(to.code);
      Corner apex = corner(store_.vertices(c)[slot]);
      if (!conflict(c, from, apex, to)) {
        rims_.push_back({to.code, to.vertex});
        from = to;
        --depth;
        continue;
      }
      cavity_.push_back(c);
      // The triangle is apex, to, from. The edge from-apex, opposite to `to`, is visited first.
      across = store_.neighbours(c);
      open[depth - 1].code = across[previous(slot)];
      apex.code = across[next(slot)];
      if (depth == open_.size()) {
        open_.resize(2 * depth);
        open = open_.data();
      }
      open[depth++] = apex;
    }
  }

  /// Whether the point is in conflict with triangle c, which has the edge from u to v and the
  /// opposite corner w.
  bool conflict(std::uint32_t c, const Corner& u, const Corner& w, const Corner& v) {
    // Determinant of the rows u, w, v relative to the point: positive inside the circumcircle.
    const double uw = u.x * w.y, wu = u.y * w.x, wv = w.x * v.y, vw = w.y * v.x, vu = v.x * u.y,
                 uv = v.y * u.x;
    const double det = (uw - wu) * v.lift + (wv - vw) * u.lift + (vu - uv) * w.lift;
    const double size = (std::abs(uw) + std::abs(wu)) * v.lift +
                        (std::abs(wv) + std::abs(vw)) * u.lift +
                        (std::abs(vu) + std::abs(uv)) * w.lift;
    // Roundings on a path of the computation: 2 differences, a product, a difference; 4 for the
    // lift, a product, 2 sums. Computing `size` adds 4 more.
    const double bound = 16 * unit_roundoff * size + tiny_;
    if (std::abs(det) > bound) {
      ++filtered_;
      return det > 0;
    }
    if (const unsigned g = store_.ghost_slot(c); g < 3) {
      const Sign beyond = signs_.replaced(store_.vertices(c), g);
      if (beyond != Sign::zero) return beyond == Sign::positive;
      c = store_.cell_of(store_.neighbours(c)[g]);
    }
    return signs_.conflict(store_.vertices(c));
  }

  /// Creates a triangle p, from, to for each boundary edge. Its neighbours: slot 0 outside the
  /// cavity, slot 1 the next new triangle, slot 2 the previous one.
  void make_cells(std::uint32_t p) {
    store_.count_reused(cavity_.size());
    while (cavity_.size() < rims_.size()) cavity_.push_back(store_.new_cell());
    const std::size_t n = rims_.size();
    std::uint32_t before = cavity_[n - 1], from = rims_[n - 1].to;
    last_ = no_index;
    for (std::size_t i = 0; i < n; ++i) {
      const Rim& e = rims_[i];
      const std::uint32_t c = cavity_[i];
      std::uint32_t *v = store_.vertices(c), *across = store_.neighbours(c);
      v[0] = p;
      v[1] = from;
      v[2] = e.to;
      store_.link(c, 0, e.code);
      across[1] = store_.code(i + 1 < n ? cavity_[i + 1] : cavity_[0], 2);
      across[2] = store_.code(before, 1);
      before = c;
      if (from != infinite && e.to != infinite) last_ = c;
      from = e.to;
    }
    if (last_ == no_index) last_ = before;
  }

  const LiftedPoints& s_;
  const Run& run_;
  CellStore<2> store_;
  PointSigns<2> signs_;
  double tiny_;  ///< underflow term of the filters; infinite if no filter may decide
  double px_ = 0, py_ = 0;
  std::uint64_t steps_ = 0, inserted_ = 0, filtered_ = 0;
  std::uint32_t last_ = 0;
  LiftCounts counts_;
  std::vector<Corner> open_ = std::vector<Corner>(64);
  std::vector<Rim> rims_;
  std::vector<std::uint32_t> cavity_;
};

/// Whether PlaneInsertion can triangulate these points.
inline bool plain_plane(const LiftedPoints& s) {
  return s.base == 2 && s.stride == 2 && !s.may_hide;
}

}  // namespace cullhull::internal::inline delaunay
