// Where the whole numbers of a scan lie: scale and offset along each axis, and the grid on
// which points of several files can be computed exactly. Part of cullhull::io.
#pragma once

#include <string>
#include <vector>

#include "cullhull/hull.hpp"
#include "cullhull/stream.hpp"
#include "cullhull/voronoi.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

struct ReadOptions;

/// Where the whole numbers of a scan lie: along each axis at number * scale + offset. Empty where a
/// file has none such (all formats but .las).
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
/// exactly and give back. A binary grid: of 2^-places. Doubles hold its coordinates as they are.
class Grid {
 public:
  Grid() = default;  ///< none: coordinates are what they are
  explicit Grid(int decimals);
  static Grid binary(int places);

  bool empty() const noexcept { return unit_ == 0; }
  /// -1: no decimal grid.
  int decimals() const noexcept { return decimals_; }
  /// What coordinates are multiplied by on the grid: 10^decimals; 1 of a binary grid and of none.
  double power() const noexcept { return power_; }
  /// 0 of no grid.
  double unit() const noexcept { return unit_; }
  /// The double nearest to the coordinate that is `number` on the grid.
  double to_world(double number) const noexcept { return number / power_; }
  double to_grid(double coordinate) const noexcept { return coordinate * power_; }
  /// The number on the grid whose to_world() is `coordinate`; NaN where there is none.
  double number_of(double coordinate) const noexcept;

  /// Measures of so many dimensions: length 1, area 2, ...
  double measure_to_world(double measure, int dimension) const noexcept;
  double measure_to_grid(double measure, int dimension) const noexcept;

  friend bool operator==(const Grid&, const Grid&) = default;

 private:
  int decimals_ = -1;
  double power_ = 1, unit_ = 0;
};

/// The coarsest grid on which all coordinates of such files lie. A binary one, where there is one
/// and not all are whole numbers: coordinates are doubles, as they would be in any other file. Else
/// scales and offsets are taken for the shortest decimals that read back as them (0.01 for one
/// hundredth). None where one placement is empty, or a coordinate might need more than 50 bits.
Grid common_grid(const std::vector<Placement>& placements);

/// A file's numbers on a grid that its placement lies on: exact.
class GridAxes {
 public:
  /// Error{invalid_argument} where it does not lie on it (common_grid).
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

}  // namespace cullhull
#pragma GCC visibility pop
