// .pcd (Point Cloud Library): ASCII, binary and compressed; the fields x, y and perhaps z.
#include <algorithm>
#include <memory>
#include <vector>

#include "io/columns.hpp"
#include "io/formats/record_fields.hpp"
#include "io/packed/lzf.hpp"
#include "io/records.hpp"
#include "io/text/lines.hpp"
#include "parallel/byte_order.hpp"

namespace cullhull::internal {
namespace {

struct Field {
  std::string name;
  std::string label;  ///< for messages
  char type = 'F';    ///< 'F', 'I' or 'U'
  std::uint64_t size = 4, count = 1;
  std::uint64_t offset = 0;  ///< in the record
};

enum class Body { ascii, binary, compressed };

struct PcdHeader {
  Body body_kind = Body::ascii;
  std::vector<Field> fields;
  std::uint64_t points = 0, record = 0;
  std::uint32_t dimension = 0;
  ChosenFields chosen;  ///< of the fields
  const char* body = nullptr;
  std::uint64_t lines = 0;

  const Field& axis(std::uint64_t j) const { return fields[chosen.columns[j]]; }
};

class PcdHeaderParser {
 public:
  PcdHeaderParser(const Source& source, const ReadOptions& options)
      : source_(source), options_(options), lines_(source.data, source.data + source.size) {}

  PcdHeader parse() {
    while (h_.body == nullptr) {
      if (!lines_.next()) fault("ends within the PCD header");
      split();
      if (words_.empty() || words_[0].starts_with("#")) continue;
      read_line();
    }
    if (h_.fields.empty()) fault("no line 'FIELDS' in the header");
    count_points();
    lay_out();
    find_axes();
    choose();
    return std::move(h_);
  }

 private:
  [[noreturn]] void fault(const std::string& message) const {
    fail_at_line(source_, lines_.number(), message);
  }
  void split() {
    words_.clear();
    const char* p = lines_.begin();
    for (;;) {
      const std::string_view word = first_word(p, lines_.end());
      if (word.empty()) return;
      words_.push_back(word);
      p = word.data() + word.size();
    }
  }

  void read_line() {
    const std::string_view key = words_[0];
    if (std::find(seen_.begin(), seen_.end(), key) != seen_.end())
      fault("second line " + quoted_text(key));
    seen_.emplace_back(key);
    if (key == "VERSION") return check_version();
    if (key == "VIEWPOINT") return;
    if (key == "FIELDS" || key == "COLUMNS") return read_names();
    if (key == "SIZE")
      return for_each_field([](Field& f, std::string_view word) {
        return parse_unsigned(word, f.size) &&
               (f.size == 1 || f.size == 2 || f.size == 4 || f.size == 8);
      });
    if (key == "TYPE")
      return for_each_field([](Field& f, std::string_view word) {
        f.type = word[0];
        return word == "F" || word == "I" || word == "U";
      });
    if (key == "COUNT")
      return for_each_field([](Field& f, std::string_view word) {
        // Some writers mark padding of no bytes so, between fields that are aligned already.
        return parse_unsigned(word, f.count) && (f.count > 0 || f.name == "_");
      });
    if (key == "WIDTH") return read_number(width_);
    if (key == "HEIGHT") return read_number(height_);
    if (key == "POINTS") return read_number(points_);
    if (key == "DATA") return begin_data();
    fault(quoted_text(key) + " is no keyword of a PCD header");
  }
  void check_version() const {
    static constexpr std::string_view known[] = {".5", ".6", ".7", "0.5", "0.6", "0.7"};
    if (words_.size() != 2 ||
        std::find(std::begin(known), std::end(known), words_[1]) == std::end(known))
      fault("PCD versions 0.5 to 0.7 are known");
  }
  void read_names() {
    if (!h_.fields.empty()) fault("second line of fields");
    for (std::size_t i = 1; i < words_.size(); ++i) {
      Field field;
      field.name = words_[i];
      field.label = "field " + quoted_text(words_[i]);
      h_.fields.push_back(std::move(field));
    }
    if (h_.fields.empty()) fault("no fields");
  }
  template <class Take>
  void for_each_field(const Take& take) {
    const std::string key(words_[0]);
    if (words_.size() - 1 != h_.fields.size())
      fault(key + " has " + std::to_string(words_.size() - 1) + " values for the " +
            std::to_string(h_.fields.size()) + " fields before it");
    for (std::size_t i = 1; i < words_.size(); ++i)
      if (!take(h_.fields[i - 1], words_[i])) fault(quoted_text(words_[i]) + " is no " + key);
  }
  void read_number(std::optional<std::uint64_t>& value) const {
    std::uint64_t number = 0;
    if (words_.size() != 2 || !parse_unsigned(words_[1], number))
      fault(std::string(words_[0]) + " needs one whole number");
    value = number;
  }
  void begin_data() {
    const std::string_view kind = words_.size() == 2 ? words_[1] : std::string_view();
    if (kind == "ascii")
      h_.body_kind = Body::ascii;
    else if (kind == "binary")
      h_.body_kind = Body::binary;
    else if (kind == "binary_compressed")
      h_.body_kind = Body::compressed;
    else
      fault("DATA is ascii, binary or binary_compressed");
    h_.body = lines_.rest();
    h_.lines = lines_.number();
  }

