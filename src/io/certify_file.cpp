// A result file against its points: the certificate of its hull, and the one list that the hull
// does not have.
#include "io/certify_file.hpp"

#include <string>
#include <vector>

#include "cullhull/hull.hpp"
#include "io/mapped_file.hpp"

namespace cullhull::internal {

Certificate certify_source(const PointView& points, const Source& source, const Options& options,
                           const Grid& grid, std::uint64_t first_id) {
  std::vector<double> rows;
  Hull hull = read_hull_json(source, &rows, options, first_id);
  to_grid(hull, rows, grid);
  Certificate certificate = certify(points, hull, options);
  if (!certificate.valid) return certificate;
  const unsigned d = points.dimension;
  for (std::size_t i = 0; i < hull.vertices.size() && certificate.valid; ++i)
    for (unsigned j = 0; j < d && certificate.valid; ++j)
      if (rows[i * d + j] != points.at(hull.vertices[i], j)) {
        certificate.valid = false;
        certificate.reason = "row " + std::to_string(i) + " of vertex_coordinates is not point " +
                             std::to_string(hull.vertices[i]);
      }
  return certificate;
}

}  // namespace cullhull::internal

namespace cullhull {

Certificate certify_file(const PointView& points, const std::string& path, const Options& options,
                         const Grid& grid, std::uint64_t first_id) {
  const internal::MappedFile file(path);
  const Certificate certificate =
      internal::certify_source(points, file.source(), options, grid, first_id);
  file.check_size();
  return certificate;
}

}  // namespace cullhull
