// LAZ: files of every point format and version that lazrs writes (fuzz/corpus/laz), whole, in
// blocks and as records; what is damaged.
#include <gtest/gtest.h>

#include <numeric>

#include "io/formats/laz.hpp"
#include "io/formats/laz_models.hpp"
#include "io_fixtures.hpp"

namespace cullhull::testing::io_laz_test {

constexpr std::uint64_t points = 240;  // of each file, in chunks of 100

struct Made {
  const char* name;
  std::size_t record;  ///< bytes
  std::uint64_t hash;  ///< FNV-1a of all records, as laspy had them
};

// Made by lazrs 0.8 of random points, formats 5 and 10 by LASzip 3.5: 1, 4 and 5 have items of
// version 1, 10 of version 4, the others of 2 and 3. 0, 3, 5, 8 and 10 have extra bytes; 6, 7, 8
// and 10 four scanner channels; the last one chunks of 7, 1, 192 and 40 points.
const std::vector<Made> made = {
    {"format-0", 33, 0x7f956afc7970d87aU},  {"format-1", 28, 0x0f5c39b6d839f7f2U},
    {"format-2", 26, 0x9cdef562a2584c0aU},  {"format-3", 47, 0xb8183de479718c7fU},
    {"format-4", 57, 0xb2694574547779b2U},  {"format-5", 76, 0x18f337c8b325b01fU},
    {"format-6", 30, 0x6bc004548df141b4U},  {"format-7", 36, 0x16c6b577f2f53f77U},
    {"format-8", 51, 0x2441ded4342b6b1cU},  {"format-9", 59, 0x793fc656a4279e31U},
    {"format-10", 80, 0x793910368f836342U}, {"variable", 30, 0xc5c0deeb01ccb941U}};

std::string file_of(const std::string& name) {
  return std::string(CULLHULL_ROOT) + "/fuzz/corpus/laz/" + name + ".laz";
}

std::uint64_t hash_of(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return hash;
}

/// The same points as a file that is not compressed, with these of them.
std::string unpacked(const TemporaryFolder& folder, const std::string& path,
                     const std::vector<std::uint64_t>& ids) {
  const std::string las = folder.file("unpacked.las");
  write_las_records(las, path, ids);
  return las;
}

std::vector<std::uint64_t> all_ids() {
  std::vector<std::uint64_t> ids(points);
  std::iota(ids.begin(), ids.end(), 0U);
  return ids;
}

TEST(IoLaz, EveryPointFormat) {
  const TemporaryFolder folder;
  for (const Made& m : made) {
    SCOPED_TRACE(m.name);
    const std::string path = file_of(m.name), las = unpacked(folder, path, all_ids());
    const std::string bytes = slurp(las);
    ASSERT_GT(bytes.size(), points * m.record);
    EXPECT_EQ(hash_of(bytes.substr(bytes.size() - points * m.record)), m.hash);
    const PointFile laz = open_points(path), other = open_points(las);
    EXPECT_EQ(laz.format(), other.format() + ", LAZ");
    EXPECT_EQ(rows_of(laz.points()), rows_of(other.points()));
    for (const std::uint64_t block : {1U, 4096U, 1U << 20})
      EXPECT_EQ(rows_in_blocks(path, {}, block), rows_of(other.points()));
  }
}

TEST(IoLaz, EachFieldAlone) {
  const TemporaryFolder folder;
  for (const Made& m : made) {
    const std::string path = file_of(m.name), las = unpacked(folder, path, all_ids());
    for (const char* field :
         {"x", "y,x", "z", "intensity", "return_number", "number_of_returns", "synthetic",
          "scan_direction_flag", "edge_of_flight_line", "classification", "user_data",
          "point_source_id", "gps_time", "z,scan_angle", "scanner_channel", "red,blue", "nir"}) {
      SCOPED_TRACE(std::string(m.name) + " " + field);
      ReadOptions options;
      options.columns = field;
      const std::string error = error_of([&] { open_points(las, options); });
      if (!error.empty()) {  // a field that the format does not have
        EXPECT_TRUE(has(error_of([&] { open_points(path, options); }), "no column"));
        continue;
      }
      EXPECT_EQ(rows_of(open_points(path, options).points()),
                rows_of(open_points(las, options).points()));
    }
    ReadOptions keyed;
    keyed.weights = "intensity";
    EXPECT_EQ(open_points(path, keyed).weights(), open_points(las, keyed).weights());
  }
}

TEST(IoLaz, SomeRecords) {
  const TemporaryFolder folder;
  const std::vector<std::uint64_t> ids{0, 7, 99, 100, 239};
  for (const Made& m : made) {
    const std::string path = file_of(m.name);
    const Rows all = rows_of(open_points(path).points());
    Rows some;
    for (const std::uint64_t id : ids) some.push_back(all[id]);
    EXPECT_EQ(rows_of(open_points(unpacked(folder, path, ids)).points()), some) << m.name;
  }
  EXPECT_TRUE(has(error_of([&] { unpacked(folder, file_of("format-0"), {points}); }), "below 240"));
}

// No chunk is decoded for two blocks.
TEST(IoLaz, BlocksAreWholeChunks) {
  std::vector<std::uint64_t> counts;
  BlockOptions options;
  options.block_bytes = 1;
  options.readers = 1;
  BlockVisitor visitor;
  visitor.points = [&](const PointView& view, std::uint64_t) { counts.push_back(view.count); };
  visit_blocks({file_of("variable")}, visitor, options);
  EXPECT_EQ(counts, (std::vector<std::uint64_t>{7, 1, 192, 40}));
}

TEST(IoLaz, PartsOfRowsBeginWithinChunks) {
  const std::vector<std::string> files{file_of("format-7"), file_of("variable")};
  std::vector<int> seen(2 * points);
  for (std::uint64_t part = 0; part < 7; ++part) {
    BlockOptions options;
    options.read.numbers = Numbers::raw;
    options.rows = rows_of_part(files, part, 7, options);
    options.readers = 1;
    BlockVisitor visitor;
    visitor.points = [&](const PointView& view, std::uint64_t first) {
      for (std::uint64_t i = 0; i < view.count; ++i) ++seen[first + i];
    };
    visit_blocks(files, visitor, options);
  }
  EXPECT_EQ(seen, std::vector<int>(2 * points, 1));
}

/// What a file says whose bytes at `at` are replaced.
std::string said(const TemporaryFolder& folder, std::string bytes, std::size_t at,
                 const std::string& by) {
  bytes.replace(at, by.size(), by);
  return error_whole_and_in_blocks(folder.write("a.laz", bytes));
}

template <class T>
T number(const std::string& bytes, std::size_t at) {
  return internal::load_little_endian<T>(bytes.data() + at);
}

TEST(IoLaz, HeadersThatLie) {
  const TemporaryFolder folder;
  const std::string bytes = slurp(file_of("format-7"));
  const std::size_t offset = number<std::uint32_t>(bytes, 96), vlr = bytes.find("laszip enc") + 52;
  const std::uint64_t table = number<std::uint64_t>(bytes, offset);
  const auto expect = [&](std::size_t at, const std::string& by, const std::string& say) {
    const std::string error = said(folder, bytes, at, by);
    EXPECT_TRUE(has(error, say)) << error;
  };
  const auto half = [](unsigned v) { return bytes_of(static_cast<std::uint16_t>(v)); };
  expect(vlr - 52, "l0szip", "the points are compressed (LAZ), but no record");
  expect(vlr, half(4), "LAZ compressor 4; 1 to 3 are known");
  expect(vlr + 2, half(1), "LAZ coder 1");
  expect(vlr + 12, bytes_of(std::uint32_t{0}), "chunks of 0 points");
  expect(vlr + 32, half(9), "9 items, which the laszip record cannot hold");
  expect(vlr + 34, half(6), "LAZ item 6, which is unknown in point format 7");
  expect(vlr + 36, half(31), "LAZ item 10 of 31 bytes");
  expect(vlr + 38, half(5), "LAZ item 10 of version 5; 3 and 4 are known");
  expect(vlr + 40, half(99), "LAZ item 99");
  expect(105, half(40), "LAZ items of 36 bytes for records of 40");
  expect(offset, bytes_of(std::int64_t{-5}), "the chunk table is at byte -5");
  expect(offset, bytes_of(std::int64_t{1} << 40), "the chunk table is at byte 1099511627776 of");
  expect(offset, bytes_of(std::int64_t{-1}), "the chunk table is at byte");
  expect(table, bytes_of(std::uint32_t{1}), "chunk table of version 1");
  expect(table + 4, bytes_of(std::uint32_t{0xFFFFFFFF}), "4294967295 chunks in");
  expect(table + 4, bytes_of(std::uint32_t{2}), "2 chunks hold 200 points, the header says 240");
  expect(247, bytes_of(std::uint64_t{300}), "points than the chunk table says");
  expect(247, bytes_of(std::uint64_t{301}), "3 chunks hold 300 points, the header says 301");
  expect(offset + 8 + 36, bytes_of(std::uint32_t{99}),
         "chunk 0 of 3 is damaged: it has another number of points");
  expect(offset + 8 + 40, bytes_of(std::uint32_t{1} << 30),
         "chunk 0 of 3 is damaged: its layers need more bytes");
}

TEST(IoLaz, ChunkTableAtTheEnd) {
  const TemporaryFolder folder;
  for (const Made& m : made) {
    std::string bytes = slurp(file_of(m.name));
    const std::size_t offset = number<std::uint32_t>(bytes, 96);
    bytes += bytes.substr(offset, 8);  // as a pipe is written
    bytes.replace(offset, 8, std::string(8, '\xFF'));
    EXPECT_EQ(rows_of(open_points(folder.write("a.laz", bytes)).points()),
              rows_of(open_points(file_of(m.name)).points()));
  }
}

TEST(IoLaz, DamagedAndCutShortAnywhere) {
  const TemporaryFolder folder;
  for (const Made& m : made) {
    const std::string bytes = slurp(file_of(m.name));
    for (std::size_t size = 300; size < bytes.size(); size += 97)
      EXPECT_NE(error_of([&] { parse(bytes.substr(0, size), "las"); }), "") << m.name << size;
    for (std::size_t at = 104; at < bytes.size(); at += 41) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
      const std::string path = folder.write("a.laz", damaged);
      error_of([&] { unpacked(folder, path, {0, 150, 239}); });  // no crash, whatever it says
    }
  }
}

