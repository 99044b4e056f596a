// constrained_delaunay(): computes the Delaunay triangulation, then inserts the constraints one by
// one by flipping the edges that cross them.
#include "cullhull/constrained.hpp"

#include <algorithm>
#include <deque>
#include <iterator>
#include <list>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/error.hpp"
#include "delaunay/triangulate.hpp"
#include "delaunay/write_triangulation.hpp"
#include "exact/insphere/lift_side.hpp"
#include "exact/orientation/difference_products.hpp"
#include "geometry/gather.hpp"
#include "parallel/index.hpp"
#include "parallel/memory/pages.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

/// A 2D triangulation whose edges can be flipped. Edge e consists of the half-edges 2 e and 2 e
/// + 1. A half-edge has a triangle on its left, or, on the hull, no face. The caller chooses the
/// vertex numbers.
class HalfEdges {
 public:
  /// `place`: the vertex number of each of t's ids. t is two-dimensional.
  HalfEdges(const Triangulation& t, const std::vector<std::uint32_t>& place, std::uint32_t vertices)
      : out_(vertices) {
    std::fill(out_.begin(), out_.end(), no_index);
    const auto count = static_cast<std::uint32_t>(t.size());
    Array<std::uint32_t> half(3 * std::size_t{count});  // opposite to each corner
    for (std::uint32_t c = 0; c < count; ++c)
      for (unsigned j = 0; j < 3; ++j) {
        const std::uint32_t o = t.neighbours_of(c)[j];
        if (o != no_index && o < c) {
          half[3 * std::size_t{c} + j] =
              twin(half[3 * std::size_t{o} + place_in(t.neighbours_of(o), c)]);
          continue;
        }
        half[3 * std::size_t{c} + j] = size();
        origin_.push_back(place[t.cell(c)[(j + 1) % 3]]);
        origin_.push_back(place[t.cell(c)[(j + 2) % 3]]);
      }
    next_.assign(origin_.size(), no_index);
    for (std::uint32_t c = 0; c < count; ++c)
      for (unsigned j = 0; j < 3; ++j) {
        const std::uint32_t h = half[3 * std::size_t{c} + j];
        next_[h] = half[3 * std::size_t{c} + (j + 1) % 3];
        out_[origin_[h]] = h;
      }
  }

  std::uint32_t size() const { return static_cast<std::uint32_t>(origin_.size()); }
  static std::uint32_t twin(std::uint32_t h) { return h ^ 1U; }
  std::uint32_t origin(std::uint32_t h) const { return origin_[h]; }
  std::uint32_t target(std::uint32_t h) const { return origin_[h ^ 1U]; }
  bool has_face(std::uint32_t h) const { return next_[h] != no_index; }
  std::uint32_t next(std::uint32_t h) const { return next_[h]; }
  std::uint32_t previous(std::uint32_t h) const { return next_[next_[h]]; }
  /// The corner of h's triangle that is not on h.
  std::uint32_t apex(std::uint32_t h) const { return origin_[previous(h)]; }
  bool inner(std::uint32_t edge) const { return has_face(2 * edge) && has_face(2 * edge + 1); }
  /// A half-edge from the vertex with a triangle on its left; no_index if there is no triangle.
  std::uint32_t out(std::uint32_t vertex) const { return out_[vertex]; }

  /// Flips an inner edge of a strictly convex quadrilateral: afterwards the edge joins the two
  /// apexes, half-edge 2 e leading from the apex of 2 e + 1 to the apex of 2 e.
  void flip(std::uint32_t edge) {
    const std::uint32_t h = 2 * edge, g = h + 1;
    const std::uint32_t h1 = next_[h], h2 = next_[h1], g1 = next_[g], g2 = next_[g1];
    const std::uint32_t u = origin_[h], v = origin_[g];
    if (out_[u] == h) out_[u] = g1;
    if (out_[v] == g) out_[v] = h1;
    origin_[h] = origin_[g2];
    origin_[g] = origin_[h2];
    next_[h] = h2;
    next_[h2] = g1;
    next_[g1] = h;
    next_[g] = g2;
    next_[g2] = h1;
    next_[h1] = g;
  }

 private:
  Array<std::uint32_t> origin_, next_, out_;
};

