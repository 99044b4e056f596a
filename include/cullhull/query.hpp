// Questions to a finished hull: is a point in it, how far is it, what does it see, where does a ray
// pass, which vertex is extreme in a direction.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "cullhull/device_points.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull::inline v1 {

/// Where a point lies; for a flat hull, within its flat (off the flat is outside).
enum class Side : std::int8_t { inside = -1, boundary = 0, outside = 1 };

/// Where the line origin + t direction, t real, passes through the hull.
struct RayHit {
  static constexpr std::uint32_t no_facet = 0xFFFFFFFF;
  bool hit = false;
  double enter = 0, exit = 0;  ///< parameters t, enter <= exit; negative ones lie behind the origin
  std::uint32_t enter_facet = no_facet, exit_facet = no_facet;
};

struct NearestFacet {
  std::uint32_t facet = 0;
  /// Euclidean distance to the boundary, negative for points of the hull.
  double distance = 0;
};

/// A hull prepared for questions. Answers about sides, visibility and support are exact; distances
/// and ray parameters are doubles with a relative error of about 2^-40 of the hull's extent.
///
/// Construction takes O(facets d^3 + simplices) time and memory and copies what it needs: neither
/// the points nor the hull must outlive it. All members are const and thread safe. Points asked
/// about are d = hull.dimension finite doubles; a NaN or an infinity is Error{not_finite} (naming
/// the first index in the batched forms). An empty hull is Error{invalid_argument}.
///
/// A query walks over neighbouring facets (or vertices) from a start near the answer: a few facets
/// for d = 3, in general a linear program on the dual, where a local maximum is global. d > 8, and
/// hulls too thin for doubles to have a point inside, look at every facet instead.
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

  Side side(const double* point) const;
  bool contains(const double* point) const { return side(point) != Side::outside; }

  /// Facets (indices, ascending) that the point is strictly above (they are visible from it). None
  /// for a point of the hull, and none for a point off the flat of a flat hull.
  std::vector<std::uint32_t> visible_facets(const double* point) const;

  /// The vertex id with the largest scalar product with `direction`, exactly; of several, the
  /// lowest id. Finite directions only; the zero vector gives the lowest id.
  std::uint64_t support(const double* direction) const;

  /// Euclidean distance to the hull, 0 on the boundary, and for points inside minus the distance to
  /// the boundary (for a flat hull: the boundary within its flat).
  double signed_distance(const double* point) const { return nearest_facet(point).distance; }
  /// The facet on which a nearest point of the boundary lies; of several, any one.
  NearestFacet nearest_facet(const double* point) const;

  /// For full-dimensional hulls (else Error{invalid_argument}). A zero direction is an
  /// Error{invalid_argument}. Touching lines within rounding may be reported either way.
  RayHit ray(const double* origin, const double* direction) const;

  /// The same for many: `out` holds one item a point. Dimensions must agree. In parallel over
  /// options.threads, with options.stop and options.progress. contains() and sides() first test a
  /// gauge map of the hull, which decides most inner points at the speed of memory.
  void contains(const PointView& points, std::uint8_t* out, const Options& options = {}) const;
  void sides(const PointView& points, Side* out, const Options& options = {}) const;
  void supports(const PointView& directions, std::uint64_t* out, const Options& options = {}) const;
  void nearest_facets(const PointView& points, NearestFacet* out,
                      const Options& options = {}) const;
  void signed_distances(const PointView& points, double* out, const Options& options = {}) const;
  void rays(const PointView& origins, const PointView& directions, RayHit* out,
            const Options& options = {}) const;

  /// The same answers about points in a CUDA device's memory; `out` is in the host's. Hulls of full
  /// dimension from 2 to 6 are asked on the device; the points that arithmetic in doubles leaves
  /// open are copied and asked here, with signed_distances all that are not inside. All points are
  /// with Backend::cpu, for other hulls, and, unless Backend::cuda was given, where the device's
  /// memory is full. Throws Error{backend_unavailable} without a device, Error{out_of_budget},
  /// Error{invalid_argument} for memory or scalars it does not take.
  void contains(const DevicePointView& points, std::uint8_t* out,
                const Options& options = {}) const;
  void sides(const DevicePointView& points, Side* out, const Options& options = {}) const;
  void supports(const DevicePointView& directions, std::uint64_t* out,
                const Options& options = {}) const;
  void signed_distances(const DevicePointView& points, double* out,
                        const Options& options = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
