#include "outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "converted.hpp"
#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "cullhull/point_blocks.hpp"
#include "io/json/json_writer.hpp"
#include "parallel/paths.hpp"
#include "system.hpp"
#include "terminal.hpp"

namespace app {

using cullhull::internal::is_map;
using cullhull::internal::is_mesh;
using cullhull::internal::native_path;
using cullhull::internal::utf8_name;

namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& path,
                         const std::string& why) {
  throw cullhull::Error(cullhull::ErrorCode::invalid_argument, option + " " + path + ": " + why);
}

/// An extension without its dot.
std::string_view format_of(const std::string& ending) {
  return ending.empty() ? std::string_view() : std::string_view(ending).substr(1);
}

/// Standard output, a pipe or a device: names that have no extension to check.
bool is_stream(const std::string& path) {
  if (path == "-") return true;
  const system::FileIdentity file = system::identify(path);
  return file.exists && !file.regular && !file.folder;
}

}  // namespace

std::string must_end_in(const Endings& endings) {
  std::string text = "the name must end in ";
  std::size_t left = endings.size();
  for (const std::string_view ending : endings) {
    text += ending;
    --left;
    text += left > 1 ? ", " : left == 1 ? " or " : "";
  }
  return text;
}

bool holds_points(const std::string& path) {
  const std::string ending = ending_of(path);
  return ending == ".ply" || ending == ".xyz" || ending == ".las" || ending == ".geojson";
}

void check_points_dimension(const std::string& path, std::uint32_t dimension) {
  const std::string ending = ending_of(path);
  if ((ending == ".ply" || ending == ".geojson") && dimension != 2 && dimension != 3)
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                          fmt::format("{}: {} holds points of dimension 2 or 3, not {}; write "
                                      ".xyz",
                                      path, ending, dimension));
}

std::string ending_of(const std::string& path) {
  std::string ending = utf8_name(native_path(path).extension());
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return ending;
}

std::string format_of(const Input& input) {
  const std::string& format = input.file.format();
  const std::string read_as = format.empty() ? "hull state" : format;
  return input.places.parts.empty() ? read_as : users_format(input.places.parts[0].name, read_as);
}

bool is_in_place(const Input& input) {
  return input.file.mapped() &&
         (input.places.parts.empty() || !is_converted(input.places.parts[0].name));
}

std::string points_line(const Input& input) {
  const cullhull::PointView& points = input.points;
  return fmt::format("points     {} x {} {}, {}{}\n", grouped(points.count), points.dimension,
                     cullhull::scalar_name(points.scalar), format_of(input),
                     is_in_place(input) ? ", in place" : "");
}

std::string survivors_line(std::uint64_t survivors, std::uint64_t count, std::string_view method) {
  const double share = count == 0 ? 1 : static_cast<double>(survivors) / static_cast<double>(count);
  return fmt::format("survivors  {} ({:.3g} %), cull: {}\n", grouped(survivors), 100 * share,
                     method);
}

std::string measure_lines(int affine_dimension, double area, double volume) {
  if (affine_dimension <= 0) return "";  // no points, or one
  if (affine_dimension == 1) return fmt::format("length     {}\n", volume);
  if (affine_dimension == 2) return fmt::format("perimeter  {}\narea       {}\n", area, volume);
  return fmt::format("area       {}\nvolume     {}\n", area, volume);
}

std::string report_text(std::string_view kind, const cullhull::PointView& points,
                        const nlohmann::ordered_json& members) {
  using cullhull::internal::JsonPoints;
  return cullhull::internal::json_document(
      kind, JsonPoints{points.count, points.dimension, points.scalar}, members);
}

void add_measures(nlohmann::ordered_json& json, int affine_dimension, double area, double volume) {
  cullhull::internal::put_measures(affine_dimension, area, volume,
                                   [&](const char* name, double measure) { json[name] = measure; });
}

std::string wrote_line(const std::string& path) {
  if (path.empty() || path == "-") return "";
  std::error_code not_a_file;
  if (is_converted(path)) return fmt::format("wrote      {}\n", path);  // of another size
  const auto bytes = std::filesystem::file_size(native_path(path), not_a_file);
  return not_a_file ? fmt::format("wrote      {}\n", path)
                    : fmt::format("wrote      {}, {} bytes\n", path, grouped(bytes));
}

// ------------------------------------------------------------------------------- FilePlan

std::optional<FilePlan::Identity> FilePlan::identify(const std::string& path, bool output) {
  const bool stream = path == "-";
  const system::FileIdentity file =
      stream ? system::identify(output ? system::standard_output : system::standard_input)
             : system::identify(path);
  if (file.regular) return Identity{file.device, file.number, ""};
  if (file.exists || stream) return std::nullopt;
  const std::filesystem::path name = native_path(path);
  const std::string folder = name.has_parent_path() ? utf8_name(name.parent_path()) : ".";
  const system::FileIdentity place = system::identify(folder);
  if (!place.exists) return Identity{0, 0, utf8_name(name.lexically_normal())};
  return Identity{place.device, place.number, utf8_name(name.filename())};
}

