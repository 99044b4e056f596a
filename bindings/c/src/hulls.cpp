// Hulls, extreme points, batches, questions, states and streams.
#include <vector>

#include "boundary.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/halfspaces.hpp"

using namespace cullhull;     // NOLINT: the functions of the header
using namespace cullhull::c;  // NOLINT

namespace {

void hand_over(const std::vector<std::uint64_t>& items, std::uint64_t** ids, std::uint64_t* count) {
  *ids = static_cast<std::uint64_t*>(handed_over(items.data(), items.size() * sizeof(items[0])));
  *count = items.size();
}

const Hull& hull_of(const cullhull_hull* hull) { return content(hull).hull; }

}  // namespace

cullhull_status cullhull_hull_new(const cullhull_points* points, const cullhull_options* options,
                                  cullhull_hull** hull) {
  return guarded([&] {
    wants(hull);
    give(hull, convex_hull(view(points), CallOptions(options).options));
  });
}

void cullhull_hull_free(cullhull_hull* hull) { end(hull); }

cullhull_status cullhull_hull_get_info(const cullhull_hull* hull, cullhull_hull_info* info) {
  return guarded([&] {
    const Hull& h = hull_of(hull);
    cullhull_hull_info own{};
    own.dimension = h.dimension;
    own.affine_dimension = h.affine_dimension;
    own.point_count = h.point_count;
    own.vertex_count = h.vertices.size();
    own.facet_count = h.facet_count();
    own.simplex_count = h.simplex_count();
    own.survivors = h.statistics.survivors;
    own.volume = h.volume;
    own.area = h.area;
    fill(info, own, "info->size is not sizeof(cullhull_hull_info)");
  });
}

cullhull_status cullhull_hull_get(const cullhull_hull* hull, int part, cullhull_array* array) {
  return guarded([&] {
    wants(array);
    const Hull& h = hull_of(hull);
    Spread& spread = content(hull).spread;
    const std::size_t d = h.dimension;
    const auto k = static_cast<std::size_t>(std::max(h.affine_dimension, 0));
    *array = [&]() -> cullhull_array {
      switch (part) {
        case CULLHULL_HULL_VERTICES:
          return rows(h.vertices);
        case CULLHULL_HULL_SIMPLICES:
          return rows(h.simplices, k);
        case CULLHULL_HULL_SIMPLEX_NEIGHBOURS:
          return rows(h.simplex_neighbours, k);
        case CULLHULL_HULL_SIMPLEX_FACETS:
          return spread.of(h.simplex_facets);
        case CULLHULL_HULL_FACETS:
          return rows(h.facets.items);
        case CULLHULL_HULL_FACET_OFFSETS:
          return spread.of(h.facets.offsets);
        case CULLHULL_HULL_FACET_NEIGHBOURS:
          return rows(h.facet_neighbours.items);
        case CULLHULL_HULL_FACET_NEIGHBOUR_OFFSETS:
          return spread.of(h.facet_neighbours.offsets);
        case CULLHULL_HULL_PLANES:
          return rows(h.facet_planes, d + 1);
        case CULLHULL_HULL_CENTROID:
          return rows(h.centroid, d);
        case CULLHULL_HULL_COORDINATES:
          return rows(h.vertex_coordinates, d);
        default:
          refuse("a hull has no such part (cullhull_hull_part)");
      }
    }();
  });
}

cullhull_status cullhull_extreme_points(const cullhull_points* points,
                                        const cullhull_options* options, uint64_t** ids,
                                        uint64_t* count) {
  return guarded([&] {
    wants(ids);
    wants(count);
    hand_over(extreme_points(view(points), CallOptions(options).options).ids, ids, count);
  });
}

