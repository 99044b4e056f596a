// A hull as JSON.
#include "io/json/json.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include "cullhull/hull.hpp"

namespace cullhull::internal {
namespace {

JsonPoints points_of(const Hull& hull) { return {hull.point_count, hull.dimension, hull.scalar}; }

void write_measures(JsonWriter& w, const Hull& hull) {
  w.member("affine_dimension", hull.affine_dimension);
  w.member("vertex_count", std::uint64_t{hull.vertices.size()});
  w.member("facet_count", hull.facet_count());
  w.member("simplex_count", hull.simplex_count());
  put_measures(hull.affine_dimension, hull.area, hull.volume,
               [&](const char* name, double measure) { w.member(name, measure); });
  w.flat("centroid", hull.centroid);
}

void write_lists(JsonWriter& w, const Coordinates& points, const Hull& hull) {
  const auto k = static_cast<std::uint64_t>(std::max(hull.affine_dimension, 0));
  w.flat("vertices", hull.vertices);
  std::vector<std::uint32_t> axes(hull.dimension);
  std::iota(axes.begin(), axes.end(), 0U);
  w.rows("vertex_coordinates", hull.vertices.size(), [&](JsonWriter& row, std::uint64_t i) {
    row.list_by(axes, 0, axes.size(),
                [&](std::uint32_t j) { row.value(points.at(hull.vertices[i], j)); });
  });
  w.nested("facets", hull.facets);
  w.nested("facet_neighbours", hull.facet_neighbours);
  w.nested("facet_planes", hull.facet_planes, std::uint64_t{hull.dimension} + 1);
  w.nested("simplices", hull.simplices, k);
  w.nested("simplex_neighbours", hull.simplex_neighbours, k);
  w.flat("simplex_facets", hull.simplex_facets);
}

void write_run(JsonWriter& w, const Hull& hull, const JsonExtras& extras) {
  const Statistics& s = hull.statistics;
  const std::vector<double> all = extras.compute_seconds_all.empty()
                                      ? std::vector<double>{s.compute_seconds}
                                      : extras.compute_seconds_all;
  w.member("read_seconds", extras.read_seconds);
  w.member("compute_seconds", s.compute_seconds);
  w.flat("compute_seconds_all", all);
  w.member("peak_bytes", extras.peak_bytes);
  w.key("certified");
  if (extras.certified)
    w.value(*extras.certified);
  else
    w.null();  // not checked
}

}  // namespace

void write_result_json(const Coordinates& points, const Hull& hull, const TextSink& sink,
                       const ItemSink& items) {
  std::string text;
  JsonWriter w(text, sink, items);
  w.begin_document("hull", points_of(hull));
  write_measures(w, hull);
  write_lists(w, points, hull);
  w.end_document();
}

std::string hull_to_json(const Hull& hull, const JsonExtras& extras) {
  std::string text;
  JsonWriter w(text);
  const Statistics& s = hull.statistics;
  w.begin_document("hull_report", points_of(hull));
  w.member("threads", s.threads);
  w.member("backend", backend_name(s.backend));
  w.key("cull");
  w.begin_object();
  w.member("method", filter_name(s.filter));
  w.member("survivors", s.survivors);
  w.member("seconds", s.cull_seconds);
  w.member("reason", s.cull_reason);
  w.end_object();
  w.key("hull");
  w.begin_object();
  w.member("engine", "native");
  w.member("seconds", s.hull_seconds);
  w.end_object();
  write_measures(w, hull);
  write_run(w, hull, extras);
  w.end_document();
  return text;
}

}  // namespace cullhull::internal
