// Ids of points, and points by their ids: .npy, .ply, .csv, .txt, .xyz.
#include <cstring>

#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "io/coordinates.hpp"
#include "io/records.hpp"
#include "io/source.hpp"
#include "io/write/mesh.hpp"
#include "io/write/output_file.hpp"
#include "io/write/output_formats.hpp"

namespace cullhull::internal::inline io {
namespace {

/// Writes the rows packed, little-endian.
void write_rows(OutputFile& out, const Coordinates& points, const std::vector<std::uint64_t>& ids) {
  const std::size_t size = scalar_size(points.scalar);
  std::vector<char> row(points.dimension * size);
  for (const std::uint64_t id : ids) {
    for (std::uint32_t j = 0; j < points.dimension; ++j)
      std::memcpy(row.data() + j * size, points.address(id, j), size);
    little_endian_items(row.data(), row.size(), size);
    out.write({row.data(), row.size()});
  }
}

/// PLY's own words for scalar types.
const char* ply_type(ScalarType type) {
  constexpr const char* words[] = {"float", "double", "char", "uchar",
                                   "short", "ushort", "int",  "uint"};
  return words[static_cast<std::size_t>(type)];
}

void write_ply_points(OutputFile& out, const Coordinates& points,
                      const std::vector<std::uint64_t>& ids) {
  std::string head = "ply\nformat binary_little_endian 1.0\nelement vertex ";
  append_number(head, std::uint64_t{ids.size()});
  for (std::uint32_t j = 0; j < points.dimension; ++j)
    head.append("\nproperty ").append(ply_type(points.scalar)).append({' ', "xyz"[j]});
  out.write(head += "\nend_header\n");
  write_rows(out, points, ids);
}

/// Every number as a double: the shortest decimal of a 32-bit float would read back as another
/// double.
void write_text_points(OutputFile& out, const Coordinates& points,
                       const std::vector<std::uint64_t>& ids, char separator) {
  std::string line;
  for (const std::uint64_t id : ids) {
    line.clear();
    for (std::uint32_t j = 0; j < points.dimension; ++j) {
      append_number(line, points.at(id, j));
      line += j + 1 < points.dimension ? separator : '\n';
    }
    out.write(line);
  }
}

/// "x,y,z", or "x0,x1,..." beyond three dimensions.
std::string column_names(std::uint32_t dimension) {
  std::string names;
  for (std::uint32_t j = 0; j < dimension; ++j) {
    if (dimension <= 3)
      names += "xyz"[j];
    else
      names.append("x").append(std::to_string(j));
    names += j + 1 < dimension ? ',' : '\n';
  }
  return names;
}

}  // namespace
}  // namespace cullhull::internal::inline io

namespace cullhull::inline v1 {

void write_ids(const std::string& path, const std::vector<std::uint64_t>& ids,
               const std::string& format) {
  using namespace internal;
  const std::string f = output_format(path, format, "npy");
  if (f == "npy") return write_npy_ids(path, ids);
  if (!holds(f, {OutputKind::ids})) refuse_format(path, f, {OutputKind::ids});
  OutputFile out(path);
  if (f == "csv") out.write("id\n");
  std::string line;
  for (const std::uint64_t id : ids) {
    line.clear();
    append_number(line, id);
    out.write(line += '\n');
  }
  out.commit();
}

namespace {

void write_points_of(const std::string& path, const internal::Coordinates& points,
                     const std::vector<std::uint64_t>& ids, const std::string& format) {
  using namespace internal;
  const std::string f = output_format(path, format, "npy");
  if (!holds(f, {OutputKind::points})) refuse_format(path, f, {OutputKind::points});
  if (f == "ply" && points.dimension != 2 && points.dimension != 3)
    throw Error(ErrorCode::invalid_argument, ".ply holds points of 2 and 3 dimensions, not of ",
                points.dimension);
  OutputFile out(path);
  if (f == "npy") {
    out.write(npy_header(npy_descr(points.scalar).c_str(), {ids.size(), points.dimension}));
    write_rows(out, points, ids);
  } else if (f == "ply") {
    write_ply_points(out, points, ids);
  } else {
    if (f == "csv") out.write(column_names(points.dimension));
    write_text_points(out, points, ids, f == "csv" ? ',' : ' ');
  }
  out.commit();
}

}  // namespace

void write_points(const std::string& path, const PointView& points,
                  const std::vector<std::uint64_t>& ids, const std::string& format) {
  write_points_of(path, points, ids, format);
}

void write_points(const std::string& path, const HullState& state, const std::string& format) {
  write_points_of(path, state, state.ids(), format);
}

}  // namespace cullhull::inline v1
