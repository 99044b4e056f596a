// How the integers of a scan map to coordinates: scale and offset of each axis, and the grid on
// which points of several files are computed exactly; and the coordinate reference systems that
// files state. Part of cullhull::io.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cullhull/hull_fwd.hpp"
#include "cullhull/stream.hpp"
#include "cullhull/voronoi.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

struct ReadOptions;

/// Maps the integers of a scan to coordinates: number * scale + offset on each axis. Empty for
/// formats without such a map (all but .las).
struct Placement {
  std::vector<double> scale, offset;
  std::string unit{};  ///< of x and y, as the file states it: "metre", ...; empty: unknown

  bool empty() const noexcept { return scale.empty(); }
  /// In doubles, as laspy computes it.
  double at(std::size_t axis, double number) const noexcept {
    return empty() ? number : number * scale[axis] + offset[axis];
  }
  friend bool operator==(const Placement&, const Placement&) = default;
};

/// Coordinates that are integer multiples of a unit, the same on every axis, with at most 50 bits.
/// Decimal grid: the unit is 10^-decimals; computations use the multiples, which doubles hold
/// exactly and map back. Binary grid: the unit is 2^-places; doubles hold the coordinates exactly.
class Grid {
 public:
  Grid() = default;  ///< no grid: coordinates are used as given
  explicit Grid(int decimals);
  static Grid binary(int places);

  bool empty() const noexcept { return unit_ == 0; }
  /// -1 unless the grid is decimal.
  int decimals() const noexcept { return decimals_; }
  /// The factor from coordinates to grid units: 10^decimals; 1 for a binary grid and without one.
  double power() const noexcept { return power_; }
  /// The spacing of the grid in coordinates; 0 without a grid.
  double unit() const noexcept { return unit_; }
  /// The bits of the largest number on the grid that a file could hold from which common_grid()
  /// made it; 0: unknown. No part of the grid's value.
  int bits() const noexcept { return bits_; }
  void set_bits(int bits) noexcept { bits_ = bits; }
  /// The double nearest to the coordinate that is `number` on the grid.
  double to_world(double number) const noexcept { return number / power_; }
  double to_grid(double coordinate) const noexcept { return coordinate * power_; }
  /// The integer whose to_world() is `coordinate`; NaN if no integer is.
  double number_of(double coordinate) const noexcept;

  /// Converts measures: `dimension` 1 for lengths, 2 for areas, ...
  double measure_to_world(double measure, int dimension) const noexcept;
  double measure_to_grid(double measure, int dimension) const noexcept;

  friend bool operator==(const Grid& a, const Grid& b) noexcept {
    return a.decimals_ == b.decimals_ && a.unit_ == b.unit_;
  }

 private:
  int decimals_ = -1, bits_ = 0;
  double power_ = 1, unit_ = 0;
};

/// The coarsest grid that contains all coordinates of files with these placements. A binary grid,
/// if one exists and some coordinates are not integers: coordinates are then the same doubles as in
/// any other file format. Otherwise a decimal grid, which takes scales and offsets as the shortest
/// decimals that read back as them (0.01 is one hundredth). Empty if a placement is empty, or if a
/// coordinate might need more than 50 bits.
Grid common_grid(const std::vector<Placement>& placements);

/// Converts the numbers of a hull from grid units to world coordinates, or back; rounded. Ids,
/// facets and normals do not change.
void to_world(Hull& hull, const Grid& grid);
void to_grid(Hull& hull, const Grid& grid);
/// The same for a hull from a file and the coordinates of its vertices, which become the grid's
/// integers, NaN where there is none. A centroid within the box of the vertices stays within it.
void to_grid(Hull& hull, std::vector<double>& vertex_coordinates, const Grid& grid);
/// The same for a diagram, for clipped cells and for the extreme points that a state holds.
void to_world(Voronoi& diagram, const Grid& grid);
void to_world(ClippedCells& cells, const Grid& grid);
void to_world(HullState& state, const Grid& grid);
/// The same for coordinates of points, in place.
void to_world(std::vector<double>& numbers, const Grid& grid);

/// The common grid (as above) of these inputs, from their headers; hull states have the grid on
/// which they were computed. Empty if an input is not a regular file. Throws what open_points
/// throws. Visiting a state of a decimal grid throws Error{invalid_argument} if there is no common
/// grid: it lacks points that rounding could make extreme.
Grid common_grid(const std::vector<std::string>& files, const ReadOptions& options);

/// A coordinate reference system as AUTHORITY:CODE ("EPSG:25832", "OGC:CRS84"), of such a text or
/// of a URN or URL of the OGC ("urn:ogc:def:crs:EPSG::25832"). Empty for any other text.
std::string crs_code(const std::string& text);
/// The same of a WKT (1 or 2): of its projected system, else of its geographic one. Systems without
/// a code are known by name where they are UTM zones of WGS 84, ETRS89 and NAD83, Web Mercator, WGS
/// 84 or ETRS89.
std::string crs_of_wkt(const std::string& wkt);

/// The coordinate reference system that a file states: .las in its GeoTIFF keys or WKT, GeoJSON in
/// its member `crs`, both also compressed; any file in a .prj of its name (a.prj beside a.csv).
/// Empty where it states none that has a code, for standard input, and for what cannot be read.
std::string file_crs(const std::string& path);

/// The one that all inputs state that state any, as file_crs finds it; empty: none, or several.
/// `differing`, if given, receives two inputs that state different ones, if there are such.
std::string common_crs(const std::vector<std::string>& files,
                       std::pair<std::string, std::string>* differing = nullptr);

}  // namespace cullhull
#pragma GCC visibility pop