TEST(IoLaz, NoCodeIsReadBeyondItsEnd) {
  using namespace internal;
  const std::string few = "abc";
  EXPECT_THROW(LazDecoder(few.data(), few.data() + 3), LazDamage);
  const std::string none(4, '\xFF'), zeros(8, '\0');
  EXPECT_THROW(LazDecoder(none.data(), none.data() + 4), LazDamage);
  LazDecoder decoder(zeros.data(), zeros.data() + 8);
  EXPECT_EQ(decoder.bits(32), 0U);
  EXPECT_THROW(decoder.bits(32), LazDamage);
}

// A chunk may hold all points of a file. Zeros code as many as are asked for.
TEST(IoLaz, StopsWithinAChunk) {
  using namespace internal;
  const std::uint32_t count = 70000, layer = 50000;  // of x and y; the others are empty
  std::string bytes(100000, '\0'), room(count * 12, '\0');
  const LazChunk chunk{bytes.data(), bytes.data() + bytes.size(), count};
  const LazRows rows{room.data(), 30, 12, std::vector<bool>(30, true)};
  ReadOptions options;
  const auto both = [&] {
    bytes.replace(30, 8, 8, '\0');
    const auto of_points = error_of([&] {
      decode_points(chunk, {{LazItem::bytes, 30, 2}}, rows, options);
    });
    std::memcpy(&bytes[30], &count, 4);
    std::memcpy(&bytes[34], &layer, 4);
    return of_points + error_of([&] {
             decode_layers(chunk, {{LazItem::point14, 30, 3}}, rows, options);
           });
  };
  EXPECT_EQ(both(), "");
  std::stop_source source;
  options.stop = source.get_token();
  source.request_stop();
  EXPECT_EQ(both(), "6 cancelled6 cancelled");
}

}  // namespace cullhull::testing::io_laz_test
