// The complete result of a hull in the plane, from its polygon. The cycle of corners determines
// everything: in canonical order simplex i is the edge from the corner with the i-th lowest id to
// the corner before it on the polygon.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "cullhull/hull_fwd.hpp"
#include "hull/plane/polygon.hpp"
#include "result/facets/facet_share.hpp"
#include "result/measures/measure_frame.hpp"
#include "result/measures/totals.hpp"

namespace cullhull::internal {

struct PlanarPoint {
  double x, y;
};

/// The measures of a polygon.
struct PlanarMeasures {
  double volume = 0, area = 0, centroid[2] = {};
};

/// Computes planes and shares of a polygon's edges, with the same bits as the general code
/// (measure.cpp), if the coordinates need no special scaling.
class EdgeKernel {
 public:
  /// `box`: the bounding box of the corners, which is also that of all points.
  explicit EdgeKernel(const Box& box);

  /// False if the coordinates span too many powers of two for scaled doubles. The
  /// general code is then needed.
  bool ordinary() const { return ordinary_; }
  int exponent() const { return exponent_; }

  PlanarPoint scaled(PlanarPoint p) const {
    return exponent_ == 0 ? p : PlanarPoint{scale_by(p.x, -exponent_), scale_by(p.y, -exponent_)};
  }
  /// Computes plane and share of the edge from corner p to the corner q before it; o is the corner
  /// with the lowest id; all three are scaled. Writes the plane to out[0 .. 3). Returns false if
  /// the edge is too short for doubles.
  bool edge(PlanarPoint p, PlanarPoint q, PlanarPoint o, double* out, Share<2>& share) const {
    const double corner[2][2] = {{p.x, p.y}, {q.x, q.y}}, origin[2] = {o.x, o.y};
    double plane[3];
    const bool plain = plain_facet<2>(corner, origin, unscale_, plane, share);
    std::copy_n(plane, 3, out);
    return plain;
  }

 private:
  int exponent_ = 0;
  double unscale_ = 1;
  bool ordinary_ = false;
};

/// Computes the measures from the sums. `first`: the id of the corner with the lowest id. Returns
/// false if rounding could show in the measures (a thin polygon): the general code is then needed.
bool finish_polygon(const EdgeKernel& kernel, const Share<2, DoubleDouble>& sums,
                    const PointView& points, std::uint64_t first, PlanarMeasures& measures);

/// Fills the lists and measures of `hull` from a polygon of at least three corners. `ids`: the id
/// of each row's point, ascending; nullptr: the id is the row. Returns false if build_hull is
/// needed.
bool write_polygon(const PointView& points, const std::uint64_t* ids, const Polygon& polygon,
                   const Run& run, Hull& hull);

}  // namespace cullhull::internal
