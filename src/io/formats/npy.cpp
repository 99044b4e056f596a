// NumPy's .npy, versions 1 to 3 (numpy/lib/format.py documents it).
#include <algorithm>
#include <atomic>
#include <cstring>
#include <numeric>

#include "io/columns.hpp"
#include "io/formats/record_fields.hpp"
#include "io/records.hpp"
#include "io/source.hpp"
#include "io/text/lines.hpp"
#include "io/write/npy_writers.hpp"
#include "io/write/output_file.hpp"
#include "parallel/byte_order.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {
namespace {

/// A field of a structured array.
struct NpyField {
  std::string name, descr;
  std::uint64_t offset = 0;  ///< in the record
  bool plain = true;         ///< a single item, not an array of its own
};

struct Header {
  std::string descr;
  std::vector<NpyField> fields;  ///< of a structured array
  std::uint64_t record = 0;      ///< bytes of all fields
  bool fortran = false;
  std::vector<std::uint64_t> shape;
  std::uint64_t data_offset = 0;
};

/// The header is a Python dictionary: {'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }
class HeaderParser {
 public:
  HeaderParser(const Source& source, std::uint64_t from, std::uint64_t to)
      : source_(source), p_(from), end_(to) {}

  Header parse() {
    Header h;
    bool seen[3] = {false, false, false};
    expect('{');
    while (!accept('}')) {
      const std::string key = string();
      expect(':');
      const int which = key == "descr" ? 0 : key == "fortran_order" ? 1 : key == "shape" ? 2 : -1;
      if (which < 0) fault("unknown key " + quoted_text(key));
      if (std::exchange(seen[which], true)) fault("key " + quoted_text(key) + " twice");
      if (which == 0) read_descr(h);
      if (which == 1) h.fortran = boolean();
      if (which == 2) h.shape = tuple();
      if (!accept(',')) {
        expect('}');
        break;
      }
    }
    if (!seen[0] || !seen[1] || !seen[2]) fault("needs descr, fortran_order and shape");
    return h;
  }

 private:
  [[noreturn]] void fault(const std::string& message) const {
    fail_at_byte(source_, p_, "npy header: ", message);
  }
  char peek() {
    while (p_ < end_ && (is_blank(source_.data[p_]) || source_.data[p_] == '\n')) ++p_;
    return p_ < end_ ? source_.data[p_] : '\0';
  }
  bool accept(char c) {
    if (peek() != c) return false;
    ++p_;
    return true;
  }
  void expect(char c) {
    if (!accept(c)) fault(std::string("expected '") + c + "'");
  }
  std::string string() {
    const char quote = peek();
    if (quote != '\'' && quote != '"') fault("expected a string");
    const char* const begin = source_.data + ++p_;
    const void* close = std::memchr(begin, quote, end_ - p_);
    if (close == nullptr) fault("string without an end");
    const std::string s(begin, static_cast<const char*>(close));
    p_ += s.size() + 1;
    return s;
  }
  /// The type of all numbers, or a list of fields: [('x', '<f8'), ('rgb', '|u1', (3,)), ...].
  void read_descr(Header& h) {
    if (!accept('[')) {
      h.descr = string();
      return;
    }
    h.descr = "structured";
    while (!accept(']')) {
      NpyField f;
      expect('(');
      if (accept('(')) {  // a title before the name
        (void)string();
        expect(',');
        f.name = string();
        expect(')');
      } else {
        f.name = string();
      }
      expect(',');
      if (peek() == '[') fault("field " + quoted_text(f.name) + " has fields of its own");
      f.descr = string();
      f.offset = h.record;
      std::uint64_t bytes = item_bytes(f.descr);
      if (accept(',') && peek() == '(') {
        f.plain = false;
        for (const std::uint64_t n : tuple())
          if (!multiply(bytes, n, bytes)) fault("a field of too many bytes");
      }
      expect(')');
      if (h.record + bytes < bytes) fault("records of too many bytes");
      h.record += bytes;
      h.fields.push_back(std::move(f));
      if (!accept(',')) {
        expect(']');
        break;
      }
    }
    if (h.fields.empty() || h.record == 0) fault("a structured dtype without fields");
  }
  /// Bytes of one item of a type such as <f8, |V4, <U3 or <M8[ns].
  std::uint64_t item_bytes(const std::string& descr) const {
    std::size_t at = 0;
    if (at < descr.size() && std::strchr("<>|=", descr[at]) != nullptr) ++at;
    const char kind = at < descr.size() ? descr[at++] : '\0';
    std::size_t end = at;
    while (end < descr.size() && is_digit(descr[end])) ++end;
    std::uint64_t bytes = 0;
    if (kind == 'O' || !parse_unsigned(std::string_view(descr).substr(at, end - at), bytes) ||
        (kind == 'U' && !multiply(bytes, 4, bytes)))
      fault("a field of type " + quoted_text(descr));
    return bytes;
  }
  bool boolean() {
    for (const std::string_view word : {"True", "False"}) {
      peek();
      if (end_ - p_ >= word.size() &&
          std::memcmp(source_.data + p_, word.data(), word.size()) == 0) {
        p_ += word.size();
        return word == "True";
      }
    }
    fault("expected True or False");
  }
  std::vector<std::uint64_t> tuple() {
    std::vector<std::uint64_t> values;
    expect('(');
    while (!accept(')')) {
      if (values.size() == 64) fault("more than 64 axes");
      peek();
      std::uint64_t from = p_, value = 0;
      while (p_ < end_ && is_digit(source_.data[p_])) ++p_;
      if (!parse_unsigned({source_.data + from, p_ - from}, value))
        fault("shape needs whole numbers that are not negative");
      accept('L');  // Python 2
      values.push_back(value);
      if (!accept(',')) {
        expect(')');
        break;
      }
    }
    return values;
  }

