// Queries to a finished hull: whether it contains a point, distances, visible facets, intersections
// with lines, and extreme vertices in a direction.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "cullhull/device_points.hpp"
#include "cullhull/hull_fwd.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// Position of a point; for a flat hull, within its flat (points off the flat are outside).
enum class Side : std::int8_t { inside = -1, boundary = 0, outside = 1 };

/// Intersection of the hull with the line origin + t direction, t real.
struct RayHit {
  bool hit = false;
  double enter = 0, exit = 0;  ///< parameters t, enter <= exit; negative: behind the origin
  std::uint32_t enter_facet = no_index, exit_facet = no_index;
};

struct NearestFacet {
  std::uint32_t facet = 0;
  /// Euclidean distance to the boundary, negative for points of the hull.
  double distance = 0;
};

/// A hull prepared for queries. Answers about sides, visibility and support are exact; distances
/// and ray parameters are doubles with an error of about 2^-40 of the hull's extent.
///
/// Construction takes O(facets d^3 + simplices) time and memory and copies what it needs: neither
/// the points nor the hull must outlive it. All members are const and thread safe. Query points are
/// d = hull.dimension finite numbers (OnePoint: an array, a span, a list in braces, ...), another
/// number of them is Error{invalid_argument}; a NaN or an infinity is Error{not_finite} (which
/// names the first index in the batched forms). An empty hull is Error{invalid_argument}.
///
/// A query walks over neighbouring facets (or vertices) from a start near the answer: a few facets
/// for d = 3; in general the walk solves a linear program on the dual, where a local maximum is
/// global. For d > 8, and for hulls too thin to have an interior point in doubles, it tests every
/// facet.
/// Source: docs/algorithm.md, "Queries".
class HullQuery {
 public:
  /// `points`: those the hull was computed from.
  HullQuery(const PointView& points, const Hull& hull, const Options& options = {});
  /// By the coordinates that the hull carries (Options::with_coordinates).
  /// Error{invalid_argument} if it has none.
  explicit HullQuery(const Hull& hull, const Options& options = {});
  ~HullQuery();
  HullQuery(HullQuery&&) noexcept;
  HullQuery& operator=(HullQuery&&) noexcept;

  std::uint32_t dimension() const noexcept;

  Side side(const double* point) const;
  Side side(const OnePoint& point) const { return side(point.of(dimension())); }
  bool contains(const OnePoint& point) const { return side(point) != Side::outside; }

  /// Facets (indices, ascending) that are visible from the point: it is strictly above them. Empty
  /// for a point of the hull, and for a point off the flat of a flat hull.
  std::vector<std::uint32_t> visible_facets(const double* point) const;
  std::vector<std::uint32_t> visible_facets(const OnePoint& point) const {
    return visible_facets(point.of(dimension()));
  }

  /// The id of the vertex with the largest scalar product with `direction`, exactly; of several,
  /// the lowest id. The direction must be finite; the zero vector gives the lowest id.
  std::uint64_t support(const double* direction) const;
  std::uint64_t support(const OnePoint& direction) const {
    return support(direction.of(dimension()));
  }

  /// Euclidean distance to the hull, 0 on the boundary; for points inside, minus the distance to
  /// the boundary (for a flat hull: its boundary within its flat).
  double signed_distance(const OnePoint& point) const { return nearest_facet(point).distance; }
  /// The facet that contains a nearest point of the boundary; of several, any one.
  NearestFacet nearest_facet(const double* point) const;
  NearestFacet nearest_facet(const OnePoint& point) const {
    return nearest_facet(point.of(dimension()));
  }

  /// For full-dimensional hulls (else Error{invalid_argument}). A zero direction is an
  /// Error{invalid_argument}. A line that touches the hull, up to rounding, may be reported as a
  /// hit or not.
  RayHit ray(const double* origin, const double* direction) const;
  RayHit ray(const OnePoint& origin, const OnePoint& direction) const {
    return ray(origin.of(dimension()), direction.of(dimension()));
  }

  /// The same for many points: `out` receives one item per point. Dimensions must agree. Parallel
  /// over options.threads, with options.stop and options.progress. contains() and sides() first
  /// test a gauge map of the hull, which decides most inner points at memory speed.
  void contains(const PointView& points, std::uint8_t* out, const Options& options = {}) const;
  void sides(const PointView& points, Side* out, const Options& options = {}) const;
  void supports(const PointView& directions, std::uint64_t* out, const Options& options = {}) const;
  void nearest_facets(const PointView& points, NearestFacet* out,
                      const Options& options = {}) const;
  void signed_distances(const PointView& points, double* out, const Options& options = {}) const;
  void rays(const PointView& origins, const PointView& directions, RayHit* out,
            const Options& options = {}) const;

  /// The same for points in a CUDA device's memory; `out` is in host memory. The device answers for
  /// full-dimensional hulls in 2 to 6 dimensions; the points that arithmetic in doubles does not
  /// decide (signed_distances: all points not inside) are copied and tested on the CPU. The CPU
  /// tests all points with Backend::cpu, for other hulls, and, unless Backend::cuda was given, if
  /// that is estimated to take less time or the device's memory is full. Throws
  /// Error{backend_unavailable} without a device, Error{out_of_budget}, Error{invalid_argument} for
  /// unsupported memory or scalar types.
  void contains(const DevicePointView& points, std::uint8_t* out,
                const Options& options = {}) const;
  void sides(const DevicePointView& points, Side* out, const Options& options = {}) const;
  void supports(const DevicePointView& directions, std::uint64_t* out,
                const Options& options = {}) const;
  void signed_distances(const DevicePointView& points, double* out,
                        const Options& options = {}) const;

  /// The same with the answers left on the device: `out`, an item per point, is memory of the
  /// points' device, aligned to its items, that does not overlap the points (device_memory() makes
  /// such). What the CPU answers is copied there. All answers are written when the call returns.
  /// After an exception the contents of `out` are unspecified.
  void contains_on_device(const DevicePointView& points, std::uint8_t* out,
                          const Options& options = {}) const;
  void sides_on_device(const DevicePointView& points, Side* out, const Options& options = {}) const;
  void supports_on_device(const DevicePointView& directions, std::uint64_t* out,
                          const Options& options = {}) const;
  void signed_distances_on_device(const DevicePointView& points, double* out,
                                  const Options& options = {}) const;

 private:
  struct [[gnu::visibility("hidden")]] State;
  std::unique_ptr<State> state_;
};

}  // namespace cullhull
#pragma GCC visibility pop
