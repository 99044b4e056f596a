// What the coordinates of a run are, for its summary and its report: of files with scale and offset
// (LAS), and of those that state a coordinate reference system.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cullhull/io.hpp"

namespace app {

/// Where the points of files with a Placement are.
struct Placing {
  cullhull::Placement placement;  ///< of the first file
  cullhull::Grid grid;            ///< whose units the run computed in; empty: rounded doubles
  bool any = false;               ///< whether a file has a placement; otherwise nothing is reported
  bool raw = false;               ///< --raw: the files' own numbers
  std::string crs{};  ///< the coordinate reference system, as crs_code spells it; empty: unknown
  /// With --skip-nan the number of points left out.
  std::optional<std::uint64_t> skipped = {};
  /// The columns that are the coordinates, of the first file, for reports; empty: unknown.
  std::vector<std::string> columns{};
  bool shows_columns = false;  ///< whether the summary names them: of texts, and of chosen columns

  /// `format`: of the first file; `chosen`: --columns.
  void note_columns(std::vector<std::string> names, const std::string& format,
                    const std::string& chosen);
};

/// The box of points that come one after another.
class Extent {
 public:
  void add(const cullhull::PointView& points);
  void add(const Extent& other);
  /// Its lowest and its highest corner, of points on `grid`: two rows; empty without points.
  std::vector<double> corners(const cullhull::Grid& grid) const;

 private:
  std::vector<double> least_, greatest_;
};

/// A report with the members "columns" and "placement", whose extent these corners are.
std::string with_placing(std::string report, const Placing& placing,
                         const std::vector<double>& corners);

/// "skipped    12 points with NaN\n"; empty without --skip-nan.
std::string skipped_line(const Placing& placing);

/// The lines of the columns, of the system and of the points left out; and "units      exact on the
/// grid of 0.001; scale ..., offset ...\nextent     ...\n", where `placing.any`. `points`: those
/// whose box is the extent, in the world.
std::string units_lines(const Placing& placing, const cullhull::PointView& points);

/// The system alone, as a line of a summary.
std::string crs_line(const Placing& placing);

/// The member "placement" of a report (docs/cullhull.schema.json).
nlohmann::ordered_json placing_json(const Placing& placing, const cullhull::PointView& points);

/// "columns    x, y, z\n", where the summary names them.
std::string columns_line(const Placing& placing);

/// A report with that member, "columns", "crs" and "skipped", where there is something to report.
std::string with_placing(std::string report, const Placing& placing,
                         const cullhull::PointView& points);
void add_placing(nlohmann::ordered_json& report, const Placing& placing,
                 const cullhull::PointView& points);

}  // namespace app
