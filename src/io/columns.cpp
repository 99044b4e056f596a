#include "io/columns.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>

namespace cullhull::internal {
namespace {

constexpr const char* what_to_write = "write a range such as 0:3 or a list such as 0,2,5";

[[noreturn]] void refuse(const std::string& file, const std::string& text, const std::string& why) {
  throw Error(ErrorCode::invalid_argument, file, ": columns ", quoted_text(text), ": ", why);
}

struct Item {
  std::string text;
  bool name = false;
};

/// Splits at commas outside of double quotes; within quotes two quotes stand for one.
std::vector<Item> items_of(const std::string& text) {
  std::vector<Item> items(1);
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    Item& item = items.back();
    if (text[i] == '"') {
      const bool doubled = quoted && i + 1 < text.size() && text[i + 1] == '"';
      if (doubled)
        item.text += text[++i];
      else
        quoted = !quoted;
      item.name = true;
    } else if (text[i] == ',' && !quoted) {
      items.emplace_back();
    } else {
      item.text += text[i];
    }
  }
  for (Item& item : items)
    item.name = item.name || item.text.find_first_not_of("0123456789:") != std::string::npos;
  return items;
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t most = 12;
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < most; ++i)
    text += (i > 0 ? ", " : "") + quoted_text(names[i]);
  return text + (names.size() > most ? ", ..." : "");
}

/// Finds a name as written, or regardless of case if only one matches.
std::uint32_t find_name(const std::string& name, const std::string& file, const std::string& text,
                        const std::vector<std::string>& names) {
  if (names.empty()) refuse(file, text, std::string("no names of columns here; ") + what_to_write);
  std::vector<std::uint32_t> same, similar;
  for (std::uint32_t j = 0; j < names.size(); ++j) {
    if (names[j] == name) same.push_back(j);
    if (alike(names[j], name)) similar.push_back(j);
  }
  const std::vector<std::uint32_t>& found = same.empty() ? similar : same;
  if (found.empty())
    refuse(file, text, "no column " + quoted_text(name) + "; there are " + listed(names));
  if (found.size() > 1) refuse(file, text, "more than one column " + quoted_text(name));
  return found[0];
}

std::uint32_t parse_number(std::string_view number, std::uint32_t missing, const std::string& file,
                           const std::string& text) {
  if (number.empty()) return missing;
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error != std::errc() || end != number.data() + number.size())
    refuse(file, text, what_to_write);
  return value;
}

void add_range(const std::string& item, std::uint32_t width, const std::string& file,
               const std::string& text, std::vector<std::uint32_t>& columns) {
  if (item.empty()) refuse(file, text, what_to_write);
  const std::string_view range = item;
  const auto colon = range.find(':');
  const std::uint32_t first = parse_number(range.substr(0, colon), 0, file, text);
  std::uint64_t last = std::uint64_t{first} + 1;
  if (colon != std::string_view::npos)
    last = parse_number(range.substr(colon + 1), width, file, text);
  if (first >= last) refuse(file, text, "the range '" + item + "' is empty");
  if (last > width)
    refuse(file, text, "the points have coordinates 0 to " + std::to_string(width - 1));
  if (columns.size() >= width) refuse(file, text, "some coordinate is named twice");
  for (std::uint32_t j = first; j < last; ++j) columns.push_back(j);
}

bool evenly_spaced(const std::vector<std::uint32_t>& columns) {
  for (std::size_t j = 2; j < columns.size(); ++j)
    if (std::int64_t{columns[j]} - columns[j - 1] != std::int64_t{columns[1]} - columns[0])
      return false;
  return true;
}

void gather(PointData& data, const std::vector<std::uint32_t>& columns) {
  const PointView from = data.view;
  const std::size_t size = scalar_size(from.scalar);
  const auto d = static_cast<std::uint32_t>(columns.size());
  std::uint64_t bytes = 0;
  if (!multiply(from.count, d * size, bytes)) throw std::bad_alloc();
  Buffer packed(bytes);
  std::byte* out = packed.data();
  for (std::uint64_t i = 0; i < from.count; ++i)
    for (const std::uint32_t j : columns) {
      std::memcpy(out, from.address(i, j), size);
      out += size;
    }
  if (data.in_place && data.colours.count > 0) {  // the source may be closed
    Buffer colours(3 * data.colours.count);
    auto* to = colours.as<std::uint8_t>();
    for (std::uint64_t i = 0; i < data.colours.count; ++i)
      for (std::uint32_t j = 0; j < 3; ++j) std::memcpy(to++, data.colours.address(i, j), 1);
    data.colour_storage = std::move(colours);
    data.colours =
        PointView::row_major(data.colour_storage.as<const std::uint8_t>(), data.colours.count, 3);
  }
  data.storage = std::move(packed);
  data.in_place = false;
  const auto step = static_cast<std::ptrdiff_t>(size);
  data.view = {data.storage.data(), from.scalar, d, from.count, step * d, step};
}

