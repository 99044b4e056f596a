// Planes of the cells of a growing triangulation, stored in an array of their own.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "delaunay/cell_store.hpp"
#include "delaunay/lift_planes.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/points/local_points.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/prefetch.hpp"

namespace cullhull::internal::inline delaunay {

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

/// The planes of all cells, for 3 <= K <= 6 and points without weights that span the whole space.
template <unsigned K>
class CellPlanes {
 public:
  explicit CellPlanes(const LiftedPoints& s)
      : s_(s), used_(s.filtered && s.stride == s.base && !s.may_hide) {}

  bool used() const { return used_; }
  /// To be called whenever the store may have grown or the planes may have been reallocated.
  void set_room(PlaneArray<K>& planes, std::size_t cells) {
    if (!used_) return;
    planes.reserve(cells);
    planes_ = planes.data();
  }
  /// Marks cell c, a ghost for instance, as having no plane.
  void set_none(std::uint32_t c) {
    planes_[c].origin = 0;
    planes_[c].linear = ShortBound(std::numeric_limits<double>::infinity());
    planes_[c].square = ShortBound(0);
  }

  /// Adds the plane of cell c, whose corners are `v` and whose corner `slot` is the point p. Planes
  /// are computed lift_block at a time.
  void add(std::uint32_t c, const std::uint32_t* v, unsigned slot, std::uint32_t p) {
    const double* o = s_.row(p);
    for (unsigned i = 0, to = 0; i <= K; ++i) {
      if (i == slot) continue;
      const double* q = s_.row(v[i]);
      for (unsigned j = 0; j < K; ++j) rows_[(to * (K + 1) + j) * lift_block + open_] = q[j] - o[j];
      ++to;
    }
    cells_[open_] = c;
    odd_[open_] = slot % 2 == 1;
    if (++open_ == lift_block) flush(p);
  }
  /// 3D: sets the vertices, other than p, of the next cells; add_seen() refers to them by index.
  /// The infinite vertex may be among them.
  void see(const std::uint32_t* vertices, std::uint32_t count, std::uint32_t p) {
    const double* o = s_.row(p);
    for (std::uint32_t i = 0; i < count; ++i) {
      const double* q = s_.row(vertices[i] == infinite ? p : vertices[i]);
      for (unsigned j = 0; j < K; ++j) seen_[i][j] = q[j] - o[j];
    }
  }
  /// 3D: add() for the positively oriented cell of p and the vertices with the indices a, b, c.
  void add_seen(std::uint32_t cell, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                std::uint32_t p) {
    for (unsigned j = 0; j < K; ++j) {
      rows_[(0 * (K + 1) + j) * lift_block + open_] = seen_[a][j];
      rows_[(1 * (K + 1) + j) * lift_block + open_] = seen_[b][j];
      rows_[(2 * (K + 1) + j) * lift_block + open_] = seen_[c][j];
    }
    cells_[open_] = cell;
    odd_[open_] = false;
    if (++open_ == lift_block) flush(p);
  }
  /// Computes the planes that are still pending. Call after the last cell of each point p.
  void flush(std::uint32_t p) {
    if (open_ == 0) return;
    lift_planes(K, rows_, block_);
    for (std::size_t i = 0; i < open_; ++i) {
      LiftedPlane<K>& plane = planes_[cells_[i]];
      plane.origin = p;
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
  /// Sets `below` to whether p is below the cell's plane, as lift_side() would; returns false if
  /// the plane does not decide that or the cell has none. Branch-free on `below`, which is
  /// unpredictable.
  bool decides(std::uint32_t c, const double* p, bool& below) const {
    const LiftedPlane<K>& plane = planes_[c];
    const double* o = s_.row(plane.origin);
    double lift = 0, value = 0, most = 0;
    for (unsigned j = 0; j < K; ++j) {
      const double v = p[j] - o[j];
      most = std::max(most, std::abs(v));
      lift += v * v;
      value += plane.normal[j] * v;
    }
    value += plane.normal[K] * lift;
    const double bound = (plane.linear.value() + plane.square.value() * most) * most + s_.tiny;
    below = value < 0;
    return std::abs(value) > bound;
  }

 private:
  const LiftedPoints& s_;
  bool used_;
  LiftedPlane<K>* planes_ = nullptr;
  std::size_t open_ = 0;
  std::uint32_t cells_[lift_block] = {};
  bool odd_[lift_block] = {};
  double seen_[K == 3 ? 64 : 1][K] = {};
  double rows_[K * (K + 1) * lift_block] = {}, block_[(K + 3) * lift_block] = {};
};

/// Replaces CellPlanes in dimensions without planes.
struct NoPlanes {
  explicit NoPlanes(const LiftedPoints&) {}
};

}  // namespace cullhull::internal::inline delaunay
