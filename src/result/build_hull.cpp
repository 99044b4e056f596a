#include "result/build_hull.hpp"

#include <utility>

#include "parallel/dispatch.hpp"
#include "parallel/memory/pages.hpp"
#include "result/boundary.hpp"
#include "result/measures/measure.hpp"
#include "result/write/write_simplices.hpp"

namespace cullhull::internal {
namespace {

/// k = 2: changes the order of hull.vertices from ascending to counter-clockwise, beginning with
/// the lowest id. It follows the facets, each an edge from its vertex 0 to its vertex 1.
void wind_vertices(Hull& hull) {
  std::uint32_t facet = 0;
  while (hull.facets.items[2 * std::size_t{facet}] != hull.vertices[0]) ++facet;
  for (std::uint64_t& v : hull.vertices) {
    v = hull.facets.items[2 * std::size_t{facet}];
    facet = hull.facet_neighbours.items[2 * std::size_t{facet}];
  }
}

/// Fills the fields that describe the input.
void begin_hull(const ResultInput& input, unsigned k, const Run& run, Hull& hull) {
  hull.dimension = input.view->dimension;
  hull.point_count = input.view->count;
  hull.scalar = input.view->scalar;
  hull.affine_dimension = static_cast<int>(k);
  run.report("surface", 0);
}

/// The general way: first tries write_simplices (4D to 8D, no coplanar simplices), else merges,
/// sorts and measures.
void build_any(const ResultInput& input, Boundary&& surface, const Run& run, Hull& hull) {
  const LocalPoints& local = *input.local;
  sort_simplices(surface, local, run);
  if (!plane_only && surface.dimension >= 4 && surface.dimension <= 8 &&
      surface.dimension == input.view->dimension) {
    VertexList vertices = list_vertices(surface, local.count, input.ids, run);
    const Frame frame = make_frame(*input.view, vertices.ids, input.axes, surface.dimension, run);
    if (!frame.wild && write_simplices(input, surface, vertices, frame, run, hull)) {
      hull.vertices = std::move(vertices.ids);
      return;
    }
  }
  run.report("merge", 0);
  CoplanarPairs pairs;
  if (!plane_only && surface.dimension > 1)
    pairs = coplanar_pairs(surface, local, run, hull.statistics.rung_counts);
  const OrderedFacets assembled =
      order_facets(input, merge_coplanar(std::move(surface), pairs, local, run), run, hull);
  if (hull.affine_dimension == 2) wind_vertices(hull);
  run.report("measures", 0);
  measure(*input.view, assembled.vertices, assembled.index, input.axes, run, hull);
}

}  // namespace

void build_hull(const ResultInput& input, Boundary&& boundary, const Run& run, Hull& hull) {
  const PageScope pages;
  begin_hull(input, boundary.dimension, run, hull);
  build_any(input, std::move(boundary), run, hull);
}

void build_hull(const ResultInput& input, TriangleMesh&& boundary, const Run& run, Hull& hull) {
  const PageScope pages;
  begin_hull(input, 3, run, hull);
  if (write_triangles(input, boundary, run, hull)) return;
  build_any(input, boundary_of(std::move(boundary), run), run, hull);
}

}  // namespace cullhull::internal