  const Source& source_;
  std::uint64_t p_, end_;
};

Header parse_header(const Source& s) {
  if (s.size < 10 || std::memcmp(s.data, "\x93NUMPY", 6) != 0)
    fail_at_byte(s, 0, "does not begin as an .npy file does");
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint64_t>(static_cast<unsigned char>(s.data[i]));
  };
  if (byte(6) < 1 || byte(6) > 3) fail_at_byte(s, 6, "npy version ", byte(6), "; 1 to 3 are known");
  std::uint64_t from = 10, length = byte(8) | byte(9) << 8;
  if (byte(6) >= 2) {
    if (s.size < 12) fail_at_byte(s, s.size, "ends within the npy header");
    length |= byte(10) << 16 | byte(11) << 24;
    from = 12;
  }
  if (s.size - from < length)
    fail_at_byte(s, 8, "npy header of ", length, " bytes in a file of ", s.size);
  Header h = HeaderParser(s, from, from + length).parse();
  h.data_offset = from + length;
  return h;
}

bool is_number(const std::string& descr) {
  std::string_view word = descr;
  if (!word.empty() && std::strchr("<>|=", word[0]) != nullptr) word.remove_prefix(1);
  for (const char* known : {"f4", "f8", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8"})
    if (word == known) return true;
  return false;
}

struct Dtype : FieldType {
  bool big_endian = false;
};

Dtype parse_dtype(const Source& s, const std::string& descr) {
  Dtype t;
  std::string_view word = descr;
  if (!word.empty() && std::strchr("<>|=", word[0]) != nullptr) {
    t.big_endian = word[0] == '>';
    t.swapped = word[0] == (little_endian_machine ? '>' : '<');
    word.remove_prefix(1);
  }
  t.kind = word.empty() ? '\0' : word[0];
  const bool ok = word.size() == 2 && parse_unsigned(word.substr(1), t.size) &&
                  ((t.kind == 'f' && (t.size == 4 || t.size == 8)) ||
                   ((t.kind == 'i' || t.kind == 'u') &&
                    (t.size == 1 || t.size == 2 || t.size == 4 || t.size == 8)));
  if (!ok)
    fail(s, "dtype ", quoted_text(descr),
         " cannot be read as points; convert to float64, float32 or an integer type");
  return t;
}

void copy_swapped(const char* from, std::uint64_t bytes, std::uint64_t size, std::byte* to,
                  const ReadOptions& options) {
  for_each_chunk(bytes / size, std::uint64_t{1} << 18, resolve_threads(options.threads),
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
    check_stop(options);
    for (std::uint64_t i = begin * size; i < end * size; i += size)
      std::reverse_copy(from + i, from + i + size, reinterpret_cast<char*>(to) + i);
  });
}

/// Memory order is kept. Returns the first element (in memory order) that is not exactly a double,
/// or `count`.
template <class T>
std::uint64_t widen(const char* from, std::uint64_t count, bool swap, double* to,
                    const ReadOptions& options) {
  std::atomic<std::uint64_t> first{count};
  for_each_chunk(count, std::uint64_t{1} << 18, resolve_threads(options.threads),
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
    check_stop(options);
    for (std::uint64_t i = begin; i < end; ++i) {
      std::uint64_t bits;
      std::memcpy(&bits, from + 8 * i, 8);
      if (swap) bits = reverse_bytes(bits);
      if (exact_double(static_cast<T>(bits), to[i])) continue;
      std::uint64_t seen = first.load();
      while (i < seen && !first.compare_exchange_weak(seen, i)) {
      }
      return;
    }
  });
  return first;
}

}  // namespace

