// A hull for each group of points: those with the same key.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cullhull/options.hpp"
#include "cullhull/point_blocks.hpp"

#pragma GCC visibility push(default)
namespace cullhull::inline v1 {

/// What write_group_hulls did.
struct GroupReport {
  std::uint64_t points = 0, groups = 0;
  std::uint32_t dimension = 0;
  double read_seconds = 0;  ///< reading, and sorting by group
  double hull_seconds = 0;  ///< hulls, and writing them
};

/// Reads the files in blocks, sorts the points by what the column `reading.read.key` holds, and
/// writes the hull of each group. Points belong to one group where their keys are the same text;
/// groups are ordered by value where all keys are JSON numbers, else by their bytes. The format is
/// that of the extension of `path`: .geojson (2D), .csv, .json (docs/formats.md); the bytes depend
/// on points and keys alone. Points are kept as doubles.
///
/// Memory: twice the points, 4 bytes a point and about 40 a group; Error{out_of_budget} beyond
/// options.memory_budget. Throws what visit_blocks, convex_hulls and write_hull throw.
GroupReport write_group_hulls(const std::vector<std::string>& files, const std::string& path,
                              const BlockOptions& reading, const Options& options = {});

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
