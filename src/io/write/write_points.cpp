// Ids of points, points by their ids (.npy, .ply, .csv, .txt, .xyz, .geojson), and points in
// pieces.
#include <cstring>
#include <memory>

#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "io/coordinates.hpp"
#include "io/file_formats.hpp"
#include "io/formats/geometry_text.hpp"
#include "io/json/json_text.hpp"
#include "io/records.hpp"
#include "io/source.hpp"
#include "io/write/mesh.hpp"
#include "io/write/output_file.hpp"

namespace cullhull::internal {
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

std::string ply_head(std::uint64_t count, std::uint32_t dimension, ScalarType type) {
  std::string head = "ply\nformat binary_little_endian 1.0\nelement vertex ";
  append_number(head, count);
  for (std::uint32_t j = 0; j < dimension; ++j)
    head.append("\nproperty ").append(ply_type(type)).append({' ', "xyz"[j]});
  return head += "\nend_header\n";
}

/// Every number as a double: the shortest decimal of a 32-bit float would read back as another
/// double.
void write_text_points(OutputFile& out, const Coordinates& points,
                       const std::vector<std::uint64_t>& ids, char separator,
                       const std::vector<PointColumn>& columns) {
  std::string line;
  for (const std::uint64_t id : ids) {
    line.clear();
    for (std::uint32_t j = 0; j < points.dimension; ++j) {
      if (j > 0) line += separator;
      append_number(line, points.at(id, j));
    }
    for (const PointColumn& column : columns) append_csv(line += separator, column.values[id]);
    out.write(line += '\n');
  }
}

/// A Point with its id for each.
void write_geojson_points(OutputFile& out, const Coordinates& points,
                          const std::vector<std::uint64_t>& ids, const MapExtras& extras) {
  out.write("{\"type\": \"FeatureCollection\", " + crs_member(extras.crs) + "\"features\": [");
  std::string line;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    line = i > 0 ? ",\n" : "\n";
    line += "{\"type\": \"Feature\", \"properties\": {\"id\": ";
    append_json_number(line, ids[i]);
    for (const PointColumn& column : extras.columns) append_property(line, column, ids[i], {"id"});
    line += "}, \"geometry\": {\"type\": \"Point\", \"coordinates\": [";
    for (std::uint32_t j = 0; j < points.dimension; ++j) {
      if (j > 0) line += ", ";
      append_json_number(line, points.at(ids[i], j));
    }
    out.write(line += "]}}");
  }
  out.write("\n]}\n");
}

/// "x,y,z", or "x0,x1,..." beyond three dimensions.
std::string axis_names(std::uint32_t dimension) {
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
}  // namespace cullhull::internal

namespace cullhull {

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
                     const std::vector<std::uint64_t>& ids, const std::string& format,
                     const MapExtras& extras) {
  using namespace internal;
  const std::string f = output_format(path, format, "npy");
  if (!holds(f, {OutputKind::points})) refuse_format(path, f, {OutputKind::points});
  if ((f == "ply" || f == "geojson") && points.dimension != 2 && points.dimension != 3)
    throw Error(ErrorCode::invalid_argument, ".", f, " holds points of 2 and 3 dimensions, not of ",
                points.dimension);
  if (!extras.columns.empty() && f != "csv" && f != "geojson")
    throw Error(ErrorCode::invalid_argument, ".", f,
                " holds coordinates alone; .csv and .geojson hold columns beside them");
  OutputFile out(path);
  if (f == "npy") {
    out.write(npy_header(npy_descr(points.scalar).c_str(), {ids.size(), points.dimension}));
    write_rows(out, points, ids);
  } else if (f == "ply") {
    out.write(ply_head(ids.size(), points.dimension, points.scalar));
    write_rows(out, points, ids);
  } else if (f == "geojson") {
    write_geojson_points(out, points, ids, extras);
  } else {
    if (f == "csv") {
      std::string names = axis_names(points.dimension);
      names.pop_back();
      for (const PointColumn& column : extras.columns)
        append_csv(names += ',', name_beside(column.name, {"x", "y", "z"}));
      out.write(names += '\n');
    }
    write_text_points(out, points, ids, f == "csv" ? ',' : ' ', extras.columns);
  }
  out.commit();
}

}  // namespace

void write_points(const std::string& path, const PointView& points,
                  const std::vector<std::uint64_t>& ids, const std::string& format,
                  const MapExtras& extras) {
  write_points_of(path, points, ids, format, extras);
}

void write_points(const std::string& path, const HullState& state, const std::string& format,
                  const MapExtras& extras) {
  write_points_of(path, state, state.ids(), format, extras);
}

