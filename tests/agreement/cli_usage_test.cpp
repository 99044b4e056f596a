// What the program says: of words it does not know, of arguments it repeats, of what it is doing.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "agreement/run_app.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/version.hpp"

namespace cullhull::cli_usage_test {

using namespace testing;

TEST(CliUsage, DidYouMean) {
  const Folder f;
  write_points(f / "p.npy", "ball", 100, 3);
  const std::string p = f / "p.npy";
  expect_error({"hull", p, "--thread", "3"}, 2, "unknown option --thread; did you mean --threads?");
  expect_error({"hull", p, "--treads=3"}, 2, "unknown option --treads; did you mean --threads?");
  expect_error({"hull", p, "--certfy"}, 2, "did you mean --certify? (see cullhull hull --help)");
  expect_error({"cull", p, "--quite"}, 2, "did you mean --quiet?");
  expect_error({"hul", p}, 2, "unknown command 'hul'; did you mean hull?");
  expect_error({"bench", "rivals"}, 2,
               "unknown command 'bench'; it is now the program cullhull-bench");
  expect_error({"infos"}, 2, "did you mean info?");
  expect_error({"hull", p, "--columns"}, 2, "--columns needs a value (see cullhull hull --help)");
  for (const std::vector<std::string>& far : command_lines(
           f, {"hull @p.npy --colour", "fly", "convert", "help convert", "hull @p.npy --resolution",
               "hull @p.npy --formats-all", "hull @p.npy --xyzzy", "hull @p.npy --area",
               "hull @p.npy --2d", "hull @p.npy -v"})) {
    const Ran ran = run_app(far);
    EXPECT_EQ(ran.status, 2);
    EXPECT_FALSE(has(ran.err, "did you mean"));
  }
  expect_error({"info", p, "--no-such"}, 2, "--no-such");
}

TEST(CliUsage, ASecondNameAfterAnOutput) {
  const Folder f;
  write_file(f / "p.txt", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
  write_file(f / "q.txt", "5 5 5\n");
  const std::string p = f / "p.txt", a = f / "a.ply", b = f / "b.ply";
  for (const char* command : {"hull", "delaunay", "voronoi", "alpha", "cull", "view"})
    expect_error({command, p, "-o", a, b}, 2, "each output needs an -o of its own");
  expect_error({"hull", p, "--output=" + a, b}, 2, "'" + b + "' after --output=" + a);
  expect_error({"hull", p, "-o" + a, b}, 2, "each output needs an -o of its own");
  expect_error({"hull", p, "-o", a, f / "q.txt"}, 2, "inputs stand together");
  write_file(b, "ply\nformat ascii 1.0\n");  // of a run before: no input either
  expect_error({"hull", p, "-q", "--output", a, b, "-o", b}, 2, "each output needs an -o");
  EXPECT_FALSE(std::filesystem::exists(a));
  // Inputs after the output, and several outputs.
  run_well({"hull", "-q", "-o", a, p, f / "q.txt"});
  run_well({"hull", p, "-q", "-o", a, "-o", b});
  run_well({"hull", p, "-o", a, "-q", "--threads", "1"});
}

/// Lines with more columns than that, and lines that begin with the second part of a word of the
/// text.
void expect_fits(const std::string& shown, const std::string& whole, std::size_t columns) {
  std::istringstream lines(shown);
  std::string joined;
  for (std::string line; std::getline(lines, line);) {
    if (line.ends_with('\r')) line.pop_back();
    std::size_t blanks = 0;
    while (blanks < line.size() && line[blanks] == ' ') ++blanks;
    if (line.find(' ', blanks) != std::string::npos) {
      EXPECT_LE(line.size(), columns) << line;
    }
    joined += line + ' ';
  }
  const auto words = [](const std::string& text) {
    std::istringstream in(text);
    std::vector<std::string> all;
    for (std::string word; in >> word;) all.push_back(word);
    return all;
  };
  EXPECT_EQ(words(joined), words(whole));
  const auto paragraphs = [](std::string text) {
    std::erase(text, '\r');
    std::size_t count = 0;
    for (std::size_t at = 0; (at = text.find("\n\n", at)) != std::string::npos; ++at) ++count;
    return count;
  };
  EXPECT_EQ(paragraphs(shown), paragraphs(whole)) << shown;
}

TEST(CliUsage, HelpFitsTheTerminal) {
  ::unsetenv("COLUMNS");
  std::vector<std::vector<std::string>> all{{"--help"}, {"help", "formats"}, {"help", "units"}};
  for (const char* command : {"hull", "cull", "track", "delaunay", "voronoi", "alpha", "certify",
                              "generate", "info", "view", "qconvex", "completion", "man"})
    all.push_back({command, "--help"});
  for (const auto& words : all) {
    const std::string whole = run_app(words).out;
    for (const int columns : {40, 60, 72, 80, 99, 100, 132}) {
      OnTerminal terminal(words, -1, static_cast<unsigned short>(columns));
      EXPECT_EQ(terminal.wait(), 0);
      expect_fits(terminal.shown(), whole, static_cast<std::size_t>(columns));
      if (columns < 100) continue;
      std::string plain = terminal.shown();
      std::erase(plain, '\r');
      EXPECT_EQ(plain, whole) << "wide enough";
    }
  }
  const auto shown = [](unsigned short columns) {
    OnTerminal terminal({"hull", "--help"}, -1, columns);
    terminal.wait();
    std::string text = terminal.shown();
    std::erase(text, '\r');
    return text;
  };
  // The text of an option stays in its column, and its lines are filled.
  const std::string narrow = shown(80);
  EXPECT_TRUE(has(narrow,
                  "\n  --format WORDS              Print the hull as qconvex does. Quote "
                  "several\n                              words: --format 'Fx n'\n"));
  ::setenv("COLUMNS", "50", 1);  // as exported, it is taken before the window's
  expect_fits(shown(80), run_app({"hull", "--help"}).out, 50);
  ::setenv("COLUMNS", "0", 1);
  EXPECT_EQ(shown(80), narrow);
  ::unsetenv("COLUMNS");
}

TEST(CliUsage, NamesOfOtherPrograms) {
  const Folder f;
  write_points(f / "p.npy", "ball", 100, 2);
  const std::string p = f / "p.npy";
  expect_error({"concave", p}, 2, "unknown command 'concave'; did you mean alpha?");
  expect_error({"triangulate", p}, 2, "did you mean delaunay?");
  expect_error({"hull", p, "--group-by", "c"}, 2, "did you mean --by?");
  expect_error({"hull", p, "--output-format", "wkt"}, 2, "did you mean --output?");
  expect_error({"voronoi", p, "--mask", "a.geojson"}, 2, "did you mean --clip?");
  expect_error({"hull", p, "--mask", "a.geojson"}, 2, "unknown option --mask (see");
  expect_error({"hull", p, "--json", f / "r.json"}, 1, "(--json=" + (f / "r.json") + " writes it)");
  write_file(f / "lon.csv", "lat,lon,n\n0,0,1\n1,0,1\n0,1,1\n");
  expect_error({"hull", f / "lon.csv", "--columns", "lat", "lon"}, 1,
               "(--columns lat,lon takes both columns)");
  expect_error({"hull", p, "--format", "wkt"}, 2, "; -o FILE.wkt writes a file");
  expect_error({"hull", p, "--by", "1"}, 2, "--by needs one -o FILE.geojson (2D)");
  expect_error({"qconvex", p}, 2, "TI " + p + " reads points from a file");
  write_file(f / "hull.ply", "ply\n");
  expect_error({"certify", p, f / "hull.ply"}, 2, "hull.ply: the hull to verify is the last word");
  write_file(f / "p.csv", "n;x;y\na;1,5;2\n");
  expect_error({"hull", f / "p.csv", "--columns", "x,y", "--decimal", "."}, 1,
               "p.csv:2: column 'x': '1,5' is not a number; --decimal , reads decimal commas");
}

TEST(CliUsage, HelpByCommand) {
  for (const char* command : {"hull", "generate", "qconvex"}) expect_same_help({}, command);
  EXPECT_EQ(run_app({"help"}).out, run_app({"--help"}).out);
  expect_error({"help", "hul"}, 2, "did you mean hull?");
}

TEST(CliUsage, TheProgramAloneShowsItsHelp) {
  expect_help_alone({});
  const Ran version = run_well({"--version"});
  EXPECT_EQ(run_app({"-V"}).out, version.out);
  EXPECT_EQ(version.out, CULLHULL_VERSION "\n");
}

TEST(CliUsage, HelpByTopic) {
  const Ran formats = run_app({"help", "formats"}), units = run_app({"help", "units"});
  EXPECT_EQ(formats.status, 0) << formats.err;
  EXPECT_TRUE(has(formats.out, ".pcd"));
  EXPECT_EQ(units.status, 0) << units.err;
  EXPECT_TRUE(has(units.out, "scale"));
  const std::string help = run_app({"--help"}).out;
  EXPECT_TRUE(has(help, "\nTopics:\n  formats "));
  EXPECT_TRUE(has(help, "\n  units "));
  expect_error({"help", "format"}, 2, "no command or topic 'format'; did you mean formats?");
  expect_error({"help", "formats", "units"}, 2, "");
}

TEST(CliUsage, OptionsStandInSectionsAndInputsAreDescribedOnce) {
  const std::string top = run_app({"--help"}).out;
  std::istringstream listed(top.substr(top.find("Subcommands:\n") + 13));
  std::vector<std::string> commands;
  for (std::string line; std::getline(listed, line) && line.starts_with("  ");)
    commands.push_back(line.substr(2, line.find(' ', 2) - 2));
  ASSERT_EQ(commands.size(), 13U);
  for (const std::string& command : commands) {
    const std::string help = run_app({command, "--help"}).out;
    EXPECT_FALSE(has(help, "\nOptions:\n"));
    EXPECT_TRUE(has(help, "\nOther:\n"));
    EXPECT_TRUE(has(help, "\nExamples:\n"));
    EXPECT_TRUE(has(help, "\nExit status: "));
    EXPECT_FALSE(has(help, "\n\n\n"));
    EXPECT_FALSE(has(help, ".pcd")) << "formats belong to help formats";
    const bool points = command != "generate" && command != "completion" && command != "man";
    EXPECT_EQ(help.find("help formats") != std::string::npos, points) << help;
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);)
      EXPECT_LE(line.size(), 100U) << command << ": " << line;
  }
  const std::string hull = run_app({"hull", "--help"}).out;
  std::size_t at = 0;
  for (const char* section : {"Input", "Output", "Filter", "Verification and timing",
                              "Streaming and partial results", "Limits", "Other"}) {
    const std::size_t found = hull.find("\n" + std::string(section) + ":\n  -");
    EXPECT_TRUE(found != std::string::npos && found > at) << section << "\n" << hull;
    at = found;
  }
  const auto section_of = [&](const char* option) {
    const std::size_t here = hull.find(option);
    const std::size_t end = hull.rfind(":\n  -", here);
    const std::size_t begin = hull.rfind('\n', end) + 1;
    return hull.substr(begin, end - begin);
  };
  EXPECT_EQ(section_of("  --columns"), "Input");
  EXPECT_EQ(section_of("  -o,--output"), "Output");
  EXPECT_EQ(section_of("  --cull"), "Filter");
  EXPECT_EQ(section_of("  --memory"), "Limits");
}

