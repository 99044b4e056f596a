// Planes of the cells of a growing triangulation, stored in an array of their own.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "delaunay/cell_store.hpp"
#include "delaunay/lift_planes.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/points/local_points.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/prefetch.hpp"

namespace cullhull::internal::inline delaunay {

template <unsigned K>
struct LiftedPlane {
  double normal[K + 1];
  double linear, square;  ///< the numbers a and b of lift_planes()
  std::uint32_t origin;
};
/// Indexed by cell.
template <unsigned K>
using PlaneArray = RawArray<LiftedPlane<K>>;

/// For 4 <= K <= 6 and points without weights that span all of space.
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
  void set_none(std::uint32_t c) { planes_[c].origin = infinite; }

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
  /// Computes the planes added last. To be called after the last cell of each point p.
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
      plane.linear = block_[(K + 1) * lift_block + i];
      plane.square = block_[(K + 2) * lift_block + i];
    }
    open_ = 0;
  }

  /// Whether a cell's plane is known.
  bool known(std::uint32_t c) const { return planes_[c].origin != infinite; }
  void prefetch(std::uint32_t c) const {
    prefetch_line(planes_ + c);
    prefetch_line(&planes_[c].origin);
  }
  /// As lift_side(), for a cell whose plane is known; zero if floating point does not decide.
  Sign side(std::uint32_t c, const double* p) const {
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
    const double bound = (plane.linear + plane.square * most) * most + s_.tiny;
    if (value > bound) return Sign::positive;
    if (value < -bound) return Sign::negative;
    return Sign::zero;
  }

 private:
  const LiftedPoints& s_;
  bool used_;
  LiftedPlane<K>* planes_ = nullptr;
  std::size_t open_ = 0;
  std::uint32_t cells_[lift_block] = {};
  bool odd_[lift_block] = {};
  double rows_[K * (K + 1) * lift_block] = {}, block_[(K + 3) * lift_block] = {};
};

/// Stands in for CellPlanes in dimensions without planes.
struct NoPlanes {
  explicit NoPlanes(const LiftedPoints&) {}
};

}  // namespace cullhull::internal::inline delaunay
