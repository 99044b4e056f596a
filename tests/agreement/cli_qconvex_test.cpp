// `cullhull qconvex` and `--format` beside Qhull's own qconvex, on what its own rbox makes.
#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "agreement/run_app.hpp"

namespace cullhull::cli_qconvex_test {

using namespace testing;

#if defined(CULLHULL_RBOX) && defined(CULLHULL_QCONVEX)

using Rows = std::vector<std::vector<double>>;

/// What a program of the system prints; its status goes to `status`.
std::string shell(const std::string& command, int* status = nullptr) {
  const Folder f;
  const int code = std::system((command + " > " + (f / "out") + " 2> " + (f / "err")).c_str());
  if (status != nullptr) *status = code;
  return read_file(f / "out") + read_file(f / "err");
}

std::string rbox(const std::string& words) { return shell(CULLHULL_RBOX " " + words); }

/// Every number of each line.
Rows rows_of(const std::string& text) {
  Rows rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream in(line);
    std::vector<double> row;
    for (double x; in >> x;) row.push_back(x);
    rows.push_back(row);
  }
  return rows;
}

bool near(double a, double b) {
  return std::fabs(a - b) <= 1e-7 * std::max({1.0, std::fabs(a), std::fabs(b)});
}

/// The same rows up to their order.
void expect_same_rows(Rows a, Rows b, const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (const std::vector<double>& row : a) {
    const auto it = std::find_if(b.begin(), b.end(), [&](const std::vector<double>& other) {
      return row.size() == other.size() && std::equal(row.begin(), row.end(), other.begin(), near);
    });
    ASSERT_NE(it, b.end()) << what << ": a row of ours Qhull has not, beginning "
                           << (row.empty() ? 0 : row[0]);
    b.erase(it);
  }
}

/// Rows as sets of numbers, but for the `fixed` first.
Rows sorted_rows(Rows rows, std::size_t fixed = 0) {
  for (auto& row : rows)
    if (row.size() > fixed) std::sort(row.begin() + static_cast<long>(fixed), row.end());
  return rows;
}

Rows from(const Rows& rows, std::size_t first) {
  return {rows.begin() + static_cast<long>(std::min(first, rows.size())), rows.end()};
}

/// What Fs counts, but for the vertices that Qhull took up and gave up again.
std::vector<double> counts(const std::string& text) {
  std::vector<double> row = rows_of(text).at(0);
  row.at(9) = 0;
  return row;
}

/// A general set and what both programs print of it.
struct Pair {
  std::string name, points;
  std::string ours(const std::string& words) const {
    const Folder f;
    write_file(f / "in", points);
    std::vector<std::string> arguments{"qconvex"};
    std::istringstream in(words);
    for (std::string word; in >> word;) arguments.push_back(word);
    const Ran ran = run_well(arguments, f / "in");
    return ran.out + ran.err;
  }
  std::string theirs(const std::string& words) const {
    const Folder f;
    write_file(f / "in", points);
    return shell(CULLHULL_QCONVEX " " + words + " < " + (f / "in"));
  }
};

std::vector<Pair> general_sets() {
  std::vector<Pair> sets;
  for (const std::string words :
       {"20 D2 t1", "40 D2 s t2", "30 D3 t3", "60 D3 s t4", "200 D3 t5", "30 D4 t6", "20 D5 t7"})
    sets.push_back({words, rbox(words)});
  return sets;
}

/// Facet -> the sorted ids of its vertices, of both, and how ours are numbered by Qhull.
struct Facets {
  std::vector<std::vector<double>> ours, theirs;
  std::vector<double> their_number;  ///< of each of ours

  explicit Facets(const Pair& p) : ours(lists(p.ours("Fv"))), theirs(lists(p.theirs("Fv"))) {
    for (const auto& facet : ours)
      their_number.push_back(
          static_cast<double>(std::find(theirs.begin(), theirs.end(), facet) - theirs.begin()));
  }
  static std::vector<std::vector<double>> lists(const std::string& text) {
    Rows rows = from(rows_of(text), 1);
    for (auto& row : rows) row.erase(row.begin());
    return sorted_rows(rows);
  }
};

TEST(Qconvex, FacetsAreTheSame) {
  for (const Pair& p : general_sets()) {
    const Facets f(p);
    ASSERT_FALSE(f.ours.empty()) << p.name;
    for (const double number : f.their_number)
      EXPECT_LT(number, static_cast<double>(f.theirs.size())) << p.name;
    EXPECT_EQ(f.ours.size(), f.theirs.size()) << p.name;
  }
}

