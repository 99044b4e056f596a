// Insertion in the plane without weights: every point becomes a vertex and no vertex is ever
// removed. The cavity of a point is then a tree of triangles, so that each edge is tested once, and
// no marks are needed. The new triangles overwrite those of the cavity; two more are allocated.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "delaunay/cell_store.hpp"
#include "delaunay/point_signs.hpp"
#include "exact/insphere/lift_side.hpp"
#include "exact/points/local_points.hpp"
#include "parallel/threads/run.hpp"
#include "parallel/two_doubles.hpp"

namespace cullhull::internal {

// Why the cavity is a tree here: without weights every point becomes a vertex, and a cavity in the
// plane is a polygon without inner vertices (a vertex inside would be hidden), so its triangles and
// the edges between them form a tree. n triangles have n + 2 boundary edges: each test either
// closes an edge or replaces it by two.
//
// The bound of the in-circle test, for corners u, v, w seen from p. A product of a 2 x 2 minor and
// a lift meets at most 11 roundings: two differences, a product and a difference in the minor; four
// in the lift; a product and two sums. The minor's products are |a_x b_y| + |a_y b_x| <= |a| |b| <=
// (|a|^2 + |b|^2) / 2, so all magnitudes add up to at most
//
//   |u| |w| |v|^2 + |w| |v| |u|^2 + |v| |u| |w|^2 <= |u|^2 |v|^2 + |w|^2 (|u|^2 + |v|^2),
//
// which needs the three lifts only. 16 u times that sum, as computed, also covers its own
// roundings. Example: corners at a distance of 1 give the bound 16 u * 3 = 5e-15; on a grid with
// spacing 1 / 1024 neighbours give 5e-15 * 1e-12.
//
// The infinite vertex is the row (0, 0, 1): the determinant is then the orientation of p and the
// edge, up to its sign, and with 1 in place of its squared length the same bound holds.
class PlaneInsertion {
 public:
  /// Writes cells into `store`.
  PlaneInsertion(const LiftedPoints& points, const Run& run, CellStore<2>& store)
      : s_(points), run_(run), store_(store), signs_(points) {}

  /// The number of cells made since start(), overwritten ones among them.
  std::uint64_t created() const { return created_; }
  const LiftCounts& counts() {
    counts_ = signs_.counts();
    counts_.rungs[0] += filtered_;
    return counts_;
  }

  /// Starts with three points that are not collinear. n points take the store's cells
  /// [first, first + 2 n - 2), all of them: no cell is deleted.
  void start(const std::uint32_t* simplex, std::uint32_t first) {
    tiny_ = s_.filtered ? s_.tiny : std::numeric_limits<double>::infinity();
    rows_ = s_.row(0);
    std::uint32_t v[3] = {simplex[0], simplex[1], simplex[2]};
    if (signs_.orientation(v) == Sign::negative) std::swap(v[1], v[2]);
    store_.make_simplex(v, first);
    last_ = first;
    next_ = first + 4;
    created_ = 4;
  }

  /// Inserts point p; always succeeds (true). May throw cancelled.
  bool insert(std::uint32_t p) {
    Corner corners[3];
    const std::uint32_t first = locate(p, corners);
    make_cells(p, find_cavity(first, corners));
    if ((++inserted_ & 1023) == 0) run_.check();
    return true;
  }

 private:
  using Pair = TwoDoubles;
  static Pair firsts(const Pair& a, const Pair& b) { return Pair{a[0], b[0]}; }
  static Pair seconds(const Pair& a, const Pair& b) { return Pair{a[1], b[1]}; }

  /// Coordinates relative to the point.
  struct Corner {
    double x, y;
  };
  // The boundary is a cycle of edges in one array, linked by indices: replacing an edge by two
  // keeps its place for the first of them and appends the second. Example: edges 0, 1, 2 of the
  // first triangle; the triangle across edge 1 is in conflict: edge 1 now ends at that triangle's
  // apex, edge 3 leads from the apex to where edge 1 ended, and 1 links to 3, 3 to 2. So n
  // triangles have n + 2 edges, in the order in which they were found, and new triangles link by
  // the same links.

  /// An edge of the cavity's boundary, in a cyclic list.
  struct alignas(64) Edge {
    Pair at;               ///< coordinates of its start, relative to the point
    Pair lift;             ///< of its start; the determinant of its start and its end
    std::uint64_t links;   ///< from the low bits: the neighbour across it (a code), the next edge
    std::uint32_t vertex;  ///< its start

