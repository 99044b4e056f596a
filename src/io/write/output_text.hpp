// Writes text to a file in pieces; cell types of VTK.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "cullhull/triangulation.hpp"
#include "io/json/json_writer.hpp"
#include "io/write/mesh.hpp"
#include "io/write/output_file.hpp"

namespace cullhull::internal {

/// Buffers text and writes it to a file in pieces.
class OutputText {
 public:
  explicit OutputText(const std::string& path) : out_(path) {}
  OutputText& add(std::string_view s) {
    text_ += s;
    if (text_.size() > 1 << 16) flush();
    return *this;
  }
  template <class Number>
  OutputText& number(Number v) {
    append_number(text_, v);
    return add("");
  }
  void commit() {
    flush();
    out_.commit();
  }
  std::string& text() { return text_; }
  /// Writes one JSON document: write(writer) its members.
  template <class Write>
  void json(std::string_view kind, const JsonPoints& points, const Write& write) {
    JsonWriter w(
        text_, [this](const std::string& piece) { out_.write(piece); },
        [this](std::uint64_t count, const TextOfItems& text_of) {
      out_.write_items(count, text_of);
        });
    w.begin_document(kind, points);
    write(w);
    w.end_document();
  }

 private:
  void flush() {
    out_.write(text_);
    text_.clear();
  }
  OutputFile out_;
  std::string text_;
};

/// Throws Error{invalid_argument} if the triangulation is not that of the points, or if its cells
/// or hull facets have points that do not exist.
void require_triangulation_of(const PointView& points, const Triangulation& t);

/// VTK's legacy text of these cells of a triangulation of up to 3 dimensions.
void write_vtk(const std::string& path, const PointView& points, const Triangulation& t,
               std::span<const std::uint32_t> cells);

/// A mesh in one of the formats ply, obj, off, stl, glb, vtp.
void write_mesh(const std::string& path, const std::string& f, const HullMesh& mesh);

}  // namespace cullhull::internal
