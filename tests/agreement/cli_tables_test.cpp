// The program over tables: what it says of the columns it uses, --decimal, and files that lie on
// their side. tests/reference/io_tables_test.cpp has the layouts themselves.

#include "agreement/expect_json.hpp"
#include "cullhull/io.hpp"

namespace cullhull::cli_tables_test {

using namespace testing;

/// A triangle in some layout.
struct Sample {
  std::string file, text;
  std::vector<std::string> options;
  nlohmann::json columns;
};

std::vector<Sample> samples() {
  return {{"gbif.csv",
           "decimalLatitude,decimalLongitude\n0,0\n0,1\n1,0\n",
           {},
           {"decimalLongitude", "decimalLatitude"}},
          {"plain.txt", "0 0\n1 0\n0 1\n", {}, {"0", "1"}},
          {"scan.pts", "3\n0 0 0 9\n1 0 0 9\n0 1 0 9\n", {}, {"0", "1", "2"}},
          {"tri.node", "3 2 0 0\n1 0 0\n2 1 0\n3 0 1\n", {}, {"x", "y"}},
          {"z.txt", "x\ty\n0,5\t0\n1,5\t0\n0\t1,5\n", {}, {"x", "y"}},
          {"d.txt", "0,5 0\n1,5 0\n0 1,5\n", {"--decimal", ","}, {"0", "1"}},
          {"u.csv",
           "mass,price,name\n0,0,a\n1,0,b\n0,1,c\n",
           {"--columns", "price,mass"},
           {"price", "mass"}}};
}

std::string listed(const nlohmann::json& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + word.get<std::string>();
  return text;
}

TEST(CliTables, SummaryAndReportNameTheColumns) {
  const Folder f;
  for (const Sample& sample : samples()) {
    const std::string path = f / sample.file, line = "columns    " + listed(sample.columns) + "\n";
    write_file(path, sample.text);
    const auto run = [&](std::vector<std::string> words, const std::string& input = "/dev/null") {
      SCOPED_TRACE(sample.file + " " + words[0]);
      words.insert(words.end(), sample.options.begin(), sample.options.end());
      const std::vector<std::string> plain = words;
      words.push_back("--json=" + (f / "report.json"));
      const Ran ran = run_well(words, input);
      EXPECT_TRUE(has(ran.out, line));
      EXPECT_EQ(json_in(f / "report.json")["columns"], sample.columns);
    };
    for (const char* stream : {"on", "off"}) {
      run({"hull", path, "--stream", stream, "-o", f / "hull.json"});
      run({"info", path, "--stream", stream});
      run({"cull", path, "--stream", stream});
    }
    run({"hull", path, "--only", "vertices"});
    run({"hull", path, path});
    run({"delaunay", path});
    if (sample.columns.size() == 2) run({"alpha", path, "--alpha", "10"});
    if (sample.columns.size() == 2) run({"voronoi", path});
    const Ran checked = run_well([&] {
      return joined({"certify", path, f / "hull.json", "--json=" + (f / "c.json")}, sample.options);
    }());
    EXPECT_EQ(json_in(f / "c.json")["columns"], sample.columns);
  }
}

// A pipe has no name: its content says what it is.
TEST(CliTables, PipesAreReadAsFilesAre) {
  const Folder f;
  for (const Sample& sample : samples()) {
    if (sample.file.ends_with(".node") || sample.file.ends_with(".pts")) continue;
    write_file(f / sample.file, sample.text);
    for (const char* stream : {"on", "off"}) {
      std::vector<std::string> words =
          joined({"hull", f / sample.file, "-o", f / "a.json", "--stream", stream}, sample.options);
      const Ran file = run_app(words);
      words[1] = "-";
      words[3] = f / "b.json";
      const Ran pipe = run_well(words, f / sample.file);
      EXPECT_EQ(read_file(f / "a.json"), read_file(f / "b.json")) << sample.file;
    }
  }
}

TEST(CliTables, OtherFormatsReportTheirColumnsToo) {
  const Folder f;
  write_file(f / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n");
  for (const char* stream : {"on", "off"}) {
    const Ran all = run_app({"hull", f / "a.obj", "--stream", stream, "--json=" + (f / "r.json")});
    EXPECT_FALSE(has(all.out, "columns"));
    EXPECT_EQ(json_in(f / "r.json")["columns"], (nlohmann::json{"x", "y", "z"}));
    const Ran two = run_app(
        {"hull", f / "a.obj", "--columns", "z,0", "--stream", stream, "--json=" + (f / "r.json")});
    EXPECT_TRUE(has(two.out, "columns    z, x\n"));
    EXPECT_EQ(json_in(f / "r.json")["columns"], (nlohmann::json{"z", "x"}));
  }
}

TEST(CliTables, NamesThatSayNothingAreRefused) {
  const Folder f;
  write_file(f / "a.csv", "mass,L\xC3\xA4nge\n1,2\n3,4\n5,1\n");
  for (const char* stream : {"on", "off"}) {
    expect_error({"hull", f / "a.csv", "--stream", stream}, 1,
                 "a.csv:1: the names of the columns are not known as coordinates: 'mass', "
                 "'L\xC3\xA4nge'; --columns takes some by name or by number from 0, as "
                 "--columns mass,L\xC3\xA4nge or --columns 0,1");
    for (const char* columns : {"mass,L\xC3\xA4nge", "0,1", "0:2"})
      run_well({"hull", f / "a.csv", "--stream", stream, "--columns", columns});
  }
}

TEST(CliTables, DecimalCommasAreOneRemark) {
  const Folder f;
  write_file(f / "z.txt", "x\ty\n1,5\t2,5\n3,5\t4,5\n5,5\t1,5\n");
  for (const char* stream : {"on", "off"}) {
    const Ran ran = run_app({"hull", f / "z.txt", "--stream", stream, "--json=" + (f / "r.json")});
    EXPECT_EQ(ran.err, "cullhull: " + (f / "z.txt") +
                           ": commas are read as decimal marks; --decimal . refuses them\n");
    EXPECT_EQ(json_in(f / "r.json")["points"]["dimension"], 2);
    EXPECT_DOUBLE_EQ(json_in(f / "r.json")["area"].get<double>(), 5);
  }
  EXPECT_EQ(run_app({"hull", f / "z.txt", "--decimal", ","}).err, "");
  expect_error({"hull", f / "z.txt", "--decimal", "."}, 1, "--decimal , reads decimal commas");
  expect_error({"hull", f / "z.txt", "--decimal", ";"}, 2, "--decimal");
  write_file(f / "a.obj", "v 1 2 3\n");
  expect_error({"hull", f / "a.obj", "--decimal", ","}, 2,
               "only texts of rows have decimal commas");
}

// Python's condition: at most a simplex, in more dimensions than anybody asks one for.
TEST(CliTables, AFileOnItsSideIsRemarkedOn) {
  const Folder f;
  const std::vector<double> few = generate("ball", 3, 50, 1);
  write_npy_points(f / "a.npy", few.data(), 3, 50, ScalarType::f64);
  std::string rows;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 50; ++j)
      rows += std::to_string(few[static_cast<std::size_t>(50 * i + j)]) + " ";
    rows += "\n";
  }
  write_file(f / "a.txt", rows);
  for (const char* name : {"a.npy", "a.txt"})
    for (const char* stream : {"on", "off"})
      for (const char* command : {"hull", "info"}) {
        const Ran ran = run_well({command, f / name, "--stream", stream});
        EXPECT_TRUE(has(ran.err, "3 points in 50 dimensions")) << command << name << stream;
      }
  write_npy_points(f / "b.npy", few.data(), 3, 8, ScalarType::f64);
  EXPECT_EQ(run_app({"hull", f / "b.npy"}).err, "");
}

}  // namespace cullhull::cli_tables_test