TEST(CliUsage, AFileAloneIsHulled) {
  const Folder f;
  write_points(f / "p.npy", "ball", 100, 3);
  const std::string want = run_app({"hull", f / "p.npy", "--format", "Fx"}).out;
  EXPECT_FALSE(want.empty());
  EXPECT_EQ(run_app({f / "p.npy", "--format", "Fx"}).out, want);
  EXPECT_EQ(run_app({"-", "--format", "Fx"}, f / "p.npy").out, want);
  expect_error({f / "absent.npy"}, 1, "absent.npy: cannot open");
}

TEST(CliUsage, RepeatedArgumentsAreCutAndEscaped) {
  const Folder f;
  const std::string p = f / "p.txt", monster(5000, 'x');
  write_file(p, "0 0\n1 0\n0 1\n");
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"hull", p, "--" + monster},
        {monster},
        {"hull", "./" + monster},
        {"hull", "--cull=" + monster, p},
        {"hull", "--memory", monster, p},
        {"generate", monster, "-n", "5", "-o", "x.npy"},
        {"hull", p, monster, monster + "y"},
        {"generate", "ball", "-n", "5", "-o", monster},
        {"hull", p, "--format", monster},
        {"hull", p, "--columns", monster},
        {"qconvex", "TI", monster},
        {"qconvex", "Q" + monster},
        {"view", p, "-o", monster}}) {
    const Ran ran = run_app(arguments);
    EXPECT_TRUE(ran.status == 1 || ran.status == 2) << arguments[0].substr(0, 20);
    EXPECT_TRUE(one_line(ran.err)) << ran.err.substr(0, 100);
    EXPECT_LT(ran.err.size(), 700U) << ran.err.substr(0, 100);
    EXPECT_TRUE(has(ran.err, "xxx")) << ran.err.substr(0, 300);
  }
  for (const std::string word : {"a\nb", "a\x1b[31mb", "a\rb",
                                 "a\x7f"
                                 "b",
                                 "a\xC2\x9B"
                                 "31mb"}) {
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{word},
                                                      {"hull", word},
                                                      {"hull", p, "--" + word},
                                                      {"hull", "./" + word, "-o", word}}) {
      const Ran ran = run_app(arguments);
      EXPECT_TRUE(one_line(ran.err)) << ran.err;
      for (const char c : ran.err.substr(0, ran.err.size() - 1))
        EXPECT_FALSE(static_cast<unsigned char>(c) < 32 || c == 127) << ran.err;
      EXPECT_FALSE(has(ran.err, "\xC2\x9B"));
    }
  }
}

