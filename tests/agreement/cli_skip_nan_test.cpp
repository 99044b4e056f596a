// --skip-nan: points without a return are left out of every command, and ids stay the file's.
#include <string>
#include <vector>

#include "agreement/expect_json.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/io.hpp"
#include "cullhull/point_blocks.hpp"

namespace cullhull::cli_skip_nan_test {

using nlohmann::json;
using namespace testing;

/// Points with and without rows of NaN, which are the first, the last and some between.
struct Pair {
  std::string whole, kept;          ///< as text
  std::vector<std::uint64_t> rows;  ///< of the file with NaN, which the other one has
  std::uint64_t count = 0;
};

Pair pair_of(const std::string& shape, std::uint64_t n, std::uint32_t d,
             std::uint64_t leading = 3) {
  const std::vector<double> numbers = generate(shape, n, d, 7);
  Pair made;
  std::uint64_t at = 0;
  const auto row = [&](std::string& text, std::uint64_t i, bool nan) {
    for (std::uint32_t j = 0; j < d; ++j)
      text += (j > 0 ? "," : "") +
              (nan && j == i % d ? std::string("nan") : std::to_string(numbers[i * d + j]));
    text += '\n';
  };
  for (; at < leading; ++at) row(made.whole, at % n, true);
  for (std::uint64_t i = 0; i < n; ++i) {
    row(made.whole, i, false);
    row(made.kept, i, false);
    made.rows.push_back(at++);
    for (std::uint64_t k = 0; k < i * i % 3; ++k, ++at) row(made.whole, i, true);
  }
  row(made.whole, 0, true);
  made.count = at + 1;
  return made;
}

json mapped(json ids, const std::vector<std::uint64_t>& rows) {
  if (ids.is_array()) {
    for (json& item : ids) item = mapped(item, rows);
    return ids;
  }
  return rows[ids.get<std::size_t>()];
}

class CliSkipNan : public ::testing::Test {
 protected:
  void write(const Pair& made) {
    write_file(f / "nan.csv", made.whole);
    write_file(f / "kept.csv", made.kept);
  }
  json document(const std::vector<std::string>& arguments, const std::string& kind) {
    return expect_json(arguments, kind);
  }
  Folder f;
};

TEST_F(CliSkipNan, TheHullHasTheIdsOfTheFile) {
  for (const auto& [shape, d] :
       {std::pair{"ball", 3U}, {"disk", 2U}, {"sphere", 3U}, {"gauss", 5U}})
    for (const std::uint64_t n : {1U, 4U, 50U, 400U}) {
      const Pair made = pair_of(shape, n, d);
      write(made);
      run_well({"hull", f / "kept.csv", "-q", "-o", f / "kept.json"});
      const json kept = json_in(f / "kept.json");
      for (const char* stream : {"off", "on"}) {
        const std::string out = f / (std::string(stream) + ".json");
        const Ran ran = run_well(
            {"hull", f / "nan.csv", "--skip-nan", "--certify", "--stream", stream, "-o", out});
        const std::uint64_t skipped = made.count - n;
        EXPECT_TRUE(has(ran.out, "skipped    " + std::to_string(skipped)));
        const json found = json_in(out);
        EXPECT_EQ(found["points"]["count"], made.count);
        for (const char* ids : {"vertices", "facets", "simplices"})
          EXPECT_EQ(found[ids], mapped(kept[ids], made.rows)) << shape << n << stream << ids;
        for (const char* same : {"facet_planes", "vertex_coordinates", "facet_neighbours"})
          EXPECT_EQ(found[same], kept[same]) << shape << n << stream;
        run_well({"certify", f / "nan.csv", out, "--skip-nan"});
      }
      EXPECT_EQ(read_file(f / "on.json"), read_file(f / "off.json"));
    }
}

TEST_F(CliSkipNan, ReportsCountThem) {
  const Pair made = pair_of("disk", 100, 2);
  write(made);
  const std::string p = f / "nan.csv";
  const std::uint64_t skipped = made.count - 100;
  for (const char* stream : {"off", "on"}) {
    EXPECT_EQ(
        document({"hull", p, "--skip-nan", "--stream", stream, "--json"}, "hull_report")["skipped"],
        skipped);
    EXPECT_EQ(
        document({"cull", p, "--skip-nan", "--stream", stream, "--json"}, "cull_report")["skipped"],
        skipped);
    const json info =
        document({"info", p, "--skip-nan", "--stream", stream, "--json"}, "info_report");
    EXPECT_EQ(info["skipped"], skipped);
    EXPECT_EQ(info["not_finite"], 0);
    EXPECT_EQ(info["points"]["count"], made.count);
    EXPECT_EQ(
        document({"hull", p, "--only", "vertices", "--skip-nan", "--stream", stream, "--json"},
                 "extreme_report")["skipped"],
        skipped);
  }
  EXPECT_EQ(document({"delaunay", p, "--skip-nan", "--json"}, "triangulation_report")["skipped"],
            skipped);
  EXPECT_EQ(document({"voronoi", p, "--skip-nan", "--json"}, "voronoi_report")["skipped"], skipped);
  EXPECT_EQ(document({"alpha", p, "--skip-nan", "--json"}, "alpha_report")["skipped"], skipped);
  EXPECT_EQ(document({"track", p, "--skip-nan", "--json"}, "track_report")["skipped"], skipped);
  run_well({"hull", p, "--skip-nan", "-q", "-o", f / "h.json"});
  EXPECT_EQ(
      document({"certify", p, f / "h.json", "--skip-nan", "--json"}, "certify_report")["skipped"],
      skipped);
  EXPECT_FALSE(document({"hull", f / "kept.csv", "--json"}, "hull_report").contains("skipped"));
  EXPECT_EQ(document({"hull", f / "kept.csv", "--skip-nan", "--json"}, "hull_report")["skipped"],
            0);
}

TEST_F(CliSkipNan, SurvivorsAreThoseOfTheOtherPoints) {
  const Pair made = pair_of("disk", 3000, 2);
  write(made);
  for (const char* stream : {"off", "on"}) {
    const auto ids = [&](const std::string& input, const std::vector<std::string>& more) {
      run_well(joined({"cull", input, "-q", "--stream", stream, "-o", f / "ids.txt"}, more));
      std::istringstream in(read_file(f / "ids.txt"));
      std::vector<std::uint64_t> found;
      for (std::uint64_t id; in >> id;) found.push_back(id);
      return found;
    };
    std::vector<std::uint64_t> kept = ids(f / "kept.csv", {});
    for (std::uint64_t& id : kept) id = made.rows[id];
    EXPECT_EQ(ids(f / "nan.csv", {"--skip-nan"}), kept) << stream;
  }
}

TEST_F(CliSkipNan, TriangulationsHaveTheIdsOfTheFile) {
  for (const std::uint64_t leading : {0U, 3U}) {
    const Pair made = pair_of("disk", 200, 2, leading);
    write(made);
    for (const char* furthest : {"", "--furthest"}) {
      const auto run = [&](const std::string& input, const std::string& out, const char* more) {
        std::vector<std::string> words{"delaunay", input, "-q", "--certify", "-o", out};
        for (const char* word : {furthest, more})
          if (*word != 0) words.emplace_back(word);
        const Ran ran = run_well(words);
        return json_in(out);
      };
      const json kept = run(f / "kept.csv", f / "kept.json", "");
      const json found = run(f / "nan.csv", f / "nan.json", "--skip-nan");
      for (const char* ids : {"cells", "hull_facets"})
        EXPECT_EQ(found[ids], mapped(kept[ids], made.rows)) << ids << leading << furthest;
      EXPECT_EQ(found["neighbours"], kept["neighbours"]);
      EXPECT_EQ(found["hidden"].size(), kept["hidden"].size() + made.count - 200);
      EXPECT_EQ(found["duplicates"].size(), kept["duplicates"].size());
    }
    run_well({"voronoi", f / "kept.csv", "-q", "--measures", f / "kept.txt"});
    run_well({"voronoi", f / "nan.csv", "--skip-nan", "-q", "--measures", f / "nan.txt"});
    std::istringstream with(read_file(f / "nan.txt")), without(read_file(f / "kept.txt"));
    std::vector<double> all, others;
    for (double v; with >> v;) all.push_back(v);
    for (double v; without >> v;) others.push_back(v);
    ASSERT_EQ(all.size(), made.count);
    for (std::size_t i = 0; i < others.size(); ++i) {
      EXPECT_EQ(all[made.rows[i]], others[i]);
      all[made.rows[i]] = 0;
    }
    for (const double v : all) EXPECT_EQ(v, 0);
    for (const char* command : {"alpha", "delaunay", "voronoi"}) {
      run_well({command, f / "kept.csv", "-q", "-o", f / "kept.wkt"});
      run_well({command, f / "nan.csv", "--skip-nan", "-q", "-o", f / "nan.wkt"});
      EXPECT_EQ(std::string(command) == "voronoi" ||
                    read_file(f / "kept.wkt") == read_file(f / "nan.wkt"),
                true)
          << command;
    }
  }
}

TEST_F(CliSkipNan, WeightsAndHeightsBesideThem) {
  write_file(f / "p.csv",
             "x,y,z,w\nnan,nan,nan,nan\n0,0,1,0\n4,0,2,0\nnan,1,nan,nan\n0,4,3,0\n1,1,4,-9\n");
  const Ran tin = run_well({"delaunay", f / "p.csv", "--columns", "x,y", "--height", "z",
                            "--skip-nan", "-q", "-o", f / "tin.json"});
  const json found = json_in(f / "tin.json");
  EXPECT_EQ(found["cells"], json::parse("[[1,2,5],[1,5,4],[2,4,5]]"));
  const Ran power = run_well({"delaunay", f / "p.csv", "--columns", "x,y", "--weights", "w",
                              "--skip-nan", "-q", "-o", f / "power.json"});
  const json regular = json_in(f / "power.json");
  EXPECT_EQ(regular["cells"], json::parse("[[1,2,4]]"));
  EXPECT_EQ(regular["hidden"], json::parse("[0,3,5]"));
  write_file(f / "edges.txt", "1 2\n3 4\n");
  expect_error(
      {"delaunay", f / "p.csv", "--columns", "x,y", "--skip-nan", "--edges", f / "edges.txt"}, 1,
      "edges.txt:2: edge 1 has point 3, which --skip-nan leaves out");
}

TEST_F(CliSkipNan, GroupsStatesAndCheckpoints) {
  write_file(f / "g.csv", "x,y,k\nnan,0,b\n0,0,a\n1,0,a\nnan,nan,a\n0,1,a\n5,5,b\n6,5,b\n5,6,b\n");
  const Ran groups = run_well({"hull", f / "g.csv", "--by", "k", "--skip-nan", "-o", f / "g.json"});
  EXPECT_TRUE(has(groups.out, "skipped    2 points"));
  const json written = json_in(f / "g.json");
  ASSERT_EQ(written["groups"].size(), 2U);
  // A state keeps the ids, and counts what was left out.
  const Pair made = pair_of("sphere", 300, 3);
  write(made);
  run_well({"hull", f / "nan.csv", "--skip-nan", "-q", "--partial", f / "a.hullstate"});
  run_well({"hull", f / "a.hullstate", "-q", "-o", f / "merged.json"});
  run_well({"hull", f / "nan.csv", "--skip-nan", "-q", "-o", f / "h.json"});
  EXPECT_EQ(read_file(f / "merged.json"), read_file(f / "h.json"));
  const Ran twice = run_well({"hull", f / "nan.csv", f / "nan.csv", "--skip-nan", "--stream", "on",
                              "-q", "-o", f / "twice.json", "--checkpoint", f / "c"});
  const json both = json_in(f / "twice.json");
  EXPECT_EQ(both["points"]["count"], 2 * made.count);
  EXPECT_EQ(both["vertices"], json_in(f / "h.json")["vertices"]);
}

TEST_F(CliSkipNan, FramesAndPages) {
  write_file(f / "f-1.xyz", "nan nan\n0 0\n1 0\n0 1\n");
  write_file(f / "f-2.xyz", "5 5\n0 0\nnan 0\n0 1\n");
  run_well({"track", f / "f-1.xyz", f / "f-2.xyz", "--skip-nan", "-q", "--certify", "-o",
            f / "h-%d.json"});
  EXPECT_EQ(json_in(f / "h-0.json")["vertices"], json::parse("[1,2,3]"));
  EXPECT_EQ(json_in(f / "h-1.json")["vertices"], json::parse("[0,3,1]"));
  const Ran page = run_app({"view", f / "f-1.xyz", "--skip-nan", "-o", f / "p.html", "--json"});
  if (page.status == 5) return;  // built without three.js
  ASSERT_EQ(page.status, 0) << page.err;
  EXPECT_EQ(expect_document(page.out, "hull_report")["skipped"], 1);
}

TEST_F(CliSkipNan, NoOtherPoints) {
  write_file(f / "none.txt", "nan 0\nnan 1\n");
  for (const char* stream : {"off", "on"}) {
    const json found = document(
        {"hull", f / "none.txt", "--skip-nan", "--stream", stream, "--json"}, "hull_report");
    EXPECT_EQ(found["skipped"], 2) << stream;
    EXPECT_EQ(found["vertex_count"], 0) << stream;
  }
  for (const char* command : {"delaunay", "voronoi", "alpha", "cull", "info"})
    EXPECT_TRUE(has(run_well({command, f / "none.txt", "--skip-nan"}).out,
                    "skipped    2 points with a NaN coordinate"));
}

TEST_F(CliSkipNan, TheErrorNamesIt) {
  write_file(f / "p.txt", "0 0\n1 nan\n1 1\n");
  for (const char* command : {"hull", "cull", "delaunay", "voronoi", "alpha", "track"}) {
    const Ran ran = run_app({command, f / "p.txt"});
    EXPECT_EQ(ran.status, 1) << command;
    EXPECT_TRUE(has(ran.err, "p.txt:2: "));
    EXPECT_TRUE(has(ran.err, "point 1, coordinate 1 is NaN; --skip-nan leaves such points out"));
  }
  // An infinity is no mark; its point has the id of the file.
  write_file(f / "inf.txt", "nan 0\n0 0\ninf 0\n1 1\n");
  for (const char* stream : {"off", "on"})
    expect_error({"hull", f / "inf.txt", "--skip-nan", "--stream", stream}, 1,
                 "point 2, coordinate 0 is infinite");
}

TEST(SkipNan, FilesOfPointsNameTheirRows) {
  const Folder f;
  write_file(f / "p.txt", "nan 0\n0 0\n1 0\n2 nan\n0 1\n");
  ReadOptions options;
  options.skip_nan = true;
  std::vector<std::string> remarks;
  options.remark = [&](const std::string& line) { remarks.push_back(line); };
  const PointFile file = open_points(f / "p.txt", options);
  EXPECT_EQ(file.points().count, 3U);
  EXPECT_EQ(file.rows(), (std::vector<std::uint64_t>{1, 2, 4}));
  EXPECT_EQ(file.skipped(), 2U);
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_TRUE(has(remarks[0], "2 of 5 points have a NaN coordinate and are skipped"));
  Hull hull = convex_hull(file.points());
  hull.rename([&](std::uint64_t i) { return file.rows()[i]; });
  EXPECT_EQ(hull.vertices, (std::vector<std::uint64_t>{1, 2, 4}));
  EXPECT_THROW(open_sequence({f / "p.txt"}, options), Error);
}

}  // namespace cullhull::cli_skip_nan_test