/// The constraints as pairs of ids, each duplicate point replaced by its representative.
class Constraints {
 public:
  Constraints(const Triangulation& t, std::span<const std::uint32_t> edges) : given_(edges) {
    if (edges.size() % 2 != 0) refuse("constraints are pairs of points");
    representative_.resize(t.point_count);
    std::iota(representative_.begin(), representative_.end(), 0U);
    for (const DuplicatePoint& p : t.duplicates) representative_[p.id] = p.representative;
    for (std::size_t i = 0; i < edges.size(); ++i)
      if (edges[i] >= t.point_count)
        refuse("edge ", i / 2, " has the point ", edges[i], " of ", t.point_count);
  }
  std::uint32_t size() const { return static_cast<std::uint32_t>(given_.size() / 2); }
  std::uint32_t from(std::uint32_t i) const { return representative_[given_[2 * std::size_t{i}]]; }
  std::uint32_t to(std::uint32_t i) const {
    return representative_[given_[2 * std::size_t{i} + 1]];
  }
  std::string name(std::uint32_t i) const {
    return std::to_string(i) + " (" + std::to_string(given_[2 * std::size_t{i}]) + ", " +
           std::to_string(given_[2 * std::size_t{i} + 1]) + ")";
  }

 private:
  std::span<const std::uint32_t> given_;
  std::vector<std::uint32_t> representative_;
};

/// A part of a constraint between two neighbouring points on it, as ids.
struct Piece {
  std::uint32_t low, high, source;
  bool operator<(const Piece& o) const {
    return low != o.low ? low < o.low : high != o.high ? high < o.high : source < o.source;
  }
};

void write_pieces(std::vector<Piece>& pieces, ConstrainedTriangulation& out) {
  std::sort(pieces.begin(), pieces.end());
  for (const Piece& p : pieces) {
    out.pieces.push_back(p.low);
    out.pieces.push_back(p.high);
    out.piece_sources.push_back(p.source);
  }
}

// Why flipping ends. The crossed edges are flipped away in an order that ends: of the vertices on
// the left of the segment one is taken, w, that is higher over it than the one before and not lower
// than the one after, along the crossed triangles. Its edges to the right go to points below the
// segment, all in a half-plane below w, so that w is a convex corner of each quadrilateral around
// them; and of those points one is convex in the polygon of w's triangles, as else all would lie in
// the triangle of w and its neighbours, above the segment. Flipping that edge takes it from w and
// gives w none; after the last w is no longer crossed over, and the vertices on the left are one
// fewer. Heights are compared by the sign of (b - a) x (v - w), exactly.

/// Inserts constraints into the triangulation. Vertices are numbered in the order of insertion, as
/// the predicates require.
class Forcing {
 public:
  Forcing(const Triangulation& t, const LiftedPoints& s, const Constraints& constraints,
          const std::vector<std::uint32_t>& place, const Run& run)
      : s_(s), constraints_(constraints), mesh_(t, place, s.count), run_(run) {
    source_.assign(mesh_.size() / 2, no_index);
  }

  const HalfEdges& mesh() const { return mesh_; }
  bool fixed(std::uint32_t half) const { return source_[half / 2] != no_index; }
  std::uint32_t source(std::uint32_t half) const { return source_[half / 2]; }

  /// Inserts a constraint from one point on it to the next. Each step starts from the end with
  /// fewer edges, so that the triangles around a point shared by many constraints are not visited
  /// for each.
  void force(std::uint32_t from, std::uint32_t to, std::uint32_t constraint) {
    constraint_ = constraint;
    bool forward = false;  // an error names the first edge that is crossed seen from `from`
    while (from != to) {
      poll();
      if (forward || !fewer_edges(to, from)) {
        from = advance(from, to).end;
      } else {
        const Advance step = advance(to, from, true);
        forward = step.refused;
        if (!forward) to = step.end;
      }
    }
  }

 private:
  /// A crossed edge: a half-edge from the right of the segment to its left.
  using Crossed = std::list<std::uint32_t>;

  struct Advance {
    std::uint32_t end;
    bool refused;
  };

  /// Call for each triangle or edge visited. Checks every 4096 calls whether the caller requested a
  /// stop.
  void poll() {
    if (++steps_ % 4096 == 0) run_.check();
  }

