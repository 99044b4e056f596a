// Hulls of points that arrive in pieces: more than fit in memory, from many threads or machines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "cullhull/certify.hpp"
#include "cullhull/hull_fwd.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)

namespace cullhull::internal {
struct StateParts;
}

namespace cullhull {

/// What a set of points contributes to any hull: its extreme points, each with its global id and
/// its exact coordinates; of equal points the one with the lowest id. Flat and empty sets have
/// states, too.
///
/// States can be merged. Merging is associative and commutative: merging the states of all parts in
/// any order gives the state of the whole, and its hull() equals convex_hull of all points in
/// memory, bit for bit. Parts of different scalar types merge to f64, which represents every value.
///
/// A value: copies are independent. Not thread safe: use one object from one thread at a time.
class HullState {
 public:
  /// State of no points; the first points or state merged into it set the dimension.
  HullState();
  /// State of no points of this dimension. Error{invalid_argument} for 0.
  explicit HullState(std::uint32_t dimension, ScalarType scalar = ScalarType::f64);
  /// State of points that have the ids first_id, first_id + 1, ... Errors and time as of
  /// extreme_points(); not_finite names the global id.
  explicit HullState(const PointView& points, std::uint64_t first_id = 0,
                     const Options& options = {});
  /// State of the points that a hull was computed from with Options::with_coordinates. O(vertices).
  /// Error{invalid_argument} if the hull has no coordinates.
  explicit HullState(const Hull& hull);

  std::uint32_t dimension() const noexcept { return dimension_; }  ///< 0: not known yet
  ScalarType scalar() const noexcept { return scalar_; }
  std::uint64_t point_count() const noexcept { return seen_; }  ///< number of points it stands for

  /// Global ids of the extreme points, ascending.
  const std::vector<std::uint64_t>& ids() const noexcept { return ids_; }
  /// Their coordinates, packed rows of scalar(), in the order of ids(). Valid until the state
  /// changes.
  PointView points() const noexcept;

  /// Adds the points of another state. An id may occur in both only for the same point. States of
  /// different grids (below) are compared on the coarsest grid that contains both. Errors as of
  /// extreme_points(), after which the state is unchanged. Error{invalid_argument} if dimensions
  /// differ, if different extreme points of the two have the same id, or if one state is of a
  /// decimal grid and no grid of at most 50 bits contains the other. A shared id of which one
  /// point is not extreme in its set is not detected, as states hold extreme points only; the
  /// result is then still the hull of all points, but the id is ambiguous.
  void merge(const HullState& other, const Options& options = {});

  /// Adds `offset` to every id, so that a part numbered from 0 gets its ids in the whole.
  /// Error{invalid_argument} if an id would reach 2^64.
  void shift_ids(std::uint64_t offset);

  /// Converts points from units of a grid with this many decimals (cullhull/placement.hpp) to world
  /// coordinates, rounded. The state remembers the grid, on which merge() compares. `bits`: those
  /// of the largest number that a file of the points could hold (Grid::bits); 0: those of the
  /// points. Throws Error{invalid_argument} beyond 15 decimals.
  void to_world(int decimals, int bits = 0);
  /// Converts back to grid units. No effect without a decimal grid.
  void to_grid();
  /// The same, to units of a finer grid. Throws Error{invalid_argument} if no grid of that many
  /// decimals and at most 50 bits contains the points.
  void to_grid(int decimals);
  /// Remembers that the coordinates are multiples of 2^-places. `bits`: as of to_world().
  void set_binary_grid(int places, int bits = 0);
  /// The decimals of the grid on which the state was computed and merges exactly; -1: no such grid.
  int decimals() const noexcept { return decimals_; }
  /// The binary places of its grid; -1: no such grid.
  int places() const noexcept { return places_; }
  /// The `bits` of set_binary_grid.
  int bits() const noexcept { return bits_; }

  /// Equal to convex_hull() of all the points, with global ids, bit for bit except for
  /// `statistics`, which describe the last step. Errors as convex_hull; Error{invalid_argument} if
  /// no dimension is known yet.
  Hull hull(const Options& options = {}) const;

  /// The state as a versioned record with a checksum (docs/formats.md).
  std::vector<std::byte> to_bytes() const;
  /// Reads a record of to_bytes() and checks every number. Throws Error{bad_file}.
  static HullState from_bytes(std::span<const std::byte> bytes);

  friend bool operator==(const HullState&, const HullState&) = default;

 private:
  friend class HullStream;
  friend struct internal::StateParts;
  std::uint32_t dimension_ = 0;
  ScalarType scalar_ = ScalarType::f64;
  std::int8_t decimals_ = -1, places_ = -1, bits_ = 0;
  std::uint64_t seen_ = 0;
  std::vector<std::uint64_t> ids_;
  std::vector<std::byte> rows_;
};

/// Counters of a stream.
struct StreamReport {
  std::uint64_t point_count = 0;  ///< pushed so far
  std::uint64_t extreme = 0;      ///< found to be so by the last exact reduction; 0 after others
  std::uint64_t waiting = 0;      ///< further points held, not known to be inside
  std::uint64_t reductions = 0;   ///< number of exact computations of the extreme points
  std::uint64_t maps = 0;         ///< number of filters built, by push() alone
};

/// The hull of points that are pushed block by block, in any order of blocks, from one thread or
/// many. A filter built from points of earlier blocks tests a block in the caller's memory;
/// survivors are collected, and when there are many more than it was built from, a finer filter is
/// built and drops those of them that are inside. One pass over the points; memory O(extreme points
/// + a block). push(), state(), hull() and report() may be called from any threads at once.
///
/// Points beyond 6D are not filtered; their extreme points are found without facets.
class HullStream {
 public:
  /// `options` apply to every call. `threads`: of each push(), which takes no more than are idle
  /// while other threads push, and of each state(). `memory_budget`: limit for all memory of the
  /// stream.
  /// `progress`: called by one thread at a time, the one that computes extreme points; `poll`: by
  /// every pushing thread.
  explicit HullStream(Options options = {});
  HullStream(HullStream&&) noexcept;
  HullStream& operator=(HullStream&&) noexcept;
  ~HullStream();

  /// Adds points with the ids first_id, first_id + 1, ...; each id must be pushed once. The first
  /// block sets the dimension. Blocks may have any size, including 0. If different, possibly
  /// extreme points have the same id, this or a later call throws Error{invalid_argument}.
  ///
  /// An error leaves the stream as it was before the call. Errors: not_finite, which names the
  /// global id; out_of_budget, if the possibly extreme points exceed the memory budget; cancelled;
  /// invalid_argument (another dimension, null data, ids beyond 2^64).
  void push(const PointView& block, std::uint64_t first_id);
  /// The same; ids continue after the highest id so far, pushed or counted by a pushed state.
  void push(const PointView& block);
  /// Adds the points that a state represents. Throws Error{invalid_argument} for one of numbers
  /// with decimals (HullState::decimals() > 0), whose coordinates are rounded: merge() compares
  /// those on their grid.
  void push(const HullState& state);
  /// Counts points that are left out, such as those without a return: the `count` ids from first_id
  /// on are taken, and the state's point_count() includes them if it has other points. Errors:
  /// invalid_argument for ids beyond 2^64.
  void skip(std::uint64_t first_id, std::uint64_t count);

  /// The state of all points pushed by calls that have returned. Errors as push().
  HullState state();
  /// The hull of that state, as state().hull(options) gives it, in less time.
  Hull hull();

  StreamReport report() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cullhull
#pragma GCC visibility pop
