// Incremental Delaunay and regular triangulation in any dimension (Bowyer 1981; Watson 1981), with
// one vertex at infinity. The cells in conflict with a new point form its cavity. They are replaced
// by new cells that join the point to the facets of the cavity's boundary. Two new cells are linked
// by walking around their common ridge through the cavity, or by tables of edges or ridges.
//
// Why a new cell is never flat: a facet F of the cavity's boundary lies between a cell in conflict
// with p and one that is not. If p were in the hyperplane of F, both cells' planes would have the
// same height over p (they share F), so both would be in conflict or neither.
//
// Why the cavity is connected: below the lifted point the lower hull's facets that it sees are, as
// for any convex surface, one piece, and the cell that contains p is among them. So a search across
// facets from that cell finds all of them.
//
// Example in the plane, cells (0, 1, 2) and (0, 2, 3) of a square and p = 4 inside of the first one
// and of both circles: the cavity is both cells, its boundary the four sides, and the new cells are
// (0, 1, 4), (1, 2, 4), (2, 3, 4) and (3, 0, 4). A point outside of the square is in conflict with
// ghosts: cells of a hull facet and the infinite vertex, whose circle is the half plane beyond the
// facet.
//
// Ghost cells make the hull's outside a part of the triangulation, so no case is special: every
// facet has a cell on either side.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "delaunay/cell_planes.hpp"
#include "delaunay/cell_store.hpp"
#include "delaunay/point_signs.hpp"
#include "exact/insphere/lift_side.hpp"
#include "exact/insphere/lift_sides.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/points/local_points.hpp"
#include "geometry/simplex.hpp"
#include "parallel/random_stream.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// The triangulation under construction, by one thread or several.
template <unsigned K>
struct GrowingCells {
  GrowingCells(unsigned k, std::uint64_t budget) : store(k, budget) {}

  /// Reserves up to `cells` unused cells for the calling thread and appends them to `to`. Returns
  /// false if no unused cell remains.
  bool take(std::uint32_t cells, std::vector<std::uint32_t>& to) {
    const std::uint64_t first = next.fetch_add(cells, std::memory_order_relaxed);
    const std::uint64_t last = std::min<std::uint64_t>(first + cells, end);
    for (std::uint64_t c = last; c > first; --c) {
      to.push_back(static_cast<std::uint32_t>(c - 1));
      store.mark(to.back()) = CellStore<K>::dead_mark;
    }
    return first < last;
  }

  CellStore<K> store;
  PlaneArray<K> planes;
  std::atomic<std::uint64_t> next{0};  ///< the first cell that no thread has reserved
  std::uint64_t end = 0;               ///< of the cells that threads may reserve
};

enum class Inserted : std::uint8_t {
  done,
  hidden,  ///< the point conflicts with no cell: its lifted point is not below the lower hull
  busy,    ///< another thread holds a cell that is needed; the triangulation is unchanged
  full,    ///< no unused cells remain; the triangulation is unchanged
};

/// Inserts points one after another. K: the dimension of the points' flat if it is a compile-time
/// constant, otherwise 0. `shared`: several threads insert into the same cells (insert_together),
/// each with an object of this class. A thread takes a cell by writing its own mark into it. No
/// other thread changes a held cell until it is released. A thread also reads the vertices of a
/// held cell's neighbours without holding them: vertices of a live cell never change, and a
/// neighbour of a held cell cannot be deleted.
template <unsigned K, bool shared = false>
class CellInsertion {
 public:
  CellInsertion(const LiftedPoints& points, const Run& run) requires(!shared)
      : s_(points), run_(run), cells_(points.base, run.budget), signs_(points), planes_(points) {
    make_tables();
  }
  /// For one of several threads; each thread passes a different `number`.
  CellInsertion(const LiftedPoints& points, const Run& run, GrowingCells<K>& cells,
                std::uint32_t number) requires(shared)
      : s_(points), run_(run), cells_(cells), signs_(points), planes_(points) {
    make_tables();
    in_ = 2 * number + 2;
  }

