// Planes of the cells of a growing triangulation, stored in an array of their own.
//
// What a plane saves: an in-sphere test in space reads four corners scattered in memory and expands
// a determinant of four rows; with the plane it reads one record and one corner, and takes a dot
// product. A cell is tested by several later insertions, so the plane is computed once for each new
// cell.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "delaunay/cell_store.hpp"
#include "delaunay/lift_planes.hpp"
#include "exact/determinants/minors.hpp"
#include "exact/insphere/lift_filter.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/points/local_points.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/prefetch.hpp"

namespace cullhull::internal {

// Example: 0.1 has the bits 0x3fb999999999999a; the upper sixteen are 0x3fb9, and 0x3fba stands for
// 0.1015625, which is at least 0.1. A bound is too large by at most 6 %, as 4 bits of the mantissa
// are left.

/// An upper bound, at least 0, in 16 bits: the upper bits of a double, rounded up.
class ShortBound {
 public:
  ShortBound() = default;
  explicit ShortBound(double least)
      : bits_(static_cast<std::uint16_t>((std::bit_cast<std::uint64_t>(least) + 0xffff'ffff'ffff) >>
                                         48)) {}
  double value() const { return std::bit_cast<double>(std::uint64_t{bits_} << 48); }

 private:
  std::uint16_t bits_;
};

/// A cell's plane. It is small, because an insertion reads about fifty of them, scattered in
/// memory.
template <unsigned K>
struct LiftedPlane {
  double normal[K + 1];
  std::uint32_t origin;
  ShortBound linear, square;  ///< the numbers a and b of lift_planes()
};
/// Indexed by cell.
template <unsigned K>
using PlaneArray = RawArray<LiftedPlane<K>>;

// Cells without a plane (ghosts) have the bound infinity, so that decides() is false for them
// without a branch of its own. Planes are relative to the corner that was inserted last, the
// nearest to the points that will be tested against the cell.

/// The planes of all cells, for 3 <= K <= 6 and points without weights that span the whole space.
template <unsigned K>
class CellPlanes {
 public:
  explicit CellPlanes(const LiftedPoints& s)
      : s_(s),
        used_(s.filtered && s.stride == s.base && !s.may_hide),
        on_sphere_(!s.powers.empty()),
        exact_bound_(on_sphere_ ? 0 : exact_plane_bound(K, s.exact_limit)) {}

  bool used() const { return used_; }
  /// To be called whenever the store may have grown or the planes may have been reallocated.
  void set_room(PlaneArray<K>& planes, std::size_t cells) {
    if (!used_) return;
    planes.reserve(cells);
    planes_ = planes.data();
  }
  /// Marks cell c, a ghost for instance, as having no plane.
  void set_none(std::uint32_t c) {
    std::fill_n(planes_[c].normal, K + 1, 0.0);  // read, though it decides nothing
    planes_[c].origin = 0;
    planes_[c].linear = ShortBound(std::numeric_limits<double>::infinity());
    planes_[c].square = ShortBound(0);
  }

  /// Sets the point p that decides() and the cells of the following calls refer to.
  void set_point(std::uint32_t p) {
    point_ = p;
    row_ = s_.row(p);
  }

  /// Adds the plane of cell c, whose corners are `v` and whose corner `slot` is the point p. Planes
  /// are computed lift_block at a time.
  void add(std::uint32_t c, const std::uint32_t* v, unsigned slot) {
    for (unsigned i = 0, to = 0; i <= K; ++i) {
      if (i == slot) continue;
      see(v[i], 0);
      set_row(to++, 0);
    }
    finish(c, slot % 2 == 1);
  }
  /// 3D: sets the vertices, other than p, of the next cells; add_seen() refers to them by index.
  /// The infinite vertex may be among them.
  void see(const std::uint32_t* vertices, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i)
      see(vertices[i] == infinite ? point_ : vertices[i], i);
  }
  /// 3D: add() for the positively oriented cell of p and the vertices with the indices a, b, c.
  [[gnu::always_inline]] void add_seen(std::uint32_t cell, std::uint32_t a, std::uint32_t b,
                                       std::uint32_t c) {
    set_row(0, a);
    set_row(1, b);
    set_row(2, c);
    finish(cell, false);
  }
  /// Computes the planes that are still pending. Call after the last cell of each point p.
  void flush() {
    if (open_ == 0) return;
    lift_planes(K, rows_, on_sphere_ ? sizes_ : nullptr, block_);
    for (std::size_t i = 0; i < open_; ++i) {
      LiftedPlane<K>& plane = planes_[cells_[i]];
      plane.origin = point_;
      for (unsigned j = 0; j <= K; ++j) {
        const double v = block_[j * lift_block + i];
        plane.normal[j] = odd_[i] ? -v : v;
      }
      plane.linear = ShortBound(block_[(K + 1) * lift_block + i]);
      plane.square = ShortBound(block_[(K + 2) * lift_block + i]);
    }
    open_ = 0;
  }