  void count_points() {
    std::uint64_t product = width_.value_or(0);
    if (width_ && !multiply(*width_, height_.value_or(1), product))
      fault("WIDTH times HEIGHT is beyond 64 bits");
    if (!width_ && !points_) fault("neither POINTS nor WIDTH in the header");
    if (width_ && points_ && product != *points_)
      fault("POINTS is " + std::to_string(*points_) + ", but WIDTH times HEIGHT " +
            std::to_string(product));
    h_.points = points_.value_or(product);
  }
  void lay_out() {
    for (Field& f : h_.fields) {
      if (f.type == 'F' && f.size < 4)
        fault(f.label + " is a float of " + std::to_string(f.size) + " bytes");
      std::uint64_t bytes = 0;
      f.offset = h_.record;
      if (!multiply(f.size, f.count, bytes) || h_.record + bytes < bytes)
        fault(f.label + " has too large a COUNT");
      h_.record += bytes;
    }
  }
  void find_axes() {
    for (const std::string_view name : {"x", "y", "z"}) {
      const auto as_written = [&](const Field& f) { return f.name == name; };
      // PDAL writes X, Y, Z.
      const bool lower = std::any_of(h_.fields.begin(), h_.fields.end(), as_written);
      const auto named = [&](const Field& f) {
        return lower ? f.name == name : alike(f.name, name);
      };
      const auto it = std::find_if(h_.fields.begin(), h_.fields.end(), named);
      if (it == h_.fields.end()) {
        if (name == "z") continue;
        fault("no field " + quoted_text(name));
      }
      if (it->count != 1 || std::find_if(it + 1, h_.fields.end(), named) != h_.fields.end())
        fault("field " + quoted_text(name) + " must be one number");
      axes_.push_back(static_cast<std::uint32_t>(it - h_.fields.begin()));
    }
  }
  /// Among the axes and the other fields of one number.
  void choose() {
    std::vector<std::pair<std::string, std::uint32_t>> others;
    for (std::uint32_t i = 0; i < h_.fields.size(); ++i) {
      const Field& f = h_.fields[i];
      const bool axis = std::find(axes_.begin(), axes_.end(), i) != axes_.end();
      if (f.count == 1 && f.name != "_" && !axis) others.emplace_back(f.name, i);
    }
    h_.chosen = fields_to_read(options_, source_.name, axes_, others);
    h_.dimension = static_cast<std::uint32_t>(h_.chosen.columns.size());
  }

