// The one writer of JSON: every document of the library and of the program is written by it, so
// that all have one layout (docs/formats.md, "JSON"). Our own, because a hull of millions of facets
// must be streamed. In headers alone, so that the program can use it beside a shared library.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "cullhull/io.hpp"
#include "cullhull/version.hpp"
#include "io/json/json_text.hpp"

namespace cullhull::internal {

using TextSink = std::function<void(const std::string&)>;
/// Takes the text of the items [0, count), which text_of appends, part by part in any order
/// (OutputFile::write_items).
using ItemSink = std::function<void(
    std::uint64_t count,
    const std::function<void(std::string& text, std::uint64_t begin, std::uint64_t end)>& text_of)>;

/// The points that a document is about.
struct JsonPoints {
  std::uint64_t count = 0;
  std::uint32_t dimension = 0;
  ScalarType scalar = ScalarType::f64;  ///< of the coordinates as they were read
};

/// Writes one document. The layout: each member of the document is on a line of its own; of a
/// member that lists rows or records each of these is, too; all else stays within its line.
class JsonWriter {
 public:
  /// Appends to `text`. Where `sink` is given, it takes the text piece by piece, and `text` stays
  /// small; `items`, where given, takes lists of rows, which threads may format.
  explicit JsonWriter(std::string& text, TextSink sink = {}, ItemSink items = {})
      : text_(text), sink_(std::move(sink)), items_(std::move(items)) {}

  /// `kind`: the name of the document's definition in docs/cullhull.schema.json. What all documents
  /// are to say of their points, a unit for example, has its place here.
  void begin_document(std::string_view kind, const std::optional<JsonPoints>& points) {
    open('{', true);
    member("version", CULLHULL_VERSION);
    member("kind", kind);
    member("schema", json_schema_version);
    if (!points) return;
    key("points");
    begin_object();
    member("count", points->count);
    member("dimension", points->dimension);
    member("scalar", scalar_name(points->scalar));
    end_object();
  }
  /// `tree`: an nlohmann::ordered_json object that holds the head, too.
  template <class Tree>
  void whole_document(const Tree& tree) {
    open('{', true);
    members(tree);
    end_document();
  }
  void end_document() {
    levels_.pop_back();
    text_ += "\n}\n";
    flush();
  }

  void begin_object() { open('{', false); }
  void end_object() { close('}'); }
  /// Begins a list; item() is to be called before each of its values. `lines`: each on a line of
  /// its own.
  void begin_list(bool lines) { open('[', lines); }
  void item() { separate(false); }
  void end_list() { close(']'); }

  void key(std::string_view name) {
    separate(true);
    append_json_string(text_, name);
    text_ += ": ";
  }
  template <class T>
  void member(std::string_view name, const T& v) {
    key(name);
    value(v);
  }

  void null() { text_ += "null"; }
  void value(bool v) { text_ += v ? "true" : "false"; }
  template <class T>
  requires(std::is_integral_v<T> && !std::is_same_v<T, bool>) void value(T v) {
    append_json_number(text_, v);
  }
  void value(double v) { append_json_number(text_, v); }
  void value(std::string_view v) { append_json_string(text_, v); }
  void value(const char* v) { value(std::string_view(v)); }
  /// An index; -1 for `none`.
  void index(std::uint32_t v, std::uint32_t none) {
    if (v == none)
      text_ += "-1";
    else
      value(v);
  }

