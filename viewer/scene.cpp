#include "viewer/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "parallel/byte_order.hpp"
#include "viewer/assets.hpp"
#include "viewer/drawn_cells.hpp"
#include "viewer/hull_shape.hpp"
#include "viewer/page.hpp"

namespace cullhull::viewer {
namespace {

/// Limit for the bytes of arrays in a page. Base64 makes them 4/3 as long; with three.js (0.9 MB)
/// and the rest, the page stays below 12 MB.
constexpr std::uint64_t page_bytes = 8'000'000;
/// More dots could not be distinguished, and phones would draw them slowly.
constexpr std::uint64_t most_points = 100'000, most_survivors = 50'000;
/// From a list of more axes users could hardly choose three, and one row must not fill the page.
constexpr std::uint32_t most_axes = 64;
/// Up to this number of axes, the page stores all projections on three axes (20 for 6 axes).
constexpr std::uint32_t most_shadow_axes = 6;

/// Ids are written as 32-bit numbers if they fit, else as doubles, which are exact up to 2^53.
bool wide_ids(std::uint64_t count) { return count > UINT64_C(1) << 32; }

/// Scalars that a float represents exactly need half the space.
bool narrow_scalar(ScalarType t) {
  return t != ScalarType::f64 && t != ScalarType::i32 && t != ScalarType::u32;
}

std::string member(const char* name, std::uint64_t value) {
  return fmt::format("\"{}\":{},", name, value);
}

/// Bytes per vertex of a shape of dimension k, without the vertex's row. A polyhedron has up to
/// twice as many triangles (each with its facet) and three times as many edges as vertices. Numbers
/// below 2^16 use two bytes, so this bounds large shapes only.
std::uint64_t shape_bytes(int k) { return k == 3 ? 56 : k == 2 ? 20 : 0; }

ShapeLimits shape_limits(int k, std::uint64_t bytes, std::uint64_t row_bytes) {
  constexpr std::uint64_t least = 64;
  if (k <= 3) return {std::max(least, bytes * 6 / 10 / (row_bytes + shape_bytes(k))), 0};
  return {std::max(least, bytes * 3 / 10 / row_bytes), std::max(least, bytes * 3 / 10 / 8)};
}

bool has_nan(const PointView& points, std::uint64_t id) {
  for (std::uint32_t j = 0; j < points.dimension; ++j)
    if (std::isnan(points.at(id, j))) return true;
  return false;
}

bool contains(const std::vector<std::uint64_t>& sorted, std::uint64_t id) {
  return std::binary_search(sorted.begin(), sorted.end(), id);
}

}  // namespace

/// Ids in the order of the page, and the shape, which refers to the first of them.
struct Scene::Rows {
  HullShape shape;
  std::vector<Shadow> shadows;
  std::vector<std::uint64_t> survivors, points;
  std::uint64_t all_survivors = 0, all_points = 0;  ///< in the input, without vertices
};

bool available() { return !assets::three_js.empty(); }

Scene::Scene(std::string title, std::uint64_t frames, std::uint64_t shown_frames)
    : title_(std::move(title)),
      frames_(frames),
      frame_bytes_(page_bytes / std::max<std::uint64_t>(1, shown_frames)) {}

template <class T>
std::string Scene::array(const char* name, const char* type, const std::vector<T>& items) {
  bytes_.resize((bytes_.size() + 7) / 8 * 8);  // a typed array must be aligned to its item size
  const std::string json =
      fmt::format("\"{}\":[{},{},\"{}\"],", name, bytes_.size(), items.size(), type);
  const std::size_t begin = bytes_.size(), size = items.size() * sizeof(T);
  bytes_.append(reinterpret_cast<const char*>(items.data()), size);
  internal::little_endian_items(bytes_.data() + begin, size, sizeof(T));
  return json;
}

std::string Scene::indices(const char* name, const std::vector<std::uint32_t>& items,
                           std::uint64_t rows) {
  if (rows > UINT64_C(1) << 16) return array(name, "u32", items);
  return array(name, "u16", std::vector<std::uint16_t>(items.begin(), items.end()));
}

Scene::Rows Scene::choose_rows(const SceneFrame& frame, std::uint64_t row_bytes,
                               std::uint64_t frame_bytes) const {
  const Hull& hull = *frame.hull;
  const int k = hull.affine_dimension;
  Rows rows;
  rows.shape = hull_shape(hull, frame.vertex_rows, shape_limits(k, frame_bytes, row_bytes));
  std::uint64_t used =
      rows.shape.vertices.size() * row_bytes +
      4 * (rows.shape.edges.size() + rows.shape.triangles.size() + rows.shape.facets.size());
  if (k >= 4 && axes_ <= most_shadow_axes) {
    rows.shadows = shadows(frame.vertex_rows, dimension_, rows.shape.vertices, axes_);
    std::uint64_t bytes = 0;
    for (const Shadow& s : rows.shadows) bytes += 4 * (s.edges.size() + s.triangles.size());
    if (bytes > frame_bytes / 4)
      rows.shadows.clear();  // edges are drawn instead
    else
      used += bytes;
  }
  if (frame.points.count == 0) return rows;

  const std::uint64_t n = frame.points.count;
  const std::uint64_t room = (frame_bytes - std::min(used, frame_bytes)) / row_bytes;
  std::vector<std::uint64_t> vertices(hull.vertices.begin(), hull.vertices.end());
  std::sort(vertices.begin(), vertices.end());
  const Survivors& survivors = *frame.survivors;
  rows.all_survivors = survivors.size(n) - vertices.size();
  rows.all_points = n - survivors.size(n) - frame.skipped;

  // The same ids in every frame, so that a viewer can follow points. Each is drawn by its role in
  // this frame: vertex, survivor or discarded point.
  for (const std::uint64_t id : fair_sample(n, std::min(most_points, room / 2 + 1))) {
    if (contains(vertices, id) || (frame.skipped > 0 && has_nan(frame.points, id))) continue;
    const bool survived = survivors.all || contains(survivors.ids, id);
    (survived ? rows.survivors : rows.points).push_back(id);
  }
  if (!survivors.all)
    for (const std::uint64_t i :
         fair_sample(survivors.ids.size(), std::min(most_survivors, room / 4)))
      if (!contains(vertices, survivors.ids[i])) rows.survivors.push_back(survivors.ids[i]);
  std::sort(rows.survivors.begin(), rows.survivors.end());
  rows.survivors.erase(std::unique(rows.survivors.begin(), rows.survivors.end()),
                       rows.survivors.end());
  return rows;
}

void Scene::write_rows(const SceneFrame& frame, const Rows& rows, std::string& json) {
  const Hull& hull = *frame.hull;
  std::vector<double> ids, coordinates;
  for (const std::uint64_t v : rows.shape.vertices) {
    ids.push_back(static_cast<double>(hull.vertices[v]));
    for (std::uint32_t j = 0; j < axes_; ++j)
      coordinates.push_back(frame.vertex_rows[v * dimension_ + j]);
  }
  for (const auto* list : {&rows.survivors, &rows.points})
    for (const std::uint64_t id : *list) {
      ids.push_back(static_cast<double>(id));
      for (std::uint32_t j = 0; j < axes_; ++j) coordinates.push_back(frame.points.at(id, j));
    }
  if (wide_ids(hull.point_count))
    json += array("ids", "f64", ids);
  else
    json += array("ids", "u32", std::vector<std::uint32_t>(ids.begin(), ids.end()));
  if (narrow_scalar(hull.scalar))
    json += array("coordinates", "f32", std::vector<float>(coordinates.begin(), coordinates.end()));
  else
    json += array("coordinates", "f64", coordinates);
  if (frame.colours.count > 0) write_colours(frame.colours, ids, json);
  if (!frame.attribute_names.empty()) write_attributes(frame, ids, json);
  if (frame.triangulate != nullptr) write_cells(frame, ids, coordinates, json);
}

/// Writes the cells of all rows, or of a uniform sample of them.
void Scene::write_cells(const SceneFrame& frame, const std::vector<double>& ids,
                        const std::vector<double>& coordinates, std::string& json) {
  const DrawnCells cells =
      drawn_cells(ids, coordinates, axes_, cell_bytes() / 4, *frame.triangulate, frame.outline);
  json += member("cell_corners", cells.corners);
  json += member("cell_points", cells.points);
  if (frame.outline) json += "\"outline\":true,";
  json += indices("cells", cells.rows, ids.size());
}

void Scene::write_attributes(const SceneFrame& frame, const std::vector<double>& ids,
                             std::string& json) {
  std::string list;
  for (std::uint32_t k = 0; k < frame.attribute_names.size(); ++k) {
    std::vector<float> values;
    for (const double id : ids)
      values.push_back(static_cast<float>(frame.attributes.at(static_cast<std::uint64_t>(id), k)));
    list += fmt::format("{}{{\"name\":{},", list.empty() ? "" : ",",
                        nlohmann::json(frame.attribute_names[k]).dump());
    list += array("values", "f32", values);
    list.back() = '}';  // replaces the last comma
  }
  json += "\"attributes\":[" + list + "],";
}

void Scene::write_colours(const PointView& colours, const std::vector<double>& ids,
                          std::string& json) {
  std::vector<std::uint8_t> bytes;
  for (const double id : ids)
    for (std::uint32_t c = 0; c < 3; ++c)
      bytes.push_back(static_cast<std::uint8_t>(colours.at(static_cast<std::uint64_t>(id), c)));
  json += array("colours", "u8", bytes);
}

/// Writes the projections on three axes of hulls of four to six dimensions.
void Scene::write_shadows(const Rows& rows, std::string& json) {
  std::string list;
  for (const Shadow& s : rows.shadows) {
    list += fmt::format("{}{{\"axes\":[{},{},{}],", list.empty() ? "" : ",", s.axes[0], s.axes[1],
                        s.axes[2]);
    list += indices("edges", s.edges, rows.shape.vertices.size());
    list += indices("triangles", s.triangles, rows.shape.vertices.size());
    list.back() = '}';  // replaces the last comma
  }
  json += "\"shadows\":[" + list + "],";
}

void Scene::add(const SceneFrame& frame) {
  const Hull& hull = *frame.hull;
  if (frames_json_.empty()) {
    dimension_ = hull.dimension;
    axes_ = std::min(dimension_, most_axes);
  } else if (hull.dimension != dimension_) {
    throw Error(ErrorCode::invalid_argument, "frames of one page have one dimension");
  }
  const std::uint64_t row_bytes =
      axes_ * (narrow_scalar(hull.scalar) ? 4U : 8U) + (wide_ids(hull.point_count) ? 8U : 4U) +
      (frame.colours.count > 0 ? 3U : 0U) + 4U * frame.attribute_names.size();
  if (frame.triangulate != nullptr && (dimension_ < 2 || dimension_ > 3))
    throw Error(
        ErrorCode::invalid_argument,
        "cells are drawn of points of dimension 2 and 3, not " + std::to_string(dimension_));
  const Rows rows = choose_rows(frame, row_bytes,
                                frame_bytes_ - (frame.triangulate != nullptr ? cell_bytes() : 0));
  std::string& json = frames_json_;
  json += json.empty() ? "{" : ",\n{";
  json += member("index", frame.index);
  json += fmt::format(
      "\"affine_dimension\":{},\"has_points\":{},\"simplified\":{},\"edges_sampled\":{},",
      hull.affine_dimension, frame.points.count > 0, rows.shape.simplified,
      rows.shape.edges_sampled);
  json += member("vertices", rows.shape.vertices.size());
  json += member("survivors", rows.survivors.size());
  json += member("points", rows.points.size());
  json += member("all_vertices", hull.vertices.size());
  json += member("all_survivors", rows.all_survivors);
  json += member("all_points", rows.all_points);
  write_rows(frame, rows, json);
  json += indices("edges", rows.shape.edges, rows.shape.vertices.size());
  json += indices("triangles", rows.shape.triangles, rows.shape.vertices.size());
  if (!rows.shape.facets.empty()) json += array("facets", "u32", rows.shape.facets);
  write_shadows(rows, json);
  json.append("\"report\":").append(frame.report).append("}");
}

std::string Scene::page() const {
  if (!available())
    throw Error(ErrorCode::backend_unavailable,
                "this build has no viewer, as three.js was not there when it was configured; "
                "install libjs-three, configure and build again");
  Page page;
  page.title = title_;
  page.body = assets::view_html;
  page.styles = {assets::view_css};
  page.notice = assets::three_licence_txt;
  page.scripts = {assets::three_js,  assets::data_js,  assets::cells_js,  assets::colours_js,
                  assets::shadow_js, assets::axes_js,  assets::camera_js, assets::stage_js,
                  assets::panel_js,  assets::tools_js, assets::view_js};
  std::string scene =
      fmt::format("{{\"frame_count\":{},\"dimension\":{},\"axes\":{},\"frames\":[{}]}}", frames_,
                  dimension_, axes_, frames_json_);
  page.data.push_back({"scene", "application/json", std::move(scene)});
  page.data.push_back({"bytes", "text/plain", base64(bytes_)});
  return page_text(page);
}

std::vector<double> vertex_rows(const PointView& points, const Hull& hull) {
  std::vector<double> rows;
  rows.reserve(hull.vertices.size() * hull.dimension);
  for (const std::uint64_t id : hull.vertices)
    for (std::uint32_t j = 0; j < hull.dimension; ++j) rows.push_back(points.at(id, j));
  return rows;
}

}  // namespace cullhull::viewer