TEST(CliUsage, SeedsAndBudgetsAreReadWhole) {
  const Folder f;
  write_points(f / "p.npy", "ball", 5000, 3);
  const std::string out = f / "g.npy";
  for (const std::string seed :
       {"18446744073709551616", "99999999999999999999999", "-1", "1.5", "0x10", "", "7 ", "+7"})
    expect_error({"generate", "ball", "-n", "5", "--seed", seed, "-o", out}, 2, "--seed");
  run_well({"generate", "ball", "-n", "5", "--seed", "18446744073709551615", "-o", out});
  for (const std::string memory : {"", "K", "-1", "lots"})
    expect_error({"hull", f / "p.npy", "--memory", memory}, 2, "--memory");
  expect_error({"hull", f / "p.npy", "--memory="}, 2, "--memory");
  expect_error({"hull", f / "p.npy", "--cull", "none", "--memory", "1K"}, 4,
               "1000 bytes (--memory 1K)");
  expect_error({"hull", f / "p.npy", "--cull", "none", "--memory=1K"}, 4, "(--memory=1K)");
}

TEST(CliUsage, NotFiniteNamesTheFile) {
  const Folder f;
  const std::string p = f / "p.txt", good = f / "a.txt";
  write_file(p, "0 0\n1 0\n0 nan\n1 1\n");
  write_file(good, "0 0\n1 0\n0 1\n1 1\n");
  const std::string want = p + ":3: point 2, coordinate 1 is NaN";
  expect_error({"hull", p}, 1, want);
  expect_error({"hull", p, "--only", "vertices"}, 1, want);
  expect_error({"cull", p}, 1, want);
  expect_error({"qconvex", "TI", p, "Fx"}, 1, want);
  if (run_app({"view", good, "-o", f / "v.html"}).status != 5)
    expect_error({"view", p, "-o", f / "w.html"}, 1, want);
  expect_error({"track", good, p}, 1, p + ":3: frame 1: point 2, coordinate 1 is NaN");
  const Ran stream = run_app({"hull", "-"}, p);
  EXPECT_TRUE(has(stream.err, "standard input:3: point 2"));
  const std::string csv = f / "p.csv";
  write_file(csv, "# words\nname,x,y\n\na,0,0\n# more\nb,1,0\n\nc,inf,1\n");
  expect_error({"hull", csv, "--columns", "x,y"}, 1,
               csv + ":8: point 2, coordinate 0 is infinite; remove or repair");
}

