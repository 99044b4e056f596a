// Insertion in the plane without weights: every point becomes a vertex and no vertex is ever
// removed. The cavity of a point is then a tree of triangles. A walk around it visits each edge
// once and needs no marks. The new triangles, in cyclic order, overwrite those of the cavity; two
// more are allocated.
#pragma once

#include <cmath>
#include <cstdint>
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
      : s_(points), run_(run), store_(2, run.budget), signs_(points) {}

  CellStore<2>& store() { return store_; }
  const LiftCounts& counts() {
    counts_ = signs_.counts();
    counts_.rungs[0] += filtered_;
    return counts_;
  }

  /// Begins with three points that are not on a line. `expected`: the approximate number of points.
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
    const std::uint32_t first = locate();
    edges_.clear();
    cavity_.clear();
    open_.clear();
    cavity_.push_back(first);
    const std::uint32_t* v = store_.vertices(first);
    const Corner a = corner(v[0]), b = corner(v[1]), c = corner(v[2]);
    // The edges are visited counter-clockwise, beginning with a b, opposite to corner 2. open_ is a
    // stack, so they are pushed in reverse.
    const std::uint32_t* n = store_.neighbours(first);
    open_.push_back({n[1], c, a});
    open_.push_back({n[0], b, c});
    open_.push_back({n[2], a, b});
    walk_around();
    make_cells(p);
    if ((++inserted_ & 1023) == 0) run_.check();
    return true;
  }

 private:
  /// A vertex with coordinates and lift relative to the point.
  struct Corner {
    double x, y, lift;
    std::uint32_t vertex;
  };
  /// The edge from `from` to `to` of a triangle in the cavity. `code`: the neighbour across it.
  struct Edge {
    std::uint32_t code;
    Corner from, to;
  };
  /// An edge of the cavity's boundary. `code`: the neighbour outside.
  struct Rim {
    std::uint32_t code, from, to;
  };

  Corner corner(std::uint32_t v) const {
    if (v == infinite) return {0, 0, 0, v};
    const double* q = s_.row(v);
    const double x = q[0] - px_, y = q[1] - py_;
    return {x, y, x * x + y * y, v};
  }

  /// Visibility walk to the triangle that contains the point, or to a ghost.
  std::uint32_t locate() {
    std::uint32_t c = last_;
    if (const unsigned g = store_.ghost_slot(c); g < 3) c = store_.cell_of(store_.neighbours(c)[g]);
    unsigned from = 3;
    for (;;) {
      const unsigned j = signs_.separating_facet(store_.vertices(c), from);
      if (j == 3) return c;
      const std::uint32_t code = store_.neighbours(c)[j];
      c = store_.cell_of(code);
      from = store_.slot_of(code);
      if (store_.vertices(c)[from] == infinite) return c;
      if ((++steps_ & 4095) == 0) run_.check();
    }
  }

  /// Finds the cavity (cavity_) and its boundary in cyclic order (edges_) by depth-first search.
  void walk_around() {
    while (!open_.empty()) {
      const Edge e = open_.back();
      open_.pop_back();
      const std::uint32_t c = store_.cell_of(e.code);
      const unsigned slot = store_.slot_of(e.code);
      const Corner apex = corner(store_.vertices(c)[slot]);
      if (!conflict(c, e, apex)) {
        edges_.push_back({e.code, e.from.vertex, e.to.vertex});
        continue;
      }
      cavity_.push_back(c);
      // The triangle is apex, to, from. Visit the edge from-apex, opposite to `to`, first.
      const unsigned next = slot == 2 ? 0 : slot + 1, last = slot == 0 ? 2 : slot - 1;
      const std::uint32_t* n = store_.neighbours(c);
      open_.push_back({n[last], apex, e.to});
      open_.push_back({n[next], e.from, apex});
    }
  }

  /// Whether the point is in conflict with triangle c, which has edge e and the opposite corner w.
  bool conflict(std::uint32_t c, const Edge& e, const Corner& w) {
    if (s_.filtered && w.vertex != infinite && e.from.vertex != infinite &&
        e.to.vertex != infinite) {
      const Corner &u = e.from, &v = e.to;
      // Determinant of the rows u, w, v relative to the point: positive inside the circumcircle.
      const double uw = u.x * w.y, wu = u.y * w.x, wv = w.x * v.y, vw = w.y * v.x, vu = v.x * u.y,
                   uv = v.y * u.x;
      const double det = (uw - wu) * v.lift + (wv - vw) * u.lift + (vu - uv) * w.lift;
      const double size = (std::abs(uw) + std::abs(wu)) * v.lift +
                          (std::abs(wv) + std::abs(vw)) * u.lift +
                          (std::abs(vu) + std::abs(uv)) * w.lift;
      // Roundings on a path of the computation: 2 differences, a product, a difference; 4 for the
      // lift, a product, 2 sums. Computing `size` adds 4 more.
      const double bound = 16 * unit_roundoff * size + s_.tiny;
      if (std::abs(det) > bound) {
        ++filtered_;
        return det > 0;
      }
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
    while (cavity_.size() < edges_.size()) cavity_.push_back(store_.new_cell());
    const std::size_t n = edges_.size();
    std::uint32_t before = cavity_[n - 1];
    last_ = no_index;
    for (std::size_t i = 0; i < n; ++i) {
      const Rim& e = edges_[i];
      const std::uint32_t c = cavity_[i];
      std::uint32_t *v = store_.vertices(c), *across = store_.neighbours(c);
      v[0] = p;
      v[1] = e.from;
      v[2] = e.to;
      store_.link(c, 0, e.code);
      across[1] = store_.code(i + 1 < n ? cavity_[i + 1] : cavity_[0], 2);
      across[2] = store_.code(before, 1);
      before = c;
      if (e.from != infinite && e.to != infinite) last_ = c;
    }
    if (last_ == no_index) last_ = before;
  }

  const LiftedPoints& s_;
  const Run& run_;
  CellStore<2> store_;
  PointSigns<2> signs_;
  double px_ = 0, py_ = 0;
  std::uint64_t steps_ = 0, inserted_ = 0, filtered_ = 0;
  std::uint32_t last_ = 0;
  LiftCounts counts_;
  std::vector<Edge> open_;
  std::vector<Rim> edges_;
  std::vector<std::uint32_t> cavity_;
};

/// Whether PlaneInsertion can triangulate these points.
inline bool plain_plane(const LiftedPoints& s) {
  return s.base == 2 && s.stride == 2 && !s.may_hide;
}

}  // namespace cullhull::internal::inline delaunay
