// Hulls of points that come in pieces: more than memory holds, from many threads or many machines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "cullhull/certify.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)

namespace cullhull::internal::inline stream {
struct StateParts;
}

namespace cullhull::inline v1 {

/// All that a set of points contributes to a hull: its extreme points, each with its global id and
/// its coordinates bit for bit as given; of equal points the one with the lowest id. Flats and
/// empty sets are states like others.
///
/// States merge: merging is associative and commutative, so any order and any tree of merges of the
/// parts' states gives the state of the whole, and its hull() is that of convex_hull of all points
/// in memory, bit for bit. Parts of different scalar types merge to f64, which holds every value.
///
/// A value: copies are independent; one object is for one thread at a time.
class HullState {
 public:
  /// Of no points; the dimension is that of the first points or state merged.
  HullState();
  /// Of no points of this dimension. Error{invalid_argument} for 0.
  explicit HullState(std::uint32_t dimension, ScalarType scalar = ScalarType::f64);
  /// Of points, which have the ids first_id, first_id + 1, ... Errors and time as
  /// extreme_points(); not_finite names the global id.
  explicit HullState(const PointView& points, std::uint64_t first_id = 0,
                     const Options& options = {});
  /// Of the points a hull was computed from, with Options::with_coordinates. O(vertices).
  /// Error{invalid_argument} if the hull has no coordinates.
  explicit HullState(const Hull& hull);

  std::uint32_t dimension() const noexcept { return dimension_; }  ///< 0: not known yet
  ScalarType scalar() const noexcept { return scalar_; }
  std::uint64_t point_count() const noexcept { return seen_; }  ///< points it stands for

  /// Global ids of the extreme points, ascending.
  const std::vector<std::uint64_t>& ids() const noexcept { return ids_; }
  /// Their coordinates, packed rows of scalar(), in that order; invalidated when the state changes.
  PointView points() const noexcept;

  /// Adds another set's points. An id may occur in both only for the same point. Errors as
  /// extreme_points(), after which the state is unchanged. Error{invalid_argument} where dimensions
  /// differ, or where different extreme points of the two have one id. An id that two points have
  /// of which one is not extreme in its set is not found, as states hold extreme points alone: then
  /// the result is still that of all points, but the id is ambiguous.
  void merge(const HullState& other, const Options& options = {});

  /// Adds `offset` to every id: a part that was numbered from 0 takes its place in the whole.
  /// Error{invalid_argument} where an id would reach 2^64.
  void shift_ids(std::uint64_t offset);

  /// Converts points from units of a grid with this many decimals (cullhull/placement.hpp) to world
  /// coordinates, rounded. The state remembers the grid: merge() compares grid units if both states
  /// have the same grid. Throws Error{invalid_argument} beyond 15 decimals.
  void to_world(int decimals);
  /// Converts back to grid units. No effect without a grid.
  void to_grid();
  /// The decimals of the grid on which the state was computed and merges exactly; -1: no grid.
  int decimals() const noexcept { return decimals_; }

  /// What convex_hull() gives for all the points, ids being the global ones; bit for bit but for
  /// `statistics`, which are those of the last step. Errors as convex_hull; Error{invalid_argument}
  /// while no dimension is known.
  Hull hull(const Options& options = {}) const;

  /// The state as a versioned record with a check sum (docs/formats.md).
  std::vector<std::byte> to_bytes() const;
  /// Reads what to_bytes() wrote; every number is checked. Throws Error{bad_file}.
  static HullState from_bytes(std::span<const std::byte> bytes);

  friend bool operator==(const HullState&, const HullState&) = default;

 private:
  friend class HullStream;
  friend struct internal::StateParts;
  std::uint32_t dimension_ = 0;
  ScalarType scalar_ = ScalarType::f64;
  int decimals_ = -1;
  std::uint64_t seen_ = 0;
  std::vector<std::uint64_t> ids_;
  std::vector<std::byte> rows_;
};

/// Counters of a stream.
struct StreamReport {
  std::uint64_t point_count = 0;  ///< pushed so far
  std::uint64_t extreme = 0;      ///< extreme points of the points that were reduced exactly
  std::uint64_t waiting = 0;      ///< points held besides, not known to be inside
  std::uint64_t reductions = 0;   ///< number of exact computations of the extreme points
  std::uint64_t maps = 0;         ///< number of filters built
};

/// The hull of points that are pushed block by block, in any order of blocks, from one thread or
/// many. A block is culled in the caller's memory, by a filter built from the hull of earlier
/// blocks; survivors are collected, and when there are as many as the hull has vertices, the
/// extreme points are computed exactly and a finer filter is built. One pass; memory O(extreme
/// points + a block).
/// push(), state(), hull() and report() may be called from any threads at once.
///
/// Points beyond 6D are not filtered by a map; their extreme points are found without facets.
class HullStream {
 public:
  /// `options` hold for every call. `threads`: of each push(); with as many pushing threads as
  /// processors, 1 is best. `memory_budget`: for all that the stream holds and needs beside it.
  /// `progress`: called by one thread at a time, the one that reduces; `poll`: by every pushing
  /// thread.
  explicit HullStream(Options options = {});
  HullStream(HullStream&&) noexcept;
  HullStream& operator=(HullStream&&) noexcept;
  ~HullStream();

  /// Points with the ids first_id, first_id + 1, ...; each id is to be pushed once. The first block
  /// determines the dimension. Blocks may be of any size, 0 included. Where different points that
  /// may be extreme have one id, this or a later call throws Error{invalid_argument}.
  ///
  /// Errors, after which the stream is as if the block had not come: not_finite, naming the global
  /// id; out_of_budget, where the points that may be extreme exceed the memory: what was pushed
  /// before is still there; cancelled; invalid_argument (another dimension, null data, ids beyond
  /// 2^64).
  void push(const PointView& block, std::uint64_t first_id);
  /// The same with the ids that follow the highest id so far, pushed or counted by a pushed state.
  void push(const PointView& block);
  /// Adds the points that a state represents.
  void push(const HullState& state);

  /// The state of all that was pushed (by pushes that have returned). Errors as push().
  HullState state();
  /// Its hull: state().hull(options).
  Hull hull();

  StreamReport report() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
