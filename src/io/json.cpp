// JSON writers. Our own, because a hull of millions of facets must be streamed. Doubles are printed
// so that they read back as the same double, infinities as the strings "inf" and "-inf".
#include "io/json.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "cullhull/version.hpp"
#include "io/mesh.hpp"

namespace cullhull {
namespace internal {
namespace {

class JsonWriter {
 public:
  explicit JsonWriter(const TextSink& sink) : sink_(sink) {}

  void open() { text_ += "{\n"; }
  void close() {
    text_ += "\n}\n";
    flush();
  }
  void key(const char* name) {
    if (!std::exchange(first_, false)) text_ += ",\n";
    text_ += '"';
    text_ += name;
    text_ += "\": ";
  }
  template <class T>
  void member(const char* name, const T& v) {
    key(name);
    value(v);
  }
  void object(const char* name) {
    key(name);
    text_ += '{';
    inner_first_ = true;
  }
  template <class T>
  void inner(const char* name, const T& v) {
    if (!std::exchange(inner_first_, false)) text_ += ", ";
    text_ += '"';
    text_ += name;
    text_ += "\": ";
    value(v);
  }
  void end_object() { text_ += '}'; }

  /// [a, b, ...] of items [from, to).
  template <class Items>
  void list(const Items& items, std::uint64_t from, std::uint64_t to) {
    text_ += '[';
    for (std::uint64_t i = from; i < to; ++i) {
      if (i > from) text_ += ',';
      value(items[i]);
      if (text_.size() > flush_size) flush();
    }
    text_ += ']';
  }
  template <class Items>
  void flat(const char* name, const Items& items) {
    key(name);
    list(items, 0, items.size());
  }
  template <class T, class Items>
  void nested(const char* name, const Lists<T, Items>& lists) {
    rows(name, lists.size(),
         [&](std::uint64_t i) { list(lists.items, lists.offsets[i], lists.offsets[i + 1]); });
  }
  template <class Items>
  void nested(const char* name, const Items& items, std::uint64_t width) {
    rows(name, width > 0 ? items.size() / width : 0,
         [&](std::uint64_t i) { list(items, i * width, (i + 1) * width); });
  }
  template <class Row>
  void rows(const char* name, std::uint64_t count, const Row& row) {
    key(name);
    text_ += '[';
    for (std::uint64_t i = 0; i < count; ++i) {
      text_ += i > 0 ? ",\n" : "\n";
      row(i);
    }
    text_ += ']';
  }

  void null() { text_ += "null"; }
  void value(bool v) { text_ += v ? "true" : "false"; }
  void value(std::uint64_t v) { append_number(text_, v); }
  void value(std::uint32_t v) { append_number(text_, std::uint64_t{v}); }
  void value(int v) { text_ += std::to_string(v); }
  void value(double v) {
    if (std::isinf(v))
      text_ += v > 0 ? "\"inf\"" : "\"-inf\"";  // a volume that overflows doubles
    else if (std::isnan(v))
      null();
    else if (v == 0 && std::signbit(v))
      text_ += "-0.0";  // "-0" would read back as an integer, which has no sign
    else
      append_number(text_, v);
  }
  void value(const char* s) {
    text_ += '"';
    for (; *s != 0; ++s) {
      const char c = *s;
      if (c == '"' || c == '\\') {
        (text_ += '\\') += c;
      } else if (static_cast<unsigned char>(c) < ' ') {
        char escape[8];
        std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(c));
        text_ += escape;
      } else {
        text_ += c;
      }
    }
    text_ += '"';
  }

