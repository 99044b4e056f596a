// Reads a hull from events, so that memory is that of the lists and not of a document tree; then
// every size, offset and index is checked, because certify() relies on them.
#include <cmath>
#include <limits>
#include <utility>

#include "cullhull/hull.hpp"
#include "io/json/json_events.hpp"
#include "io/mapped_file.hpp"
#include "io/source.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {
namespace {

/// The members of a hull, in the order of `fields`.
enum class Field {
  ignored,
  kind,
  schema,
  points,
  affine_dimension,
  vertex_count,
  facet_count,
  simplex_count,
  length,
  perimeter,
  area,
  volume,
  centroid,
  vertices,
  vertex_coordinates,
  facets,
  facet_neighbours,
  facet_planes,
  simplices,
  simplex_neighbours,
  simplex_facets
};
enum class Shape { single, count, measure, flat, nested };

struct FieldOf {
  const char* name;
  Shape shape;
};
constexpr FieldOf fields[] = {{"", Shape::single},
                              {"kind", Shape::single},
                              {"schema", Shape::single},
                              {"points", Shape::single},
                              {"affine_dimension", Shape::single},
                              {"vertex_count", Shape::count},
                              {"facet_count", Shape::count},
                              {"simplex_count", Shape::count},
                              {"length", Shape::measure},
                              {"perimeter", Shape::measure},
                              {"area", Shape::measure},
                              {"volume", Shape::measure},
                              {"centroid", Shape::flat},
                              {"vertices", Shape::flat},
                              {"vertex_coordinates", Shape::nested},
                              {"facets", Shape::nested},
                              {"facet_neighbours", Shape::nested},
                              {"facet_planes", Shape::nested},
                              {"simplices", Shape::nested},
                              {"simplex_neighbours", Shape::nested},
                              {"simplex_facets", Shape::flat}};
constexpr std::size_t field_total = std::size(fields);

const FieldOf& of(Field field) { return fields[static_cast<std::size_t>(field)]; }

/// The file's contents before they are checked.
struct RawHull {
  Hull hull;
  std::uint64_t dimension = 0;
  std::int64_t affine_dimension = 0;
  std::uint64_t counts[field_total] = {};
  double measures[field_total] = {};
  bool has_count = false, has_dimension = false, has_scalar = false;
  Lists<double> planes;
  Lists<double> coordinates;
  bool want_coordinates = false;  ///< otherwise they are skipped
  std::uint64_t first_id = 0;     ///< id of point 0 in the file
  Lists<std::uint64_t> simplices;
  Lists<std::uint32_t> simplex_neighbours;
  bool seen[field_total] = {};
  bool has(Field field) const { return seen[static_cast<int>(field)]; }
  std::uint64_t count(Field field) const { return counts[static_cast<int>(field)]; }
  double measure(Field field) const { return measures[static_cast<int>(field)]; }
};

class HullReader {
 public:
  HullReader(const Source& source, RawHull& raw, const Control& control)
      : source_(source), raw_(raw), control_(control) {}

  bool null() { return unexpected(); }
  bool boolean(bool) { return unexpected(); }
  bool number_integer(std::int64_t v) {
    poll();
    if (top_level() && field_ == Field::affine_dimension) {
      raw_.affine_dimension = v;
      return true;
    }
    return real(static_cast<double>(v), true);
  }
  bool number_unsigned(std::uint64_t v) {
    poll();
    return whole(v);
  }
  bool number_float(double v, std::string_view) {
    poll();
    return real(v, true);
  }
  bool string(std::string_view v) {
    poll();
    if (top_level() && field_ == Field::kind) return check_kind(v);
    // A measure or an offset that overflows doubles.
    if (v == "inf") return real(std::numeric_limits<double>::infinity(), false);
    if (v == "-inf") return real(-std::numeric_limits<double>::infinity(), false);
    if (v == "nan") return real(std::numeric_limits<double>::quiet_NaN(), false);
    if (!in_points() || inner_ != "scalar") return unexpected();
    for (int t = 0; t <= static_cast<int>(ScalarType::u32); ++t)
      if (v == scalar_name(static_cast<ScalarType>(t))) {
        if (raw_.has_scalar) fault("scalar given twice");
        raw_.hull.scalar = static_cast<ScalarType>(t);
        raw_.has_scalar = true;
        return true;
      }
    fault("unknown scalar " + quoted_text(v));
  }

