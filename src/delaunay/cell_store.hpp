// Cells of a triangulation while it grows: corners, neighbours, marks.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "cullhull/error.hpp"
#include "parallel/memory/memory.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/prefetch.hpp"

namespace cullhull::internal {

/// The vertex at infinity, and no cell yet.
inline constexpr std::uint32_t infinite = 0xffffffff, unset = 0xffffffff;

/// K: the dimension where it is known early, else 0. A neighbour is told as its number and the slot
/// that it has the cell in, in one word.
template <unsigned K>
class CellStore {
 public:
  CellStore(unsigned k, std::uint64_t budget)
      : k_(k), shift_(static_cast<unsigned>(std::bit_width(k))), budget_(budget) {}

  unsigned corners() const { return (K ? K : k_) + 1; }
  /// Cells [0, count()), dead ones among them.
  std::uint32_t count() const { return count_; }
  /// Cells that can be told apart, as a neighbour's slot takes a few bits of its word.
  std::uint64_t limit() const { return (std::uint64_t{1} << (32 - shift())) - 1; }
  std::uint64_t capacity() const { return capacity_; }
  std::uint64_t created() const { return created_; }
  bool dead(std::uint32_t c) const { return marks_[c] == dead_mark; }
  std::uint32_t* vertices(std::uint32_t c) { return data_.data() + std::size_t{c} * 2 * corners(); }
  std::uint32_t* neighbours(std::uint32_t c) { return vertices(c) + corners(); }
  std::uint32_t& mark(std::uint32_t c) { return marks_[c]; }
  void prefetch_mark(std::uint32_t c) const { prefetch_line(marks_.data() + c); }

  std::uint32_t code(std::uint32_t cell, unsigned slot) const { return cell << shift() | slot; }
  std::uint32_t cell_of(std::uint32_t code) const { return code >> shift(); }
  unsigned slot_of(std::uint32_t code) const { return code & ((1U << shift()) - 1); }
  unsigned find(const std::uint32_t* list, std::uint32_t item) const {
    unsigned j = 0;
    while (j < corners() && list[j] != item) ++j;
    return j;
  }
  /// Where it is known to be one: which it is is unpredictable, so there is no branch.
  unsigned find_known(const std::uint32_t* list, std::uint32_t item) const {
    unsigned found = 0;
    for (unsigned j = 1; j < corners(); ++j) found |= list[j] == item ? j : 0;
    return found;
  }
  /// corners() where the cell is finite.
  unsigned ghost_slot(std::uint32_t c) { return find(vertices(c), infinite); }

  void link(std::uint32_t c, unsigned slot, std::uint32_t other) {
    neighbours(c)[slot] = other;
    neighbours(cell_of(other))[slot_of(other)] = code(c, slot);
  }

  /// One positive cell and its ghosts; room for what `points` will need.
  void start(const std::uint32_t* v, std::uint32_t points) {
    expected_ = points;
    for (unsigned c = 0; c <= corners(); ++c) {
      new_cell();
      std::copy_n(v, corners(), vertices(c));
      if (c > 0) vertices(c)[c - 1] = infinite;
    }
    // A point beyond facet j in the place of v_j turns the cell round: so does an exchange of two
    // corners of the ghost. `at`: where its corner j then is.
    const auto at = [](unsigned j) { return j < 2 ? 1 - j : j; };
    for (unsigned c = 1; c <= corners(); ++c) std::swap(vertices(c)[0], vertices(c)[1]);
    for (unsigned j = 0; j < corners(); ++j) {
      link(0, j, code(1 + j, at(j)));
      for (unsigned i = 0; i < j; ++i) link(1 + j, at(i), code(1 + i, at(j)));
    }
  }

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
  /// Cells that were changed into new ones.
  void count_reused(std::uint64_t cells) { created_ += cells; }
  void free_cell(std::uint32_t c) {
    marks_[c] = dead_mark;
    free_.push_back(c);
  }

  /// For several threads that take cells from count() on: of `capacity`, or as many as the budget
  /// allows, those that do not live are marked dead, the others 0.
  void share(std::uint64_t capacity) {
    const std::uint64_t most = std::min({capacity, limit(), budget_ / cell_bytes()});
    if (most > capacity_) reserve(most);
    for (std::uint32_t c = 0; c < count_; ++c)
      if (!dead(c)) marks_[c] = 0;
    std::fill(marks_.data() + count_, marks_.data() + capacity_, dead_mark);
  }
  /// After that: which cells have been taken.
  void unshare(std::uint64_t count) {
    count_ = static_cast<std::uint32_t>(std::min(count, capacity_));
  }
  /// Dead cells that a thread had, and how many it made.
  void give_back(const std::vector<std::uint32_t>& cells, std::uint64_t created) {
    free_.insert(free_.end(), cells.begin(), cells.end());
    created_ += created;
  }
  std::uint32_t living() const { return count_ - static_cast<std::uint32_t>(free_.size()); }

  static constexpr std::uint32_t dead_mark = 0xffffffff;

  /// Allocates `count` cells, uninitialised.
  void resize(std::uint32_t count) {
    expected_ = 0;
    require_budget(budget_, count * cell_bytes(), "the cells of the triangulation");
    data_.reserve(std::size_t{count} * 2 * corners());
    marks_.reserve(count);
    capacity_ = count_ = count;
  }

  /// A mark no cell has; nor has any the next greater one.
  std::uint32_t next_stamp() {
    if (stamp_ > dead_mark - 8) {
      for (std::uint32_t c = 0; c < count_; ++c)
        if (!dead(c)) marks_[c] = 0;
      stamp_ = 0;
    }
    return stamp_ += 2;
  }

 private:
  unsigned shift() const { return K ? static_cast<unsigned>(std::bit_width(K)) : shift_; }

  /// Corners, neighbours and a mark.
  std::uint64_t cell_bytes() const { return (2 * corners() + 1) * sizeof(std::uint32_t); }

  void grow() {
    const unsigned cells_a_point = corners() == 2 ? 1 : corners() == 3 ? 2 : 7;
    const std::uint64_t wanted =
        capacity_ == 0 ? std::uint64_t{expected_} * cells_a_point + 64 : capacity_ + capacity_ / 2;
    const std::uint64_t most = std::min(wanted, limit());
    if (most == capacity_)
      throw Error(ErrorCode::out_of_budget,
                  "the triangulation has too many cells for their numbers");
    reserve(most);
  }
  void reserve(std::uint64_t cells) {
    require_budget(budget_, cells * cell_bytes(), "the cells of the triangulation");
    data_.reserve(cells * 2 * corners());
    marks_.reserve(cells);
    capacity_ = cells;
  }

  unsigned k_, shift_;
  std::uint64_t budget_, capacity_ = 0, created_ = 0;
  std::uint32_t count_ = 0, expected_ = 0, stamp_ = 0;
  RawArray<std::uint32_t> data_;  ///< a cell: its corners, then its neighbours
  RawArray<std::uint32_t> marks_;
  std::vector<std::uint32_t> free_;
};

}  // namespace cullhull::internal