TEST(CliUsage, NotFiniteNamesTheLineWhereverTheTextComesFrom) {
  const Folder f;
  write_file(f / "a.txt", "0 0\n1 0\n0 1\n");
  write_file(f / "b.txt", "# words\n5 5\n\n0 nan\n1 1\n");
  write_file(f / "c.wkt", "POINT (0 0)\nLINESTRING (1 1,\n2 inf)\n");
  const std::string a = f / "a.txt", b = f / "b.txt";
  const std::string want = b + ":4: point 4, coordinate 1 is NaN";
  for (const char* stream : {"on", "off"}) {
    expect_error({"hull", a, b, "--stream", stream}, 1, want);
    expect_error({"cull", a, b, "--stream", stream}, 1, want);
    expect_error({"hull", "-", "--stream", stream}, 1,
                 "standard input:4: point 1, coordinate 1 is NaN", b);
    expect_error({"hull", f / "c.wkt"}, 1, "c.wkt:3: point 2, coordinate 1 is infinite");
  }
  expect_error({"hull", a, "-"}, 1, "standard input:4: point 4", b);
  write_file(f / "c.csv", "id,x,y,note\n0,1,2,nan\n1,inf,2,a\n");
  const Ran ran = run_app({"hull", f / "c.csv"});
  EXPECT_TRUE(has(ran.err, "c.csv:3: point 1, coordinate 0 is infinite"));
}

/// A bad row behind blank lines and comments, so that its line is not its point's number.
struct BadRow {
  const char* row;
  std::string message;
};
const BadRow bad_rows[] = {
    {"b,nan,1", ": point 2, coordinate 0 is NaN; --skip-nan leaves such points out"},
    {"b,1,-inf", ": point 2, coordinate 1 is infinite; remove or repair"},
    {"b,1e999,1", ": column 'x': '1e999' exceeds the range of doubles"},
    {"b,1,1,1", ": 4 columns where there are 3"},
    {"b,1", ": 2 columns where there are 3"},
    {"b,1,", ": column 'y' is empty"},
    {"b,1,one", ": column 'y': 'one' is not a number"}};

