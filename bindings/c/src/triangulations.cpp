// Triangulations, questions to them, and Voronoi diagrams.
#include <span>

#include "boundary.hpp"

using namespace cullhull;     // NOLINT: the functions of the header
using namespace cullhull::c;  // NOLINT

namespace {

std::span<const double> weights_of(const double* weights, const PointView& points) {
  if (weights == nullptr) return {};
  return {weights, static_cast<std::size_t>(points.count)};
}

}  // namespace

cullhull_status cullhull_triangulation_new(const cullhull_points* points, const double* weights,
                                           const cullhull_options* options,
                                           cullhull_triangulation** triangulation) {
  return guarded([&] {
    wants(triangulation);
    const PointView p = view(points);
    const CallOptions call(options);
    auto o = options_as<TriangulationOptions>(call.options);
    o.furthest_site = call.furthest_site;
    give(triangulation,
         weights == nullptr ? delaunay(p, o) : regular_triangulation(p, weights_of(weights, p), o));
  });
}

void cullhull_triangulation_free(cullhull_triangulation* triangulation) { end(triangulation); }

cullhull_status cullhull_triangulation_get(const cullhull_triangulation* triangulation, int part,
                                           cullhull_array* array) {
  static_assert(sizeof(DuplicatePoint) == 2 * sizeof(std::uint32_t));
  return guarded([&] {
    wants(array);
    const Triangulation& t = content(triangulation);
    const std::size_t c = t.corners(), k = c == 0 ? 0 : c - 1;
    *array = [&]() -> cullhull_array {
      switch (part) {
        case CULLHULL_CELLS:
          return rows(t.cells, c);
        case CULLHULL_CELL_NEIGHBOURS:
          return rows(t.neighbours, c);
        case CULLHULL_CELL_GROUPS:
          return rows(t.cell_groups);
        case CULLHULL_CELL_HULL_FACETS:
          return rows(t.hull_facets, k);
        case CULLHULL_CELL_HULL_CELLS:
          return rows(t.hull_cells);
        case CULLHULL_CELL_DUPLICATES:
          return rows(reinterpret_cast<const std::uint32_t*>(t.duplicates.data()),
                      2 * t.duplicates.size(), 2);
        case CULLHULL_CELL_HIDDEN:
          return rows(t.hidden);
        default:
          refuse("a triangulation has no such part (cullhull_triangulation_part)");
      }
    }();
  });
}

cullhull_status cullhull_triangulation_certify(const cullhull_triangulation* triangulation,
                                               const cullhull_points* points, const double* weights,
                                               const cullhull_options* options,
                                               cullhull_certificate* certificate) {
  return guarded([&] {
    const PointView p = view(points);
    const Triangulation& t = content(triangulation);
    const auto o = options_as<TriangulationOptions>(CallOptions(options).options);
    fill(certificate,
         weights == nullptr ? certify(p, t, o) : certify(p, weights_of(weights, p), t, o));
  });
}

cullhull_status cullhull_locator_new(const cullhull_triangulation* triangulation,
                                     const cullhull_points* points, const double* weights,
                                     const cullhull_options* options, cullhull_locator** locator) {
  return guarded([&] {
    wants(locator);
    const PointView p = view(points);
    give(locator, p, content(triangulation), weights_of(weights, p), CallOptions(options).options);
  });
}

void cullhull_locator_free(cullhull_locator* locator) { end(locator); }

cullhull_status cullhull_locator_find(const cullhull_locator* locator,
                                      const cullhull_points* points,
                                      const cullhull_options* options, uint32_t* cells,
                                      double* barycentric) {
  return guarded([&] {
    const TriangulationQuery& query = content(locator);
    const PointView p = view(points);
    wants(cells);
    const CallOptions call(options);
    query.find(p, cells, call.options);
    if (barycentric != nullptr) query.barycentric(p, cells, barycentric, call.options);
  });
}

cullhull_status cullhull_locator_nearest(const cullhull_locator* locator,
                                         const cullhull_points* points,
                                         const cullhull_options* options, uint32_t* ids) {
  return guarded([&] {
    const PointView p = view(points);
    wants(ids);
    content(locator).nearest(p, ids, CallOptions(options).options);
  });
}

cullhull_status cullhull_voronoi_new(const cullhull_triangulation* triangulation,
                                     const cullhull_points* points, const double* weights,
                                     const cullhull_options* options, cullhull_voronoi** voronoi) {
  return guarded([&] {
    wants(voronoi);
    const PointView p = view(points);
    give(voronoi, cullhull::voronoi(p, content(triangulation), weights_of(weights, p),
                                    CallOptions(options).options));
  });
}

void cullhull_voronoi_free(cullhull_voronoi* voronoi) { end(voronoi); }

cullhull_status cullhull_voronoi_get(const cullhull_voronoi* voronoi, int part,
                                     cullhull_array* array) {
  return guarded([&] {
    wants(array);
    const Voronoi& v = content(voronoi).voronoi;
    Spread& spread = content(voronoi).spread;
    *array = [&]() -> cullhull_array {
      switch (part) {
        case CULLHULL_VORONOI_VERTICES:
          return rows(v.vertices, v.dimension);
        case CULLHULL_VORONOI_RIDGE_POINTS:
          return rows(v.ridge_points, 2);
        case CULLHULL_VORONOI_RIDGES:
          return rows(v.ridges.items);
        case CULLHULL_VORONOI_RIDGE_OFFSETS:
          return spread.of(v.ridges.offsets);
        case CULLHULL_VORONOI_REGIONS:
          return rows(v.regions.items);
        case CULLHULL_VORONOI_REGION_OFFSETS:
          return spread.of(v.regions.offsets);
        case CULLHULL_VORONOI_RAY_VERTICES:
          return rows(v.ray_vertices);
        case CULLHULL_VORONOI_RAY_DIRECTIONS:
          return rows(v.ray_directions, v.dimension);
        default:
          refuse("a diagram has no such part (cullhull_voronoi_part)");
      }
    }();
  });
}
