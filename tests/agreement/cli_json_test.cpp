// Every JSON document the program writes is the one that docs/cullhull.schema.json describes.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <utility>

#include "agreement/expect_json.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/io.hpp"
#include "cullhull/version.hpp"

namespace cullhull::cli_json_test {

using nlohmann::json;
using namespace testing;

/// The file `-o` writes with these arguments, checked.
json expect_file(std::vector<std::string> arguments, const std::string& file,
                 const std::string& kind) {
  arguments.insert(arguments.end(), {"-o", file});
  const Ran ran = run_well(arguments);
  return expect_document(read_file(file), kind);
}

TEST(CliJson, CertifySaysWhyNot) {
  const Folder f;
  write_points(f / "p.npy", "ball", 3000, 3);
  run_well({"hull", f / "p.npy", "-q", "-o", f / "h.json"});
  write_npy_points(f / "q.npy", generate("ball", 3000, 3, 4).data(), 3000, 3, ScalarType::f64);
  const json checked =
      expect_json({"certify", f / "q.npy", f / "h.json", "--json"}, "certify_report", 3);
  EXPECT_EQ(checked["certified"], false);
  EXPECT_TRUE(checked["reason"].is_string());
}

TEST(CliJson, InfoCountsWhatIsNotFinite) {
  const Folder f;
  write_file(f / "p.txt", "0 0\n1 inf\n0 nan\n-inf 1\n");
  const json info = expect_json({"info", f / "p.txt", "--json"}, "info_report");
  EXPECT_EQ(info["not_finite"], 3);
  EXPECT_EQ(info["first_not_finite"], 1);
  EXPECT_EQ(info["axes"][0]["least"], "-inf");
  EXPECT_EQ(info["axes"][1]["greatest"], "inf");
  run_well({"generate", "ball", "-n", "0", "-q", "-o", f / "none.npy"});
  EXPECT_EQ(expect_json({"info", f / "none.npy", "--json"}, "info_report")["axes"][0]["least"],
            nullptr);
  // Into a file, the summary stays.
  const Ran ran = run_app({"info", f / "p.txt", "--json=" + (f / "i.json")});
  EXPECT_EQ(schema().fault(json_in(f / "i.json"), "info_report"), "");
  EXPECT_TRUE(has(ran.out, "finite     no: 3 points"));
}

TEST(CliJson, InfoPlansTheWayThatHullTakes) {
  const Folder f;
  const auto generate = [&](const char* shape, const char* n, const char* d) {
    const std::string path = f / (std::string(shape) + "-" + n + "-" + d + ".npy");
    run_well({"generate", shape, "-n", n, "-d", d, "-q", "-o", path});
    return path;
  };
  struct Case {
    std::string file;
    std::vector<std::string> options;
    std::string taken;  ///< the end of cull.reason
    std::vector<std::string> named;
  };
  const Case cases[] = {
      {generate("ball", "10", "2"), {}, "few in plane", {"few in plane"}},
      {generate("ball", "5k", "2"), {}, "ellipse, few in plane", {"ellipse", "few in plane"}},
      {generate("grid", "3k", "2"), {}, "columns, few in plane", {"columns", "few in plane"}},
      {generate("sphere", "100k", "2"), {}, "; then plane engine", {"gauge map", "plane engine"}},
      {generate("ball", "500", "3"), {}, "few in space", {"few in space"}},
      {generate("grid:16", "1k", "3"), {}, "small lattice, few in space", {"small lattice"}},
      {generate("ball", "5k", "3"), {}, " directions; then few in space", {"outermost"}},
      {generate("sphere", "5k", "3"), {}, "; then space engine", {"space engine"}},
      {generate("ball", "100k", "3"), {"--backend", "cpu"}, "; then space engine", {"gauge map"}},
      {generate("ball", "5k", "3"),
       {"--cull", "pseudo-hull"},
       "; then few in space",
       {"pseudo-hull"}},
      {generate("ball", "500", "3"),
       {"--cull", "none"},
       "asked; then few in space",
       {"few in space"}},
      {generate("ball", "500", "3"), {"--memory", "1M"}, "; then space engine", {"space engine"}},
      {generate("ball", "100", "4"), {}, "few in 4D", {"few in 4D"}},
      {generate("ball", "300", "5"), {}, "; then general engine", {"general engine"}},
  };
  for (const Case& c : cases) {
    const auto with = [&](std::vector<std::string> words) {
      words.insert(words.end(), c.options.begin(), c.options.end());
      return words;
    };
    const json hull = expect_json(with({"hull", c.file, "--json"}), "hull_report");
    const std::string reason = hull["cull"]["reason"];
    EXPECT_TRUE(reason.ends_with(c.taken)) << c.file << ": " << reason;
    const json plan =
        expect_json(with({"info", c.file, "--plan", "--json"}), "info_report")["plan"];
    // What was taken is planned, and is tried or depends on what a filter leaves.
    for (std::string way : c.named) {
      const auto row =
          std::find_if(plan.begin(), plan.end(), [&](const json& r) { return r["way"] == way; });
      ASSERT_NE(row, plan.end()) << c.file << ", " << way;
      EXPECT_EQ((*row)["tried"], "yes") << c.file << ", " << way;
    }
    std::istringstream text(run_well(with({"info", c.file, "--plan"})).out);
    for (std::string line; std::getline(text, line);) EXPECT_LE(line.size(), 80U) << line;
  }
  // What cannot be is told.
  const auto row_of = [&](const std::string& file, const std::vector<std::string>& options,
                          const std::string& way) {
    std::vector<std::string> words{"info", file, "--plan", "--json"};
    words.insert(words.end(), options.begin(), options.end());
    const json info = expect_json(words, "info_report");
    for (const json& row : info["plan"])
      if (row["way"] == way)
        return row["tried"].get<std::string>() + ": " + row["reason"].get<std::string>();
    return std::string("is not listed");
  };
  const std::string ball = f / "ball-5k-3.npy";
  EXPECT_EQ(row_of(ball, {}, "few in plane"), "is not listed");
  EXPECT_EQ(row_of(ball, {}, "few in space"), "left: if a filter leaves at most 2,048 points");
  EXPECT_EQ(row_of(generate("ball", "3", "3"), {}, "few in space"), "no: needs 4 points");
  EXPECT_EQ(row_of(ball, {}, "gauge map"), "no: too few points for the filter to pay (5000)");
  EXPECT_EQ(row_of(ball, {}, "pseudo-hull"), "no: only if it is asked for");
  EXPECT_EQ(row_of(ball, {"--cull", "none"}, "gauge map"), "no: no filter, as asked");
  EXPECT_EQ(row_of(ball, {"--cull", "none"}, "few in space"), "no: takes at most 1024 points");
  EXPECT_EQ(row_of(ball, {"--cull", "gauge"}, "outermost"), "no: a filter is asked for");
  EXPECT_EQ(row_of(ball, {"--memory", "1M"}, "few in space"), "no: needs a budget of 4 MiB");
  EXPECT_EQ(row_of(ball, {"--stream", "on"}, "blocks").substr(0, 3), "yes");
}

TEST(CliJson, InfoHasTheRangesOfEveryTypeAndDimension) {
  const Folder f;
  for (unsigned d = 1; d <= 10; ++d)
    for (const ScalarType type :
         {ScalarType::f32, ScalarType::f64, ScalarType::i8, ScalarType::u8, ScalarType::i16,
          ScalarType::u16, ScalarType::i32, ScalarType::u32}) {
      const bool whole = type != ScalarType::f32 && type != ScalarType::f64;
      const std::size_t n = 16384 + 5 * d;  // a chunk and a piece of one
      std::vector<double> rows = generate("cube", n, d, d);
      for (double& x : rows) x = whole ? std::floor(60 * (x + 1)) : static_cast<float>(x);
      const std::size_t bad = d % 2 != 0 ? n - 1 : 7;
      if (!whole) rows[bad * d] = d % 3 != 0 ? NAN : INFINITY;
      write_npy_points(f / "p.npy", rows.data(), n, d, type);
      const json info = expect_json({"info", f / "p.npy", "--json"}, "info_report");
      for (unsigned j = 0; j < d; ++j) {
        double least = INFINITY, greatest = -INFINITY;
        for (std::size_t i = 0; i < n; ++i) {
          least = std::fmin(least, rows[i * d + j]);
          greatest = std::fmax(greatest, rows[i * d + j]);
        }
        EXPECT_EQ(info["axes"][j]["least"], least);
        if (greatest < INFINITY)
          EXPECT_EQ(info["axes"][j]["greatest"], greatest);
        else
          EXPECT_EQ(info["axes"][j]["greatest"], "inf");
      }
      EXPECT_EQ(info["not_finite"], whole ? 0 : 1);
      EXPECT_EQ(info["first_not_finite"], whole ? json() : json(bad));
    }
}

TEST(CliJson, SequencesPagesAndSets) {
  const Folder f;
  const json made =
      expect_json({"generate", "ball", "-n", "3000", "--frames", "3", "--motion", "spin", "--seed",
                   "18446744073709551615", "-o", f / "s.npy", "--json"},
                  "generate_report");
  EXPECT_EQ(made["seed"], 18446744073709551615U);
  EXPECT_EQ(made["frames"], 3);
  EXPECT_EQ(expect_json({"generate", "ball", "-n", "30", "-o", f / "p.npy", "--json"},
                        "generate_report")["motion"],
            nullptr);
  EXPECT_EQ(expect_json({"track", f / "s.npy", "--json", "--certify"}, "track_report")["certified"],
            true);
  write_file(f / "a.txt", "0 0\n1 0\n0 1\n");
  write_file(f / "b.txt", "0 0\n1 0\n0 nan\n");
  expect_json({"track", f / "a.txt", f / "b.txt", "--json", "--keep-going"}, "track_report", 1);
  if (run_app({"view", f / "p.npy", "-q", "-o", f / "v.html"}).status == 5) return;
  expect_json({"view", f / "p.npy", "-o", f / "v.html", "--json"}, "hull_report");
  const json shown =
      expect_json({"view", f / "s.npy", "-o", f / "v.html", "--json"}, "view_report");
  ASSERT_EQ(shown["frames"].size(), 3U);
  EXPECT_EQ(shown["frames"][2]["kind"], "hull_report");
  run_well({"hull", f / "p.npy", "-q", "-o", f / "h.json"});
  expect_json({"view", f / "h.json", "-o", f / "v.html", "--json"}, "hull_figures");
}

// What the bare flag becomes on its way to the parser is nobody's business.
TEST(CliJson, ErrorsDoNotShowTheSpellingOut) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"--json"}, {"hull", "--json"}}) {
    const Ran ran = run_app(arguments);
    EXPECT_EQ(ran.status, 2) << ran.err;
    EXPECT_FALSE(has(ran.err, "--json=-"));
  }
}

