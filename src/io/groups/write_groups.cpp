// write_group_hulls: points sorted by group, hulls in slices, a record for each; and of a batch.
#include <algorithm>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cullhull/batch.hpp"
#include "cullhull/error.hpp"
#include "cullhull/group_hulls.hpp"
#include "io/groups/collected.hpp"
#include "io/groups/group_files.hpp"

namespace cullhull::internal {
namespace {

GroupKind kind_of_hulls(std::uint32_t dimension) {
  return {"groups", "hulls", nullptr,
          dimension == 2 ? std::vector{"vertices"} : std::vector{"vertices", "facets"}};
}

/// Adds one hull of a batch; `corners`: the coordinates of its vertices, a row each.
void add_hull(GroupFile& file, GroupRecord group, const HullBatch& batch, std::size_t set,
              const double* corners, const Grid& grid) {
  const std::span<const std::uint64_t> vertices = batch.vertices[set];
  const std::uint64_t first = batch.facet_starts[set], facets = batch.facet_starts[set + 1] - first;
  const std::uint32_t d = batch.dimension;
  const int k = std::max(batch.affine_dimensions[set], 0);
  std::vector<double> rows(corners, corners + vertices.size() * d);
  to_world(rows, grid);
  group.points = batch.point_counts[set];
  group.affine_dimension = batch.affine_dimensions[set];
  group.counts = {vertices.size(), facets};
  group.area = grid.measure_to_world(batch.areas[set], std::max(k - 1, 0));
  group.volume = grid.measure_to_world(batch.volumes[set], k);
  group.polygons = [&] { return PlanePolygons{{rows}}; };
  group.lists = [&](JsonWriter& json) {
    json.rows(
        "vertex_coordinates", vertices.size(),
        [&](JsonWriter&, std::uint64_t i) { json.list(rows, i * d, (i + 1) * d); }, false);
    // Each facet by the positions of its corners among the vertices.
    std::vector<std::pair<std::uint64_t, std::uint64_t>> places;
    for (const std::uint64_t v : vertices) places.emplace_back(v, places.size());
    std::sort(places.begin(), places.end());
    const auto place_of = [&](std::uint64_t v) {
      json.value(
          std::lower_bound(places.begin(), places.end(), std::pair{v, std::uint64_t{0}})->second);
    };
    json.rows(
        "facets", facets,
        [&](JsonWriter&, std::uint64_t i) {
      const auto corners_of = batch.facets[first + i];
      json.list_by(corners_of, 0, corners_of.size(), place_of);
        },
        false);
  };
  file.add(group);
}

void write_slices(const CollectedPoints& collected, const SortedGroups& sorted, GroupFile& file,
                  const Grid& grid, const Options& options) {
  // Hulled and written at a time: some 100 MB of text at most. Not tuned.
  constexpr std::uint64_t slice_points = std::uint64_t{1} << 20;
  const std::uint32_t d = sorted.dimension;
  const std::size_t groups = sorted.keys.order.size();
  std::vector<double> corners;  // of the hulls of a slice, end to end
  for (std::size_t begin = 0, end = 0; begin < groups; begin = end) {
    const std::uint64_t first = sorted.offsets[begin];
    while (end < groups && (end == begin || sorted.offsets[end + 1] - first <= slice_points)) ++end;
    std::vector<std::uint64_t> offsets;
    for (std::size_t i = begin; i <= end; ++i) offsets.push_back(sorted.offsets[i] - first);
    const double* const rows = sorted.coordinates.as<const double>() + first * d;
    const HullBatch batch =
        convex_hulls(PointView::row_major(rows, offsets.back(), d), offsets, options);
    corners.clear();
    for (std::size_t set = 0; set < batch.size(); ++set)
      for (const std::uint64_t v : batch.vertices[set]) {
        const double* const row = rows + (offsets[set] + v) * d;
        corners.insert(corners.end(), row, row + d);
      }
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t set = i - begin;
      add_hull(file,
               {collected.words()[sorted.keys.order[i]], sorted.keys.numeric, i, sorted.columns},
               batch, set, corners.data() + batch.vertices.offsets[set] * d, grid);
    }
    if (options.progress)
      options.progress("hulls", static_cast<double>(end) / static_cast<double>(groups));
  }
  file.commit();
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

GroupReport write_group_hulls(const std::vector<std::string>& files, const std::string& path,
                              const BlockOptions& reading, const Options& options,
                              const MapExtras& extras) {
  using namespace internal;
  const std::string format = checked_format(path, "");
  return write_sorted_groups(
      files, reading, options, extras.columns,
      [&](const auto& collected, const auto& sorted, const auto& read, const auto& report) {
    GroupFile file(path, format, name_of_key(reading.read.key), kind_of_hulls(report.dimension),
                   {report.points, report.dimension, read.scalar}, extras);
    write_slices(collected, sorted, file, read.grid, options);
      });
}

void write_group_hulls(const std::string& path, const HullBatch& hulls,
                       std::span<const double> vertex_coordinates, const PointKeys& keys,
                       const std::string& key_name, const std::string& format,
                       const MapExtras& extras) {
  using namespace internal;
  if (keys.size() != hulls.size())
    throw Error(ErrorCode::invalid_argument, hulls.size(), " hulls have ", keys.size(), " keys");
  const std::size_t numbers = hulls.vertices.items.size() * hulls.dimension;
  if (vertex_coordinates.size() != numbers)
    throw Error(ErrorCode::invalid_argument, "the vertices of the hulls have ", numbers,
                " coordinates, not ", vertex_coordinates.size());
  const std::uint64_t points =
      std::accumulate(hulls.point_counts.begin(), hulls.point_counts.end(), std::uint64_t{0});
  const KeyOrder order(keys);
  const Grid grid;
  GroupFile file(path, checked_format(path, format), key_name, kind_of_hulls(hulls.dimension),
                 {points, hulls.dimension, hulls.scalar}, extras);
  for (const std::uint32_t set : order.order)
    add_hull(file, {keys[set], order.numeric}, hulls, set,
             vertex_coordinates.data() + hulls.vertices.offsets[set] * hulls.dimension, grid);
  file.commit();
}

}  // namespace cullhull
