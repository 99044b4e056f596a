// Arguments that several subcommands share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "cullhull/options.hpp"
#include "parser.hpp"
#include "placing.hpp"
#include "skipped.hpp"

namespace app {

/// Which points to read: files, format, and columns.
struct InputArguments {
  std::string path;
  std::string format;
  std::uint32_t dimension = 0;
  std::string type;
  std::string columns;
  std::string decimal;  ///< "," or "."; empty: found in the text
  std::string weights;  ///< a column beside the coordinates
  bool raw = false;     ///< the files' own numbers
  bool skip_nan = false;
  /// Instead of the grid that the files have in common: an empty one for coordinates in the world.
  std::optional<cullhull::Grid> grid;
  std::string crs;  ///< as crs_code spells it: of --crs, else what the files state
  /// ReadOptions::blocks_hint, for commands that can read in blocks.
  std::string blocks_hint;
  /// The words as given, for commands that take several files. Their files are one set of points.
  std::vector<std::string> words;

  void add_to(Parser& command);
  /// INPUT may be several words; `last`: the help text for the last of them.
  void add_many_to(Parser& command, const std::string& last = "");
  /// The files that the words stand for (input_files), or the one path.
  std::vector<std::string> files() const;
  /// The same; sets `path` to the name that messages use for all of them, and `crs`.
  std::vector<std::string> find_files();
  /// Refuses options that describe files of points where every file is a .hullstate:
  /// Error{invalid_argument}.
  void check_states(const std::vector<std::string>& files) const;
  /// Refuses --dim and --type for what was read in another format than raw:
  /// Error{invalid_argument}.
  void check_raw(const std::string& format) const;

 private:
  void add_format_to(Parser& command);
};

/// The files that points come from, for messages about a point.
struct Places {
  struct Part {
    std::string name;         ///< of the file
    std::uint64_t first = 0;  ///< number of its first point
    std::optional<std::pair<std::uint64_t, std::uint64_t>> not_finite;  ///< with its line
  };
  std::vector<Part> parts;  ///< in order
  Skipped skipped;          ///< messages name numbers beside these

  /// "FILE:LINE" of the point that a message begins with ("point 7, ..."), or "FILE".
  std::string of(const std::string& message) const;
};

/// An open file and the requested view of it.
struct Input {
  cullhull::PointFile file;
  Places places;
  /// Owns the points where they come from several files.
  std::vector<std::byte> gathered;
  cullhull::PointView points;
  /// With --skip-nan: what is left out of `points`, and a copy of the others where there are any.
  Skipped skipped;
  std::vector<std::byte> others;
  cullhull::PointView kept_points;
  Placing placing;
  std::vector<double> weights;  ///< where InputArguments::weights names a column

  /// The points beside those that are left out; ids are numbers of these, which skipped.restore()
  /// makes ids of the file.
  const cullhull::PointView& kept() const { return skipped.any() ? kept_points : points; }
  /// How many of `points` are left out.
  std::uint64_t skipped_points() const { return points.count == 0 ? 0 : skipped.count(); }
  /// Leaves out points with a NaN, as --skip-nan asks.
  void skip_nan();
  /// Puts copies in the place of points that are left out, for commands that need points of every
  /// id; the result goes through skipped.restore_copies().
  void fill_skipped();
  /// The bytes of memory that it takes, beyond the pages of a mapped file.
  std::uint64_t held() const {
    return file.held_bytes() + gathered.size() + weights.size() * sizeof(double);
  }

