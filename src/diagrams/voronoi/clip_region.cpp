#include "diagrams/voronoi/clip_region.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "cullhull/constrained.hpp"
#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "exact/orientation/orientation.hpp"
#include "geometry/gather.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

template <unsigned D>
RegionPlane<D> plane_through(const std::array<std::array<double, D>, D>& points) {
  RegionPlane<D> plane;
  plane.through = points;
  for (unsigned j = 0; j < D && plane.axis < 0 && D > 1; ++j)
    if (std::all_of(points.begin(), points.end(),
                    [&](const auto& x) { return x[j] == points[0][j]; }))
      plane.axis = static_cast<int>(j);
  if (plane.axis >= 0) {
    // The sign of the normal's only nonzero coordinate, from the other coordinates of the points.
    const auto k = static_cast<unsigned>(plane.axis + 1) % D;
    if constexpr (D == 2) {
      const bool ascends = points[1][k] > points[0][k];
      plane.toward = ascends == (k == 1) ? 1 : -1;
    } else if constexpr (D == 3) {
      const unsigned l = (k + 1) % 3;
      double rows[3][2];
      const double* corners[3];
      for (unsigned i = 0; i < 3; ++i) {
        rows[i][0] = points[i][k];
        rows[i][1] = points[i][l];
        corners[i] = rows[i];
      }
      plane.toward = orientation(2, corners) == Sign::positive ? 1 : -1;
    }
  }
  plane.normal = normal_of<D, BoundedDoubleDouble>(plane);
  return plane;
}

RegionPlane<1> end_at(double x, double toward) {
  RegionPlane<1> plane;
  plane.through = {{{x}}};
  plane.axis = 0;
  plane.toward = toward;
  plane.normal = normal_of<1, BoundedDoubleDouble>(plane);
  return plane;
}

RegionPiece<1> interval(double low, double high) {
  RegionPiece<1> piece;
  piece.corners = {{low}, {high}};
  piece.planes = {end_at(low, -1), end_at(high, 1)};
  piece.across.assign(2, no_index);
  return piece;
}

/// Computes the planes of a piece from its corners and faces.
template <unsigned D>
void add_planes(RegionPiece<D>& piece) {
  const std::size_t n = D == 2 ? piece.corners.size() : piece.faces.size();
  for (std::size_t i = 0; i < n; ++i) {
    std::array<std::array<double, D>, D> through;
    for (unsigned k = 0; k < D; ++k)
      through[k] = piece.corners[D == 2 ? (i + k) % n : piece.faces[i][k]];
    piece.planes.push_back(plane_through<D>(through));
  }
  piece.across.assign(n, no_index);
}

/// Corners (without the last one of a ring if it repeats the first), and edges between them.
struct Outline {
  std::vector<double> corners;
  std::vector<std::uint32_t> edges;

  std::size_t size() const { return corners.size() / 2; }
  const double* at(std::uint32_t i) const { return corners.data() + 2 * std::size_t{i}; }
  PointView view() const { return PointView::row_major(corners.data(), size(), 2); }
};

Outline outline_of(const PointView& corners, std::span<const std::uint64_t> offsets) {
  if (corners.dimension != 2)
    refuse("a polygon has corners in dimension 2, not in ", corners.dimension);
  require_points(corners);
  if (offsets.empty() || offsets.front() != 0 || offsets.back() != corners.count ||
      !std::is_sorted(offsets.begin(), offsets.end()))
    refuse("the rings' offsets do not ascend from 0 to the number of corners");
  Outline out;
  for (std::size_t r = 0; r + 1 < offsets.size(); ++r) {
    const std::uint64_t begin = offsets[r];
    std::uint64_t end = offsets[r + 1];
    const auto repeats = [&](std::uint64_t a, std::uint64_t b) {
      return corners.at(a, 0) == corners.at(b, 0) && corners.at(a, 1) == corners.at(b, 1);
    };
    while (end > begin + 1 && repeats(begin, end - 1)) --end;
    if (end - begin < 3)
      refuse("ring ", r, " of the polygon has ", end - begin, " corners; three are needed");
    const auto first = static_cast<std::uint32_t>(out.size());
    for (std::uint64_t i = begin; i < end; ++i) {
      for (unsigned j = 0; j < 2; ++j) out.corners.push_back(corners.at(i, j));
      const auto place = first + static_cast<std::uint32_t>(i - begin);
      out.edges.push_back(place);
      out.edges.push_back(i + 1 < end ? place + 1 : first);
    }
  }
  return out;
}

/// Removes edges that occur an even number of times: polygons share them, so they are not part of
/// the boundary.
void drop_shared_edges(Outline& outline) {
  std::vector<std::uint32_t> order(outline.size()), place(outline.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t i) { return std::pair(outline.at(i)[0], outline.at(i)[1]); };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    place[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? place[order[i - 1]] : order[i];
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t e = 0; e < outline.edges.size(); e += 2) {
    const std::uint32_t a = place[outline.edges[e]], b = place[outline.edges[e + 1]];
    edges.emplace_back(std::min(a, b), std::max(a, b));
  }
  std::sort(edges.begin(), edges.end());
  outline.edges.clear();
  for (std::size_t i = 0, next = 0; i < edges.size(); i = next) {
    while (next < edges.size() && edges[next] == edges[i]) ++next;
    if ((next - i) % 2 == 0) continue;
    outline.edges.push_back(edges[i].first);
    outline.edges.push_back(edges[i].second);
  }
}