  const Source& source_;
  const ReadOptions& options_;
  LineScanner lines_;
  std::vector<std::string_view> words_;
  std::vector<std::string> seen_;
  std::optional<std::uint64_t> width_, height_, points_;
  std::vector<std::uint32_t> axes_;  ///< numbers of fields
  PcdHeader h_;
};

const char* name_of(Body body) {
  return body == Body::ascii    ? "pcd (ascii)"
         : body == Body::binary ? "pcd (binary)"
                                : "pcd (compressed)";
}

/// Where the numbers that are read are stored: in records, or (`count` > 0) in an array a field, of
/// so many points each.
std::vector<NumberField> stored_fields(const PcdHeader& h, std::uint64_t count) {
  std::vector<NumberField> stored;
  for (std::uint32_t j = 0; j < h.dimension; ++j) {
    const Field& f = h.axis(j);
    const char kind = f.type == 'F' ? 'f' : f.type == 'I' ? 'i' : 'u';
    const FieldType type{kind, f.size, !little_endian_machine};
    stored.push_back(count > 0 ? NumberField{f.name, type, f.offset * count, f.size}
                               : NumberField{f.name, type, f.offset, h.record});
  }
  return stored;
}

PointData points_of_records(const Source& records, const PcdHeader& h, std::uint64_t count,
                            std::uint64_t first, const ReadOptions& options) {
  PointData data =
      points_of_fields(records, stored_fields(h, 0), count, first, name_of(h.body_kind), options);
  return with_keys(std::move(data), h.chosen);
}

/// Throws unless the records fit into what follows the header. Bytes behind them are passed over:
/// early versions of PCL fill the last page.
void check_room(const Source& source, const PcdHeader& h, std::uint64_t size,
                const ReadOptions& options) {
  const auto body = static_cast<std::uint64_t>(h.body - source.data);
  std::uint64_t bytes = 0;
  if (!multiply(h.points, h.record, bytes) || bytes > size - body)
    fail_at_byte(source, body, h.points, " points of ", h.record, " bytes exceed the ", size - body,
                 " bytes that follow");
  if (bytes < size - body)
    remark(source, options,
           std::to_string(size - body - bytes) + " bytes after the last point are passed over");
}

/// The fields one after another, each of all points, packed by LZF.
PointData read_compressed(const Source& source, const PcdHeader& h, const ReadOptions& options) {
  const auto body = static_cast<std::uint64_t>(h.body - source.data);
  if (source.size - body < 8) fail_at_byte(source, source.size, "ends before its points");
  const std::uint64_t packed = load_little_endian<std::uint32_t>(h.body);
  const std::uint64_t size = load_little_endian<std::uint32_t>(h.body + 4);
  std::uint64_t bytes = 0;
  if (!multiply(h.points, h.record, bytes) || bytes != size)
    fail_at_byte(source, body + 4, h.points, " points of ", h.record, " bytes are not the ", size,
                 " bytes it unpacks to");
  // What follows is passed over: some writers fill the last page.
  if (packed > source.size - body - 8 || size > lzf_most_growth * packed)
    fail_at_byte(source, body, packed, " packed bytes of ", size, " do not fit the ",
                 source.size - body - 8, " that follow");
  Buffer unpacked(size);
  if (!unpack_lzf(h.body + 8, packed, unpacked.as<char>(), size))
    fail_at_byte(source, body + 8, "the packed points are corrupt");
  PointData data =
      points_of_fields({source.name, unpacked.as<char>(), size}, stored_fields(h, h.points),
                       h.points, 0, name_of(h.body_kind), options);
  if (data.in_place) data.storage = std::move(unpacked);
  data.in_place = false;
  return data;
}

bool is_data_line(const char* p, const char* end) {
  p = skip_blanks(p, end);
  return p < end && *p != '#';
}

void parse_point(const PcdHeader& h, const char* p, const char* end, double* out) {
  for (std::size_t i = 0; i < h.fields.size(); ++i)
    for (std::uint64_t n = 0; n < h.fields[i].count; ++n) {
      double value = 0;
      p = parse_coordinates(p, end, 1, &value, h.fields[i].label.c_str());
      for (std::uint32_t j = 0; j < h.dimension; ++j)
        if (h.chosen.columns[j] == i) out[j] = value;
    }
  p = skip_blanks(p, end);
  if (p < end) throw LineFault{quoted_text(first_word(p, end)) + " after the last field"};
}

PointData read_ascii(const Source& source, const PcdHeader& h, const ReadOptions& options) {
  const LineIndex index = index_lines(source, h.body, h.lines, options, is_data_line);
  if (index.points != h.points)
    fail_at_line(source, h.lines, "promises ", h.points, " points, but ", index.points,
                 " lines follow");
  PointData data = parsed_points(h.points, h.dimension, name_of(Body::ascii));
  double* const out = data.storage.as<double>();
  parse_lines(
      source, index, options, is_data_line,
      [&](std::uint64_t point, const char* p, const char* end) {
    parse_point(h, p, end, out + point * h.dimension);
      },
      [](const char*, const char*) {});
  data.not_finite = line_of_not_finite(index, data.view, is_data_line);
  return data;
}

}  // namespace

PointData read_pcd(const Source& source, const ReadOptions& options) {
  const PcdHeader h = PcdHeaderParser(source, options).parse();
  if (h.body_kind == Body::ascii) return with_keys(read_ascii(source, h, options), h.chosen);
  if (h.body_kind == Body::compressed)
    return with_keys(read_compressed(source, h, options), h.chosen);
  check_room(source, h, source.size, options);
  return points_of_records({source.name, h.body, source.size}, h, h.points, 0, options);
}

std::optional<RecordLayout> pcd_records(const Source& head, std::uint64_t size,
                                        const ReadOptions& options) {
  const auto header = std::make_shared<const PcdHeader>(PcdHeaderParser(head, options).parse());
  if (header->body_kind != Body::binary) return std::nullopt;
  if (size != unknown_size) check_room(head, *header, size, options);
  RecordLayout layout;
  layout.format = name_of(Body::binary);
  layout.offset = static_cast<std::uint64_t>(header->body - head.data);
  layout.count = header->points;
  layout.record_bytes = header->record;
  layout.ends_file = false;
  layout.decode = [=](const Source& records, std::uint64_t first, std::uint64_t count) {
    return points_of_records(records, *header, count, first, options);
  };
  return layout;
}

}  // namespace cullhull::internal
