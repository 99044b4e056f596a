// Incremental construction by cavities (Bowyer 1981; Watson 1981) with one vertex at infinity, in
// any dimension. The cells a point is in conflict with are replaced by those that join the point to
// the cavity's boundary; new cells find one another by walking around ridges within the cavity.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "geometry/orientation.hpp"
#include "lifting/cell_planes.hpp"
#include "lifting/cell_store.hpp"
#include "lifting/lift_side.hpp"
#include "lifting/lifted_points.hpp"
#include "lifting/point_signs.hpp"
#include "parallel/run.hpp"

namespace cullhull::internal {

/// K: the dimension of the points' flat where it is known early, else 0.
template <unsigned K>
class CellInsertion {
 public:
  CellInsertion(const LiftedPoints& points, const Run& run)
      : s_(points), run_(run), store_(points.base, run.budget), signs_(points), planes_(points) {
    if constexpr (K == 3) {
      labels_.resize(points.count, 0);
      edges_.assign(std::size_t{most_labels} * most_labels, unset);
    }
  }

  CellStore<K>& store() { return store_; }
  const LiftCounts& counts() {
    counts_ = signs_.counts();
    counts_.rungs[0] += by_plane_;
    return counts_;
  }

  /// k + 1 affinely independent points; about how many there will be.
  void start(const std::uint32_t* simplex, std::uint32_t expected) {
    std::vector<std::uint32_t> v(simplex, simplex + corners());
    if (signs_.orientation(v.data()) == Sign::negative) std::swap(v[k() - 1], v[k()]);
    store_.start(v.data(), expected);
    if constexpr (with_planes) {
      planes_.set_room(store_.capacity());
      for (std::uint32_t c = 0; planes_.used() && c < store_.count(); ++c) planes_.set_none(c);
    }
    last_ = 0;
  }

  /// False if the point is hidden by those that are there.
  bool insert(std::uint32_t p) {
    signs_.aim(p);
    const std::uint32_t first = locate();
    if (s_.may_hide && !conflict(first)) return false;
    find_cavity(first);
    make_cells(p);
    bool joined = false;
    if constexpr (K == 3) joined = join_along_edges();
    if (!joined) join_cells();
    for (const std::uint32_t c : cavity_) store_.free_cell(c);
    work_ += facets_.size();
    if (work_ > 4096) {  // well below a millisecond in any dimension
      work_ = 0;
      run_.check();
    }
    return true;
  }

 private:
  struct Facet {
    std::uint32_t cell, slot, made;
  };

  unsigned k() const { return store_.corners() - 1; }
  unsigned corners() const { return store_.corners(); }

  /// Towards p through facets that p is beyond: in a regular triangulation, which this is under the
  /// perturbation, no cell is met twice.
  std::uint32_t locate() {
    std::uint32_t c = last_;
    if (const unsigned g = store_.ghost_slot(c); g < corners())
      c = store_.cell_of(store_.neighbours(c)[g]);
    unsigned from = corners();
    for (;;) {
      const unsigned j = signs_.beyond(store_.vertices(c), from);
      if (j == corners()) return c;
      const std::uint32_t code = store_.neighbours(c)[j];
      c = store_.cell_of(code);
      from = store_.slot_of(code);
      if (store_.vertices(c)[from] == infinite) return c;
      if ((++steps_ & 4095) == 0) run_.check();
    }
  }

  bool conflict(std::uint32_t c) {
    if constexpr (with_planes) {
      if (planes_.used() && planes_.known(c)) {
        const Sign side = planes_.side(c, signs_.point());
        if (side != Sign::zero) {
          ++by_plane_;
          return side == Sign::negative;
        }
      }
    }
    const unsigned g = store_.ghost_slot(c);
    if (g < corners()) {
      const Sign beyond = signs_.replaced(store_.vertices(c), g);
      if (beyond != Sign::zero) return beyond == Sign::positive;
      c = store_.cell_of(store_.neighbours(c)[g]);
    }
    return signs_.conflict(store_.vertices(c));
  }

  void find_cavity(std::uint32_t first) {
    in_ = store_.next_stamp();
    const std::uint32_t out = in_ + 1;
    cavity_.clear();
    facets_.clear();
    cavity_.push_back(first);
    store_.mark(first) = in_;
    for (std::size_t i = 0; i < cavity_.size(); ++i) {
      const std::uint32_t c = cavity_[i];
      const std::uint32_t* n = store_.neighbours(c);
      for (unsigned j = 0; j < corners(); ++j) {
        const std::uint32_t o = store_.cell_of(n[j]);
        std::uint32_t& mark = store_.mark(o);
        if (mark == in_) continue;
        if (mark != out) {
          if (conflict(o)) {
            mark = in_;
            cavity_.push_back(o);
            continue;
          }
          mark = out;
        }
        facets_.push_back({c, j, unset});
      }
    }
  }