cullhull_status cullhull_cull(const cullhull_points* points, const cullhull_options* options,
                              uint64_t** ids, uint64_t* count) {
  return guarded([&] {
    wants(ids);
    wants(count);
    const PointView p = view(points);
    Survivors left = cull(p, CallOptions(options).options);
    if (left.all) {
      left.ids.resize(p.count);
      for (std::uint64_t i = 0; i < p.count; ++i) left.ids[i] = i;
    }
    hand_over(left.ids, ids, count);
  });
}

cullhull_status cullhull_intersect_halfspaces(const cullhull_points* halfspaces,
                                              const double* interior,
                                              const cullhull_options* options, double** vertices,
                                              uint64_t* count) {
  return guarded([&] {
    wants(vertices);
    wants(count);
    const HalfspaceIntersection h =
        intersect_halfspaces(view(halfspaces), interior, CallOptions(options).options);
    *vertices = static_cast<double*>(
        handed_over(h.vertices.data(), h.vertices.size() * sizeof(h.vertices[0])));
    *count = h.vertices.size() / h.dimension;
  });
}

cullhull_status cullhull_hull_certify(const cullhull_hull* hull, const cullhull_points* points,
                                      const cullhull_options* options,
                                      cullhull_certificate* certificate) {
  return guarded([&] {
    const CallOptions call(options);
    fill(certificate, points == nullptr ? certify(hull_of(hull), call.options)
                                        : certify(view(points), hull_of(hull), call.options));
  });
}

cullhull_status cullhull_batch_new(const cullhull_points* points, const uint64_t* offsets,
                                   uint64_t sets, const cullhull_options* options,
                                   cullhull_batch** batch) {
  return guarded([&] {
    wants(batch);
    if (offsets == nullptr) refuse("the offsets are NULL");
    if (sets > SIZE_MAX / sizeof(*offsets) - 1) refuse("more sets than memory can hold offsets of");
    give(batch, convex_hulls(view(points), {offsets, static_cast<std::size_t>(sets) + 1},
                             CallOptions(options).options));
  });
}

void cullhull_batch_free(cullhull_batch* batch) { end(batch); }

cullhull_status cullhull_batch_get(const cullhull_batch* batch, int part, cullhull_array* array) {
  return guarded([&] {
    wants(array);
    const HullBatch& b = content(batch).batch;
    Spread& spread = content(batch).spread;
    *array = [&]() -> cullhull_array {
      switch (part) {
        case CULLHULL_BATCH_VOLUMES:
          return rows(b.volumes);
        case CULLHULL_BATCH_AREAS:
          return rows(b.areas);
        case CULLHULL_BATCH_AFFINE_DIMENSIONS:
          return rows(b.affine_dimensions);
        case CULLHULL_BATCH_CENTROIDS:
          return rows(b.centroids, b.dimension);
        case CULLHULL_BATCH_VERTICES:
          return rows(b.vertices.items);
        case CULLHULL_BATCH_VERTEX_OFFSETS:
          return spread.of(b.vertices.offsets);
        case CULLHULL_BATCH_SIMPLICES:
          return rows(b.simplices.items);
        case CULLHULL_BATCH_SIMPLEX_OFFSETS:
          return spread.of(b.simplices.offsets);
        default:
          refuse("a batch has no such part (cullhull_batch_part)");
      }
    }();
  });
}

cullhull_status cullhull_batch_hull(const cullhull_batch* batch, uint64_t set,
                                    cullhull_hull** hull) {
  return guarded([&] {
    wants(hull);
    const HullBatch& b = content(batch).batch;
    if (set >= b.size()) refuse("the batch has no such set");
    give(hull, b.hull(static_cast<std::size_t>(set)));
  });
}

cullhull_status cullhull_query_new(const cullhull_hull* hull, const cullhull_points* points,
                                   const cullhull_options* options, cullhull_query** query) {
  return guarded([&] {
    wants(query);
    const CallOptions call(options);
    if (points == nullptr)
      give(query, HullQuery(hull_of(hull), call.options));
    else
      give(query, HullQuery(view(points), hull_of(hull), call.options));
  });
}

