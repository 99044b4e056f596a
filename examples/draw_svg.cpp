// Draws a 3D file of points with its hull, seen from an angle, as an SVG:
//   draw_svg INPUT OUTPUT.svg [HEIGHT_FACTOR]
// Grey: points, a fair sample. Orange: what the filter kept. Blue: the hull, its far side faint.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cullhull/cullhull.hpp>
#include <cullhull/io.hpp>
#include <string>

namespace {

struct Camera {
  double centre[3], scale, height;
  struct Seen {
    double x, y, depth;
  };
  Seen see(const cullhull::PointView& p, std::uint64_t id) const {
    constexpr double turn = 0.6, tilt = 0.5;
    const double x = p.at(id, 0) - centre[0], y = p.at(id, 1) - centre[1];
    const double z = (p.at(id, 2) - centre[2]) * height;
    const double u = x * std::cos(turn) - y * std::sin(turn);
    const double v = x * std::sin(turn) + y * std::cos(turn);
    return {480 + scale * u, 300 - scale * (v * std::sin(tilt) + z * std::cos(tilt)),
            v * std::cos(tilt) - z * std::sin(tilt)};
  }
};

Camera look_at(const cullhull::PointView& p, const cullhull::Hull& hull, double height) {
  Camera c{{0, 0, 0}, 1, height};
  double extent = 0;
  for (unsigned j = 0; j < 3; ++j) c.centre[j] = hull.centroid[j];
  for (const std::uint64_t id : hull.vertices)
    extent = std::max(extent, std::hypot(p.at(id, 0) - c.centre[0], p.at(id, 1) - c.centre[1]));
  c.scale = 440 / extent;
  return c;
}

void dots(std::FILE* out, const cullhull::PointView& p, const Camera& camera, std::uint64_t count,
          const std::uint64_t* ids, std::uint64_t most, const char* colour, double width) {
  std::fprintf(out, "<path stroke=\"%s\" stroke-width=\"%g\" stroke-linecap=\"round\" d=\"", colour,
               width);
  const std::uint64_t step = std::max<std::uint64_t>(1, count / most);
  for (std::uint64_t i = 0; i < count; i += step) {
    const Camera::Seen s = camera.see(p, ids != nullptr ? ids[i] : i);
    std::fprintf(out, "M%.1f %.1fh0", s.x, s.y);
  }
  std::fprintf(out, "\"/>\n");
}

/// Facets whose outside faces the viewer, or the others.
void facets(std::FILE* out, const cullhull::PointView& p, const cullhull::Hull& hull,
            const Camera& camera, bool near, const char* style) {
  std::fprintf(out, "<path %s d=\"", style);
  for (std::size_t f = 0; f < hull.facets.size(); ++f) {
    std::string path;
    double area = 0;
    const std::uint64_t first = hull.facets.offsets[f], end = hull.facets.offsets[f + 1];
    for (std::uint64_t k = first; k < end; ++k) {
      const Camera::Seen a = camera.see(p, hull.facets.items[k]);
      const Camera::Seen b = camera.see(p, hull.facets.items[k + 1 < end ? k + 1 : first]);
      area += a.x * b.y - b.x * a.y;
      char step[48];
      std::snprintf(step, sizeof step, "%c%.1f %.1f", k == first ? 'M' : 'L', a.x, a.y);
      path += step;
    }
    if ((area < 0) == near) std::fprintf(out, "%sZ", path.c_str());
  }
  std::fprintf(out, "\"/>\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: draw_svg INPUT OUTPUT.svg [HEIGHT_FACTOR]\n");
    return 2;
  }
  try {
    const cullhull::PointFile file = cullhull::open_points(argv[1]);
    const cullhull::PointView points = file.points();
    const cullhull::Hull hull = cullhull::convex_hull(points);
    if (points.dimension != 3 || hull.affine_dimension != 3) {
      std::fprintf(stderr, "draw_svg: %s holds no three-dimensional set\n", argv[1]);
      return 1;
    }
    const cullhull::Survivors kept = cullhull::cull(points);
    const Camera camera = look_at(points, hull, argc > 3 ? std::atof(argv[3]) : 1);
    std::FILE* out = std::fopen(argv[2], "w");
    if (out == nullptr) {
      std::fprintf(stderr, "draw_svg: cannot write %s\n", argv[2]);
      return 1;
    }
    std::fprintf(out,
                 "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 960 600\">\n"
                 "<rect width=\"960\" height=\"600\" fill=\"#fcfcfb\"/>\n"
                 "<g fill=\"none\" stroke-linejoin=\"round\">\n");
    facets(out, points, hull, camera, false, "stroke=\"#9db7d6\" stroke-width=\".6\"");
    dots(out, points, camera, points.count, nullptr, 6000, "#b9b7b0", 1.1);
    dots(out, points, camera, kept.size(points.count), kept.all ? nullptr : kept.ids.data(), 3000,
         "#e8833a", 1.4);
    facets(out, points, hull, camera, true,
           "fill=\"#2f6db5\" fill-opacity=\".07\" stroke=\"#2f6db5\" stroke-width=\".8\"");
    dots(out, points, camera, hull.vertices.size(), hull.vertices.data(), 1000, "#173f73", 3.5);
    std::fprintf(out, "</g>\n</svg>\n");
    if (std::fclose(out) != 0) {
      std::fprintf(stderr, "draw_svg: cannot write %s\n", argv[2]);
      return 1;
    }
  } catch (const cullhull::Error& e) {
    std::fprintf(stderr, "draw_svg: %s\n", e.what());
    return 1;
  }
}