  /// Visits the edges of a vertex: counterclockwise, then, if the vertex is on the hull, clockwise
  /// from the first.
  class EdgeCirculator {
   public:
    EdgeCirculator(const HalfEdges& mesh, std::uint32_t v)
        : mesh_(mesh), start_(mesh.out(v)), at_(start_) {}
    /// A half-edge that begins at the vertex.
    std::uint32_t at() const { return at_; }
    /// Moves to the next edge; false if all have been visited.
    bool next() {
      if (!right_ && mesh_.has_face(at_)) {
        at_ = HalfEdges::twin(mesh_.previous(at_));
        return at_ != start_;
      }
      if (!right_) at_ = start_;
      right_ = true;
      const std::uint32_t back = HalfEdges::twin(at_);
      if (!mesh_.has_face(back)) return false;
      at_ = mesh_.next(back);
      return true;
    }

   private:
    const HalfEdges& mesh_;
    std::uint32_t start_, at_;
    bool right_ = false;
  };
  /// Whether v has fewer edges than w: visits the edges of both in turn until one has no more.
  bool fewer_edges(std::uint32_t v, std::uint32_t w) {
    for (EdgeCirculator at_v(mesh_, v), at_w(mesh_, w);;) {
      poll();
      if (!at_w.next()) return false;
      if (!at_v.next()) return true;
    }
  }

  Sign side(std::uint32_t a, std::uint32_t b, std::uint32_t v) const {
    const double* p[] = {s_.row(a), s_.row(b), s_.row(v)};
    return base_orientation<2>(s_, p);
  }

  /// Whether b and v, on a line through a, are on the same side of a.
  bool same_direction(std::uint32_t a, std::uint32_t b, std::uint32_t v) const {
    const auto before = [&](const double* p, const double* q) {
      return p[0] != q[0] ? p[0] < q[0] : p[1] < q[1];
    };
    return before(s_.row(a), s_.row(b)) == before(s_.row(a), s_.row(v));
  }

  void fix(std::uint32_t half) {
    if (!fixed(half)) source_[half / 2] = constraint_;
  }

  /// Makes the segment from a towards b an edge up to the next point on it, and returns that point.
  /// If the segment crosses a constraint, returns `refused` without changes if `may_refuse`, else
  /// throws.
  Advance advance(std::uint32_t a, std::uint32_t b, bool may_refuse = false) {
    std::uint32_t first = no_index;
    if (const std::uint32_t along = edge_along(a, b, first); along != no_index) {
      fix(along);
      return {mesh_.origin(along) == a ? mesh_.target(along) : mesh_.origin(along), false};
    }
    Crossed crossed;
    const std::uint32_t end = collect(a, b, first, crossed, may_refuse);
    if (end == no_index) return {no_index, true};
    clear(a, end, crossed);
    restore();
    return {end, false};
  }

  /// The half-edge at a that the segment begins with, or no_index; then `first` is the half-edge
  /// opposite to a that the segment crosses, from right to left.
  std::uint32_t edge_along(std::uint32_t a, std::uint32_t b, std::uint32_t& first) {
    EdgeCirculator around(mesh_, a);
    do {
      poll();
      const std::uint32_t h = around.at(), x = mesh_.target(h);
      if (x == b) return h;
      const Sign sign = side(a, b, x);
      if (sign == Sign::zero && same_direction(a, b, x)) return h;
      if (sign != Sign::negative || !mesh_.has_face(h)) continue;
      if (side(a, b, mesh_.apex(h)) != Sign::positive) continue;
      first = mesh_.next(h);
      break;
    } while (around.next());
    return no_index;
  }

  /// Collects the edges that the segment crosses before it meets a point, and returns that point;
  /// no_index if it crosses a constraint and `may_refuse`.
  std::uint32_t collect(std::uint32_t a, std::uint32_t b, std::uint32_t half, Crossed& crossed,
                        bool may_refuse) {
    for (;;) {
      poll();
      if (fixed(half) && may_refuse) return no_index;
      if (fixed(half))
        refuse("edges ", constraints_.name(std::min(source(half), constraint_)), " and ",
               constraints_.name(std::max(source(half), constraint_)), " cross");
      crossed.push_back(half);
      const std::uint32_t back = HalfEdges::twin(half);
      const std::uint32_t z = mesh_.apex(back);
      const Sign sign = z == b ? Sign::zero : side(a, b, z);
      if (sign == Sign::zero) return z;
      half = sign == Sign::negative ? mesh_.previous(back) : mesh_.next(back);
    }
  }

  /// Compares the distances of v and w, both on the left, from the line through a and b: positive
  /// if v is farther.
  Sign compare_heights(std::uint32_t a, std::uint32_t b, std::uint32_t v, std::uint32_t w) const {
    const double *p = s_.row(a), *q = s_.row(b), *x = s_.row(v), *y = s_.row(w);
    const DifferenceProduct terms[] = {{1, q, p, x + 1, y + 1}, {-1, q + 1, p + 1, x, y}};
    return sign_of_products(1, terms);
  }

