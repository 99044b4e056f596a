// .ply: ASCII and binary of both endians; x, y and perhaps z of the element "vertex".
#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>

#include "io/columns.hpp"
#include "io/formats/record_fields.hpp"
#include "io/records.hpp"
#include "io/text/lines.hpp"
#include "io/write/mesh.hpp"
#include "parallel/byte_order.hpp"

namespace cullhull::internal {
namespace {

enum class Encoding { ascii, little, big };

struct Property {
  std::string name;
  std::string label;  ///< for messages
  ScalarType type{};
  bool list = false;
  ScalarType count_type{};   ///< of a list
  std::uint64_t offset = 0;  ///< in the record, if no list comes before it
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::uint64_t line = 0;
  std::vector<Property> properties;
  bool has_list = false;
  std::uint64_t min_size = 0;  ///< bytes of a record; with empty lists
};

struct PlyHeader {
  Encoding encoding{};
  std::vector<Element> elements;
  std::size_t vertex = 0;  ///< index of the element
  const char* body = nullptr;
  std::uint64_t lines = 0;
  std::uint32_t dimension = 0;
  ChosenFields chosen;               ///< of the vertex's properties
  std::array<std::size_t, 3> rgb{};  ///< likewise, of bytes
  bool coloured = false;
};

bool parse_type(std::string_view word, ScalarType& type) {
  static constexpr std::pair<std::string_view, ScalarType> names[] = {
      {"char", ScalarType::i8},    {"int8", ScalarType::i8},     {"uchar", ScalarType::u8},
      {"uint8", ScalarType::u8},   {"short", ScalarType::i16},   {"int16", ScalarType::i16},
      {"ushort", ScalarType::u16}, {"uint16", ScalarType::u16},  {"int", ScalarType::i32},
      {"int32", ScalarType::i32},  {"uint", ScalarType::u32},    {"uint32", ScalarType::u32},
      {"float", ScalarType::f32},  {"float32", ScalarType::f32}, {"double", ScalarType::f64},
      {"float64", ScalarType::f64}};
  for (const auto& [name, t] : names)
    if (word == name) {
      type = t;
      return true;
    }
  return false;
}

class PlyHeaderParser {
 public:
  PlyHeaderParser(const Source& source, const ReadOptions& options)
      : source_(source), options_(options), lines_(source.data, source.data + source.size) {}

