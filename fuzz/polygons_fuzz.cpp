// GeoJSON from any bytes: refused in one line, or rings that clip a diagram or are refused.
#include <cmath>

#include "cullhull/voronoi.hpp"
#include "fuzz/read_points.hpp"
#include "io/formats/geometry_text.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<char> bytes(data, data + size);
  cullhull::Polygons polygons;
  try {
    polygons = cullhull::internal::read_polygons({"input", bytes.data(), bytes.size()});
  } catch (const cullhull::Error& error) {
    cullhull::fuzz::check_refusal(error);
    return 0;
  }
  if (polygons.ring_offsets.size() < 2 ||
      polygons.ring_offsets.back() * 2 != polygons.corners.size())
    std::abort();
  for (const double x : polygons.corners)
    if (!std::isfinite(x)) std::abort();
  const double sites[] = {0, 0, 1, 0, 0, 1, 3, 3, -2, 5};
  const auto points = cullhull::PointView::row_major(sites, 5, 2);
  try {
    const cullhull::ClippedCells cells =
        cullhull::clip_voronoi(points, cullhull::delaunay(points), polygons.points(),
                               polygons.ring_offsets, {}, {.threads = 1});
    for (const double m : cells.measures)
      if (!(m >= 0)) std::abort();
    for (const double x : cells.vertices)
      if (!std::isfinite(x)) std::abort();
  } catch (const cullhull::Error& error) {
    if (error.code() != cullhull::ErrorCode::invalid_argument) std::abort();
  }
  return 0;
}
