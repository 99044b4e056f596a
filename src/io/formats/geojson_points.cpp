// Points of GeoJSON (RFC 7946): the positions of all its geometries; and of JSON that is a list of
// rows of numbers, or an object whose member "points" is one.
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/formats/geometry_positions.hpp"

namespace cullhull::internal::inline io {
namespace {

struct GeometryType {
  std::string_view name;
  int depth;  ///< arrays around a position's numbers; 0: has no coordinates
  bool rings;
};

constexpr GeometryType geometry_types[] = {{"Point", 1, false},
                                           {"MultiPoint", 2, false},
                                           {"LineString", 2, false},
                                           {"MultiLineString", 3, false},
                                           {"Polygon", 3, true},
                                           {"MultiPolygon", 4, true},
                                           {"GeometryCollection", 0, false},
                                           {"Feature", 0, false},
                                           {"FeatureCollection", 0, false}};

using nlohmann::json;

constexpr std::string_view points_key = "\"points\"";

/// Reads a text for the parser, and keeps where that is: its events have no place.
class Cursor {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  Cursor(const char* at, const char*& read) : at_(at), read_(&read) {}
  reference operator*() const { return *at_; }
  Cursor& operator++() {
    *read_ = ++at_;
    return *this;
  }
  friend bool operator==(const Cursor& a, const Cursor& b) { return a.at_ == b.at_; }

 private:
  const char* at_;
  const char** read_;
};

/// Follows the parser's events through the members that hold geometries, and skips all others
/// (properties may hold anything). No document is built: memory goes to the positions alone.
class PositionReader : public nlohmann::json_sax<json> {
 public:
  PositionReader(const Source& source, const ReadOptions& options)
      : source_(source), positions_(!options.columns.empty()), options_(options) {}

  PointData read() {
    const char* const end = source_.data + source_.size;
    const char* ignored = end;
    json::sax_parse(Cursor(source_.data, read_), Cursor(end, ignored), this);
    return std::move(positions_).points("geojson");
  }

  bool null() override {
    if (in_coordinates()) fail_at(token(), "null among coordinates");
    if (places_.empty()) not_geojson();
    return true;
  }
  bool boolean(bool) override { return other("true or false"); }
  bool number_integer(number_integer_t value) override {
    return number(static_cast<double>(value));
  }
  bool number_unsigned(number_unsigned_t value) override {
    return number(static_cast<double>(value));
  }
  bool number_float(number_float_t value, const string_t&) override { return number(value); }
  bool string(string_t& value) override {
    if (places_.empty() || places_.back() != Place::object || key_ != "type")
      return other("a string");
    objects_.back().type = value;
    return true;
  }
  bool binary(binary_t&) override { return other("bytes"); }

  bool start_object(std::size_t) override {
    check_stop_sometimes();
    const Place place = expected();
    if (place == Place::coordinates) fail_at(token(), "an object among coordinates");
    if (place == Place::objects)
      fail_at(token(), "not GeoJSON: ", quoted_text(key_), " is not a list");
    if (place == Place::object) objects_.push_back({{}, false, 0, positions_.size(), {}, token()});
    places_.push_back(place);
    return true;
  }
  bool key(string_t& name) override {
    if (places_.back() == Place::object) key_ = name;
    return true;
  }
  bool end_object() override {
    if (places_.back() == Place::object) end_geometry();
    places_.pop_back();
    return true;
  }
  bool start_array(std::size_t) override {
    check_stop_sometimes();
    const Place place = expected();
    if (place == Place::object) not_geojson();
    if (place == Place::coordinates) {
      if (!in_coordinates()) objects_.back().has_coordinates = true;
      if (!levels_.empty() && levels_.back().numbers > 0)
        fail_at(token(), "position ", seen_, " has a list among its coordinates");
      if (!levels_.empty()) levels_.back().lists = true;
      levels_.push_back({0, false, positions_.size(), token()});
    }
    places_.push_back(place);
    return true;
  }
  bool end_array() override {
    if (places_.back() == Place::coordinates) end_level();
    places_.pop_back();
    return true;
  }
  bool parse_error(std::size_t byte, const std::string&,
                   const nlohmann::detail::exception& error) override {
    const char* const at = source_.data + std::min(byte > 0 ? byte - 1 : 0, source_.size);
    constexpr int out_of_range = 406;
    if (error.id == out_of_range) fail_at(at, "a number exceeds the range of doubles");
    if (at < source_.data + source_.size && (*at == 'N' || *at == 'I'))
      fail_at(at, "not valid JSON, which has no NaN and no infinity");
    fail_at(at, "not valid JSON");
  }

 private:
  enum class Place { object, objects, coordinates, skipped };
  struct Object {
    std::string type;
    bool has_coordinates;
    int depth;  ///< of positions; 0 before the first
    std::uint64_t first;
    std::vector<std::uint64_t> lists;  ///< the first position of each list of positions
    const char* at;
  };
  struct Level {
    std::uint32_t numbers;
    bool lists;
    std::uint64_t first;
    const char* at;
  };