TEST(CliUsage, BadRowsAreNamedByTheirLineInEveryWayOfReading) {
  const Folder f;
  const std::string bad = f / "bad.csv", good = f / "good.csv";
  write_file(good, "key,x,y\na,0,0\na,4,0\nb,0,4\n");
  for (const BadRow& b : bad_rows) {
    write_file(bad,
               std::string("# words\nkey,x,y\n\na,0,0\na,1,0\n# more\n") + b.row + "\nb,1,1\n");
    const bool finite = b.message.find("point 2") == std::string::npos;
    const auto numbered = [&](const char* point) {  // ids that are not those of the file alone
      std::string message = b.message;
      return finite ? message : message.replace(8, 1, point);
    };
    const std::string line = bad + ":7", of_pipe = "standard input:7";
    for (const char* columns : {"x,y", "1,2"}) {
      const std::vector<std::string> more{"--columns", columns};
      const auto check = [&](std::vector<std::string> words, const std::string& want,
                             const std::string& input = "/dev/null") {
        words.insert(words.end(), more.begin(), more.end());
        expect_error(words, 1, want, input);
      };
      for (const char* stream : {"on", "off"}) {
        check({"hull", bad, "--stream", stream}, line + b.message);
        check({"hull", "-", "--stream", stream}, of_pipe + b.message, bad);
        check({"hull", good, bad, "--stream", stream}, line + numbered("5"));
        check({"hull", bad, "--only", "vertices", "--stream", stream}, line + b.message);
        check({"cull", bad, "--stream", stream}, line + b.message);
      }
      check({"hull", bad, "--first-id", "1000"}, line + numbered("1002"));
      check({"hull", good, "-", "--first-id", "1000"}, of_pipe + numbered("1005"), bad);
      check({"hull", bad, "--partial", f / "s.npz"}, line + b.message);
      check({"hull", bad, "--checkpoint", f / "c"}, line + b.message);
      check({"hull", bad, "--by", "key", "-o", f / "o.csv"}, line + b.message);
      check({"hull", good, "-", "--by", "0", "-o", f / "o.csv"}, of_pipe + numbered("5"), bad);
      check({"delaunay", bad}, line + b.message);
      check({"voronoi", good, bad}, line + numbered("5"));
      check({"alpha", bad}, line + b.message);
    }
  }
  EXPECT_FALSE(std::filesystem::exists(f / "o.csv"));
}

TEST(CliUsage, BadRowsFarIntoAFileAreNamedByTheirLine) {
  const Folder f;
  const std::string p = f / "p.csv";
  std::string rows;  // several blocks, and several chunks of a block
  while (rows.size() < 9000000) rows += "1,2,3\n\n";
  const auto lines = static_cast<std::uint64_t>(std::count(rows.begin(), rows.end(), '\n'));
  write_file(p, "x,y,z\n" + rows + "1,inf,3\n1,2\n" + rows);
  const std::string infinite = p + ":" + std::to_string(lines + 2) + ": point " +
                               std::to_string(lines / 2) + ", coordinate 1 is infinite";
  const std::string shorter = p + ":" + std::to_string(lines + 3) + ": ";
  for (const char* stream : {"on", "off"}) {
    expect_error({"hull", p, "--stream", stream}, 1, shorter);
    write_file(p + ".csv", "x,y,z\n" + rows + "1,inf,3\n" + rows + "nan,0,0\n");
    expect_error({"hull", p + ".csv", "--stream", stream}, 1, infinite.substr(p.size()));
  }
  expect_error({"hull", p + ".csv", "--by", "z", "-o", f / "o.csv"}, 1, infinite.substr(p.size()));
  expect_error({"hull", "-", "--by", "z", "-o", f / "o.csv"}, 1, infinite.substr(p.size()),
               p + ".csv");
}