TEST(CliJson, Groups) {
  const Folder f;
  testing::write_file(f / "p.csv", "k,x,y\na,0,0\na,1,0\na,0,2\nb,3,3\n");
  const Ran ran = run_well({"hull", f / "p.csv", "--by", "k", "-o", f / "h.json"});
  json parsed = expect_document(read_file(f / "h.json"), "groups");
  EXPECT_EQ(parsed["points"], (json{{"count", 4}, {"dimension", 2}, {"scalar", "f64"}}));
  parsed["groups"][0].erase("points");
  EXPECT_NE(schema().fault(parsed, "groups"), "");
}

TEST(CliJson, DocumentsNameTheirPoints) {
  const Folder f;
  write_npy_points(f / "f.npy", std::vector<double>{0, 0, 1, 0, 0, 1, 1, 2}.data(), 4, 2,
                   ScalarType::f32);
  for (const auto& [command, kind] :
       {std::pair{"delaunay", "triangulation"}, {"voronoi", "voronoi"}, {"alpha", "alpha_shape"}})
    EXPECT_EQ(expect_file({command, f / "f.npy"}, f / "x.json", kind)["points"],
              (json{{"count", 4}, {"dimension", 2}, {"scalar", "f32"}}))
        << command;
  EXPECT_EQ(
      expect_file({"alpha", f / "f.npy", "--alpha", "inf"}, f / "a.json", "alpha_shape")["alpha"],
      "inf");
  EXPECT_EQ(
      expect_file({"alpha", f / "f.npy", "--ratio", "0.5"}, f / "a.json", "alpha_shape")["alpha"],
      nullptr);
}

