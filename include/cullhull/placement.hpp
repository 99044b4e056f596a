// How the integers of a scan map to coordinates: scale and offset of each axis, and the grid on
// which points of several files can be computed exactly. Part of cullhull::io.
#pragma once

#include <string>
#include <vector>

#include "cullhull/hull.hpp"
#include "cullhull/stream.hpp"
#include "cullhull/voronoi.hpp"

#pragma GCC visibility push(default)
namespace cullhull::inline v1 {

struct ReadOptions;

/// Maps the integers of a scan to coordinates: number * scale + offset on each axis. Empty for
/// formats without such a map (all but .las).
struct Placement {
  std::vector<double> scale, offset;
  std::string unit{};  ///< of x and y, by the file's reference system: "metre", ...; empty: unknown

  bool empty() const noexcept { return scale.empty(); }
  /// In doubles, as laspy computes it.
  double at(std::size_t axis, double number) const noexcept {
    return empty() ? number : number * scale[axis] + offset[axis];
  }
  friend bool operator==(const Placement&, const Placement&) = default;
};

/// Coordinates that are whole multiples of a unit, the same on every axis, and of at most 50 bits.
/// A decimal grid: of 10^-decimals. On it coordinates are these multiples, which doubles hold
/// exactly and give back. A binary grid: of 2^-places. Doubles hold its coordinates exactly.
class Grid {
 public:
  Grid() = default;  ///< no grid: coordinates are used as given
  explicit Grid(int decimals);
  static Grid binary(int places);

  bool empty() const noexcept { return unit_ == 0; }
  /// -1: no decimal grid.
  int decimals() const noexcept { return decimals_; }
  /// The factor from coordinates to grid units: 10^decimals; 1 for a binary grid and without one.
  double power() const noexcept { return power_; }
  /// The spacing of the grid in coordinates; 0 without a grid.
  double unit() const noexcept { return unit_; }
  /// The double nearest to the coordinate that is `number` on the grid.
  double to_world(double number) const noexcept { return number / power_; }
  double to_grid(double coordinate) const noexcept { return coordinate * power_; }
  /// The integer whose to_world() is `coordinate`; NaN if no integer is.
  double number_of(double coordinate) const noexcept;

  /// Converts measures of `dimension` dimensions: 1 for lengths, 2 for areas, ...
  double measure_to_world(double measure, int dimension) const noexcept;
  double measure_to_grid(double measure, int dimension) const noexcept;

  friend bool operator==(const Grid&, const Grid&) = default;

 private:
  int decimals_ = -1;
  double power_ = 1, unit_ = 0;
};

/// The coarsest grid that contains all coordinates of files with these placements. It is binary if
/// a binary grid exists and some coordinates are not integers: coordinates are then the doubles
/// that any other file would hold. Otherwise scales and offsets stand for the shortest decimals
/// that read back as them (0.01 for one hundredth). Empty if a placement is empty, or a coordinate
/// might need more than 50 bits.
Grid common_grid(const std::vector<Placement>& placements);

/// Converts a file's integers to units of a grid that contains its placement, exactly.
class GridAxes {
 public:
  /// Throws Error{invalid_argument} if the grid does not contain the placement (see common_grid).
  GridAxes(const Placement& placement, const Grid& grid);
  double at(std::size_t axis, double number) const noexcept {
    return number * step_[axis] + origin_[axis];
  }

 private:
  std::vector<double> step_, origin_;
};

/// Numbers of a hull on a grid as those in the world, and back; rounded. Ids, facets and normals
/// stay.
void to_world(Hull& hull, const Grid& grid);
void to_grid(Hull& hull, const Grid& grid);
/// The same of a diagram, of clipped cells and of the extreme points that a state holds.
void to_world(Voronoi& diagram, const Grid& grid);
void to_world(ClippedCells& cells, const Grid& grid);
void to_world(HullState& state, const Grid& grid);
/// Coordinates of points on a grid, as doubles, in their memory.
void to_world(std::vector<double>& numbers, const Grid& grid);

/// The common grid of such inputs, as common_grid says, by their headers; states have the one they
/// were made on. None where one of several is no regular file. Throws what open_points throws.
Grid common_grid(const std::vector<std::string>& files, const ReadOptions& options);

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