    std::uint32_t code() const { return static_cast<std::uint32_t>(links); }
    std::uint32_t next() const { return static_cast<std::uint32_t>(links >> 32); }
  };
  static std::uint64_t packed(std::uint32_t low, std::uint32_t high) {
    return std::uint64_t{high} << 32 | low;
  }

  const double* row(std::uint32_t v) const { return rows_ + 2 * std::size_t{v}; }
  Corner finite_corner(std::uint32_t v) const {
    const double* q = row(v);
    return {q[0] - px_, q[1] - py_};
  }
  // Tables, because branches on slots would be unpredictable.
  static unsigned next(unsigned slot) {
    static constexpr std::uint8_t slots[4] = {1, 2, 0, 0};
    return slots[slot];
  }
  static unsigned previous(unsigned slot) {
    static constexpr std::uint8_t slots[4] = {2, 0, 1, 0};
    return slots[slot];
  }

  /// The determinant of two corners, and whether its sign is certain. Rounds as
  /// filtered_by_columns() does.
  struct Turn {
    double det, bound;
    bool negative() const { return det < -bound; }
    bool positive() const { return det > bound; }
  };
  Turn turn(const Corner& a, const Corner& b) const {
    const double l = a.x * b.y, r = a.y * b.x;
    return {l - r, 6 * unit_roundoff * (std::abs(l) + std::abs(r)) + tiny_};
  }
  /// Whether the edge of triangle c opposite to corner j, which has this turn, separates the point
  /// from c.
  bool beyond(const Turn& t, std::uint32_t c, unsigned j) {
    if (t.negative() || t.positive()) return t.negative();
    return signs_.replaced(store_.vertices(c), j) == Sign::negative;
  }

  /// Visibility walk to the triangle that contains the point, or to a ghost; sets its corners.
  std::uint32_t locate(std::uint32_t p, Corner* corners) {
    signs_.set_query(p);
    px_ = row(p)[0];
    py_ = row(p)[1];
    std::uint32_t c = last_;
    if (const unsigned g = store_.ghost_slot(c); g < 3) c = store_.cell_of(store_.neighbours(c)[g]);
    const std::uint32_t* v = store_.vertices(c);
    // The walk enters c by the edge from b to a; the corner w is opposite.
    Corner w = finite_corner(v[0]), a = finite_corner(v[1]), b = finite_corner(v[2]);
    unsigned from = 0;
    bool back = beyond(turn(a, b), c, 0);
    for (;;) {
      std::uint32_t code = 0;
      if (back) {
        code = store_.neighbours(c)[from];
        std::swap(a, b);
        back = false;
      } else {
        const Turn l = turn(b, w), r = turn(w, a);
        bool left = l.negative();
        if (static_cast<unsigned>(left) + static_cast<unsigned>(r.negative()) == 0) {
          if (static_cast<unsigned>(l.positive()) + static_cast<unsigned>(r.positive()) == 2) break;
          left = beyond(l, c, next(from));
          if (!left && !beyond(r, c, previous(from))) break;
        }
        code = store_.neighbours(c)[left ? next(from) : previous(from)];
        a.x = left ? w.x : a.x;
        a.y = left ? w.y : a.y;
        b.x = left ? b.x : w.x;
        b.y = left ? b.y : w.y;
      }
      c = store_.cell_of(code);
      from = store_.slot_of(code);
      const std::uint32_t apex = store_.vertices(c)[from];
      if (apex == infinite) {
        w = {0, 0};
        break;
      }
      w = finite_corner(apex);
      if ((++steps_ & 4095) == 0) run_.check();
    }
    corners[from] = w;
    corners[next(from)] = a;
    corners[previous(from)] = b;
    return c;
  }

  /// Finds the cavity and its boundary (edges_, cavity_), starting with a triangle and its corners;
  /// returns the number of edges. Each edge is tested once; if the triangle across it is in
  /// conflict, two edges replace it, which are tested together. The outcomes are unpredictable, so
  /// they are added to numbers instead of branched on.
  std::uint32_t find_cavity(std::uint32_t first, const Corner* corners) {
    const std::uint32_t* v = store_.vertices(first);
    for (unsigned j = 0; j < 3; ++j) {
      const Corner &a = corners[j], &b = corners[next(j)];
      const double lift = v[j] == infinite ? 1 : a.x * a.x + a.y * a.y;
      edges_[j] = {Pair{a.x, a.y}, Pair{lift, a.x * b.y - a.y * b.x},
                   packed(v[3 + previous(j)], next(j)), v[j]};
    }
    cavity_[0] = packed(first, 0);
    Front front{edges_.data(), cavity_.data(), store_.vertices(0), rows_,
                {px_, py_},    Pair{px_, py_}, Pair{tiny_, tiny_}, 3};
    test<1>(front, 2);
    for (std::uint32_t i = 0; i < front.count - 2; ++i) {
      if (front.count + 2 > room_) [[unlikely]] {
        grow();
        front.edges = edges_.data();
        front.cavity = cavity_.data();
      }
      test<2>(front, static_cast<std::uint32_t>(front.cavity[i] >> 32));
    }
    filtered_ += 2 * front.count - 3;
    return front.count;
  }

