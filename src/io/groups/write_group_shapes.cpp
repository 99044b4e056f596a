// write_group_shapes: alpha shapes and concave hulls of groups of points, a record for each.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/group_hulls.hpp"
#include "io/groups/collected.hpp"
#include "io/groups/group_files.hpp"

namespace cullhull::internal {

namespace {

/// The shape of one group; in the end in world units.
struct GroupOfShape {
  PointView points;
  Triangulation triangulation;
  AlphaShape shape;
  double limit = 0;  ///< alpha, or the length of edges
};

/// The shape of points on a grid; `alpha` and `edge_length` are on it, and so is the limit.
void find_shape(const PointView& points, const GroupShape& wanted, const Options& options,
                GroupOfShape& out) {
  out.triangulation = delaunay(points, options_as<TriangulationOptions>(options));
  const Triangulation& t = out.triangulation;
  if (wanted.edge_length >= 0 || wanted.ratio >= 0) {
    out.limit = wanted.edge_length >= 0 ? wanted.edge_length
                                        : concave_length(points, t, wanted.ratio, options);
    out.shape = concave_hull(points, t, out.limit, options);
    return;
  }
  out.limit =
      wanted.alpha >= 0 ? wanted.alpha : critical_alpha(points, t, wanted.one_region, options);
  out.shape = alpha_shape(points, t, out.limit, options);
}

/// In the plane: polygons, of points on a line the segment and of equal ones the point. Empty for
/// segments with gaps.
PlanePolygons polygons_of(const GroupOfShape& group) {
  const Triangulation& t = group.triangulation;
  if (t.affine_dimension != 2) {
    const Array<std::uint32_t>& ends = t.affine_dimension == 1 ? group.shape.facets : t.cells;
    if (ends.size() != static_cast<std::size_t>(t.affine_dimension) + 1) return {};
    return {{ring_of(group.points, ends)}};
  }
  const CellPolygons all = cell_polygons(group.points, t, group.shape.cells);
  PlanePolygons out;
  for (std::uint64_t i = 0; i < all.polygon_count(); ++i)
    out.push_back(rings_of(all, i, group.points));
  return out;
}

/// Writes the coordinates of the shape's points, cells and facets by their places among them.
void write_lists(JsonWriter& json, const GroupOfShape& group) {
  const Triangulation& t = group.triangulation;
  std::vector<std::uint32_t> ids;  // of the shape's points, ascending
  for (const std::uint32_t c : group.shape.cells)
    ids.insert(ids.end(), t.cell(c).begin(), t.cell(c).end());
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  json.rows(
      "coordinates", ids.size(),
      [&](JsonWriter&, std::uint64_t i) {
    std::vector<double> row;
    for (std::uint32_t j = 0; j < group.points.dimension; ++j)
      row.push_back(group.points.at(ids[i], j));
    json.list(row, 0, row.size());
      },
      false);
  const auto list = [&](std::span<const std::uint32_t> corners) {
    json.list_by(corners, 0, corners.size(), [&](std::uint32_t id) {
      json.value(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
    });
  };
  json.rows(
      "cells", group.shape.cells.size(),
      [&](JsonWriter&, std::uint64_t i) { list(t.cell(group.shape.cells[i])); }, false);
  const std::size_t k = t.corners() > 1 ? t.corners() - 1 : 0;
  json.rows(
      "facets", group.shape.facet_cells.size(),
      [&](JsonWriter&, std::uint64_t i) { list(std::span(group.shape.facets).subspan(i * k, k)); },
      false);
}

/// Lengths that are wanted, on the grid of the points.
GroupShape on_grid(GroupShape wanted, const Grid& grid) {
  if (wanted.alpha >= 0) wanted.alpha = grid.to_grid(wanted.alpha);
  if (wanted.edge_length >= 0) wanted.edge_length = grid.to_grid(wanted.edge_length);
  return wanted;
}

void write_shapes(const CollectedPoints& collected, const SortedGroups& sorted,
                  const GroupShape& wanted, GroupFile& file, const Grid& grid,
                  const Options& options) {
  constexpr std::uint64_t few = 10000;  // threads do not pay for fewer points
  const std::uint32_t d = sorted.dimension;
  const std::size_t groups = sorted.keys.order.size();
  const GroupShape shape = on_grid(wanted, grid);
  for (std::size_t i = 0; i < groups; ++i) {
    const std::uint64_t first = sorted.offsets[i], count = sorted.offsets[i + 1] - first;
    const double* const rows = sorted.coordinates.as<const double>() + first * d;
    Options own = options;
    own.progress = {};
    if (count < few) own.threads = 1;
    GroupOfShape group;
    find_shape(PointView::row_major(rows, count, d), shape, own, group);
    std::vector<double> world(rows, rows + count * d);
    to_world(world, grid);
    group.points = PointView::row_major(world.data(), count, d);
    const auto measures = shape_measures(group.points, group.triangulation, group.shape);
    file.add({.key = collected.words()[sorted.keys.order[i]],
              .numeric = sorted.keys.numeric,
              .number = i,
              .columns = sorted.columns,
              .points = count,
              .affine_dimension = group.triangulation.affine_dimension,
              .limit = grid.to_world(group.limit),
              .counts = {group.shape.cells.size(), group.shape.facet_cells.size()},
              .area = measures.boundary,
              .volume = measures.volume,
              .polygons = [&] { return polygons_of(group); },
              .lists = [&](JsonWriter& json) { write_lists(json, group); }});
    if (options.progress)
      options.progress("shapes", static_cast<double>(i + 1) / static_cast<double>(groups));
  }
  file.commit();
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

GroupReport write_group_shapes(const std::vector<std::string>& files, const std::string& path,
                               const GroupShape& shape, const BlockOptions& reading,
                               const Options& options, const MapExtras& extras) {
  using namespace internal;
  const bool by_edges = shape.edge_length >= 0 || shape.ratio >= 0;
  if ((shape.alpha >= 0 ? 1 : 0) + (shape.edge_length >= 0 ? 1 : 0) + (shape.ratio >= 0 ? 1 : 0) >
      1)
    throw Error(ErrorCode::invalid_argument, "alpha, edge_length and ratio exclude one another");
  const std::string format = checked_format(path, "");
  return write_sorted_groups(
      files, reading, options, extras.columns,
      [&](const auto& collected, const auto& sorted, const auto& read, const auto& report) {
    const std::vector<const char*> counts =
        report.dimension == 2 ? std::vector<const char*>() : std::vector{"cells", "facets"};
    GroupFile file(path, format, name_of_key(reading.read.key),
                   {"group_shapes", "shapes", by_edges ? "edge_length" : "alpha", counts},
                   {report.points, report.dimension, read.scalar}, extras);
    write_shapes(collected, sorted, shape, file, read.grid, options);
      });
}

}  // namespace cullhull