// Texts whose rows are those of facets, points or vertices, in whatever order.
TEST(Qconvex, RowsAreTheSame) {
  for (const Pair& p : general_sets()) {
    for (const std::string word : {"Fx", "n", "Fi", "Fo", "p", "FC", "Fa", "FV"})
      expect_same_rows(rows_of(p.ours(word)), rows_of(p.theirs(word)), p.name + " " + word);
    for (const std::string word : {"i", "Fv", "Ft", "o"})
      expect_same_rows(sorted_rows(rows_of(p.ours(word))), sorted_rows(rows_of(p.theirs(word))),
                       p.name + " " + word);
  }
}

TEST(Qconvex, TotalsAreTheSame) {
  for (const Pair& p : general_sets()) {
    const Rows ours = rows_of(p.ours("FS")), theirs = rows_of(p.theirs("FS"));
    ASSERT_EQ(ours.size(), 2U);
    for (std::size_t j = 0; j < 3; ++j) EXPECT_TRUE(near(ours[1][j], theirs[1][j])) << p.name;
    EXPECT_EQ(counts(p.ours("Fs")), counts(p.theirs("Fs"))) << p.name;
    const auto before = [](const std::string& text, const char* end) {
      return text.substr(0, text.find(end));
    };
    EXPECT_EQ(p.ours("s"), before(p.theirs("s"), "\nStatistics for") + "\n") << p.name;
    EXPECT_TRUE(has(p.ours("FA"), "Total volume: ")) << p.name;
  }
}

TEST(Qconvex, NeighboursAreTheSame) {
  for (const Pair& p : general_sets()) {
    const Facets f(p);
    const auto renumbered = [&](Rows rows) {
      for (auto& row : rows)
        for (std::size_t j = 1; j < row.size(); ++j)
          row[j] = f.their_number[static_cast<std::size_t>(row[j])];
      return sorted_rows(rows, 1);
    };
    const Rows ours = renumbered(from(rows_of(p.ours("Fn")), 1));
    const Rows theirs = sorted_rows(from(rows_of(p.theirs("Fn")), 1), 1);
    for (std::size_t i = 0; i < ours.size(); ++i)
      EXPECT_EQ(ours[i], theirs[static_cast<std::size_t>(f.their_number[i])]) << p.name;
    EXPECT_EQ(renumbered(from(rows_of(p.ours("FN")), 1)),
              sorted_rows(from(rows_of(p.theirs("FN")), 1), 1))
        << p.name;
  }
}

TEST(Qconvex, DumpHasEveryFacetOfQhulls) {
  for (const Pair& p : general_sets()) {
    const auto vertex_lists = [](const std::string& text) {  // "- vertices: p4(v4) p5(v3)"
      std::multiset<std::set<std::string>> lists;
      std::istringstream in(text);
      for (std::string line; std::getline(in, line);) {
        if (line.find("- vertices:") == std::string::npos) continue;
        std::set<std::string> ids;
        std::istringstream words(line.substr(line.find(':') + 1));
        for (std::string word; words >> word;) ids.insert(word.substr(0, word.find('(')));
        lists.insert(ids);
      }
      return lists;
    };
    EXPECT_EQ(vertex_lists(p.ours("f")), vertex_lists(p.theirs("f"))) << p.name;
    EXPECT_FALSE(vertex_lists(p.ours("FF")).empty());
  }
}

TEST(Qconvex, CddNormals) {
  for (const Pair& p : general_sets()) {
    const auto rows = [](const std::string& text) {
      return from(rows_of(text.substr(text.find("begin"))), 2);
    };
    expect_same_rows(rows(p.ours("FD")), rows(p.theirs("FD n")), p.name);
  }
}

// Sets with facets of many corners: what does not depend on how Qhull merges.
TEST(Qconvex, NonSimplicialFacets) {
  for (const std::string words : {"c D3", "d D3", "c D2", "c D4", "d D4"}) {
    const Pair p{words, rbox(words)};
    EXPECT_EQ(counts(p.ours("Fs")), counts(p.theirs("Fs"))) << words;
    expect_same_rows(sorted_rows(rows_of(p.ours("Fv"))), sorted_rows(rows_of(p.theirs("Fv"))),
                     words);
    expect_same_rows(rows_of(p.ours("FC")), rows_of(p.theirs("FC")), words + " FC");
    const Rows ours = rows_of(p.ours("Ft")), theirs = rows_of(p.theirs("Ft"));
    if (words != "c D4") {  // Qhull cuts the facets of a hypercube up in its own way
      EXPECT_EQ(ours[1], theirs[1]) << words;
      EXPECT_EQ(ours.size(), theirs.size()) << words;
    }
  }
}

TEST(Qconvex, SeveralAtOnceInTheirOrder) {
  const Pair p{"30 D3 t3", rbox("30 D3 t3")};
  EXPECT_EQ(p.ours("Fx n i"), p.ours("Fx") + p.ours("n") + p.ours("i"));
  const Folder f;
  write_file(f / "p.txt", p.points);
  const std::string want = p.ours("FS Fx");
  EXPECT_EQ(run_app({"hull", f / "p.txt", "--format", "FS Fx"}).out, want);
  EXPECT_EQ(run_app({"hull", f / "p.txt", "--format", "FS,Fx"}).out, want);
  EXPECT_EQ(run_app({"hull", f / "p.txt", "--format", "FS", "--format", "Fx"}).out, want);
}

