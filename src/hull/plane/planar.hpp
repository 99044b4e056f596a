// Points of the plane in the 2D engine: entries to sort, the exact turn of three, and blocks of
// coordinates read from the caller's memory.
#pragma once

#include <cmath>
#include <cstdint>

#include "cullhull/point_view.hpp"
#include "exact/orientation/orientation.hpp"
#include "geometry/gather.hpp"

namespace cullhull::internal {

/// A point with its exact coordinates, its row in the source, and a key that is monotone in x.
struct Entry {
  double x, y;
  std::uint32_t row, key;
};

/// Lexicographic order; of equal points the lowest row comes first.
inline bool before(const Entry& a, const Entry& b) {
  return a.x < b.x || (a.x == b.x && (a.y < b.y || (a.y == b.y && a.row < b.row)));
}
inline bool equal(const Entry& a, const Entry& b) { return a.x == b.x && a.y == b.y; }

/// Error bound of (a.x - c.x)(b.y - c.y) - (a.y - c.y)(b.x - c.x), as a factor of the sum of its
/// two products' magnitudes. With u = 2^-53 the differences and products are off by the factor (1 +
/// u)^3 at most, the last subtraction and the evaluation of the bound itself by 1 + u each: (3 +
/// 16u) u (|l| + |r|) covers them (Shewchuk 1997, ccwerrboundA); the doubled second term covers the
/// sum with `turn_tiny`. A product may underflow by 2^-1075, far less than `turn_tiny`. Any finite
/// coordinates are allowed: an overflow makes the bound infinite or the determinant a NaN, and then
/// the sign is decided exactly.
inline constexpr double turn_bound = (3 + 32 * 0x1p-53) * 0x1p-53, turn_tiny = 0x1p-1060;

/// Sign of the turn a, b, c: by the filter in doubles, else exactly.
class Turn {
 public:
  /// `lattice`: doubles compute the determinant without rounding.
  explicit Turn(bool lattice = false) : lattice_(lattice) {}

  int operator()(const Entry& a, const Entry& b, const Entry& c) {
    const double l = (a.x - c.x) * (b.y - c.y);
    const double r = (a.y - c.y) * (b.x - c.x);
    const double det = l - r;
    const double error = turn_bound * (std::fabs(l) + std::fabs(r)) + turn_tiny;
    if (det > error) return decided(1);
    if (-det > error) return decided(-1);
    if (lattice_) return decided(det > 0 ? 1 : det < 0 ? -1 : 0);
    counts_.count(Rung::exact);
    return static_cast<int>(turn_exact(&a.x, &b.x, &c.x));
  }

  const RungCounts& counts() const { return counts_; }
  void restart() { counts_ = {}; }
  void add_counts(const Turn& other) { counts_ += other.counts_; }

 private:
  int decided(int sign) {
    counts_.count(Rung::filter);
    return sign;
  }

  bool lattice_;
  RungCounts counts_;
};

/// Rows of a view of dimension 2, as packed doubles.
class PlanarSource {
 public:
  /// Rows that are read at once: 16 KB, which fit L1.
  static constexpr std::uint32_t block = 1024;

  explicit PlanarSource(const PointView& view) : view_(view), packed_(packed_doubles(view)) {}

  const PointView& view() const { return view_; }
  std::uint32_t count() const { return static_cast<std::uint32_t>(view_.count); }

  /// Rows [begin, end), at most `block` of them: in place where they are packed doubles, else
  /// copied to `room`.
  const double* rows(std::uint64_t begin, std::uint64_t end, double* room) const {
    if (packed_ != nullptr) return packed_ + 2 * begin;
    load_rows(view_, begin, end, room);
    return room;
  }
  Entry entry(std::uint32_t row) const {
    double room[2];
    const double* p = rows(row, row + std::uint64_t{1}, room);
    return {p[0], p[1], row, 0};
  }

 private:
  PointView view_;
  const double* packed_;
};

}  // namespace cullhull::internal
