// Common output of several subcommands, and checks of output names.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arguments.hpp"
#include "cullhull/io.hpp"
#include "io/file_formats.hpp"

namespace app {

using cullhull::internal::OutputKind;

/// "npy", "las 1.4, point format 6": of the first input, as the user knows it.
std::string format_of(const Input& input);

/// Whether the user's file is read where it lies.
bool is_in_place(const Input& input);

/// "points     20,000 x 3 f64, npy, in place\n"
std::string points_line(const Input& input);

/// "survivors  1,000 (5 %), cull: gauge\n", of `count` points.
std::string survivors_line(std::uint64_t survivors, std::uint64_t count, std::string_view method);

/// The measures of a hull of this dimension, by the names used there: in the plane perimeter and
/// area.
std::string measure_lines(int affine_dimension, double area, double volume);

/// "wrote      page.html, 1.2 MB\n"; nothing for standard output.
std::string wrote_line(const std::string& path);

/// The text of a JSON report on these points: `members` after what every document begins with.
/// `kind`: its name in docs/cullhull.schema.json.
std::string report_text(std::string_view kind, const cullhull::PointView& points,
                        const nlohmann::ordered_json& members);

/// Adds the measures of a hull of this dimension, by the names of measure_lines.
void add_measures(nlohmann::ordered_json& json, int affine_dimension, double area, double volume);

/// Extensions in small letters, with their dots.
using Endings = std::vector<std::string_view>;

/// The files that a command reads and writes, checked before the work. Each output's extension must
/// match its format, and it must differ from all inputs and other outputs, by whatever link or
/// spelling of the name, so that nothing is overwritten. Refusals are Error{invalid_argument}, and
/// Error{io} where a file cannot be written.
class FilePlan {
 public:
  /// To be called before the outputs are named.
  void reads(const std::string& path);
  void reads(const std::vector<std::string>& paths);
  /// The files that the words of INPUT stand for, and the lists among the words (@LIST).
  void reads_inputs(const std::vector<std::string>& words, const std::vector<std::string>& files);

  /// `option` as on the command line, e.g. "-o". An empty name: no such output. The name must end
  /// in one of `endings`, unless it is "-", a pipe or a device.
  void writes(const std::string& option, const std::string& path, const Endings& endings);
  void writes(const std::string& option, const std::string& path,
              cullhull::internal::OutputKinds kinds) {
    writes(option, path, cullhull::internal::output_endings(kinds));
  }

  /// A report: any name without the extension of another format.
  void writes_json(const std::string& path);

  /// A text whose format is given by an option: any name.
  void writes_any(const std::string& option, const std::string& path) { claim(option, path); }

  /// A frame of a sequence; frames have distinct names.
  void writes_frame(const std::string& path);

  /// Output to standard output.
  void prints(const std::string& option);

  bool uses_stdout() const { return !printing_.empty(); }

 private:
  /// The identity of a regular file: device and inode, or, if it does not exist, its folder and
  /// name.
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
  std::string printing_;  ///< the option that prints to standard output
};

/// --triangles and --polygons: how a mesh stores faces with more than three corners.
struct FacesArguments {
  bool triangles = false;
  bool polygons = false;

  /// `faces`: what has these corners: "merged facets".
  void add_to(Parser& command, const std::string& faces);
  cullhull::Faces faces() const;
  /// Refuses both options together, and one of them where no output is a mesh of polygons.
  void check(const std::vector<std::string>& outputs) const;
};

/// Adds `--json[=FILE]`, common to all commands.
void add_json_option(Parser& command, std::string& path, const std::string& what);

/// "must end in .a, .b or .c"
std::string must_end_in(const Endings& endings);

/// Refuses, before the work, a file that write_hull cannot write for points of this dimension:
/// Error{invalid_argument}, beginning "-o PATH: ".
void check_hull_dimension(const std::string& path, std::uint32_t dimension);

/// The extensions of pages.
inline const Endings page_endings{".html", ".htm"};

/// Whether an output that takes ids or points takes points, by the extension of its name.
bool holds_points(const std::string& path);

/// Refuses, before the work, a file that cannot hold points of this dimension.
void check_points_dimension(const std::string& path, std::uint32_t dimension);

/// The extension of a name in small letters, with its dot.
std::string ending_of(const std::string& path);

}  // namespace app
