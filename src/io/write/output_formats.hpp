// The formats of written files: which results each holds.
#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <string_view>
#include <vector>

namespace cullhull::internal {

/// What a file of results holds, by the function that writes it.
enum class OutputKind : std::uint8_t {
  hull,           ///< write_hull
  group_hulls,    ///< write_group_hulls
  triangulation,  ///< write_triangulation, write_alpha_shape
  voronoi,        ///< write_voronoi
  cells,          ///< write_cells
  ids,            ///< write_ids
  points,         ///< write_points
  made,           ///< PointsWriter
  records,        ///< write_las_records
  state,          ///< write_state
};

struct OutputFormat {
  using enum OutputKind;

  class Kinds {
   public:
    constexpr Kinds(std::initializer_list<OutputKind> kinds) {
      for (const OutputKind kind : kinds) bits_ |= 1U << static_cast<unsigned>(kind);
    }
    constexpr bool meet(Kinds other) const { return (bits_ & other.bits_) != 0; }

   private:
    unsigned bits_ = 0;
  };
  /// mesh: polygons in space, for points of dimension 2 and 3. map: polygons in the plane, as
  /// programs for maps read them, for points of dimension 2.
  enum class Shape : std::uint8_t { other, mesh, map };

  std::string_view ending;  ///< the extension with its dot
  Kinds kinds;
  Shape shape = Shape::other;

  /// In the order in which messages list them.
  static const OutputFormat all[];
};

inline constexpr OutputFormat OutputFormat::all[] = {
    {".npy", {ids, points, made}},
    {".ply", {hull, triangulation, cells, points, made}, Shape::mesh},
    {".obj", {hull, triangulation, cells, made}, Shape::mesh},
    {".off", {hull, triangulation, cells, made}, Shape::mesh},
    {".stl", {hull, triangulation}, Shape::mesh},
    {".glb", {hull, triangulation}, Shape::mesh},
    {".vtp", {hull, triangulation, cells}, Shape::mesh},
    {".vtk", {triangulation}},
    {".las", {records}},
    {".geojson", {hull, group_hulls, triangulation, cells, points, made}, Shape::map},
    {".wkt", {hull, triangulation, cells, made}, Shape::map},
    {".csv", {group_hulls, ids, points, made}},
    {".json", {hull, group_hulls, triangulation, voronoi}},
    {".xyz", {points, made}},
    {".txt", {hull, ids, points, made}},
    {".hullstate", {state}},
    {".npz", {state}},
    {".raw", {made}},
};

/// The extensions, with their dots, of the formats that hold one of these kinds.
inline std::vector<std::string_view> output_endings(OutputFormat::Kinds kinds) {
  std::vector<std::string_view> endings;
  for (const OutputFormat& f : OutputFormat::all)
    if (f.kinds.meet(kinds)) endings.push_back(f.ending);
  return endings;
}

/// The format with this extension; `format`: without the dot. Null if nothing is written so.
inline const OutputFormat* find_output_format(std::string_view format) {
  const auto* const it =
      std::find_if(std::begin(OutputFormat::all), std::end(OutputFormat::all),
                   [&](const OutputFormat& f) { return f.ending.substr(1) == format; });
  return it == std::end(OutputFormat::all) ? nullptr : it;
}

inline bool holds(std::string_view format, OutputFormat::Kinds kinds) {
  const OutputFormat* const f = find_output_format(format);
  return f != nullptr && f->kinds.meet(kinds);
}

inline bool is_mesh(std::string_view format) {
  const OutputFormat* const f = find_output_format(format);
  return f != nullptr && f->shape == OutputFormat::Shape::mesh;
}

inline bool is_map(std::string_view format) {
  const OutputFormat* const f = find_output_format(format);
  return f != nullptr && f->shape == OutputFormat::Shape::map;
}

}  // namespace cullhull::internal
