// One hull per group of points; a group is the points with the same key.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cullhull/options.hpp"
#include "cullhull/point_blocks.hpp"

#pragma GCC visibility push(default)
namespace cullhull::inline v1 {

/// Summary of write_group_hulls.
struct GroupReport {
  std::uint64_t points = 0, groups = 0;
  std::uint32_t dimension = 0;
  double read_seconds = 0;  ///< reading, and sorting by group
  double hull_seconds = 0;  ///< computing and writing the hulls
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
                              const BlockOptions& reading, const Options& options = {});

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
