// clip_voronoi(): each cell is the region cut by the halfspaces towards its neighbours.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "cells/clip_shapes.hpp"
#include "cells/dual.hpp"
#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/query.hpp"
#include "cullhull/voronoi.hpp"
#include "parallel/helpers.hpp"
#include "parallel/pages.hpp"

namespace cullhull {
namespace internal {
namespace {

/// A region in the caller's coordinates: in the plane vertices counterclockwise, in space vertices
/// and faces; on a line both ends.
struct Region {
  std::vector<double> vertices;
  std::vector<std::vector<std::uint32_t>> faces;
};

[[noreturn]] void refuse(const std::string& message) {
  throw Error(ErrorCode::invalid_argument, message);
}

std::string shown(double v) {
  char text[32];
  return {text, static_cast<std::size_t>(std::snprintf(text, sizeof text, "%.6g", v))};
}

void check_dimension(const Triangulation& t) {
  if (t.dimension == 0 || t.dimension > 3)
    refuse("cells are clipped in dimensions 1 to 3, not in " + std::to_string(t.dimension));
}

Region box_region(const Triangulation& t, std::span<const double> low,
                  std::span<const double> high) {
  const unsigned d = t.dimension;
  if (low.size() != d || high.size() != d)
    refuse("a box in dimension " + std::to_string(d) + " needs as many numbers for each corner");
  for (unsigned j = 0; j < d; ++j)
    if (!(low[j] < high[j]) || !std::isfinite(low[j]) || !std::isfinite(high[j]))
      refuse("the box is empty or not finite along axis " + std::to_string(j));
  Region r;
  for (unsigned i = 0; i < 1U << d; ++i) {
    const unsigned corner = d == 2 ? (i ^ i >> 1) : i;  // around
    for (unsigned j = 0; j < d; ++j)
      r.vertices.push_back((corner >> j & 1U) != 0 ? high[j] : low[j]);
  }
  if (d == 3)
    r.faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  return r;
}

/// A list of corners in the plane is a polygon to whoever passes it: one with dents is no convex
/// region.
void refuse_dents(const PointView& points, const Hull& hull, const Options& options) {
  std::vector<Side> sides(points.count);
  HullQuery(points, hull).sides(points, sides.data(), options);
  for (std::uint64_t i = 0; i < points.count; ++i)
    if (sides[i] == Side::inside)
      refuse("the region is not convex: its point " + std::to_string(i) +
             " lies inside the hull of the others; pass that hull's vertices if it is meant");
}

/// A hull lists its vertices around in the plane, and those of its facets in space.
Region hull_region(const Triangulation& t, const PointView& points, const Options& options) {
  const unsigned d = t.dimension;
  if (points.dimension != d)
    refuse("a region in dimension " + std::to_string(points.dimension) +
           " for a diagram in dimension " + std::to_string(d));
  const Hull hull = convex_hull(points, options);
  if (hull.affine_dimension != static_cast<int>(d))
    refuse("the region spans dimension " + std::to_string(hull.affine_dimension) + " only");
  if (d == 2) refuse_dents(points, hull, options);
  Region r;
  std::vector<std::uint64_t> ids(hull.vertices.begin(), hull.vertices.end());
  const auto place = [&](std::uint64_t id) {
    return static_cast<std::uint32_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
  };
  for (const std::uint64_t id : ids)
    for (unsigned j = 0; j < d; ++j) r.vertices.push_back(points.at(id, j));
  if (d == 1) std::sort(r.vertices.begin(), r.vertices.end());
  for (std::uint64_t f = 0; d == 3 && f < hull.facet_count(); ++f) {
    r.faces.emplace_back();
    for (const std::uint64_t id : hull.facets[f]) r.faces.back().push_back(place(id));
  }
  return r;
}

/// The halfspace of the points, relative to p, that are at least as near to p as to q; with a
/// normal whose largest component is 1. The other one for the furthest site.
template <unsigned D>
CutPlane<D> towards(const double* p, const double* q, double heavier, bool furthest,
                    std::uint32_t owner) {
  CutPlane<D> plane{{}, 0, owner};
  double unit = 1, largest = 0;
  for (unsigned j = 0; j < D; ++j) {
    plane.normal[j] = q[j] - p[j];
    largest = std::max(largest, std::abs(plane.normal[j]));
  }
  if (!std::isfinite(largest)) {
    largest = 0;
    unit = 2;
    for (unsigned j = 0; j < D; ++j) {
      plane.normal[j] = q[j] * 0.5 - p[j] * 0.5;
      largest = std::max(largest, std::abs(plane.normal[j]));
    }
  }
  double squares = 0;
  for (double& n : plane.normal) {
    n /= largest;
    squares += n * n;
  }
  plane.offset = largest * (squares / 2) * unit + heavier / 2 / largest / unit;
  if (furthest) {
    for (double& n : plane.normal) n = -n;
    plane.offset = -plane.offset;
  }
  return plane;
}

/// What a chunk of points makes.
struct Part {
  std::vector<double> vertices;
  std::vector<std::uint64_t> vertex_counts, face_counts;
  std::vector<std::uint32_t> face_sizes, face_vertices, neighbours;
};

template <unsigned D>
std::array<double, D> relative(const double* v, const double* p) {
  std::array<double, D> r;
  for (unsigned j = 0; j < D; ++j) r[j] = v[j] - p[j];
  return r;
}

/// The region as a shape around p.
void start_shape(const Region& region, const double* p, ClipPolygon& shape) {
  shape.vertices.clear();
  for (std::size_t i = 0; i < region.vertices.size(); i += 2)
    shape.vertices.push_back(relative<2>(region.vertices.data() + i, p));
  shape.owners.assign(shape.vertices.size(), no_point);
}
void start_shape(const Region& region, const double* p, ClipPolyhedron& shape) {
  shape.vertices.clear();
  for (std::size_t i = 0; i < region.vertices.size(); i += 3)
    shape.vertices.push_back(relative<3>(region.vertices.data() + i, p));
  shape.starts.assign(1, 0);
  shape.items.clear();
  shape.owners.clear();
  for (const auto& face : region.faces) shape.add_face(face, no_point);
}

void add_faces(const ClipPolygon& shape, Part& part) {
  part.neighbours.insert(part.neighbours.end(), shape.owners.begin(), shape.owners.end());
}
void add_faces(const ClipPolyhedron& shape, Part& part) {
  part.neighbours.insert(part.neighbours.end(), shape.owners.begin(), shape.owners.end());
  part.face_vertices.insert(part.face_vertices.end(), shape.items.begin(), shape.items.end());
  part.face_counts.push_back(shape.owners.size());
  for (std::size_t f = 0; f < shape.owners.size(); ++f)
    part.face_sizes.push_back(shape.starts[f + 1] - shape.starts[f]);
}

/// On a line a cell is the greatest lower and the least upper bound.
struct ClipInterval {
  std::vector<std::array<double, 1>> vertices;
  std::vector<std::uint32_t> owners;