  /// Points of one file, its own numbers, take their places on its grid.
  void to_grid(const cullhull::ReadOptions& options);
  /// Points take their coordinates in the world. The placing still names the grid.
  void to_world();
};

/// Adds `--skip-nan`, likewise.
void add_skip_option(Parser& command, bool& skip);
/// Adds `--crs`, common to all commands that write maps.
void add_crs_option(Parser& command, std::string& crs);
/// Refuses what `--crs` does not take, and spells it as crs_code does.
void check_crs(std::string& crs);
/// The system that files state, of points in these columns; a remark where they state several.
std::string stated_crs(const std::vector<std::string>& files, const InputArguments& arguments);

/// Adds `--raw`, common to all commands that read points.
void add_raw_option(Parser& command, bool& raw);

/// `memory`: limit for what is read from a pipe, unpacked or parsed; 0: that of ReadOptions.
Input open_input(const InputArguments& arguments, unsigned threads = 0, std::uint64_t memory = 0);
Input open_input(const InputArguments& arguments, const cullhull::ReadOptions& options);
/// All of these files' points in memory, one after the other.
Input open_inputs(const InputArguments& arguments, const std::vector<std::string>& files,
                  unsigned threads, std::uint64_t memory = 0);

/// A line on standard error where points are so few in so many dimensions that the file looks as if
/// it lay on its side: the condition of the Python package.
void remark_on_shape(const std::string& name, std::uint64_t count, std::uint32_t dimension);
/// Whether the command has --columns, which remarks may then name.
extern bool columns_can_be_chosen;

/// One line on standard error; the same remark about other files is not repeated.
void print_remark(const cullhull::Remark& remark);

/// The options with which open_input would open it.
cullhull::ReadOptions read_options(const InputArguments& arguments, unsigned threads,
                                   std::uint64_t memory = 0);

/// The options of a run, as given on the command line.
struct RunArguments {
  std::string cull = "auto";
  std::string backend = "auto";
  unsigned threads = 0;
  std::string memory;
  bool quiet = false;
  /// Bytes that points and results in memory take of the limit; the rest is for the work.
  std::uint64_t held = 0;

  /// `filter`: with --cull and --backend, which `certify` does not have.
  void add_to(Parser& command, bool filter);
  /// Adds `--memory`, which the filter's options include.
  void add_memory_to(Parser& command);
  cullhull::Options options() const;
  /// The value of --memory; 0 without it.
  std::uint64_t memory_bytes() const;
};

/// "800", "1.5M", "2GiB", "1e6": a whole number with an optional unit (k M G T powers of 1000; Ki
/// Mi Gi Ti powers of 1024; a B may follow). Throws Error{invalid_argument} naming `option`.
std::uint64_t parse_size(std::string_view text, std::string_view option);

/// A whole number below 2^64. Throws Error{invalid_argument} naming `option`.
std::uint64_t parse_whole(std::string_view text, std::string_view option);

/// "standard input" for "-".
std::string input_name(const std::string& path);

/// The number in "point 7, coordinate 0 is NaN", behind "frame 3: " perhaps.
std::optional<std::uint64_t> point_of(std::string_view message);

/// The file and, where it is a text, the line of the point that such a message begins with.
std::string place_of(const std::string& path, const std::string& message);
inline std::string place_of(const Places& places, const std::string& message) {
  return places.of(message);
}

/// The message with the id that the point has in the file.
inline std::string restored(const std::string& /*path*/, const std::string& message) {
  return message;
}
inline std::string restored(const Places& places, const std::string& message) {
  return places.skipped.restored(message);
}

/// Calls read(); an error about a point that is not finite then also names the file and its line.
/// `source`: its path, or Places.
template <class Source, class Read>
auto naming_file(const Source& source, const Read& read) -> decltype(read()) {
  try {
    return read();
  } catch (const cullhull::Error& e) {
    if (e.code() != cullhull::ErrorCode::not_finite) throw;
    const std::string message = restored(source, e.what());
    throw cullhull::Error(e.code(), place_of(source, message) + ": " + message);
  }
}

/// Calls work(); an error about the memory budget then says what else takes the limit: `held`
/// bytes, RunArguments::held.
template <class Work>
void naming_held(std::uint64_t held, const Work& work) {
  try {
    work();
  } catch (const cullhull::Error& e) {
    constexpr std::uint64_t worth_naming = std::uint64_t{1} << 20;
    if (e.code() != cullhull::ErrorCode::out_of_budget || held < worth_naming) throw;
    throw cullhull::Error(e.code(), e.what(), ", beside ", held >> 20,
                          " MiB of points and earlier results");
  }
}
}  // namespace app
