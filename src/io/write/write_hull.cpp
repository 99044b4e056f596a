// Chooses the writer of a file.
#include <algorithm>

#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "io/file_formats.hpp"
#include "io/formats/geometry_text.hpp"
#include "io/json/json.hpp"
#include "io/source.hpp"
#include "io/system.hpp"
#include "io/write/mesh.hpp"
#include "io/write/output_file.hpp"

namespace cullhull::internal {

std::string output_format(const std::string& path, const std::string& format,
                          const std::string& unnamed) {
  if (!format.empty()) return format;
  system::FileStatus status{};
  const bool has_name =
      path != "-" && (system::status_of(path.c_str(), status) != 0 || system::is_regular(status));
  return has_name ? extension_of(path) : unnamed;
}

void refuse_format(const std::string& path, const std::string& format, OutputKinds kinds) {
  std::string known;
  for (const std::string_view ending : output_endings(kinds)) (known += ' ') += ending;
  throw Error(ErrorCode::invalid_argument, display_name(path), ": cannot tell the format from ",
              quoted_text("." + format), "; expected", known);
}

}  // namespace cullhull::internal

namespace cullhull {

namespace {

/// `Points`: PointView or HullState.
template <class Points>
void write_hull_of(const std::string& path, const Points& of, const Hull& hull,
                   const std::string& format, Faces faces, const MapExtras& extras) {
  using namespace internal;
  const Coordinates points(of);
  points.require_hull(hull);
  const std::string f = output_format(path, format, "json");
  if (is_mesh(f)) {
    write_mesh(path, f, make_mesh(points, hull, f, faces));
  } else if (f == "json") {
    OutputFile out(path);
    write_result_json(
        points, hull, [&](const std::string& piece) { out.write(piece); },
        [&](std::uint64_t count, const TextOfItems& text_of) { out.write_items(count, text_of); });
    out.commit();
  } else if (is_map(f)) {
    write_text(path, geometry_file(points, hull, f, extras));
  } else if (f == "txt") {
    // As `p`, with words after the dimension, so that no reader takes a 1D header for a point.
    std::string text = hull_to_qhull_text(of, hull, "p");
    text.insert(text.find('\n'), " vertices of a convex hull");
    write_text(path, text);
  } else {
    const auto& qhull = qhull_formats();
    if (std::find(qhull.begin(), qhull.end(), f) == qhull.end())
      refuse_format(path, f, {OutputKind::hull});
    write_text(path, hull_to_qhull_text(of, hull, f));
  }
}

}  // namespace

void write_hull(const std::string& path, const PointView& points, const Hull& hull,
                const std::string& format, Faces faces, const MapExtras& extras) {
  write_hull_of(path, points, hull, format, faces, extras);
}

void write_hull(const std::string& path, const Hull& hull, const std::string& format, Faces faces,
                const MapExtras& extras) {
  write_hull_of(path, HullState(hull), hull, format, faces, extras);
}

void write_hull(const std::string& path, const HullState& state, const Hull& hull,
                const std::string& format, Faces faces, const MapExtras& extras) {
  write_hull_of(path, state, hull, format, faces, extras);
}

}  // namespace cullhull
