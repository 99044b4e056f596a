// What one insertion works with: the facets a point sees, their border, and a worker's scratch.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace cullhull::internal {

/// A ridge between a facet that the point sees and one that it does not.
struct HorizonRidge {
  std::uint32_t facet, outside;
  std::uint8_t apex;  ///< index in `facet` of the vertex opposite to the ridge
  std::uint8_t back;  ///< the same in `outside`
};

/// A run of the insertion order, near one another in space, and its next point's cavity.
struct Stream {
  std::uint32_t next = 0, end = 0;
  std::uint32_t hint = 0;  ///< a facet near the last point
  bool found = false;      ///< visible and horizon are those of point `next`
  bool accepted = false;
  std::vector<std::uint32_t> visible;
  std::vector<HorizonRidge> horizon;
  std::vector<std::uint32_t> extra;  ///< slots for new facets beyond those of the visible ones
};

/// Facets met in one search, and whether the point sees them. Private to a worker, so searches write
/// nothing that others read.
class Visited {
 public:
  enum State : std::uint32_t { unknown = 0, unseen = 1, seen = 2 };

  Visited() : slots_(1024) {}
  void clear() {
    used_ = 0;
    stamp_ += 4;
    if (stamp_ >= 0xFFFFFFF0) {
      slots_.assign(slots_.size(), {});
      stamp_ = 4;
    }
  }
  /// The state of f, for the caller to set.
  struct Slot {
    std::uint32_t facet = 0, state = 0;
  };
  Slot& find(std::uint32_t f) {
    if (2 * used_ >= slots_.size()) grow();
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t h = (f * 0x9E3779B1U) >> 7 & mask;; h = (h + 1) & mask) {
      Slot& s = slots_[h];
      if (s.state < stamp_) {
        ++used_;
        s = {f, stamp_};
        return s;
      }
      if (s.facet == f) return s;
    }
  }
  State state(const Slot& s) const { return static_cast<State>(s.state - stamp_); }
  void set(Slot& s, State state) const { s.state = stamp_ + state; }

 private:
  void grow() {
    std::vector<Slot> old(slots_.size() * 4);
    old.swap(slots_);
    used_ = 0;
    for (const Slot& s : old)
      if (s.state >= stamp_) find(s.facet).state = s.state;
  }
  std::vector<Slot> slots_;
  std::size_t used_ = 0;
  std::uint32_t stamp_ = 4;
};

/// A worker's own memory.
struct Lane {
  explicit Lane(unsigned d) : offset(d), rows(d + 1), simplex_rows(d + 1) {
    if (d <= 8) minors.resize(std::size_t{1} << d);
  }
  Visited visited;
  std::vector<std::uint32_t> vertices, neighbours, slots;  // of new facets
  std::vector<std::uint8_t> apex;
  std::vector<float> planes;
  std::vector<float> offset;  // the point seen from O
  std::vector<const double*> rows, simplex_rows;
  std::vector<double> minors;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> duplicates;
  std::uint64_t rung_counts[3] = {0, 0, 0};
  std::uint64_t random = 0;
};

}  // namespace cullhull::internal
