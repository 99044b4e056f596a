// Our reader of JSON beside nlohmann's: the same texts are valid, with the same events.
#include "io/json/json_events.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <iterator>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace cullhull::internal {
namespace {

using nlohmann::json;

/// Writes down what it is told, by our events or by nlohmann's.
class Recorder final : public nlohmann::json_sax<json> {
 public:
  std::string events;

  bool null() override { return add("null"); }
  bool boolean(bool v) override { return add(v ? "true" : "false"); }
  bool number_integer(std::int64_t v) override { return add("i" + std::to_string(v)); }
  bool number_unsigned(std::uint64_t v) override { return add("u" + std::to_string(v)); }
  bool number_float(double v, const std::string& text) override { return real(v, text); }
  bool real(double v, std::string_view text) {
    char exact[40];
    std::snprintf(exact, sizeof exact, "%a ", v);
    return add(exact) && more(text);
  }
  bool string(std::string& v) override { return add("s") && more(v); }
  bool binary(json::binary_t&) override { return false; }
  bool start_object(std::size_t) override { return add("{"); }
  bool end_object() override { return add("}"); }
  bool start_array(std::size_t) override { return add("["); }
  bool end_array() override { return add("]"); }
  bool key(std::string& v) override { return add("k") && more(v); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }
  bool add(std::string_view event) { return (events += '\n').append(event), true; }
  bool more(std::string_view text) { return events.append(text), true; }
};

/// The same by our events.
struct Ours {
  Recorder to;
  const char* fault_at = nullptr;
  std::string_view why;

  bool null() { return to.null(); }
  bool boolean(bool v) { return to.boolean(v); }
  bool number_integer(std::int64_t v) { return to.number_integer(v); }
  bool number_unsigned(std::uint64_t v) { return to.number_unsigned(v); }
  bool number_float(double v, std::string_view text) { return to.real(v, text); }
  bool string(std::string_view v) { return to.add("s") && to.more(v); }
  bool key(std::string_view v) { return to.add("k") && to.more(v); }
  bool start_object() { return to.start_object(0); }
  bool end_object() { return to.end_object(); }
  bool start_array() { return to.start_array(0); }
  bool end_array() { return to.end_array(); }
  void at(const char*) {}
  void fault(const char* place, std::string_view reason) {
    fault_at = place;
    why = reason;
  }
};

bool read_all(std::string_view text, Ours& by) {
  return JsonEvents(text.data(), text.data() + text.size(), by).read_all();
}

/// Whether the text is valid, which both must agree about.
bool same(const std::string& text) {
  Ours ours;
  Recorder theirs;
  const bool valid = read_all(text, ours);
  EXPECT_EQ(valid, json::sax_parse(text, &theirs)) << text;
  EXPECT_TRUE(!valid || ours.to.events == theirs.events) << text;
  EXPECT_EQ(valid, ours.fault_at == nullptr) << text;
  return valid;
}

/// Words without blanks in them, and texts with them or with bytes beyond ASCII.
std::vector<std::string> texts(const char* words, std::vector<std::string> others) {
  std::istringstream in(words);
  others.insert(others.begin(), std::istream_iterator<std::string>(in), {});
  return others;
}

const std::vector<std::string> valid_texts =
    texts(R"(0 -0 [] {} [1,2,3] [[],[[]],{}] {"a":1,"a":2,"":[{"b":null}]} true [false,null]
             "" "\"\\\/\b\f\n\r\t" "\u0000\u00e9\u20AC\uD83D\uDE00z" 1.5 -0.0 1e5 1E+05 1e-400 0.1e1
             18446744073709551615 18446744073709551616 9999999999999999999 -9223372036854775808
             -9223372036854775809 123456789012345678901234567890 5e-324 2.2250738585072011e-308
             1.7976931348623157e308 9007199254740993.0)",
          {" [ ] ", "\t{\n}\r", "\xEF\xBB\xBF[1]", "\"\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80\"",
           "[1 , 2\n,\t3]", R"({ "a" : [ 1 ] , "b" : { } })"});

