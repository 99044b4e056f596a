// Reading points and writing hulls. docs/formats.md describes every format.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cullhull/certify.hpp"
#include "cullhull/hull_fwd.hpp"
#include "cullhull/placement.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/stop_token.hpp"
#include "cullhull/stream.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// What the coordinates of a file with a Placement (.las) mean; other files' numbers are
/// coordinates.
enum class Numbers {
  /// World coordinates, as doubles: on a decimal grid (common_grid) the nearest ones, else number *
  /// scale + offset, as laspy computes them.
  world,
  grid,  ///< exact integers on a common grid, for computing; world coordinates if there is no grid
  file,  ///< the file's own integers, read in place, for a caller who places them; with a column of
         ///< doubles (gps_time) world coordinates
  raw,   ///< the same whatever scale and offset are; the others refuse those that place no point
};

/// A choice that a reader made by itself, or data that it skipped.
struct Remark {
  std::string file;     ///< name of the file
  std::string message;  ///< part of a line, without the file's name
  /// Whether it says which columns of a text are the coordinates; ReadOptions::columns selects
  /// others. Otherwise how a text was understood (decimal commas, a line of units, row names of R),
  /// what was left out after the points, or how many points ReadOptions::skip_nan left out.
  bool of_columns = false;

  std::string line() const { return file + ": " + message; }
  operator std::string() const { return line(); }
};

/// The names of the formats of points: "npy", "ply", ..., "raw".
std::vector<std::string> input_formats();

struct ReadOptions {
  /// One of input_formats(); empty: detected from the extension, then from the content.
  std::string format{};
  /// Dimension and scalar type of raw input; required for it.
  std::uint32_t raw_dimension = 0;
  std::optional<ScalarType> raw_scalar{};
  /// Which columns are the coordinates, in this order: names, numbers from 0 and ranges a:b (b
  /// excluded), separated by commas ("x,y,z", "0,2,5", "1:4"); a name may be in double quotes.
  /// Empty: of a text with names of columns those whose names are known coordinates (x, y, z, lon,
  /// lat, easting, ... docs/formats.md); names of which none is known are refused. Without names
  /// all columns. A text's names are those in its first line, else in a comment before the points;
  /// mesh and scan formats have x, y, z, and by name the other fields of their records (.las, .ply,
  /// .pcd, a structured .npy) or the properties of GeoJSON's features. Other columns of a text may
  /// hold anything.
  std::string columns{};
  /// A column that holds a weight for each point (PointFile::weights), named as in `columns`. It is
  /// a coordinate only if `columns` names it, too. For open_points only, and not together with
  /// `key`.
  std::string weights{};
  /// The column that holds the group of each point, named as in `columns`. It is a coordinate only
  /// if `columns` names it, too. BlockVisitor::keyed receives its values as written in the file.
  std::string key{};
  /// Called for each remark, from any thread. A function that takes std::string gets
  /// Remark::line().
  std::function<void(const Remark&)> remark{};
  /// Limit in bytes for the memory that open_points takes: what it reads from a pipe, unpacks
  /// (.gz, .zst, .npz) and parses, but not the pages of a mapped file. 0: half of the memory that
  /// the process may use. visit_blocks needs memory for a few blocks alone.
  std::uint64_t memory_budget = 0;
  Numbers numbers = Numbers::world;
  /// For Numbers::grid: the grid, from common_grid of all inputs; not set: the file's own grid;
  /// empty grid: world coordinates.
  std::optional<Grid> grid{};
  /// Threads that parse text; 0: std::thread::hardware_concurrency().
  unsigned threads = 0;
  /// Leaves out points with a NaN coordinate, which is how scanners mark pulses without a return
  /// (.pcd, .ply). Ids remain the file's: PointFile::rows() has the number in the file of each
  /// point, and visit_blocks passes on the points between those left out with the ids that they
  /// have. Infinities are not left out. Not for open_sequence, where point i of a frame is point i
  /// of the next.
  bool skip_nan = false;
  /// Checked while text is parsed.
  stop_token stop{};
  /// The decimal mark of the numbers in a text: '.' or ','. With ',' a comma separates nothing. 0:
  /// commas are decimal marks where semicolons, tabs or the names of columns leave no other meaning
  /// (said by `remark`); where a comma could be either, the text is refused. Other formats refuse
  /// ','.
  char decimal = 0;
  /// Advice that ends the message of an out_of_budget error where visit_blocks would read the input
  /// in blocks, for instance how a program's user asks for that. The text must outlive the call.
  const char* blocks_hint = nullptr;
};