// ---------------------------------------------------------------------------- PointsWriter

namespace {

/// What stands around and between the coordinates of a text of points; of a binary file its head.
struct PointsFrame {
  std::string head, before{}, between{}, after{}, next{}, tail{};
};

PointsFrame points_frame(const std::string& format, std::uint64_t count, std::uint32_t dimension,
                         ScalarType type) {
  if (format == "raw") return {""};
  if (format == "ply") return {internal::ply_head(count, dimension, type)};
  if (format == "npy")
    return {internal::npy_header(internal::npy_descr(type).c_str(), {count, dimension})};
  const std::string number = std::to_string(count), d = std::to_string(dimension);
  if (format == "csv") return {internal::axis_names(dimension), "", ",", "", "\n", "\n"};
  if (format == "obj") return {"", "v ", " ", "", "\n", "\n"};
  if (format == "off") {
    const std::string kind = dimension == 3 ? "OFF\n" : "nOFF\n" + d + "\n";
    return {kind + number + " 0 0\n", "", " ", "", "\n", "\n"};
  }
  if (format == "geojson")
    return {R"({"type": "MultiPoint", "coordinates": [)", "[", ", ", "]", ",\n", "]}\n"};
  if (format == "wkt") {
    const std::string tag = dimension == 3 ? "MULTIPOINT Z " : "MULTIPOINT ";
    if (count == 0) return {tag + "EMPTY", "", "", "", "", "\n"};
    return {tag + "(", "(", " ", ")", ",\n", ")\n"};
  }
  return {"", "", " ", "", "\n", "\n"};
}

void check_made_dimension(const std::string& format, std::uint32_t dimension) {
  const bool in_space_alone = format == "obj";
  const bool up_to_space = format == "ply" || format == "geojson" || format == "wkt";
  if ((in_space_alone && dimension != 3) || (up_to_space && dimension != 2 && dimension != 3))
    throw Error(ErrorCode::invalid_argument, ".", format, " holds points of dimension ",
                in_space_alone ? "3" : "2 or 3", ", not ", dimension);
}

}  // namespace

struct PointsWriter::Impl {
  std::unique_ptr<internal::OutputFile> out;
  std::string format;
  std::uint64_t count, left;
  std::uint32_t dimension;
  ScalarType type;
  PointsFrame frame;

  bool binary() const { return format == "npy" || format == "ply" || format == "raw"; }

  void write_row(std::string& text, const double* row) const {
    text += frame.before;
    for (std::uint32_t j = 0; j < dimension; ++j) {
      if (j > 0) text += frame.between;
      const bool single = type == ScalarType::f32;
      const double number = single ? static_cast<double>(static_cast<float>(row[j])) : row[j];
      if (format == "geojson")
        internal::append_json_number(text, number);
      else
        internal::append_number(text, number);
    }
    text += frame.after;
  }
  void end() {
    if (count > 0 || format == "geojson" || format == "wkt") out->write(frame.tail);
    out->commit();
  }
};

PointsWriter::PointsWriter(const std::string& path, std::uint64_t count, std::uint32_t dimension,
                           ScalarType type, const std::string& format)
    : impl_(new Impl) {
  Impl& impl = *impl_;
  impl.format = internal::output_format(path, format, "npy");
  impl.count = impl.left = count;
  impl.dimension = dimension;
  impl.type = type;
  if (!internal::holds(impl.format, {internal::OutputKind::made}))
    internal::refuse_format(path, impl.format, {internal::OutputKind::made});
  check_made_dimension(impl.format, dimension);
  impl.out = std::make_unique<internal::OutputFile>(path);
  impl.frame = points_frame(impl.format, count, dimension, type);
  impl.out->write(impl.frame.head);
  if (count == 0) impl.end();
}
PointsWriter::~PointsWriter() = default;

void PointsWriter::write(const double* coordinates, std::uint64_t count) {
  Impl& impl = *impl_;
  if (count > impl.left)
    throw Error(ErrorCode::invalid_argument, "more points written than were announced");
  if (count == 0) return;
  if (impl.binary()) {
    internal::write_values(*impl.out, coordinates, count * impl.dimension, impl.type);
  } else {
    std::string text;
    for (std::uint64_t i = 0; i < count; ++i) {
      if (impl.left - i < impl.count) text += impl.frame.next;
      impl.write_row(text, coordinates + i * impl.dimension);
      constexpr std::size_t piece = std::size_t{1} << 16;
      if (text.size() < piece) continue;
      impl.out->write(text);
      text.clear();
    }
    impl.out->write(text);
  }
  if ((impl.left -= count) == 0) impl.end();
}

}  // namespace cullhull