  bool start_object() {
    ++depth_;
    if (depth_ == 1) return true;
    if (depth_ == 2 && field_ == Field::points) return true;
    return unexpected();
  }
  bool end_object() {
    --depth_;
    return true;
  }
  bool key(std::string_view name) {
    if (depth_ == 1) {
      field_ = Field::ignored;
      for (std::size_t i = 1; i < field_total; ++i)
        if (name == fields[i].name) field_ = static_cast<Field>(i);
      if (field_ == Field::vertex_coordinates && !raw_.want_coordinates) field_ = Field::ignored;
      if (field_ != Field::ignored && std::exchange(raw_.seen[static_cast<int>(field_)], true))
        fault("given twice");
    } else if (in_points()) {
      inner_ = name;
    }
    return true;
  }
  bool start_array() {
    ++depth_;
    if (depth_ == 1) fault("the text is a list, not a hull");
    const bool ok = (depth_ == 2 && (is_flat() || is_nested())) || (depth_ == 3 && is_nested());
    return ok || unexpected();
  }
  bool end_array() {
    if (depth_ == 3 && is_nested()) end_row();
    --depth_;
    return true;
  }
  void at(const char*) {}
  [[noreturn]] void fault(const char* at, std::string_view why) const {
    fail_at_byte(source_, static_cast<std::uint64_t>(at - source_.data), why);
  }

