// hull --by: the hull of each group is that of its points alone, whatever the order, the blocks and
// the threads.
#include <algorithm>
#include <map>
#include <random>

#include "agreement/expect_json.hpp"
#include "cullhull/cullhull.hpp"
#include "cullhull/group_hulls.hpp"

namespace cullhull::cli_groups_test {

using namespace testing;
using Groups = std::map<std::string, std::vector<double>>;

struct Table {
  std::string text;
  Groups groups;
};

/// Groups of 1 to 40 points on a lattice (flat ones and duplicates among them), in any order.
Table table(std::uint32_t d, const std::vector<std::string>& words, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::pair<std::string, std::vector<double>>> rows;
  for (const std::string& word : words)
    for (std::uint64_t n = 1 + random() % 40; n > 0; --n) {
      std::vector<double> row;
      for (std::uint32_t j = 0; j < d; ++j)
        row.push_back(static_cast<double>(random() % 5) / (word.size() % 2 == 0 ? 1 : 8));
      rows.emplace_back(word, row);
    }
  std::shuffle(rows.begin(), rows.end(), random);
  Table t;
  t.text = "note,key";
  for (std::uint32_t j = 0; j < d; ++j) t.text.append(",c").append(std::to_string(j));
  for (const auto& [word, row] : rows) {
    t.text += "\nw,\"" + word + "\"";
    for (const double v : row) t.text.append(",").append(std::to_string(v));
    t.groups[word].insert(t.groups[word].end(), row.begin(), row.end());
  }
  t.text += "\n";
  return t;
}

std::vector<std::string> words(int n, const char* before) {
  std::vector<std::string> list;
  for (int i = 0; i < n; ++i) list.push_back(before + std::to_string(i * 37 % 1009));
  return list;
}

void expect_same(const nlohmann::json& found, const std::string& key,
                 const std::vector<double>& rows, std::uint32_t d) {
  const PointView points = PointView::row_major(rows.data(), rows.size() / d, d);
  const Hull hull = convex_hull(points);
  EXPECT_EQ(found["points"], points.count) << key;
  EXPECT_EQ(found["affine_dimension"], hull.affine_dimension) << key;
  const int k = hull.affine_dimension;
  if (k >= 1) {
    const char* const name = k == 1 ? "length" : k == 2 ? "area" : "volume";
    EXPECT_EQ(found[name].get<double>(), hull.volume) << key;
  }
  if (k >= 2) {
    EXPECT_EQ(found[k == 2 ? "perimeter" : "area"].get<double>(), hull.area) << key;
  }
  ASSERT_EQ(found["vertex_coordinates"].size(), hull.vertices.size()) << key;
  for (std::size_t i = 0; i < hull.vertices.size(); ++i)
    for (std::uint32_t j = 0; j < d; ++j)
      EXPECT_EQ(found["vertex_coordinates"][i][j].get<double>(), points.at(hull.vertices[i], j));
  ASSERT_EQ(found["facets"].size(), hull.facets.size()) << key;
  for (std::size_t f = 0; f < hull.facets.size(); ++f)
    for (std::size_t i = 0; i < hull.facets[f].size(); ++i)
      EXPECT_EQ(hull.vertices[found["facets"][f][i].get<std::size_t>()], hull.facets[f][i]) << key;
}

TEST(CliGroups, EachGroupIsTheHullOfItsPoints) {
  for (const std::uint32_t d : {1U, 2U, 3U, 4U})
    for (const char* before : {"", "town "}) {
      const Folder f;
      const Table t = table(d, words(200, before), d);
      write_file(f / "p.csv", t.text);
      const std::string columns = "2:";
      const Ran ran =
          run_well({"hull", f / "p.csv", "--by", "key", "--columns", columns, "-o", f / "h.json"});
      EXPECT_TRUE(has(ran.out, "groups     200"));
      const auto json = json_in(f / "h.json");
      ASSERT_EQ(json["groups"].size(), t.groups.size());
      double last = -1;
      for (const auto& group : json["groups"]) {
        const bool numeric = *before == 0;
        const std::string key = numeric ? group["key"].dump() : group["key"].get<std::string>();
        ASSERT_EQ(t.groups.count(key), 1U) << key;
        expect_same(group, key, t.groups.at(key), d);
        if (numeric) {
          EXPECT_GT(group["key"].get<double>(), last);
          last = group["key"].get<double>();
        }
      }
    }
}

TEST(CliGroups, TheBytesDependOnPointsAndKeysAlone) {
  const Folder f;
  const Table t = table(2, words(500, "g"), 7);
  write_file(f / "p.csv", t.text);
  const std::size_t half = t.text.find('\n', t.text.size() / 2) + 1;
  write_file(f / "a.csv", t.text.substr(0, half));
  write_file(f / "b.csv", t.text.substr(0, t.text.find('\n') + 1) + t.text.substr(half));
  for (const char* ending : {"geojson", "csv", "json"}) {
    const auto run = [&](std::vector<std::string> arguments) {
      arguments.insert(arguments.begin(), "hull");
      arguments.insert(arguments.end(), {"--by", "key", "--columns", "c0,c1", "-q", "-o",
                                         f / (std::string("out.") + ending)});
      const Ran ran = run_well(arguments);
      EXPECT_EQ(ran.out, "");
      return read_file(f / (std::string("out.") + ending));
    };
    const std::string expected = run({f / "p.csv"});
    EXPECT_EQ(run({f / "p.csv", "--threads", "1"}), expected);
    EXPECT_EQ(run({f / "a.csv", f / "b.csv"}), expected);
    // The library, in blocks of a few rows.
    BlockOptions blocks;
    blocks.read.key = "key";
    blocks.read.columns = "c0,c1";
    blocks.block_bytes = 300;
    blocks.readers = 4;
    const GroupReport report =
        write_group_hulls({f / "p.csv"}, f / (std::string("lib.") + ending), blocks);
    EXPECT_EQ(report.groups, 500U);
    EXPECT_EQ(read_file(f / (std::string("lib.") + ending)), expected);
  }
}

TEST(CliGroups, ABatchIsWrittenAsItsFileWouldBe) {
  for (const std::uint32_t d : {1U, 2U, 3U}) {
    const Folder f;
    const Table t = table(d, words(100, d == 2 ? "town " : ""), d + 30);
    write_file(f / "p.csv", t.text);
    std::vector<double> rows;
    std::vector<std::uint64_t> offsets{0};
    PointKeys keys;
    for (const auto& [key, points] : t.groups) {
      rows.insert(rows.end(), points.begin(), points.end());
      offsets.push_back(rows.size() / d);
      keys.add(key);
    }
    const PointView view = PointView::row_major(rows.data(), rows.size() / d, d);
    const HullBatch batch = convex_hulls(view, offsets);
    std::vector<double> corners;
    for (std::size_t set = 0; set < batch.size(); ++set)
      for (const std::uint64_t v : batch.vertices[set])
        for (std::uint32_t j = 0; j < d; ++j) corners.push_back(view.at(offsets[set] + v, j));
    for (const std::string format : {"csv", "json"}) {
      run_well(
          {"hull", f / "p.csv", "--by", "key", "--columns", "2:", "-o", f / ("theirs." + format)});
      write_group_hulls(f / "ours", batch, corners, keys, "key", format);
      EXPECT_EQ(read_file(f / "ours"), read_file(f / ("theirs." + format)));
    }
    EXPECT_THROW(write_group_hulls(f / "x.ply", batch, corners, keys), Error);
    keys.add("more");
    EXPECT_THROW(write_group_hulls(f / "x.csv", batch, corners, keys), Error);
    corners.pop_back();
    EXPECT_THROW(write_group_hulls(f / "x.csv", batch, corners, {}), Error);
    EXPECT_EQ(f.entries(), 4U);  // no half file
  }
}

TEST(CliGroups, KeysThatAreNumbersAndThoseThatAreNot) {
  const auto keys = [](const std::string& rows) {
    const Folder f;
    write_file(f / "p.csv", "k,x,y\n" + rows);
    run_well({"hull", f / "p.csv", "--by", "k", "-o", f / "h.geojson"});
    std::string list;
    const auto written = json_in(f / "h.geojson");
    for (const auto& feature : written["features"]) list += feature["properties"]["k"].dump() + " ";
    return list;
  };
  EXPECT_EQ(keys("10,0,0\n9,0,0\n-1,0,0\n2.5,1,1\n"), "-1 2.5 9 10 ");
  EXPECT_EQ(keys("10,0,0\n9,0,0\n007,0,0\n"), "\"007\" \"10\" \"9\" ");
  EXPECT_EQ(keys("1,0,0\nnan,0,0\n"), "\"1\" \"nan\" ");
  EXPECT_EQ(keys("1.,0,0\n+2,0,0\n"), "\"+2\" \"1.\" ");
  EXPECT_EQ(keys("a,0,0\n,0,0\n\"say \"\"a\"\"\",0,0\n"), "\"\" \"a\" \"say \\\"a\\\"\" ");
}

TEST(CliGroups, NumbersOfAnArrayAreKeys) {
  const Folder f;
  const std::vector<double> rows{1, 0, 0, 2, 5, 5, 1, 2, 0, 1, 0, 2, 2, 6, 6};
  write_npy_points(f / "p.npy", rows.data(), 5, 3, ScalarType::f32);
  const Ran ran = run_well({"hull", f / "p.npy", "--by", "0", "-o", f / "h.csv"});
  EXPECT_EQ(read_file(f / "h.csv"),
            "\"column 0\",points,vertices,perimeter,area,wkt\n"
            "1,3,3,6.82842712474619,2,\"POLYGON ((0 0, 2 0, 0 2, 0 0))\"\n"
            "2,2,2,2.8284271247461903,0,\"LINESTRING (5 5, 6 6)\"\n");
}

TEST(CliGroups, WhatIsRefused) {
  const Folder f;
  write_file(f / "p.csv", "k,x,y\na,0,0\nb,1,nan\n");
  write_file(f / "flat.csv", "k,x,y\na,0,0\nb,1,1\n");
  const std::string p = f / "p.csv", flat = f / "flat.csv";
  expect_error({"hull", p, "--by", "k", "-o", f / "h.csv"}, 1,
               "p.csv:3: point 1, coordinate 1 is NaN");
  EXPECT_EQ(f.entries(), 2U);  // no half file
  expect_error({"hull", flat, "--by", "q", "-o", f / "h.csv"}, 2, "no column 'q'");
  expect_error({"hull", flat, "--by", "k,x", "-o", f / "h.csv"}, 2, "a key is one column");
  expect_error({"hull", flat, "--by", "k", "-o", f / "h.ply"}, 2,
               "must end in .geojson, .csv or .json");
  expect_error({"hull", flat, "--by", "k"}, 2, "one -o");
  expect_error({"hull", flat, "--by", "k", "-o", f / "h.csv", "--certify"}, 2, "one -o");
  expect_error({"hull", flat, "--by", "k", "--stream", "on", "-o", f / "h.csv"}, 2, "one -o");
  expect_error({"hull", flat, "--by", "k", "--columns", "x", "-o", f / "h.geojson"}, 2, "not 1D");
  std::string long_table = "k,x,y\n";
  for (int i = 0; i < 100000; ++i) long_table += std::to_string(i) + ",1,2\n";
  write_file(f / "long.csv", long_table);
  expect_error({"hull", f / "long.csv", "--by", "k", "--memory", "1M", "-o", f / "h.csv"}, 4,
               "the points that are sorted by group need");
}

}  // namespace cullhull::cli_groups_test