void add_keys(PointData& data, std::uint32_t key) {
  char text[40];
  for (std::uint64_t i = 0; i < data.view.count; ++i) {
    const auto r = std::to_chars(text, text + sizeof text, data.view.at(i, key));
    data.keys.add({text, static_cast<std::size_t>(r.ptr - text)});
  }
}

}  // namespace

bool alike(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [lower](char c, char d) { return lower(c) == lower(d); });
}

std::vector<std::string> names_in(const std::string& text) {
  std::vector<std::string> names;
  for (Item& item : items_of(text))
    if (item.name) names.push_back(std::move(item.text));
  return names;
}

std::vector<std::uint32_t> find_columns(const std::string& text, const std::string& file,
                                        const std::vector<std::string>& names,
                                        std::uint32_t width) {
  std::vector<std::uint32_t> columns;
  for (const Item& item : items_of(text))
    if (item.name)
      columns.push_back(find_name(item.text, file, text, names));
    else
      add_range(item.text, width, file, text, columns);
  std::vector<std::uint32_t> sorted = columns;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end())
    refuse(file, text, "coordinate " + std::to_string(*twice) + " is named twice");
  return columns;
}

namespace {

/// The words of a name in lower case: divided where it is not a letter or digit, and within
/// "decimalLatitude" and "GPSLatitude". What is in brackets is left out, unless all of it is.
std::vector<std::string> words_of(std::string_view name) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(name[i]); };
  const auto upper = [&](std::size_t i) { return i < name.size() && std::isupper(byte(i)) != 0; };
  const auto lower = [&](std::size_t i) { return i < name.size() && std::islower(byte(i)) != 0; };
  std::vector<std::string> words;
  bool within = false;
  int brackets = 0;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    if (c == '(' || c == '[' || c == '{') ++brackets;
    if (c == ')' || c == ']' || c == '}') --brackets;
    const bool letter = byte(i) >= 0x80 ? byte(i) != 0xC2 && !(i > 0 && byte(i - 1) == 0xC2)
                                        : std::isalnum(byte(i)) != 0;  // 0xC2: signs such as °
    if (brackets > 0 || !letter) {
      within = false;
      continue;
    }
    const bool begins = i > 0 && upper(i) && (lower(i - 1) || (upper(i - 1) && lower(i + 1)));
    if (!within || begins) words.emplace_back();
    within = true;
    // The capitals of Latin-1 in UTF-8 are 0x20 before the small letters.
    const bool capital = i > 0 && byte(i - 1) == 0xC3 && byte(i) >= 0x80 && byte(i) <= 0x9E;
    words.back() += capital ? static_cast<char>(byte(i) + 0x20)
                            : static_cast<char>(byte(i) < 0x80 ? std::tolower(byte(i)) : byte(i));
  }
  if (words.empty() && name.find_first_of("([{") != std::string_view::npos) {
    std::string inside(name);
    for (char& c : inside)
      if (std::string_view("()[]{}").find(c) != std::string_view::npos) c = ' ';
    return words_of(inside);
  }
  return words;
}

using WordList = std::vector<std::string_view>;

