// Points of GeoJSON (RFC 7946), also of a sequence of texts (RFC 8142, newline-delimited): the
// positions of all its geometries, and properties of features as columns. And of JSON that is a
// list of rows of numbers, or an object whose member "points" is one.
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/columns.hpp"
#include "io/formats/geometry_positions.hpp"
#include "io/json/json_events.hpp"
#include "io/text/text_scan.hpp"

namespace cullhull::internal {
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

constexpr std::string_view points_key = "\"points\"";

/// Properties of features as columns: the value of each is that of all positions of its feature.
class PropertyColumns {
 public:
  /// Those that the options name beside the coordinates.
  explicit PropertyColumns(const ReadOptions& options) {
    for (const std::string* text : {&options.columns, &options.key})
      for (std::string& name : names_in(*text)) {
        const bool axis = alike(name, "x") || alike(name, "y") || alike(name, "z");
        if (!axis && std::find(wanted_.begin(), wanted_.end(), name) == wanted_.end())
          wanted_.push_back(std::move(name));
      }
  }

  static constexpr std::size_t not_asked_for = ~std::size_t{0};

  bool any() const { return !wanted_.empty(); }
  /// The number of a property of this name, or not_asked_for. Case is compared when the columns are
  /// chosen.
  std::size_t number_of(std::string_view name) {
    const auto is_it = [&](const std::string& other) { return alike(name, other); };
    const bool asked = std::any_of(wanted_.begin(), wanted_.end(), is_it);
    constexpr std::size_t most_named = 100;  // in a message
    if ((asked || names_.size() < most_named) &&
        std::find(names_.begin(), names_.end(), name) == names_.end())
      names_.emplace_back(name);
    if (!asked) return not_asked_for;
    const std::size_t number = number_asked(name);
    if (number == asked_.size()) asked_.emplace_back(name);
    return number;
  }
  /// Adds the values of the feature at `at`, which has the positions [first, end).
  void add(std::uint64_t first, std::uint64_t end, std::vector<std::string>&& values,
           const char* at) {
    if (wanted_.empty() || first == end) return;
    features_.push_back({first, end, std::move(values), at});
  }

  /// The points with the columns and keys that are asked for.
  PointData points(Positions&& positions, const Source& source, const ReadOptions& options) && {
    PointData data = std::move(positions).points("geojson");
    std::vector<std::string> names{"x", "y", "z"};
    if (!any()) {
      choose_columns(data, source.name, names, options);
      return data;
    }
    const std::uint32_t axes = data.view.dimension;
    names.resize(axes);
    names.insert(names.end(), names_.begin(), names_.end());
    ChosenFields chosen = choose_fields(options, source.name, names, axes);
    const std::uint32_t key = chosen.columns.back();
    if (chosen.keyed) {
      chosen.columns.pop_back();
      add_keys(data, key, names, axes);
    }
    gather(data, chosen.columns, names, axes, source);
    data.columns = chosen.labels;
    data.chosen = true;
    return data;
  }

 private:
  struct Feature {
    std::uint64_t first, end;
    std::vector<std::string> values;
    const char* at;
  };

  std::size_t number_asked(std::string_view name) const {
    return static_cast<std::size_t>(std::find(asked_.begin(), asked_.end(), name) - asked_.begin());
  }
  /// Empty where the feature has no such property.
  static std::string value_of(const Feature& f, std::size_t number) {
    return number < f.values.size() ? f.values[number] : std::string();
  }

  void add_keys(PointData& data, std::uint32_t key, const std::vector<std::string>& names,
                std::uint32_t axes) const {
    if (key < axes) {
      PointData column;
      column.view = data.view;
      column.view.dimension = key + 1;
      data.keys = with_keys(std::move(column), {{}, true, {}}).keys;
      return;
    }
    const std::size_t number = number_asked(names[key]);
    std::uint64_t next = 0;
    const auto add_until = [&](std::uint64_t end, const std::string& value) {
      for (; next < end; ++next) data.keys.add(value);
    };
    for (const Feature& f : features_) {
      add_until(f.first, "");
      add_until(f.end, value_of(f, number));
    }
    add_until(data.view.count, "");
  }

