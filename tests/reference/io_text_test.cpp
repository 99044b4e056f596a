#include <cmath>

#include "call_options.hpp"
#include "tests/io_fixtures.hpp"
#include "thrown.hpp"

namespace cullhull::testing::io_text_test {

using testing_support::stopped;

TEST(Text, SeparatorsCommentsAndLineEnds) {
  const Rows want{{1, -2.5}, {3, 4e-3}};
  for (const char* text :
       {"1 -2.5\n3 4e-3\n", "1,-2.5\n3,4e-3", "1 ; -2.5\r\n3;4e-3\r\n", "\t1\t-2.5\n\n3 .004\n\n",
        "# head\n// too\n1 -2.5 # tail\n3 4e-3// tail\n", "\xEF\xBB\xBF+1 -2.5\n3. 4E-3"}) {
    EXPECT_EQ(rows_of(parse(text, "txt").view), want) << text;
    EXPECT_EQ(rows_of(parse(text, "xyz").view), want) << text;
    EXPECT_EQ(rows_of(parse(text, "csv").view), want) << text;
    EXPECT_EQ(rows_of(parse(text, "").view), want) << text;
  }
}

TEST(Text, NumbersAreRoundedOnce) {
  const auto p = parse("0.1 9007199254740993 1e-400 2.4703282292062328e-324 4.9e-324\n", "txt");
  EXPECT_EQ(rows_of(p.view), (Rows{{0.1, 9007199254740992, 0, 5e-324, 5e-324}}));
}

TEST(Text, NotFiniteValuesPass) {
  const auto p = parse("nan inf\n-INF NaN\n", "txt");
  EXPECT_TRUE(std::isnan(p.view.at(0, 0)));
  EXPECT_EQ(p.view.at(0, 1), INFINITY);
  EXPECT_EQ(p.view.at(1, 0), -INFINITY);
  EXPECT_TRUE(std::isnan(p.view.at(1, 1)));
}

TEST(Text, ColumnNames) {
  const Rows want{{1, 2}};
  EXPECT_EQ(rows_of(parse("# c\n\"x\", \"y\"\n1,2\n", "csv").view), want);
  EXPECT_EQ(rows_of(parse("x y\n1 2\n", "csv").view), want);
  EXPECT_EQ(rows_of(parse("x;y\n1;2\n", "").view), want);
  EXPECT_EQ(rows_of(parse("x y\n1 2\n", "txt").view), want);
  EXPECT_EQ(rows_of(parse("a b\n1 2\n", "txt").view), want);
  EXPECT_EQ(refusal("some words about it\n1 2 3\n", "txt"), "F:1: 'some' is not a number");
  EXPECT_EQ(refusal("x,y\nz,w\n1,2\n", "csv"), "F:2: 'z' is not a number");
  EXPECT_EQ(refusal("x,y\n", "csv"), "F: no points after the line of column names");
}

TEST(Text, QhullsHeader) {
  const Rows want{{1, 2, 3}, {4, 5, 6}};
  for (const char* text : {"3 rbox 2 D3\n2\n1 2 3\n4 5 6\n", "3\n2\n1 2 3\n4 5 6\n"}) {
    const auto p = parse(text, "txt");
    EXPECT_EQ(p.format, "txt");
    EXPECT_EQ(rows_of(p.view), want);
    EXPECT_EQ(parse(text, "").format, "text (Qhull)");
  }
  EXPECT_EQ(rows_of(parse("1 words\n2\n5\n6\n", "txt").view), (Rows{{5}, {6}}));
  // Without words, and one number a line, nothing tells a header from points.
  EXPECT_EQ(rows_of(parse("3\n2\n7\n", "txt").view), (Rows{{3}, {2}, {7}}));
  EXPECT_EQ(parse("3 rbox 0 D3\n0\n", "txt").view.count, 0U);
  EXPECT_EQ(parse("3 rbox 0 D3\n0\n", "txt").view.dimension, 3U);
  EXPECT_EQ(refusal("3 rbox 4 D3\n4\n1 2 3\n4 5 6\n", "txt"),
            "F:2: promises 4 points, but 2 lines follow");
  EXPECT_EQ(refusal("3 rbox 2 D3\n2\n1 2 3\n4 5\n", "txt"),
            "F:4: 2 coordinates where the first point has 3");
  EXPECT_EQ(refusal("0 none\n2\n1\n2\n", "txt"), "F:1: dimension 0");
  EXPECT_EQ(refusal("4294967295 many\n2\n1\n2\n", "txt").find("F:3: 1 coordinates"), 0U);
  EXPECT_EQ(refusal("3 apples\nand pears\n", "txt"),
            "F:1: 'apples' is not a number; --columns 0 takes the columns of numbers (in Python "
            "columns=)");
}

TEST(Text, RefusalsNameTheLine) {
  EXPECT_EQ(refusal("1 2\n\n3 4 5\n", "txt"), "F:3: 3 coordinates where the first point has 2");
  EXPECT_EQ(refusal("1 2\n# c\n3 word\n", "txt"), "F:3: 'word' is not a number");
  EXPECT_EQ(refusal("1 2\n3 4x\n", "txt"), "F:2: '4x' is not a number");
  EXPECT_EQ(refusal("1 2\n3 0x10\n", "txt"), "F:2: '0x10' is not a number");
  EXPECT_EQ(refusal("1 2\n3 +-4\n", "txt"), "F:2: '+-4' is not a number");
  EXPECT_EQ(refusal("1 2\n3 1d5\n", "txt"), "F:2: '1d5' is not a number");
  EXPECT_EQ(refusal("1 2\n3 -1e999\n", "txt"), "F:2: '-1e999' exceeds the range of doubles");
  EXPECT_EQ(refusal("1,2\n3,,4\n", "csv"), "F:2: column 2 is empty");
  EXPECT_EQ(refusal("1,2\n3,4,\n", "csv"), "F:2: column 3 is empty");
  EXPECT_EQ(refusal("1,2\n,3\n", "csv"), "F:2: column 1 is empty");
  EXPECT_EQ(refusal("1.5,1;2.5,1\n", "csv").find("F:1: both ',' and ';'"), 0U);
  EXPECT_EQ(refusal("1;5;2\n1;2,5.5\n", "csv").find("F:2: both ',' and ';'"), 0U);
  EXPECT_EQ(refusal("1,2\n1;2\n", "csv").find("F:2: other separators"), 0U);
  EXPECT_EQ(refusal("1 2 3 4\n1,2 3,4\n", "txt").find("F:2: both ',' and blanks"), 0U);
  EXPECT_EQ(refusal("1;2;3\n1;2 3\n", "txt").find("F:2: both blanks and ';'"), 0U);
  EXPECT_EQ(refusal("# nothing\n\n", "txt"), "F: no points");
  EXPECT_EQ(refusal("", "txt"), "F: empty file");
  EXPECT_EQ(refusal(std::string_view("1 2\n3 \0\n", 8), "txt"), "F:2: '?' is not a number");
}

/// Lines of varying length across many chunks of the parallel parser.
std::string long_text(std::size_t lines, Rows& want) {
  std::string text = "# head\n";
  std::uint64_t state = 1;
  for (std::size_t i = 0; i < lines; ++i) {
    std::vector<double> row;
    for (int j = 0; j < 3; ++j) {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;
      row.push_back(std::ldexp(static_cast<double>(state >> 20), -static_cast<int>(state % 50)));
      char number[40];
      std::snprintf(number, sizeof number, "%.17g ", row.back());
      text += number;
    }
    want.push_back(row);
    text += i % 7 == 0 ? "# note\n\n" : "\n";
  }
  return text;
}

TEST(Text, ChunksKeepOrderAndLineNumbers) {
  Rows want;
  std::string text = long_text(60000, want);
  ASSERT_GT(text.size(), 3U << 20);
  for (const unsigned threads : {1U, 2U, 5U}) {
    ReadOptions options;
    options.threads = threads;
    EXPECT_EQ(rows_of(parse(text, "txt", options).view), want);
  }
  const auto line_of = [&](std::size_t at) {
    return std::to_string(std::count(text.begin(), text.begin() + static_cast<long>(at), '\n') + 1);
  };
  for (const double share : {0.3, 0.62, 0.98}) {
    std::string bad = text;
    const std::size_t at =
        bad.find("\n", static_cast<std::size_t>(share * static_cast<double>(bad.size()))) + 1;
    bad[at] = 'w';
    if (text[at] == '\n') continue;
    // A second fault further on must not win.
    bad += "1 2\n";
    const std::string message = refusal(bad, "txt");
    EXPECT_EQ(message.substr(0, message.find(' ')), std::string("F:").append(line_of(at)) += ':');
  }
}

TEST(Text, OneLongLine) {
  std::string text;
  for (int i = 0; i < 700000; ++i) text += std::to_string(i % 10) + ' ';
  const auto p = parse(text, "txt");
  EXPECT_EQ(p.view.count, 1U);
  EXPECT_EQ(p.view.dimension, 700000U);
  EXPECT_EQ(p.view.at(0, 699999), 9);
  EXPECT_EQ(refusal(text + "\n1\n2\n", "txt"),
            "F:2: 1 coordinates where the first point has 700000");
}

TEST(Text, StopsWhenAsked) {
  const ReadOptions options = stopped<ReadOptions>();
  error_of(ErrorCode::cancelled, [&] { parse("1 2\n", "txt", options); });
}

// The words behind the dimension are a comment, whatever they hold.
TEST(Text, QhullHeaderWithCommasAndSemicolons) {
  for (const char* words :
       {" rbox 10 D3 P0.5,0.5,0.5", " a;b, c ; d", " rbox 1,2;3", " x,", " (1,2)"}) {
    const auto p = parse(std::string("3").append(words).append("\n2\n1 2 3\n4 5 6\n"), "txt");
    EXPECT_EQ(rows_of(p.view), (Rows{{1, 2, 3}, {4, 5, 6}})) << words;
    EXPECT_EQ(p.format, "txt") << words;
  }
  // Separators of the points are not touched by this.
  EXPECT_EQ(rows_of(parse("2 m;m\n2\n1,2\n4,5\n", "csv").view), (Rows{{1, 2}, {4, 5}}));
  EXPECT_EQ(refusal("3 m,m\n2\n1 2 3\n", "txt"), "F:2: promises 2 points, but 1 lines follow");
  EXPECT_EQ(refusal("3,x\n2\n1 2 3\n", "txt").find("F:1: 'x' is not a number; --columns 0 "), 0U);
}

// Both numbers on one line, as Qhull takes them too; points of the plane are points.
TEST(Text, QhullHeaderOnOneLine) {
  EXPECT_EQ(rows_of(parse("3 2\n1 2 3\n4 5 6\n", "txt").view), (Rows{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(rows_of(parse("3 1 a comment, too\n1 2 3\n", "txt").view), (Rows{{1, 2, 3}}));
  EXPECT_EQ(rows_of(parse("2 1\n5 6\n", "txt").view), (Rows{{2, 1}, {5, 6}}));
  EXPECT_EQ(refusal("3 2\n1 2 3\n", "txt"), "F:1: promises 2 points, but 1 lines follow");
  EXPECT_EQ(refusal("3 2\n1 2\n4 5 6\n", "txt"), "F:3: 3 coordinates where the first point has 2");
}

// cdd's and lrs's V-representation: rbox writes it with its option h.
TEST(Text, CddFiles) {
  const char* const rbox =
      "rbox 2 D3 h\nbegin\n        2 4 real\n     1 0.5 -1 2 \n     1 3 4 5e-3 \nend\nhull\n";
  const auto p = parse(rbox, "");
  EXPECT_EQ(rows_of(p.view), (Rows{{0.5, -1, 2}, {3, 4, 5e-3}}));
  EXPECT_EQ(p.format, "text (cdd)");
  EXPECT_EQ(rows_of(parse(rbox, "txt").view), rows_of(p.view));
  EXPECT_EQ(
      rows_of(parse("* a note\nV-representation\nbegin\n1 3 integer\n1 7 8\nend\n", "txt").view),
      (Rows{{7, 8}}));
  EXPECT_EQ(rows_of(parse("begin\r\n1 2 rational\r\n1 7\r\nend", "txt").view), (Rows{{7}}));
  EXPECT_EQ(rows_of(parse("begin\n1 3 real\n4 7 8\nend\n", "txt").view), (Rows{{7, 8}}));
  EXPECT_EQ(refusal("begin\n2 3 real\n1 7 8\nend\n", "txt"),
            "F:2: promises 2 points, but 1 lines follow");
  EXPECT_EQ(refusal("begin\n1 3 real\n1 7 8\n", "txt"), "F: no line 'end' after the points");
  EXPECT_EQ(refusal("begin\n1 3 real\n0 7 8\nend\n", "txt"),
            "F:3: begins with 0, which is a ray: only points are read");
  EXPECT_EQ(refusal("begin\n1 3 rational\n1 1/3 8\nend\n", "txt"), "F:3: '1/3' is not a number");
  EXPECT_EQ(refusal("begin\n1 3 real\n1 7\nend\n", "txt"),
            "F:3: 2 numbers where the header promises 3");
  EXPECT_EQ(refusal("begin\n1 1 real\n1\nend\n", "txt"), "F:2: dimension 0");
  EXPECT_EQ(refusal("begin\nmany\n1 7 8\nend\n", "txt"),
            "F:2: 'begin' is followed by the number of points, the dimension + 1 and the type");
  EXPECT_EQ(refusal("H-representation\nbegin\n1 3 real\n1 7 8\nend\n", "txt"),
            "F:1: holds halfspaces, not points");
}

/// A text of UTF-16 code units, with a byte order mark.
std::string utf16(std::u16string_view text, bool big) {
  std::string out;
  for (const char16_t unit : u"\uFEFF" + std::u16string(text)) {
    const char low = static_cast<char>(unit & 0xFF), high = static_cast<char>(unit >> 8);
    out += big ? high : low;
    out += big ? low : high;
  }
  return out;
}

TEST(Text, InUtf16IsRead) {
  for (const bool big : {false, true}) {
    for (const char* format : {"csv", "txt", ""})
      EXPECT_EQ(rows_of(parse(utf16(u"1,2\r\n3,4\r\n", big), format).view), (Rows{{1, 2}, {3, 4}}));
    EXPECT_EQ(rows_of(parse(utf16(u"v 1 2 3\n", big), "obj").view), (Rows{{1, 2, 3}}));
    EXPECT_EQ(rows_of(parse(utf16(u"POINT (1 2)", big), "wkt").view), (Rows{{1, 2}}));
    EXPECT_EQ(refusal(utf16(u"L\u00E4nge,\U0001F600,\u6F22\n1,2,3\n", big), "csv")
                  .find("F:1: the names of the columns are not known as coordinates: "
                        "'L\xC3\xA4nge', '\xF0\x9F\x98\x80', '\xE6\xBC\xA2'"),
              0U);
    EXPECT_EQ(refusal(utf16(u"", big), "csv"), "F: no points");
    std::string half = utf16(u"1,\xD83D\n", big);
    EXPECT_EQ(refusal(half, "csv").find("F:1: '?' is not a number"), 0U);
    half = utf16(u"1,2\n", big) + "3";  // half a code unit
    EXPECT_EQ(rows_of(parse(half, "csv").view), (Rows{{1, 2}}));
  }
}

TEST(Text, LettersInMessagesStay) {
  const auto named = [](const std::string& word) {
    const std::string message = refusal("1," + word + "\n", "csv");
    return message.substr(5, message.find(" is not") - 5);
  };
  EXPECT_EQ(named("\xC3\xA4\xE6\xBC\xA2"), "'\xC3\xA4\xE6\xBC\xA2'");
  EXPECT_EQ(named("a\xE4z\x01\x7F"),
            "'a?z?"
            "?'");  // not UTF-8, controls
  EXPECT_EQ(named("\xE2\x80\xAE\xC2\x85"),
            "'?"
            "?"
            "?"
            "?"
            "?'");  // turns the line; a control
  EXPECT_EQ(named("\xC0\xAF\xED\xA0\x80"),
            "'?"
            "?"
            "?"
            "?"
            "?'");  // overlong; a surrogate
  EXPECT_EQ(named(std::string(39, 'a') + "\xC3\xA4"
                                         "b"),
            "'" + std::string(39, 'a') + "...'");
}

TEST(Text, LineOfAPoint) {
  const TemporaryFolder folder;
  const std::string csv = folder.write("a.csv", "\xEF\xBB\xBFx,y\n\n1,2\n# c\n3,nan\n");
  EXPECT_EQ(line_of_point(csv, 0), 3U);
  EXPECT_EQ(line_of_point(csv, 1), 5U);
  EXPECT_EQ(line_of_point(csv, 2), std::nullopt);
  EXPECT_EQ(line_of_point(folder.write("a.txt", "2 rbox\n2\n1 2\n3 nan\n"), 1), 4U);
  EXPECT_EQ(line_of_point(folder.write("a.obj", "v 1 2 3\n"), 0), std::nullopt);
  EXPECT_EQ(line_of_point(folder.file("none.csv"), 0), std::nullopt);
  EXPECT_EQ(line_of_point("-", 0), std::nullopt);
}

TEST(Text, ByteOrderMarkIsPassedOver) {
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_EQ(rows_of(parse(mark + "1 2\n", "txt").view), (Rows{{1, 2}}));
  EXPECT_EQ(rows_of(parse(mark + "x,y\n1,2\n", "csv").view), (Rows{{1, 2}}));
  EXPECT_EQ(rows_of(parse(mark + "2 rbox\n1\n1 2\n", "txt").view), (Rows{{1, 2}}));
  const std::string solid =
      "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
      "vertex 0 1 0\nendloop\nendfacet\nendsolid\n";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n1 2 3\n";
  for (const auto& [format, text] : {std::pair<std::string, std::string>{"txt", "1 2 3\n"},
                                     {"obj", "v 1 2 3\n"},
                                     {"off", "OFF\n1 0 0\n1 2 3\n"},
                                     {"ply", ply},
                                     {"stl", solid}})
    for (const std::string& named : {format, std::string()}) {
      const auto want = parse(text, named), got = parse(mark + text, named);
      EXPECT_EQ(rows_of(got.view), rows_of(want.view)) << format;
      EXPECT_EQ(got.format, want.format) << format;
    }
  EXPECT_EQ(refusal(mark + "v 1 2 x\n", "obj"), "F:1: 'x' is not a number");
  EXPECT_EQ(refusal(mark, "txt"), "F: no points");
  // Numbers that happen to begin with these bytes are numbers.
  ReadOptions raw;
  raw.raw_dimension = 4;
  raw.raw_scalar = ScalarType::u8;
  EXPECT_EQ(rows_of(parse(mark + "a", "raw", raw).view), (Rows{{0xEF, 0xBB, 0xBF, 'a'}}));
}

}  // namespace cullhull::testing::io_text_test