/// Points of a file: mapped (binary) or parsed (text, meshes). Movable; `points()` is a view of its
/// memory.
class PointFile {
 public:
  PointFile();
  PointFile(PointFile&&) noexcept;
  PointFile& operator=(PointFile&&) noexcept;
  ~PointFile();

  const PointView& points() const noexcept;
  /// Red, green and blue of every point (u8, dimension 3), if a PLY file has them; else no points.
  const PointView& colours() const noexcept;
  /// Scale and offset of the file's numbers, for each axis of points().
  const Placement& placement() const noexcept;
  /// The weights that ReadOptions::weights selects, one per point of points(); empty if not
  /// requested.
  const std::vector<double>& weights() const noexcept;
  /// The grid whose units points() are in; empty unless Numbers::grid was requested.
  const Grid& grid() const noexcept;
  /// Converts a file's own numbers to grid units, or to world coordinates if there is no grid, as
  /// ReadOptions with Numbers::grid reads them. Call once.
  void to_grid(const ReadOptions& options);
  /// Converts grid units or a file's own numbers to world coordinates. Call once.
  void to_world();
  const std::string& format() const noexcept;  ///< "npy", "ply (binary little-endian)", ...
  /// The columns that are the coordinates, in order: their names, or their numbers from 0 where
  /// they have none. ReadOptions::columns selects others. Empty: more than 65,536.
  std::vector<std::string> columns() const;
  bool mapped() const noexcept;  ///< true if the file is read in place
  /// The number in the file (from 0) of each point of points(), ascending, if
  /// ReadOptions::skip_nan left out others; else empty: point i has the number i. An
  /// increasing function of the ids: hull.rename([&](std::uint64_t i) { return file.rows()[i]; }).
  const std::vector<std::uint64_t>& rows() const noexcept;
  /// The number of points that ReadOptions::skip_nan left out.
  std::uint64_t skipped() const noexcept;
  /// The first point with a NaN or an infinity in a text file, and its line, from 1.
  std::optional<std::pair<std::uint64_t, std::uint64_t>> first_not_finite() const noexcept;
  double read_seconds() const noexcept;
  /// The bytes of memory that the points take, beyond the pages of a mapped file.
  std::uint64_t held_bytes() const noexcept;