// What was not asked for is null in a report.
TEST(CliJson, ReportsOfWhatWasNotAskedFor) {
  const Folder f;
  write_points(f / "p.npy", "disk", 200, 2);
  EXPECT_EQ(expect_json({"hull", f / "p.npy", "--json"}, "hull_report")["certified"], nullptr);
  EXPECT_EQ(expect_json({"voronoi", f / "p.npy", "--json"}, "voronoi_report")["measure"], nullptr);
  run_well({"hull", f / "p.npy", "-q", "-o", f / "h.json"});
  const json checked =
      expect_json({"certify", f / "p.npy", f / "h.json", "--json"}, "certify_report");
  EXPECT_EQ(checked["certified"], true);
  EXPECT_EQ(checked["reason"], nullptr);
}

// -0 and what is not finite are spelled alike by all writers.
TEST(CliJson, OneSpellingOfNumbers) {
  const Folder f;
  write_file(f / "p.csv", "k,x,y\na,-0.0,-0.0\na,1,-0.0\na,-0.0,2\n");
  const std::string zero = "\"vertex_coordinates\": [";
  run_well(
      {"hull", f / "p.csv", "--columns", "x,y", "-q", "-o", f / "h.json", "-o", f / "h.geojson"});
  run_well({"hull", f / "p.csv", "--by", "k", "-q", "-o", f / "g.json"});
  EXPECT_TRUE(has(read_file(f / "h.json"), zero + "\n[-0.0,-0.0],\n[1,-0.0],\n[-0.0,2]]"));
  EXPECT_TRUE(has(read_file(f / "g.json"), zero + "[-0.0,-0.0],[1,-0.0],[-0.0,2]]"));
  EXPECT_TRUE(has(read_file(f / "h.geojson"), "[-0.0, 2]"));
  run_well({"voronoi", f / "p.csv", "--columns", "x,y", "-q", "-o", f / "v.json"});
  EXPECT_EQ(json_in(f / "v.json")["vertices"], json::parse("[[0.5, 1]]"));
  write_file(f / "far.csv", "k,x,y\na,0,0\na,1e308,0\na,0,1e308\n");
  run_well({"hull", f / "far.csv", "--by", "k", "-q", "-o", f / "g.json"});
  EXPECT_EQ(json_in(f / "g.json")["groups"][0]["area"], "inf");
  EXPECT_EQ(
      expect_json({"hull", f / "far.csv", "--columns", "x,y", "--json"}, "hull_report")["area"],
      "inf");
}

