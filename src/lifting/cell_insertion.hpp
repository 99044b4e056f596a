// Incremental construction by cavities (Bowyer 1981; Watson 1981) with one vertex at infinity, in
// any dimension. The cells a point is in conflict with are replaced by those that join the point to
// the cavity's boundary; new cells find one another by walking around ridges within the cavity.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/orientation.hpp"
#include "lifting/lift_side.hpp"
#include "lifting/lifted_points.hpp"
#include "parallel/raw_array.hpp"
#include "parallel/run.hpp"

namespace cullhull::internal {

/// The vertex at infinity, and no cell yet.
inline constexpr std::uint32_t infinite = 0xffffffff, unset = 0xffffffff;

/// K: the dimension of the points' flat where it is known early, else 0.
template <unsigned K>
class CellInsertion {
 public:
  CellInsertion(const LiftedPoints& points, const Run& run)
      : s_(points), run_(run), k_(points.base), at_(points.base + 2), probe_(points.base + 2) {}

  unsigned k() const { return K ? K : k_; }
  unsigned corners() const { return k() + 1; }
  /// Cells [0, cell_count()), dead ones among them.
  std::uint32_t cell_count() const { return cells_; }
  bool dead(std::uint32_t c) const { return marks_[c] == dead_mark; }
  std::uint32_t* vertices(std::uint32_t c) { return data_.data() + std::size_t{c} * 2 * corners(); }
  std::uint32_t* neighbours(std::uint32_t c) { return vertices(c) + corners(); }
  bool ghost(std::uint32_t c) { return ghost_slot(c) < corners(); }
  const LiftCounts& counts() const { return counts_; }
  std::uint64_t cells_created() const { return created_; }

  /// k + 1 affinely independent points.
  void start(const std::uint32_t* simplex) {
    std::vector<std::uint32_t> v(simplex, simplex + corners());
    for (unsigned i = 0; i < corners(); ++i) at_[i] = s_.row(v[i]);
    if (base_orientation<K>(s_, at_.data()) == Sign::negative) std::swap(v[k() - 1], v[k()]);
    const std::uint32_t finite = new_cell();
    std::copy(v.begin(), v.end(), vertices(finite));
    // The ghost across slot j has infinity there.
    for (unsigned j = 0; j < corners(); ++j) {
      const std::uint32_t c = new_cell();
      std::copy(v.begin(), v.end(), vertices(c));
      vertices(c)[j] = infinite;
    }
    for (unsigned j = 0; j < corners(); ++j) {
      neighbours(finite)[j] = 1 + j;
      for (unsigned i = 0; i < corners(); ++i) neighbours(1 + j)[i] = i == j ? finite : 1 + i;
    }
    // A point beyond facet j in the place of v_j turns the cell round: so does an exchange.
    for (std::uint32_t c = 1; c <= corners(); ++c) {
      std::swap(vertices(c)[0], vertices(c)[1]);
      std::swap(neighbours(c)[0], neighbours(c)[1]);
    }
    last_ = finite;
  }

  /// False if the point is hidden by those that are there.
  bool insert(std::uint32_t p) {
    const std::uint32_t first = locate(p);
    if (s_.may_hide && !conflict(first, p)) return false;
    find_cavity(first, p);
    make_cells(p);
    join_cells();
    for (const std::uint32_t c : cavity_) {
      marks_[c] = dead_mark;
      free_.push_back(c);
    }
    if ((++inserted_ & 255) == 0) run_.check();
    return true;
  }

 private:
  static constexpr std::uint32_t dead_mark = 0xffffffff;
  struct Facet {
    std::uint32_t cell, slot, made;
  };

  unsigned ghost_slot(std::uint32_t c) { return slot_of(vertices(c), infinite); }
  unsigned slot_of(const std::uint32_t* list, std::uint32_t item) const {
    unsigned j = 0;
    while (j < corners() && list[j] != item) ++j;
    return j;
  }

  std::uint32_t new_cell() {
    ++created_;
    if (!free_.empty()) {
      const std::uint32_t c = free_.back();
      free_.pop_back();
      marks_[c] = 0;
      return c;
    }
    if (cells_ == capacity_) grow();
    marks_[cells_] = 0;
    return cells_++;
  }

  void grow() {
    const std::uint64_t wanted = capacity_ == 0 ? std::uint64_t{s_.count} * (k() == 2 ? 2 : 4) + 64
                                                : capacity_ + capacity_ / 2;
    const std::uint64_t most = std::min<std::uint64_t>(wanted, 0xfffffff0);
    if (most == capacity_)
      throw Error(ErrorCode::out_of_budget, "the triangulation has more than 2^32 cells");
    require_budget(run_.budget, most * (2 * corners() + 1) * sizeof(std::uint32_t),
                   "the triangulation");
    data_.reserve(most * 2 * corners());
    marks_.reserve(most);
    capacity_ = most;
  }

  /// Sign of the orientation of cell c with its corner j replaced by p; no other is infinite.
  Sign replaced(std::uint32_t c, unsigned j, const double* p) {
    const std::uint32_t* v = vertices(c);
    for (unsigned i = 0; i < corners(); ++i) probe_[i] = i == j ? p : s_.row(v[i]);
    return base_orientation<K>(s_, probe_.data());
  }