 private:
  friend PointFile open_points(const std::string& path, const ReadOptions& options);
  struct Impl;
  explicit PointFile(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Opens `path` ("-": standard input; FILE.npz:NAME: an array in an archive; FILE.h5:/GROUP/NAME: a
/// dataset of an HDF5 or NetCDF-4 file). Unpacks gzip and zstd. Throws Error{io} or
/// Error{bad_file}, which name the file and line or byte offset; Error{out_of_budget} before it
/// takes more memory than ReadOptions::memory_budget.
PointFile open_points(const std::string& path, const ReadOptions& options = {});

/// The line (from 1) of a point in an uncompressed text file, for messages; empty for other formats
/// and on read errors. In text formats of meshes only the first point that is not finite has one.
/// Takes as long as reading the file.
std::optional<std::uint64_t> line_of_point(const std::string& path, std::uint64_t point) noexcept;

/// The columns of a table that are coordinates by their names, in order, as open_points takes them
/// from a text: known names (docs/formats.md), else, with `series`, the only column or a series
/// such as a b c or dim_0 dim_1, beside which columns may number the points. Empty: the names do
/// not say.
std::vector<std::uint32_t> coordinate_columns(const std::vector<std::string>& names,
                                              bool series = true);

/// Moving points, frame by frame: an array (frames, n, d) in an .npy file, of which one frame at a
/// time is mapped (so a sequence may exceed memory), or one file of points per frame.
class PointSequence {
 public:
  PointSequence();
  PointSequence(PointSequence&&) noexcept;
  PointSequence& operator=(PointSequence&&) noexcept;
  ~PointSequence();

  std::uint64_t frames() const noexcept;
  /// Moves to the next frame; false after the last one. Invalidates the view of the previous frame.
  /// Throws as open_points does.
  bool next();
  /// The current frame; empty before next() is called.
  const PointView& points() const noexcept;
  /// Index of the current frame, from 0, and the file that it comes from.
  std::uint64_t index() const noexcept;
  const std::string& name() const noexcept;
  const std::string& format() const noexcept;
  const Grid& grid() const noexcept;  ///< as PointFile::grid(), the same for all frames
  /// As PointFile::placement(), of the current frame; empty before next() and for arrays.
  const Placement& placement() const noexcept;
  /// As PointFile::columns(), of the current frame; empty before next().
  const std::vector<std::string>& columns() const noexcept;
  double read_seconds() const noexcept;  ///< for the current frame

 private:
  friend PointSequence open_sequence(const std::vector<std::string>& paths,
                                     const ReadOptions& options);
  struct Impl;
  explicit PointSequence(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Each of `paths` is a file, a folder (its files, without hidden ones) or a pattern with * ? [ ].
/// If some files of a folder have the extension of a known format, the others are skipped and named
/// by options.remark, unless options.format names the format. Files of folders and patterns are
/// sorted by name, numbers in names by value (2 before 10). An .npy array (frames, n, d) must be
/// the only path. Throws Error{io}, Error{bad_file}.
PointSequence open_sequence(const std::vector<std::string>& paths, const ReadOptions& options = {});

/// The files that such paths stand for, in that order.
std::vector<std::string> sequence_files(const std::vector<std::string>& paths,
                                        const ReadOptions& options = {});

/// For a SIGBUS handler (async-signal-safe; the library installs none): the name of the open
/// PointFile whose mapping contains `address`, or nullptr. The kernel sends SIGBUS when a mapped
/// file shrinks while it is read. The name is valid as long as the PointFile is open.
const char* describe_mapped_fault(const void* address) noexcept;

/// For a handler of SIGSEGV, SIGBUS, SIGFPE or SIGABRT (async-signal-safe): the name of the HDF5
/// file that libhdf5 is reading on this thread, or nullptr. Some damaged files crash it.
const char* describe_library_fault() noexcept;

/// The version of docs/cullhull.schema.json, which every document states in its member "schema". It
/// increases when a member is removed or changes its meaning, not when members are added.
inline constexpr int json_schema_version = 2;

/// How a mesh file (.ply .obj .off .vtp) stores facets with more than three corners.
enum class Faces {
  polygons,   ///< as polygons
  triangles,  ///< as triangles: the hull's simplices
  /// Triangles in .ply, .off and .obj, of which several programs read nothing else right (trimesh
  /// and PyVista of .ply, Open3D of .obj); polygons in .vtp.
  by_format,
};

/// The keys (ReadOptions::key) of points, concatenated.
struct PointKeys {
  std::string text;
  std::vector<std::uint64_t> ends;  ///< end of each key in `text`

  std::size_t size() const noexcept { return ends.size(); }
  std::string_view operator[](std::size_t i) const {
    const auto begin = static_cast<std::size_t>(i > 0 ? ends[i - 1] : 0);
    return std::string_view(text).substr(begin, static_cast<std::size_t>(ends[i]) - begin);
  }
  void add(std::string_view key) {
    text += key;
    ends.push_back(text.size());
  }
};

/// A value for each point, to be written beside what belongs to one point.
struct PointColumn {
  std::string name;
  PointKeys values;      ///< one per point of the input; an empty one is missing
  bool numeric = false;  ///< whether all values are JSON numbers, or missing
};

/// What programs for maps want to know beside the shapes. Files that hold only shapes leave it out.
struct MapExtras {
  /// The coordinate reference system, as crs_code spells it: the member `crs` of .geojson, as GDAL
  /// writes it; for WGS 84 there is none (RFC 7946). Empty: unknown.
  std::string crs{};
  /// For .geojson, and .csv of points. What belongs to a single point gets its value; a triangle,
  /// hull or shape the value that its points have in common (of a shape without groups: all
  /// points), null where they differ.
  std::vector<PointColumn> columns{};
};

/// Writes `hull` in the format of the extension of `path` (.ply .obj .off .stl .glb .vtp .geojson
/// .wkt .json .txt) or in `format`: one of these names or of qhull_formats(). The bytes depend only
/// on points and hull, so .json holds the result without times. The file appears complete or not at
/// all (written under another name, then renamed); "-", pipes and devices are written directly.
/// Throws Error{invalid_argument} if the format cannot hold the hull's dimension, Error{io} with
/// the system's reason.
void write_hull(const std::string& path, const PointView& points, const Hull& hull,
                const std::string& format = "", Faces faces = Faces::by_format,
                const MapExtras& extras = {});
/// The same with the coordinates that the hull carries (Options::with_coordinates). Throws
/// Error{invalid_argument} for formats that list every point and for a hull without coordinates.
void write_hull(const std::string& path, const Hull& hull, const std::string& format = "",
                Faces faces = Faces::by_format, const MapExtras& extras = {});
/// The same bytes from the points' state and its hull(). Throws Error{invalid_argument} for formats
/// that list every point.
void write_hull(const std::string& path, const HullState& state, const Hull& hull,
                const std::string& format = "", Faces faces = Faces::by_format,
                const MapExtras& extras = {});

/// For a handler of SIGINT or SIGTERM (async-signal-safe): removes the temporary files of
/// unfinished writers.
void remove_unfinished_files() noexcept;

/// Reads a document of write_hull(".json"), of this schema version or an earlier one. Checks every
/// size, offset and index, so the result can be passed to certify(); statistics are not in the
/// file. `vertex_coordinates`, if given, receives the rows of that key, in the order of `vertices`;
/// with Options::with_coordinates the hull carries them. `first_id`: the id of point 0 in the file;
/// the result counts from 0. Options used: stop, poll, with_coordinates. Throws Error{bad_file},
/// Error{io} or Error{cancelled}.
Hull hull_from_json(const std::string& path, std::vector<double>* vertex_coordinates = nullptr,
                    const Options& options = {}, std::uint64_t first_id = 0);

/// certify() of the hull in such a file; the file's `vertex_coordinates` must also equal those of
/// the points. Points on a grid are compared with the file in world coordinates. `first_id`: the id
/// of point 0 in the file. Throws what hull_from_json and certify throw.
Certificate certify_file(const PointView& points, const std::string& path,
                         const Options& options = {}, const Grid& grid = {},
                         std::uint64_t first_id = 0);

/// Throws Error{io} if a file of this name cannot be written; for a check before long work. Does
/// not change an existing file.
void check_writable(const std::string& path);

/// Text as Qhull's `qconvex` prints it; `what` is one of qhull_formats(), described in
/// docs/formats.md. Throws Error{invalid_argument} for other words, with the reason for words that
/// only Qhull supports, and for G, m and FM if the hull is neither 2D nor 3D.
std::string hull_to_qhull_text(const PointView& points, const Hull& hull, std::string_view what);
/// The same from a state; o, f, FF, Ft and FN, which list every point, are refused.
std::string hull_to_qhull_text(const HullState& state, const Hull& hull, std::string_view what);

/// The words that hull_to_qhull_text accepts.
const std::vector<std::string>& qhull_formats();

/// Throws the error that hull_to_qhull_text throws for this word, for any hull.
void check_qhull_format(std::string_view what);

/// Writes a text file as write_hull does: complete or not at all.
void write_text(const std::string& path, std::string_view text);

/// Writes point ids in the format of the extension of `path` or `format`: .npy (int64), .txt (one
/// per line), .csv (the same after a header line "id"); default for "-", pipes and devices: .npy.
/// Throws Error{invalid_argument} for another extension, Error{io}.
void write_ids(const std::string& path, const std::vector<std::uint64_t>& ids,
               const std::string& format = "");

/// Writes the points with these ids, in that order: .npy and .ply keep the scalar type (.ply: 2D
/// and 3D); .xyz, .txt and .csv are decimals that read back as the same numbers, .csv after a line
/// of column names; .geojson (2D and 3D) has a Point for each, with its id. The columns of `extras`
/// go into .csv and .geojson; other formats refuse them. Throws as write_ids does.
void write_points(const std::string& path, const PointView& points,
                  const std::vector<std::uint64_t>& ids, const std::string& format = "",
                  const MapExtras& extras = {});
/// The same for the extreme points that a state holds.
void write_points(const std::string& path, const HullState& state, const std::string& format = "",
                  const MapExtras& extras = {});

/// Writes the records of the LAS or LAZ file `las` (any name that open_points accepts) with these
/// ids, ascending, as a LAS file. All fields of these records, scale, offset, point format and
/// other records are the same bytes; the header's counts and box describe the new file. Throws
/// Error{bad_file} unless `las` is one, Error{invalid_argument} for an id out of range or another
/// extension than .las.
void write_las_records(const std::string& path, const std::string& las,
                       const std::vector<std::uint64_t>& ids);

/// Ids as (n) int64, points as (n, d), in NumPy's format.
void write_npy_ids(const std::string& path, const std::vector<std::uint64_t>& ids);
void write_npy_points(const std::string& path, const double* coordinates, std::uint64_t count,
                      std::uint32_t dimension, ScalarType type);

/// Writes points piece by piece, in the format of the extension of `path` (without one .npy) or of
/// `format`: .npy .ply .obj .off .raw .xyz .txt .csv, and .geojson .wkt as one multipoint.
/// .ply .geojson .wkt hold points of dimension 2 and 3, .obj of 3. .npy .ply .raw keep `type`; the
/// others hold decimals that read back as the same numbers. The file appears once the last point is
/// written. Throws Error{invalid_argument} for other names and dimensions, else as the other
/// writers do.
class PointsWriter {
 public:
  PointsWriter(const std::string& path, std::uint64_t count, std::uint32_t dimension,
               ScalarType type, const std::string& format = "");
  ~PointsWriter();
  /// The next points: count x dimension doubles, which are rounded to `type`.
  void write(const double* coordinates, std::uint64_t count);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cullhull
#pragma GCC visibility pop
