// Queries to a hull about points on a device (inside or outside, support vertices): the interface
// for host code, without CUDA's headers. Builds with CUDA implement it in hull_questions.cpp,
// others in not_compiled.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/device_points.hpp"
#include "filter/gauge/gauge_table.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline cuda {

/// The data of a full-dimensional hull of dimension d <= 6 that the kernels need. Its extents must
/// be between 2^-100 and 2^100 (docs/exactness.md, "Queries").
struct HullTables {
  static constexpr unsigned most_dimensions = 6;
  unsigned dimension = 0;
  std::vector<double> low, high;  ///< bounding box
  /// 2 d + 1 numbers for each simplex of the boundary: a corner, the outward normal, and a factor.
  /// The error of normal . (x - corner) in doubles is at most factor * max|x - corner| + side_tiny.
  std::vector<double> simplices;
  std::vector<double> planes;    ///< normal and offset of each facet
  std::vector<double> vertices;  ///< vertices relative to a centre, rounded
  double vertex_reach = 0;       ///< largest absolute coordinate in `vertices`

  std::size_t simplex_count() const { return simplices.size() / (2 * dimension + 1); }
};

/// The side of a point. `open`: doubles do not decide it.
enum class PointAnswer : std::uint8_t { open, inside, outside, not_finite };
/// The answer of supports() if doubles do not decide it.
inline constexpr std::uint32_t open_vertex = 0xFFFFFFFFU;

/// Answers queries about points on their device. The constructor makes that device current for its
/// thread, and the destructor restores the former one. Functions throw OutOfMemory and Failure.
class QuestionsOnDevice {
 public:
  /// `hull` must outlive the object; null: only rows() and all_rows() are used. Throws Failure if
  /// there is no device, and Error{invalid_argument} for memory that the device cannot read.
  QuestionsOnDevice(const DevicePointView& points, const HullTables* hull);
  ~QuestionsOnDevice();
  QuestionsOnDevice(const QuestionsOnDevice&) = delete;
  QuestionsOnDevice& operator=(const QuestionsOnDevice&) = delete;

  /// Writes the sides of `count` points from `first` on. `inner`: a map of the hull that is tested
  /// first; may be null. `distances`, if not null, receives the largest value of a facet's plane
  /// for each point inside, and 0 for the others; `inner` must be null then.
  void sides(const GaugeTable* inner, std::uint64_t first, std::uint64_t count, PointAnswer* out,
             double* distances) const;
  /// Writes, for each of `count` directions from `first` on, the index of the vertex with the
  /// largest scalar product, or open_vertex.
  void supports(std::uint64_t first, std::uint64_t count, std::uint32_t* out) const;
  /// Copies these points to the host, as packed rows.
  Array<double> rows(const std::vector<std::uint64_t>& ids, const Run& run) const;
  /// Copies all points to the host. Throws Error{not_finite} for the first point that is not
  /// finite.
  Array<double> all_rows(const Run& run) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cullhull::internal::inline cuda
