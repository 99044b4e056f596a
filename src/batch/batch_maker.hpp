// How a batch is made: all threads compute hulls of sets, small sets go straight from points to the
// lists of the batch, and the results are concatenated.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "cullhull/batch.hpp"
#include "cullhull/error.hpp"
#include "cullhull/point_view.hpp"
#include "few/small_polygon.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

/// A hull whose vertices a device has found.
struct FoundHull {
  PointView rows;             ///< of the vertices, by ascending ids
  const std::uint64_t* ids;   ///< the vertices' ids within the set
  std::uint64_t point_count;  ///< of the set
  /// In space, where every facet is a simplex: three positions in `rows` per simplex, in the order
  /// of a result; null if unknown.
  const std::uint8_t* simplices = nullptr;
  unsigned simplex_count = 0;
};

/// Computes the hull of one set at a time on the calling thread, by the first path that accepts it.
class SetHuller {
 public:
  explicit SetHuller(const Run& run);
  void append(const PointView& set, HullBatch& to);
  /// The same for a set whose vertices are known.
  void append(const FoundHull& found, HullBatch& to);

 private:
  Options options_;
  SmallPolygon polygon_;
};

class BatchMaker {
 public:
  /// Appends set i to a part.
  using Append = std::function<void(SetHuller&, std::uint64_t i, HullBatch& part)>;
  /// The number by which an error names set i.
  using Number = std::function<std::uint64_t(std::uint64_t i)>;

  /// For `sets` sets with `points` points in all; `run` must outlive this object.
  BatchMaker(std::uint32_t dimension, ScalarType scalar, std::uint64_t sets, std::uint64_t points,
             const Run& run);
  /// Adds `count` sets, on all threads. If sets fail, throws the error of the first one, which
  /// names it number(i), or i without `number`.
  void add(std::uint64_t count, const Append& append, const Number& number = nullptr);
  HullBatch finish() &&;

 private:
  void add_chunk(std::uint64_t c, std::uint64_t begin, std::uint64_t end, const Append& append,
                 const Number& number);

  const Run& run_;
  const std::uint64_t sets_, chunk_, block_;  ///< in all; of a task, of a block
  std::uint64_t done_ = 0;
  HullBatch all_;
  std::vector<HullBatch> parts_;
  std::vector<std::optional<Error>> errors_;
};

/// Throws Error{invalid_argument} unless the offsets ascend and none exceeds the number of points.
void check_offsets(std::uint64_t points, const std::uint64_t* offsets, std::uint64_t sets);

}  // namespace cullhull::internal
