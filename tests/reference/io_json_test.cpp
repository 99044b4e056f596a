#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <stop_token>
#include <utility>

#include "agreement/canonical_hash.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/version.hpp"
#include "generate/point_generator.hpp"
#include "io/certify_file.hpp"
#include "io/json/json.hpp"
#include "io/json/json_writer.hpp"
#include "tests/hull_fixtures.hpp"
#include "tests/io_fixtures.hpp"
#include "thrown.hpp"

namespace cullhull::testing::io_json_test {

using nlohmann::json;

Hull read(const std::string& text) {
  return internal::read_hull_json({"F", text.data(), text.size()});
}

std::string result_text(const Example& e) {
  const TemporaryFolder folder;
  write_hull(folder.file("a.json"), e.view(), e.hull);
  return slurp(folder.file("a.json"));
}

void expect_equal(const Hull& a, const Hull& b) {
  EXPECT_EQ(a.scalar, b.scalar);
  EXPECT_EQ(testing_support::canonical_hash(a), testing_support::canonical_hash(b));
}

TEST(Json, ResultRoundTrip) {
  for (Example e : {cube(), square()}) {
    e.hull.volume = 0.1;
    e.hull.area = 1e22;
    e.hull.scalar = ScalarType::u16;
    e.hull.facet_planes[0] = 5e-324;
    e.hull.facet_planes[1] = -1.7976931348623157e308;
    e.hull.facet_planes[2] = 9223372036854775808.0;
    expect_equal(read(result_text(e)), e.hull);
  }
}

TEST(Json, NegativeZeroAndWhatIsNotFinite) {
  Example e = cube();
  e.hull.facet_planes[0] = -0.0;
  e.hull.facet_planes[3] = -INFINITY;
  e.hull.volume = INFINITY;
  const Hull h = read(result_text(e));
  EXPECT_TRUE(std::signbit(h.facet_planes[0]));
  EXPECT_EQ(h.facet_planes[3], -INFINITY);
  EXPECT_EQ(h.volume, INFINITY);
}

TEST(Json, HullsWithoutFacets) {
  Example e;
  e.hull.dimension = 3;
  expect_equal(read(result_text(e)), e.hull);
  e.hull.point_count = 2;
  e.coordinates = {1, 2, 3, 1, 2, 3};
  e.hull.affine_dimension = 0;
  e.hull.vertices = {0};
  expect_equal(read(result_text(e)), e.hull);
}

TEST(Json, TheFileHoldsTheResultAndNothingOfTheRun) {
  Example a = cube(), b = cube();
  b.hull.statistics.threads = 7;
  b.hull.statistics.filter = UsedFilter::gauge;
  b.hull.statistics.backend = Backend::cuda;
  b.hull.statistics.compute_seconds = 3;
  b.hull.statistics.survivors = 8;
  EXPECT_EQ(result_text(a), result_text(b));
  std::set<std::string> keys;
  const json parsed = json::parse(result_text(a));
  for (const auto& [key, value] : parsed.items()) keys.insert(key);
  EXPECT_EQ(keys, (std::set<std::string>{"version", "kind", "schema", "points", "affine_dimension",
                                         "vertex_count", "facet_count", "simplex_count", "area",
                                         "volume", "centroid", "vertices", "vertex_coordinates",
                                         "facets", "facet_neighbours", "facet_planes", "simplices",
                                         "simplex_neighbours", "simplex_facets"}));
}

TEST(Json, TheReportHasTheKeysOfTheContract) {
  Example e = cube();
  Statistics& s = e.hull.statistics;
  s.threads = 2;
  s.filter = UsedFilter::gauge_twice;
  s.cull_reason = "because";
  s.survivors = 8;
  s.cull_seconds = 0.25;
  s.hull_seconds = 0.5;
  internal::JsonExtras extras;
  extras.read_seconds = 0.125;
  extras.compute_seconds_all = {3, 1, 2, 8};
  e.hull.statistics.compute_seconds = 2.5;
  extras.peak_bytes = 12345;
  extras.certified = true;
  const json j = json::parse(internal::hull_to_json(e.hull, extras));
  EXPECT_EQ(
      j,
      (json{{"version", CULLHULL_VERSION},
            {"points", {{"count", 9}, {"dimension", 3}, {"scalar", "f64"}}},
            {"kind", "hull_report"},
            {"schema", json_schema_version},
            {"threads", 2},
            {"backend", "cpu"},
            {"cull",
             {{"method", "gauge x2"}, {"survivors", 8}, {"seconds", 0.25}, {"reason", "because"}}},
            {"hull", {{"engine", "native"}, {"seconds", 0.5}}},
            {"affine_dimension", 3},
            {"vertex_count", 8},
            {"facet_count", 6},
            {"simplex_count", 12},
            {"area", 6},
            {"volume", 1},
            {"centroid", {0.5, 0.5, 0.5}},
            {"read_seconds", 0.125},
            {"compute_seconds", 2.5},
            {"compute_seconds_all", {3, 1, 2, 8}},
            {"peak_bytes", 12345},
            {"certified", true}}));
  e.hull.statistics.compute_seconds = 7;
  const json plain = json::parse(internal::hull_to_json(e.hull, {}));
  EXPECT_EQ(plain["certified"], nullptr);
  EXPECT_EQ(plain["compute_seconds"], 7);
  EXPECT_EQ(plain["compute_seconds_all"], json{7});
}

TEST(Json, HostileFilesAreRefused) {
  const json good = json::parse(result_text(cube()));
  const auto refused = [&](const char* key, const json& value) {
    json bad = good;
    bad[key] = value;
    const std::string text = bad.dump();
    return error_of(ErrorCode::bad_file, [&] { read(text); });
  };
  const auto changed =
      [&](const char* key, std::initializer_list<std::size_t> path, const json& v) {
    json value = good[key];
    json* at = &value;
    for (const std::size_t i : path) at = &(*at)[i];
    *at = v;
    return refused(key, value);
  };
  EXPECT_EQ(changed("vertices", {3}, 9),
            "F: vertices: item 3 is 9, but the ids of 9 points go from 0 to below 9; "
            "for a hull made with --first-id give it here, too");
  EXPECT_EQ(changed("facets", {1, 2}, 9),
            "F: facets: item 6 is 9, but the ids of 9 points go from 0 to below 9; "
            "for a hull made with --first-id give it here, too");
  EXPECT_EQ(changed("simplices", {0, 0}, 900),
            "F: simplices: item 0 is 900, but the ids of 9 points go from 0 to below 9; "
            "for a hull made with --first-id give it here, too");
  EXPECT_EQ(changed("facet_neighbours", {0, 0}, 6),
            "F: facet_neighbours: item 0 is 6, but must be below 6");
  EXPECT_EQ(changed("simplex_neighbours", {0, 0}, 12),
            "F: simplex_neighbours: item 0 is 12, but must be below 12");
  EXPECT_EQ(changed("simplex_facets", {0}, 6),
            "F: simplex_facets: item 0 is 6, but must be below 6");
  EXPECT_EQ(changed("facet_neighbours", {0, 0}, std::uint64_t{1} << 32),
            "F: facet_neighbours: 4294967296 is not an index");
  EXPECT_EQ(changed("simplices", {4}, {1, 2}), "F: simplices: entry 4 needs 3 items");
  EXPECT_EQ(changed("facet_planes", {4}, {1, 2, 3}), "F: facet_planes: entry 4 needs 4 items");
  EXPECT_EQ(changed("facets", {0}, {1, 2}), "F: facets: entry 0 has 2 vertices");
  EXPECT_EQ(changed("facet_neighbours", {0}, {1, 2}), "F: facet_neighbours: entry 0 needs 4 items");
  EXPECT_EQ(changed("vertices", {0}, -1), "F: vertices: a value of the wrong kind");
  EXPECT_EQ(changed("vertices", {0}, 1.5), "F: vertices: a value of the wrong kind");
  EXPECT_EQ(changed("vertices", {0}, {1}), "F: vertices: a value of the wrong kind");
  EXPECT_EQ(changed("facets", {0}, 1), "F: facets: a value of the wrong kind");
  EXPECT_EQ(refused("vertex_count", 7), "F: vertices: has 8 entries instead of 7");
  EXPECT_EQ(refused("facet_count", 5), "F: facets: has 6 entries instead of 5");
  EXPECT_EQ(refused("simplex_count", 13), "F: simplex_facets: has 12 entries instead of 13");
  EXPECT_EQ(refused("affine_dimension", 4), "F: affine_dimension: 4 in dimension 3");
  EXPECT_EQ(refused("affine_dimension", -2), "F: affine_dimension: -2 in dimension 3");
  EXPECT_EQ(refused("affine_dimension", 0), "F: vertices: 8 cannot span affine dimension 0");
  EXPECT_EQ(refused("affine_dimension", 2), "F: simplices: entry 0 needs 2 items");
  EXPECT_EQ(refused("points", {{"count", 9}, {"dimension", 0}, {"scalar", "f64"}}),
            "F: points: dimension 0");
  EXPECT_EQ(refused("points", {{"count", 9}, {"dimension", 3}, {"scalar", "f16"}}),
            "F: points: unknown scalar 'f16'");
  EXPECT_EQ(refused("points", {{"count", 9}, {"dimension", 3}}),
            "F: points: needs count, dimension and scalar");
  EXPECT_EQ(refused("points", 3), "F: points: a value of the wrong kind");
  EXPECT_EQ(refused("volume", "big"), "F: volume: a value of the wrong kind");
  EXPECT_EQ(refused("centroid", {1, 2}), "F: centroid: needs one number for each dimension");
  for (const auto& [key, value] : good.items()) {
    if (key == "version" || key == "kind" || key == "schema" || key == "vertex_coordinates")
      continue;
    json bad = good;
    bad.erase(key);
    const std::string text = bad.dump();
    EXPECT_TRUE(has(error_of(ErrorCode::bad_file, [&] { read(text); }), "F: " + key + ": missing"));
  }
}

// Schema 1 had no kind, and called the measures `area` and `volume` in every dimension.
TEST(Json, HullsOfTheFirstSchemaAreRead) {
  for (const Example& e : {cube(), square()}) {
    json old = json::parse(result_text(e));
    for (const char* key : {"kind", "schema", "perimeter"}) old.erase(key);
    old["area"] = e.hull.area;
    old["volume"] = e.hull.volume;
    expect_equal(read(old.dump()), e.hull);
    old["schema"] = 1;  // as reports had it
    expect_equal(read(old.dump()), e.hull);
  }
  json line = json::parse(
      R"({"version": "1", "points": {"count": 2, "dimension": 1, "scalar": "f64"},
"affine_dimension": 1, "vertex_count": 2, "facet_count": 2, "simplex_count": 2, "area": 2,
"volume": 5, "centroid": [2.5], "vertices": [0, 1], "vertex_coordinates": [[0], [5]],
"facets": [[0], [1]], "facet_neighbours": [[1], [0]], "facet_planes": [[-1, 0], [1, 5]],
"simplices": [[0], [1]], "simplex_neighbours": [[1], [0]], "simplex_facets": [0, 1]})");
  const Hull old = read(line.dump());
  line.erase("area");
  line.erase("volume");
  line["length"] = 5;
  expect_equal(read(line.dump()), old);
  EXPECT_EQ(old.volume, 5);
  EXPECT_EQ(old.area, 2);
}