bool has(const WordList& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

const WordList& units() {
  static const WordList list{"m",  "meter", "meters", "metre",   "metres", "mm",  "cm",
                             "km", "ft",    "feet",   "foot",    "usft",   "in",  "inch",
                             "yd", "deg",   "degree", "degrees", "grad",   "gon", "dd"};
  return list;
}

/// Words beside a coordinate's name that do not change what it is.
bool is_beside(const std::string& word) {
  static const WordList list{
      "coord",   "coords",    "coordinate", "coordinates", "koordinate", "koordinaten", "koord",
      "pos",     "position",  "point",      "pt",          "pkt",        "punkt",       "location",
      "loc",     "gps",       "decimal",    "dec",         "wgs",        "wgs84",       "utm",
      "etrs",    "etrs89",    "gk",         "epsg",        "lv95",       "lv03",        "l93",
      "lambert", "lambert93", "rgf93",      "centroid",    "center",     "centre",      "map",
      "local",   "world",     "grid",       "geo",         "wert",       "dim",         "projected",
      "osgb",    "osgb36",    "bng",        "nad27",       "nad83",      "gda94",       "nn",
      "nhn",     "ngf",       "msl",        "ellipsoidal", "ellipsoid",  "orthometric", "ground",
      "terrain"};
  if (has(list, word) || has(units(), word)) return true;
  if (word.starts_with("utm") && word.size() <= 6 && word.size() > 3 &&
      std::isdigit(static_cast<unsigned char>(word[3])) != 0)
    return true;  // utm32, utm32n
  const bool digits = word.find_first_not_of("0123456789") == std::string::npos;
  return digits && (word.size() > 3 || has({"84", "89", "93", "95"}, word));  // EPSG:25832
}

enum Axis : unsigned { no_axis, first_axis, second_axis, height_axis };

/// Names that belong together.
struct Family {
  WordList first, second, height;

  Axis axis_of(std::string_view word) const {
    return has(first, word)    ? first_axis
           : has(second, word) ? second_axis
           : has(height, word) ? height_axis
                               : no_axis;
  }
};

const WordList& heights() {
  static const WordList list{"z",    "h",     "height",   "heights", "elevation", "elev",
                             "ele",  "alt",   "altitude", "alti",    "hoehe",     "h\xC3\xB6he",
                             "cota", "quota", "cote",     "hgt"};
  return list;
}

const std::vector<Family>& families() {
  static const std::vector<Family> list{
      {{"x"}, {"y"}, {"z"}},
      {{"lon", "long", "lng", "longitude", "longitud", "longitudine", "laengengrad",
        "l\xC3\xA4ngengrad", "lengtegraad"},
       {"lat", "latitude", "latitud", "latitudine", "breitengrad", "breedtegraad"},
       heights()},
      {{"e", "east", "easting", "eastings", "ost", "ostwert", "rechts", "rechtswert", "rw", "est",
        "este", "oost", "abscisse"},
       {"n", "north", "northing", "northings", "nord", "nordwert", "hoch", "hochwert", "hw",
        "norte", "noord", "ordonnee", "ordonn\u00E9e"},
       heights()}};
  return list;
}

/// "pointx", "xcoord": such a word without what stands beside it.
std::string_view bare(std::string_view word) {
  static const WordList before{"point", "coord", "koord", "pos", "gps", "utm", "decimal", "dim"},
      behind{"coordinates", "coordinate", "koordinate", "coord", "koord",
             "pos",         "wert",       "utm",        "dd"};
  for (const std::string_view b : before)
    if (word.size() > b.size() && word.starts_with(b)) return word.substr(b.size());
  for (const std::string_view b : behind)
    if (word.size() > b.size() && word.ends_with(b)) return word.substr(0, word.size() - b.size());
  return word;
}

struct NamedAxis {
  Axis axis = no_axis;
  bool plain = false;  ///< nothing stands beside the name
};

/// What a column is in a family.
NamedAxis axis_of(const std::string& name, const Family& family) {
  if (name.size() == 3 && alike(name.substr(0, 1), "n") && name[1] == '\xC2') return {};  // N°
  const std::vector<std::string> words = words_of(name);
  std::string all;
  for (const std::string& word : words) all += word;
  if (const Axis axis = family.axis_of(all)) return {axis, true};
  std::string left;
  std::size_t count = 0;
  for (const std::string& word : words)
    if (family.axis_of(word) != no_axis || !is_beside(word)) {
      left += word;
      ++count;
    }
  if (const Axis axis = family.axis_of(left)) return {axis, false};
  return {count == 1 ? family.axis_of(bare(left)) : no_axis, false};
}

/// Degrees in a column of their own, minutes and seconds in others: no decimal degrees.
bool in_minutes(const std::vector<std::string>& names) {
  return std::any_of(names.begin(), names.end(), [](const std::string& name) {
    const std::vector<std::string> words = words_of(name);
    const auto any_of = [&](const WordList& list) {
      return std::any_of(words.begin(), words.end(),
                         [&](const std::string& word) { return has(list, word); });
    };
    return any_of({"min", "minute", "minutes", "sec", "second", "seconds"}) &&
           any_of({"lat", "latitude", "lon", "long", "lng", "longitude"});
  });
}

/// The columns of one family; `plain`: whose names have nothing beside them.
std::vector<std::uint32_t> columns_of(const Family& family, const std::vector<NamedAxis>& axes,
                                      bool plain) {
  const auto with = [&](Axis axis, bool only_plain) {
    std::vector<std::uint32_t> found;
    for (std::uint32_t j = 0; j < axes.size(); ++j)
      if (axes[j].axis == axis && (axes[j].plain || !only_plain)) found.push_back(j);
    return found;
  };
  const auto first = with(first_axis, plain), second = with(second_axis, plain);
  auto height = with(height_axis, true);
  if (height.empty()) height = with(height_axis, false);
  if (first.size() != 1 || second.size() != 1 || height.size() > 1) return {};
  std::vector<std::uint32_t> columns{first[0], second[0]};
  if (!height.empty() && !family.height.empty()) columns.push_back(height[0]);
  return columns;
}

/// "dim_12" -> "dim_" and 12.
bool split_number(const std::string& name, std::string& stem, std::uint64_t& number) {
  const std::size_t end = name.find_last_not_of("0123456789") + 1;
  stem = name.substr(0, end);
  const auto [p, error] = std::from_chars(name.data() + end, name.data() + name.size(), number);
  return error == std::errc() && p == name.data() + name.size() && end < name.size();
}

bool are_numbered(const std::vector<std::string>& names) {
  std::string stem, other;
  std::uint64_t before = 0, number = 0;
  for (std::size_t j = 0; j < names.size(); ++j, before = number)
    if (!split_number(names[j], j == 0 ? stem : other, number) ||
        (j > 0 && (!alike(stem, other) || number != before + 1)))
      return false;
  return true;
}

/// a, b, c; also colours, which their letters do not order.
bool are_letters(const std::vector<std::string>& names) {
  std::string letters;
  for (const std::string& name : names) {
    if (name.size() != 1 || std::isalpha(static_cast<unsigned char>(name[0])) == 0) return false;
    letters += static_cast<char>(std::tolower(static_cast<unsigned char>(name[0])));
  }
  if (letters == "rgb" || letters == "xyzw") return true;
  for (std::size_t j = 1; j < letters.size(); ++j)
    if (letters[j] != letters[j - 1] + 1) return false;
  return true;
}

/// vel_x, vel_y, vel_z.
bool are_axes_of_a_stem(const std::vector<std::string>& names) {
  if (names.size() < 2 || names.size() > 3) return false;
  std::string stem = names[0];
  if (stem.empty()) return false;
  stem.pop_back();
  for (std::size_t j = 0; j < names.size(); ++j) {
    std::string wanted = stem;
    wanted += "xyz"[j];
    if (!alike(names[j], wanted)) return false;
  }
  return true;
}

}  // namespace

