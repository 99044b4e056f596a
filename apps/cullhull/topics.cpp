#include "topics.hpp"

#include <string>

#include "io/file_formats.hpp"

namespace app {
namespace {

constexpr const char* formats_head =
    "Input formats, chosen by the extension of the name, otherwise by the content:\n";

constexpr const char* formats_tail =
    "  .gz .zst         any of these formats, compressed\n"
    "  -                standard input; its format is detected from the content\n"
    "\n"
    "The program of the Python package, 'python3 -m cullhull', also reads:\n"
    "  .gpkg .shp .fgb .gml .kml   vertices of all geometries, with pyogrio; FILE.gpkg:LAYER;\n"
    "                   it writes .gpkg .shp .fgb where .geojson is written\n"
    "  .parquet .e57    with pyarrow, with pye57\n"
    "\n"
    "Several inputs:\n"
    "  Files form one set of points, in the order given. An input may also be a folder, a\n"
    "  pattern in quotes ('tiles/*.las') or @LIST, a text file with one input per line. Files of\n"
    "  folders and patterns are ordered by name, with numbers compared by value.\n"
    "\n"
    "Columns:\n"
    "  In a text file with column names, the columns x, y and z, or longitude and latitude, or\n"
    "  easting and northing (with a height) are the coordinates, in many spellings: POINT_X,\n"
    "  lat_dd, X [m], Rechtswert. A series such as x0, x1, x2 or a, b, c is used whole. Other\n"
    "  names are refused. Without names all columns are coordinates. The summary and --json name\n"
    "  the columns used; a note on standard error says where that is not all of them in order.\n"
    "  --columns chooses others, by name (x,y) or by number from 0 (0,2,5 or 1:4). Columns that\n"
    "  are not used may contain text. Decimal commas are read where semicolons or tabs separate\n"
    "  the columns; --decimal , reads them elsewhere.\n"
    "\n"
    "Values:\n"
    "  Floating-point numbers, and integers of up to 32 bits, are used at their exact value. Text\n"
    "  is rounded once, to the nearest double. NaN and infinities are errors that name the file\n"
    "  and, in a text, the line. Points are numbered from 0 in the order of the input.\n"
    "\n"
    "docs/formats.md describes every format in full, and those that are written.";

constexpr const char* units =
    "Coordinates and units:\n"
    "  Every command reads, computes with and writes coordinates in the units of the file. The\n"
    "  values of --box, --alpha and --edge-length are in these units, weights in their square.\n"
    "\n"
    "LAS files:\n"
    "  A .las stores whole numbers with a scale and an offset per axis; the coordinate is\n"
    "  number * scale + offset. Where scale and offset are decimals (0.01, 484000), the points\n"
    "  lie on a decimal grid and the computation is exact on this grid. Tiles with different\n"
    "  offsets share a grid where their offsets differ by multiples of it. Otherwise each\n"
    "  coordinate is rounded once, to the nearest double. The summary and --json report which\n"
    "  applies, with scale, offset, extent and, where the file names it, the unit.\n"
    "  --raw uses the whole numbers themselves.\n"
    "\n"
    "Coordinate reference systems (EPSG codes):\n"
    "  The one that a .las, a .geojson or a .prj beside a file states is reported (crs) and "
    "written\n"
    "  to .geojson, as GDAL does; --crs EPSG:N sets it. Coordinates are never transformed.\n"
    "\n"
    "Longitude and latitude:\n"
    "  Columns lon and lat are used as plane coordinates, in degrees. Areas and lengths are then\n"
    "  in degrees as well; project the points first if they are to be in metres.\n"
    "\n"
    "Measures:\n"
    "  In the plane the perimeter and the area of the polygon are reported; in space, and in\n"
    "  higher dimensions, the area of the boundary and the volume; of a segment its length.";

}  // namespace

const char* const input_footer =
    "Input formats and columns: 'cullhull help formats'; coordinates: 'cullhull help units'.";

const std::vector<Topic>& topics() {
  static const std::string about_formats =
      formats_head + cullhull::internal::help_on_formats() + formats_tail;
  static const std::vector<Topic> all{
      {"formats", "Input formats, several inputs, columns", about_formats.c_str()},
      {"units", "Coordinates, units of LAS files, measures", units},
  };
  return all;
}

}  // namespace app
