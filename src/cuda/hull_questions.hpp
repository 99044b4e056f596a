// Questions about points on a device to a hull, for the host's code, without CUDA's headers:
// implemented by hull_questions.cpp where CUDA is compiled, by not_compiled.cpp elsewhere.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/device_points.hpp"
#include "filter/gauge/gauge_table.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline cuda {

/// A full-dimensional hull of dimension d <= 6 as kernels test points against it. Its extents lie
/// between 2^-100 and 2^100 (docs/exactness.md, "Queries").
struct HullTables {
  static constexpr unsigned most_dimensions = 6;
  unsigned dimension = 0;
  std::vector<double> low, high;  ///< the box
  /// A simplex of the boundary: a corner, the normal that leads out, and a factor: the computed
  /// normal . (x - corner) is off by at most factor * max|x - corner| + side_tiny.
  std::vector<double> simplices;
  std::vector<double> planes;    ///< of the facets: normal, offset
  std::vector<double> vertices;  ///< relative to a centre, rounded
  double vertex_reach = 0;       ///< their largest coordinate

  std::size_t simplex_count() const { return simplices.size() / (2 * dimension + 1); }
};

enum class PointAnswer : std::uint8_t { open, inside, outside, not_finite };
inline constexpr std::uint32_t open_vertex = 0xFFFFFFFFU;

/// Points, and the device that holds them, which is current for the thread that made this until it
/// is destroyed. Functions throw OutOfMemory and Failure.
class QuestionsOnDevice {
 public:
  /// `hull` must stay; null: only rows are wanted. Throws Failure where there is no device,
  /// Error{invalid_argument} for memory it cannot read.
  QuestionsOnDevice(const DevicePointView& points, const HullTables* hull);
  ~QuestionsOnDevice();
  QuestionsOnDevice(const QuestionsOnDevice&) = delete;
  QuestionsOnDevice& operator=(const QuestionsOnDevice&) = delete;

  /// Where `count` points from `first` on lie, as far as doubles decide. `inner`: a map of the
  /// hull, tested first; may be null. `distances`, where wanted, gets the largest value of a
  /// facet's plane for those inside; then there must be no map.
  void sides(const GaugeTable* inner, std::uint64_t first, std::uint64_t count, PointAnswer* out,
             double* distances) const;
  /// The place of the vertex with the largest scalar product with each direction, or open_vertex.
  void supports(std::uint64_t first, std::uint64_t count, std::uint32_t* out) const;
  Array<double> rows(const std::vector<std::uint64_t>& ids, const Run& run) const;
  /// Of all points. Throws Error{not_finite} for the first bad one.
  Array<double> all_rows(const Run& run) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cullhull::internal::inline cuda
