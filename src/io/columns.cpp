#include "io/columns.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>

namespace cullhull::internal::inline io {
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

/// Of the columns that have one of these names, regardless of case.
std::vector<std::uint32_t> positions(const std::vector<std::string>& names,
                                     const std::vector<std::string_view>& wanted) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t j = 0; j < names.size(); ++j)
    if (std::any_of(wanted.begin(), wanted.end(),
                    [&](std::string_view name) { return alike(names[j], name); }))
      found.push_back(j);
  return found;
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

KnownColumns find_known_columns(const std::vector<std::string>& names) {
  static const std::vector<std::string_view> heights{"z", "height", "elevation", "altitude"};
  struct Known {
    std::string_view first, second;
    std::vector<std::string_view> third;
  };
  static const Known known[] = {{"x", "y", {"z"}},
                                {"lon", "lat", heights},
                                {"longitude", "latitude", heights},
                                {"easting", "northing", heights}};
  for (const Known& k : known) {
    const auto first = positions(names, {k.first}), second = positions(names, {k.second}),
               third = positions(names, k.third);
    if (first.size() != 1 || second.size() != 1 || third.size() > 1) continue;
    const std::string one(k.first), two(k.second);
    if (third.empty()) return {{first[0], second[0]}, one + " and " + two};
    std::string name;
    for (const char c : names[third[0]])
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return {{first[0], second[0], third[0]}, one + ", " + two + " and " + name};
  }
  return {};
}

std::vector<std::uint32_t> find_numbering(const std::vector<std::string>& names) {
  return positions(names, {"id", "index", "fid", ""});
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

void choose_columns(PointData& data, const std::string& file, std::vector<std::string> names,
                    const ReadOptions& options) {
  if (options.columns.empty() && options.key.empty()) return;
  const std::uint32_t width = data.view.dimension;
  names.resize(
      std::min<std::size_t>(names.size(), width));  // those of a format, x y z, of a 2D file
  std::vector<std::uint32_t> columns =
      find_columns(options.columns.empty() ? ":" : options.columns, file, names, width);
  const std::uint32_t key = find_key(options, file, names, width, columns);
  if (key != 0xFFFFFFFF) add_keys(data, key);
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

}  // namespace cullhull::internal::inline io