  /// What find_cavity() works on.
  struct Front {
    Edge* edges;
    std::uint64_t* cavity;
    std::uint32_t* cells;  ///< of the store: three vertices and three neighbours each
    const double* rows;
    double point[2];
    Pair at, tiny;        ///< the point; the underflow term twice
    std::uint32_t count;  ///< of edges; the cavity has two triangles less
  };

  /// Sets `at` to the coordinates of vertex v. The infinite vertex is (0, 0) with the lift 1: an
  /// in-circle determinant with this row is the orientation of the point and the other two corners.
  /// Returns what the lift adds to the square of the distance.
  [[gnu::always_inline]] static double corner(const Front& front, std::uint32_t v, Pair& at) {
    const double* q = front.rows + 2 * std::size_t{v};
    q = v == infinite ? front.point : q;
    at = Pair{q[0], q[1]} - front.at;
    return v == infinite ? 1 : 0;
  }

  /// Tests an edge and, if `tests` is 2, the next one.
  template <unsigned tests>
  [[gnu::always_inline]] void test(Front& front, std::uint32_t edge) {
    Edge& a = front.edges[edge];
    const std::uint32_t second = a.next();
    Edge& b = front.edges[second];
    const Edge& after = front.edges[b.next()];
    const std::uint32_t c = store_.cell_of(a.code()), d = store_.cell_of(b.code());
    const std::uint32_t *const cell = front.cells + std::size_t{c} * 6, *const other =
                                                                            front.cells +
                                                                            std::size_t{d} * 6;
    const unsigned slot = store_.slot_of(a.code()), slot_d = store_.slot_of(b.code());
    const std::uint32_t apex = cell[slot], apex_d = other[slot_d];
    Pair p, q;
    const double more = corner(front, apex, p), more_d = corner(front, apex_d, q);
    // Rows u, w, v relative to the point: start, apex and end. The determinant is positive inside
    // the circumcircle.
    const Pair ux = firsts(a.at, b.at), uy = seconds(a.at, b.at), ul = firsts(a.lift, b.lift);
    const Pair vx = firsts(b.at, after.at), vy = seconds(b.at, after.at),
               vl = firsts(b.lift, after.lift);
    const Pair uv = seconds(a.lift, b.lift);
    const Pair wx = firsts(p, q), wy = seconds(p, q), wl = wx * wx + wy * wy + Pair{more, more_d};
    const Pair uw = ux * wy - uy * wx, wv = wx * vy - wy * vx;
    const Pair det = uw * vl + wv * ul - uv * wl;
    // Roundings on a path of the computation: 2 differences, a product, a difference; 4 for the
    // lift, a product, 2 sums. The magnitudes of all products add up to at most |u| |w| |v|^2 + |w|
    // |v| |u|^2 + |u| |v| |w|^2, and with 2 |u| |w| <= |u|^2 + |w|^2 to the sum below.
    const Pair bound = 16 * unit_roundoff * (ul * vl + wl * (ul + vl)) + front.tiny;
    const unsigned above = less_bits(bound, det);
    std::uint32_t hit = above & 1, hit_d = above >> 1;
    const unsigned doubtful = ~(above | less_bits(det, -bound)) & ((1U << tests) - 1);
    if (doubtful != 0) [[unlikely]] {
      if ((doubtful & 1) != 0) hit = conflict_in_doubt(c);
      if ((doubtful & 2) != 0) hit_d = conflict_in_doubt(d);
    }
    replace(front, a, edge, hit, c, cell, slot, apex, p, firsts(wl, wv), uw[0]);
    if (tests == 2)
      replace(front, b, second, hit_d, d, other, slot_d, apex_d, q, seconds(wl, wv), uw[1]);
  }