  /// Towards p through facets that p is beyond: in a regular triangulation, which this is under the
  /// perturbation, no cell is met twice.
  std::uint32_t locate(std::uint32_t point) {
    const double* p = s_.row(point);
    std::uint32_t c = last_, from = unset;
    if (const unsigned g = ghost_slot(c); g < corners()) c = neighbours(c)[g];
    for (;;) {
      bool moved = false;
      for (unsigned j = 0; j < corners() && !moved; ++j) {
        const std::uint32_t next = neighbours(c)[j];
        if (next == from || replaced(c, j, p) != Sign::negative) continue;
        from = c;
        c = next;
        moved = true;
      }
      if (!moved || ghost(c)) return c;
      if ((++steps_ & 4095) == 0) run_.check();
    }
  }

  bool conflict(std::uint32_t c, std::uint32_t point) {
    const double* p = s_.row(point);
    unsigned g = ghost_slot(c);
    if (g < corners()) {
      const Sign beyond = replaced(c, g, p);
      if (beyond != Sign::zero) return beyond == Sign::positive;
      c = neighbours(c)[g];
    }
    const std::uint32_t* v = vertices(c);
    for (unsigned i = 0; i < corners(); ++i) at_[i] = s_.row(v[i]);
    const Sign side = lift_side<K>(s_, at_.data(), p, counts_);
    if (side != Sign::zero) return side == Sign::negative;
    return tied_conflict(c, point);
  }

  /// docs/exactness.md, "Ties": the lift of id i is lowered by e_i, e_0 >> e_1 >> ...
  bool tied_conflict(std::uint32_t c, std::uint32_t point) {
    ++counts_.ties;
    const std::uint32_t* v = vertices(c);
    const std::uint32_t own = s_.ids[point];
    std::uint64_t next = 0;  // ids below this have been asked
    for (;;) {
      unsigned slot = corners();
      std::uint32_t lowest = own;
      for (unsigned i = 0; i < corners(); ++i) {
        const std::uint32_t id = s_.ids[v[i]];
        if (id < next || id >= lowest) continue;
        lowest = id;
        slot = i;
      }
      if (slot == corners()) return true;
      const Sign sign = replaced(c, slot, s_.row(point));
      if (sign != Sign::zero) return sign == Sign::negative;
      next = std::uint64_t{lowest} + 1;
    }
  }

  void find_cavity(std::uint32_t first, std::uint32_t p) {
    if (stamp_ > dead_mark - 8) {
      for (std::uint32_t c = 0; c < cells_; ++c)
        if (!dead(c)) marks_[c] = 0;
      stamp_ = 0;
    }
    stamp_ += 2;
    in_ = stamp_;
    const std::uint32_t out = stamp_ + 1;
    cavity_.clear();
    facets_.clear();
    cavity_.push_back(first);
    marks_[first] = in_;
    for (std::size_t i = 0; i < cavity_.size(); ++i) {
      const std::uint32_t c = cavity_[i];
      for (unsigned j = 0; j < corners(); ++j) {
        const std::uint32_t o = neighbours(c)[j];
        if (marks_[o] == in_) continue;
        if (marks_[o] != out) {
          if (conflict(o, p)) {
            marks_[o] = in_;
            cavity_.push_back(o);
            continue;
          }
          marks_[o] = out;
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
      const std::uint32_t made = new_cell(), outside = neighbours(f.cell)[f.slot];
      f.made = made;
      std::uint32_t* v = vertices(made);
      std::copy_n(vertices(f.cell), corners(), v);
      v[f.slot] = p;
      std::uint32_t* n = neighbours(made);
      std::fill_n(n, corners(), unset);
      n[f.slot] = outside;
      std::uint32_t* back = neighbours(outside);
      back[slot_of(back, f.cell)] = made;
      neighbours(f.cell)[f.slot] = made;
      if (last_ == unset && slot_of(v, infinite) == corners()) last_ = made;
    }
    if (last_ == unset) last_ = facets_.front().made;
  }

  void join_cells() {
    for (const Facet& f : facets_)
      for (unsigned i = 0; i < corners(); ++i)
        if (i != f.slot && neighbours(f.made)[i] == unset) join(f, i);
  }

  /// Around the ridge without corner i of the facet, from cell to cell of the cavity to the other
  /// facet of the boundary that it has.
  void join(const Facet& f, unsigned i) {
    std::uint32_t c = f.cell, pivot = vertices(c)[f.slot];
    unsigned cross = i;
    for (;;) {
      const std::uint32_t next = neighbours(c)[cross];
      if (marks_[next] != in_) {
        neighbours(f.made)[i] = next;
        neighbours(next)[slot_of(vertices(c), pivot)] = f.made;
        return;
      }
      const unsigned back = slot_of(neighbours(next), c);
      cross = slot_of(vertices(next), pivot);
      pivot = vertices(next)[back];
      c = next;
    }
  }

  const LiftedPoints& s_;
  const Run& run_;
  unsigned k_;
  std::vector<const double*> at_, probe_;
  RawArray<std::uint32_t> data_;  ///< a cell: its vertices, then its neighbours
  RawArray<std::uint32_t> marks_;
  std::uint64_t capacity_ = 0, created_ = 0, steps_ = 0, inserted_ = 0;
  std::uint32_t cells_ = 0, last_ = 0, stamp_ = 0, in_ = 0;
  std::vector<std::uint32_t> free_, cavity_;
  std::vector<Facet> facets_;
  LiftCounts counts_;
};

}  // namespace cullhull::internal