  template <class... Parts>
  [[noreturn]] void fail_at(const char* at, const Parts&... parts) const {
    fail_at_line(source_, 1 + static_cast<std::uint64_t>(std::count(source_.data, at, '\n')),
                 parts...);
  }

  /// The last character of the current event's text; of a number the one after it.
  const char* token() const { return read_ == source_.data ? read_ : read_ - 1; }

  bool in_coordinates() const { return !places_.empty() && places_.back() == Place::coordinates; }

  /// What the value that begins now is.
  Place expected() const {
    if (places_.empty() || places_.back() == Place::objects) return Place::object;
    if (places_.back() != Place::object) return places_.back();
    if (key_ == "features" || key_ == "geometries") return Place::objects;
    if (key_ == "geometry") return Place::object;
    return key_ == "coordinates" ? Place::coordinates : Place::skipped;
  }

  [[noreturn]] void not_geojson() const {
    fail(source_,
         "is JSON but not GeoJSON, and holds no points; a hull file is for certify and view");
  }

  bool other(const char* what) {
    const Place place = expected();
    if (place == Place::coordinates) fail_at(token(), what, " among coordinates");
    if (place != Place::skipped) not_geojson();
    return true;
  }

  bool number(double value) {
    if (!in_coordinates()) return other("a number");
    Level& level = levels_.back();
    if (level.lists) fail_at(token(), "position ", seen_, ": a number beside lists of coordinates");
    if (level.numbers == 3)
      fail_at(level.at, "position ", seen_, " has more than three coordinates");
    position_[level.numbers++] = value;
    return true;
  }

  void end_level() {
    const Level level = levels_.back();
    Object& object = objects_.back();
    if (level.numbers > 0) {
      if (level.numbers < 2) fail_at(level.at, "position ", seen_, " has one coordinate");
      const int depth = static_cast<int>(levels_.size());
      if (object.depth == 0) object.depth = depth;
      if (object.depth != depth)
        fail_at(level.at, "position ", seen_, " is nested differently from those before it");
      if (!positions_.add(position_, level.numbers))
        fail_at(level.at, "position ", seen_, " has ", level.numbers, " coordinates, others have ",
                positions_.dimension(), "; --columns x,y takes two of each");
      ++seen_;
    } else if (positions_.size() > level.first &&
               object.depth == static_cast<int>(levels_.size()) + 1) {
      object.lists.push_back(level.first);
    }
    levels_.pop_back();
  }

  void end_geometry() {
    Object object = std::move(objects_.back());
    objects_.pop_back();
    const auto* const known =
        std::find_if(std::begin(geometry_types), std::end(geometry_types),
                     [&](const GeometryType& type) { return type.name == object.type; });
    if (known == std::end(geometry_types)) {
      if (object.type.empty()) not_geojson();
      fail_at(object.at, "not GeoJSON: its type is ", quoted_text(object.type));
    }
    if (known->depth > 0 && !object.has_coordinates)
      fail_at(object.at, "a ", object.type, " without coordinates");
    if (object.has_coordinates && known->depth == 0)
      fail_at(object.at, "a ", object.type, " with coordinates");
    if (object.depth != 0 && object.depth != known->depth)
      fail_at(object.at, "the coordinates of a ", object.type, " are nested ", object.depth,
              " deep, not ", known->depth);
    if (known->rings) close_rings(object);
  }

  void close_rings(const Object& object) {
    const std::uint32_t d = positions_.dimension();
    if (object.lists.size() == 1) return positions_.close_ring(object.lists[0]);
    if (object.lists.empty()) return;
    const std::uint64_t end = positions_.size();
    const std::vector<double> rows = positions_.take_from(object.first);
    for (std::size_t i = 0; i < object.lists.size(); ++i) {
      const std::uint64_t from = object.lists[i];
      const std::uint64_t to = i + 1 < object.lists.size() ? object.lists[i + 1] : end;
      const std::uint64_t begin = positions_.size();
      positions_.append(rows.data() + (from - object.first) * d, to - from);
      positions_.close_ring(begin);
    }
  }

  void check_stop_sometimes() {
    if ((++values_ & 0xFFFF) == 0) check_stop(options_);
  }

  const Source& source_;
  const char* read_ = source_.data;  ///< up to where the parser has read
  Positions positions_;
  const ReadOptions& options_;
  std::vector<Place> places_;
  std::vector<Object> objects_;
  std::vector<Level> levels_;
  std::string key_;
  double position_[3] = {0, 0, 0};
  std::uint64_t seen_ = 0, values_ = 0;
};

/// Reads rows, [[0, 0], [1, 0]], of any dimension; of an object its member "points". No document is
/// built. Ends without a result where the text is an object of another kind.
class RowsReader : public nlohmann::json_sax<json> {
 public:
  RowsReader(const Source& source, const ReadOptions& options)
      : source_(source), options_(options) {}