  PlyHeader parse() {
    if (!lines_.next() || trimmed() != "ply") fault("does not begin with 'ply'");
    bool format = false;
    for (;;) {
      if (!lines_.next()) fault("ends within the header");
      const auto words = split();
      if (words.empty()) fault("blank line in the header");
      if (words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      if (words[0] == "format") {
        if (std::exchange(format, true)) fault("second 'format' line");
        parse_format(words);
      } else if (words[0] == "element") {
        parse_element(words);
      } else if (words[0] == "property") {
        parse_property(words);
      } else {
        fault(quoted_text(words[0]) + " is no keyword of a PLY header");
      }
    }
    if (!format) fault("header without a 'format' line");
    header_.body = lines_.rest();
    header_.lines = lines_.number();
    find_coordinates();
    return std::move(header_);
  }

 private:
  [[noreturn]] void fault(const std::string& message) const {
    fail_at_line(source_, std::max<std::uint64_t>(lines_.number(), 1), message);
  }
  std::string_view trimmed() const {
    const char* end = lines_.end();
    while (end > lines_.begin() && is_blank(end[-1])) --end;
    return {lines_.begin(), static_cast<std::size_t>(end - lines_.begin())};
  }
  std::vector<std::string_view> split() const {
    std::vector<std::string_view> words;
    const char* p = lines_.begin();
    for (;;) {
      // More words than any header line has: only comments may go on.
      const std::string_view word = first_word(p, lines_.end());
      if (word.empty() || words.size() == 6) return words;
      words.push_back(word);
      p = word.data() + word.size();
    }
  }
  void parse_format(const std::vector<std::string_view>& words) {
    if (words.size() != 3 || words[2] != "1.0") fault("format needs a name and version 1.0");
    if (words[1] == "ascii")
      header_.encoding = Encoding::ascii;
    else if (words[1] == "binary_little_endian")
      header_.encoding = Encoding::little;
    else if (words[1] == "binary_big_endian")
      header_.encoding = Encoding::big;
    else
      fault("unknown format " + quoted_text(words[1]));
  }
  void parse_element(const std::vector<std::string_view>& words) {
    Element e;
    if (words.size() != 3 || !parse_unsigned(words[2], e.count))
      fault("element needs a name and a count");
    e.name = words[1];
    e.line = lines_.number();
    for (const Element& other : header_.elements)
      if (other.name == e.name) fault("second element " + quoted_text(e.name));
    header_.elements.push_back(std::move(e));
  }
  void parse_property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) fault("property before the first element");
    Element& e = header_.elements.back();
    Property p;
    p.list = words.size() == 5 && words[1] == "list";
    if (!p.list && words.size() != 3) fault("property needs a type and a name");
    if (!parse_type(words[words.size() - 2], p.type))
      fault("unknown type " + quoted_text(words[words.size() - 2]));
    if (p.list && (!parse_type(words[2], p.count_type) || p.count_type == ScalarType::f32 ||
                   p.count_type == ScalarType::f64))
      fault(quoted_text(words[2]) + " cannot count a list");
    p.name = words.back();
    p.label = "property " + quoted_text(p.name);
    p.offset = e.min_size;
    e.min_size += scalar_size(p.list ? p.count_type : p.type);
    e.has_list = e.has_list || p.list;
    e.properties.push_back(std::move(p));
  }
  void find_coordinates() {
    const auto is_vertex = [](const Element& e) { return e.name == "vertex"; };
    const auto it = std::find_if(header_.elements.begin(), header_.elements.end(), is_vertex);
    if (it == header_.elements.end()) fault("no element 'vertex'");
    for (const Element& e : header_.elements)
      if (e.properties.empty())
        fail_at_line(source_, e.line, "element ", quoted_text(e.name), " has no property");
    header_.vertex = static_cast<std::size_t>(it - header_.elements.begin());
    std::vector<std::uint32_t> axes;
    for (const std::string_view name : {"x", "y", "z"}) {
      auto found = static_cast<std::uint32_t>(it->properties.size());
      for (std::uint32_t j = 0; j < it->properties.size(); ++j) {
        if (it->properties[j].name != name) continue;
        if (found != it->properties.size() || it->properties[j].list)
          fail_at_line(source_, it->line, "property ", quoted_text(name), " must be one number");
        found = j;
      }
      if (found < it->properties.size())
        axes.push_back(found);
      else if (name != "z")
        fail_at_line(source_, it->line, "vertex has no property ", quoted_text(name));
    }
    choose(*it, axes);
    find_colours(*it);
  }
  /// Among the axes and the other properties of one number.
  void choose(const Element& vertex, const std::vector<std::uint32_t>& axes) {
    std::vector<std::pair<std::string, std::uint32_t>> others;
    for (std::uint32_t j = 0; j < vertex.properties.size(); ++j) {
      const Property& p = vertex.properties[j];
      const bool axis = std::find(axes.begin(), axes.end(), j) != axes.end();
      if (!p.list && !axis) others.emplace_back(p.name, j);
    }
    header_.chosen = fields_to_read(options_, source_.name, axes, others);
    header_.dimension = static_cast<std::uint32_t>(header_.chosen.columns.size());
  }
  /// Colours are optional: fields other than three bytes are ignored.
  void find_colours(const Element& vertex) {
    static constexpr std::string_view names[] = {"red", "green", "blue"};
    header_.coloured = true;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto is_channel = [&](const Property& p) {
        return p.name == names[c] && !p.list && p.type == ScalarType::u8;
      };
      const auto it = std::find_if(vertex.properties.begin(), vertex.properties.end(), is_channel);
      header_.coloured = header_.coloured && it != vertex.properties.end();
      header_.rgb[c] = static_cast<std::size_t>(it - vertex.properties.begin());
    }
  }

  const Source& source_;
  const ReadOptions& options_;
  LineScanner lines_;
  PlyHeader header_;
};

double load(const char* p, ScalarType type, bool big_endian) {
  double number = 0;
  (void)field_type(type, big_endian).load(p, number);
  return number;
}