  void gather(PointData& data, const std::vector<std::uint32_t>& columns,
              const std::vector<std::string>& names, std::uint32_t axes,
              const Source& source) const {
    if (std::all_of(columns.begin(), columns.end(), [&](std::uint32_t c) { return c < axes; }))
      return take_columns(data, columns);
    const auto d = static_cast<std::uint32_t>(columns.size());
    const PointView from = data.view;
    Buffer room(std::max<std::uint64_t>(1, from.count * d * sizeof(double)));
    auto* const out = room.as<double>();
    for (std::uint32_t j = 0; j < d; ++j) {
      const std::uint32_t c = columns[j];
      if (c < axes)
        for (std::uint64_t i = 0; i < from.count; ++i) out[i * d + j] = from.at(i, c);
      else
        write_property(names[c], from.count, d, out + j, source);
    }
    data.storage = std::move(room);
    data.view = PointView::row_major(data.storage.as<const double>(), from.count, d);
  }

  /// The numbers of a property, each `step` after the one before.
  void write_property(const std::string& name, std::uint64_t count, std::uint32_t step, double* out,
                      const Source& source) const {
    const std::size_t number = number_asked(name);
    std::uint64_t next = 0;
    for (const Feature& f : features_) {
      if (f.first != next) break;
      const std::string text = value_of(f, number);
      const char* p = text.data();
      const char* const end = p + text.size();
      double value = 0;
      if (scan_number(p, end, value) != Scan::ok || skip_blanks(p, end) != end)
        fail_at_line(
            source, 1 + static_cast<std::uint64_t>(std::count(source.data, f.at, '\n')),
            "property ", quoted_text(name), " of this feature ",
            text.empty() ? std::string("has no value") : "is not a number: " + quoted_text(text));
      for (; next < f.end; ++next) out[next * step] = value;
    }
    if (next < count)
      fail(source, "position ", next, " is of no feature, and has no property ", quoted_text(name));
  }

  std::vector<std::string> wanted_;  ///< as the options write them
  std::vector<std::string> asked_;   ///< the same as the file writes them
  std::vector<std::string> names_;   ///< all that occur, or many
  std::vector<Feature> features_;
};

/// Follows the parser's events through the members that hold geometries, and skips all others
/// (properties may hold anything). No document is built: memory goes to the positions alone.
class PositionReader {
 public:
  PositionReader(const Source& source, const ReadOptions& options)
      : source_(source),
        positions_(!options.columns.empty()),
        properties_(options),
        options_(options) {}

  PointData read() {
    const char* const end = source_.data + source_.size;
    skip_separators(end);
    do {
      JsonEvents events(read_, end, *this);
      events.read();
      read_ = events.next();
    } while (another_text(end));
    return std::move(properties_).points(std::move(positions_), source_, options_);
  }

  bool null() {
    if (in_properties()) return property("");
    if (in_coordinates()) fail_at(read_, "null among coordinates");
    if (places_.empty()) not_geojson();
    return true;
  }
  bool boolean(bool value) {
    if (in_properties()) return property(value ? "true" : "false");
    return other("true or false");
  }
  bool number_integer(std::int64_t value) {
    if (in_properties()) return property(std::to_string(value));
    return number(static_cast<double>(value));
  }
  bool number_unsigned(std::uint64_t value) {
    if (in_properties()) return property(std::to_string(value));
    return number(static_cast<double>(value));
  }
  bool number_float(double value, std::string_view text) {
    if (in_properties()) return property(text);
    return number(value);
  }
  bool string(std::string_view value) {
    if (in_properties()) return property(value);
    if (places_.empty() || places_.back() != Place::object || key_ != "type")
      return other("a string");
    objects_.back().type = value;
    return true;
  }

  bool start_object() {
    check_stop_sometimes();
    const Place place = expected();
    if (place == Place::coordinates) fail_at(read_, "an object among coordinates");
    if (place == Place::objects)
      fail_at(read_, "not GeoJSON: ", quoted_text(key_), " is not a list");
    if (place == Place::object)
      objects_.push_back({{}, false, 0, positions_.size(), {}, read_, {}});
    places_.push_back(place);
    return true;
  }
  bool key(std::string_view name) {
    if (places_.back() == Place::object) key_ = name;
    if (places_.back() == Place::properties) property_ = properties_.number_of(name);
    return true;
  }
  bool end_object() {
    if (places_.back() == Place::object) end_geometry();
    places_.pop_back();
    return true;
  }
  bool start_array() {
    check_stop_sometimes();
    const Place place = expected();
    if (place == Place::object) not_geojson();
    if (place == Place::coordinates) {
      if (!in_coordinates()) objects_.back().has_coordinates = true;
      if (!levels_.empty() && levels_.back().numbers > 0)
        fail_at(read_, "position ", seen_, " has a list among its coordinates");
      if (!levels_.empty()) levels_.back().lists = true;
      levels_.push_back({0, false, positions_.size(), read_});
    }
    places_.push_back(place);
    return true;
  }
  bool end_array() {
    if (places_.back() == Place::coordinates) end_level();
    places_.pop_back();
    return true;
  }
  void at(const char* token) { read_ = token; }
  [[noreturn]] void fault(const char* at, std::string_view why) const { fail_at(at, why); }