  /// Flips edges until none crosses the segment. A vertex on its left that is higher than its
  /// neighbours along the crossed triangles loses its crossed edges, one after another.
  /// docs/exactness.md, "Constrained triangulations", proves termination.
  void clear(std::uint32_t a, std::uint32_t b, Crossed& crossed) {
    const auto last_of_vertex = [&](Crossed::iterator i) {
      const std::uint32_t w = mesh_.target(*i);
      for (auto next = std::next(i); next != crossed.end() && mesh_.target(*next) == w; ++next)
        i = next;
      return i;
    };
    auto at = last_of_vertex(crossed.begin());  // the last edge of a vertex on the left
    std::uint32_t last = no_index;
    while (!crossed.empty()) {
      poll();
      const std::uint32_t w = mesh_.target(*at);
      const auto end = std::next(at);
      if (end != crossed.end() && compare_heights(a, b, mesh_.target(*end), w) == Sign::positive) {
        at = last_of_vertex(end);
        continue;
      }
      while (at != crossed.begin() && mesh_.target(*std::prev(at)) == w) --at;
      last = clear_vertex(a, b, w, at, crossed);
      // The vertex before may have more edges now, and be higher than its neighbours.
      if (at != crossed.begin()) --at;
      if (at != crossed.end()) at = last_of_vertex(at);
    }
    fix(2 * last);
  }

  /// Flips all crossed edges of w, from `at` on; afterwards `at` is behind them. Returns the last
  /// edge flipped. Among the points on the right that edges of w lead to, one is a convex corner;
  /// it is found as in a scan for a convex chain, which steps back after each flip.
  std::uint32_t clear_vertex(std::uint32_t a, std::uint32_t b, std::uint32_t w,
                             Crossed::iterator& at, Crossed& crossed) {
    const auto own = [&](Crossed::iterator i) {
      return i != crossed.end() && mesh_.target(*i) == w;
    };
    std::uint32_t last = no_index;
    for (auto i = at; own(at);) {
      const std::uint32_t half = *i;
      const std::uint32_t before = mesh_.apex(half), after = mesh_.apex(HalfEdges::twin(half));
      if (side(before, mesh_.origin(half), after) != Sign::positive) {
        ++i;
        continue;
      }
      last = half / 2;
      mesh_.flip(last);
      touched_.push_back(last);
      const bool first = i == at;
      const auto back = first ? crossed.end() : std::prev(i);
      const std::uint32_t now = crossing_half(a, b, last);
      auto next = std::next(i);
      if (now == no_index)
        next = crossed.erase(i);
      else
        *i = now;  // the flipped edge now belongs to the vertex before or after
      if (first) at = next;
      i = first ? at : back;
    }
    return last;
  }

  /// The half-edge from the right of the segment to its left; no_index if the edge does not cross
  /// it.
  std::uint32_t crossing_half(std::uint32_t a, std::uint32_t b, std::uint32_t edge) const {
    const std::uint32_t u = mesh_.origin(2 * edge), v = mesh_.target(2 * edge);
    if (u == a || u == b || v == a || v == b) return no_index;
    const Sign of_u = side(a, b, u), of_v = side(a, b, v);
    if (of_u == of_v) return no_index;
    return of_u == Sign::negative ? 2 * edge : 2 * edge + 1;
  }

  /// Flips unconstrained edges, starting with the changed ones, until all are locally Delaunay
  /// (Lawson 1977).
  void restore() {
    std::vector<std::uint32_t> todo;
    for (const std::uint32_t edge : touched_) add_around(edge, todo);
    touched_.clear();
    while (!todo.empty()) {
      const std::uint32_t edge = todo.back();
      todo.pop_back();
      poll();
      if (fixed(2 * edge) || !mesh_.inner(edge) || !wrong(2 * edge)) continue;
      mesh_.flip(edge);
      add_around(edge, todo);
    }
  }
  void add_around(std::uint32_t edge, std::vector<std::uint32_t>& todo) const {
    todo.push_back(edge);
    for (const std::uint32_t h : {2 * edge, 2 * edge + 1})
      for (const std::uint32_t other : {mesh_.next(h), mesh_.previous(h)})
        todo.push_back(other / 2);
  }
  /// Whether the edge must be flipped: the apex across it is inside the circumcircle of h's
  /// triangle, or on the circle and the edge does not contain the lowest of the four ids.
  bool wrong(std::uint32_t h) {
    const std::uint32_t u = mesh_.origin(h), v = mesh_.target(h), p = mesh_.apex(h),
                        q = mesh_.apex(HalfEdges::twin(h));
    const double* corners[] = {s_.row(u), s_.row(v), s_.row(p)};
    const Sign sign = lift_side<2>(s_, corners, s_.row(q), counts_);
    if (sign != Sign::zero) return sign == Sign::negative;
    return std::min(s_.ids[p], s_.ids[q]) < std::min(s_.ids[u], s_.ids[v]);
  }