  GrowingCells<K>& cells() { return cells_; }
  CellStore<K>& store() { return cells_.store; }
  const LiftCounts& counts() {
    counts_ = signs_.counts();
    counts_.rungs[0] += by_plane_;
    counts_.rungs[1] += by_lanes_;
    return counts_;
  }

  /// Starts with the cell of k + 1 affinely independent points. `expected`: the approximate number
  /// of points, which sizes the first allocation.
  void start(const std::uint32_t* simplex, std::uint32_t expected) {
    std::vector<std::uint32_t> v(simplex, simplex + corners());
    if (signs_.orientation(v.data()) == Sign::negative) std::swap(v[k() - 1], v[k()]);
    cells_.store.start(v.data(), expected);
    if constexpr (with_planes) {
      planes_.set_room(cells_.planes, cells_.store.capacity());
      for (std::uint32_t c = 0; planes_.used() && c < cells_.store.count(); ++c)
        planes_.set_none(c);
    }
    last_ = 0;
  }

  /// Inserts point p: visibility walk, cavity, new cells. May throw cancelled.
  Inserted insert(std::uint32_t p) {
    signs_.set_query(p);
    if constexpr (with_planes) planes_.set_point(p);
    const std::uint32_t first = locate();
    if (first == no_index) return Inserted::busy;
    if (s_.may_hide && !conflict(first)) {
      let_go();
      return Inserted::hidden;
    }
    if (!find_cavity(first)) {
      let_go();
      return Inserted::busy;
    }
    if (!have_room()) {
      let_go();
      return Inserted::full;
    }
    if (K == 3 && facets_.size() <= 2 * most_labels - 4) {  // vertices by Euler's formula
      make_cells_in_space(p);
    } else {
      make_cells(p);
      join_cells();
    }
    for (const std::uint32_t c : cavity_) free_cell(c);
    let_go();
    work_ += facets_.size();
    if (work_ > 4096) {  // well below a millisecond of work in any dimension
      work_ = 0;
      run_.check();
    }
    return Inserted::done;
  }

  /// Lets other threads insert `more` points into these cells, which have `done` points, until
  /// unshare(). Reserves unused cells, as far as the budget allows: half as many again as the
  /// points need if they have as many cells each, plus `spare`.
  void share(std::uint64_t more, std::uint64_t done, std::uint64_t spare) {
    const std::uint64_t live = cells_.store.living();
    const double part = 1.25 * double(more) / double(std::max<std::uint64_t>(done, 1));
    const auto needed = static_cast<std::uint64_t>(double(live) * std::min(2.0, part));
    cells_.end = cells_.store.reserve_up_to(cells_.store.count() + needed + spare);
    if constexpr (with_planes) planes_.set_room(cells_.planes, cells_.store.capacity());
    cells_.next = cells_.store.count();
  }
  void unshare() { cells_.store.unshare(std::min<std::uint64_t>(cells_.next, cells_.end)); }
  /// Call after other threads have inserted: the walks' start cell may have been deleted.
  void restart() {
    last_ = 0;
    while (cells_.store.dead(last_)) ++last_;
    if constexpr (with_planes) planes_.set_room(cells_.planes, cells_.store.capacity());
  }
  /// Returns this thread's unused cells to the store.
  void give_cells_back() requires(shared) {
    cells_.store.give_back(spare_, created_);
    spare_.clear();
    created_ = 0;
  }

 private:
  struct Facet {
    std::uint32_t cell, slot, made;
  };
  enum class CellState : std::uint8_t { inside, outside, first, busy };

  void make_tables() {
    if constexpr (K == 3) {
      labels_.resize(label_places);
      edges_.reserve(std::size_t{most_labels} * most_labels);
      labelled_.resize(most_labels);
    }
  }

  std::atomic_ref<std::uint32_t> mark(std::uint32_t c) {
    return std::atomic_ref<std::uint32_t>(cells_.store.mark(c));
  }
  std::uint32_t out() const { return in_ + 1; }

