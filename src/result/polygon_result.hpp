// The complete result of a polygon. In the plane the cycle of corners determines everything:
// simplex i, in canonical order, is the edge from the i-th corner by id to the one before it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "cullhull/hull.hpp"
#include "hull/plane/polygon.hpp"
#include "parallel/control.hpp"
#include "result/measure_frame.hpp"
#include "result/totals.hpp"

namespace cullhull::internal {

struct PlanarPoint {
  double x, y;
};

/// What one edge adds to the sums over a run.
struct EdgeShare {
  double volume = 0, area = 0;
  double moment[2] = {0, 0};
  double error = 0;  // of volume and, times the reach, of area; see Totals

  void add(const EdgeShare& o) {
    volume = volume + o.volume;
    area = area + o.area;
    for (unsigned c = 0; c < 2; ++c) moment[c] = moment[c] + o.moment[c];
    error += o.error;
  }
  /// Sums: as Totals.
  template <class Sums>
  void add_to(Sums& t) const {
    t.volume = t.volume + DoubleDouble(volume);
    t.area = t.area + DoubleDouble(area);
    for (unsigned c = 0; c < 2; ++c) t.moment[c] = t.moment[c] + DoubleDouble(moment[c]);
    t.error += error;
    t.area_error += area;
  }
};

/// As Totals<DoubleDouble>(2), without memory of its own.
struct PolygonSums {
  DoubleDouble volume = 0, area = 0, moment[2];
  double error = 0, area_error = 0;

  void add(const PolygonSums& o) {
    volume = volume + o.volume;
    area = area + o.area;
    for (unsigned c = 0; c < 2; ++c) moment[c] = moment[c] + o.moment[c];
    error += o.error;
    area_error += o.area_error;
  }
};

struct PlanarMeasures {
  double volume = 0, area = 0, centroid[2] = {};
};

/// Planes and sums of a polygon's edges, bit for bit as the general way computes them
/// (triangle_sweep, simplicial_nd, measure.cpp), where coordinates are of ordinary proportions.
class EdgeKernel {
 public:
  /// `box`: of the corners, which is that of all points.
  explicit EdgeKernel(const Box& box);

  /// False: too many powers of two for scaled doubles.
  bool ordinary() const { return ordinary_; }
  int exponent() const { return exponent_; }

  PlanarPoint scaled(PlanarPoint p) const {
    return exponent_ == 0 ? p : PlanarPoint{scale_by(p.x, -exponent_), scale_by(p.y, -exponent_)};
  }
  /// The edge from p to the corner before it, q; o is the corner with the lowest id; all scaled.
  /// The plane goes to out[0 .. 3). False if the edge is too short for doubles.
  bool edge(PlanarPoint p, PlanarPoint q, PlanarPoint o, double* out, EdgeShare& share) const {
    const double n[2] = {-(q.y - p.y), q.x - p.x};
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1]);
    const double largest = std::max(std::fabs(n[0]), std::fabs(n[1]));
    const double step[2] = {p.x - o.x, p.y - o.y};
    share.area = length;
    share.volume = (0.0 + n[0] * step[0]) + n[1] * step[1];
    share.error = length * std::max(std::fabs(step[0]), std::fabs(step[1]));
    share.moment[0] = share.volume * ((0.0 + step[0]) + (q.x - o.x));
    share.moment[1] = share.volume * ((0.0 + step[1]) + (q.y - o.y));
    out[0] = n[0] / length;
    out[1] = n[1] / length;
    out[2] = ((0.0 - out[0] * p.x) - out[1] * p.y) * unscale_;
    return largest > 0x1p-400;
  }

 private:
  int exponent_ = 0;
  double unscale_ = 1;
  bool ordinary_ = false;
};

/// Measures from the sums; `first`: the corner with the lowest id, as given. False if rounding
/// could show (a thin polygon): the general way knows what to do then.
bool finish_polygon(const EdgeKernel& kernel, const PolygonSums& sums, const PointView& points,
                    std::uint64_t first, PlanarMeasures& measures);

/// Everything of `hull` but its statistics, from three corners or more. `ids`: the point of each
/// row, ascending; nullptr: the same. False, and nothing done, where build_hull must.
bool write_polygon(const PointView& points, const std::uint64_t* ids, const Polygon& polygon,
                   const Control& control, unsigned threads, Hull& hull);

}  // namespace cullhull::internal
