// How a batch is made: sets hulled on all threads, their results joined end to end.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "batch/planar_sets.hpp"
#include "cullhull/batch.hpp"
#include "cullhull/error.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline batch {

/// A hull of which vertices are known, from a device.
struct FoundHull {
  PointView rows;             ///< of the vertices, by ascending ids
  const std::uint64_t* ids;   ///< theirs within the set
  std::uint64_t point_count;  ///< of the set
  /// In space, where every facet is a simplex: places among `rows`, three each, in the order of a
  /// result. Null: not known.
  const std::uint8_t* simplices = nullptr;
  unsigned simplex_count = 0;
};

/// Hulls one set at a time on the calling thread, by the first way that takes it.
class SetHuller {
 public:
  explicit SetHuller(const Run& run);
  void append(const PointView& set, HullBatch& to);
  /// The same for a set whose vertices are known.
  void append(const FoundHull& found, HullBatch& to);

 private:
  Options options_;
  bool plain_;  ///< with other options the fast paths' errors would differ
  PlanarSets planar_;
};

class BatchMaker {
 public:
  /// Appends set i to a part.
  using Append = std::function<void(SetHuller&, std::uint64_t i, HullBatch& part)>;
  /// The number by which an error names set i.
  using Number = std::function<std::uint64_t(std::uint64_t i)>;

  /// For so many sets of so many points in all; `run` must stay.
  BatchMaker(std::uint32_t dimension, ScalarType scalar, std::uint64_t sets, std::uint64_t points,
             const Run& run);
  /// Adds `count` sets, on all threads. Throws the error of the first set that has one, by
  /// number(i), or i.
  void add(std::uint64_t count, const Append& append, const Number& number = nullptr);
  HullBatch finish() &&;

 private:
  void add_chunk(std::uint64_t c, std::uint64_t begin, std::uint64_t end, const Append& append,
                 const Number& number);

  const Run& run_;
  const std::uint64_t sets_, block_;
  std::uint64_t done_ = 0;
  HullBatch all_;
  std::vector<HullBatch> parts_;
  std::vector<std::optional<Error>> errors_;
};

/// Throws Error{invalid_argument} unless they ascend and none exceeds the number of points.
void check_offsets(std::uint64_t points, const std::uint64_t* offsets, std::uint64_t sets);

}  // namespace cullhull::internal::inline batch