  /// Takes cell c if no thread holds it; false if one does or the cell is dead.
  bool hold(std::uint32_t c) {
    std::uint32_t free = 0;
    return mark(c).compare_exchange_strong(free, out(), std::memory_order_acquire,
                                           std::memory_order_relaxed);
  }
  /// Releases every cell this thread holds, except those it deleted.
  void let_go() {
    if constexpr (shared) {
      for (const std::uint32_t c : held_)
        if (mark(c).load(std::memory_order_relaxed) != CellStore<K>::dead_mark)
          mark(c).store(0, std::memory_order_release);
      held_.clear();
    }
  }

  /// Classifies a cell during the search for the cavity: known to be inside, known to be outside,
  /// seen for the first time (and now held), or held by another thread.
  CellState classify(std::uint32_t c) {
    const std::uint32_t known = mark(c).load(std::memory_order_relaxed);
    if (known == in_) return CellState::inside;
    if (known == out()) return CellState::outside;
    if constexpr (shared) {
      if (known != 0 || !hold(c)) return CellState::busy;
      held_.push_back(c);
    }
    return CellState::first;
  }
  void set_mark(std::uint32_t c, std::uint32_t value) {
    mark(c).store(value, std::memory_order_relaxed);
  }
  bool inside(std::uint32_t c) { return mark(c).load(std::memory_order_relaxed) == in_; }

  /// Ensures one unused cell for each facet of the cavity's boundary; false if there are too few.
  bool have_room() {
    if constexpr (shared) {
      constexpr std::uint32_t many = 256;  // cells per reservation; a cavity needs tens to hundreds
      while (spare_.size() < facets_.size())
        if (!cells_.take(many, spare_)) return false;
    }
    return true;
  }
  std::uint32_t new_cell() {
    if constexpr (shared) {
      const std::uint32_t c = spare_.back();
      spare_.pop_back();
      ++created_;
      mark(c).store(out(), std::memory_order_relaxed);
      held_.push_back(c);
      return c;
    } else {
      return cells_.store.new_cell();
    }
  }
  void free_cell(std::uint32_t c) {
    if constexpr (shared) {
      mark(c).store(CellStore<K>::dead_mark, std::memory_order_relaxed);
      spare_.push_back(c);
    } else {
      cells_.store.free_cell(c);
    }
  }

  unsigned k() const { return cells_.store.corners() - 1; }
  unsigned corners() const { return cells_.store.corners(); }

  // Why the walk ends: order the cells by the height of their lifted planes over p. Crossing a
  // facet that separates p from the cell leads to a plane that is strictly lower over p, because
  // the lower hull is convex at every facet (strictly, once ties are perturbed). So no cell comes
  // twice. Example: across n points of a square a walk takes about sqrt(n) steps; points of a round
  // come in the order of a curve, so that walks from the last new cell are short.

  /// Visibility walk: crosses facets that separate p from the cell until it reaches the cell that
  /// contains p, or a ghost. It terminates because the perturbed triangulation is regular, so that
  /// no cell is visited twice. Returns no_index if another thread holds a cell on the way.
  std::uint32_t locate() {
    std::uint32_t c = start_of_walk();
    if (c == no_index) return no_index;
    if (const unsigned g = cells_.store.ghost_slot(c); g < corners())
      c = step(c, cells_.store.cell_of(cells_.store.neighbours(c)[g]));
    unsigned from = corners();
    while (c != no_index) {
      const unsigned j = signs_.separating_facet(cells_.store.vertices(c), from);
      if (j == corners()) break;
      const std::uint32_t code = cells_.store.neighbours(c)[j];
      c = step(c, cells_.store.cell_of(code));
      if (c == no_index) break;
      from = cells_.store.slot_of(code);
      if (cells_.store.vertices(c)[from] == infinite) break;
      if ((++steps_ & 4095) == 0) run_.check();
    }
    if constexpr (shared)
      if (c != no_index) held_.push_back(c);
    return c;
  }
  std::uint32_t start_of_walk() {
    if constexpr (shared) {
      constexpr int tries = 64;  // random cells to try where most are dead or held by other threads
      std::uint32_t c = last_;
      for (int i = 0; i < tries; ++i) {
        if (hold(c)) return c;
        c = static_cast<std::uint32_t>(random_.next() % cells_.store.count());
      }
      return no_index;
    }
    return last_;
  }
  /// Moves the walk to the next cell and releases the last one; no_index if another thread holds
  /// it.
  std::uint32_t step(std::uint32_t from, std::uint32_t to) {
    if constexpr (shared) {
      const bool held = hold(to);
      mark(from).store(0, std::memory_order_release);
      return held ? to : no_index;
    }
    return to;
  }