TEST(CliUsage, NotFiniteVerticesOfTextsAreNamedByTheirLine) {
  const Folder f;
  const struct {
    const char *name, *text, *message;
  } texts[] = {
      {"a.obj", "# v\nv 0 0 0\nvn 0 0 1\nv 1 0 0\nf 1 2 3\nv nan 1 0\n",
       ":6: point 2, coordinate 0"},
      {"a.off", "OFF\n3 1 0\n\n0 0 0\n1 0 0\n0 inf 0\n3 0 1 2\n", ":6: point 2, coordinate 1"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement edge 1\nproperty int a\nelement vertex 3\n"
       "property float x\nproperty float y\nend_header\n7\n0 0\n1 0\nnan 1\n",
       ":12: point 2, coordinate 0"},
      {"a.stl",
       "solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 nan 0\n"
       "endloop\nendfacet\nendsolid\n",
       ":6: point 2, coordinate 1"},
      {"a.pcd",
       "VERSION 0.7\nFIELDS x y\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\nWIDTH 3\nHEIGHT 1\n"
       "POINTS 3\nDATA ascii\n0 0\n1 0\n0 inf\n",
       ":12: point 2, coordinate 1"},
      {"q.txt", "2 words\n4\n0 0\n1 0\nnan 1\n1 inf\n", ":5: point 2, coordinate 0"},
  };
  for (const auto& t : texts) {
    const std::string p = f / t.name;
    write_file(p, t.text);
    for (const char* stream : {"on", "off"})
      expect_error({"hull", p, "--stream", stream}, 1, p + t.message);
    const std::string message = t.message;
    const std::size_t behind = message.find(' ') + 1;
    expect_error({"track", p, p}, 1,
                 p + message.substr(0, behind) + "frame 0: " + message.substr(behind));
  }
  // Of the columns that are asked for.
  for (const char* stream : {"on", "off"})
    expect_error({"hull", f / "q.txt", "--columns", "1", "--stream", stream}, 1,
                 "q.txt:6: point 3, coordinate 0 is infinite");
}

TEST(CliUsage, AFolderReadsWhatItKnows) {
  const Folder f;
  const std::string folder = f / "tiles";
  std::filesystem::create_directory(folder);
  write_file(folder + "/b.csv", "x,y\n0,0\n1,0\n");
  write_file(folder + "/a.wkt", "POINT (0 1)\n");
  write_file(f / "all.txt", "0 1\n0 0\n1 0\n");
  const std::string want = run_app({"hull", f / "all.txt", "--format", "i"}).out;
  const Ran alone = run_app({"hull", folder, "--format", "i"});
  EXPECT_EQ(alone.out, want) << alone.err;
  EXPECT_EQ(alone.err, "");
  write_file(folder + "/README.md", "about\n");
  write_file(folder + "/meta.json", "{}\n");
  const Ran among = run_app({"hull", folder, "--format", "i"});
  EXPECT_EQ(among.out, want);
  EXPECT_EQ(among.err, "cullhull: " + folder +
                           ": 2 files of unknown formats skipped: 'README.md', 'meta.json'\n");
  // Without a known name all files are read, and a format that is given is that of all.
  const std::string plain = f / "plain";
  std::filesystem::create_directory(plain);
  write_file(plain + "/one", "0 1\n");
  write_file(plain + "/two", "0 0\n1 0\n");
  EXPECT_EQ(run_app({"hull", plain, "--format", "i"}).out, want);
  write_file(plain + "/zero.csv", "9 9\n");
  EXPECT_NE(run_app({"hull", plain, "--input-format", "xyz", "--format", "i"}).out, want);
  EXPECT_EQ(run_app({"hull", plain, "--input-format", "xyz"}).err, "");
  expect_error({"hull", folder + "/README.md"}, 1, "README.md:1: 'about' is not a number");
  for (const char* name : {"a.gpkg", "a.shp", "a.parquet", "a.kml"}) {
    write_file(f / name, "bytes");
    expect_error({"hull", f / name}, 1,
                 "is read by the program of the Python package: python3 -m cullhull");
  }
}

TEST(CliUsage, GenerateWritesWhatIsRead) {
  const Folder f;
  const auto ids = [&](const std::string& file) {
    std::vector<std::string> words{"hull", file, "--format", "p"};
    if (file.ends_with(".raw")) words.insert(words.end(), {"--dim", "3", "--type", "f64"});
    const Ran ran = run_well(words);
    EXPECT_EQ(ran.err, "") << file;
    return ran.out;
  };
  const std::vector<std::string> made{"generate", "ball", "-n", "5000", "--seed", "4", "-q", "-o"};
  const auto generate = [&](const std::string& name, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = made;
    words.push_back(f / name);
    words.insert(words.end(), more.begin(), more.end());
    return run_app(words);
  };
  ASSERT_EQ(generate("a.npy").status, 0);
  ASSERT_EQ(generate("single.npy", {"--type", "f32"}).status, 0);
  const std::string want = ids(f / "a.npy"), single = ids(f / "single.npy");
  for (const std::string ending :
       {"ply", "obj", "off", "raw", "xyz", "txt", "csv", "geojson", "wkt"}) {
    const Ran ran = generate("a." + ending);
    ASSERT_EQ(ran.status, 0) << ending << ran.err;
    EXPECT_EQ(ids(f / ("a." + ending)), want) << ending;
    if (ending == "raw") continue;
    ASSERT_EQ(generate("b." + ending, {"--type", "f32"}).status, 0);
    EXPECT_EQ(ids(f / ("b." + ending)), single) << ending;
  }
  EXPECT_TRUE(read_file(f / "a.csv").starts_with("x,y,z\n"));
  EXPECT_EQ(std::filesystem::file_size(f / "a.raw"), 5000U * 3 * 8);
  for (const char* name : {"c.off", "c.txt", "c.csv"})
    EXPECT_EQ(generate(name, {"-d", "5"}).status, 0) << name;
  EXPECT_EQ(ids(f / "c.off"), ids(f / "c.txt"));
  for (const char* name : {"d.ply", "d.geojson", "d.wkt"})
    expect_error({"generate", "ball", "-n", "5", "-d", "4", "-o", f / name}, 2,
                 "holds points of dimension 2 or 3, not 4");
  expect_error({"generate", "disk", "-n", "5", "-o", f / "d.obj"}, 2, "of dimension 3, not 2");
  expect_error({"generate", "ball", "-n", "5", "-o", f / "d.stl"}, 2, "must end in .npy, .ply");
  expect_error(
      {"generate", "ball", "-n", "5", "--frames", "2", "--motion", "spin", "-o", f / "d.csv"}, 2,
      "must end in .npy");
  EXPECT_FALSE(std::filesystem::exists(f / "d.ply")) << "nothing is left of what was refused";
  for (const char* name : {"e.geojson", "e.wkt", "e.ply", "e.off"}) {
    run_well({"generate", "ball", "-n", "0", "-o", f / name});
    run_well({"info", f / name});
  }
}

