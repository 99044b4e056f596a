// LAS: every version and point format, in place and in blocks; headers that lie.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cullhull/point_blocks.hpp"
#include "io_fixtures.hpp"

namespace cullhull::testing::io_las_test {

constexpr unsigned least_record[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

struct Las {
  unsigned minor = 2, format = 0, record = 0, header = 0, offset = 0;
  std::uint64_t promised = ~std::uint64_t{0};
  std::array<double, 3> scale = {1, 1, 1}, origin = {0, 0, 0};
  std::vector<std::array<std::int32_t, 3>> points = {
      {1, 2, 3}, {-4, 5, 6}, {2147483647, -2147483648, 0}};

  std::string bytes() const {
    const unsigned size = header != 0 ? header : minor == 4 ? 375 : minor == 3 ? 235 : 227;
    const unsigned begin = offset != 0 ? offset : size + 54;
    const unsigned length = record != 0 ? record : least_record[format & 15] + 3;
    std::string b(std::max(begin, 375U), '\0');
    const auto put = [&](std::size_t at, auto v) { b.replace(at, sizeof v, bytes_of(v)); };
    b.replace(0, 4, "LASF");
    put(24, static_cast<std::uint8_t>(1));
    put(25, static_cast<std::uint8_t>(minor));
    put(94, static_cast<std::uint16_t>(size));
    put(96, static_cast<std::uint32_t>(begin));
    put(104, static_cast<std::uint8_t>(format));
    put(105, static_cast<std::uint16_t>(length));
    const std::uint64_t n = promised != ~std::uint64_t{0} ? promised : points.size();
    if (format <= 5 || minor < 4) put(107, static_cast<std::uint32_t>(n));
    if (minor == 4) put(247, n);
    for (std::size_t j = 0; j < 3; ++j) {
      put(131 + 8 * j, scale[j]);
      put(155 + 8 * j, origin[j]);
    }
    b.resize(begin);
    for (const auto& p : points) {
      std::string r(length, '\x55');
      r.replace(0, 12, bytes_of(p[0], p[1], p[2]));
      b += r;
    }
    return b;
  }
};

/// A variable-length record.
std::string vlr(unsigned id, const std::string& contents,
                const std::string& user = "LASF_Projection") {
  std::string b(54, '\0');
  b.replace(2, user.size(), user);
  b.replace(18, 2, bytes_of(static_cast<std::uint16_t>(id)));
  b.replace(20, 2, bytes_of(static_cast<std::uint16_t>(contents.size())));
  return b + contents;
}

/// GeoTIFF's directory: keys whose values stand in it. `told`: how many it says it has.
std::string geo_keys(const std::vector<std::pair<unsigned, unsigned>>& keys, int told = -1) {
  const auto number = [](unsigned v) { return static_cast<std::uint16_t>(v); };
  std::string b =
      bytes_of(number(1), number(1), number(0),
               number(told < 0 ? static_cast<unsigned>(keys.size()) : static_cast<unsigned>(told)));
  for (const auto& [key, value] : keys)
    b += bytes_of(number(key), number(0), number(1), number(value));
  return vlr(34735, b);
}

/// A file with these records behind its header.
std::string with_records(const std::vector<std::string>& records) {
  std::string all;
  for (const std::string& r : records) all += r;
  Las las;
  las.offset = static_cast<unsigned>(227 + all.size());
  std::string bytes = las.bytes();
  bytes.replace(100, 4, bytes_of(static_cast<std::uint32_t>(records.size())));
  bytes.replace(227, all.size(), all);
  return bytes;
}

/// What a file with these records names as the unit of x and y.
std::string unit_of(const std::vector<std::string>& records) {
  const TemporaryFolder folder;
  const PointFile file = open_points(folder.write("a.las", with_records(records)));
  EXPECT_FALSE(file.placement().empty());
  return file.placement().unit;
}

TEST(IoLas, SystemsByGeoTiffKeysAndWkt) {
  const TemporaryFolder folder;
  const auto crs_of = [&](const std::vector<std::string>& records) {
    return file_crs(folder.write("a.las", with_records(records)));
  };
  constexpr unsigned model = 1024, on_earth = 2048, in_plane = 3072, wkt = 2112;
  EXPECT_EQ(crs_of({}), "");
  EXPECT_EQ(crs_of({geo_keys({{in_plane, 25832}})}), "EPSG:25832");
  EXPECT_EQ(crs_of({geo_keys({{model, 1}, {on_earth, 4258}, {in_plane, 25832}})}), "EPSG:25832");
  EXPECT_EQ(crs_of({geo_keys({{model, 2}, {on_earth, 4258}})}), "EPSG:4258");
  EXPECT_EQ(crs_of({geo_keys({{model, 1}, {in_plane, 32767}})}), "") << "user-defined";
  EXPECT_EQ(crs_of({geo_keys({{model, 1}, {in_plane, 0}})}), "");
  EXPECT_EQ(crs_of({geo_keys({{model, 1}, {in_plane, 25832}}, 1)}), "");
  const std::string of_wkt = R"(PROJCS["p",GEOGCS["g",AUTHORITY["EPSG","4258"]],)"
                             R"(AUTHORITY["EPSG","25833"]])";
  EXPECT_EQ(crs_of({vlr(wkt, of_wkt)}), "EPSG:25833");
  EXPECT_EQ(crs_of({geo_keys({{in_plane, 25832}}), vlr(wkt, of_wkt)}), "EPSG:25833");
  EXPECT_EQ(crs_of({geo_keys({{in_plane, 25832}}), vlr(wkt, "PROJCS[\"p\"]")}), "EPSG:25832");
  EXPECT_EQ(crs_of({vlr(wkt, of_wkt, "someone_else")}), "");
  // Cut short anywhere: the readers say so.
  const std::string whole = with_records({vlr(wkt, of_wkt)});
  for (std::size_t size = 0; size < 227 + 54 + of_wkt.size(); size += 7)
    EXPECT_EQ(file_crs(folder.write("b.las", whole.substr(0, size))), "");
}

TEST(IoLas, SystemBehindThePoints) {
  const TemporaryFolder folder;
  const std::string of_wkt = R"(PROJCRS["p",ID["EPSG",25833]])";
  std::string bytes = Las{.minor = 4, .format = 6}.bytes();
  const auto add = [&](const std::string& user, unsigned id, const std::string& contents) {
    std::string head(60, '\0');
    head.replace(2, user.size(), user);
    head.replace(18, 2, bytes_of(static_cast<std::uint16_t>(id)));
    head.replace(20, 8, bytes_of(static_cast<std::uint64_t>(contents.size())));
    bytes += head + contents;
  };
  bytes.replace(235, 8, bytes_of(static_cast<std::uint64_t>(bytes.size())));
  bytes.replace(243, 4, bytes_of(std::uint32_t{2}));
  add("other", 7, "abc");
  add("LASF_Projection", 2112, of_wkt);
  EXPECT_EQ(file_crs(folder.write("a.las", bytes)), "EPSG:25833");
  for (std::size_t cut = 1; cut < 180; cut += 11)
    EXPECT_EQ(file_crs(folder.write("a.las", bytes.substr(0, bytes.size() - cut))), "");
  bytes.replace(235, 8, bytes_of(~std::uint64_t{0} - 10));
  EXPECT_EQ(file_crs(folder.write("a.las", bytes)), "");
}

TEST(IoLas, UnitsByGeoTiffKeys) {
  constexpr unsigned model = 1024, linear = 3076, angular = 2054, system = 3072, vertical = 4099;
  EXPECT_EQ(unit_of({geo_keys({{model, 1}, {linear, 9001}})}), "metre");
  EXPECT_EQ(unit_of({geo_keys({{model, 1}, {linear, 9002}})}), "foot");
  EXPECT_EQ(unit_of({geo_keys({{model, 1}, {linear, 9003}})}), "US survey foot");
  EXPECT_EQ(unit_of({geo_keys({{linear, 9003}, {vertical, 9001}})}), "US survey foot");
  EXPECT_EQ(unit_of({geo_keys({{model, 2}})}), "degree");
  EXPECT_EQ(unit_of({geo_keys({{model, 2}, {angular, 9102}})}), "degree");
  // Missing: none, another, one that only the system's number tells, other records alone.
  EXPECT_EQ(unit_of({}), "");
  EXPECT_EQ(unit_of({geo_keys({})}), "");
  EXPECT_EQ(unit_of({geo_keys({{model, 1}, {system, 32612}})}), "");
  EXPECT_EQ(unit_of({geo_keys({{model, 1}, {linear, 9036}})}), "");
  EXPECT_EQ(unit_of({geo_keys({{model, 2}, {angular, 9101}})}), "");
  EXPECT_EQ(unit_of({geo_keys({{vertical, 9001}})}), "");
  EXPECT_EQ(unit_of({vlr(34735, std::string(8, 'x'), "someone_else")}), "");
  EXPECT_EQ(unit_of({vlr(7, "abc", "other"), geo_keys({{linear, 9001}})}), "metre");
  // Contradictory: a system in degrees has no lengths; two units are none.
  EXPECT_EQ(unit_of({geo_keys({{model, 2}, {linear, 9001}})}), "degree");
  EXPECT_EQ(unit_of({geo_keys({{linear, 9001}, {model, 2}})}), "degree");
  EXPECT_EQ(unit_of({geo_keys({{linear, 9001}, {linear, 9002}})}), "");
  EXPECT_EQ(unit_of({geo_keys({{linear, 9002}, {linear, 9002}})}), "foot");
  // Behind the keys that the directory has nothing is one; it may be cut off.
  EXPECT_EQ(unit_of({geo_keys({{model, 1}, {linear, 9001}}, 1)}), "");
  EXPECT_EQ(unit_of({geo_keys({{model, 1}, {linear, 9001}}, 9)}), "metre");
  EXPECT_EQ(unit_of({vlr(34735, "abc")}), "");
}

TEST(IoLas, UnitsByWellKnownText) {
  constexpr unsigned wkt = 2112;
  const std::string degrees = R"(GEOGCS["g",DATUM["d",SPHEROID["s",1,2]],UNIT["degree",0.0175]])";
  EXPECT_EQ(unit_of({vlr(wkt, degrees)}), "degree");
  EXPECT_EQ(unit_of({vlr(wkt, "PROJCS[\"p\"," + degrees + ",UNIT[\"US survey foot\",0.3]]")}),
            "US survey foot");
  EXPECT_EQ(unit_of({vlr(wkt, "PROJCS[\"p\"," + degrees + "]")}), "");
  EXPECT_EQ(unit_of({vlr(wkt, R"(PROJCRS["p",BASEGEOGCRS["b",PRIMEM["m",0,ANGLEUNIT["degree",1]]],)"
                              R"(CONVERSION["c",PARAMETER["k",0,LENGTHUNIT["foot",1]]],)"
                              R"(CS[Cartesian,2],AXIS["x",east,LENGTHUNIT["metre",1]]])")}),
            "metre");
  // Beside keys the text has the word.
  EXPECT_EQ(unit_of({geo_keys({{3076, 9001}}), vlr(wkt, degrees)}), "degree");
  EXPECT_EQ(unit_of({geo_keys({{3076, 9001}}), vlr(wkt, "LOCAL_CS[]")}), "metre");
  EXPECT_EQ(unit_of({vlr(wkt, "PROJCS[\"p\",UNIT[\"" + std::string(300, 'x') + "\",1]]")}), "");
  EXPECT_EQ(unit_of({vlr(wkt, "PROJCS[\"p\",UNIT[\"metre")}), "");
}

void expect_points(const Las& las, const PointView& view) {
  ASSERT_EQ(view.count, las.points.size());
  EXPECT_EQ(view.dimension, 3U);
  EXPECT_EQ(view.scalar, ScalarType::i32);
  for (std::size_t i = 0; i < las.points.size(); ++i)
    for (std::uint32_t j = 0; j < 3; ++j) EXPECT_EQ(view.at(i, j), las.points[i][j]);
}

TEST(IoLas, EveryVersionAndPointFormat) {
  const TemporaryFolder folder;
  for (unsigned minor = 0; minor <= 4; ++minor)
    for (unsigned format = 0; format <= 10; ++format) {
      SCOPED_TRACE(std::to_string(minor) + " " + std::to_string(format));
      Las las;
      las.minor = minor;
      las.format = format;
      const std::string path = folder.write("a.las", las.bytes());
      ReadOptions stored;
      stored.numbers = Numbers::raw;
      const PointFile file = open_points(path, stored);
      EXPECT_EQ(file.mapped(), lies_ready);
      EXPECT_EQ(file.format(),
                "las 1." + std::to_string(minor) + ", point format " + std::to_string(format));
      expect_points(las, file.points());
      EXPECT_EQ(rows_in_blocks(path, stored, 1), rows_of(file.points()));
      // By content, and with extra bytes behind the points, as waveforms and extended records are.
      const PointFile other = open_points(folder.write("b", las.bytes() + "more"), stored);
      expect_points(las, other.points());
    }
}

std::string said(const TemporaryFolder& folder, const std::string& bytes) {
  return error_whole_and_in_blocks(folder.write("a.las", bytes));
}

TEST(IoLas, HeadersThatLie) {
  const TemporaryFolder folder;
  const auto expect_error = [&](const Las& las, const char* say) {
    EXPECT_TRUE(has(said(folder, las.bytes()), say));
  };
  expect_error({.minor = 5}, "byte 24: LAS version 1.5");
  expect_error({.format = 11, .record = 80}, "byte 104: LAS point format 11");
  expect_error({.format = 0x80}, "the points are compressed (LAZ), but no record");
  expect_error({.format = 1, .record = 27}, "byte 105: records of 27 bytes");
  expect_error({.header = 100, .offset = 400}, "byte 94: LAS header of 100 bytes");
  expect_error({.minor = 4, .header = 300}, "byte 94: LAS header of 300 bytes");
  expect_error({.offset = 200}, "byte 96: points at byte 200");
  expect_error({.promised = 4}, "4 points of 23 bytes need more than the 69 bytes");
  expect_error({.minor = 4, .promised = ~std::uint64_t{0} / 23}, "need more than");
  const std::string whole = Las().bytes();
  for (const std::size_t size : std::vector<std::size_t>{4, 100, 226, 250, whole.size() - 1})
    EXPECT_NE(said(folder, whole.substr(0, size)), "") << size;
}

TEST(IoLas, ScalesAndOffsetsThatGiveNoCoordinates) {
  const TemporaryFolder folder;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto expect_refused = [&](const Las& las, const std::string& say) {
    SCOPED_TRACE(say);
    const std::string path = folder.write("a.las", las.bytes());
    EXPECT_EQ(
        error_whole_and_in_blocks(path),
        path + ": byte " + say +
            ", which gives no coordinates; --raw (Python: raw=True) reads the stored integers");
    // Beside a good tile, whose grid the report would have claimed for both.
    const std::string good = folder.write("good.las", Las().bytes());
    ReadOptions on_grid;
    on_grid.numbers = Numbers::grid;
    for (const auto& files : {std::vector{good, path}, std::vector{path, good}})
      error_of(ErrorCode::bad_file, [&] { common_grid(files, on_grid); });
    ReadOptions stored;
    stored.numbers = Numbers::file;  // for a caller who places them
    error_of(ErrorCode::bad_file, [&] { open_points(path, stored); });
    stored.numbers = Numbers::raw;
    const PointFile file = open_points(path, stored);
    EXPECT_TRUE(file.placement().empty());
    expect_points(las, file.points());
    EXPECT_EQ(rows_in_blocks(path, stored), rows_of(file.points()));
  };
  expect_refused({.scale = {0, 1, 1}}, "131: the scale of x is 0");
  expect_refused({.scale = {1, -0.0, 1}}, "139: the scale of y is -0");
  expect_refused({.scale = {1, 1, -0.01}}, "147: the scale of z is -0.01");
  expect_refused({.scale = {1, infinity, 1}}, "139: the scale of y is inf");
  expect_refused({.scale = {std::nan(""), 1, 1}}, "131: the scale of x is nan");
  expect_refused({.origin = {0, infinity, 0}}, "163: the offset of y is inf");
  expect_refused({.origin = {0, 0, -infinity}}, "171: the offset of z is -inf");
  expect_refused({.minor = 4, .origin = {std::nan(""), 0, 0}}, "155: the offset of x is nan");
}

}  // namespace cullhull::testing::io_las_test
