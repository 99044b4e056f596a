#include <algorithm>
#include <atomic>
#include <cmath>

#include "cullhull/hull.hpp"
#include "hull/space/triangle_mesh.hpp"
#include "parallel/id_places.hpp"
#include "parallel/index.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

using Id = std::uint32_t;
constexpr std::uint64_t grain = 512;

/// The sign (1 or -1) of det [a; b; c] where the error bound proves it, else 0. Rows are
/// differences, exact or rounded once. The filter of Orientation3D::side.
int certain_sign(const double* a, const double* b, const double* c) {
  const double det = determinant_3(a, b, c);
  const double bound = (minor_roundings(3) + 2) * unit_roundoff * permanent_3(a, b, c) + 0x1p-1000;
  return std::abs(det) > bound ? (det > 0 ? 1 : -1) : 0;
}

/// Whether the surface provably winds once around `centre`. Where `centre` is beneath every
/// triangle, central projection makes the surface a covering of the sphere, one-to-one near each
/// triangle and edge; a ray that meets only one triangle, in its interior, proves that it covers
/// once.
bool winds_once(const TriangleMesh& surface, const double* centre, const Run& run) {
  // Not a direction of lattices or symmetric bodies: it should miss their edges.
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

/// Maps a vertex id of a hull to its position among the hull's vertices, whose ids ascend.
class Positions {
 public:
  Positions(const std::vector<std::uint64_t>& ids, const Run& run)
      : all_(ids.back() + 1 == ids.size()) {
    if (!all_) places_ = IdPlaces(ids, run);
  }
  Id of(std::uint64_t id) const { return all_ ? static_cast<Id>(id) : places_(id); }

 private:
  const bool all_;  // vertex i is point i
  IdPlaces places_;
};

}  // namespace

NearbyNumbers::NearbyNumbers(const Hull& hull) {
  const std::uint64_t count = hull.simplex_count();
  const Positions positions(hull.vertices, short_run());
  std::vector<Id> walk, slot(count, no_index), number(hull.vertices.size(), no_index);
  walk.reserve(count);
  const auto visit = [&](Id f) {
    if (slot[f] != no_index) return;
    slot[f] = static_cast<Id>(walk.size());
    walk.push_back(f);
  };
  visit(0);
  order.reserve(number.size());
  vertices.reserve(3 * count);
  for (std::size_t i = 0; i < walk.size(); ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      visit(hull.simplex_neighbours[3 * std::size_t{walk[i]} + j]);
      const Id v = positions.of(hull.simplices[3 * std::size_t{walk[i]} + j]);
      if (number[v] == no_index) {
        number[v] = static_cast<Id>(order.size());
        order.push_back(v);
      }
      vertices.push_back(number[v]);
    }
  }
  neighbours.reserve(3 * count);
  for (const Id f : walk)
    for (std::size_t j = 0; j < 3; ++j)
      neighbours.push_back(slot[hull.simplex_neighbours[3 * std::size_t{f} + j]]);
}

namespace {

/// The surface of `live` triangles, if it is provably star-shaped. order(v): the local point of
/// vertex v; vertex(i) and neighbour(i): the i-th number of all triangles, three each.
template <class Order, class Vertex, class Neighbour>
std::optional<TriangleMesh> star_shaped(std::uint64_t live, const Order& order,
                                        const Vertex& vertex, const Neighbour& neighbour,
                                        const LocalPoints& points, const std::uint32_t* simplex,
                                        const Run& run) {
  TriangleMesh surface;
  surface.live = live;
  surface.count = points.count;
  surface.used = {{0, static_cast<Id>(surface.live)}};
  surface.predicates.emplace(points, simplex);
  surface.order = BigArray<Id>(points.count);
  surface.rows = BigArray<double>(std::size_t{points.count} * Shared3D::row_stride);
  run.each(points.count, grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t v = begin; v < end; ++v) {
      const Id local = order(v);
      surface.order[v] = local;
      double* row = surface.rows.get() + v * Shared3D::row_stride;
      std::copy_n(points.row(local), 3, row);
      row[3] = 0;
    }
  });
  surface.facets.reserve(2 * std::uint64_t{points.count} + 64);  // room to mend it
  run.each(surface.live, grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t f = begin; f < end; ++f) {
      Facet3D& facet = surface.facets[f];
      facet = {};
      for (std::size_t j = 0; j < 3; ++j) {
        facet.vertices[j] = vertex(3 * f + j);
        facet.neighbours[j] = neighbour(3 * f + j);
      }
    }
  });
  if (!winds_once(surface, surface.predicates->centre(), run)) return {};
  return surface;
}

/// Of an order of vertices_first().
Id place_in(const std::vector<Id>& order, std::size_t v) {
  return order.empty() ? static_cast<Id>(v) : order[v];
}

