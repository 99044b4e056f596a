#include "outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "cullhull/error.hpp"
#include "terminal.hpp"

namespace app {
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw cullhull::Error(cullhull::ErrorCode::invalid_argument, "-o " + path + ": " + why);
}

}  // namespace

std::string points_line(const Input& input) {
  const cullhull::PointView& points = input.points;
  return fmt::format("points     {} x {} {}, {}{}\n", grouped(points.count), points.dimension,
                     cullhull::scalar_name(points.scalar), input.file.format(),
                     input.file.mapped() ? ", in place" : "");
}

std::string survivors_line(std::uint64_t survivors, std::uint64_t count, std::string_view method) {
  const double share = count == 0 ? 1 : static_cast<double>(survivors) / static_cast<double>(count);
  return fmt::format("survivors  {} ({:.3g} %), cull: {}\n", grouped(survivors), 100 * share,
                     method);
}

void check_hull_file(const std::string& path, std::uint32_t dimension) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (extension == ".json" || extension == ".txt") return;
  static constexpr std::string_view meshes[] = {".ply", ".obj", ".off", ".stl"};
  if (std::find(std::begin(meshes), std::end(meshes), extension) == std::end(meshes))
    refuse(path, "the name must end in .ply .obj .off .stl .json or .txt");
  if (dimension != 2 && dimension != 3)
    refuse(path,
           fmt::format("a mesh needs points of dimension 2 or 3, not {}; write .json", dimension));
}

}  // namespace app