 private:
  /// Called for each value: 2^16 of them take milliseconds.
  void poll() {
    if ((++values_ & 0xFFFF) == 0) control_.check();
  }
  bool top_level() const { return depth_ == 1; }
  bool in_points() const { return depth_ == 2 && field_ == Field::points; }
  bool is_flat() const { return of(field_).shape == Shape::flat; }
  bool is_nested() const { return of(field_).shape == Shape::nested; }
  [[noreturn]] void fault(const std::string& message) const {
    fail(source_, field_ == Field::ignored ? "JSON" : of(field_).name, ": ", message);
  }
  /// Allowed in members that are ignored.
  bool unexpected() const {
    if (depth_ > 0 && field_ == Field::ignored) return true;
    if (in_points() && inner_ != "count" && inner_ != "dimension" && inner_ != "scalar")
      return true;
    fault("a value of the wrong kind");
  }
  void end_row() {
    const auto end = [](auto& lists) { lists.offsets.push_back(lists.items.size()); };
    if (field_ == Field::facets) end(raw_.hull.facets);
    if (field_ == Field::facet_neighbours) end(raw_.hull.facet_neighbours);
    if (field_ == Field::facet_planes) end(raw_.planes);
    if (field_ == Field::vertex_coordinates) end(raw_.coordinates);
    if (field_ == Field::simplices) end(raw_.simplices);
    if (field_ == Field::simplex_neighbours) end(raw_.simplex_neighbours);
  }
  bool check_kind(std::string_view kind) const {
    if (kind == "hull" || kind == "hull_report") return true;
    fail(source_, "JSON of the kind ", quoted_text(kind), ", which is not a hull");
  }
  bool check_schema(std::uint64_t v) const {
    if (v <= json_schema_version) return true;
    fail(source_, "JSON of schema ", v, ", newer than this program's ", json_schema_version);
  }
  std::uint32_t narrow(std::uint64_t v) const {
    if (v > std::numeric_limits<std::uint32_t>::max())
      fault(std::to_string(v) + " is not an index");
    return static_cast<std::uint32_t>(v);
  }
  bool whole(std::uint64_t v) {
    const std::uint64_t level = is_nested() ? 3 : is_flat() || field_ == Field::points ? 2 : 1;
    if (depth_ != level) return unexpected();
    switch (field_) {
      case Field::schema:
        return check_schema(v);
      case Field::points:
        return point_value(v);
      case Field::affine_dimension:
        if (v > std::numeric_limits<std::uint32_t>::max()) fault("out of range");
        raw_.affine_dimension = static_cast<std::int64_t>(v);
        return true;
      case Field::vertex_count:
      case Field::facet_count:
      case Field::simplex_count:
        raw_.counts[static_cast<int>(field_)] = v;
        return true;
      case Field::vertices:
        raw_.hull.vertices.push_back(v);
        return true;
      case Field::facets:
        raw_.hull.facets.items.edit().push_back(v);
        return true;
      case Field::simplices:
        raw_.simplices.items.push_back(v);
        return true;
      case Field::facet_neighbours:
        raw_.hull.facet_neighbours.items.push_back(narrow(v));
        return true;
      case Field::simplex_neighbours:
        raw_.simplex_neighbours.items.push_back(narrow(v));
        return true;
      case Field::simplex_facets:
        raw_.hull.simplex_facets.push_back(narrow(v));
        return true;
      default:
        return real(static_cast<double>(v), true);
    }
  }
  bool point_value(std::uint64_t v) {
    if ((inner_ == "count" && raw_.has_count) || (inner_ == "dimension" && raw_.has_dimension))
      fault(inner_ + " given twice");
    if (inner_ == "count") {
      raw_.hull.point_count = v;
      raw_.has_count = true;
    } else if (inner_ == "dimension") {
      raw_.dimension = v;
      raw_.has_dimension = true;
    } else {
      return unexpected();
    }
    return true;
  }
  /// A double. `number`: written as one, so that it must be finite; else it stands for a word.
  bool real(double v, bool number) {
    if (number && !std::isfinite(v)) fault("a number out of range");
    if (top_level() && of(field_).shape == Shape::measure)
      raw_.measures[static_cast<int>(field_)] = v;
    else if (depth_ == 2 && field_ == Field::centroid)
      raw_.hull.centroid.push_back(v);
    else if (depth_ == 3 && field_ == Field::facet_planes)
      raw_.planes.items.push_back(v);
    else if (depth_ == 3 && field_ == Field::vertex_coordinates && std::isfinite(v))
      raw_.coordinates.items.push_back(v);
    else
      return unexpected();
    return true;
  }

  const Source& source_;
  RawHull& raw_;
  const Control& control_;
  std::uint64_t values_ = 0;
  std::uint64_t depth_ = 0;
  Field field_ = Field::ignored;
  std::string inner_;
};

class HullChecker {
 public:
  HullChecker(const Source& source, RawHull& raw) : source_(source), raw_(raw), hull_(raw.hull) {}