  /// Whether the point is in conflict with cell c: inside its circumsphere (below its lifted cell),
  /// ties broken.
  bool conflict(std::uint32_t c) { return signs_.conflict(cells_.store, c); }

  // The order of the rungs for one cell: its kept plane in doubles; on a lattice the same plane
  // exactly; then double-doubles, many cells at a time; then the predicate one by one, which ends
  // with integers and ties. A cell that waits for the third counts as not in conflict until
  // decided, so that the search can go on; if it turns out to be inside, the search continues from
  // it.

  /// conflict() for a cell whose plane does not decide. If it decides on no lattice either, the
  /// cell is deferred (decide_undecided) and counts as not in conflict until then.
  [[gnu::noinline]] bool conflict_in_doubt(std::uint32_t c) {
    if constexpr (with_planes) {
      if (planes_.known(c)) {
        Sign side = Sign::zero;
        if (!planes_.decides_on_lattice(c, side)) {
          undecided_.push_back(c);
          return false;
        }
        ++by_plane_;
        return side == Sign::zero ? signs_.tied_conflict(cells_.store.vertices(c))
                                  : side == Sign::negative;
      }
    }
    return conflict(c);
  }

  /// Decides the deferred cells by double-doubles, many at a time. Those in conflict are appended
  /// to the cavity's `cells`.
  void decide_undecided(std::size_t& cells) {
    if constexpr (with_planes) {
      double rows[(K + 1) * K * sides_block] = {}, signs[sides_block];
      for (std::size_t begin = 0; begin < undecided_.size(); begin += sides_block) {
        const std::size_t count = std::min(sides_block, undecided_.size() - begin);
        for (std::size_t lane = 0; lane < count; ++lane) {
          const std::uint32_t* v = cells_.store.vertices(undecided_[begin + lane]);
          for (unsigned i = 0; i <= K; ++i)
            for (unsigned j = 0; j < K; ++j)
              rows[(i * K + j) * sides_block + lane] = s_.row(v[i])[j];
        }
        lift_sides_double_double(K, rows, signs_.point(), s_.tiny, signs);
        for (std::size_t lane = 0; lane < count; ++lane) {
          const std::uint32_t c = undecided_[begin + lane];
          const bool decided = signs[lane] != 0;
          by_lanes_ += decided ? 1 : 0;
          if (!(decided ? signs[lane] < 0 : conflict(c))) continue;
          set_mark(c, in_);
          make_room(cells, 0);
          room_of_cells_[cells++] = c;
        }
      }
    }
    undecided_.clear();
  }

  // Cells are marked with `in_` or `in_ + 1`, a pair of stamps that no cell has from earlier
  // searches, so nothing need be cleared. A facet is listed when its cell is in conflict and the
  // cell across is not yet known to be: with cells put off for double-doubles some of these turn
  // out to be inside, and their facets are removed afterwards.

