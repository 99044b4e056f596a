// One hull or shape per group of points; a group is the points with the same key.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cullhull/alpha_shape.hpp"
#include "cullhull/batch.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_blocks.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// Summary of write_group_hulls.
struct GroupReport {
  std::uint64_t points = 0, groups = 0;
  std::uint32_t dimension = 0;
  std::uint64_t skipped = 0;  ///< of the points, those that ReadOptions::skip_nan left out
  double read_seconds = 0;    ///< reading, and sorting by group
  double hull_seconds = 0;    ///< computing and writing the hulls
};

/// Reads the files in blocks, sorts the points by their keys (the column `reading.read.key`), and
/// writes the hull of each group. Keys are compared as text; groups are ordered by value if all
/// keys are JSON numbers, else by their bytes. The extension of `path` selects the format: .geojson
/// (2D), .csv, .json (docs/formats.md); the bytes depend only on points and keys. Points are stored
/// as doubles.
///
/// Memory: twice the points, plus 4 bytes per point and about 40 per group; Error{out_of_budget}
/// beyond options.memory_budget. Throws what visit_blocks, convex_hulls and write_hull throw.
GroupReport write_group_hulls(const std::vector<std::string>& files, const std::string& path,
                              const BlockOptions& reading, const Options& options = {},
                              const MapExtras& extras = {});

/// The shape that write_group_shapes computes of each group: at most one of the numbers is not
/// negative; without any that of critical_alpha(), another one for each group.
struct GroupShape {
  bool one_region = true;   ///< as in critical_alpha()
  double alpha = -1;        ///< alpha_shape() with this alpha
  double edge_length = -1;  ///< concave_hull() with this length
  double ratio = -1;        ///< concave_hull() with the length of concave_length()
};

/// The same with the alpha shape or concave hull of each group. Lengths are in the units of the
/// points. Throws what delaunay(), alpha_shape() and concave_hull() throw as well.
GroupReport write_group_shapes(const std::vector<std::string>& files, const std::string& path,
                               const GroupShape& shape, const BlockOptions& reading,
                               const Options& options = {}, const MapExtras& extras = {});

/// Writes the hulls of a batch in the same formats: set i is the group of the key `keys[i]`. For
/// the same points and keys the bytes are those of the function above. Groups of equal keys keep
/// the order of their sets. `vertex_coordinates`: hulls.dimension numbers for each of
/// hulls.vertices.items. `key_name`: the name of the keys in the file. `format`: as the extension
/// of `path`, which it overrides. Throws Error{invalid_argument} for another number of keys or
/// coordinates and for a format that cannot hold the hulls; Error{io}.
void write_group_hulls(const std::string& path, const HullBatch& hulls,
                       std::span<const double> vertex_coordinates, const PointKeys& keys,
                       const std::string& key_name = "key", const std::string& format = "",
                       const MapExtras& extras = {});

}  // namespace cullhull
#pragma GCC visibility pop