  /// A facet's cell with the corner off the facet replaced by p is the new one there: it has the
  /// same orientation. Then the cell in the cavity knows the new one as its neighbour.
  void make_cells(std::uint32_t p) {
    last_ = unset;
    for (Facet& f : facets_) {
      const std::uint32_t made = store_.new_cell();
      f.made = made;
      const std::uint32_t *old = store_.vertices(f.cell),
                          outside = store_.neighbours(f.cell)[f.slot];
      std::uint32_t *v = store_.vertices(made), *n = store_.neighbours(made);
      bool finite = true;
      for (unsigned i = 0; i < corners(); ++i) {
        v[i] = i == f.slot ? p : old[i];
        n[i] = unset;
        finite = finite && v[i] != infinite;
      }
      store_.link(made, f.slot, outside);
      store_.neighbours(f.cell)[f.slot] = store_.code(made, f.slot);
      if (finite) last_ = made;
      if constexpr (with_planes) {
        if (!planes_.used()) continue;
        planes_.set_room(store_.capacity());
        if (finite)
          planes_.add(made, v, f.slot, p);
        else
          planes_.set_none(made);
      }
    }
    if constexpr (with_planes) planes_.flush(p);
    if (last_ == unset) last_ = facets_.front().made;
  }

  /// Labels of the vertices of a cavity's boundary begin anew.
  void clear_labels() {
    if (label_base_ > ~std::uint32_t{0} - 4 * most_labels) {
      std::fill(labels_.begin(), labels_.end(), 0U);
      label_base_ = 0;
    }
    label_base_ += most_labels;
    label_count_ = 0;
    at_infinity_ = unset;
  }
  std::uint32_t label(std::uint32_t v) {
    if (v == infinite) return at_infinity_ != unset ? at_infinity_ : at_infinity_ = label_count_++;
    const std::uint32_t known = labels_[v] - label_base_;
    if (known < most_labels) return known;
    labels_[v] = label_base_ + label_count_;
    return label_count_++;
  }

  /// In space new cells meet in edges of the cavity's boundary, twice in each: a small table has
  /// those met once. False, with nothing done, where the boundary has too many vertices for it.
  bool join_along_edges() {
    if (facets_.size() > 2 * most_labels - 4) return false;  // Euler's formula
    clear_labels();
    for (const Facet& f : facets_) {
      const std::uint32_t* v = store_.vertices(f.made);
      std::uint32_t corner[4];
      for (unsigned i = 0; i < 4; ++i) corner[i] = i == f.slot ? 0 : label(v[i]);
      for (unsigned i = 0; i < 4; ++i) {
        if (i == f.slot) continue;
        // The edge has the two slots that are neither i nor the point's.
        std::uint32_t a = unset, b = 0;
        for (unsigned j = 0; j < 4; ++j) {
          if (j == i || j == f.slot) continue;
          if (a == unset)
            a = corner[j];
          else
            b = corner[j];
        }
        std::uint32_t& met = edges_[a < b ? a * most_labels + b : b * most_labels + a];
        if (met == unset) {
          met = store_.code(f.made, i);
        } else {
          store_.link(f.made, i, met);
          met = unset;
        }
      }
    }
    return true;
  }

  void join_cells() {
    for (const Facet& f : facets_) {
      const std::uint32_t* n = store_.neighbours(f.made);
      for (unsigned i = 0; i < corners(); ++i)
        if (n[i] == unset) join(f, i);
    }
  }

  /// Around the ridge without corner i of the facet, from cell to cell of the cavity to the other
  /// facet of the boundary that it has.
  void join(const Facet& f, unsigned i) {
    std::uint32_t c = f.cell;
    unsigned cross = i, pivot = f.slot;  // slots of c: the facet ahead, the corner behind it
    for (;;) {
      const std::uint32_t code = store_.neighbours(c)[cross], next = store_.cell_of(code);
      if (store_.mark(next) != in_) {
        store_.link(f.made, i, store_.code(next, pivot));
        return;
      }
      const std::uint32_t corner = store_.vertices(c)[pivot];
      pivot = store_.slot_of(code);
      cross = store_.find(store_.vertices(next), corner);
      c = next;
    }
  }

  static constexpr std::uint32_t most_labels = 64;
  static constexpr bool with_planes = K >= 4 && K <= 6;

  const LiftedPoints& s_;
  const Run& run_;
  CellStore<K> store_;
  PointSigns<K> signs_;
  std::conditional_t<with_planes, CellPlanes<K>, NoPlanes> planes_;
  LiftCounts counts_;
  std::uint64_t by_plane_ = 0, steps_ = 0, work_ = 0;
  std::uint32_t last_ = 0, in_ = 0;
  std::vector<std::uint32_t> cavity_;
  std::vector<Facet> facets_;
  // A label of each vertex of a boundary, from label_base_ on; edges met once, by labels.
  std::vector<std::uint32_t> labels_, edges_;
  std::uint32_t label_base_ = 0, label_count_ = 0, at_infinity_ = unset;
};

}  // namespace cullhull::internal