namespace {

/// n x d numbers at `data` as points; in place where possible. `first`: the index of the first one
/// in its array, for messages.
PointData points_of_array(const Source& source, const char* data, std::uint64_t n, std::uint64_t d,
                          const Dtype& type, bool fortran, const ReadOptions& options,
                          std::uint64_t first = 0) {
  const std::uint64_t items = n * d, bytes = items * type.size;
  PointData result;
  result.format = "npy";
  const std::byte* base = reinterpret_cast<const std::byte*>(data);
  const std::uint64_t size = type.size;
  if (type.kind != 'f' && type.size == 8) {
    result.format += " (64-bit integers)";
    result.storage = Buffer(bytes);
    double* const to = result.storage.as<double>();
    const std::uint64_t bad = type.kind == 'i'
                                  ? widen<std::int64_t>(data, items, type.swapped, to, options)
                                  : widen<std::uint64_t>(data, items, type.swapped, to, options);
    if (bad < items)
      fail(source, "value at index (", first + (fortran ? bad % n : bad / d), ", ",
           fortran ? bad / n : bad % d, ") is a 64-bit integer that no double equals");
    base = result.storage.data();
    result.view.scalar = ScalarType::f64;
  } else {
    result.view.scalar = *type.scalar();
    if (type.big_endian && size > 1) result.format += " (big-endian)";
    if (type.swapped && size > 1) {
      result.storage = Buffer(bytes);
      copy_swapped(data, bytes, size, result.storage.data(), options);
      base = result.storage.data();
    } else {
      result.in_place = true;
    }
  }
  result.view.data = base;
  result.view.dimension = static_cast<std::uint32_t>(d);
  result.view.count = n;
  result.view.point_stride = static_cast<std::ptrdiff_t>(fortran ? size : size * d);
  result.view.coordinate_stride = static_cast<std::ptrdiff_t>(fortran ? size * n : size);
  return result;
}

/// Error{bad_file} unless the array fills the file from the header to the end.
void check_extent(const Source& source, const Header& h, const Dtype& type,
                  std::uint64_t file_size) {
  std::uint64_t bytes = type.size;
  std::string shape;
  bool fits = true, empty = false;
  for (const std::uint64_t n : h.shape) {
    shape.append(shape.empty() ? "" : ", ").append(std::to_string(n));
    empty = empty || n == 0;
    fits = fits && multiply(bytes, std::max<std::uint64_t>(n, 1), bytes);
  }
  if (empty) bytes = 0;
  const std::uint64_t have = file_size - h.data_offset;
  if (!fits || bytes > have)
    fail_at_byte(source, h.data_offset, "shape (", shape, ") of ", quoted_text(h.descr),
                 " needs more than the ", have, " bytes that follow");
  if (bytes < have && file_size != unknown_size)
    fail_at_byte(source, h.data_offset + bytes, have - bytes, " bytes after the array");
}

}  // namespace

