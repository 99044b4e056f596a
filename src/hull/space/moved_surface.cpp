#include "hull/space/moved_surface.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace cullhull::internal {
namespace {

using Id = std::uint32_t;
constexpr std::uint64_t grain = 8192;

/// 1 or -1: the certain sign of det [a; b; c], rows of differences that were rounded once or are
/// exact; 0 where it is in doubt. The filter of Orientation3D::side.
int certain_sign(const double* a, const double* b, const double* c) {
  const double det = determinant_3(a, b, c);
  const double bound = (minor_roundings(3) + 2) * unit_roundoff * permanent_3(a, b, c) + 0x1p-1000;
  return std::abs(det) > bound ? (det > 0 ? 1 : -1) : 0;
}

/// Whether the surface winds once around `centre`, certainly. Where every triangle is seen from
/// beneath, central projection maps the surface onto the sphere, triangle by triangle and across
/// each edge; a ray that meets one triangle alone, in its interior, shows that it does so once.
bool winds_once(const TriangleMesh& surface, const double* centre, const Run& run) {
  // No direction of a lattice or of a symmetric body.
  static constexpr double ray[3] = {0.6180339887498949, 0.3247179572447461, 0.7161203842163911};
  std::atomic<std::uint64_t> met{0};
  std::atomic<bool> doubtful{false};
  run.each(surface.live, grain, [&](std::uint64_t begin, std::uint64_t end) {
    std::uint64_t here = 0;
    for (std::uint64_t f = begin; f < end && !doubtful.load(std::memory_order_relaxed); ++f) {
      double corner[3][3];
      for (unsigned j = 0; j < 3; ++j) {
        const Id v = surface.facets[f].vertices[j];
        const double* row = surface.rows.get() + std::size_t{v} * Shared3D::row_stride;
        for (unsigned c = 0; c < 3; ++c) corner[j][c] = row[c] - centre[c];
      }
      if (certain_sign(corner[0], corner[1], corner[2]) <= 0) doubtful = true;
      int least = 1;
      for (unsigned j = 0; j < 3 && least >= 0; ++j)
        least = std::min(least, certain_sign(ray, corner[j], corner[(j + 1) % 3]));
      if (least == 0) doubtful = true;  // through an edge, perhaps
      here += least > 0;
    }
    met += here;
  });
  return !doubtful && met == 1;
}

}  // namespace

std::optional<TriangleMesh> moved_surface(const Hull& last, const LocalPoints& points,
                                          const std::uint32_t* simplex, const Run& run) {
  if (last.affine_dimension != 3 || points.dimension != 3 ||
      last.facet_count() != last.simplex_count() || last.vertices.size() != points.count ||
      points.exact != points.coordinates)
    return {};
  TriangleMesh surface;
  surface.live = last.simplex_count();
  surface.count = points.count;
  surface.used = {{0, static_cast<Id>(surface.live)}};
  surface.predicates.emplace(points, simplex);
  surface.order = BigArray<Id>(points.count);
  surface.rows = BigArray<double>(std::size_t{points.count} * Shared3D::row_stride);
  run.each(points.count, grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t v = begin; v < end; ++v) {
      surface.order[v] = static_cast<Id>(v);
      double* row = surface.rows.get() + v * Shared3D::row_stride;
      std::copy_n(points.row(static_cast<Id>(v)), 3, row);
      row[3] = 0;
    }
  });
  const auto& ids = last.vertices;
  const bool all = ids.back() + 1 == ids.size();  // they ascend: vertex i is point i
  surface.facets.reserve(surface.live);
  run.each(surface.live, grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t f = begin; f < end; ++f) {
      Facet3D& facet = surface.facets[f];
      facet = {};
      for (unsigned j = 0; j < 3; ++j) {
        const std::uint64_t id = last.simplices[3 * f + j];
        facet.vertices[j] = static_cast<Id>(
            all ? id : static_cast<std::uint64_t>(std::ranges::lower_bound(ids, id) - ids.begin()));
        facet.neighbours[j] = last.simplex_neighbours[3 * f + j];
      }
    }
  });
  if (!winds_once(surface, surface.predicates->centre(), run)) return {};
  return surface;
}

}  // namespace cullhull::internal