void cullhull_query_free(cullhull_query* query) { end(query); }

cullhull_status cullhull_query_sides(const cullhull_query* query, const cullhull_points* points,
                                     const cullhull_options* options, int8_t* out) {
  static_assert(sizeof(Side) == sizeof(int8_t));
  return guarded([&] {
    const PointView p = view(points);
    wants(out);
    content(query).sides(p, reinterpret_cast<Side*>(out), CallOptions(options).options);
  });
}

cullhull_status cullhull_query_supports(const cullhull_query* query,
                                        const cullhull_points* directions,
                                        const cullhull_options* options, uint64_t* out) {
  return guarded([&] {
    const PointView p = view(directions);
    wants(out);
    content(query).supports(p, out, CallOptions(options).options);
  });
}

cullhull_status cullhull_query_signed_distances(const cullhull_query* query,
                                                const cullhull_points* points,
                                                const cullhull_options* options, double* out) {
  return guarded([&] {
    const PointView p = view(points);
    wants(out);
    content(query).signed_distances(p, out, CallOptions(options).options);
  });
}

cullhull_status cullhull_state_new(const cullhull_points* points, uint64_t first_id,
                                   const cullhull_options* options, cullhull_state** state) {
  return guarded([&] {
    wants(state);
    give(state, view(points), first_id, CallOptions(options).options);
  });
}

void cullhull_state_free(cullhull_state* state) { end(state); }

cullhull_status cullhull_state_merge(cullhull_state* state, const cullhull_state* other,
                                     const cullhull_options* options) {
  return guarded([&] { content(state).merge(content(other), CallOptions(options).options); });
}

cullhull_status cullhull_state_save(const cullhull_state* state, uint8_t** bytes, uint64_t* count) {
  return guarded([&] {
    wants(bytes);
    wants(count);
    const std::vector<std::byte> record = content(state).to_bytes();
    *bytes = static_cast<uint8_t*>(handed_over(record.data(), record.size()));
    *count = record.size();
  });
}

cullhull_status cullhull_state_load(const uint8_t* bytes, uint64_t count, cullhull_state** state) {
  return guarded([&] {
    wants(state);
    if (bytes == nullptr) refuse("the bytes of the state are NULL");
    give(state, HullState::from_bytes(
                    {reinterpret_cast<const std::byte*>(bytes), static_cast<std::size_t>(count)}));
  });
}

cullhull_status cullhull_state_get(const cullhull_state* state, cullhull_array* ids,
                                   cullhull_points* points) {
  return guarded([&] {
    const HullState& s = content(state);
    if (ids != nullptr) *ids = rows(s.ids());
    if (points != nullptr)
      fill(points, points_of(s.points()), "points->size is not sizeof(cullhull_points)");
  });
}

cullhull_status cullhull_state_hull(const cullhull_state* state, const cullhull_options* options,
                                    cullhull_hull** hull) {
  return guarded([&] {
    wants(hull);
    give(hull, content(state).hull(CallOptions(options).options));
  });
}

cullhull_status cullhull_stream_new(const cullhull_options* options, cullhull_stream** stream) {
  return guarded([&] {
    wants(stream);
    give(stream, CallOptions(options).options);
  });
}

void cullhull_stream_free(cullhull_stream* stream) { end(stream); }

cullhull_status cullhull_stream_push(cullhull_stream* stream, const cullhull_points* block,
                                     uint64_t first_id) {
  return guarded([&] { content(stream).push(view(block), first_id); });
}

cullhull_status cullhull_stream_state(cullhull_stream* stream, cullhull_state** state) {
  return guarded([&] {
    wants(state);
    give(state, content(stream).state());
  });
}

cullhull_status cullhull_stream_hull(cullhull_stream* stream, cullhull_hull** hull) {
  return guarded([&] {
    wants(hull);
    give(hull, content(stream).hull());
  });
}