  bool empty() const { return vertices.empty(); }
  void cut(const CutPlane<1>& plane) {
    if (empty()) return;
    const double bound = plane.offset / plane.normal[0];
    const bool upper = plane.normal[0] > 0;
    const unsigned end = upper ? 1 : 0;
    if (upper ? bound < vertices[1][0] : bound > vertices[0][0]) {
      vertices[end][0] = bound;
      owners[end] = plane.owner;
      if (!(vertices[0][0] < vertices[1][0])) vertices.clear(), owners.clear();
    }
  }
  double measure() const { return empty() ? 0 : vertices[1][0] - vertices[0][0]; }
};
void start_shape(const Region& region, const double* p, ClipInterval& shape) {
  shape.vertices = {relative<1>(region.vertices.data(), p),
                    relative<1>(region.vertices.data() + 1, p)};
  shape.owners.assign(2, no_point);
}
void add_faces(const ClipInterval& shape, Part& part) {
  part.neighbours.insert(part.neighbours.end(), shape.owners.begin(), shape.owners.end());
}

template <unsigned D, class Shape>
class Clipper {
 public:
  Clipper(const DualPoints& points, const Triangulation& t, const PointNeighbours& neighbours,
          const Region& region)
      : points_(points), t_(t), neighbours_(neighbours), region_(region) {}

  /// The cell of point v; its measure.
  double clip(std::uint32_t v) {
    const double* p = points_.row(v);
    planes_.clear();
    for (const std::uint32_t q : neighbours_.of(v)) {
      const double* r = points_.row(q);
      const double heavier = points_.weighted() ? p[D] - r[D] : 0;
      planes_.push_back(towards<D>(p, r, heavier, t_.furthest_site, q));
    }
    // Near ones first leave little for the others to do.
    std::stable_sort(planes_.begin(), planes_.end(),
                     [](const auto& a, const auto& b) { return a.offset < b.offset; });
    start_shape(region_, p, shape_);
    for (const auto& plane : planes_) {
      shape_.cut(plane);
      if (shape_.empty()) break;
    }
    return shape_.measure();
  }

  void add_shape(std::uint32_t v, Part& part) const {
    const double* p = points_.row(v);
    for (const auto& x : shape_.vertices)
      for (unsigned j = 0; j < D; ++j) part.vertices.push_back(p[j] + x[j]);
    part.vertex_counts.push_back(shape_.vertices.size());
    add_faces(shape_, part);
  }
  void add_nothing(Part& part) const {
    part.vertex_counts.push_back(0);
    if (D == 3) part.face_counts.push_back(0);
  }

