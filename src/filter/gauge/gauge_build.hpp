// How a GaugeMap is built: from a polytope to its table and cones, and the test before the map's
// own, the core, that decides most points at a lower cost.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "filter/gauge/gauge_map.hpp"
#include "filter/gauge/gauge_table.hpp"

namespace cullhull::internal {

/// A polytope and the cones over its facets, for testing single points.
class GaugeCones {
 public:
  virtual ~GaugeCones() = default;
  /// Returns true only if x (in the points' coordinates, exact doubles) is strictly inside. Thread
  /// safe.
  virtual bool inside(const double* x) const = 0;
};

/// Fills `table` and, if `settings` ask for them, `cones`; returns false if no useful map exists.
/// See GaugeMap::build.
bool build_gauge_table(InnerPolytope&& polytope, const GaugeSettings& settings, GaugeTable& table,
                       std::unique_ptr<GaugeCones>* cones);

/// GaugeMap::of_leaders: fills `table`; returns false if no useful map exists.
bool build_gauge_of_leaders(const Array<double>& rows, const GaugeTable& before,
                            const LeaderCells& cells, const Run& run, GaugeTable& table);

// Constants shared by all ways to build a GaugeMap's table: docs/exactness.md, "GaugeMap".

/// Returns the smallest float >= v.
inline float round_up(double v) {
  const auto f = static_cast<float>(v);
  return static_cast<double>(f) >= v ? f
                                     : std::nextafter(f, std::numeric_limits<float>::infinity());
}

// Example, 3D: L = 1.8 gives kappa = 1.8 (2 * 2^-19 + 3 * 2^-23) = 7.5e-6: every node is raised by
// that much, so that no point pays for it.

/// Returns a bound of what the kernel's roundings add to a gauge (G3), to be added to every node.
inline double gauge_allowance(unsigned d, double lipschitz) {
  return (1 + 0x1p-40) * lipschitz * ((d - 1) * 0x1p-19 + d * 0x1p-23);
}
/// The largest allowance of a useful map: only points with a bound below 1 are dropped, so a larger
/// one would drop hardly any.
inline constexpr double most_gauge_allowance = 0.25;

/// Sets all members but the nodes; `face` is the number of nodes per face. Dimension and cells must
/// be set.
inline void fill_gauge_constants(GaugeTable& t, const double* centre, const double* scale,
                                 std::uint64_t face) {
  const unsigned d = t.dimension;
  t.single_precision = true;
  for (unsigned j = 0; j < d; ++j) {
    t.scale[j] = scale[j];
    t.offset[j] = centre[j] * scale[j];
    t.scale_f32[j] = static_cast<float>(t.scale[j]);
    t.offset_f32[j] = static_cast<float>(t.offset[j]);
    t.single_precision = t.single_precision && t.scale[j] >= 0x1p-120 && t.scale[j] <= 0x1p120 &&
                         static_cast<double>(t.offset_f32[j]) == t.offset[j];
  }
  t.middle = static_cast<float>(t.cells) / 2;
  t.half_cells = t.middle * (1 - 0x1p-20F);
  std::uint64_t corners = 0, stride = 1;
  for (unsigned k = 0; k + 1 < d; ++k, stride *= t.cells + 1) {
    t.stride[k] = static_cast<float>(stride);
    corners += stride;
  }
  t.face_stride = static_cast<float>(face);
  t.last_corner = static_cast<std::uint32_t>(2 * d * face - 1 - corners);
  t.threshold = 1 - (static_cast<float>(d) + 6) * 0x1p-23F;
}

// A simple body inside the GaugeMap's pseudo-hull: a test without look-ups that decides most
// points.

/// A body inside the region that the map drops, symmetric to the axes of the map's frame: an
/// ellipsoid around the centre, or a box around it with cut edges and corners.
struct GaugeCore {
  enum class Kind {
    round,  ///< the sum of weight_j y_j^2 is below radius[0]
    cut     ///< with z_j = weight_j |y_j|: the largest z_j, the sum without the smallest, and the
            ///< sum of all are below radius[0], [1], [2]
  };
  static constexpr unsigned norms = 3;

  Kind kind = Kind::round;
  float weight[GaugeTable::max_dimension] = {};
  float radius[norms] = {};
};

/// Returns the body that contains most of `probes` (columns of `count` coordinates in the map's
/// frame), if it contains enough of them to save time. docs/exactness.md, G8, proves that the map
/// drops every point of the body. Does not depend on the number of threads.
std::optional<GaugeCore> make_core(const GaugeTable& table, const std::vector<float>& probes,
                                   std::uint32_t count, unsigned threads);

/// Building a core takes a fraction of a millisecond, and it saves up to a nanosecond per point:
/// with 2 million points it is worthwhile even if it saves half of that.
inline constexpr std::uint64_t worth_a_core = std::uint64_t{1} << 21;

/// Returns the core for a pass over `count` points, of which `points` are a part, where it is
/// worthwhile, judged by 512 of them.
std::optional<GaugeCore> core_for_pass(const GaugeTable& table, const PointView& points,
                                       std::uint64_t count, unsigned threads);

// The GaugeMap's table for a 3D polytope with few facets: every node is tested against all facet
// planes, which is faster than a walk from cone to cone.

/// The facets' planes in the frame of a table: the gauge of y is the largest q . y over all facets;
/// `slack` bounds the rounding for |y| <= 1.
struct GaugePlanes {
  std::vector<float> q[3], slack;  // padded to multiples of 16 by copies of the last plane
};

/// Computes the largest q . v + cells * slack over all planes, for each of `count` directions v
/// with integer coordinates up to `cells`.
void largest_gauges(const GaugePlanes& planes, unsigned cells, const float* x, const float* y,
                    const float* z, std::uint32_t count, float* gauges);

/// Fills `table` for a polytope of few facets in space, all of whose planes are asked for each node
/// (build_gauge_table walks over cones instead: other nodes, the same guarantee). `cells`: along
/// each edge of the cube of directions. The polytope must be an exact hull with its facets outward
/// oriented; only facets and vertices are read. Returns false, and leaves `table` undefined, if no
/// useful map exists.
bool build_gauge_by_planes(const InnerPolytope& polytope, unsigned cells, GaugeTable& table);

}  // namespace cullhull::internal
