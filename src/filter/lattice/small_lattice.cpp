#include "filter/lattice/small_lattice.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

#include "filter/lattice/whole_range.hpp"
#include "filter/ways.hpp"
#include "geometry/gather.hpp"
#include "parallel/threads/thread_memory.hpp"

namespace cullhull::internal {
namespace {

constexpr double places_per_point = 10, most_places = 1U << 18;

class SmallLattice {
 public:
  bool find(const PointView& points) {
    constexpr std::uint64_t first = 16;  // points that show that most sets are no lattice
    if (!measure(points, first) || !measure(points, points.count)) return false;
    note(points);
    mark_ends();
    return true;
  }
  const std::vector<std::uint64_t>& ids() const { return ids_; }

 private:
  /// Whether the first `count` points are on a lattice that is small for all of them and has at
  /// most 64 places along each axis.
  bool measure(const PointView& points, std::uint64_t count) {
    const WholeRange range = whole_range(points, count);
    if (!range.finite) return false;
    double places = 1;
    for (unsigned a = 0; a < 3; ++a) {
      low_[a] = range.low[a];
      const double size = range.high[a] - range.low[a] + 1;
      if (!range.whole[a] || size > 64) return false;
      size_[a] = static_cast<std::uint32_t>(size);
      places *= size;
    }
    return places <= std::min(places_per_point * static_cast<double>(points.count), most_places);
  }

  /// Sets for each place of the lattice the first point there, and for each line along the third
  /// axis a bit for each place that has a point.
  void note(const PointView& points) {
    const std::size_t lines = std::size_t{size_[0]} * size_[1];
    first_.resize(lines * size_[2]);
    lines_.assign(lines, 0);
    const auto number = [&](const double* row, unsigned a) {
      return static_cast<std::uint32_t>(static_cast<std::int32_t>(row[a] - low_[a]));
    };
    const auto note_row = [&](const double* row, std::uint64_t i) {
      const std::size_t line = std::size_t{number(row, 0)} * size_[1] + number(row, 1);
      const std::uint32_t z = number(row, 2);
      first_[line * size_[2] + z] = static_cast<std::uint32_t>(i);
      lines_[line] |= std::uint64_t{1} << z;
    };
    // Backwards: the first point is stored last.
    const std::uint64_t n = points.count;
    if (const double* const rows = packed_doubles(points)) {
      for (std::uint64_t i = n; i-- > 0;) note_row(rows + 3 * i, i);
      return;
    }
    PointView from_last = points;
    from_last.data = points.address(n - 1, 0);
    from_last.point_stride = -points.point_stride;
    for_row_blocks(from_last, n, [&](std::uint64_t first, const double* rows, std::uint32_t count) {
      for (std::uint32_t k = 0; k < count; ++k)
        note_row(rows + 3 * std::size_t{k}, n - 1 - first - k);
    });
  }

  /// Sets inner_ to the places between two others on one line along an axis, given that consecutive
  /// lines along it are `step` apart.
  void add_inner(std::size_t begin, std::size_t step, std::uint32_t size) {
    std::array<std::uint64_t, 64> before;  // places that an earlier line has
    std::uint64_t seen = 0;
    for (std::uint32_t i = 0; i < size; ++i) {
      before[i] = seen;
      seen |= lines_[begin + i * step];
    }
    seen = 0;
    for (std::uint32_t i = size; i-- > 0;) {
      inner_[begin + i * step] |= before[i] & seen;
      seen |= lines_[begin + i * step];
    }
  }

  void mark_ends() {
    inner_.assign(lines_.size(), 0);
    for (std::uint32_t x = 0; x < size_[0]; ++x) add_inner(std::size_t{x} * size_[1], 1, size_[1]);
    for (std::uint32_t y = 0; y < size_[1]; ++y) add_inner(y, size_[1], size_[0]);
    ids_.clear();
    for (std::size_t line = 0; line < lines_.size(); ++line) {
      const std::uint64_t all = lines_[line];
      if (all == 0) continue;
      const std::uint64_t ends = std::bit_floor(all) | (all & (~all + 1));
      for (std::uint64_t left = ends & ~inner_[line]; left != 0; left &= left - 1)
        ids_.push_back(first_[line * size_[2] + static_cast<unsigned>(std::countr_zero(left))]);
    }
    std::sort(ids_.begin(), ids_.end());
  }

  double low_[3] = {};
  std::uint32_t size_[3] = {};
  std::vector<std::uint32_t> first_;
  std::vector<std::uint64_t> lines_, inner_, ids_;
};

}  // namespace

bool ends_in_small_lattice(const PointView& points, const std::vector<std::uint64_t>*& ids) {
  if (!takes(Way::small_lattice, {.dimension = points.dimension, .count = points.count}))
    return false;
  SmallLattice& lattice = thread_memory<SmallLattice>();
  if (!lattice.find(points)) return false;
  ids = &lattice.ids();
  return true;
}

}  // namespace cullhull::internal