TEST(CliUsage, FoldersInThePlaceOfFilesAreCalledSo) {
  const Folder f;
  const std::string p = f / "p.txt", folder = f / "folder";
  write_file(p, "0 0\n1 0\n0 1\n");
  std::filesystem::create_directory(folder);
  expect_error({"hull", p, "--checkpoint", folder}, 1, folder + ": a folder, where a checkpoint");
  expect_error({"hull", "@" + folder}, 1, folder + ": a folder, where a list of files is wanted");
  expect_error({"delaunay", p, "--weights", folder}, 1, folder + ": cannot read: Is a directory");
}

TEST(CliUsage, RangesAreShort) {
  const Folder f;
  const std::string p = f / "p.txt";
  write_file(p, "0 0\n1 0\n0 1\n");
  expect_error({"alpha", p, "--edge-length", "-1"}, 2,
               "--edge-length: Value -1 is not a finite number from 0 on");
  expect_error({"alpha", p, "--edge-length", "inf"}, 2, "Value inf is not a finite number");
  expect_error({"alpha", p, "--edge-length", "nan"}, 2, "nan is not a number");
  expect_error({"alpha", p, "--ratio", "1.5"}, 2, "--ratio: Value 1.5 not in range 0 to 1");
}

TEST(CliUsage, MeasuresHaveTheNamesOfTheirDimension) {
  const Folder f;
  const auto said = [&](const char* text) {
    write_file(f / "p.txt", text);
    return run_app({"hull", f / "p.txt"}).out;
  };
  const std::string plane = said("0 0\n2 0\n0 3\n2 3\n");
  EXPECT_TRUE(has(plane, "\nperimeter  10\n") && has(plane, "\narea       6\n")) << plane;
  EXPECT_FALSE(has(plane, "volume")) << plane;
  const std::string flat = said("0 0 1\n2 0 1\n0 3 1\n2 3 1\n");
  EXPECT_TRUE(has(flat, "\nperimeter  10\n") && has(flat, "\narea       6\n")) << flat;
  const std::string line = said("0 0 0\n3 4 0\n");
  EXPECT_TRUE(has(line, "\nlength     5\n")) << line;
  EXPECT_FALSE(has(line, "area") || has(line, "volume")) << line;
  const std::string point = said("0 0 0\n0 0 0\n");
  EXPECT_FALSE(has(point, "area") || has(point, "volume") || has(point, "length")) << point;
  const std::string solid = said("0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
  EXPECT_TRUE(has(solid, "\narea ") && has(solid, "\nvolume ")) << solid;
}

TEST(CliUsage, ProgressHasABarARateAndTheTimeLeft) {
  const Folder f;
  OnTerminal frames(
      {"generate", "ball", "-n", "300k", "--frames", "40", "--motion", "spin", "-o", f / "s.npy"});
  EXPECT_EQ(frames.wait(), 0) << frames.shown();
  EXPECT_TRUE(has(frames.shown(), "frames     [####"));
  EXPECT_TRUE(has(frames.shown(), " of 40 frames"));
  EXPECT_TRUE(has(frames.shown(), " frames/s  "));
  EXPECT_TRUE(has(frames.shown(), " s left"));
  EXPECT_TRUE(frames.shown().ends_with("\r\x1b[K")) << "the line is wiped";
  write_points(f / "p.npy", "sphere", 4000, 6);
  OnTerminal hull({"hull", f / "p.npy", "--memory", "64G"});
  EXPECT_EQ(hull.wait(), 0) << hull.shown();
  EXPECT_TRUE(has(hull.shown(), "hull       ["));
  EXPECT_TRUE(has(hull.shown(), " s left"));
  EXPECT_FALSE(has(hull.shown(), "/s")) << "a rate of what?\n" << hull.shown();
  OnTerminal quiet({"hull", f / "p.npy", "-q", "--cull", "none", "--threads", "1"});
  EXPECT_EQ(quiet.wait(), 0);
  EXPECT_EQ(quiet.shown(), "");
}

/// Feeds a pipe until a line of progress about it holds `part`; returns all that was shown.
std::string shown_of_a_pipe(const std::vector<std::string>& arguments, const std::string& row,
                            const std::string& part) {
  int ends[2];
  EXPECT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  OnTerminal program(arguments, ends[0]);
  std::string rows;
  while (rows.size() < 1 << 16) rows += row;
  const auto seen = [&] { return program.shown().find(part) != std::string::npos; };
  bool fed = true;
  // The bound ends a program that shows nothing.
  for (std::uint64_t bytes = 0; fed && !seen() && bytes < std::uint64_t{4} << 30;) {
    std::size_t at = 0;
    while (fed && at < rows.size()) {
      const ssize_t n = ::write(ends[1], rows.data() + at, rows.size() - at);
      fed = n > 0;
      at += fed ? static_cast<std::size_t>(n) : 0;
    }
    bytes += at;
    program.look();
  }
  ::close(ends[1]);
  EXPECT_EQ(program.wait(), 0) << program.shown();
  EXPECT_TRUE(fed && seen()) << program.shown();
  EXPECT_TRUE(program.shown().ends_with("\r\x1b[K")) << "the line is wiped";
  return program.shown();
}

TEST(CliUsage, ProgressOfAPipeCountsBytes) {
  const auto before = ::signal(SIGPIPE, SIG_IGN);  // should the program end early
  const Folder f;
  for (const std::vector<std::string>& arguments : command_lines(
           f, {"hull - --stream on", "info - --stream on", "hull - --by 2 -o @groups.json"})) {
    const std::string shown = shown_of_a_pipe(arguments, "0 0 1\n1 0 1\n0 1 1\n", "B/s");
    EXPECT_TRUE(has(shown, "\r\x1b[Kread       "));
    std::istringstream lines(shown);
    for (std::string line; std::getline(lines, line, '\r');) {
      if (line.find("read") == std::string::npos) continue;
      EXPECT_FALSE(has(line, "%")) << "a share of what?\n" << line;
      EXPECT_FALSE(has(line, "left"));
    }
  }
  ::signal(SIGPIPE, before);
}

TEST(CliUsage, ProgressOfFilesThatAreReadInBlocks) {
  const Folder f;
  std::string rows;
  while (rows.size() < 4000000) rows += "0 0 1\n1 0 1\n0 1 1\n";
  write_file(f / "p.txt", rows);
  // More and more inputs, until they take long enough to be shown.
  for (std::size_t inputs = 4;; inputs *= 2) {
    std::vector<std::string> arguments{"hull", "--stream", "on", "--threads", "1"};
    arguments.insert(arguments.end(), inputs, f / "p.txt");
    OnTerminal hull(arguments);
    ASSERT_EQ(hull.wait(), 0) << hull.shown();
    const std::string& shown = hull.shown();
    if (shown.find("B/s  ") == std::string::npos && inputs < 4096) continue;
    EXPECT_TRUE(has(shown, "\r\x1b[Kread       [####"));
    EXPECT_TRUE(has(shown, " of "));
    EXPECT_TRUE(has(shown, " MB/s  "));
    EXPECT_TRUE(has(shown, " s left"));
    EXPECT_TRUE(shown.ends_with("\r\x1b[K")) << "the line is wiped";
    break;
  }
}

TEST(CliUsage, NoTimesOfADeviceThatIsNotThere) {
  if (cuda_status().available) GTEST_SKIP() << "there is a CUDA device";
  const Folder f;
  write_points(f / "p.npy", "ball", 300000, 3);
  const auto json = nlohmann::json::parse(run_app({"cull", f / "p.npy", "--json"}).out);
  const std::string why = json["cull"]["reason"];
  EXPECT_TRUE(has(why, "on the CPU"));
  EXPECT_FALSE(has(why, "on a CUDA device"));
}

}  // namespace cullhull::cli_usage_test