namespace {

struct PointArray {
  Header header;
  Dtype type;
  std::uint64_t count, dimension;
};

struct StructuredArray {
  std::uint64_t data_offset = 0, count = 0, record = 0;
  std::vector<NumberField> fields;  ///< the coordinates, and behind them the key
  ChosenFields chosen;
};

/// Points of the fields x, y and z, longitude and latitude, ... or of those that options name.
StructuredArray parse_structured(const Source& head, const Header& h, std::uint64_t file_size,
                                 const ReadOptions& options) {
  if (h.shape.size() != 1)
    fail(head, "structured array of ", h.shape.size(), " axes; points need one");
  StructuredArray a{h.data_offset, h.shape[0], h.record, {}, {}};
  Dtype record;
  record.size = h.record;
  check_extent(head, h, record, file_size);
  std::vector<NumberField> numbers;
  std::vector<std::string> names;
  for (const NpyField& f : h.fields)
    if (f.plain && is_number(f.descr)) {
      numbers.push_back({f.name, parse_dtype(head, f.descr), f.offset, h.record});
      names.push_back(f.name);
    }
  std::vector<std::uint32_t> axes = find_known_columns(names);
  if (axes.empty() && options.columns.empty()) {
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + quoted_text(name);
    fail(head, "a structured array whose fields name no x and y: ",
         list.empty() ? "none is a number" : list + "; --columns says which are the coordinates");
  }
  if (axes.empty()) {  // then numbers count the fields
    axes.resize(names.size());
    std::iota(axes.begin(), axes.end(), 0U);
  }
  std::vector<NumberField> ordered;
  std::vector<std::string> ordered_names;
  for (const std::uint32_t c : axes) ordered.push_back(numbers[c]);
  for (std::uint32_t c = 0; c < numbers.size(); ++c)
    if (std::find(axes.begin(), axes.end(), c) == axes.end()) ordered.push_back(numbers[c]);
  for (const NumberField& f : ordered) ordered_names.push_back(f.name);
  a.chosen =
      choose_fields(options, head.name, ordered_names, static_cast<std::uint32_t>(axes.size()));
  for (const std::uint32_t c : a.chosen.columns) a.fields.push_back(ordered[c]);
  return a;
}

PointData points_of_structured(const Source& records, const StructuredArray& a, std::uint64_t count,
                               std::uint64_t first, const ReadOptions& options) {
  return with_keys(points_of_fields(records, a.fields, count, first, "npy (structured)", options),
                   a.chosen);
}

PointArray parse_points(const Source& head, Header&& header, std::uint64_t file_size) {
  PointArray a{std::move(header), {}, 0, 1};
  a.type = parse_dtype(head, a.header.descr);
  const std::vector<std::uint64_t>& shape = a.header.shape;
  if (shape.size() == 3)
    fail(head, "array of 3 axes (frames, n, d): moving points, for the command track");
  if (shape.empty() || shape.size() > 2)
    fail(head, "array of ", shape.size(), " axes; points need (n, d) or (n,)");
  a.count = shape[0];
  if (shape.size() == 2) a.dimension = shape[1];
  if (a.dimension == 0 || a.dimension > UINT32_MAX) fail(head, "points of dimension ", a.dimension);
  check_extent(head, a.header, a.type, file_size);
  return a;
}

}  // namespace

std::optional<RecordLayout> npy_records(const Source& head, std::uint64_t size,
                                        const ReadOptions& options) {
  RecordLayout layout;
  Header header = parse_header(head);
  if (!header.fields.empty()) {
    const StructuredArray a = parse_structured(head, header, size, options);
    layout.format = "npy (structured)";
    layout.offset = a.data_offset;
    layout.count = a.count;
    layout.record_bytes = a.record;
    layout.decode = [=](const Source& records, std::uint64_t first, std::uint64_t count) {
      return points_of_structured(records, a, count, first, options);
    };
    return layout;
  }
  const PointArray a = parse_points(head, std::move(header), size);
  layout.format = "npy";
  layout.offset = a.header.data_offset;
  layout.count = a.count;
  const bool columns = a.header.fortran && a.dimension > 1;
  layout.columns = columns ? static_cast<std::uint32_t>(a.dimension) : 1;
  layout.record_bytes = a.type.size * (columns ? 1 : a.dimension);
  layout.decode = [=, type = a.type, d = a.dimension](const Source& records, std::uint64_t first,
                                                      std::uint64_t count) {
    return points_of_array(records, records.data, count, d, type, columns, options, first);
  };
  return layout;
}