  Hull check() {
    check_header();
    const auto k = static_cast<std::uint64_t>(std::max<std::int64_t>(raw_.affine_dimension, 0));
    const std::uint64_t facets = hull_.facets.size(), simplices = hull_.simplex_facets.size();
    equal("vertices", hull_.vertices.size(), raw_.count(Field::vertex_count));
    if (raw_.want_coordinates) {
      equal("vertex_coordinates", raw_.coordinates.size(), raw_.count(Field::vertex_count));
      widths("vertex_coordinates", raw_.coordinates, raw_.dimension);
    }
    equal("facets", facets, raw_.count(Field::facet_count));
    equal("facet_neighbours", hull_.facet_neighbours.size(), facets);
    equal("facet_planes", raw_.planes.size(), facets);
    equal("simplex_facets", simplices, raw_.count(Field::simplex_count));
    equal("simplices", raw_.simplices.size(), simplices);
    equal("simplex_neighbours", raw_.simplex_neighbours.size(), simplices);
    if (k == 0 && (facets > 0 || simplices > 0)) fault("facets", "a hull of one point has none");

    number_points("vertices", hull_.vertices);
    number_points("facets", hull_.facets.items.edit());
    below("facet_neighbours", hull_.facet_neighbours.items, facets);
    number_points("simplices", raw_.simplices.items);
    below("simplex_neighbours", raw_.simplex_neighbours.items, simplices);
    below("simplex_facets", hull_.simplex_facets, facets);

    widths("facet_planes", raw_.planes, raw_.dimension + 1);
    widths("simplices", raw_.simplices, k);
    widths("simplex_neighbours", raw_.simplex_neighbours, k);
    check_facets(k);
    if (!hull_.centroid.empty() && hull_.centroid.size() != raw_.dimension)
      fault("centroid", "needs one number for each dimension");

    hull_.facet_planes = std::move(raw_.planes.items);
    hull_.simplices = std::move(raw_.simplices.items);
    hull_.simplex_neighbours = std::move(raw_.simplex_neighbours.items);
    return std::move(hull_);
  }

 private:
  [[noreturn]] void fault(const std::string& field, const std::string& message) const {
    fail(source_, field, ": ", message);
  }
  bool is_required(Field field) const {
    if (field == Field::vertex_coordinates) return raw_.want_coordinates;
    return field != Field::kind && field != Field::schema && of(field).shape != Shape::measure;
  }
  /// By the names that measures have in the hull's dimension; in schema 1 they were `area` and
  /// `volume` in every dimension, `area` being that of the boundary.
  void take_measures() {
    const std::int64_t k = raw_.affine_dimension;
    const bool old = k < 3 && raw_.has(Field::volume);
    const auto wanted = [&](Field field) {
      if (old || k > 2) return field == Field::area || field == Field::volume;
      if (k == 2) return field == Field::perimeter || field == Field::area;
      return k == 1 && field == Field::length;
    };
    for (const Field field : {Field::length, Field::perimeter, Field::area, Field::volume}) {
      const char* const name = of(field).name;
      if (wanted(field) && !raw_.has(field))
        fault(name, "missing, so this is not a hull with its lists");
      if (!wanted(field) && raw_.has(field))
        fault(name, "no measure of a hull of dimension " + std::to_string(k));
    }
    const bool boundary_is_perimeter = k == 2 && !old;
    hull_.volume = raw_.measure(boundary_is_perimeter ? Field::area : Field::volume);
    hull_.area = raw_.measure(boundary_is_perimeter ? Field::perimeter : Field::area);
    if (k != 1 || old) return;
    hull_.volume = raw_.measure(Field::length);
    hull_.area = 2;  // the end points
  }
  void check_header() {
    for (std::size_t i = 1; i < field_total; ++i) {
      if (!is_required(static_cast<Field>(i))) continue;
      if (!raw_.seen[i]) fault(fields[i].name, "missing, so this is not a hull with its lists");
    }
    if (!raw_.has_count || !raw_.has_dimension || !raw_.has_scalar)
      fault("points", "needs count, dimension and scalar");
    if (raw_.dimension == 0 || raw_.dimension >= std::numeric_limits<std::uint32_t>::max())
      fault("points", "dimension " + std::to_string(raw_.dimension));
    if (raw_.affine_dimension < -1 ||
        raw_.affine_dimension > std::min<std::int64_t>(static_cast<std::int64_t>(raw_.dimension),
                                                       std::numeric_limits<int>::max()))
      fault("affine_dimension", std::to_string(raw_.affine_dimension) + " in dimension " +
                                    std::to_string(raw_.dimension));
    hull_.dimension = static_cast<std::uint32_t>(raw_.dimension);
    hull_.affine_dimension = static_cast<int>(raw_.affine_dimension);
    take_measures();
    const std::uint64_t least = static_cast<std::uint64_t>(raw_.affine_dimension + 1);
    if (hull_.vertices.size() < least || (least <= 1 && hull_.vertices.size() != least))
      fault("vertices", std::to_string(hull_.vertices.size()) + " cannot span affine dimension " +
                            std::to_string(raw_.affine_dimension));
  }
  void equal(const char* field, std::uint64_t have, std::uint64_t want) const {
    if (have != want)
      fault(field, "has " + std::to_string(have) + " entries instead of " + std::to_string(want));
  }
  /// Ids, which begin at first_id in the file, become positions.
  template <class Items>
  void number_points(const char* field, Items& ids) const {
    const std::uint64_t first = raw_.first_id, end = first + hull_.point_count;
    for (std::uint64_t i = 0; i < ids.size(); ++i) {
      if (ids[i] < first || ids[i] >= end)
        fault(field, "item " + std::to_string(i) + " is " + std::to_string(ids[i]) +
                         ", but the ids of " + std::to_string(hull_.point_count) +
                         " points go from " + std::to_string(first) + " to below " +
                         std::to_string(end) +
                         "; for a hull made with --first-id give it here, too");
      ids[i] -= first;
    }
  }
  template <class Items>
  void below(const char* field, const Items& items, std::uint64_t limit) const {
    for (std::uint64_t i = 0; i < items.size(); ++i)
      if (items[i] >= limit)
        fault(field, "item " + std::to_string(i) + " is " + std::to_string(items[i]) +
                         ", but must be below " + std::to_string(limit));
  }
  template <class T>
  void widths(const char* field, const Lists<T>& lists, std::uint64_t width) const {
    for (std::uint64_t i = 0; i < lists.size(); ++i)
      if (lists.offsets[i + 1] - lists.offsets[i] != width)
        fault(field, "entry " + std::to_string(i) + " needs " + std::to_string(width) + " items");
  }
  /// At least k vertices each, exactly 2 for k = 2; for k = 2, 3 a neighbour for each vertex.
  void check_facets(std::uint64_t k) const {
    for (std::uint64_t i = 0; i < hull_.facets.size(); ++i) {
      const std::uint64_t n = hull_.facets.offsets[i + 1] - hull_.facets.offsets[i];
      const std::uint64_t m =
          hull_.facet_neighbours.offsets[i + 1] - hull_.facet_neighbours.offsets[i];
      if (n < k || (k <= 2 && n != k))
        fault("facets", "entry " + std::to_string(i) + " has " + std::to_string(n) + " vertices");
      if ((k == 2 || k == 3) && m != n)
        fault("facet_neighbours",
              "entry " + std::to_string(i) + " needs " + std::to_string(n) + " items");
    }
  }