  /// Whether a cell's plane is known.
  bool known(std::uint32_t c) const {
    return planes_[c].linear.value() < std::numeric_limits<double>::infinity();
  }
  void prefetch(std::uint32_t c) const { prefetch_line(planes_ + c); }
  /// Whether lifts are powers with respect to a common sphere instead of squared distances.
  bool on_sphere() const { return on_sphere_; }
  /// Sets `below` to whether p is below the cell's plane, as lift_side() would; returns false if
  /// the plane does not decide that or the cell has none. Branch-free on `below`, which is
  /// unpredictable. `sphere`: on_sphere(). `p`: the row of p.
  template <bool sphere>
  [[gnu::always_inline]] bool decides(std::uint32_t c, const double* p, bool& below) const {
    const auto [value, bound] = side<sphere>(c, p);
    below = value < 0;
    return std::abs(value) > bound;
  }
  /// The same where decides() returns false: returns whether the points are on a lattice and
  /// `sign`, zero if p is on the cell's sphere, is exact.
  [[gnu::noinline]] bool decides_on_lattice(std::uint32_t c, Sign& sign) const {
    const auto [value, bound] = side<false>(c, row_);
    sign = sign_of(value);
    return bound <= exact_bound_;
  }

 private:
  /// Computes the difference of two powers; `size` bounds it and its error as in lift_planes().
  static void set_lift(double power, double other, double& lift, double& size) {
    lift = power - other;
    size = power_size(power, other);
  }
  /// Sets corner `to` of the list to vertex v, relative to p.
  [[gnu::always_inline]] void see(std::uint32_t v, std::uint32_t to) {
    const double* q = s_.row(v);
    for (unsigned j = 0; j < K; ++j) seen_[to][j] = q[j] - row_[j];
    if (on_sphere_) set_lift(s_.powers[v], s_.powers[point_], seen_lifts_[to], seen_sizes_[to]);
  }
  /// Sets row i of the next plane to a corner of the list.
  [[gnu::always_inline]] void set_row(unsigned i, std::uint32_t from) {
    double* const to = rows_ + i * (K + 1) * lift_block + open_;
    for (unsigned j = 0; j < K; ++j) to[j * lift_block] = seen_[from][j];
    if (!on_sphere_) return;
    to[K * lift_block] = seen_lifts_[from];
    sizes_[i * lift_block + open_] = seen_sizes_[from];
  }
  void finish(std::uint32_t c, bool odd) {
    cells_[open_] = c;
    odd_[open_] = odd;
    if (++open_ == lift_block) flush();
  }

  template <bool sphere>
  [[gnu::always_inline]] PlaneSide side(std::uint32_t c, const double* p) const {
    const LiftedPlane<K>& plane = planes_[c];
    const double linear = plane.linear.value(), square = plane.square.value();
    const double* o = s_.row(plane.origin);
    if constexpr (!sphere) return plane_side<K>(plane.normal, linear, square, o, p, s_.tiny);
    double lift = 0, size = 0, value = 0, most = 0;
    for (unsigned j = 0; j < K; ++j) {
      const double v = p[j] - o[j];
      most = std::max(most, std::abs(v));
      value += plane.normal[j] * v;
    }
    set_lift(s_.powers[point_], s_.powers[plane.origin], lift, size);
    value += plane.normal[K] * lift;
    return {value, linear * most + square * size + s_.tiny};
  }

  const LiftedPoints& s_;
  bool used_, on_sphere_;
  /// Up to this bound no product or sum of the determinant is rounded, if the points are on a
  /// lattice; 0 if they are not.
  double exact_bound_;
  LiftedPlane<K>* planes_ = nullptr;
  std::uint32_t point_ = 0;
  const double* row_ = nullptr;
  std::size_t open_ = 0;
  std::uint32_t cells_[lift_block] = {};
  bool odd_[lift_block] = {};
  static constexpr unsigned most_seen = K == 3 ? 64 : 1;
  double seen_[most_seen][K] = {}, seen_lifts_[most_seen] = {}, seen_sizes_[most_seen] = {};
  double rows_[K * (K + 1) * lift_block] = {}, sizes_[K * lift_block] = {};
  double block_[(K + 3) * lift_block] = {};
};

/// Replaces CellPlanes in dimensions without planes.
struct NoPlanes {
  explicit NoPlanes(const LiftedPoints&) {}
};

}  // namespace cullhull::internal