 private:
  static constexpr std::size_t flush_size = std::size_t{1} << 18;
  void flush() {
    sink_(text_);
    text_.clear();
  }
  const TextSink& sink_;
  std::string text_;
  bool first_ = true, inner_first_ = true;
};

void write_points(JsonWriter& w, const Hull& hull) {
  w.member("version", CULLHULL_VERSION);
  w.object("points");
  w.inner("count", hull.point_count);
  w.inner("dimension", hull.dimension);
  w.inner("scalar", scalar_name(hull.scalar));
  w.end_object();
}

void write_measures(JsonWriter& w, const Hull& hull) {
  w.member("affine_dimension", hull.affine_dimension);
  w.member("vertex_count", std::uint64_t{hull.vertices.size()});
  w.member("facet_count", hull.facet_count());
  w.member("simplex_count", hull.simplex_count());
  w.member("area", hull.area);
  w.member("volume", hull.volume);
  w.flat("centroid", hull.centroid);
}

void write_lists(JsonWriter& w, const Coordinates& points, const Hull& hull) {
  const auto k = static_cast<std::uint64_t>(std::max(hull.affine_dimension, 0));
  w.flat("vertices", hull.vertices);
  std::vector<double> row(hull.dimension);
  w.rows("vertex_coordinates", hull.vertices.size(), [&](std::uint64_t i) {
    for (std::uint32_t j = 0; j < hull.dimension; ++j) row[j] = points.at(hull.vertices[i], j);
    w.list(row, 0, row.size());
  });
  w.nested("facets", hull.facets);
  w.nested("facet_neighbours", hull.facet_neighbours);
  w.nested("facet_planes", hull.facet_planes, std::uint64_t{hull.dimension} + 1);
  w.nested("simplices", hull.simplices, k);
  w.nested("simplex_neighbours", hull.simplex_neighbours, k);
  w.flat("simplex_facets", hull.simplex_facets);
}

void write_run(JsonWriter& w, const Hull& hull, const JsonExtras& extras) {
  const Statistics& s = hull.statistics;
  const std::vector<double> all = extras.compute_seconds_all.empty()
                                      ? std::vector<double>{s.compute_seconds}
                                      : extras.compute_seconds_all;
  w.member("read_seconds", extras.read_seconds);
  w.member("compute_seconds", s.compute_seconds);
  w.flat("compute_seconds_all", all);
  w.member("peak_bytes", extras.peak_bytes);
  w.key("certified");
  if (extras.certified)
    w.value(*extras.certified);
  else
    w.null();  // not checked
}

}  // namespace

void write_result_json(const Coordinates& points, const Hull& hull, const TextSink& sink) {
  JsonWriter w(sink);
  w.open();
  write_points(w, hull);
  write_measures(w, hull);
  write_lists(w, points, hull);
  w.close();
}

}  // namespace internal

namespace {

std::string report_json(const internal::Coordinates& points, const Hull& hull,
                        const JsonExtras& extras, bool with_lists) {
  std::string text;
  const internal::TextSink sink = [&](const std::string& piece) { text += piece; };
  internal::JsonWriter w(sink);
  const Statistics& s = hull.statistics;
  w.open();
  internal::write_points(w, hull);
  w.member("schema", json_schema_version);
  w.member("threads", std::uint32_t{s.threads});
  w.member("backend", s.backend);
  w.object("cull");
  w.inner("method", s.cull_method);
  w.inner("survivors", s.survivors);
  w.inner("seconds", s.cull_seconds);
  w.inner("reason", s.cull_reason.c_str());
  w.end_object();
  w.object("hull");
  w.inner("engine", s.engine);
  w.inner("seconds", s.hull_seconds);
  w.end_object();
  internal::write_measures(w, hull);
  internal::write_run(w, hull, extras);
  if (with_lists) internal::write_lists(w, points, hull);
  w.close();
  return text;
}

}  // namespace

std::string hull_to_json(const PointView& points, const Hull& hull, const JsonExtras& extras,
                         bool with_lists) {
  return report_json(points, hull, extras, with_lists);
}

std::string hull_to_json(const HullState& state, const Hull& hull, const JsonExtras& extras,
                         bool with_lists) {
  return report_json(state, hull, extras, with_lists);
}

}  // namespace cullhull