const std::vector<std::string> invalid_texts = texts(
    R"([ ] { } [1 [1, [1,] [,1] [1]] {] [} {"a"} {"a":} {"a":1,} {a:1} {1:1} 01 - -a +1 1. .5 1e
             1e+ 1.e5 0x10 1e400 -1e400 NaN -Infinity tru nulL truefalse 'a' " "a "\ "\x" "\u12"
             "\u12G4" "\u-123" "\uD800" "\uD800a" "\uD800\n" "\uD800\u0041" "\uDC00" [1]x)",
    {"", " ", "[1 2]", "{\"a\" 1}", "\"\n\"", "\"\x01\"", "\"\xC3\"", "\"\xC0\x80\"",
     "\"\xED\xA0\x80\"", "\"\xF4\x90\x80\x80\"", "\"\xFF\"", "\xEF\xBB[1]", "[1]\v", "/* */1",
     std::string(1, '\0'), std::string("\"\0\"", 3)});

TEST(JsonEvents, AreThoseOfAnotherReader) {
  for (const std::string& text : valid_texts) EXPECT_TRUE(same(text)) << text;
  for (const std::string& text : invalid_texts) EXPECT_FALSE(same(text)) << text;
}

TEST(JsonEvents, TextsWithAChangedByteOrCutOff) {
  std::mt19937 random(1);
  constexpr std::string_view bytes = "[]{}\",:0123456789.eE+-\\utrnalsf \n\x80\xC3\xE2\xFF";
  int valid = 0;
  for (int round = 0; round < 200; ++round)
    for (std::string text : valid_texts) {
      const std::size_t where = random() % text.size();
      if (round % 4 == 0)
        text.resize(where);
      else
        text[where] = bytes[random() % bytes.size()];
      valid += same(text) ? 1 : 0;
    }
  EXPECT_GT(valid, 300);
}

TEST(JsonEvents, NoNestingIsTooDeep) {
  constexpr std::size_t deep = 3'000'000;
  const std::string open(deep, '[');
  Ours all;
  EXPECT_TRUE(read_all(open + std::string(deep, ']'), all));
  Ours cut;
  EXPECT_FALSE(read_all(open, cut));
  EXPECT_EQ(cut.fault_at, open.data() + deep);
}

TEST(JsonEvents, AFaultHasItsPlace) {
  const auto place = [](std::string_view text) {
    Ours ours;
    EXPECT_FALSE(read_all(text, ours));
    return std::to_string(ours.fault_at - text.data()).append(": ").append(ours.why);
  };
  EXPECT_EQ(place("[1,2"), "4: not valid JSON");
  EXPECT_EQ(place("[1, 2}"), "5: not valid JSON");
  EXPECT_EQ(place("[1, nul]"), "7: not valid JSON");
  EXPECT_EQ(place("{\"a\" 1}"), "5: not valid JSON");
  EXPECT_EQ(place("[\"\xC3\xA9\xFF\"]"), "4: not valid JSON");
  EXPECT_EQ(place("[\"\\uD83D\\u0041\"]"), "13: not valid JSON");
  EXPECT_EQ(place("[1.]"), "3: not valid JSON");
  EXPECT_EQ(place({"[1]\0", 4}), "3: not valid JSON");
  EXPECT_EQ(place("[-Infinity]"), "2: not valid JSON, which has no NaN and no infinity");
  EXPECT_EQ(place("[1] 2"), "4: not valid JSON");
  EXPECT_EQ(place("[1, 1e999]"), "4: a number exceeds the range of doubles");
}

TEST(JsonEvents, OneOfSeveralTexts) {
  const std::string_view text = "[1]\n[2]";
  Ours ours;
  JsonEvents events(text.data(), text.data() + text.size(), ours);
  EXPECT_TRUE(events.read());
  EXPECT_EQ(events.next(), text.data() + 3);
}

}  // namespace
}  // namespace cullhull::internal