 private:
  enum class Place { object, objects, coordinates, properties, skipped };
  struct Object {
    std::string type;
    bool has_coordinates;
    int depth;  ///< of positions; 0 before the first
    std::uint64_t first;
    std::vector<std::uint64_t> lists;  ///< the first position of each list of positions
    const char* at;
    std::vector<std::string> properties;  ///< of a feature: those that are asked for
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

  bool in_properties() const { return !places_.empty() && places_.back() == Place::properties; }
  bool property(std::string_view value) {
    std::vector<std::string>& values = objects_.back().properties;
    if (property_ == PropertyColumns::not_asked_for) return true;
    values.resize(std::max(values.size(), property_ + 1));
    values[property_] = value;
    return true;
  }

  void skip_separators(const char* end) {
    constexpr char record_separator = 0x1E;
    while (read_ < end && (is_blank(*read_) || *read_ == '\n' || *read_ == record_separator))
      ++read_;
  }
  /// Whether another text begins behind blanks and record separators; nothing else may be there.
  bool another_text(const char* end) {
    skip_separators(end);
    if (read_ == end) return false;
    if (*read_ != '{') fail_at(read_, "not valid JSON");
    return true;
  }

  bool in_coordinates() const { return !places_.empty() && places_.back() == Place::coordinates; }

  /// What the value that begins now is.
  Place expected() const {
    if (places_.empty() || places_.back() == Place::objects) return Place::object;
    if (places_.back() == Place::properties) return Place::skipped;
    if (places_.back() != Place::object) return places_.back();
    if (key_ == "properties" && properties_.any()) return Place::properties;
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
    if (place == Place::coordinates) fail_at(read_, what, " among coordinates");
    if (place != Place::skipped) not_geojson();
    return true;
  }

  bool number(double value) {
    if (!in_coordinates()) return other("a number");
    Level& level = levels_.back();
    if (level.lists) fail_at(read_, "position ", seen_, ": a number beside lists of coordinates");
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
    if (object.type == "Feature")
      properties_.add(object.first, positions_.size(), std::move(object.properties), object.at);
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
  const char* read_ = source_.data;  ///< where the current event's text begins
  Positions positions_;
  PropertyColumns properties_;
  std::size_t property_ = 0;  ///< the current one
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
class RowsReader {
 public:
  RowsReader(const Source& source, const ReadOptions& options)
      : source_(source), options_(options) {}

  /// Empty: an object without such rows.
  std::optional<PointData> read() {
    JsonEvents events(source_.data, source_.data + source_.size, *this);
    if (!events.read_all() || !found_) return std::nullopt;
    if (numbers_.empty()) fail(source_, "no points");
    PointData data = parsed_points(numbers_.size() / dimension_, dimension_, "json");
    std::copy(numbers_.begin(), numbers_.end(), data.storage.as<double>());
    return data;
  }

  bool null() { return other("null"); }
  bool boolean(bool) { return other("true or false"); }
  bool number_integer(std::int64_t value) { return number(static_cast<double>(value)); }
  bool number_unsigned(std::uint64_t value) { return number(static_cast<double>(value)); }
  bool number_float(double value, std::string_view) { return number(value); }
  bool string(std::string_view) { return other("a string"); }
  bool start_object() {
    if (depth_ > 0 && rows_ == 0 && !named_) return skip();
    if (rows_ > 0) return other("an object");
    if (named_) return false;  // "points" of a hull's report
    ++depth_;
    return true;
  }
  bool end_object() { return close(); }
  bool key(std::string_view name) {
    if (depth_ != 1) return true;
    named_ = name == "points";
    return name != "type" && name != "features" && name != "geometry";
  }
  bool start_array() {
    if (rows_ == 0 && depth_ > 0 && !named_) return skip();
    if (rows_ == 2) return other("a list");
    found_ = true;
    ++rows_;
    row_ = 0;
    return true;
  }
  bool end_array() {
    if (rows_ == 0) return close();
    if (rows_-- == 2) end_row();
    if (rows_ == 0) named_ = false;
    return true;
  }
  void at(const char* token) { read_ = token; }
  void fault(const char* at, std::string_view why) {
    if (depth_ > 0 && !found_) return;  // the other reader says what is wrong
    read_ = at;
    fail_here(why);
  }

 private:
  [[noreturn]] void fail_here(std::string_view message) const {
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
  /// A value that is not a number.
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

}  // namespace cullhull::internal