/// Vertices without lists, from the beginning of their records.
PointData vertices_of_records(const char* records, std::uint64_t count, const PlyHeader& h,
                              const ReadOptions& options) {
  const Element& e = h.elements[h.vertex];
  std::vector<NumberField> fields;
  for (const std::size_t j : h.chosen.columns) {
    const Property& p = e.properties[j];
    fields.push_back(
        {p.name, field_type(p.type, h.encoding == Encoding::big), p.offset, e.min_size});
  }
  return points_of_fields({"", records, 0}, fields, count, 0, "", options);
}

const char* binary_name(Encoding encoding) {
  return encoding == Encoding::big ? "ply (binary big-endian)" : "ply (binary little-endian)";
}

class PlyBinary {
 public:
  PlyBinary(const Source& source, const PlyHeader& header, const ReadOptions& options)
      : source_(source), h_(header), options_(options), big_(header.encoding == Encoding::big) {}

  PointData read() {
    std::uint64_t at = static_cast<std::uint64_t>(h_.body - source_.data);
    for (std::size_t i = 0; i < h_.vertex; ++i) at = skip(h_.elements[i], at);
    const Element& e = h_.elements[h_.vertex];
    check_room(e, at);
    PointData data = e.has_list ? read_walking(e, at) : read_records(e, at);
    if (h_.coloured && !e.has_list) data.colours = colours_of(e, at);
    if (!data.in_place && data.colours.count > 0) {  // the source may be closed
      Buffer copy(3 * data.colours.count);
      auto* to = copy.as<std::uint8_t>();
      for (std::uint64_t i = 0; i < data.colours.count; ++i)
        for (std::uint32_t c = 0; c < 3; ++c) std::memcpy(to++, data.colours.address(i, c), 1);
      data.colour_storage = std::move(copy);
      data.colours =
          PointView::row_major(data.colour_storage.as<const std::uint8_t>(), data.colours.count, 3);
    }
    data.format = binary_name(h_.encoding);
    return data;
  }

  /// The offset of the vertices, if these and the elements before them are records of fixed size,
  /// and the file is complete. Reads no byte behind the header.
  std::optional<std::uint64_t> records() const {
    std::uint64_t at = static_cast<std::uint64_t>(h_.body - source_.data);
    for (std::size_t i = 0; i <= h_.vertex; ++i) {
      const Element& e = h_.elements[i];
      if (e.has_list) return std::nullopt;
      if (i < h_.vertex) at = skip(e, at);
    }
    const Element& e = h_.elements[h_.vertex];
    check_room(e, at);
    if (source_.size != unknown_size) check_rest(at + e.count * e.min_size);
    return at;
  }

 private:
  /// Checks that the element's records, at their smallest, fit into the rest of the file.
  void check_room(const Element& e, std::uint64_t at) const {
    std::uint64_t bytes = 0;
    if (!multiply(e.count, e.min_size, bytes) || bytes > source_.size - at)
      fail_at_byte(source_, at, e.count, " records of ", quoted_text(e.name),
                   " need more than the ", source_.size - at, " bytes that follow");
  }
  std::uint64_t skip(const Element& e, std::uint64_t at) const {
    check_room(e, at);
    if (!e.has_list) return at + e.count * e.min_size;
    for (std::uint64_t i = 0; i < e.count; ++i) {
      if (i % 65536 == 0) check_stop(options_);
      at = walk(e, at, nullptr);
    }
    return at;
  }
  /// Walks over one record property by property; `at_property` receives the offset of each.
  std::uint64_t walk(const Element& e, std::uint64_t at, std::uint64_t* at_property) const {
    for (const Property& p : e.properties) {
      if (at_property != nullptr) *at_property++ = at;
      const std::uint64_t head = scalar_size(p.list ? p.count_type : p.type);
      if (source_.size - at < head) fail_at_byte(source_, at, "ends within ", quoted_text(e.name));
      if (p.list) {
        const double count = load(source_.data + at, p.count_type, big_);
        const double room = static_cast<double>((source_.size - at - head) / scalar_size(p.type));
        if (count < 0 || count > room)
          fail_at_byte(source_, at, "list ", quoted_text(p.name), " of ",
                       static_cast<std::int64_t>(count), " items does not fit the file");
        at += static_cast<std::uint64_t>(count) * scalar_size(p.type);
      }
      at += head;
    }
    return at;
  }
  /// Compares the elements after the vertices with the file's size: those of fixed size exactly,
  /// lists, which are not read, by their smallest size. The vertices are complete in any case.
  void check_rest(std::uint64_t at) const {
    for (std::size_t i = h_.vertex + 1; i < h_.elements.size(); ++i) {
      const Element& e = h_.elements[i];
      std::uint64_t bytes = 0;
      if (!multiply(e.count, e.min_size, bytes) || bytes > source_.size - at)
        return remark(
            source_, options_,
            "ends within its records of " + quoted_text(e.name) + "; the points are complete");
      if (e.has_list && e.count > 0) return;
      at += bytes;
    }
    if (at < source_.size)
      remark(source_, options_,
             std::to_string(source_.size - at) + " bytes after the last element are passed over");
  }

