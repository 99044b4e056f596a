// Which writer writes the file.
#include <algorithm>

#include "cullhull/error.hpp"
#include "io/json.hpp"
#include "io/mesh.hpp"
#include "io/output_file.hpp"
#include "io/source.hpp"

namespace cullhull {

void write_hull(const std::string& path, const PointView& points, const Hull& hull,
                const std::string& format) {
  using namespace internal;
  if (points.count != hull.point_count || points.dimension != hull.dimension)
    throw Error(ErrorCode::invalid_argument, "the hull is not that of these points");
  const std::string f = format.empty() ? extension_of(path) : format;
  if (f == "ply" || f == "obj" || f == "off" || f == "stl") {
    const HullMesh mesh = make_mesh(points, hull, f);
    OutputFile out(path);
    if (f == "ply") write_ply(out, mesh);
    if (f == "obj") write_obj(out, mesh);
    if (f == "off") write_off(out, mesh);
    if (f == "stl") write_stl(out, mesh);
    out.commit();
  } else if (f == "json") {
    OutputFile out(path);
    write_result_json(points, hull, [&](const std::string& piece) { out.write(piece); });
    out.commit();
  } else if (f == "txt") {
    // As `p`, with a word after the dimension: so that no reader takes a 1D header for points.
    std::string text = hull_to_qhull_text(points, hull, "p");
    text.insert(text.find('\n'), " vertices of a convex hull");
    OutputFile out(path);
    out.write(text);
    out.commit();
  } else {
    static constexpr std::string_view qhull[] = {"Fx", "i", "o", "n", "p", "FV", "FS"};
    if (std::find(std::begin(qhull), std::end(qhull), f) == std::end(qhull))
      throw Error(ErrorCode::invalid_argument,
                  display_name(path) + ": cannot tell the format from " + quoted_text("." + f) +
                      "; known are .ply .obj .off .stl .json .txt");
    const std::string text = hull_to_qhull_text(points, hull, f);
    OutputFile out(path);
    out.write(text);
    out.commit();
  }
}

}  // namespace cullhull
