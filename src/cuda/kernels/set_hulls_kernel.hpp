// The kernels for the hulls of many small sets. Each function launches a kernel on a stream and
// returns the status of the launch. The callers (set_hulls.cpp) handle memory and errors.
#pragma once

#include <driver_types.h>

#include <cstddef>
#include <cstdint>

#include "cullhull/device_points.hpp"

namespace cullhull::internal {

/// The most points of a set that a warp copies to shared memory. Numbers of points within a set,
/// and numbers of simplices, then fit a byte.
inline constexpr unsigned most_near_points = 128;
/// The most simplices of a larger set, in space, so that a block needs no more shared memory than
/// it may have without asking: a hull of some 640 vertices; 16,384 points of a ball have 580.
inline constexpr unsigned most_far_facets = 1280;

/// Sets are hulled by classes, as the warps of a launch have the same amount of shared memory: up
/// to so many points. In the plane there are `near_classes`: there larger sets are the CPU's, which
/// takes hardly longer than copying them.
inline constexpr unsigned set_classes[] = {32, 64, 96, most_near_points, 256, 512, 1U << 14};
inline constexpr unsigned near_classes = 4;

/// Numbers of room for simplices for each point of a set. A set of n points has at most n simplices
/// in 2D and fewer than 2 n in 3D, of d numbers each.
constexpr unsigned simplex_room(unsigned dimension) { return dimension == 2 ? 2 : 6; }

/// How many there are in a set's hull.
struct SetCounts {
  std::uint16_t vertices = 0, simplices = 0;
};
/// Sets and their hulls. All pointers refer to the device's memory.
struct WarpSets {
  const std::uint64_t* starts;  ///< set i has the points [starts[i], starts[i + 1])
  std::uint32_t sets;
  /// None: the hull was not decided, because the set has another size, a sign is too close to zero,
  /// a point is not finite, or the hull has too many simplices.
  SetCounts* counts;
  /// The lists of vertices and of simplices (d numbers each), in the order of a HullBatch. A set's
  /// lists begin at the index of its first point times the room for a point: 1 number in
  /// `vertices`, simplex_room() in `simplices`.
  std::uint16_t* vertices;
  std::uint16_t* simplices;
};

/// Finds the hulls of the sets of `least` to `most` points, of one class, and leaves the counts of
/// others unchanged. Dimension 2 or 3.
cudaError_t find_set_hulls(const DevicePointView& points, const WarpSets& sets, unsigned least,
                           unsigned most, cudaStream_t stream);

/// The lengths of a set's lists.
struct SetLengths {
  std::uint32_t set, vertices, simplices;
  std::int32_t affine_dimension;
};
/// Where the lists of set i begin: the vertices at vertex_at[i], the simplices at simplex_at[i]
/// (counted in simplices, not numbers).
struct PlacedLists {
  std::uint64_t *vertex_at = nullptr, *simplex_at = nullptr;         ///< of all sets and one more
  std::int32_t *vertex_counts = nullptr, *simplex_counts = nullptr;  ///< null: not wanted
  std::int32_t* affine_dimensions = nullptr;                         ///< likewise
  std::uint64_t vertex_width = 0, simplex_width = 0;                 ///< of padded rows
};
/// Writes what `out` wants of the decided sets, whose dimension is `dimension`, and of the
/// `others`; a set that is neither has empty lists. Without widths vertex_at and simplex_at get
/// lengths, and a 0 at the end: their sums are wanted.
cudaError_t place_lists(const WarpSets& sets, std::int32_t dimension, const SetLengths* others,
                        std::uint32_t other_count, const PlacedLists& out, cudaStream_t stream);

/// Copies the lists of the decided sets as numbers of type Id, std::uint16_t or std::int32_t. With
/// `rows`, vertices ascend, and their packed rows in the points' scalar type are written there.
template <class Id>
cudaError_t pack_set_hulls(const DevicePointView& points, const WarpSets& sets,
                           const PlacedLists& at, Id* vertices, Id* simplices, void* rows,
                           cudaStream_t stream);

/// Volume, area and centroid of each set's hull, and the exponent by which its coordinates are
/// scaled: what measure_sets() finds.
struct SetMeasures {
  double* volumes;
  double* areas;
  double* centroids;  ///< d numbers a set
  std::int8_t* exponents;
};
/// Measures the decided sets. Sets whose measures or planes doubles leave uncertain become
/// undecided.
cudaError_t measure_sets(const DevicePointView& points, const WarpSets& sets,
                         const SetMeasures& measures, cudaStream_t stream);
/// Writes the planes of the decided sets' simplices, those of set i from simplex_at[i] (d + 1) on.
/// `exponents`: as measure_sets() finds them.
cudaError_t write_set_planes(const DevicePointView& points, const WarpSets& sets,
                             const std::int8_t* exponents, const std::uint64_t* simplex_at,
                             double* planes, cudaStream_t stream);

/// Items to copy: where they begin in the source and in the destination, and how many.
struct ItemRun {
  std::uint64_t from, to, length;
};
/// Copies runs of points to packed rows of the points' scalar type.
cudaError_t copy_point_runs(const DevicePointView& points, const ItemRun* runs, std::uint32_t count,
                            void* rows, cudaStream_t stream);

}  // namespace cullhull::internal
