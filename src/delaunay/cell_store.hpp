// The cells of a growing triangulation: for each its vertices, its neighbours and a mark.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "cullhull/error.hpp"
#include "delaunay/memory_needs.hpp"
#include "parallel/index.hpp"
#include "parallel/memory/memory.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/prefetch.hpp"

namespace cullhull::internal {

/// The vertex at infinity.
inline constexpr std::uint32_t infinite = 0xffffffff;

/// Vertices, neighbours and marks of numbered cells. K: the dimension if it is a compile-time
/// constant, otherwise 0. A neighbour reference packs the neighbour's index and the slot in which
/// the neighbour refers back to this cell into one 32-bit code; see code().
template <unsigned K>
class CellStore {
 public:
  /// `budget`: bytes for the cells and for all that is made of them (bytes_per_cell).
  CellStore(unsigned k, std::uint64_t budget)
      : k_(k), shift_(static_cast<unsigned>(std::bit_width(k))), budget_(budget) {}

  unsigned corners() const { return (K ? K : k_) + 1; }
  /// Cells are numbered [0, count()); deleted (dead) cells keep their numbers.
  std::uint32_t count() const { return count_; }
  /// The largest number of cells: a code has 32 bits, and the slot takes a few of them.
  std::uint64_t limit() const { return (std::uint64_t{1} << (32 - shift())) - 1; }
  std::uint64_t capacity() const { return capacity_; }
  std::uint64_t created() const { return created_; }
  bool dead(std::uint32_t c) const { return marks_[c] == dead_mark; }
  std::uint32_t* vertices(std::uint32_t c) { return data_.data() + std::size_t{c} * 2 * corners(); }
  std::uint32_t* neighbours(std::uint32_t c) { return vertices(c) + corners(); }
  std::uint32_t& mark(std::uint32_t c) { return marks_[c]; }
  void prefetch_mark(std::uint32_t c) const { prefetch_line(marks_.data() + c); }

  // Example in space: shift() is 2, so the code 4 * 17 + 3 = 71 refers to slot 3 of cell 17. If
  // slot j of cell c has that code, slot 3 of cell 17 has the code 4 * c + j: both cells lack each
  // other's opposite corner and share the rest.
  std::uint32_t code(std::uint32_t cell, unsigned slot) const { return cell << shift() | slot; }
  std::uint32_t cell_of(std::uint32_t code) const { return code >> shift(); }
  unsigned slot_of(std::uint32_t code) const { return code & ((1U << shift()) - 1); }
  /// The slot of `item` in a list of corners() entries; corners() if it is absent.
  unsigned find(const std::uint32_t* list, std::uint32_t item) const {
    unsigned j = 0;
    while (j < corners() && list[j] != item) ++j;
    return j;
  }
  /// As find(), for an item that is present. Branch-free, because the slot is unpredictable.
  unsigned index_of_present(const std::uint32_t* list, std::uint32_t item) const {
    unsigned found = 0;
    for (unsigned j = 1; j < corners(); ++j) found |= list[j] == item ? j : 0;
    return found;
  }
  /// The slot of the infinite vertex of a ghost cell; corners() if the cell is finite.
  unsigned ghost_slot(std::uint32_t c) { return find(vertices(c), infinite); }

  /// Links facet `slot` of cell c and the facet with the code `other` in both directions.
  void link(std::uint32_t c, unsigned slot, std::uint32_t other) {
    neighbours(c)[slot] = other;
    neighbours(cell_of(other))[slot_of(other)] = code(c, slot);
  }

  /// Empties the store and keeps its memory. Creates one positively oriented cell with vertices `v`
  /// and its ghosts, the cells that join its facets to the infinite vertex. `points`: the expected
  /// number of points, which sizes the first allocation.
  void start(const std::uint32_t* v, std::uint32_t points) {
    expected_ = points;
    count_ = stamp_ = 0;
    created_ = 0;
    free_.clear();
    for (unsigned c = 0; c <= corners(); ++c) new_cell();
    make_simplex(v, 0);
  }
  /// Makes the cells [first, first + corners()] one positively oriented cell and its ghosts.
  void make_simplex(const std::uint32_t* v, std::uint32_t first) {
    // Replacing v_j by a point beyond facet j reverses the orientation of the cell. Swapping the
    // first two corners of each ghost restores it. `at`: the slot of corner j after that swap.
    const auto at = [](unsigned j) { return j < 2 ? 1 - j : j; };
    const auto ghost = [&](unsigned j) { return first + 1 + j; };
    marks_[first] = 0;
    std::copy_n(v, corners(), vertices(first));
    for (unsigned j = 0; j < corners(); ++j) {
      marks_[ghost(j)] = 0;
      std::uint32_t* const own = vertices(ghost(j));
      std::copy_n(v, corners(), own);
      own[j] = infinite;
      std::swap(own[0], own[1]);
      link(first, j, code(ghost(j), at(j)));
      for (unsigned i = 0; i < j; ++i) link(ghost(j), at(i), code(ghost(i), at(j)));
    }
  }