void FilePlan::reads(const std::string& path) {
  if (const auto identity = identify(cullhull::file_of_input(path), false))
    inputs_.push_back({*identity, "", path});
}

void FilePlan::reads(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) reads(path);
}

void FilePlan::reads_inputs(const std::vector<std::string>& words,
                            const std::vector<std::string>& files) {
  reads(files);
  for (const std::string& word : words)
    if (word.size() > 1 && word[0] == '@') reads(word.substr(1));
}

void FilePlan::claim(const std::string& option, const std::string& path) {
  if (path == "-") prints(option);
  const auto identity = identify(path, true);
  if (!identity) return;
  const auto same = [&](const File& file) { return file.identity == *identity; };
  if (const auto it = std::find_if(inputs_.begin(), inputs_.end(), same); it != inputs_.end())
    refuse(option, path, "would overwrite the input " + input_name(it->path));
  if (const auto it = std::find_if(outputs_.begin(), outputs_.end(), same); it != outputs_.end())
    refuse(option, path, "is the file that " + it->option + " " + it->path + " writes");
  cullhull::check_writable(path);
  outputs_.push_back({*identity, option, path});
}

void FilePlan::prints(const std::string& option) {
  if (!printing_.empty())
    throw cullhull::Error(
        cullhull::ErrorCode::invalid_argument,
        "only one of " + printing_ + " and " + option + " can go to standard output");
  printing_ = option;
}

void FilePlan::writes(const std::string& option, const std::string& path, const Endings& endings) {
  if (path.empty()) return;
  const std::string ending = ending_of(path);
  if (!is_stream(path) && std::find(endings.begin(), endings.end(), ending) == endings.end())
    refuse(option, path, must_end_in(endings));
  claim(option, path);
}

void FilePlan::writes_json(const std::string& path) {
  if (path.empty()) return;
  const std::string ending = ending_of(path);
  const bool json = ending == ".json" || ending == ".geojson";
  const bool page =
      std::find(page_endings.begin(), page_endings.end(), ending) != page_endings.end();
  if (!is_stream(path) && !json && (page || cullhull::internal::is_written(format_of(ending))))
    refuse("--json", path, "JSON is written, which is not what the name says; end it in .json");
  claim("--json", path);
}

void FilePlan::writes_frame(const std::string& path) {
  const auto identity = identify(path, true);
  if (!identity) return;
  const auto same = [&](const File& file) { return file.identity == *identity; };
  if (const auto it = std::find_if(inputs_.begin(), inputs_.end(), same); it != inputs_.end())
    refuse("-o", path, "would overwrite the input " + it->path);
  if (const auto it = std::find_if(outputs_.begin(), outputs_.end(), same); it != outputs_.end())
    refuse("-o", path, "is the file that " + it->option + " writes");
}

void FacesArguments::add_to(Parser& command, const std::string& faces) {
  command.group("Output");
  command.add_flag("--polygons", polygons,
                   "Write " + faces +
                       " as polygons in .ply, .obj, .off and\n.vtp (default: triangles, but for "
                       ".vtp)");
  command.add_flag("--triangles", triangles, "Write triangles in .vtp, too");
}

cullhull::Faces FacesArguments::faces() const {
  return polygons    ? cullhull::Faces::polygons
         : triangles ? cullhull::Faces::triangles
                     : cullhull::Faces::by_format;
}

void FacesArguments::check(const std::vector<std::string>& outputs) const {
  if (!polygons && !triangles) return;
  if (polygons && triangles)
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                          "--polygons and --triangles exclude each other");
  for (const std::string& path : outputs)
    for (const std::string_view ending : {".ply", ".obj", ".off", ".vtp"})
      if (ending_of(path) == ending) return;
  throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                        polygons ? "--polygons" : "--triangles",
                        " is of meshes: write -o FILE.ply, .obj, .off or .vtp");
}

void add_json_option(Parser& command, std::string& path, const std::string& what) {
  command.group("Output");
  needs_value(
      *command.add_option("--json", path, what + " as JSON, on standard output\nor in FILE"))
      .type_name("[=FILE]");
}

void check_hull_dimension(const std::string& path, std::uint32_t dimension) {
  const std::string ending = ending_of(path);
  if (is_map(format_of(ending)) && dimension != 2)
    refuse("-o", path,
           fmt::format("a geometry needs points of dimension 2, not {}; write .json", dimension));
  if (is_mesh(format_of(ending)) && dimension != 2 && dimension != 3)
    refuse("-o", path,
           fmt::format("a mesh needs points of dimension 2 or 3, not {}; write .json", dimension));
}

}  // namespace app