/// Whether the outline is one convex ring, in either orientation: it turns the same way at every
/// corner, and once around.
bool convex_ring(const Outline& outline, const Hull& hull) {
  if (hull.vertices.size() != outline.size()) return false;
  // A hull's vertices are counterclockwise from the lowest id.
  const std::size_t n = outline.size();
  const auto in_order = [&](bool forward) {
    for (std::size_t i = 0; i < n; ++i)
      if (hull.vertices[i] != (forward ? i : (n - i) % n)) return false;
    return true;
  };
  return in_order(true) || in_order(false);
}

Region<2> triangles_of(const Outline& outline, const Triangulation& t) {
  Region<2> region(t.size());
  for (std::uint32_t c = 0; c < t.size(); ++c) {
    for (const std::uint32_t v : t.cell(c))
      region[c].corners.push_back({outline.at(v)[0], outline.at(v)[1]});
    add_planes<2>(region[c]);
    // Plane i contains the edge from corner i to the next, opposite to the corner after that.
    for (unsigned i = 0; i < 3; ++i) {
      const std::uint32_t o = t.neighbours_of(c)[(i + 2) % 3];
      region[c].across[i] = o == no_index ? no_index : o;
    }
  }
  return region;
}

}  // namespace

template <unsigned D>
Region<D> box_region(std::span<const double> low, std::span<const double> high) {
  if constexpr (D == 1) return {interval(low[0], high[0])};
  RegionPiece<D> piece;
  for (unsigned i = 0; i < 1U << D; ++i) {
    const unsigned corner = D == 2 ? (i ^ i >> 1) : i;  // in cyclic order
    std::array<double, D> x;
    for (unsigned j = 0; j < D; ++j) x[j] = (corner >> j & 1U) != 0 ? high[j] : low[j];
    piece.corners.push_back(x);
  }
  if (D == 3)
    piece.faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                   {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  if constexpr (D > 1) add_planes<D>(piece);
  return {piece};
}

template <unsigned D>
Region<D> hull_region(const PointView& points, const Run& run) {
  const Hull hull = convex_hull(points, run.options);
  if (hull.affine_dimension != static_cast<int>(D))
    refuse("the region spans dimension ", hull.affine_dimension, " only");
  std::vector<std::uint64_t> ids(hull.vertices.begin(), hull.vertices.end());
  if constexpr (D == 1) {
    const double a = points.at(ids[0], 0), b = points.at(ids[1], 0);
    return {interval(std::min(a, b), std::max(a, b))};
  } else {
    RegionPiece<D> piece;
    for (const std::uint64_t id : ids) {
      std::array<double, D> x;
      for (unsigned j = 0; j < D; ++j) x[j] = points.at(id, j);
      piece.corners.push_back(x);
    }
    for (std::uint64_t f = 0; f < hull.facet_count(); ++f) {
      piece.faces.emplace_back();
      for (const std::uint64_t id : hull.facets[f])
        piece.faces.back().push_back(
            static_cast<std::uint32_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin()));
    }
    add_planes<D>(piece);
    return {piece};
  }
}

template Region<1> box_region<1>(std::span<const double>, std::span<const double>);
template Region<2> box_region<2>(std::span<const double>, std::span<const double>);
template Region<3> box_region<3>(std::span<const double>, std::span<const double>);
template Region<1> hull_region<1>(const PointView&, const Run&);
template Region<3> hull_region<3>(const PointView&, const Run&);

Region<2> polygon_region(const PointView& corners, std::span<const std::uint64_t> ring_offsets,
                         const Run& run) {
  // Every cell is cut by all planes of a piece; if there are more, triangles take less work.
  constexpr std::size_t few = 8;
  Outline outline = outline_of(corners, ring_offsets);
  const Hull hull = convex_hull(outline.view(), run.options);
  if (hull.affine_dimension != 2)
    refuse("the region spans dimension ", hull.affine_dimension, " only");
  if (ring_offsets.size() == 2 && outline.size() <= few && convex_ring(outline, hull)) {
    RegionPiece<2> piece;
    for (const std::uint64_t i : hull.vertices)
      piece.corners.push_back({outline.at(static_cast<std::uint32_t>(i))[0],
                               outline.at(static_cast<std::uint32_t>(i))[1]});
    add_planes<2>(piece);
    return {piece};
  }
  drop_shared_edges(outline);
  auto options = options_as<ConstrainedOptions>(run.options);
  options.inside_only = true;
  const auto found = [&] {
    try {
      return constrained_delaunay(outline.view(), outline.edges, options);
    } catch (const Error& e) {
      if (e.code() != ErrorCode::invalid_argument) throw;
      refuse("the boundary of the polygon crosses itself: ", e.what());
    }
  }();
  if (found.triangulation.size() == 0)
    refuse("the polygon has no inside: its edges are there an even number of times");
  return triangles_of(outline, found.triangulation);
}

}  // namespace cullhull::internal