TEST(Json, OtherKindsAndMeasuresAreRefused) {
  const json good = json::parse(result_text(square()));
  const auto refused = [&](const char* key, const json& value, const char* without = "") {
    json bad = good;
    bad[key] = value;
    bad.erase(without);
    const std::string text = bad.dump();
    return error_of(ErrorCode::bad_file, [&] { read(text); });
  };
  EXPECT_EQ(refused("kind", "voronoi"), "F: JSON of the kind 'voronoi', which is not a hull");
  EXPECT_EQ(refused("kind", 3), "F: kind: a value of the wrong kind");
  EXPECT_EQ(refused("schema", 3), "F: JSON of schema 3, newer than this program's 2");
  EXPECT_EQ(refused("schema", "2"), "F: schema: a value of the wrong kind");
  EXPECT_EQ(refused("volume", 1), "F: perimeter: no measure of a hull of dimension 2");
  EXPECT_EQ(refused("length", 1), "F: length: no measure of a hull of dimension 2");
  EXPECT_EQ(refused("kind", "hull", "area"),
            "F: area: missing, so this is not a hull with its lists");
  EXPECT_EQ(refused("kind", "hull", "perimeter"),
            "F: perimeter: missing, so this is not a hull with its lists");
}

TEST(Json, TheWritersLayout) {
  const auto tree = nlohmann::ordered_json::parse(
      R"({"a": 1, "b": [1, 2.5], "c": {"d": -1, "e": [[1], [2]]}, "f": [[1], [{"g": null}]],
          "h": true, "i": [], "j": {}, "k": -0.0, "l": 1e300})");
  EXPECT_EQ(internal::json_document("test", internal::JsonPoints{5, 3, ScalarType::u16}, tree),
            "{\n\"version\": \"" CULLHULL_VERSION
            "\",\n\"kind\": \"test\",\n\"schema\": 2,\n"
            "\"points\": {\"count\": 5, \"dimension\": 3, \"scalar\": \"u16\"},\n"
            "\"a\": 1,\n\"b\": [1,2.5],\n\"c\": {\"d\": -1, \"e\": [[1],[2]]},\n"
            "\"f\": [\n[1],\n[{\"g\": null}]],\n\"h\": true,\n\"i\": [],\n\"j\": {},\n"
            "\"k\": -0.0,\n\"l\": 1e+300\n}\n");
}