std::vector<std::uint32_t> find_known_columns(const std::vector<std::string>& names) {
  std::vector<std::vector<NamedAxis>> axes;
  for (const Family& family : families()) {
    std::vector<NamedAxis>& of = axes.emplace_back();
    for (const std::string& name : names) of.push_back(axis_of(name, family));
  }
  for (const bool plain : {true, false})
    for (std::size_t f = 0; f < axes.size(); ++f) {
      std::vector<std::uint32_t> found = columns_of(families()[f], axes[f], plain);
      const bool longitudes = f == 1;
      if (!found.empty() && !(longitudes && in_minutes(names))) return found;
    }
  return {};
}

bool is_height_name(const std::string& name) {
  return axis_of(name, {{}, {}, heights()}).axis == height_axis;
}

bool is_unit(std::string_view word) {
  std::string text;
  for (const char c : word)
    if (std::string_view("()[]{} \t").find(c) == std::string_view::npos)
      text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text == "\xC2\xB0" || text == "-" || has(units(), text);
}

std::vector<std::uint32_t> find_numbering(const std::vector<std::string>& names) {
  static const WordList known{
      "",      "id",      "index",    "fid",         "oid",      "gid",   "pid",
      "no",    "nr",      "num",      "number",      "objectid", "point", "pointid",
      "pt",    "ptid",    "pointno",  "pointnumber", "row",      "rowid", "unnamed0",
      "punkt", "punktnr", "rownames", "n\xC2\xB0",   "n\xC2\xBA"};
  std::vector<std::uint32_t> found;
  for (std::uint32_t j = 0; j < names.size(); ++j) {
    std::string word;
    for (const char c : names[j])
      if (std::isalnum(static_cast<unsigned char>(c)) != 0 || (c & 0x80) != 0)
        word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (has(known, word)) found.push_back(j);
  }
  return found;
}

bool are_series(const std::vector<std::string>& names) {
  if (names.empty()) return false;
  return (names.size() > 1 && are_numbered(names)) || are_letters(names) ||
         are_axes_of_a_stem(names);
}