  const LiftedPoints& s_;
  const Constraints& constraints_;
  HalfEdges mesh_;
  std::vector<std::uint32_t> source_;  ///< for each edge, its constraint
  std::uint32_t constraint_ = 0;
  std::vector<std::uint32_t> touched_;
  LiftCounts counts_;
  const Run& run_;
  std::uint64_t steps_ = 0;
};

// ---------------------------------------------------------------------------------- the result

/// Writes half-edges as cells in canonical order.
class CellWriter {
 public:
  CellWriter(const Forcing& forcing, const Array<std::uint32_t>& ids)
      : forcing_(forcing), mesh_(forcing.mesh()), ids_(ids) {}

  /// Writes cells, neighbours and the pieces of constraints.
  void write(ConstrainedTriangulation& out, std::vector<Piece>& pieces) {
    find_cells();
    Triangulation& t = out.triangulation;
    const std::size_t count = cells_.size();
    Array<std::uint32_t> cell_of(mesh_.size());
    std::fill(cell_of.begin(), cell_of.end(), no_index);
    for (std::uint32_t c = 0; c < count; ++c) {
      std::uint32_t h = cells_[c];
      for (unsigned j = 0; j < 3; ++j, h = mesh_.next(h)) cell_of[h] = c;
    }
    t.cells.clear();
    t.neighbours.clear();
    for (const std::uint32_t first : cells_) {
      for (std::uint32_t h = first, j = 0; j < 3; ++j, h = mesh_.next(h))
        t.cells.push_back(ids_[mesh_.origin(h)]);
      for (std::uint32_t h = mesh_.next(first), j = 0; j < 3; ++j, h = mesh_.next(h))
        t.neighbours.push_back(cell_of[HalfEdges::twin(h)]);
    }
    for (std::uint32_t h = 0; h < mesh_.size(); h += 2) {
      if (!forcing_.fixed(h)) continue;
      const auto [low, high] = std::minmax(ids_[mesh_.origin(h)], ids_[mesh_.target(h)]);
      pieces.push_back({low, high, forcing_.source(h)});
    }
    write_depths(cell_of, out.depths);
  }

 private:
  /// Finds one half-edge per triangle, the one from its lowest id; sorted by ids.
  void find_cells() {
    for (std::uint32_t h = 0; h < mesh_.size(); ++h) {
      if (!mesh_.has_face(h)) continue;
      const std::uint32_t own = id(h);
      if (own < id(mesh_.next(h)) && own < id(mesh_.previous(h))) cells_.push_back(h);
    }
    std::sort(cells_.begin(), cells_.end(), [&](std::uint32_t a, std::uint32_t b) {
      for (unsigned j = 0; j < 3; ++j, a = mesh_.next(a), b = mesh_.next(b))
        if (id(a) != id(b)) return id(a) < id(b);
      return false;
    });
  }
  std::uint32_t id(std::uint32_t half) const { return ids_[mesh_.origin(half)]; }

  /// Computes depths breadth first, from the outside inward.
  void write_depths(const Array<std::uint32_t>& cell_of, Array<std::uint32_t>& depths) const {
    depths.assign(cells_.size(), no_index);
    std::deque<std::pair<std::uint32_t, std::uint32_t>> todo;
    const auto reach = [&](std::uint32_t half, std::uint32_t depth) {
      if (mesh_.has_face(half) && depths[cell_of[half]] == no_index) {
        if (forcing_.fixed(half))
          todo.emplace_back(half, depth + 1);
        else
          todo.emplace_front(half, depth);
      }
    };
    for (std::uint32_t h = 0; h < mesh_.size(); ++h)
      if (!mesh_.has_face(h)) reach(HalfEdges::twin(h), 0);
    while (!todo.empty()) {
      auto [h, depth] = todo.front();
      todo.pop_front();
      if (depths[cell_of[h]] != no_index) continue;
      depths[cell_of[h]] = depth;
      for (unsigned j = 0; j < 3; ++j, h = mesh_.next(h)) reach(HalfEdges::twin(h), depth);
    }
  }