TEST(Json, EveryStringAndNumberIsJson) {
  const double inf = std::numeric_limits<double>::infinity();
  std::string text;
  for (const double v : {inf, -inf, std::nan(""), -0.0, 0.0, 5e-324, 0.1}) {
    internal::append_json_number(text, v);
    text += ' ';
  }
  EXPECT_EQ(text, "\"inf\" \"-inf\" \"nan\" -0.0 0 5e-324 0.1 ");
  // Each byte that is no UTF-8 becomes U+FFFD: cut, overlong, a surrogate, beyond the last.
  const std::pair<std::string, std::string> words[] = {
      {"a\"\\\n\x01\x7f", "a\"\\\n\x01\x7f"},
      {"\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80", "\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80"},
      {"\xff", "\xef\xbf\xbd"},
      {"x\xe2\x82", "x\xef\xbf\xbd\xef\xbf\xbd"},
      {"\xc0\xaf", "\xef\xbf\xbd\xef\xbf\xbd"},
      {"\xed\xa0\x80", "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd"},
      {"\xf4\x90\x80\x80", "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd"}};
  for (const auto& [given, expected] : words) {
    std::string written;
    internal::append_json_string(written, given);
    EXPECT_EQ(json::parse(written).get<std::string>(), expected) << written;
  }
}

