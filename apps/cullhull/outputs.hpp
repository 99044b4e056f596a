// What several subcommands say and write, and the names they write it under.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arguments.hpp"

namespace app {

/// "points     20,000 x 3 f64, npy, in place\n"
std::string points_line(const Input& input);

/// "survivors  1,000 (5 %), cull: gauge\n", of `count` points.
std::string survivors_line(std::uint64_t survivors, std::uint64_t count, std::string_view method);

/// The measures of a hull of this dimension by their names there: in the plane perimeter and area.
std::string measure_lines(int affine_dimension, double area, double volume);

/// "wrote      page.html, 1.2 MB\n"; nothing for standard output.
std::string wrote_line(const std::string& path);

/// What a JSON report begins with: version, schema, and the number, dimension and type of points.
nlohmann::ordered_json report_head(const cullhull::PointView& points);

/// Endings of names, in small letters and with their dots.
using Endings = std::vector<std::string_view>;

/// The files a command reads and writes, looked at before the work. Each output's name is checked
/// against what is written under it, and against all that is read and written besides: nothing may
/// be overwritten, by whatever link or spelling of its name. Everything refused is
/// Error{invalid_argument}.
class FilePlan {
 public:
  /// To be named before the outputs.
  void reads(const std::string& path);
  void reads(const std::vector<std::string>& paths);

  /// `option` as the user knows it, e.g. "-o". An empty name means there is none. The name must end
  /// in one of `endings`, unless it is "-", a pipe or a device.
  void writes(const std::string& option, const std::string& path, const Endings& endings);

  /// A report: any name that promises no other kind of file.
  void writes_json(const std::string& path);

  /// A text whose format was asked for by name: the file's name promises nothing.
  void writes_any(const std::string& option, const std::string& path) { claim(option, path); }

  /// A frame of a sequence: no two of them share a name.
  void writes_frame(const std::string& path);

  /// Something that is printed on standard output.
  void prints(const std::string& option);

  bool uses_stdout() const { return !printing_.empty(); }

 private:
  /// A regular file, there or not: device, inode and, if it is not there, the name in its folder.
  struct Identity {
    std::uint64_t device = 0, inode = 0;
    std::string name;
    bool operator==(const Identity&) const = default;
  };
  struct File {
    Identity identity;
    std::string option, path;
  };
  static std::optional<Identity> identify(const std::string& path, bool output);
  void claim(const std::string& option, const std::string& path);

  std::vector<File> inputs_, outputs_;
  std::string printing_;  ///< the option whose text goes to standard output
};

/// Adds `--json[=FILE]`, which all commands have.
void add_json_option(Parser& command, std::string& path, const std::string& what);

/// Refuses, before the work, a file that write_hull could not write for points of this dimension:
/// Error{invalid_argument}, beginning "-o PATH: ".
void check_hull_dimension(const std::string& path, std::uint32_t dimension);

/// The endings of the names write_hull, write_ids and write_points know, and those of pages.
inline const Endings hull_endings{".ply", ".obj",     ".off", ".stl",  ".glb",
                                  ".vtp", ".geojson", ".wkt", ".json", ".txt"};
inline const Endings group_endings{".geojson", ".csv", ".json"};
inline const Endings id_endings{".npy", ".csv", ".txt"};
inline const Endings point_endings{".npy", ".ply", ".las", ".csv", ".xyz", ".txt"};
inline const Endings page_endings{".html", ".htm"};

/// The extension of a name in small letters, with its dot.
std::string ending_of(const std::string& path);

}  // namespace app
