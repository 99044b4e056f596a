// What comes through the C interface is what the C++ interface gives, bit for bit.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "bindings/c/cullhull.h"
#include "cullhull/batch.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/halfspaces.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/query.hpp"
#include "cullhull/stream.hpp"
#include "cullhull/triangulation.hpp"
#include "cullhull/triangulation_query.hpp"
#include "cullhull/voronoi.hpp"

namespace c_interface_test {

using namespace cullhull;

cullhull_points points(const std::vector<double>& rows, std::uint32_t d) {
  return {sizeof(cullhull_points), rows.data(), rows.size() / d, d, CULLHULL_F64, 0, 0};
}

/// The items of an array, which must be of T.
template <class T>
std::vector<T> items(const cullhull_array& a, std::int32_t type) {
  EXPECT_EQ(a.type, type);
  const T* data = static_cast<const T*>(a.data);
  EXPECT_NE(data, nullptr);
  return {data, data + a.count * a.columns};
}
template <class T, class Range>
void expect_same(const cullhull_array& a, const Range& range, std::int32_t type) {
  EXPECT_EQ(items<T>(a, type), std::vector<T>(range.begin(), range.end()));
}

void expect_same_hull(const cullhull_hull* hull, const Hull& expected) {
  cullhull_hull_info info{};
  info.size = sizeof info;
  ASSERT_EQ(cullhull_hull_get_info(hull, &info), CULLHULL_OK);
  EXPECT_EQ(info.dimension, expected.dimension);
  EXPECT_EQ(info.affine_dimension, expected.affine_dimension);
  EXPECT_EQ(info.point_count, expected.point_count);
  EXPECT_EQ(info.vertex_count, expected.vertices.size());
  EXPECT_EQ(info.facet_count, expected.facet_count());
  EXPECT_EQ(info.simplex_count, expected.simplex_count());
  EXPECT_EQ(info.volume, expected.volume);
  EXPECT_EQ(info.area, expected.area);
  const auto part = [&](int which) {
    cullhull_array a{};
    EXPECT_EQ(cullhull_hull_get(hull, which, &a), CULLHULL_OK);
    return a;
  };
  expect_same<std::uint64_t>(part(CULLHULL_HULL_VERTICES), expected.vertices, CULLHULL_U64);
  expect_same<std::uint64_t>(part(CULLHULL_HULL_SIMPLICES), expected.simplices, CULLHULL_U64);
  expect_same<std::uint32_t>(part(CULLHULL_HULL_SIMPLEX_NEIGHBOURS), expected.simplex_neighbours,
                             CULLHULL_U32);
  expect_same<std::uint32_t>(part(CULLHULL_HULL_SIMPLEX_FACETS), expected.simplex_facets,
                             CULLHULL_U32);
  expect_same<std::uint64_t>(part(CULLHULL_HULL_FACETS), expected.facets.items, CULLHULL_U64);
  expect_same<std::uint64_t>(part(CULLHULL_HULL_FACET_OFFSETS), expected.facets.offsets,
                             CULLHULL_U64);
  expect_same<std::uint32_t>(part(CULLHULL_HULL_FACET_NEIGHBOURS), expected.facet_neighbours.items,
                             CULLHULL_U32);
  expect_same<std::uint64_t>(part(CULLHULL_HULL_FACET_NEIGHBOUR_OFFSETS),
                             expected.facet_neighbours.offsets, CULLHULL_U64);
  expect_same<double>(part(CULLHULL_HULL_PLANES), expected.facet_planes, CULLHULL_F64);
  expect_same<double>(part(CULLHULL_HULL_CENTROID), expected.centroid, CULLHULL_F64);
  expect_same<double>(part(CULLHULL_HULL_COORDINATES), expected.vertex_coordinates, CULLHULL_F64);
}

cullhull_options with_coordinates() {
  cullhull_options o{};
  o.size = sizeof o;
  o.with_coordinates = 1;
  return o;
}

TEST(CInterface, HullsOfEverySizeAndDimensionAreTheSame) {
  const cullhull_options o = with_coordinates();
  for (std::uint32_t d = 1; d <= 5; ++d) {
    for (std::uint64_t n : {0, 1, 2, 5, 10, 100, 1000}) {
      for (const char* shape : {"ball", "cube", "grid"}) {
        SCOPED_TRACE(std::string(shape) + " " + std::to_string(n) + " " + std::to_string(d));
        std::vector<double> rows = n == 0 ? std::vector<double>() : generate(shape, n, d, 1);
        if (n == 5) std::fill(rows.begin(), rows.end(), 0.25);  // equal points
        const cullhull_points p{sizeof p, rows.data(), rows.size() / d, d, 0, 0, 0};
        cullhull_hull* hull = nullptr;
        ASSERT_EQ(cullhull_hull_new(&p, &o, &hull), CULLHULL_OK) << cullhull_last_error();
        Options options;
        options.with_coordinates = true;
        const Hull expected = convex_hull(PointView::row_major(rows.data(), p.count, d), options);
        expect_same_hull(hull, expected);
        cullhull_hull_free(hull);
      }
    }
  }
}

TEST(CInterface, TypesAndStridesAreReadInPlace) {
  const std::vector<double> rows = generate("ball", 500, 3, 2);
  const Hull expected = convex_hull(PointView::row_major(rows.data(), 500, 3));
  std::vector<double> columns(rows.size());
  for (std::size_t i = 0; i < 500; ++i)
    for (std::size_t j = 0; j < 3; ++j) columns[j * 500 + i] = rows[i * 3 + j];
  const cullhull_points by_column{sizeof by_column, columns.data(), 500, 3, 0, 8, 8 * 500};
  cullhull_hull* hull = nullptr;
  ASSERT_EQ(cullhull_hull_new(&by_column, nullptr, &hull), CULLHULL_OK);
  expect_same_hull(hull, expected);
  cullhull_hull_free(hull);

  const auto of_type = [&](auto zero, std::int32_t type) {
    using T = decltype(zero);
    std::vector<T> values(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) values[i] = static_cast<T>(50 + 40 * rows[i]);
    const cullhull_points p{sizeof p, values.data(), 500, 3, type, 0, 0};
    ASSERT_EQ(cullhull_hull_new(&p, nullptr, &hull), CULLHULL_OK);
    expect_same_hull(hull, convex_hull(PointView::row_major(values.data(), 500, 3)));
    cullhull_hull_free(hull);
  };
  of_type(float{}, CULLHULL_F32);
  of_type(std::int8_t{}, CULLHULL_I8);
  of_type(std::uint8_t{}, CULLHULL_U8);
  of_type(std::int16_t{}, CULLHULL_I16);
  of_type(std::uint16_t{}, CULLHULL_U16);
  of_type(std::int32_t{}, CULLHULL_I32);
  of_type(std::uint32_t{}, CULLHULL_U32);
}

TEST(CInterface, BatchesQueriesStatesAndStreamsAreTheSame) {
  const std::vector<double> rows = generate("gauss", 3000, 3, 3);
  const PointView view = PointView::row_major(rows.data(), 3000, 3);
  const cullhull_points p = points(rows, 3);
  const std::vector<std::uint64_t> offsets{0, 0, 1, 20, 1500, 3000};
  const HullBatch expected = convex_hulls(view, offsets);
  cullhull_batch* batch = nullptr;
  ASSERT_EQ(cullhull_batch_new(&p, offsets.data(), 5, nullptr, &batch), CULLHULL_OK);
  cullhull_array a{};
  ASSERT_EQ(cullhull_batch_get(batch, CULLHULL_BATCH_VOLUMES, &a), CULLHULL_OK);
  expect_same<double>(a, expected.volumes, CULLHULL_F64);
  ASSERT_EQ(cullhull_batch_get(batch, CULLHULL_BATCH_AREAS, &a), CULLHULL_OK);
  expect_same<double>(a, expected.areas, CULLHULL_F64);
  ASSERT_EQ(cullhull_batch_get(batch, CULLHULL_BATCH_CENTROIDS, &a), CULLHULL_OK);
  expect_same<double>(a, expected.centroids, CULLHULL_F64);
  ASSERT_EQ(cullhull_batch_get(batch, CULLHULL_BATCH_AFFINE_DIMENSIONS, &a), CULLHULL_OK);
  expect_same<std::int32_t>(a, expected.affine_dimensions, CULLHULL_I32);
  ASSERT_EQ(cullhull_batch_get(batch, CULLHULL_BATCH_VERTICES, &a), CULLHULL_OK);
  expect_same<std::uint64_t>(a, expected.vertices.items, CULLHULL_U64);
  ASSERT_EQ(cullhull_batch_get(batch, CULLHULL_BATCH_VERTEX_OFFSETS, &a), CULLHULL_OK);
  expect_same<std::uint64_t>(a, expected.vertices.offsets, CULLHULL_U64);
  ASSERT_EQ(cullhull_batch_get(batch, CULLHULL_BATCH_SIMPLICES, &a), CULLHULL_OK);
  expect_same<std::uint64_t>(a, expected.simplices.items, CULLHULL_U64);
  ASSERT_EQ(cullhull_batch_get(batch, CULLHULL_BATCH_SIMPLEX_OFFSETS, &a), CULLHULL_OK);
  expect_same<std::uint64_t>(a, expected.simplices.offsets, CULLHULL_U64);
  cullhull_hull* hull = nullptr;
  ASSERT_EQ(cullhull_batch_hull(batch, 4, &hull), CULLHULL_OK);
  cullhull_batch_free(batch);  // the hull lives on
  expect_same_hull(hull, expected.hull(4));
  cullhull_hull_free(hull);

  const Hull whole = convex_hull(view);
  ASSERT_EQ(cullhull_hull_new(&p, nullptr, &hull), CULLHULL_OK);
  cullhull_query* query = nullptr;
  ASSERT_EQ(cullhull_query_new(hull, &p, nullptr, &query), CULLHULL_OK);
  cullhull_hull_free(hull);  // the query lives on
  const HullQuery asked(view, whole);
  std::vector<std::int8_t> sides(3000);
  std::vector<std::uint64_t> supports(3000), expected_supports(3000);
  std::vector<double> distances(3000), expected_distances(3000);
  std::vector<Side> expected_sides(3000);
  ASSERT_EQ(cullhull_query_sides(query, &p, nullptr, sides.data()), CULLHULL_OK);
  ASSERT_EQ(cullhull_query_supports(query, &p, nullptr, supports.data()), CULLHULL_OK);
  ASSERT_EQ(cullhull_query_signed_distances(query, &p, nullptr, distances.data()), CULLHULL_OK);
  asked.sides(view, expected_sides.data());
  asked.supports(view, expected_supports.data());
  asked.signed_distances(view, expected_distances.data());
  for (std::size_t i = 0; i < 3000; ++i)
    ASSERT_EQ(sides[i], static_cast<std::int8_t>(expected_sides[i]));
  EXPECT_EQ(supports, expected_supports);
  EXPECT_EQ(distances, expected_distances);
  cullhull_query_free(query);

  // Three parts, pushed from three threads and merged.
  cullhull_stream* stream = nullptr;
  ASSERT_EQ(cullhull_stream_new(nullptr, &stream), CULLHULL_OK);
  std::vector<std::thread> threads;
  for (std::uint64_t part = 0; part < 3; ++part)
    threads.emplace_back([&, part] {
      cullhull_points block = p;
      block.data = rows.data() + part * 3000;
      block.count = 1000;
      EXPECT_EQ(cullhull_stream_push(stream, &block, part * 1000), CULLHULL_OK);
    });
  for (std::thread& t : threads) t.join();
  ASSERT_EQ(cullhull_stream_hull(stream, &hull), CULLHULL_OK);
  cullhull_stream_free(stream);
  expect_same_hull(hull, whole);
  cullhull_hull_free(hull);

  std::uint64_t *ids = nullptr, count = 0;
  ASSERT_EQ(cullhull_extreme_points(&p, nullptr, &ids, &count), CULLHULL_OK);
  EXPECT_EQ(std::vector<std::uint64_t>(ids, ids + count), extreme_points(view).ids);
  cullhull_free(ids);
  cullhull_options unfiltered{};
  unfiltered.size = sizeof unfiltered;
  unfiltered.cull = CULLHULL_CULL_NONE;
  ASSERT_EQ(cullhull_cull(&p, &unfiltered, &ids, &count), CULLHULL_OK);
  EXPECT_EQ(count, 3000U);
  EXPECT_EQ(ids[2999], 2999U);
  cullhull_free(ids);
}

TEST(CInterface, HalfspacesAreTheSame) {
  const std::vector<double> rows = generate("gauss", 40, 4, 3);
  const Hull hull = convex_hull(PointView::row_major(rows.data(), 40, 4));
  const std::vector<double> planes(hull.facet_planes.begin(), hull.facet_planes.end());
  cullhull_points p = points(planes, 5);
  const PointView view = PointView::row_major(planes.data(), p.count, 5);
  const double inside[] = {0, 0, 0, 0.01};
  for (const double* interior : {static_cast<const double*>(nullptr), inside}) {
    double* vertices = nullptr;
    std::uint64_t count = 0;
    ASSERT_EQ(cullhull_intersect_halfspaces(&p, interior, nullptr, &vertices, &count), CULLHULL_OK);
    EXPECT_EQ(std::vector<double>(vertices, vertices + 4 * count),
              intersect_halfspaces(view, interior).vertices);
    cullhull_free(vertices);
  }
  double* vertices = nullptr;
  std::uint64_t count = 0;
  const double outside[] = {0, 0, 0, 100};
  EXPECT_EQ(cullhull_intersect_halfspaces(&p, outside, nullptr, &vertices, &count),
            CULLHULL_INVALID_ARGUMENT);
  EXPECT_EQ(vertices, nullptr);
  EXPECT_NE(std::string(cullhull_last_error()).find("not strictly inside"), std::string::npos);
  p.count = 1;  // unbounded
  ASSERT_EQ(cullhull_intersect_halfspaces(&p, nullptr, nullptr, &vertices, &count), CULLHULL_OK);
  EXPECT_EQ(count, 0U);
  cullhull_free(vertices);
  p.count = 0;
  EXPECT_EQ(cullhull_intersect_halfspaces(&p, nullptr, nullptr, nullptr, &count),
            CULLHULL_INVALID_ARGUMENT);
}

TEST(CInterface, TriangulationsAndDiagramsAreTheSame) {
  for (std::uint32_t d : {1U, 2U, 3U, 4U}) {
    std::vector<double> rows = generate("cube", 200, d, 4);
    std::copy_n(rows.begin(), d, rows.begin() + 5 * d);  // a duplicate
    std::vector<double> weights(200);
    for (std::size_t i = 0; i < 200; ++i) weights[i] = i % 7 == 0 ? 0.01 : 0.0;
    const PointView view = PointView::row_major(rows.data(), 200, d);
    const cullhull_points p = points(rows, d);
    for (const bool weighted : {false, true}) {
      const double* const w = weighted ? weights.data() : nullptr;
      const Triangulation t = w == nullptr ? delaunay(view) : regular_triangulation(view, weights);
      cullhull_triangulation* made = nullptr;
      ASSERT_EQ(cullhull_triangulation_new(&p, w, nullptr, &made), CULLHULL_OK);
      const auto part = [&](int which) {
        cullhull_array a{};
        EXPECT_EQ(cullhull_triangulation_get(made, which, &a), CULLHULL_OK);
        return a;
      };
      expect_same<std::uint32_t>(part(CULLHULL_CELLS), t.cells, CULLHULL_U32);
      EXPECT_EQ(part(CULLHULL_CELLS).columns, d + 1);
      expect_same<std::uint32_t>(part(CULLHULL_CELL_NEIGHBOURS), t.neighbours, CULLHULL_U32);
      expect_same<std::uint32_t>(part(CULLHULL_CELL_GROUPS), t.cell_groups, CULLHULL_U32);
      expect_same<std::uint32_t>(part(CULLHULL_CELL_HULL_FACETS), t.hull_facets, CULLHULL_U32);
      expect_same<std::uint32_t>(part(CULLHULL_CELL_HULL_CELLS), t.hull_cells, CULLHULL_U32);
      expect_same<std::uint32_t>(part(CULLHULL_CELL_HIDDEN), t.hidden, CULLHULL_U32);
      ASSERT_EQ(part(CULLHULL_CELL_DUPLICATES).count, t.duplicates.size());
      EXPECT_EQ(items<std::uint32_t>(part(CULLHULL_CELL_DUPLICATES), CULLHULL_U32),
                (std::vector<std::uint32_t>{t.duplicates[0].id, t.duplicates[0].representative}));

      const std::span<const double> spanned = w == nullptr ? std::span<const double>() : weights;
      const TriangulationQuery query(view, t, spanned);
      std::vector<std::uint32_t> cells(200), expected(200);
      std::vector<double> parts(200 * (d + 1)), expected_parts(parts.size());
      cullhull_locator* locator = nullptr;
      ASSERT_EQ(cullhull_locator_new(made, &p, w, nullptr, &locator), CULLHULL_OK);
      ASSERT_EQ(cullhull_locator_find(locator, &p, nullptr, cells.data(), parts.data()),
                CULLHULL_OK);
      query.find(view, expected.data());
      EXPECT_EQ(cells, expected);
      query.barycentric(view, cells.data(), expected_parts.data());
      EXPECT_EQ(parts, expected_parts);
      ASSERT_EQ(cullhull_locator_nearest(locator, &p, nullptr, cells.data()), CULLHULL_OK);
      query.nearest(view, expected.data());
      EXPECT_EQ(cells, expected);
      cullhull_locator_free(locator);

      const Voronoi v = voronoi(view, t, spanned);
      cullhull_voronoi* diagram = nullptr;
      ASSERT_EQ(cullhull_voronoi_new(made, &p, w, nullptr, &diagram), CULLHULL_OK);
      cullhull_triangulation_free(made);  // the diagram lives on
      const auto of = [&](int which) {
        cullhull_array a{};
        EXPECT_EQ(cullhull_voronoi_get(diagram, which, &a), CULLHULL_OK);
        return a;
      };
      expect_same<double>(of(CULLHULL_VORONOI_VERTICES), v.vertices, CULLHULL_F64);
      expect_same<std::uint32_t>(of(CULLHULL_VORONOI_RIDGE_POINTS), v.ridge_points, CULLHULL_U32);
      expect_same<std::uint32_t>(of(CULLHULL_VORONOI_RIDGES), v.ridges.items, CULLHULL_U32);
      expect_same<std::uint64_t>(of(CULLHULL_VORONOI_RIDGE_OFFSETS), v.ridges.offsets,
                                 CULLHULL_U64);
      expect_same<std::uint32_t>(of(CULLHULL_VORONOI_REGIONS), v.regions.items, CULLHULL_U32);
      expect_same<std::uint64_t>(of(CULLHULL_VORONOI_REGION_OFFSETS), v.regions.offsets,
                                 CULLHULL_U64);
      expect_same<std::uint32_t>(of(CULLHULL_VORONOI_RAY_VERTICES), v.ray_vertices, CULLHULL_U32);
      expect_same<double>(of(CULLHULL_VORONOI_RAY_DIRECTIONS), v.ray_directions, CULLHULL_F64);
      cullhull_voronoi_free(diagram);
    }
  }
}

/// One call with these points and options, whose line must contain `text`.
void expect_refused(const cullhull_points* p, const cullhull_options* o, cullhull_status status,
                    const std::string& text) {
  cullhull_hull* hull = reinterpret_cast<cullhull_hull*>(8);
  EXPECT_EQ(cullhull_hull_new(p, o, &hull), status) << text;
  EXPECT_EQ(hull, nullptr);
  EXPECT_NE(std::string(cullhull_last_error()).find(text), std::string::npos)
      << cullhull_last_error();
}

TEST(CInterface, WhatIsWrongIsAStatusAndALine) {
  std::vector<double> rows = generate("ball", 100, 3, 5);
  cullhull_points p = points(rows, 3);
  expect_refused(nullptr, nullptr, CULLHULL_INVALID_ARGUMENT, "points");
  EXPECT_EQ(cullhull_hull_new(&p, nullptr, nullptr), CULLHULL_INVALID_ARGUMENT);
  p.size = 4;
  expect_refused(&p, nullptr, CULLHULL_INVALID_ARGUMENT, "points->size");
  p = points(rows, 3);
  p.type = CULLHULL_U64;
  expect_refused(&p, nullptr, CULLHULL_INVALID_ARGUMENT, "points->type");
  p = points(rows, 3);
  p.data = nullptr;
  expect_refused(&p, nullptr, CULLHULL_INVALID_ARGUMENT, "null");
  p = points(rows, 3);
  p.dimension = 0;
  expect_refused(&p, nullptr, CULLHULL_INVALID_ARGUMENT, "dimension");
  p = points(rows, 3);
  rows[100] = std::numeric_limits<double>::quiet_NaN();
  expect_refused(&p, nullptr, CULLHULL_NOT_FINITE, "33");
  rows[100] = 0;

  cullhull_options o{};
  expect_refused(&p, &o, CULLHULL_INVALID_ARGUMENT, "options->size");
  o.size = sizeof o;
  o.backend = 3;
  expect_refused(&p, &o, CULLHULL_INVALID_ARGUMENT, "options->backend");
  o.backend = 0;
  o.cull = -1;
  expect_refused(&p, &o, CULLHULL_INVALID_ARGUMENT, "options->cull");
  o.cull = 0;
  const std::vector<double> many = generate("sphere", 20000, 3, 6);
  const cullhull_points large = points(many, 3);
  o.memory_budget = 1000;
  expect_refused(&large, &o, CULLHULL_OUT_OF_BUDGET, "");
}

TEST(CInterface, HandlesThatAreFreedOrOfAnotherKindAreRefused) {
  const std::vector<double> rows = generate("ball", 50, 3, 7);
  const cullhull_points p = points(rows, 3);
  cullhull_hull* hull = nullptr;
  ASSERT_EQ(cullhull_hull_new(&p, nullptr, &hull), CULLHULL_OK);
  cullhull_array a{};
  EXPECT_EQ(cullhull_hull_get(hull, 11, &a), CULLHULL_INVALID_ARGUMENT);
  EXPECT_EQ(cullhull_hull_get(hull, -1, &a), CULLHULL_INVALID_ARGUMENT);
  EXPECT_EQ(cullhull_hull_get(hull, 0, nullptr), CULLHULL_INVALID_ARGUMENT);
  cullhull_hull* const kept = hull;
  EXPECT_EQ(cullhull_batch_get(reinterpret_cast<cullhull_batch*>(kept), 0, &a),
            CULLHULL_INVALID_ARGUMENT);
  cullhull_batch_free(reinterpret_cast<cullhull_batch*>(kept));  // not what it is: nothing happens
  EXPECT_EQ(cullhull_hull_get(kept, 0, &a), CULLHULL_OK);
  cullhull_hull_free(kept);
  cullhull_hull_free(kept);
  cullhull_hull_free(nullptr);
  EXPECT_EQ(cullhull_hull_get(kept, 0, &a), CULLHULL_INVALID_ARGUMENT);
  EXPECT_STREQ(cullhull_last_error(), "the hull is NULL, freed or another handle");
  // Many more come and go; what was freed long ago is returned, and nothing else breaks.
  for (int i = 0; i < 3000; ++i) {
    ASSERT_EQ(cullhull_hull_new(&p, nullptr, &hull), CULLHULL_OK);
    cullhull_hull_free(hull);
  }
}

TEST(CInterface, CallbacksCancelAlsoByAnException) {
  const std::vector<double> rows = generate("sphere", 200000, 3, 8);
  const cullhull_points p = points(rows, 3);
  cullhull_options o{};
  o.size = sizeof o;
  o.cancelled = [](void*) { return 1; };
  expect_refused(&p, &o, CULLHULL_CANCELLED, "cancelled");
  o.cancelled = nullptr;
  o.progress = [](void*, const char*, double) { return 1; };
  expect_refused(&p, &o, CULLHULL_CANCELLED, "cancelled");
  o.progress = [](void*, const char*, double) -> int { throw std::string("no"); };
  expect_refused(&p, &o, CULLHULL_CANCELLED, "cancelled");
  int told = 0;
  o.progress = [](void* user, const char*, double) {
    ++*static_cast<int*>(user);
    return 0;
  };
  o.user = &told;
  cullhull_hull* hull = nullptr;
  ASSERT_EQ(cullhull_hull_new(&p, &o, &hull), CULLHULL_OK);
  EXPECT_GT(told, 0);
  cullhull_hull_free(hull);
}

TEST(CInterface, StructsOfOlderAndNewerHeadersAreRead) {
  const std::vector<double> rows = generate("cube", 60, 3, 9);
  cullhull_points p = points(rows, 3);
  p.size = offsetof(cullhull_points, point_stride);  // a header without strides
  p.point_stride = p.coordinate_stride = 12345;
  cullhull_hull* hull = nullptr;
  ASSERT_EQ(cullhull_hull_new(&p, nullptr, &hull), CULLHULL_OK);
  struct {
    cullhull_hull_info info;
    std::uint64_t of_later;
  } newer{};
  newer.info.size = sizeof newer;
  newer.of_later = 77;
  EXPECT_EQ(cullhull_hull_get_info(hull, &newer.info), CULLHULL_OK);
  EXPECT_EQ(newer.info.vertex_count,
            convex_hull(PointView::row_major(rows.data(), 60, 3)).vertices.size());
  EXPECT_EQ(newer.of_later, 0U);  // what this library does not know is zero
  cullhull_hull_info older{};
  older.size = offsetof(cullhull_hull_info, volume);
  older.volume = -1;
  EXPECT_EQ(cullhull_hull_get_info(hull, &older), CULLHULL_OK);
  EXPECT_EQ(older.volume, -1);
  cullhull_hull_free(hull);

  struct {
    cullhull_options options;
    std::uint64_t of_later;
  } options{};
  options.options.size = sizeof options;
  const cullhull_points now = points(rows, 3);
  ASSERT_EQ(cullhull_hull_new(&now, &options.options, &hull), CULLHULL_OK);
  cullhull_hull_free(hull);
  options.of_later = 1;
  expect_refused(&now, &options.options, CULLHULL_INVALID_ARGUMENT, "does not know");
}

TEST(CInterface, CertificatesTellWhatIsWrong) {
  const std::vector<double> rows = generate("ball", 300, 3, 10);
  std::vector<double> others = rows;
  others[0] = 50;
  const cullhull_points p = points(rows, 3), q = points(others, 3);
  cullhull_hull* hull = nullptr;
  ASSERT_EQ(cullhull_hull_new(&p, nullptr, &hull), CULLHULL_OK);
  cullhull_certificate proof{};
  proof.size = sizeof proof;
  ASSERT_EQ(cullhull_hull_certify(hull, &p, nullptr, &proof), CULLHULL_OK);
  EXPECT_EQ(proof.valid, 1);
  EXPECT_STREQ(proof.reason, "");
  ASSERT_EQ(cullhull_hull_certify(hull, &q, nullptr, &proof), CULLHULL_OK);
  EXPECT_EQ(proof.valid, 0);
  EXPECT_STRNE(proof.reason, "");
  EXPECT_EQ(cullhull_hull_certify(hull, nullptr, nullptr, &proof), CULLHULL_INVALID_ARGUMENT);
  cullhull_hull_free(hull);
}

TEST(CInterface, MessagesBelongToTheirThread) {
  cullhull_hull* hull = nullptr;
  EXPECT_EQ(cullhull_hull_new(nullptr, nullptr, &hull), CULLHULL_INVALID_ARGUMENT);
  const std::string here = cullhull_last_error();
  std::thread([&] { EXPECT_STREQ(cullhull_last_error(), ""); }).join();
  EXPECT_EQ(cullhull_last_error(), here);
}

}  // namespace c_interface_test