bool NpyFrames::read_header(const Source& head, std::uint64_t file_size) {
  const Header h = parse_header(head);
  if (h.shape.size() != 3) return false;
  const Dtype type = parse_dtype(head, h.descr);
  if (h.fortran)
    fail(head,
         "array of 3 axes in Fortran order, which scatters each frame over the whole file; "
         "save it in C order (numpy.ascontiguousarray)");
  if (h.shape[2] == 0 || h.shape[2] > UINT32_MAX) fail(head, "points of dimension ", h.shape[2]);
  check_extent(head, h, type, file_size);
  frames = h.shape[0];
  count = h.shape[1];
  dimension = static_cast<std::uint32_t>(h.shape[2]);
  data_offset = h.data_offset;
  frame_bytes = count * dimension * type.size;
  descr = h.descr;
  return true;
}

PointData NpyFrames::frame(const Source& bytes, const ReadOptions& options) const {
  return points_of_array(bytes, bytes.data, count, dimension, parse_dtype(bytes, descr), false,
                         options);
}

std::string npy_descr(ScalarType type) {
  std::string descr(1, scalar_size(type) == 1 ? '|' : '<');
  return descr.append(1, scalar_name(type)[0]).append(std::to_string(scalar_size(type)));
}

std::string npy_header(const char* descr, std::initializer_list<std::uint64_t> shape) {
  std::string dict = "{'descr': '";
  dict.append(descr).append("', 'fortran_order': False, 'shape': (");
  for (const std::uint64_t n : shape) {
    dict.append(std::to_string(n)).append(1, ',');
    if (shape.size() > 1) dict.append(1, ' ');
  }
  dict.append("), }");
  // The data begin at a multiple of 64; the header ends with a newline.
  const std::size_t total = (10 + dict.size() + 1 + 63) / 64 * 64;
  dict.resize(total - 11, ' ');
  dict += '\n';
  std::string out("\x93NUMPY\x01\x00", 8);
  out += static_cast<char>(dict.size() & 0xFF);
  out += static_cast<char>(dict.size() >> 8);
  return out + dict;
}

namespace {

template <class T>
void write_converted(OutputFile& out, const double* v, std::uint64_t count) {
  constexpr std::uint64_t block = 4096;  // numbers, on the stack
  T converted[block];
  for (std::uint64_t i = 0; i < count; ++i) {
    bool ok = true;
    if constexpr (std::is_same_v<T, float>)
      ok = !std::isfinite(v[i]) || std::fabs(v[i]) < 0x1.ffffffp127;  // rounds to a float
    else if constexpr (std::is_integral_v<T>)
      ok = v[i] >= static_cast<double>(std::numeric_limits<T>::min()) &&
           v[i] <= static_cast<double>(std::numeric_limits<T>::max()) && std::trunc(v[i]) == v[i];
    if (!ok)
      throw Error(ErrorCode::invalid_argument, "coordinate ", i,
                  " does not fit the scalar type asked for");
    converted[i % block] = static_cast<T>(v[i]);
    if (i % block == block - 1 || i + 1 == count)
      write_little_endian(out, converted, i % block + 1);
  }
}

}  // namespace

void write_values(OutputFile& out, const double* v, std::uint64_t count, ScalarType type) {
  with_scalar(type, [&](auto scalar) { write_converted<decltype(scalar)>(out, v, count); });
}

NpySequenceWriter::NpySequenceWriter(const std::string& path, std::uint64_t frames,
                                     std::uint64_t count, std::uint32_t dimension, ScalarType type)
    : out_(path), frames_(frames), values_(count * dimension), type_(type) {
  out_.write(npy_header(npy_descr(type).c_str(), {frames, count, dimension}));
  if (frames == 0) out_.commit();
}

void NpySequenceWriter::write(const double* coordinates) {
  if (frames_ == 0)
    throw Error(ErrorCode::invalid_argument, "more frames written than were announced");
  write_values(out_, coordinates, values_, type_);
  if (--frames_ == 0) out_.commit();
}

}  // namespace cullhull::internal

namespace cullhull {

void write_npy_ids(const std::string& path, const std::vector<std::uint64_t>& ids) {
  internal::OutputFile out(path);
  out.write(internal::npy_header("<i8", {ids.size()}));
  internal::write_little_endian(out, ids.data(), ids.size());
  out.commit();
}

void write_npy_points(const std::string& path, const double* coordinates, std::uint64_t count,
                      std::uint32_t dimension, ScalarType type) {
  PointsWriter(path, count, dimension, type, "npy").write(coordinates, count);
}

}  // namespace cullhull