  /// Collects the cells in conflict with the point, which are connected to `first` through facets,
  /// and the facets of their boundary. Returns false if another thread holds one of these cells or
  /// of their neighbours.
  bool find_cavity(std::uint32_t first) {
    if constexpr (!shared) in_ = cells_.store.next_stamp();
    undecided_.clear();
    make_room(0, 0);
    room_of_cells_[0] = first;
    set_mark(first, in_);
    std::size_t searched = 0, cells = 1, facets = 0;
    bool put_off = false;
    while (searched < cells) {
      bool free = false;
      if constexpr (with_planes)
        free = !planes_.used()       ? search<Tests::exact>(searched, cells, facets)
               : planes_.on_sphere() ? search<Tests::powers>(searched, cells, facets)
                                     : search<Tests::planes>(searched, cells, facets);
      else
        free = search<Tests::exact>(searched, cells, facets);
      if (!free) return false;
      if (!undecided_.empty()) {
        put_off = true;
        decide_undecided(cells);
      }
    }
    cavity_ = {room_of_cells_.data(), cells};
    facets_ = {room_of_facets_.data(), facets};
    if (put_off) {  // some cells beyond a facet have turned out to be inside
      std::size_t kept = 0;
      for (const Facet& f : facets_)
        if (!inside(cells_.store.cell_of(cells_.store.neighbours(f.cell)[f.slot])))
          room_of_facets_[kept++] = f;
      facets_ = facets_.first(kept);
    }
    return true;
  }
  /// What decides whether a cell is in conflict: the predicate, or first its plane, of squared
  /// distances or of powers with respect to a common sphere.
  enum class Tests : std::uint8_t { exact, planes, powers };
  /// Continues the search from cell number `searched` of the cavity. Returns false if another
  /// thread holds a cell.
  template <Tests tests>
  [[gnu::noinline]] bool search(std::size_t& searched, std::size_t& cells, std::size_t& facets) {
    const double* const p = signs_.point();
    std::size_t cell = cells, facet = facets, i = searched;
    std::uint64_t tested = 0;
    constexpr std::size_t ahead = 3;  // cells; 1 takes 2 to 3 % longer from 65,000 points on
    for (; i < cell; ++i) {
      make_room(cell, facet);
      std::uint32_t* const to_cells = room_of_cells_.data();
      Facet* const to_facets = room_of_facets_.data();
      const std::uint32_t c = to_cells[i];
      const std::uint32_t* n = cells_.store.neighbours(c);
      if (i + ahead < cell) prefetch_around(to_cells[i + ahead]);
      for (unsigned j = 0; j < corners(); ++j) {
        const std::uint32_t o = cells_.store.cell_of(n[j]);
        const CellState seen = classify(o);
        if (seen == CellState::busy) return false;
        bool in = seen == CellState::inside;
        if (seen == CellState::first) {
          if constexpr (tests != Tests::exact) {
            ++tested;
            if (!planes_.template decides<tests == Tests::powers>(o, p, in)) [[unlikely]] {
              in = conflict_in_doubt(o);
              --tested;
            }
          } else {
            in = conflict(o);
          }
          set_mark(o, out() - (in ? 1 : 0));
          // Whether a cell is in conflict is unpredictable. Branch-free: stores its number in both
          // lists and advances the one that it belongs to.
          to_cells[cell] = o;
          cell += in ? 1 : 0;
          prefetch_line(cells_.store.vertices(o));
        }
        to_facets[facet] = {c, j, no_index};
        facet += in ? 0 : 1;
      }
    }
    by_plane_ += tested;
    searched = i;
    cells = cell;
    facets = facet;
    return true;
  }
  void make_room(std::size_t cells, std::size_t facets) {
    if (room_of_cells_.size() < cells + corners()) room_of_cells_.resize(2 * (cells + corners()));
    if (room_of_facets_.size() < facets + corners())
      room_of_facets_.resize(2 * (facets + corners()));
  }

  /// Prefetches what find_cavity() reads of a cell's neighbours.
  void prefetch_around(std::uint32_t c) {
    const std::uint32_t* n = cells_.store.neighbours(c);
    for (unsigned j = 0; j < corners(); ++j) {
      const std::uint32_t o = cells_.store.cell_of(n[j]);
      cells_.store.prefetch_mark(o);
      if constexpr (with_planes) {
        if (planes_.used()) planes_.prefetch(o);
      } else {
        prefetch_line(cells_.store.vertices(o));
      }
    }
  }