  /// Evenly spaced bytes are viewed in place, whatever the coordinates are.
  PointView colours_of(const Element& e, std::uint64_t at) const {
    const auto offset = [&](std::size_t c) {
      return static_cast<std::ptrdiff_t>(e.properties[h_.rgb[c]].offset);
    };
    if (offset(2) - offset(1) != offset(1) - offset(0)) return {};
    return {reinterpret_cast<const std::byte*>(source_.data + at) + offset(0),
            ScalarType::u8,
            3,
            e.count,
            static_cast<std::ptrdiff_t>(e.min_size),
            offset(1) - offset(0)};
  }

  PointData read_records(const Element& e, std::uint64_t at) const {
    check_rest(at + e.count * e.min_size);
    return vertices_of_records(source_.data + at, e.count, h_, options_);
  }
  PointData read_walking(const Element& e, std::uint64_t at) const {
    PointData data = parsed_points(e.count, h_.dimension, "");
    double* out = data.storage.as<double>();
    std::vector<std::uint64_t> at_property(e.properties.size());
    for (std::uint64_t i = 0; i < e.count; ++i) {
      if (i % 65536 == 0) check_stop(options_);
      at = walk(e, at, at_property.data());
      for (std::uint32_t j = 0; j < h_.dimension; ++j)
        *out++ = load(source_.data + at_property[h_.chosen.columns[j]],
                      e.properties[h_.chosen.columns[j]].type, big_);
    }
    check_rest(at);
    return data;
  }

  const Source& source_;
  const PlyHeader& h_;
  const ReadOptions& options_;
  bool big_;
};

bool is_data_line(const char* p, const char* end) { return skip_blanks(p, end) < end; }

/// Text numbers are read as doubles, whatever type the header declares for them. False where the
/// line ends before a list that no coordinate follows, as in files from which the line
/// "element face" was lost.
bool parse_vertex(const PlyHeader& h, const char* p, const char* end, double* out,
                  std::uint8_t* colour) {
  const Element& e = h.elements[h.vertex];
  const std::size_t last = *std::max_element(h.chosen.columns.begin(), h.chosen.columns.end());
  for (std::size_t j = 0; j < e.properties.size(); ++j) {
    double value;
    if (e.properties[j].list && j > last && skip_blanks(p, end) == end) return false;
    p = parse_coordinates(p, end, 1, &value, e.properties[j].label.c_str());
    if (e.properties[j].list) {
      if (!(value >= 0 && value <= static_cast<double>(end - p)))
        throw LineFault{"list " + quoted_text(e.properties[j].name) + " does not fit its line"};
      for (auto n = static_cast<std::uint64_t>(value); n > 0; --n) {
        double ignored;
        p = parse_coordinates(p, end, 1, &ignored, e.properties[j].label.c_str());
      }
      continue;
    }
    for (std::uint32_t c = 0; c < h.dimension; ++c)
      if (h.chosen.columns[c] == j) out[c] = value;
    if (h.coloured)
      for (std::size_t c = 0; c < 3; ++c)
        if (h.rgb[c] == j)  // what is not a number is black
          colour[c] = static_cast<std::uint8_t>(value > 0 ? std::min(value, 255.0) : 0.0);
  }
  p = skip_blanks(p, end);
  if (p < end) throw LineFault{quoted_text(first_word(p, end)) + " after the last property"};
  return true;
}

