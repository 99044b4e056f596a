#include "result/build_hull.hpp"

#include <utility>

#include "parallel/pages.hpp"
#include "parallel/parallel.hpp"
#include "result/measure.hpp"
#include "result/merge.hpp"
#include "result/order_facets.hpp"
#include "result/vertex_list.hpp"
#include "result/write_simplices.hpp"
#include "result/write_triangles.hpp"

namespace cullhull::internal {
namespace {

/// k = 2: vertices counter-clockwise from the lowest id. Facet i runs from its vertex 0 to its
/// vertex 1; the vertices ascend before.
void wind_vertices(Hull& hull) {
  std::uint32_t facet = 0;
  while (hull.facets.items[2 * std::size_t{facet}] != hull.vertices[0]) ++facet;
  for (std::uint64_t& v : hull.vertices) {
    v = hull.facets.items[2 * std::size_t{facet}];
    facet = hull.facet_neighbours.items[2 * std::size_t{facet}];
  }
}

void begin_hull(const ResultInput& input, unsigned k, const Control& control, Hull& hull) {
  hull.dimension = input.view->dimension;
  hull.point_count = input.view->count;
  hull.scalar = input.view->scalar;
  hull.affine_dimension = static_cast<int>(k);
  control.report("surface", 0);
}

void build_any(const ResultInput& input, SimplicialHull&& boundary, const Control& control,
               unsigned threads, Hull& hull) {
  const LocalPoints& local = *input.local;
  Surface surface = make_surface(std::move(boundary), local, threads);
  if (surface.k >= 4 && surface.k <= 8 && surface.k == input.view->dimension) {
    VertexList vertices = list_vertices(surface, local.count, input.ids, threads);
    const Frame frame = make_frame(*input.view, vertices.ids, input.axes, surface.k, threads);
    if (!frame.wild &&
        build_simplicial_nd(input, surface, vertices, frame, threads, control, hull)) {
      hull.vertices = std::move(vertices.ids);
      return;
    }
  }
  control.report("merge", 0);
  CoplanarPairs pairs;
  if (surface.k > 1)
    pairs = coplanar_pairs(surface, local, threads, control, hull.statistics.rung_counts);
  const Assembled assembled =
      assemble(input, merge_coplanar(std::move(surface), pairs, local, threads, control), threads,
               control, hull);
  if (hull.affine_dimension == 2) wind_vertices(hull);
  control.report("measures", 0);
  measure(*input.view, assembled.vertices, assembled.index, input.axes, threads, control, hull);
}

}  // namespace

void build_hull(const ResultInput& input, SimplicialHull&& boundary, const Control& control,
                unsigned threads, Hull& hull) {
  const PageScope pages;
  begin_hull(input, boundary.dimension, control, hull);
  if (boundary.dimension == 3 && input.view->dimension == 3) {
    Surface3D surface = to_surface(boundary, *input.local, threads, control);
    if (build_simplicial_3d(input, surface, threads, control, hull)) return;
  }
  build_any(input, std::move(boundary), control, threads, hull);
}

void build_hull(const ResultInput& input, Surface3D&& boundary, const Control& control,
                unsigned threads, Hull& hull) {
  const PageScope pages;
  begin_hull(input, 3, control, hull);
  if (build_simplicial_3d(input, boundary, threads, control, hull)) return;
  build_any(input, to_simplicial(std::move(boundary), threads, control), control, threads, hull);
}

}  // namespace cullhull::internal
