// Every JSON text the program writes is the one that docs/cullhull.schema.json describes.
#include <filesystem>

#include "agreement/json_schema.hpp"
#include "agreement/run_app.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/io.hpp"

namespace cullhull {
namespace {

using nlohmann::json;
using testing::Folder;
using testing::JsonSchema;
using testing::Ran;
using testing::read_file;
using testing::run_app;
using testing::write_file;
using testing::write_points;

const JsonSchema& schema() {
  static const JsonSchema instance(json::parse(read_file(CULLHULL_SCHEMA)));
  return instance;
}

/// Standard output, checked.
json expect_json(const std::vector<std::string>& arguments, const std::string& name,
                 int status = 0) {
  const Ran ran = run_app(arguments);
  EXPECT_EQ(ran.status, status) << arguments[0] << ": " << ran.err;
  const json parsed = json::parse(ran.out, nullptr, false);
  EXPECT_FALSE(parsed.is_discarded()) << ran.out;
  EXPECT_EQ(schema().fault(parsed, name), "") << arguments[0] << "\n" << ran.out.substr(0, 2000);
  return parsed;
}

/// Sets of every kind of result: space, plane, flat, line, point, 5D, beyond the doubles.
std::vector<std::string> sets(const Folder& f) {
  write_points(f / "ball.npy", "ball", 20000, 3);
  write_points(f / "disk.npy", "disk", 2000, 2);
  write_points(f / "five.npy", "gauss", 300, 5);
  write_file(f / "flat.txt", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0.5 0.5 0\n");
  write_file(f / "line.txt", "0 0\n1 1\n2 2\n");
  write_file(f / "point.txt", "7 7\n7 7\n");
  write_file(f / "huge.txt", "0 0 0\n1e308 0 0\n0 1e308 0\n0 0 1e308\n-1e308 -1e308 -1e308\n");
  return {f / "ball.npy", f / "disk.npy",  f / "five.npy", f / "flat.txt",
          f / "line.txt", f / "point.txt", f / "huge.txt"};
}

TEST(CliJson, ReportsFollowTheSchema) {
  const Folder f;
  for (const std::string& p : sets(f)) {
    EXPECT_EQ(expect_json({"hull", p, "--json"}, "hull")["certified"], nullptr);
    EXPECT_EQ(expect_json({"hull", p, "--json", "--certify", "--repeat", "2"}, "hull")["certified"],
              true);
    expect_json({"hull", p, "--only", "vertices", "--json"}, "extreme");
    expect_json({"hull", p, "-o", "-"}, "result");
    expect_json({"cull", p, "--json"}, "cull");
    expect_json({"info", p, "--json"}, "info");
    ASSERT_EQ(run_app({"hull", p, "-q", "-o", f / "h.json"}).status, 0);
    const json checked = expect_json({"certify", p, f / "h.json", "--json"}, "certify");
    EXPECT_EQ(checked["certified"], true);
    EXPECT_EQ(checked["reason"], nullptr);
  }
}

TEST(CliJson, TriangulationsFollowTheSchema) {
  const Folder f;
  write_points(f / "disk.npy", "disk", 2000, 2);
  write_points(f / "ball.npy", "ball", 200, 3);
  write_file(f / "line.txt", "0 0\n1 1\n2 2\n");
  for (const std::string& p : {f / "disk.npy", f / "ball.npy", f / "line.txt"}) {
    EXPECT_EQ(expect_json({"delaunay", p, "--json", "--certify"}, "delaunay")["certified"], true);
    EXPECT_EQ(expect_json({"voronoi", p, "--json"}, "voronoi")["measure"], nullptr);
    EXPECT_GT(expect_json({"alpha", p, "--json"}, "alpha")["cell_count"], 0);
    EXPECT_EQ(expect_json({"alpha", p, "--alpha", "inf", "--json"}, "alpha")["alpha"], nullptr);
    EXPECT_GT(
        expect_json({"voronoi", p, "--json", "--measures", f / "m.npy"}, "voronoi")["measure"],
        0.0);
  }
}

TEST(CliJson, CertifySaysWhyNot) {
  const Folder f;
  write_points(f / "p.npy", "ball", 3000, 3);
  ASSERT_EQ(run_app({"hull", f / "p.npy", "-q", "-o", f / "h.json"}).status, 0);
  write_npy_points(f / "q.npy", generate("ball", 3000, 3, 4).data(), 3000, 3, ScalarType::f64);
  const json checked = expect_json({"certify", f / "q.npy", f / "h.json", "--json"}, "certify", 3);
  EXPECT_EQ(checked["certified"], false);
  EXPECT_TRUE(checked["reason"].is_string());
}

TEST(CliJson, InfoCountsWhatIsNotFinite) {
  const Folder f;
  write_file(f / "p.txt", "0 0\n1 inf\n0 nan\n-inf 1\n");
  const json info = expect_json({"info", f / "p.txt", "--json"}, "info");
  EXPECT_EQ(info["not_finite"], 3);
  EXPECT_EQ(info["first_not_finite"], 1);
  EXPECT_EQ(info["axes"][0]["least"], "-inf");
  EXPECT_EQ(info["axes"][1]["greatest"], "inf");
  ASSERT_EQ(run_app({"generate", "ball", "-n", "0", "-q", "-o", f / "none.npy"}).status, 0);
  EXPECT_EQ(expect_json({"info", f / "none.npy", "--json"}, "info")["axes"][0]["least"], nullptr);
  // Into a file, the summary stays.
  const Ran ran = run_app({"info", f / "p.txt", "--json=" + (f / "i.json")});
  EXPECT_EQ(schema().fault(json::parse(read_file(f / "i.json")), "info"), "");
  EXPECT_NE(ran.out.find("finite     no: 3 points"), std::string::npos) << ran.out;
}

TEST(CliJson, SequencesPagesAndSets) {
  const Folder f;
  const json made =
      expect_json({"generate", "ball", "-n", "3000", "--frames", "3", "--motion", "spin", "--seed",
                   "18446744073709551615", "-o", f / "s.npy", "--json"},
                  "generate");
  EXPECT_EQ(made["seed"], 18446744073709551615U);
  EXPECT_EQ(made["frames"], 3);
  EXPECT_EQ(expect_json({"generate", "ball", "-n", "30", "-o", f / "p.npy", "--json"},
                        "generate")["motion"],
            nullptr);
  EXPECT_EQ(expect_json({"track", f / "s.npy", "--json", "--certify"}, "track")["certified"], true);
  write_file(f / "a.txt", "0 0\n1 0\n0 1\n");
  write_file(f / "b.txt", "0 0\n1 0\n0 nan\n");
  expect_json({"track", f / "a.txt", f / "b.txt", "--json", "--keep-going"}, "track", 1);
  if (run_app({"view", f / "p.npy", "-q", "-o", f / "v.html"}).status == 5) return;
  expect_json({"view", f / "p.npy", "-o", f / "v.html", "--json"}, "view");
  expect_json({"view", f / "s.npy", "-o", f / "v.html", "--json"}, "view");
  ASSERT_EQ(run_app({"hull", f / "p.npy", "-q", "-o", f / "h.json"}).status, 0);
  expect_json({"view", f / "h.json", "-o", f / "v.html", "--json"}, "view");
}

TEST(CliJson, BenchSuites) {
  expect_json({"bench", "machine", "--bytes", "1M", "--passes", "1", "--json"}, "bench_machine");
  expect_json(
      {"bench", "rivals", "--scale", "1", "--repeat", "1", "--workload", "cube-3d-100", "--json"},
      "bench");
  expect_json({"bench", "calls", "--seconds", "0", "--workload", "cube-3d-100", "--json"}, "bench");
  expect_json({"bench", "lifting", "--scale", "1", "--repeat", "1", "--workload", "uniform-3d-50",
               "--json"},
              "bench");
  expect_json({"bench", "stream", "--scale", "1e-5", "--repeat", "1", "--format", "las", "--json"},
              "bench");
}

// What the bare flag becomes on its way to the parser is nobody's business.
TEST(CliJson, ErrorsDoNotShowTheSpellingOut) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"bench", "--json"}, {"--json"}, {"hull", "--json"}}) {
    const Ran ran = run_app(arguments);
    EXPECT_EQ(ran.status, 2) << ran.err;
    EXPECT_EQ(ran.err.find("--json=-"), std::string::npos) << ran.err;
  }
}

TEST(CliJson, Groups) {
  const Folder f;
  testing::write_file(f / "p.csv", "k,x,y\na,0,0\na,1,0\na,0,2\nb,3,3\n");
  const Ran ran = run_app({"hull", f / "p.csv", "--by", "k", "-o", f / "h.json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  json parsed = json::parse(read_file(f / "h.json"));
  EXPECT_EQ(schema().fault(parsed, "groups"), "");
  parsed["groups"][0].erase("points");
  EXPECT_NE(schema().fault(parsed, "groups"), "");
}

// The schema itself refuses what it should.
TEST(CliJson, TheSchemaIsStrict) {
  const Folder f;
  write_points(f / "p.npy", "ball", 30, 3);
  const json good = expect_json({"info", f / "p.npy", "--json"}, "info");
  for (const auto& [key, value] : good.items()) {
    json bad = good;
    bad.erase(key);
    EXPECT_NE(schema().fault(bad, "info"), "") << key;
    bad[key] = json::object({{"no", "such"}});
    EXPECT_NE(schema().fault(bad, "info"), "") << key;
  }
  json more = good;
  more["more"] = 1;
  EXPECT_EQ(schema().fault(more, "info"), "info.more is not in the schema");
}

}  // namespace
}  // namespace cullhull