  /// If `hit` is 1, adds triangle c, across edge e in slot `slot`, to the cavity: the edge then
  /// ends at the triangle's apex, and a new edge leads from there to the old end. `minor`: the
  /// determinant of the shortened edge's ends.
  [[gnu::always_inline]] static void replace(Front& front, Edge& e, std::uint32_t edge,
                                             std::uint32_t hit, std::uint32_t c,
                                             const std::uint32_t* cell, unsigned slot,
                                             std::uint32_t apex, const Pair& at, const Pair& lift,
                                             double minor) {
    const std::uint32_t count = front.count;
    Edge& added = front.edges[count];
    added.at = at;
    added.lift = lift;
    added.links = packed(cell[3 + previous(slot)], e.next());
    added.vertex = apex;
    front.cavity[count - 2] = packed(c, edge);
    e.links ^= (e.links ^ packed(cell[3 + next(slot)], count)) & (0 - std::uint64_t{hit});
    e.lift[1] = minor;  // not used again unless hit
    front.count = count + hit;
  }

  /// Returns 1 if triangle c is in conflict, else 0.
  [[gnu::noinline]] std::uint32_t conflict_in_doubt(std::uint32_t c) {
    --filtered_;
    return signs_.conflict(store_, c) ? 1 : 0;
  }

  void grow() {
    room_ *= 2;
    edges_.resize(room_);
    cavity_.resize(room_);
  }

  /// Creates a triangle p, from, to for each boundary edge. Its neighbours: slot 0 outside the
  /// cavity, slot 1 the next new triangle, slot 2 the previous one.
  void make_cells(std::uint32_t p, std::uint32_t count) {
    created_ += count;
    for (const std::uint32_t i : {count - 2, count - 1}) {
      store_.mark(next_) = 0;
      cavity_[i] = next_++;
    }
    const Edge* const edges = edges_.data();
    const std::uint64_t* const made = cavity_.data();
    std::uint32_t* const cells = store_.vertices(0);
    std::uint32_t last = no_index;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Edge& e = edges[i];
      const std::uint32_t n = e.next(), code = e.code(), to = edges[n].vertex;
      const auto c = static_cast<std::uint32_t>(made[i]),
                 after = static_cast<std::uint32_t>(made[n]);
      std::uint32_t *v = cells + std::size_t{c} * 6, *across = v + 3;
      v[0] = p;
      v[1] = e.vertex;
      v[2] = to;
      across[0] = code;
      across[1] = store_.code(after, 2);
      cells[std::size_t{store_.cell_of(code)} * 6 + 3 + store_.slot_of(code)] = store_.code(c, 0);
      cells[std::size_t{after} * 6 + 5] = store_.code(c, 1);
      last = e.vertex != infinite && to != infinite ? c : last;
    }
    last_ = last == no_index ? static_cast<std::uint32_t>(made[0]) : last;
  }

  const LiftedPoints& s_;
  const Run& run_;
  CellStore<2>& store_;
  PointSigns<2> signs_;
  double tiny_ = 0;  ///< underflow term of the filters; infinite if no filter may decide
  const double* rows_ = nullptr;
  double px_ = 0, py_ = 0;
  std::uint64_t steps_ = 0, inserted_ = 0, filtered_ = 0, created_ = 0;
  std::uint32_t last_ = 0, next_ = 0;  ///< where walks start; the next cell that is unused
  LiftCounts counts_;
  std::uint32_t room_ = 64;
  std::vector<Edge> edges_ = std::vector<Edge>(room_);
  /// For each triangle of the cavity its number and, in the high bits, the first of two consecutive
  /// edges that it brought.
  std::vector<std::uint64_t> cavity_ = std::vector<std::uint64_t>(room_);
};

/// Finds three points, the last of them among the first `most` or the last one of all, that are
/// not collinear; false if there are none. `places`: the points'.
inline bool find_triangle(const LiftedPoints& s, std::span<const std::uint32_t> places,
                          std::size_t most, std::uint32_t* simplex) {
  const std::size_t n = places.size();
  const auto turn = [&](std::size_t a, std::size_t b, std::size_t c) {
    const std::size_t of[3] = {a, b, c};
    const double* at[3];
    for (unsigned i = 0; i < 3; ++i) at[i] = s.row(simplex[i] = places[of[i]]);
    return base_orientation<2>(s, at) != Sign::zero;
  };
  if (n < 3) return false;
  if (turn(0, n / 2, n - 1)) return true;
  for (std::size_t c = 2; c < std::min(n, most); ++c)
    if (turn(0, 1, c)) return true;
  return false;
}

/// Whether PlaneInsertion can triangulate these points.
inline bool plain_plane(const LiftedPoints& s) {
  return s.base == 2 && s.stride == 2 && !s.may_hide;
}

}  // namespace cullhull::internal
