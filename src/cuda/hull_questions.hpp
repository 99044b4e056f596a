// Queries to a hull about points on a device (inside or outside, support vertices): the interface
// for host code, without CUDA's headers. Builds with CUDA implement it in hull_questions.cpp,
// others in not_compiled.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/device_points.hpp"
#include "filter/gauge/gauge_table.hpp"
#include "geometry/facet_cells.hpp"

namespace cullhull::internal {

struct Run;
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

/// A query's tables in the memory of devices: by device and by where the table is on the host. Each
/// is uploaded when a call first needs it, and stays until the query ends. Calls on several threads
/// may share it.
struct KeptTables {
  std::mutex mutex;
  std::map<std::pair<int, const void*>, std::shared_ptr<std::byte>> there;
};

/// The bytes that stand for the sides of a point.
struct SideCodes {
  std::uint8_t inside, outside;
};

/// Answers queries about points on their device, which is current for its thread from creation to
/// destruction. Functions throw OutOfMemory and Failure.
class QuestionsOnDevice {
 public:
  QuestionsOnDevice() = default;
  virtual ~QuestionsOnDevice() = default;
  QuestionsOnDevice(const QuestionsOnDevice&) = delete;
  QuestionsOnDevice& operator=(const QuestionsOnDevice&) = delete;

  // Each of these functions answers for `count` < 2^32 points from `first` on and writes an item
  // for each of them to `out`, on the device. It returns the numbers, ascending from `first`, of
  // the points that are open: doubles do not decide them, or they are not finite. Their items are
  // 0.

  /// `inner`: a map of the hull that is tested first; may be null.
  virtual std::vector<std::uint64_t> sides(const GaugeTable* inner, SideCodes codes,
                                           std::uint64_t first, std::uint64_t count,
                                           std::uint8_t* out) = 0;
  /// `cells`: the same for every call.
  virtual std::vector<std::uint64_t> sides(const FacetCellTable& cells, SideCodes codes,
                                           std::uint64_t first, std::uint64_t count,
                                           std::uint8_t* out) = 0;
  /// `ids[v]`: the id of vertex v, for every call the same. Writes the id of the vertex with the
  /// largest scalar product.
  virtual std::vector<std::uint64_t> supports(const std::vector<std::uint64_t>& ids,
                                              std::uint64_t first, std::uint64_t count,
                                              std::uint64_t* out) = 0;
  /// Minus the distance to the boundary of points certainly inside: the largest value of a facet's
  /// plane. All others are open.
  virtual std::vector<std::uint64_t> distances(std::uint64_t first, std::uint64_t count,
                                               double* out) = 0;

  /// Memory on the device for `bytes` of answers, valid until the next call or destruction.
  virtual void* room(std::uint64_t bytes) = 0;
  /// Throws Error{invalid_argument} unless the memory is the points' device's, aligned for items of
  /// this size.
  virtual void require_room(const void* answers, std::size_t item) const = 0;
  /// Copies answers to the host, or to the device.
  virtual void fetch(void* to, const void* from, std::uint64_t bytes) const = 0;
  virtual void put(void* to, const void* from, std::uint64_t bytes) const = 0;
  /// out[ids[k]] = items[k] of an array on the device, items of `item` bytes; complete on return.
  virtual void put_items(void* out, const std::vector<std::uint64_t>& ids, const void* items,
                         std::size_t item) const = 0;
  /// Copies these points to the host, as packed rows.
  virtual Array<double> rows(const std::vector<std::uint64_t>& ids, const Run& run) const = 0;
  /// Copies all points to the host. Throws Error{not_finite} for the first point that is not
  /// finite.
  virtual Array<double> all_rows(const Run& run) const = 0;
};

/// `hull` and `kept` must outlive the result; no hull: only sides() by cells and the functions
/// after distances() are used. Throws Failure if there is no device, and Error{invalid_argument}
/// for memory that the device cannot read.
std::unique_ptr<QuestionsOnDevice> questions_on_device(const DevicePointView& points,
                                                       const HullTables* hull, KeptTables& kept,
                                                       const Options& options);

}  // namespace cullhull::internal
