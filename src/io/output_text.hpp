// Text that goes to a file in pieces: lists of numbers as JSON has them, cells as VTK does.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "cullhull/triangulation.hpp"
#include "cullhull/voronoi.hpp"
#include "io/mesh.hpp"
#include "io/output_file.hpp"

namespace cullhull::internal {

/// Text that goes to a file in pieces.
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

 private:
  void flush() {
    out_.write(text_);
    text_.clear();
  }
  OutputFile out_;
  std::string text_;
};

/// A number as JSON has it: what is not finite is a string.
inline void add_real(OutputText& out, double v) {
  if (std::isfinite(v))
    out.number(v);
  else
    out.add(v > 0 ? "\"inf\"" : v < 0 ? "\"-inf\"" : "\"nan\"");
}

/// `items` in rows of `width`; `none` becomes -1.
template <class Items>
void add_rows(OutputText& out, const char* key, const Items& items, std::size_t width,
              std::uint32_t none = no_cell) {
  out.add(",\n  \"").add(key).add("\": [");
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (width > 0 && i % width == 0) out.add(i == 0 ? "\n    [" : "],\n    [");
    if (i > 0 && (width == 0 || i % width != 0)) out.add(", ");
    if constexpr (std::is_floating_point_v<typename Items::value_type>)
      add_real(out, items[i]);
    else if (items[i] == none)
      out.add("-1");
    else
      out.number(std::uint64_t{items[i]});
  }
  out.add(width > 0 && items.size() > 0 ? "]]" : "]");
}

/// Lists of items between offsets; at_infinity becomes -1.
template <class Offsets, class Items>
void add_lists(OutputText& out, const char* key, const Offsets& offsets, const Items& items) {
  out.add(",\n  \"").add(key).add("\": [");
  for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
    out.add(i == 0 ? "\n    [" : ",\n    [");
    for (auto j = offsets[i]; j < offsets[i + 1]; ++j) {
      if (j > offsets[i]) out.add(", ");
      if (items[j] == at_infinity)
        out.add("-1");
      else
        out.number(std::uint64_t{items[j]});
    }
    out.add("]");
  }
  out.add("]");
}

/// VTK's legacy text of these cells of a triangulation of up to 3 dimensions.
void write_vtk(const std::string& path, const PointView& points, const Triangulation& t,
               std::span<const std::uint32_t> cells);

/// A mesh in one of the formats ply, obj, off, stl, glb, vtp.
void write_mesh(const std::string& path, const std::string& f, const HullMesh& mesh);

}  // namespace cullhull::internal