TEST(Json, BrokenSyntaxNamesTheByte) {
  const std::string good = result_text(square());
  for (std::size_t cut = 0; cut < good.size() - 2; cut += 7) {
    const std::string text = good.substr(0, cut);
    EXPECT_EQ(error_of(ErrorCode::bad_file, [&] { read(text); }).find("F: byte "), 0U) << cut;
  }
  const auto refused = [](const std::string& text) {
    return error_of(ErrorCode::bad_file, [&] { read(text); });
  };
  EXPECT_EQ(refused(good + "x").find("F: byte "), 0U);
  EXPECT_EQ(refused("[1, 2]"), "F: JSON: the text is a list, not a hull");
  EXPECT_EQ(refused("3"), "F: JSON: a value of the wrong kind");
  EXPECT_EQ(refused("{\"area\": 1, \"area\": 2}"), "F: area: given twice");
  EXPECT_EQ(refused("{\"area\": 1e999}").find("F: byte "), 0U);
  EXPECT_EQ(refused(std::string(100000, '[')).find("F: "), 0U);
  EXPECT_EQ(refused("{\"other\": " + std::string(100000, '[')).find("F: byte "), 0U);
}

/// A long text is given up while it is read: its end is no JSON, and is not reached.
TEST(Json, ReadingIsCancelled) {
  internal::PointGenerator points("sphere", 30000, 3, 1);
  std::vector<double> rows(30000 * 3);
  points.rows(0, 30000, rows.data());
  const PointView view = PointView::row_major(rows.data(), 30000, 3);
  std::string text;
  internal::write_result_json(view, convex_hull(view), [&](const std::string& t) { text += t; });
  text.pop_back();
  text += "no end";
  std::stop_source source;
  Options options;
  options.stop = source.get_token();
  unsigned polls = 0;
  options.poll = [&] {
    if (++polls == 3) source.request_stop();
  };
  const auto read_with = [&](const Options& o) {
    internal::certify_source(view, {"F", text.data(), text.size()}, o);
  };
  error_of(ErrorCode::bad_file, [&] { read_with({}); });
  error_of(ErrorCode::cancelled, [&] { read_with(options); });
  EXPECT_EQ(polls, 3U);
}

}  // namespace cullhull::testing::io_json_test