/// False if too many of some hundred ridges, from all parts of the last hull, are certainly concave
/// at the points' positions: a surface that changed is seen so in a hundredth of the time that it
/// takes to store it.
bool may_help(const Hull& last, const Positions& positions, const std::vector<Id>& order,
              const LocalPoints& points, const Run& run) {
  const std::uint64_t count = last.simplex_count(), step = count / 64 + 1;
  const auto row = [&](std::uint64_t f, std::size_t j) {
    return points.row(place_in(order, positions.of(last.simplices[3 * f + j])));
  };
  std::uint64_t concave = 0, seen = 0;
  for (std::uint64_t f = 0; f < count; f += step)
    for (std::size_t j = 0; j < 3; ++j) {
      const std::uint64_t beyond = last.simplex_neighbours[3 * f + j];
      for (std::size_t k = 0; k < 3; ++k) {
        if (last.simplex_neighbours[3 * beyond + k] != f) continue;
        const double *const origin = row(f, 0), *const ends[3] = {row(f, 1), row(f, 2),
                                                                  row(beyond, k)};
        double edges[3][3];
        for (unsigned i = 0; i < 3; ++i)
          for (unsigned c = 0; c < 3; ++c) edges[i][c] = ends[i][c] - origin[c];
        concave += certain_sign(edges[0], edges[1], edges[2]) > 0;
        ++seen;
      }
    }

  const std::uint64_t others = points.count - last.vertices.size();
  return worth_mending(others + concave * 3 * count / (2 * seen), points.count, run);
}

}  // namespace

// A point or a ridge takes one thread some 150 ns, a point of the engine 180. The engine's threads
// share rounds of 8,192 points; mending leaves half of its time to threads that have none.
bool worth_mending(std::uint64_t changes, std::uint64_t count, const Run& run) {
  const std::uint64_t engines = std::clamp<std::uint64_t>(count / 8192, 1, run.threads);
  return 4 * engines * changes <= (run.threads > 1 ? 3 : 1) * count;
}

std::optional<std::vector<Id>> vertices_first(const std::vector<std::uint64_t>& vertices,
                                              const std::uint64_t* ids, Id count, const Run& run) {
  if (vertices.size() > count || !worth_mending(count - vertices.size(), count, run)) return {};
  if (vertices.size() == count) {
    if (ids != nullptr && !std::equal(vertices.begin(), vertices.end(), ids)) return {};
    return std::vector<Id>();
  }
  std::vector<Id> order(count);
  std::vector<std::vector<Id>> others(chunk_count(count, grain));
  run.each_chunk(count, grain, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    std::size_t v = 0;
    for (std::uint64_t i = begin; i < end; ++i) {
      const std::uint64_t id = ids != nullptr ? ids[i] : i;
      if (i == begin)
        v = static_cast<std::size_t>(std::lower_bound(vertices.begin(), vertices.end(), id) -
                                     vertices.begin());
      while (v < vertices.size() && vertices[v] < id) ++v;
      if (v < vertices.size() && vertices[v] == id)
        order[v++] = static_cast<Id>(i);
      else
        others[c].push_back(static_cast<Id>(i));
    }
  });
  std::size_t at = vertices.size();
  for (const std::vector<Id>& some : others) {
    if (some.size() > count - at) return {};
    at = static_cast<std::size_t>(std::copy(some.begin(), some.end(), order.begin() + at) -
                                  order.begin());
  }
  return at == count ? std::optional(std::move(order)) : std::nullopt;
}

std::optional<TriangleMesh> moved_surface(const Hull& last, const NearbyNumbers* numbers,
                                          const std::vector<Id>& order, const LocalPoints& points,
                                          const std::uint32_t* simplex, const Run& run) {
  if (last.affine_dimension != 3 || points.dimension != 3 ||
      last.facet_count() != last.simplex_count() || points.exact != points.coordinates)
    return {};
  const Positions positions(last.vertices, run);
  if (!may_help(last, positions, order, points, run)) return {};
  const std::uint64_t live = last.simplex_count();
  if (numbers != nullptr)
    return star_shaped(
        live,
        [&](std::size_t v) {
      return place_in(order, v < numbers->order.size() ? numbers->order[v] : v);
        },
        [&](std::size_t i) { return numbers->vertices[i]; },
        [&](std::size_t i) { return numbers->neighbours[i]; }, points, simplex, run);
  return star_shaped(
      live, [&](std::size_t v) { return place_in(order, v); },
      [&](std::size_t i) { return positions.of(last.simplices[i]); },
      [&](std::size_t i) { return last.simplex_neighbours[i]; }, points, simplex, run);
}

}  // namespace cullhull::internal