std::vector<std::string> column_labels(const std::vector<std::uint32_t>& columns,
                                       const std::vector<std::string>& names) {
  std::vector<std::string> labels;
  for (const std::uint32_t c : columns)
    labels.push_back(c < names.size() ? names[c] : std::to_string(c));
  return labels;
}

std::uint32_t find_key(const ReadOptions& options, const std::string& file,
                       const std::vector<std::string>& names, std::uint32_t width,
                       std::vector<std::uint32_t>& columns) {
  if (options.key.empty()) return 0xFFFFFFFF;
  const std::vector<std::uint32_t> key = find_columns(options.key, file, names, width);
  if (key.size() != 1)
    refuse(file, options.key,
           options.weights.empty()
               ? "a key is one column"
               : std::to_string(key.size()) + " columns; expected one number per point");
  if (options.columns.empty()) std::erase(columns, key[0]);
  if (columns.empty()) refuse(file, options.key, "no coordinates are left beside the key");
  return key[0];
}

ChosenFields choose_fields(const ReadOptions& options, const std::string& file,
                           const std::vector<std::string>& names, std::uint32_t axes) {
  ChosenFields chosen;
  chosen.columns = find_columns(options.columns.empty() ? ":" : options.columns, file, names, axes);
  const std::uint32_t key = find_key(options, file, names, axes, chosen.columns);
  chosen.keyed = !options.key.empty();
  chosen.labels = column_labels(chosen.columns, names);
  if (chosen.keyed) chosen.columns.push_back(key);
  return chosen;
}

PointData with_keys(PointData data, const ChosenFields& chosen) {
  data.chosen = true;
  data.columns = chosen.labels;
  if (!chosen.keyed) return data;
  --data.view.dimension;
  PointView keys = data.view;  // the column behind the last one
  keys.dimension = data.view.dimension + 1;
  char text[40];
  for (std::uint64_t i = 0; i < keys.count; ++i) {
    const auto r = std::to_chars(text, text + sizeof text, keys.at(i, keys.dimension - 1));
    data.keys.add({text, static_cast<std::size_t>(r.ptr - text)});
  }
  return data;
}

void choose_columns(PointData& data, const std::string& file, std::vector<std::string> names,
                    const ReadOptions& options) {
  if (data.chosen || (options.columns.empty() && options.key.empty())) return;
  data.chosen = true;
  const std::uint32_t width = data.view.dimension;
  names.resize(
      std::min<std::size_t>(names.size(), width));  // those of a format, x y z, of a 2D file
  std::vector<std::uint32_t> columns =
      find_columns(options.columns.empty() ? ":" : options.columns, file, names, width);
  const std::uint32_t key = find_key(options, file, names, width, columns);
  if (key != 0xFFFFFFFF) add_keys(data, key);
  data.columns = column_labels(columns, names);
  take_columns(data, columns);
}

void take_columns(PointData& data, const std::vector<std::uint32_t>& columns) {
  if (!data.placement.empty()) {
    Placement chosen;
    for (const std::uint32_t c : columns) {
      chosen.scale.push_back(data.placement.scale[c]);
      chosen.offset.push_back(data.placement.offset[c]);
    }
    chosen.unit = data.placement.unit;
    data.placement = std::move(chosen);
  }
  if (!evenly_spaced(columns)) return gather(data, columns);
  PointView& view = data.view;
  if (view.data != nullptr)  // of a header alone, or of no points
    view.data += static_cast<std::ptrdiff_t>(columns[0]) * view.coordinate_stride;
  if (columns.size() > 1)
    view.coordinate_stride *=
        static_cast<std::ptrdiff_t>(columns[1]) - static_cast<std::ptrdiff_t>(columns[0]);
  view.dimension = static_cast<std::uint32_t>(columns.size());
}

}  // namespace cullhull::internal

namespace cullhull {

std::vector<std::uint32_t> coordinate_columns(const std::vector<std::string>& names, bool series) {
  using namespace internal;
  std::vector<std::uint32_t> columns = find_known_columns(names);
  if (!columns.empty() || !series) return columns;
  const std::vector<std::uint32_t> numbering = find_numbering(names);
  for (std::uint32_t j = 0; j < names.size(); ++j)
    if (!std::binary_search(numbering.begin(), numbering.end(), j)) columns.push_back(j);
  if (names.size() > 1 && !are_series(column_labels(columns, names))) columns.clear();
  return columns;
}

}  // namespace cullhull