  /// Empty: an object without such rows.
  std::optional<PointData> read() {
    const char* const end = source_.data + source_.size;
    const char* ignored = end;
    if (!json::sax_parse(Cursor(source_.data, read_), Cursor(end, ignored), this) || !found_)
      return std::nullopt;
    if (numbers_.empty()) fail(source_, "no points");
    PointData data = parsed_points(numbers_.size() / dimension_, dimension_, "json");
    std::copy(numbers_.begin(), numbers_.end(), data.storage.as<double>());
    return data;
  }

  bool null() override { return other("null"); }
  bool boolean(bool) override { return other("true or false"); }
  bool number_integer(number_integer_t value) override {
    return number(static_cast<double>(value));
  }
  bool number_unsigned(number_unsigned_t value) override {
    return number(static_cast<double>(value));
  }
  bool number_float(number_float_t value, const string_t&) override { return number(value); }
  bool string(string_t&) override { return other("a string"); }
  bool binary(binary_t&) override { return other("bytes"); }
  bool start_object(std::size_t) override {
    if (depth_ > 0 && rows_ == 0 && !named_) return skip();
    if (rows_ > 0) return other("an object");
    if (named_) return false;  // "points" of a hull's report
    ++depth_;
    return true;
  }
  bool end_object() override { return close(); }
  bool key(string_t& name) override {
    if (depth_ != 1) return true;
    named_ = name == "points";
    return name != "type" && name != "features" && name != "geometry";
  }
  bool start_array(std::size_t) override {
    if (rows_ == 0 && depth_ > 0 && !named_) return skip();
    if (rows_ == 2) return other("a list");
    found_ = true;
    ++rows_;
    row_ = 0;
    return true;
  }
  bool end_array() override {
    if (rows_ == 0) return close();
    if (rows_-- == 2) end_row();
    if (rows_ == 0) named_ = false;
    return true;
  }
  bool parse_error(std::size_t byte, const std::string&,
                   const nlohmann::detail::exception& error) override {
    constexpr int out_of_range = 406;
    if (depth_ > 0 && !found_) return false;  // the other reader says what is wrong
    const char* const at = source_.data + std::min(byte > 0 ? byte - 1 : 0, source_.size);
    fail_at_line(
        source_, 1 + static_cast<std::uint64_t>(std::count(source_.data, at, '\n')),
        error.id == out_of_range ? "a number exceeds the range of doubles" : "not valid JSON");
  }

 private:
  [[noreturn]] void fail_here(const std::string& message) const {
    fail_at_line(source_, 1 + static_cast<std::uint64_t>(std::count(source_.data, read_, '\n')),
                 message);
  }
  bool skip() {
    ++depth_;
    return true;
  }
  bool close() {
    --depth_;
    return true;
  }
  /// A value that is no number.
  bool other(const char* what) const {
    if (rows_ > 0)
      fail_here("row " + std::to_string(seen_) + " of a list of points: " + what +
                " where a list of numbers is expected, as in [[0, 0], [1, 0]]");
    if (depth_ == 0) fail_here("is JSON, but neither GeoJSON nor a list of points");
    return !named_ || depth_ > 1;
  }
  bool number(double value) {
    if (rows_ != 2) return other("a number");
    numbers_.push_back(value);
    ++row_;
    return true;
  }
  void end_row() {
    if ((++seen_ & 0xFFFF) == 0) check_stop(options_);
    if (row_ == 0) fail_here("row " + std::to_string(seen_ - 1) + " of a list of points is empty");
    if (dimension_ == 0) dimension_ = row_;
    if (row_ != dimension_)
      fail_here("row " + std::to_string(seen_ - 1) + " of a list of points has " +
                std::to_string(row_) + " numbers, the first has " + std::to_string(dimension_));
  }

  const Source& source_;
  const ReadOptions& options_;
  const char* read_ = source_.data;
  std::vector<double> numbers_;
  std::uint32_t dimension_ = 0, row_ = 0;
  std::uint64_t seen_ = 0, depth_ = 0;  ///< rows; objects and lists around a value
  int rows_ = 0;                        ///< 1 within the list of rows, 2 within a row
  bool named_ = false;                  ///< behind the key "points"
  bool found_ = false;
};

}  // namespace

PointData read_geojson(const Source& source, const ReadOptions& options) {
  const char* const end = source.data + source.size;
  const char* first = source.data;
  while (first < end && (is_blank(*first) || *first == '\n')) ++first;
  const bool list = first < end && *first == '[';
  if (list || std::search(first, end, points_key.begin(), points_key.end()) != end)
    if (std::optional<PointData> rows = RowsReader(source, options).read()) return *std::move(rows);
  return PositionReader(source, options).read();
}

}  // namespace cullhull::internal::inline io