  /// Creates the new cell of a facet: the facet's cell in the cavity with the vertex opposite to
  /// the facet replaced by p, which keeps the orientation. Links it with the cell outside. Returns
  /// its vertices.
  std::uint32_t* make_cell(Facet& f, std::uint32_t p) {
    f.made = new_cell();
    const std::uint32_t *old = cells_.store.vertices(f.cell),
                        outside = cells_.store.neighbours(f.cell)[f.slot];
    std::uint32_t* v = cells_.store.vertices(f.made);
    std::copy_n(old, corners(), v);
    v[f.slot] = p;
    cells_.store.link(f.made, f.slot, outside);
    return v;
  }

  /// Creates a new cell for each facet of the boundary. The cell in the cavity then refers to the
  /// new cell across this facet, where join() finds it.
  void make_cells(std::uint32_t p) {
    last_ = no_index;
    for (Facet& f : facets_) {
      const std::uint32_t* v = make_cell(f, p);
      std::uint32_t* n = cells_.store.neighbours(f.made);
      bool finite = true;
      for (unsigned i = 0; i < corners(); ++i) {
        if (i != f.slot) n[i] = no_index;
        finite = finite && v[i] != infinite;
      }
      cells_.store.neighbours(f.cell)[f.slot] = cells_.store.code(f.made, f.slot);
      if (finite) last_ = f.made;
      if constexpr (with_planes) {
        if (!planes_.used()) continue;
        if constexpr (!shared) planes_.set_room(cells_.planes, cells_.store.capacity());
        if (finite)
          planes_.add(f.made, v, f.slot);
        else
          planes_.set_none(f.made);
      }
    }
    if constexpr (with_planes) planes_.flush();
    if (last_ == no_index) last_ = facets_.front().made;
  }

  /// Forgets all labels: vertices of the next boundary are labelled from 0.
  void clear_labels() {
    if (label_base_ > ~std::uint32_t{0} - 4 * most_labels) {
      std::fill(labels_.begin(), labels_.end(), Label{});
      label_base_ = 0;
    }
    label_base_ += most_labels;
  }
  /// A vertex and its label plus label_base_; with a lower base it is of an earlier boundary.
  struct Label {
    std::uint32_t vertex = 0, label = 0;
  };
  /// Gives the vertices of the boundary small numbers, in the order in which they are first seen.
  /// A hash table that stays in the first cache. Branch-free but for the few vertices that meet
  /// another one's place, because whether a vertex has been seen is unpredictable.
  class Labels {
   public:
    explicit Labels(CellInsertion& all)
        : table_(all.labels_.data()), vertices_(all.labelled_.data()), base_(all.label_base_) {}
    std::uint32_t operator()(std::uint32_t v) {
      for (std::uint32_t at = v * 0x9e3779b9U >> (32 - label_bits);; at = (at + 1) % label_places) {
        Label& known = table_[at];
        const std::uint32_t old = known.label - base_;
        const bool fresh = old >= most_labels;
        if (static_cast<unsigned>(fresh) + static_cast<unsigned>(known.vertex == v) == 0) continue;
        const std::uint32_t label = fresh ? count_ : old;
        known = {v, base_ + label};
        vertices_[label] = v;
        count_ += fresh ? 1 : 0;
        return label;
      }
    }
    std::uint32_t count() const { return count_; }

   private:
    Label* table_;
    std::uint32_t *vertices_, base_, count_ = 0;
  };

  // Why a table of pairs is enough: a closed surface of triangles has each of its edges in two
  // triangles, once in each direction. A new cell over (a, b, c) writes its code at (b, c), (c, a)
  // and (a, b); the cell on the other side of the edge b c finds it by reading (b, c), as it has
  // the edge as c b. By Euler's formula f facets have f / 2 + 2 vertices, so a boundary of at most
  // 2 most_labels - 4 facets has at most most_labels of them.
  //
  // Example: a tetrahedron around p has the facets (0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2). The
  // cell over (0, 1, 2) writes at (1, 2), and the cell over (1, 3, 2), which has the edge as (2,
  // 1), reads there.