  const Forcing& forcing_;
  const HalfEdges& mesh_;
  const Array<std::uint32_t>& ids_;
  std::vector<std::uint32_t> cells_;
};

/// Writes the result for collinear points: pieces lead from each point to the next.
void force_on_line(const PointView& points, const Constraints& constraints,
                   ConstrainedTriangulation& out) {
  std::vector<std::uint32_t> order(out.triangulation.cells.begin(), out.triangulation.cells.end());
  std::sort(order.begin(), order.end());
  order.erase(std::unique(order.begin(), order.end()), order.end());
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const double x = points.at(a, 0), y = points.at(b, 0);
    return x != y ? x < y : points.at(a, 1) < points.at(b, 1);
  });
  std::vector<std::uint32_t> place(points.count), free(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  std::iota(free.begin(), free.end(), 0U);  // the first step from here on that is not a piece yet
  const auto first_free = [&](std::uint32_t i) {
    while (free[i] != i) i = free[i] = free[free[i]];
    return i;
  };
  std::vector<Piece> pieces;
  for (std::uint32_t i = 0; i < constraints.size(); ++i) {
    const auto [begin, end] = std::minmax(place[constraints.from(i)], place[constraints.to(i)]);
    for (std::uint32_t at = first_free(begin); at < end; at = first_free(at)) {
      const auto [low, high] = std::minmax(order[at], order[at + 1]);
      pieces.push_back({low, high, i});
      free[at] = at + 1;
    }
  }
  write_pieces(pieces, out);
}

/// Keeps the cells of odd depth, renumbered.
void keep_inside(ConstrainedTriangulation& out) {
  std::vector<std::uint8_t> kept;
  Array<std::uint32_t> depths;
  for (const std::uint32_t depth : out.depths) {
    kept.push_back(depth % 2 == 1 ? 1 : 0);
    if (depth % 2 == 1) depths.push_back(depth);
  }
  keep_cells(out.triangulation, kept.data());
  out.depths = std::move(depths);
}

void force_all(const LiftedPoints& points, const Constraints& constraints, const Run& run,
               ConstrainedTriangulation& out) {
  const std::vector<std::uint32_t> place = places_of_ids(points, out.triangulation.point_count);
  Forcing forcing(out.triangulation, points, constraints, place, run);
  for (std::uint32_t i = 0; i < constraints.size(); ++i) {
    if (i % 256 == 0) run.check();
    if (i % 65536 == 65535) run.report("constraints", double(i) / constraints.size());
    forcing.force(place[constraints.from(i)], place[constraints.to(i)], i);
  }
  out.triangulation.cell_groups.clear();
  std::vector<Piece> pieces;
  CellWriter(forcing, points.ids).write(out, pieces);
  write_pieces(pieces, out);
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

ConstrainedTriangulation constrained_delaunay(const PointView& points,
                                              std::span<const std::uint32_t> edges,
                                              const ConstrainedOptions& o) {
  using namespace internal;
  if (points.dimension != 2)
    refuse("constrained triangulations are of points in the plane, not in dimension ",
           points.dimension);
  // Two cells a point; measured with 100,000 and 400,000 points of a disk.
  constexpr std::uint64_t bytes_per_point = 280;
  require_budget(resolve_budget(o.memory_budget), points.count * bytes_per_point,
                 "the cells of the constrained triangulation");
  ConstrainedTriangulation out;
  Prepared prepared;
  out.triangulation = triangulate(points, {}, options_as<TriangulationOptions>(o), prepared);
  const Constraints constraints(out.triangulation, edges);
  if (out.triangulation.affine_dimension < 2) {
    if (out.triangulation.affine_dimension == 1) force_on_line(points, constraints, out);
    return out;
  }
  const Call call(o);
  const Run& run = call.run;
  force_all(prepared.points, constraints, run, out);
  if (o.inside_only) keep_inside(out);
  Triangulation& t = out.triangulation;
  write_boundary(t, nullptr, t.hull_facets, t.hull_cells, run);
  run.report("done", 1);
  return out;
}

}  // namespace cullhull
