// The rows of a subset: a copy in doubles, or the caller's memory.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "cullhull/point_view.hpp"
#include "parallel/host_device.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

/// A subset of the points: subset s of M has the blocks s, s + M, s + 2 M, ..., a uniform sample
/// even where neighbours in memory are neighbours in space.
struct PseudoSubset {
  static constexpr std::uint64_t block = 512;
  std::uint64_t total, index, subsets;

  CULLHULL_HD std::uint64_t point(std::uint64_t local) const {
    return (local / block * subsets + index) * block + local % block;
  }
  std::uint64_t size() const {
    const std::uint64_t blocks = chunk_count(total, block);
    if (index >= blocks) return 0;
    const std::uint64_t mine = (blocks - index + subsets - 1) / subsets;
    const bool has_last = (blocks - 1) % subsets == index;
    return mine * block - (has_last ? blocks * block - total : 0);
  }
};

// Subsets interleave blocks of the points, so their lists interleave as well: (0, 5, 900) and (600,
// 700) become (0, 5, 600, 700, 900), the survivors as one list, whatever the number of threads and
// subsets.

/// Merges the subsets' ascending lists of ids into one ascending list.
std::vector<std::uint64_t> merge_subsets(std::vector<std::vector<std::uint64_t>> kept);

// Why NaN marks a row: every comparison with it is false, so it is no extreme point, no apex, not
// outside of a facet and not inside of one: it survives, without a test of its own anywhere.

/// Packed rows of doubles, which are scaled once, in place. A row that must survive is NaN in every
/// coordinate.
template <unsigned D>
struct StoredRows {
  double* data;

  CULLHULL_HD void load(std::uint32_t i, double* x) const {
    const double* row = data + std::size_t{i} * D;
    for (unsigned k = 0; k < D; ++k) x[k] = row[k];
  }
  struct Scale {
    double* data;
    double scale[D];
    CULLHULL_HD void operator()(std::uint32_t i) const {
      for (unsigned k = 0; k < D; ++k) data[std::size_t{i} * D + k] *= scale[k];
    }
  };
  template <class Executor>
  void rescale(const Executor& executor, std::uint32_t count, const double* scale) {
    Scale body{data, {}};
    for (unsigned k = 0; k < D; ++k) body.scale[k] = scale[k];
    executor.for_each(count, body);
  }
};

/// The points of a subset in the caller's memory, converted and scaled at each access: a device's
/// limit is bandwidth, not operations. Coordinates are aligned to their type.
template <unsigned D, class T>
struct RowsInPlace {
  const std::byte* data;
  std::ptrdiff_t point_stride, coordinate_stride;
  PseudoSubset subset;
  double scale[D];

  CULLHULL_HD void load(std::uint32_t i, double* x) const {
    const std::byte* p = data + static_cast<std::ptrdiff_t>(subset.point(i)) * point_stride;
    double check = 0;  // x * 0 is NaN exactly for NaN and infinities
    for (unsigned k = 0; k < D; ++k) {
      const auto v = static_cast<double>(
          *reinterpret_cast<const T*>(p + static_cast<std::ptrdiff_t>(k) * coordinate_stride));
      check += v * 0.0;
      x[k] = v * scale[k];
    }
    // A point with a NaN or an infinity is NaN throughout, so that no comparison holds.
    if (!(check == 0))
      for (unsigned k = 0; k < D; ++k) x[k] = std::numeric_limits<double>::quiet_NaN();
  }
  template <class Executor>
  void rescale(const Executor&, std::uint32_t, const double* powers) {
    for (unsigned k = 0; k < D; ++k) scale[k] = powers[k];
  }
};

template <unsigned D, class T>
RowsInPlace<D, T> rows_in_place(const PointView& view, const PseudoSubset& subset) {
  RowsInPlace<D, T> rows{view.data, view.point_stride, view.coordinate_stride, subset, {}};
  for (double& s : rows.scale) s = 1;
  return rows;
}

}  // namespace cullhull::internal
