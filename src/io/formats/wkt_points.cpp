// Points of WKT (OGC 06-103r4, and the SRID of PostGIS before it): the positions of all geometries.
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/formats/geometry_positions.hpp"
#include "io/text/text_scan.hpp"

namespace cullhull::internal {
namespace {

struct GeometryTag {
  std::string_view name;
  int depth;  ///< parentheses around positions; 0: of geometries
  bool rings;
};

constexpr GeometryTag tags[] = {
    {"POINT", 1, false},     {"LINESTRING", 1, false},        {"MULTIPOINT", 2, false},
    {"POLYGON", 2, true},    {"TRIANGLE", 2, true},           {"MULTILINESTRING", 2, false},
    {"TIN", 3, true},        {"MULTIPOLYGON", 3, true},       {"POLYHEDRALSURFACE", 3, true},
    {"LINEARRING", 1, true}, {"GEOMETRYCOLLECTION", 0, false}};

const GeometryTag* find_tag(std::string_view word) {
  const auto* const found = std::find_if(std::begin(tags), std::end(tags),
                                         [&](const GeometryTag& tag) { return tag.name == word; });
  return found == std::end(tags) ? nullptr : found;
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// The letters at p, as capitals.
std::string letters_at(const char* p, const char* end) {
  std::string word;
  for (; p < end && is_letter(*p) && word.size() < 40; ++p)
    word += *p >= 'a' ? static_cast<char>(*p - 'a' + 'A') : *p;
  return word;
}

/// A tag with what may be written behind it: POINTZM.
struct Tag {
  const GeometryTag* geometry = nullptr;
  bool has_z = false, has_m = false;
};

Tag tag_of(const std::string& word) {
  Tag tag;
  for (const std::string_view suffix : {"", "ZM", "Z", "M"}) {
    if (!word.ends_with(suffix)) continue;
    tag.geometry = find_tag(std::string_view(word).substr(0, word.size() - suffix.size()));
    if (tag.geometry == nullptr) continue;
    tag.has_z = suffix.starts_with("Z");
    tag.has_m = suffix.ends_with("M");
    return tag;
  }
  return tag;
}

class WktReader {
 public:
  /// `starts`, if there, receives where each position begins.
  WktReader(const Source& source, const ReadOptions& options,
            std::vector<const char*>* starts = nullptr)
      : source_(source),
        options_(options),
        p_(source.data),
        end_(source.data + source.size),
        positions_(!options.columns.empty()),
        starts_(starts) {}

  PointData read() {
    bool any = false;
    for (skip(true); p_ < end_; skip(true), any = true) {
      check_stop(options_);
      read_geometries();
    }
    if (!any) fault("no geometry");
    PointData data = std::move(positions_).points("wkt");
    data.not_finite = not_finite_;
    return data;
  }

 private:
  std::uint64_t line_of(const char* at) const {
    return 1 + static_cast<std::uint64_t>(std::count(source_.data, at, '\n'));
  }
  [[noreturn]] void fault(const std::string& message) const {
    fail_at_line(source_, line_of(p_), message);
  }
  [[noreturn]] void expected(const char* what) const {
    if (p_ == end_) fault(std::string("ends where ") + what + " is expected");
    const char* stop = p_;
    while (stop < end_ && *stop != '\n') ++stop;
    fault(std::string(what) + " is expected, not " +
          quoted_text({p_, static_cast<std::size_t>(stop - p_)}));
  }

  /// Blanks and the ends of lines; between geometries comments and semicolons, too.
  void skip(bool between = false) {
    for (; p_ < end_; ++p_) {
      if (between && is_comment(p_, end_)) {
        while (p_ < end_ && *p_ != '\n') ++p_;
        if (p_ == end_) return;
      }
      if (!is_blank(*p_) && *p_ != '\n' && !(between && *p_ == ';')) return;
    }
  }
  bool take(char c) {
    skip();
    if (p_ == end_ || *p_ != c) return false;
    ++p_;
    return true;
  }
  bool take_word(std::string_view word) {
    skip();
    if (letters_at(p_, end_) != word) return false;
    p_ += word.size();
    return true;
  }

  /// One geometry, with all those in it.
  void read_geometries() {
    pass_srid();
    std::uint64_t open = 0;  // collections
    for (;;) {
      skip();
      if (read_tagged()) {
        ++open;
        continue;
      }
      while (open > 0 && take(')')) --open;
      if (open == 0) return;
      if (!take(',')) expected("',' or ')'");
    }
  }
  void pass_srid() {
    if (letters_at(p_, end_) != "SRID") return;
    p_ += 4;
    if (!take('=')) expected("'='");
    while (p_ < end_ && is_digit(*p_)) ++p_;
    if (!take(';')) expected("';'");
    skip();
  }

  /// Whether it was the beginning of a collection.
  bool read_tagged() {
    const std::string word = letters_at(p_, end_);
    tag_ = tag_of(word);
    if (tag_.geometry == nullptr) expected("a geometry such as POINT (1 2)");
    p_ += word.size();
    for (const std::string_view more : {"ZM", "Z", "M"})
      if (!tag_.has_z && !tag_.has_m && take_word(more)) {
        tag_.has_z = more.starts_with("Z");
        tag_.has_m = more.ends_with("M");
      }
    if (take_word("EMPTY")) {
      if (tag_.has_z) positions_.assume_dimension(3);
      return false;
    }
    if (!take('(')) expected("'(' or EMPTY");
    if (tag_.geometry->depth == 0) return true;
    read_body();
    return false;
  }

  /// Behind the first parenthesis.
  void read_body() {
    const int most = tag_.geometry->depth;
    int depth = 1;
    std::uint64_t first = positions_.size();
    for (;;) {
      skip();
      if (p_ < end_ && *p_ == '(') {
        ++p_;
        if (++depth > most) fault("more parentheses than a " + name() + " has");
        first = positions_.size();
        continue;
      }
      if (!take_word("EMPTY")) {
        // MULTIPOINT (1 2, 3 4) is as good as MULTIPOINT ((1 2), (3 4)).
        if (depth < most && tag_.geometry->name != "MULTIPOINT")
          fault("fewer parentheses than a " + name() + " has");
        read_position();
      }
      while (take(')')) {
        if (depth == most && tag_.geometry->rings) end_ring(first);
        if (--depth == 0) return;
      }
      if (!take(',')) expected("',' or ')'");
    }
  }
  std::string name() const { return std::string(tag_.geometry->name); }

  void read_position() {
    if ((++seen_ & 0xFFFF) == 0) check_stop(options_);
    double numbers[4];
    std::uint32_t count = 0;
    const char* const start = p_;
    for (; p_ < end_ && *p_ != ',' && *p_ != ')'; skip()) {
      if (count == 4) fault("a position of more than four numbers");
      const Scan scan = scan_number(p_, end_, numbers[count]);
      if (scan == Scan::out_of_range) fault("a number exceeds the range of doubles");
      const bool ends = p_ == end_ || is_blank(*p_) || *p_ == '\n' || *p_ == ',' || *p_ == ')';
      if (scan != Scan::ok || !ends) expected("a number");
      ++count;
    }
    if (count < 2) expected(count == 0 ? "a position" : "a second coordinate");
    const bool z = tag_.has_z || (!tag_.has_m && count > 2);
    const std::uint32_t width = z ? 3 : 2;
    // Without the tag a fourth number is a measure.
    const bool fits =
        tag_.has_m ? count == width + 1 : count == width || (!tag_.has_z && count == 4);
    if (!fits)
      fault("a position of " + std::to_string(count) + " numbers in a " + name() +
            (tag_.has_z ? " Z" : "") + (tag_.has_m ? " M" : ""));
    if (not_finite_.line == 0 &&
        !std::all_of(numbers, numbers + width, [](double x) { return std::isfinite(x); }))
      not_finite_ = {positions_.size(), line_of(start)};
    if (!positions_.add(numbers, width))
      fault("a position of " + std::to_string(width) + " coordinates, where others have " +
            std::to_string(positions_.dimension()) + "; --columns x,y takes two of each");
    if (starts_ != nullptr) starts_->push_back(start);
  }

  void end_ring(std::uint64_t first) {
    positions_.close_ring(first);
    if (starts_ != nullptr) starts_->resize(positions_.size());
  }

  const Source& source_;
  const ReadOptions& options_;
  const char* p_;
  const char* end_;
  Positions positions_;
  std::vector<const char*>* starts_;
  PointLine not_finite_;
  std::uint64_t seen_ = 0;  ///< positions
  Tag tag_;
};

}  // namespace

PointData read_wkt(const Source& source, const ReadOptions& options) {
  return WktReader(source, options).read();
}

bool looks_like_wkt(const char* p, const char* end) {
  p = skip_blanks(p, end);
  std::string word = letters_at(p, end);
  if (word == "SRID") return p + 4 < end && p[4] == '=';
  if (tag_of(word).geometry == nullptr) return false;
  p = skip_blanks(p + word.size(), end);
  word = letters_at(p, end);
  if (word == "Z" || word == "M" || word == "ZM") {
    p = skip_blanks(p + word.size(), end);
    word = letters_at(p, end);
  }
  return (p < end && *p == '(') || word == "EMPTY";
}

std::uint64_t line_of_wkt_point(const Source& source, std::uint64_t point) {
  std::vector<const char*> starts;
  WktReader(source, {}, &starts).read();
  const char* const at = point < starts.size() ? starts[point] : source.data;
  return 1 + static_cast<std::uint64_t>(std::count(source.data, at, '\n'));
}

}  // namespace cullhull::internal