TEST(Qconvex, FilesAndReports) {
  const Folder f;
  write_file(f / "p.txt", rbox("30 D3 t3"));
  const std::string want = run_app({"qconvex", "Fx"}, f / "p.txt").out;
  EXPECT_FALSE(want.empty());
  EXPECT_EQ(run_app({"qconvex", "TI", f / "p.txt", "Fx"}).out, want);
  const Ran to = run_well({"qconvex", "Fx", "TO", f / "hull", "TI", f / "p.txt", "Tv", "Pp", "Qs"});
  EXPECT_EQ(to.out, "");
  EXPECT_EQ(read_file(f / "hull"), want);
  EXPECT_EQ(run_app({"qconvex", "TI", f / "p.txt", "Fx", "TF100000"}).err, "");
  EXPECT_TRUE(has(run_app({"qconvex", "TI", f / "p.txt", "Fx", "TF10"}).err, "Number of facets"));
  const Ran summary = run_app({"qconvex", "TI", f / "p.txt"});
  EXPECT_EQ(summary.out, "");
  EXPECT_EQ(summary.err.find("\nConvex hull of 30 points in 3-d:\n"), 0U) << summary.err;
  EXPECT_EQ(run_app({"qconvex", "TI", f / "p.txt", "s", "Tz"}).out, summary.err);
  for (const std::string word : {"QJ", "Qt", "Qc", "Fc", "FP", "Fm", "m", "G", "FM", "FO", "FQ",
                                 "Fy", "TI", "TO", "TFx", "T4", "C0.1", "bogus", ""})
    expect_error({"qconvex", word}, 2, "", f / "p.txt");
  for (const std::string word : {"m", "G", "FM"})
    EXPECT_NE(run_app({"qconvex", word}, f / "p.txt").err.find("-o writes .obj"),
              std::string::npos);
}

// All that rbox can write is read, and as Qhull reads it: dimension, count and, but for sets that
// only rounding makes flat or not, the volume.
TEST(Qconvex, ReadsAllThatRboxWrites) {
  const std::vector<std::string> sets = {"10 D3",
                                         "20 D2",
                                         "12 D4 s",
                                         "c D3",
                                         "d D4",
                                         "l 30",
                                         "r 12 D2",
                                         "r 12 s Z1 G0.1",
                                         "s 30 D3",
                                         "x 20 D3",
                                         "x 20 D3 r",
                                         "x 15 W0.1 D3",
                                         "y 20 D3",
                                         "y 10 D2",
                                         "c G2.0 d G1",
                                         "20 C1,0.1,3 D3",
                                         "10 P0.5,0.5,0.5",
                                         "10 P0.5,0.5,0.5 P1,2 P-1",
                                         "20 L3 s",
                                         "20 L2 r G0.3",
                                         "20 L2 G0.3 W0.1",
                                         "27 M1,0,1",
                                         "27 M3,4 z",
                                         "30 W0.1 D3",
                                         "30 W1e-3 s",
                                         "30 Z0.5 s",
                                         "30 Z0.5 s G0.6",
                                         "20 D5",
                                         "20 D6 s",
                                         "10 O3",
                                         "10 O-1e5",
                                         "20 t5",
                                         "15 B2 D3",
                                         "15 B1e300",
                                         "15 B1e-300",
                                         "15 D8",
                                         "3 D2 c",
                                         "10 D3 P0.5,0.5,0.5"};
  for (const std::string& set : sets)
    for (const std::string form : {"", " n", " z", " h", " h z", " n z", " h n"}) {
      int made = 0;
      const std::string points = shell(CULLHULL_RBOX " " + set + form, &made);
      if (made != 0) continue;  // rbox refuses the combination itself
      const Pair p{set + form, points};
      const Rows theirs = rows_of(p.theirs("Fs"));
      const std::string text = p.ours("Fs FS");
      if (theirs.empty() || theirs[0].size() != 11) continue;  // Qhull finds it too flat
      const Rows ours = rows_of(text);
      ASSERT_FALSE(ours.empty()) << p.name;
      EXPECT_EQ(ours[0][1], theirs[0][1]) << p.name << ": dimension";
      EXPECT_EQ(ours[0][2], theirs[0][2]) << p.name << ": count";
    }
}

#else
TEST(Qconvex, NeedsQhullsPrograms) { GTEST_SKIP() << "rbox and qconvex are not installed"; }
#endif

}  // namespace cullhull::cli_qconvex_test