PointData read_ascii(const Source& source, const PlyHeader& h, const ReadOptions& options) {
  const LineIndex index = index_lines(source, h.body, h.lines, options, is_data_line);
  std::uint64_t expected = 0, first = 0;
  for (std::size_t i = 0; i < h.elements.size(); ++i) {
    if (i == h.vertex) first = expected;
    constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
    expected += std::min(h.elements[i].count, most - expected);
  }
  const std::uint64_t count = h.elements[h.vertex].count;
  if (index.points < first || index.points - first < count)
    fail_at_line(source, h.lines + index.lines, "ends early: the header promises ", expected,
                 " lines of elements, ", index.points, " follow");
  // Each vertex has a counted line, so their number is bounded by the file's size.
  PointData data = parsed_points(count, h.dimension, "ply (ASCII)");
  double* const out = data.storage.as<double>();
  std::atomic<bool> lists_missing{false};
  std::uint8_t* colours = nullptr;
  if (h.coloured) {
    data.colour_storage = Buffer(3 * count);
    colours = data.colour_storage.as<std::uint8_t>();
    data.colours = PointView::row_major(colours, count, 3);
  }
  parse_lines(
      source, index, options, is_data_line,
      [&](std::uint64_t line, const char* p, const char* end) {
    if (line < first || line - first >= count) return;
    if (!parse_vertex(h, p, end, out + (line - first) * h.dimension,
                      colours + (h.coloured ? 3 * (line - first) : 0)))
      lists_missing = true;
      },
      [](const char*, const char*) {});
  if (lists_missing)
    remark(source, options, "vertices without the list that the header gives them");
  else if (index.points < expected)
    remark(source, options,
           "ends early, after " + std::to_string(index.points) + " of " + std::to_string(expected) +
               " lines of elements; the points are complete");
  else if (index.points > expected)
    remark(source, options, "text after the last element is passed over");
  data.not_finite = line_of_not_finite(index, data.view, is_data_line, first);
  return data;
}

}  // namespace

PointData read_ply(const Source& source, const ReadOptions& options) {
  const PlyHeader header = PlyHeaderParser(source, options).parse();
  PointData data = header.encoding == Encoding::ascii ? read_ascii(source, header, options)
                                                      : PlyBinary(source, header, options).read();
  return with_keys(std::move(data), header.chosen);
}

std::optional<RecordLayout> ply_records(const Source& head, std::uint64_t size,
                                        const ReadOptions& options) {
  const auto header = std::make_shared<const PlyHeader>(PlyHeaderParser(head, options).parse());
  if (header->encoding == Encoding::ascii) return std::nullopt;
  const Source whole{head.name, head.data, size};
  const auto begin = PlyBinary(whole, *header, options).records();
  if (!begin) return std::nullopt;
  const Element& e = header->elements[header->vertex];
  RecordLayout layout;
  layout.format = binary_name(header->encoding);
  layout.offset = *begin;
  layout.count = e.count;
  layout.record_bytes = e.min_size;
  layout.ends_file = false;
  layout.decode = [=](const Source& records, std::uint64_t, std::uint64_t count) {
    return with_keys(vertices_of_records(records.data, count, *header, options), header->chosen);
  };
  return layout;
}

void write_ply(OutputFile& out, const HullMesh& mesh) {
  std::uint64_t longest = 0;
  for (std::size_t f = 0; f < mesh.polygons.size(); ++f)
    longest = std::max(longest, mesh.polygons.offsets[f + 1] - mesh.polygons.offsets[f]);
  // The corners are counted by a byte where possible, as some programs accept no other type.
  const bool wide = longest > 255;
  std::string head = "ply\nformat binary_little_endian 1.0\ncomment convex hull\nelement vertex ";
  append_number(head, std::uint64_t{mesh.vertex_count()});
  head += "\nproperty double x\nproperty double y\nproperty double z\nelement face ";
  append_number(head, std::uint64_t{mesh.polygons.size()});
  head += wide ? "\nproperty list uint int vertex_indices\nend_header\n"
               : "\nproperty list uchar int vertex_indices\nend_header\n";
  out.write(head);
  write_little_endian(out, mesh.coordinates.data(), mesh.coordinates.size());
  for (std::size_t f = 0; f < mesh.polygons.size(); ++f) {
    const std::uint64_t from = mesh.polygons.offsets[f];
    const auto corners = static_cast<std::uint32_t>(mesh.polygons.offsets[f + 1] - from);
    const auto few = static_cast<std::uint8_t>(corners);
    wide ? write_little_endian(out, &corners, 1) : write_little_endian(out, &few, 1);
    write_little_endian(out, &mesh.polygons.items[from], corners);
  }
}

}  // namespace cullhull::internal
