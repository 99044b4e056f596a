// Meshes for viewers: GLB (glTF 2.0 in one file) and VTK's PolyData (.vtp).
#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "cullhull/error.hpp"
#include "io/write/mesh.hpp"
#include "parallel/byte_order.hpp"

namespace cullhull::internal {
namespace {

void append_bytes(std::string& out, const void* data, std::size_t size) {
  out.append(static_cast<const char*>(data), size);
}

void append_word(std::string& out, std::size_t value) {
  const std::uint32_t word = little_endian(static_cast<std::uint32_t>(value));
  append_bytes(out, &word, sizeof word);
}

/// Numbers of four bytes, little-endian.
template <class T>
void write_items(OutputFile& out, const std::vector<T>& items) {
  static_assert(sizeof(T) == 4);
  std::string bytes;
  append_bytes(bytes, items.data(), 4 * items.size());
  little_endian_items(bytes.data(), bytes.size(), 4);
  out.write(bytes);
}

struct Placed {
  std::array<double, 3> centre{};
  std::vector<float> positions;  ///< relative to the centre
  std::array<float, 3> least{}, greatest{};
};

/// Positions as floats relative to the middle of their bounding box, which limits the rounding
/// error.
Placed place(const HullMesh& mesh) {
  Placed p;
  for (unsigned j = 0; j < 3; ++j) {
    double least = std::numeric_limits<double>::infinity(), greatest = -least;
    for (std::size_t i = j; i < mesh.coordinates.size(); i += 3) {
      least = std::min(least, mesh.coordinates[i]);
      greatest = std::max(greatest, mesh.coordinates[i]);
    }
    p.centre[j] = least / 2 + greatest / 2;
    if (!(greatest - p.centre[j] < 0x1.ffffffp127))
      throw Error(ErrorCode::invalid_argument,
                  ".glb holds 32-bit floats, and the hull is larger than they reach; .vtp and .ply "
                  "hold doubles");
  }
  p.positions.reserve(mesh.coordinates.size());
  p.least.fill(std::numeric_limits<float>::infinity());
  p.greatest.fill(-std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < mesh.coordinates.size(); ++i) {
    const auto value = static_cast<float>(mesh.coordinates[i] - p.centre[i % 3]);
    p.positions.push_back(value);
    p.least[i % 3] = std::min(p.least[i % 3], value);
    p.greatest[i % 3] = std::max(p.greatest[i % 3], value);
  }
  return p;
}

template <class T>
std::string triple(const std::array<T, 3>& values) {
  std::string out = "[";
  for (unsigned j = 0; j < 3; ++j) {
    if (j > 0) out += ",";
    append_number(out, static_cast<double>(values[j]));
  }
  return out + "]";
}

std::string gltf_json(const Placed& placed, std::size_t indices) {
  const std::string position_bytes = std::to_string(4 * placed.positions.size());
  return R"({"asset":{"version":"2.0","generator":"cullhull"},"scene":0,"scenes":[{"nodes":[0]}],)"
         R"("nodes":[{"name":"hull","mesh":0,"translation":)" +
         triple(placed.centre) +
         R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"mode":4}]}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":)" +
         std::to_string(placed.positions.size() / 3) + R"(,"type":"VEC3","min":)" +
         triple(placed.least) + R"(,"max":)" + triple(placed.greatest) +
         R"(},{"bufferView":1,"componentType":5125,"count":)" + std::to_string(indices) +
         R"(,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":)" +
         position_bytes + R"(,"target":34962},{"buffer":0,"byteOffset":)" + position_bytes +
         R"(,"byteLength":)" + std::to_string(4 * indices) +
         R"(,"target":34963}],"buffers":[{"byteLength":)" +
         std::to_string(4 * (placed.positions.size() + indices)) + "}]}";
}

/// Writes the DataArrays of a .vtp, values as decimals that read back as the same numbers.
class VtpWriter {
 public:
  explicit VtpWriter(OutputFile& out) : out_(out) {}
  template <class Get>
  void array(const std::string& attributes, std::size_t count, std::size_t per_line,
             const Get& get) {
    out_.write("<DataArray " + attributes + " format=\"ascii\">\n");
    out_.write_items(count, [&](std::string& text, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        append_number(text, get(i));
        text += (i + 1) % per_line == 0 || i + 1 == count ? '\n' : ' ';
      }
    });
    out_.write("</DataArray>\n");
  }
  /// Cells of one kind: the corners of all of them, and each one's end offset.
  void cells(const std::string& kind, const Lists<std::uint32_t>& cells) {
    if (cells.size() == 0) return;
    out_.write("<" + kind + ">\n");
    array("type=\"Int64\" Name=\"connectivity\"", cells.items.size(), 12,
          [&](std::size_t i) { return std::uint64_t{cells.items[i]}; });
    array("type=\"Int64\" Name=\"offsets\"", cells.size(), 12,
          [&](std::size_t i) { return std::uint64_t{cells.offsets[i + 1]}; });
    out_.write("</" + kind + ">\n");
  }

 private:
  OutputFile& out_;
};

}  // namespace

void write_glb(OutputFile& out, const HullMesh& mesh) {
  if (mesh.triangles.empty())
    throw Error(ErrorCode::invalid_argument,
                ".glb holds triangles, and there are none; .vtp and .json hold any");
  const Placed placed = place(mesh);
  std::string json = gltf_json(placed, mesh.triangles.size());
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::size_t binary = 4 * (placed.positions.size() + mesh.triangles.size());
  const std::size_t total = 12 + 8 + json.size() + 8 + binary;
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorCode::invalid_argument, ".glb holds at most 4 GiB; .ply holds more");
  std::string head = "glTF";
  append_word(head, 2);
  append_word(head, total);
  append_word(head, json.size());
  head += "JSON" + json;
  append_word(head, binary);
  head.append("BIN\0", 4);
  out.write(head);
  write_items(out, placed.positions);
  write_items(out, mesh.triangles);
}

void write_vtp(OutputFile& out, const HullMesh& mesh) {
  const std::size_t points = mesh.vertex_count(), polygons = mesh.polygons.size();
  const bool point = points == 1, segment = points == 2;
  out.write(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n<Piece NumberOfPoints=\"" +
      std::to_string(points) + "\" NumberOfVerts=\"" + (point ? "1" : "0") + "\" NumberOfLines=\"" +
      (segment ? "1" : "0") + "\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
      std::to_string(polygons) + "\">\n<Points>\n");
  VtpWriter vtp(out);
  vtp.array("type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"", mesh.coordinates.size(), 3,
            [&](std::size_t i) { return mesh.coordinates[i]; });
  out.write("</Points>\n");
  Lists<std::uint32_t> flat;  // a point or a segment
  for (std::uint32_t i = 0; i < points; ++i) flat.items.push_back(i);
  flat.offsets.push_back(points);
  if (point || segment) vtp.cells(point ? "Verts" : "Lines", flat);
  vtp.cells("Polys", mesh.polygons);
  out.write("</Piece>\n</PolyData>\n</VTKFile>\n");
}

}  // namespace cullhull::internal
