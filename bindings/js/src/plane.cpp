// The module of the plane. Points are packed pairs of doubles; what the parts of a result mean says
// plane.js.
#include <algorithm>
#include <array>
#include <vector>

#include "cullhull/alpha_shape.hpp"
#include "cullhull/constrained.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/triangulation.hpp"
#include "cullhull/voronoi.hpp"
#include "module.hpp"

using namespace cullhull;      // NOLINT: a program's only functions
using namespace cullhull::js;  // NOLINT

namespace {

using Ids = Array<std::uint32_t>;

PointView view(const double* points, std::uint32_t count) {
  return PointView::row_major(points, count, 2);
}

/// delaunator's arrays: half-edges 3 t to 3 t + 2 run around triangle t clockwise, as seen with y
/// upwards; `halfedges` has the opposite of each, or no_index (-1).
struct Mesh {
  Ids triangles, halfedges, hull;
};

Mesh mesh_of(const Triangulation& t) {
  Mesh mesh;
  if (t.affine_dimension < 2) return mesh;
  const auto size = static_cast<std::size_t>(3 * t.size());
  mesh.triangles.resize(size);
  mesh.halfedges.resize(size);
  // Cell [a, b, c] becomes the triangle [a, c, b], whose half-edges are opposite to b, a and c.
  constexpr unsigned corner[] = {0, 2, 1}, opposite[] = {1, 0, 2};
  for (std::size_t first = 0; first < size; first += 3)
    for (unsigned j = 0; j < 3; ++j) {
      mesh.triangles[first + j] = t.cells[first + corner[j]];
      const std::uint32_t cell = t.neighbours[first + opposite[j]];
      if (cell == no_index) {
        mesh.halfedges[first + j] = no_index;
        continue;
      }
      unsigned back = 0;
      while (t.neighbours[3 * std::size_t{cell} + opposite[back]] != first / 3) ++back;
      mesh.halfedges[first + j] = 3 * cell + back;
    }
  return mesh;
}

/// The ring of edges, from its lowest id on; `from` tells which end of an edge comes first.
Ids ring_of(const Ids& edges, unsigned from, std::uint32_t points) {
  Ids ring(edges.size() / 2);
  if (ring.empty()) return ring;
  std::vector<std::uint32_t> next(points);
  for (std::size_t i = 0; i < edges.size(); i += 2) next[edges[i + from]] = edges[i + 1 - from];
  std::uint32_t at = *std::min_element(edges.begin(), edges.end());
  for (std::uint32_t& id : ring) at = next[id = at];
  return ring;
}

/// All different points of a line in their order, the lower end first.
Ids along_line(const Triangulation& t) {
  if (t.affine_dimension < 1) return t.cells;
  const std::uint32_t first = std::min(t.hull_facets[0], t.hull_facets[1]);
  std::uint32_t cell = t.hull_facets[0] == first ? t.hull_cells[0] : t.hull_cells[1];
  Ids line(static_cast<std::size_t>(t.size()) + 1);
  line[0] = first;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const std::size_t at = 2 * std::size_t{cell};
    const unsigned here = t.cells[at] == line[i - 1] ? 0 : 1;
    line[i] = t.cells[at + 1 - here];
    cell = t.neighbours[at + here];
  }
  return line;
}

}  // namespace

extern "C" {

int cullhull_hull(const double* points, std::uint32_t count) {
  return guarded([&] {
    const Hull hull = convex_hull(view(points, count));
    struct Result {
      Ids vertices;
      std::array<double, 2> measures;
    };
    const auto& r =
        keep(Result{Ids(hull.vertices.begin(), hull.vertices.end()), {hull.volume, hull.area}});
    hand_out(r.vertices, r.measures);
  });
}

int cullhull_delaunay(const double* points, std::uint32_t count) {
  return guarded([&] {
    const Triangulation t = delaunay(view(points, count));
    Mesh mesh = mesh_of(t);
    mesh.hull = t.affine_dimension < 2 ? along_line(t) : ring_of(t.hull_facets, 1, count);
    const Mesh& m = keep(std::move(mesh));
    hand_out(m.triangles, m.halfedges, m.hull);
  });
}

int cullhull_constrained(const double* points, std::uint32_t count, const std::uint32_t* edges,
                         std::uint32_t ids, int inside_only) {
  return guarded([&] {
    ConstrainedOptions options;
    options.inside_only = inside_only != 0;
    ConstrainedTriangulation t = constrained_delaunay(view(points, count), {edges, ids}, options);
    Mesh mesh = mesh_of(t.triangulation);
    mesh.hull = std::move(t.pieces);
    const Mesh& m = keep(std::move(mesh));
    hand_out(m.triangles, m.halfedges, m.hull);
  });
}

int cullhull_concave(const double* points, std::uint32_t count, double number, int is_ratio) {
  return guarded([&] {
    const PointView p = view(points, count);
    const Triangulation t = delaunay(p);
    const AlphaShape shape =
        concave_hull(p, t, is_ratio != 0 ? concave_length(p, t, number) : number);
    const ShapeMeasures m = shape_measures(p, t, shape);
    struct Result {
      Ids ring;
      std::array<double, 2> measures;
    };
    const auto& r = keep(
        Result{t.affine_dimension < 2 ? along_line(t) : ring_of(shape.facets, 0, count),
               {t.affine_dimension < 2 ? 0 : m.volume, t.affine_dimension < 2 ? 0 : m.boundary}});
    hand_out(r.ring, r.measures);
  });
}

int cullhull_voronoi(const double* points, std::uint32_t count) {
  return guarded([&] {
    const PointView p = view(points, count);
    struct Result {
      Voronoi diagram;
      Ids offsets;
    };
    Result made{voronoi(p, delaunay(p)), Ids(count + std::size_t{1})};
    for (std::uint32_t i = 0, at = 0; i <= count; ++i) {
      made.offsets[i] = at;
      if (i < count) at += static_cast<std::uint32_t>(made.diagram.region(i).size());
    }
    const auto& [v, offsets] = keep(std::move(made));
    hand_out(v.vertices, offsets, v.regions.items, v.ridge_points, v.ridges.items, v.ray_vertices,
             v.ray_directions);
  });
}
}