  /// Returns a live cell, uninitialised but for its mark 0; reuses dead cells first.
  std::uint32_t new_cell() {
    ++created_;
    if (!free_.empty()) {
      const std::uint32_t c = free_.back();
      free_.pop_back();
      marks_[c] = 0;
      return c;
    }
    if (count_ == capacity_) grow();
    marks_[count_] = 0;
    return count_++;
  }
  void free_cell(std::uint32_t c) {
    marks_[c] = dead_mark;
    free_.push_back(c);
  }

  // Why all memory is allocated before threads start: growing the arrays would move cells that
  // others read. Threads that run out of cells put their points off until the next round.

  /// Allocates cells for several threads, which take unused ones from count() on: `cells` of them
  /// in all, or as many as the budget and limit() allow. Returns how many.
  std::uint64_t reserve_up_to(std::uint64_t cells) {
    const std::uint64_t most =
        std::max<std::uint64_t>(std::min({cells, limit(), affordable()}), count_);
    if (most > capacity_) reserve(most);
    return most;
  }
  /// Marks live cells 0.
  void clear_marks() {
    for (std::uint32_t c = 0; c < count_; ++c)
      if (!dead(c)) marks_[c] = 0;
  }
  /// Cells [0, count) have been taken.
  void unshare(std::uint64_t count) { count_ = static_cast<std::uint32_t>(count); }
  /// Returns a thread's dead cells to the store and counts the cells that the thread created.
  void give_back(const std::vector<std::uint32_t>& cells, std::uint64_t created) {
    free_.insert(free_.end(), cells.begin(), cells.end());
    created_ += created;
  }
  /// The number of live cells.
  std::uint32_t living() const { return count_ - static_cast<std::uint32_t>(free_.size()); }

  static constexpr std::uint32_t dead_mark = 0xffffffff;

  /// Sets the number of cells to `count`, all of them live. New cells are uninitialised.
  void resize(std::uint64_t count) {
    require_cells(count);
    if (count > limit()) too_many();
    if (count > capacity_) reserve(count);
    count_ = static_cast<std::uint32_t>(count);
  }

  /// Returns a stamp such that no cell is marked with it or with stamp + 1.
  std::uint32_t next_stamp() {
    if (stamp_ > dead_mark - 8) {
      clear_marks();
      stamp_ = 0;
    }
    return stamp_ += 2;
  }

 private:
  unsigned shift() const { return K ? static_cast<unsigned>(std::bit_width(K)) : shift_; }

  /// The number of cells that the budget allows.
  std::uint64_t affordable() const { return budget_ / bytes_per_cell(corners() - 1); }
  void require_cells(std::uint64_t cells) const {
    require_budget(budget_, cells * bytes_per_cell(corners() - 1),
                   "the cells of the triangulation");
  }

  [[noreturn]] static void too_many() {
    throw Error(ErrorCode::out_of_budget, "the triangulation has too many cells for their numbers");
  }

  void grow() {
    const unsigned cells_a_point = corners() == 2 ? 1 : corners() == 3 ? 2 : 7;
    const std::uint64_t wanted =
        capacity_ == 0 ? std::uint64_t{expected_} * cells_a_point + 16 : capacity_ + capacity_ / 2;
    if (capacity_ == limit()) too_many();
    // Unused cells take no memory, but more cells than the budget allows must not be used.
    const std::uint64_t most = std::min({wanted, limit(), affordable()});
    if (most <= capacity_) require_cells(capacity_ + 1);
    reserve(most);
  }
  void reserve(std::uint64_t cells) {
    data_.reserve(cells * 2 * corners());
    marks_.reserve(cells);
    capacity_ = cells;
  }

  unsigned k_, shift_;
  std::uint64_t budget_, capacity_ = 0, created_ = 0;
  std::uint32_t count_ = 0, expected_ = 0, stamp_ = 0;
  RawArray<std::uint32_t> data_;  ///< for each cell its vertices, then its neighbour codes
  RawArray<std::uint32_t> marks_;
  std::vector<std::uint32_t> free_;
};

}  // namespace cullhull::internal