  /// 3D: make_cells() and join_cells() for a boundary of at most most_labels vertices. The boundary
  /// is a closed surface: each of its edges belongs to two facets, which have it in opposite
  /// directions, so a table over pairs of labels finds the cell on the other side.
  void make_cells_in_space(std::uint32_t p) {
    // For each slot the other slots, in an order that orients the facets of a cell alike.
    static constexpr std::uint8_t around[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    clear_labels();
    Labels label(*this);
    std::uint32_t* const edges = edges_.data();
    if (corners_.size() < facets_.size()) corners_.resize(2 * facets_.size());
    std::array<std::uint32_t, 3>* corners = corners_.data();
    for (Facet& f : facets_) {
      const std::uint32_t* v = make_cell(f, p);
      const std::uint8_t* slot = around[f.slot];
      const std::uint32_t a = label(v[slot[0]]), b = label(v[slot[1]]), c = label(v[slot[2]]);
      *corners++ = {a, b, c};
      edges[b * most_labels + c] = cells_.store.code(f.made, slot[0]);
      edges[c * most_labels + a] = cells_.store.code(f.made, slot[1]);
      edges[a * most_labels + b] = cells_.store.code(f.made, slot[2]);
    }
    if constexpr (with_planes) {
      if constexpr (!shared) planes_.set_room(cells_.planes, cells_.store.capacity());
      planes_.see(labelled_.data(), label.count());
    }
    const std::uint32_t* const vertex = labelled_.data();
    std::uint32_t last = no_index;
    corners = corners_.data();
    for (const Facet& f : facets_) {
      const auto [a, b, c] = *corners++;
      const std::uint8_t* slot = around[f.slot];
      std::uint32_t* n = cells_.store.neighbours(f.made);
      n[slot[0]] = edges[c * most_labels + b];
      n[slot[1]] = edges[a * most_labels + c];
      n[slot[2]] = edges[b * most_labels + a];
      const bool finite = vertex[a] != infinite && vertex[b] != infinite && vertex[c] != infinite;
      if (finite) last = f.made;
      if constexpr (with_planes) {
        if (!planes_.used()) continue;
        if (finite)
          planes_.add_seen(f.made, a, b, c);
        else
          planes_.set_none(f.made);
      }
    }
    last_ = last == no_index ? facets_.front().made : last;
    if constexpr (with_planes) planes_.flush();
  }

  // Why sums find partners: each ridge of the boundary belongs to exactly two new cells. Each adds
  // its code, with a count, to the slot that the ridge hashes to. Where the count is 2, the slot
  // has one ridge, and the sum less a cell's own code is its partner's, whatever the hash function
  // is. Example: codes 12 and 40 at one slot: sum 52, count 2, so 12 finds 52 - 12 = 40. A count of
  // 4 means two ridges: walk.

  /// 4D to 6D: links the new cells, two at each ridge of the cavity's boundary. A table holds for
  /// each ridge, by hash, the sum of the two cells' codes. Ridges with equal hashes are linked by
  /// walking (join).
  void join_by_sums() {
    const std::size_t ridges = facets_.size() * (corners() - 1);
    const auto bits = static_cast<unsigned>(std::bit_width(2 * ridges));
    sums_.assign(std::size_t{1} << bits, 0);
    places_.resize(ridges);
    std::uint32_t* place = places_.data();
    for (const Facet& f : facets_) {
      const std::uint32_t* v = cells_.store.vertices(f.made);
      std::uint64_t hash[K + 1], all = 0;
      for (unsigned i = 0; i <= K; ++i) {
        hash[i] = i == f.slot ? 0 : hash_of(v[i]);
        all += hash[i];
      }
      for (unsigned i = 0; i <= K; ++i) {
        if (i == f.slot) continue;
        *place = static_cast<std::uint32_t>((all - hash[i]) >> (64 - bits));
        sums_[*place++] += RidgeSums::entry(cells_.store.code(f.made, i));
      }
    }
    place = places_.data();
    for (const Facet& f : facets_) {
      std::uint32_t* n = cells_.store.neighbours(f.made);
      for (unsigned i = 0; i <= K; ++i) {
        if (i == f.slot) continue;
        const std::uint64_t sum = sums_[*place++];
        if (RidgeSums::is_pair(sum))
          n[i] = RidgeSums::other(sum, cells_.store.code(f.made, i));
        else if (n[i] == no_index)
          join(f, i);
      }
    }
  }
  static std::uint64_t hash_of(std::uint32_t v) {
    const std::uint64_t x = (std::uint64_t{v} + 1) * XorShift::golden;
    return (x ^ x >> 29) * XorShift::golden;
  }

  void join_cells() {
    if constexpr (K >= 4 && K <= 6) {
      if (facets_.size() * K < RidgeSums::max_entries) return join_by_sums();
    }
    for (const Facet& f : facets_) {
      const std::uint32_t* n = cells_.store.neighbours(f.made);
      for (unsigned i = 0; i < corners(); ++i)
        if (n[i] == no_index) join(f, i);
    }
  }

  // The walk turns about the ridge inside the cavity: each cell of the cavity that has the ridge
  // has two facets at it; it enters by one and leaves by the other. The cavity is bounded, so the
  // walk ends at a facet of its boundary, whose new cell is the partner.

  /// Links the new cell of f across its facet i: walks around the ridge of f without corner i, from
  /// cell to cell of the cavity, to the other facet of the boundary at this ridge.
  void join(const Facet& f, unsigned i) {
    std::uint32_t c = f.cell;
    unsigned cross = i, pivot = f.slot;  // slots of c: the facet ahead, the corner behind it
    for (;;) {
      const std::uint32_t code = cells_.store.neighbours(c)[cross],
                          next = cells_.store.cell_of(code);
      if (!inside(next)) {
        cells_.store.link(f.made, i, cells_.store.code(next, pivot));
        return;
      }
      const std::uint32_t corner = cells_.store.vertices(c)[pivot];
      pivot = cells_.store.slot_of(code);
      cross = cells_.store.index_of_present(cells_.store.vertices(next), corner);
      c = next;
    }
  }

  static constexpr std::uint32_t most_labels = 64, label_bits = 10, label_places = 1U << label_bits;
  static constexpr bool with_planes = K >= 3 && K <= 6;

  const LiftedPoints& s_;
  const Run& run_;
  std::conditional_t<shared, GrowingCells<K>&, GrowingCells<K>> cells_;
  PointSigns<K> signs_;
  std::conditional_t<with_planes, CellPlanes<K>, NoPlanes> planes_;
  LiftCounts counts_;
  std::uint64_t by_plane_ = 0, by_lanes_ = 0, steps_ = 0, work_ = 0;
  std::uint32_t last_ = 0, in_ = 0;
  std::vector<std::uint32_t> room_of_cells_, undecided_;
  std::vector<Facet> room_of_facets_;
  std::span<const std::uint32_t> cavity_;
  std::span<Facet> facets_;
  // labels_: the vertices that have labels, by hash. edges_: for the two labels of a directed edge,
  // the code of the new cell's facet there. labelled_: for each label, the vertex. corners_: for
  // each facet, its labels.
  std::vector<Label> labels_;
  std::vector<std::uint32_t> labelled_;
  RawArray<std::uint32_t> edges_;
  std::vector<std::array<std::uint32_t, 3>> corners_;
  std::vector<std::uint64_t> sums_;
  std::vector<std::uint32_t> places_;
  std::uint32_t label_base_ = 0;
  // If shared: the cells this thread holds, its unused cells, and how many cells it created.
  std::vector<std::uint32_t> held_, spare_;
  std::uint64_t created_ = 0;
  XorShift random_{XorShift::golden};
};

}  // namespace cullhull::internal