  /// [a,b,...] of items [from, to), each written by one(items[i]).
  template <class Items, class One>
  void list_by(const Items& items, std::uint64_t from, std::uint64_t to, const One& one) {
    text_ += '[';
    for (std::uint64_t i = from; i < to; ++i) {
      if (i > from) text_ += ',';
      one(items[i]);
      flush_if_long();
    }
    text_ += ']';
  }
  template <class Items>
  void list(const Items& items, std::uint64_t from, std::uint64_t to) {
    list_by(items, from, to, [&](const auto& v) { value(v); });
  }
  template <class Items>
  void flat(std::string_view name, const Items& items) {
    key(name);
    list(items, 0, items.size());
  }
  /// A row on each line, or all within one; row(writer, i) writes one, in several threads at once.
  template <class Row>
  void rows(std::string_view name, std::uint64_t count, const Row& row, bool lines = true) {
    key(name);
    begin_list(lines);
    const auto write = [&](JsonWriter& w, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        w.item();
        row(w, i);
        w.flush_if_long();
      }
    };
    if (items_ && lines) {
      flush();
      items_(count, [&](std::string& text, std::uint64_t begin, std::uint64_t end) {
        JsonWriter part(text);
        part.levels_.push_back({true, begin == 0});
        write(part, begin, end);
      });
    } else {
      write(*this, 0, count);
    }
    end_list();
  }
  template <class T, class Items>
  void nested(std::string_view name, const Lists<T, Items>& lists) {
    rows(name, lists.size(), [&](JsonWriter& w, std::uint64_t i) {
      w.list(lists.items, lists.offsets[i], lists.offsets[i + 1]);
    });
  }
  /// Rows of `width` items each; no row if `width` is 0.
  template <class Items>
  void nested(std::string_view name, const Items& items, std::uint64_t width) {
    rows(name, width > 0 ? items.size() / width : 0,
         [&](JsonWriter& w, std::uint64_t i) { w.list(items, i * width, (i + 1) * width); });
  }

  /// The members of `tree`, an nlohmann::ordered_json object, as members of this one.
  template <class Tree>
  void members(const Tree& tree) {
    for (const auto& [name, v] : tree.items()) {
      key(name);
      this->tree(v);
    }
  }
  template <class Tree>
  void tree(const Tree& v) {
    if (v.is_null())
      null();
    else if (v.is_boolean())
      value(v.template get<bool>());
    else if (v.is_number_unsigned())
      value(v.template get<std::uint64_t>());
    else if (v.is_number_integer())
      value(v.template get<std::int64_t>());
    else if (v.is_number())
      value(v.template get<double>());
    else if (v.is_string())
      value(std::string_view(v.template get_ref<const std::string&>()));
    else if (v.is_object())
      object(v);
    else
      array(v);
  }

 private:
  struct Level {
    bool lines = false, first = true;
  };
  static constexpr std::size_t flush_size = std::size_t{1} << 18;

  void open(char bracket, bool lines) {
    text_ += bracket;
    levels_.push_back({lines});
  }
  void close(char bracket) {
    levels_.pop_back();
    text_ += bracket;
  }
  void separate(bool object) {
    Level& level = levels_.back();
    if (!std::exchange(level.first, false)) text_ += level.lines || !object ? "," : ", ";
    if (level.lines) text_ += '\n';
  }
  template <class Tree>
  void object(const Tree& v) {
    begin_object();
    members(v);
    end_object();
  }
  template <class Tree>
  void array(const Tree& v) {
    bool lines = false;
    for (const auto& one : v) lines = lines || (levels_.size() == 1 && one.is_structured());
    begin_list(lines);
    for (const auto& one : v) {
      item();
      tree(one);
    }
    end_list();
  }
  void flush_if_long() {
    if (text_.size() > flush_size) flush();
  }
  void flush() {
    if (!sink_) return;
    sink_(text_);
    text_.clear();
  }

  std::string& text_;
  TextSink sink_;
  ItemSink items_;
  std::vector<Level> levels_;
};

/// A whole document of the members of `tree`, an nlohmann::ordered_json object.
template <class Tree>
std::string json_document(std::string_view kind, const std::optional<JsonPoints>& points,
                          const Tree& tree) {
  std::string text;
  JsonWriter w(text);
  w.begin_document(kind, points);
  w.members(tree);
  w.end_document();
  return text;
}

/// The text of a whole document that an nlohmann::ordered_json holds.
template <class Tree>
std::string json_text(const Tree& document) {
  std::string text;
  JsonWriter w(text);
  w.whole_document(document);
  return text;
}

/// Writes the members that tell a hull's measures, by the names they have in the dimension k of the
/// points' flat: for k = 1 `length`, for k = 2 `perimeter` and `area`, from 3 on `area` and
/// `volume`; no member below dimension 1.
template <class Put>
void put_measures(int k, double area, double volume, const Put& put) {
  if (k <= 0) return;
  if (k == 1) return put("length", volume);
  put(k == 2 ? "perimeter" : "area", area);
  put(k == 2 ? "area" : "volume", volume);
}

}  // namespace cullhull::internal