 private:
  const DualPoints& points_;
  const Triangulation& t_;
  const PointNeighbours& neighbours_;
  const Region& region_;
  std::vector<CutPlane<D>> planes_;
  Shape shape_;
};

template <class T, class U>
void append(Array<T>& to, const std::vector<U>& from) {
  to.insert(to.end(), from.begin(), from.end());
}
template <class U>
void append_sums(Array<std::uint64_t>& to, const std::vector<U>& counts) {
  for (const U n : counts) to.push_back(to.back() + n);
}

void join(std::vector<Part>& parts, ClippedCells& out) {
  out.vertex_offsets.assign(1, 0);
  if (out.dimension == 3) {
    out.face_offsets.assign(1, 0);
    out.face_starts.assign(1, 0);
  }
  for (Part& part : parts) {
    append(out.vertices, part.vertices);
    append(out.face_vertices, part.face_vertices);
    append(out.neighbours, part.neighbours);
    append_sums(out.vertex_offsets, part.vertex_counts);
    append_sums(out.face_offsets, part.face_counts);
    append_sums(out.face_starts, part.face_sizes);
    part = {};
  }
}

/// The cells add up to the region. Where they do not, points and region are too far apart, or too
/// far from the origin, for shapes in doubles: an error, and no wrong measures.
template <class Shape>
void check_sum(const Region& region, const Array<double>& measures) {
  constexpr double share = 1e-6;  // far above what roundings cost, far below what a lost cell does
  Shape whole;
  start_shape(region, region.vertices.data(), whole);
  double sum = 0;
  for (const double m : measures) sum += m;
  const double wanted = whole.measure();
  if (std::isinf(sum) && std::isinf(wanted)) return;  // beyond the doubles, and said so
  if (!(std::abs(sum - wanted) <= share * wanted))
    refuse("the cells cannot be clipped in doubles: they add up to " + shown(sum) +
           ", and the region is " + shown(wanted) + "; move or scale points and region");
}

template <unsigned D, class Shape>
void clip_all(const DualPoints& points, const Triangulation& t, const Region& region, bool shapes,
              ClippedCells& out, const Run& run) {
  const PointNeighbours neighbours(t, run);
  std::vector<bool> vertex(t.point_count);
  for (const std::uint32_t v : t.cells) vertex[v] = true;
  constexpr std::uint64_t grain = 512;  // cells; some hundred us of clipping, not tuned
  std::vector<Part> parts(chunk_count(t.point_count, grain));
  run.each_chunk(t.point_count, grain,
                 [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
                   Clipper<D, Shape> clipper(points, t, neighbours, region);
                   for (std::uint64_t v = begin; v < end; ++v) {
                     out.measures[v] = vertex[v] ? clipper.clip(static_cast<std::uint32_t>(v)) : 0;
                     if (!shapes) continue;
                     if (vertex[v])
                       clipper.add_shape(static_cast<std::uint32_t>(v), parts[chunk]);
                     else
                       clipper.add_nothing(parts[chunk]);
                   }
                 });
  if (shapes) join(parts, out);
  if (!t.cells.empty()) check_sum<Shape>(region, out.measures);
}

ClippedCells clip(const PointView& points, const Triangulation& t, const Region& region,
                  std::span<const double> weights, bool shapes, const Run& run) {
  const std::uint64_t d = t.dimension;
  require_budget(run.budget,
                 t.point_count * 8 * (d + 4) + t.cells.size() * 8 * d +
                     (shapes ? t.point_count * (d == 3 ? 2000 : 150) : 0),
                 "the cells of the diagram");
  ClippedCells out;
  out.dimension = t.dimension;
  out.point_count = t.point_count;
  out.measures.resize(t.point_count);
  const DualPoints rows(points, t, weights, run);
  if (d == 1)
    clip_all<1, ClipInterval>(rows, t, region, shapes, out, run);
  else if (d == 2)
    clip_all<2, ClipPolygon>(rows, t, region, shapes, out, run);
  else
    clip_all<3, ClipPolyhedron>(rows, t, region, shapes, out, run);
  run.report("done", 1);
  return out;
}

}  // namespace
}  // namespace internal

ClippedCells clip_voronoi(const PointView& points, const Triangulation& triangulation,
                          std::span<const double> low, std::span<const double> high,
                          std::span<const double> weights, bool shapes, const Options& options) {
  using namespace internal;
  const Run run(options);
  const CallScope call;
  const PageScope pages;
  check_dimension(triangulation);
  return clip(points, triangulation, box_region(triangulation, low, high), weights, shapes, run);
}

ClippedCells clip_voronoi(const PointView& points, const Triangulation& triangulation,
                          const PointView& region, std::span<const double> weights, bool shapes,
                          const Options& options) {
  using namespace internal;
  const Run run(options);
  const CallScope call;
  const PageScope pages;
  check_dimension(triangulation);
  return clip(points, triangulation, hull_region(triangulation, region, options), weights, shapes,
              run);
}

}  // namespace cullhull