// `area` is that of a polygon in the plane and that of a surface in space, in every document.
TEST(CliJson, MeasuresAreNamedByTheDimension) {
  const Folder f;
  write_file(f / "box.csv", "k,x,y\n1,0,0\n1,3,0\n1,3,2\n1,0,2\n");
  write_file(f / "line.csv", "k,x,y\n1,0,0\n1,3,4\n");
  write_file(f / "one.csv", "k,x,y\n1,3,4\n");
  const auto measures = [](const json& of) {
    json found = json::object();
    for (const char* key : {"length", "perimeter", "area", "volume"})
      if (of.contains(key)) found[key] = of[key];
    return found;
  };
  for (const auto& [name, expected] : {std::pair{"box.csv", json{{"perimeter", 10}, {"area", 6}}},
                                       {"line.csv", json{{"length", 5}}},
                                       {"one.csv", json::object()}}) {
    const std::vector<std::string> hull{"hull", f / name, "--columns", "x,y"};
    EXPECT_EQ(measures(expect_file(hull, f / "h.json", "hull")), expected) << name;
    EXPECT_EQ(
        measures(expect_json({"hull", f / name, "--columns", "x,y", "--json"}, "hull_report")),
        expected)
        << name;
    run_well({"hull", f / name, "--by", "k", "-q", "-o", f / "g.json"});
    EXPECT_EQ(measures(expect_document(read_file(f / "g.json"), "groups")["groups"][0]), expected)
        << name;
    run_well(
        {"cull", f / name, "--columns", "x,y", "-q", "--cull", "none", "--points", f / "p.npy"});
    EXPECT_EQ(measures(expect_json({"track", f / "p.npy", "--json"}, "track_report")["frames"][0]),
              expected)
        << name;
    run_well({"certify", f / name, f / "h.json", "--columns", "x,y"});
  }
  write_file(f / "corner.txt", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
  EXPECT_EQ(measures(expect_file({"hull", f / "corner.txt"}, f / "h.json", "hull")).size(), 2U);
  EXPECT_TRUE(expect_file({"hull", f / "corner.txt"}, f / "h.json", "hull").contains("volume"));
}

// The schema itself refuses what it should.
TEST(CliJson, TheSchemaIsStrict) {
  const Folder f;
  write_points(f / "p.npy", "ball", 30, 3);
  const json good = expect_json({"info", f / "p.npy", "--json"}, "info_report");
  for (const auto& [key, value] : good.items()) {
    json bad = good;
    bad.erase(key);
    if (key != "columns") {  // which points of a .hullstate do not have
      EXPECT_NE(schema().fault(bad, "info_report"), "") << key;
    }
    bad[key] = json::object({{"no", "such"}});
    EXPECT_NE(schema().fault(bad, "info_report"), "") << key;
  }
  json more = good;
  more["more"] = 1;
  EXPECT_EQ(schema().fault(more, "info_report"), "info_report.more is not in the schema");
}

}  // namespace cullhull::cli_json_test