  const Source& source_;
  RawHull& raw_;
  Hull& hull_;
};

}  // namespace

Hull read_hull_json(const Source& source, std::vector<double>* vertex_coordinates,
                    const Options& options, std::uint64_t first_id) {
  RawHull raw;
  raw.first_id = first_id;
  raw.want_coordinates = vertex_coordinates != nullptr || options.with_coordinates;
  const Control control(options);
  control.check();
  HullReader reader(source, raw, control);
  JsonEvents(source.data, source.data + source.size, reader).read_all();
  Hull hull = HullChecker(source, raw).check();
  if (vertex_coordinates != nullptr)
    vertex_coordinates->assign(raw.coordinates.items.begin(), raw.coordinates.items.end());
  if (options.with_coordinates)
    hull.vertex_coordinates.assign(raw.coordinates.items.begin(), raw.coordinates.items.end());
  return hull;
}

}  // namespace cullhull::internal

namespace cullhull {

Hull hull_from_json(const std::string& path, std::vector<double>* vertex_coordinates,
                    const Options& options, std::uint64_t first_id) {
  const internal::MappedFile file(path);
  Hull hull = internal::read_hull_json(file.source(), vertex_coordinates, options, first_id);
  file.check_size();
  return hull;
}

}  // namespace cullhull
