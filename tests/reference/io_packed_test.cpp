// .gz, .zst and .npz: the points of what is in them, in memory and in blocks; what is cut short,
// corrupt or lies about its size is refused in one line; and a bomb stays within the budget.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <mutex>

#include "cullhull/error.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/io.hpp"
#include "cullhull/point_blocks.hpp"
#include "cullhull/triangulation_io.hpp"
#include "io/records.hpp"
#include "tests/io_fixtures.hpp"
#include "thrown.hpp"
#if __has_include(<zlib.h>) && __has_include(<zstd.h>)
#include <zlib.h>
#include <zstd.h>

namespace cullhull::testing::io_packed_test {

std::string deflated(const std::string& bytes, int bits, int level = 6) {
  z_stream z{};
  EXPECT_EQ(deflateInit2(&z, level, Z_DEFLATED, bits, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string out(deflateBound(&z, bytes.size()) + 64, '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&z, Z_FINISH), Z_STREAM_END);
  out.resize(z.total_out);
  deflateEnd(&z);
  return out;
}

std::string gz(const std::string& bytes) { return deflated(bytes, 31); }

std::string zst(const std::string& bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 3);
  EXPECT_EQ(ZSTD_isError(size), 0U);
  out.resize(size);
  return out;
}

std::string little(std::uint64_t value, int bytes) {
  std::string out;
  for (int i = 0; i < bytes; ++i) out += static_cast<char>(value >> 8 * i & 255);
  return out;
}

struct Member {
  std::string name, bytes;
  bool deflate = false;
};

/// A ZIP archive as numpy.savez and numpy.savez_compressed write it.
std::string zip(const std::vector<Member>& members, bool wide = false) {
  std::string out, central;
  for (const Member& m : members) {
    const std::string data = m.deflate ? deflated(m.bytes, -15) : m.bytes;
    const std::uint64_t crc =
        crc32(0, reinterpret_cast<const Bytef*>(m.bytes.data()), static_cast<uInt>(m.bytes.size()));
    const std::string common = little(20, 2) + little(0, 2) + little(m.deflate ? 8 : 0, 2) +
                               little(33 << 16, 4) + little(crc, 4);
    const std::string sizes =
        wide ? little(~0ULL, 8) : little(data.size(), 4) + little(m.bytes.size(), 4);
    const std::string extra =
        wide ? little(1, 2) + little(16, 2) + little(m.bytes.size(), 8) + little(data.size(), 8)
             : "";
    central += "PK\x01\x02" + little(20, 2) + common + sizes + little(m.name.size(), 2) +
               little(extra.size(), 2) + std::string(10, '\0') + little(out.size(), 4) + m.name +
               extra;
    out += "PK\x03\x04" + common + sizes + little(m.name.size(), 2) + little(extra.size(), 2) +
           m.name + extra + data;
  }
  return out + central + "PK\x05\x06" + little(0, 4) + little(members.size(), 2) +
         little(members.size(), 2) + little(central.size(), 4) + little(out.size(), 4) +
         little(0, 2);
}

class Files : public ::testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& bytes) {
    return folder_.write(name, bytes);
  }
  TemporaryFolder folder_;
};

Rows in_memory(const std::string& path, const ReadOptions& options = {}) {
  return rows_of(open_points(path, options).points());
}

/// What both ways say of a file, which must name it; without the name.
std::string refused(const std::string& path, ErrorCode code = ErrorCode::bad_file) {
  const std::string whole = error_of(code, [&] { (void)open_points(path); });
  const std::string blocks = error_of(code, [&] { (void)rows_in_blocks(path); });
  EXPECT_EQ(whole, blocks);
  EXPECT_EQ(whole.rfind(path, 0), 0U) << whole;
  return whole.substr(std::min(whole.size(), path.size()));
}

/// Points of 3D as an .npy file.
std::string npy_of(const std::vector<double>& rows, std::uint64_t n) {
  return internal::npy_header("<f8", {n, 3}) +
         std::string(reinterpret_cast<const char*>(rows.data()), 8 * rows.size());
}

/// A table of the same points in several formats, by their endings.
std::map<std::string, std::string> formats(std::uint64_t n) {
  const std::vector<double> p = generate("ball", n, 3, 9);
  std::map<std::string, std::string> f;
  f["npy"] = npy_of(p, n);
  f["csv"] = "x,y,z,w\n";
  f["obj"] = "";
  f["ply"] = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(n) +
             "\nproperty double x\nproperty double y\nproperty double z\nend_header\n" +
             std::string(reinterpret_cast<const char*>(p.data()), 8 * p.size());
  for (std::uint64_t i = 0; i < n; ++i) {
    char line[120];
    std::snprintf(line, sizeof line, "%.17g,%.17g,%.17g", p[3 * i], p[3 * i + 1], p[3 * i + 2]);
    f["csv"] += std::string(line) + ",word\n";
    std::replace(line, line + std::strlen(line), ',', ' ');
    f["obj"] += "v " + std::string(line) + "\n";
  }
  return f;
}

TEST_F(Files, EveryFormatCompressed) {
  const auto of = formats(3000);
  const Rows want = in_memory(file("plain.npy", of.at("npy")));
  ASSERT_EQ(want.size(), 3000U);
  for (const auto& [ending, bytes] : of) {
    const std::vector<std::pair<std::string, std::string>> packed{
        {".gz", gz(bytes)},
        {".zst", zst(bytes)},
        {".GZ", gz(bytes.substr(0, 1000)) + gz(bytes.substr(1000)) + std::string(512, '\0')},
        {".zst", zst(bytes.substr(0, 777)) + std::string("\x50\x2A\x4D\x18\x02\0\0\0ab", 10) +
                     zst(bytes.substr(777))}};
    for (const auto& [suffix, content] : packed) {
      const std::string path = file("p." + ending + suffix, content);
      EXPECT_EQ(in_memory(path), want) << path;
      EXPECT_EQ(rows_in_blocks(path), want) << path;
      EXPECT_FALSE(open_points(path).mapped());
    }
    // Without a name that tells, content does: of the compression and of what is in it.
    EXPECT_EQ(in_memory(file("nameless", packed[0].second)), want) << ending;
    EXPECT_EQ(rows_in_blocks(file("nameless", packed[1].second)), want) << ending;
  }
}

TEST_F(Files, CompressedRawNumbersAndNumbersThatLookCompressed) {
  ReadOptions raw;
  raw.raw_dimension = 2;
  raw.raw_scalar = ScalarType::u8;
  const std::string numbers("\x1F\x8B\x08\x00", 4);
  const Rows want{{0x1F, 0x8B}, {8, 0}};
  EXPECT_EQ(in_memory(file("p.raw", numbers), raw), want);
  EXPECT_EQ(rows_in_blocks(file("p.bin", numbers), raw), want);
  EXPECT_EQ(in_memory(file("p.raw.gz", gz(numbers)), raw), want);
  EXPECT_EQ(rows_in_blocks(file("p.raw.gz", gz(numbers)), raw), want);
}

/// A stream's chunk table is at its end: it is read whole, and placed as other scans are.
TEST_F(Files, CompressedLaz) {
  for (const char* name : {"format-3", "format-8", "variable"}) {
    const std::string laz = std::string(CULLHULL_ROOT) + "/fuzz/corpus/laz/" + name + ".laz";
    const Rows want = in_memory(laz);
    ASSERT_EQ(want.size(), 240U);
    const std::string packed = file("p.laz.gz", gz(slurp(laz)));
    EXPECT_EQ(in_memory(packed), want);
    EXPECT_EQ(rows_in_blocks(packed), want);
  }
}

TEST_F(Files, CompressedPolygons) {
  const std::string plain = R"({"type": "Polygon", "coordinates": [[[0,0],[4,0],[0,4],[0,0]]]})";
  const Polygons want = read_polygons(file("p.geojson", plain));
  for (const auto& [suffix, whole] : {std::pair{".gz", gz(plain)}, std::pair{".zst", zst(plain)}}) {
    const Polygons polygons = read_polygons(file(std::string("p.geojson") + suffix, whole));
    EXPECT_EQ(polygons.corners, want.corners);
    EXPECT_EQ(polygons.ring_offsets, want.ring_offsets);
    const std::string cut = file(std::string("c.geojson") + suffix, whole.substr(0, 20));
    EXPECT_THROW(read_polygons(cut), Error);
  }
}

TEST_F(Files, CutShortAtEveryByte) {
  const std::string bytes = "x,y\n1,2\n3,4\n5,6\n";
  for (const auto& [suffix, whole] : {std::pair{".gz", gz(bytes)}, std::pair{".zst", zst(bytes)}})
    for (std::size_t size = 4; size < whole.size(); ++size)
      EXPECT_EQ(refused(file(std::string("p.csv") + suffix, whole.substr(0, size))),
                ": is cut short: it ends within its compressed bytes")
          << suffix << size;
  EXPECT_EQ(refused(file("p.csv.gz", "x,y\n1,2\n")), ": does not begin as a .gz file does");
  EXPECT_EQ(refused(file("p.csv.zst", gz(bytes).substr(0, 1))),
            ": does not begin as a .zst file does");
  EXPECT_EQ(refused(file("p.csv.gz", gz(""))), ": empty file");
}

TEST_F(Files, EveryBitOfThemCorrupt) {
  const std::string bytes = formats(40).at("npy");
  unsigned refusals = 0;
  for (const auto& [suffix, whole] : {std::pair{".gz", gz(bytes)}, std::pair{".zst", zst(bytes)},
                                      std::pair{".npz", zip({{"a.npy", bytes, true}})}})
    for (std::size_t bit = 0; bit < 8 * whole.size(); bit += 11) {
      std::string broken = whole;
      broken[bit / 8] = static_cast<char>(broken[bit / 8] ^ 1 << bit % 8);
      const std::string path = file(std::string("p.npy") + suffix, broken);
      for (const bool blocks : {false, true}) try {
          blocks ? (void)rows_in_blocks(path) : (void)in_memory(path);
        } catch (const Error& e) {
          ++refusals;
          EXPECT_TRUE(e.code() == ErrorCode::bad_file || e.code() == ErrorCode::invalid_argument ||
                      e.code() == ErrorCode::out_of_budget)
              << e.what();
          EXPECT_FALSE(has(e.what(), "\n"));
        }
    }
  EXPECT_GT(refusals, 400U);
}

TEST_F(Files, ABombStaysWithinTheBudget) {
  const std::string zeros(std::size_t{64} << 20, '\0');
  std::string bytes = internal::npy_header("<f8", {zeros.size() / 24, 3});
  bytes += std::string(zeros.size() / 24 * 24, '\0');
  for (const auto& [name, content] :
       {std::pair{"p.npy.gz", gz(bytes)}, std::pair{"p.npy.zst", zst(bytes)},
        std::pair{"p.npz", zip({{"a.npy", bytes, true}})}}) {
    const std::string path = file(name, content);
    EXPECT_LT(content.size(), std::size_t{1} << 17) << name;
    ReadOptions options;
    options.memory_budget = std::uint64_t{16} << 20;
    const std::string said =
        error_of(ErrorCode::out_of_budget, [&] { (void)open_points(path, options); });
    EXPECT_TRUE(has(said, "MiB"));
    std::uint64_t points = 0;
    std::mutex mutex;
    BlockVisitor visitor;
    visitor.points = [&](const PointView& block, std::uint64_t) {
      const std::lock_guard lock(mutex);
      points += block.count;
    };
    BlockOptions blocks;
    blocks.read = options;
    visit_blocks({path}, visitor, blocks);
    EXPECT_EQ(points, zeros.size() / 24);
  }
}

TEST_F(Files, UnpackingIsCancelled) {
  const std::string bytes = formats(100)["npy"];
  stop_source stop;
  ReadOptions options;
  options.stop = stop.get_token();
  const std::string paths[] = {file("p.npy.gz", gz(bytes)), file("p.npy.zst", zst(bytes)),
                               file("p.npz", zip({{"a.npy", bytes, true}}))};
  for (const std::string& path : paths)
    EXPECT_EQ(open_points(path, options).points().count, 100U) << path;
  stop.request_stop();
  for (const std::string& path : paths)
    (void)error_of(ErrorCode::cancelled, [&] { (void)open_points(path, options); });
}

TEST_F(Files, ArraysOfAnArchive) {
  const std::string a = npy_of({1, 2, 3, 4, 5, 6}, 2), b = npy_of({7, 8, 9}, 1);
  const Rows rows_a{{1, 2, 3}, {4, 5, 6}}, rows_b{{7, 8, 9}};
  for (const bool deflate : {false, true})
    for (const bool wide : {false, true}) {
      const std::string one = file("one.npz", zip({{"a.npy", a, deflate}}, wide));
      const std::string two = file(
          "two.NPZ",
          zip({{"a.npy", a, deflate}, {"notes.txt", "?", false}, {"b.npy", b, deflate}}, wide));
      for (const auto& read :
           {std::function([](const std::string& p) { return in_memory(p); }),
            std::function([](const std::string& p) { return rows_in_blocks(p); })}) {
        EXPECT_EQ(read(one), rows_a);
        EXPECT_EQ(read(one + ":a"), rows_a);
        EXPECT_EQ(read(two + ":a.npy"), rows_a);
        EXPECT_EQ(read(two + ":b"), rows_b);
      }
      EXPECT_EQ(open_points(one).mapped(), !deflate);
      EXPECT_EQ(refused(two, ErrorCode::invalid_argument),
                ": holds the arrays 'a', 'b'; say which as FILE.npz:NAME");
      EXPECT_EQ(error_of(ErrorCode::invalid_argument, [&] { (void)in_memory(two + ":c"); }),
                two + ": no array 'c'; there are 'a', 'b'");
    }
  EXPECT_EQ(refused(file("none.npz", zip({{"notes.txt", "?", false}}))),
            ": an archive without an array (.npy)");
  EXPECT_EQ(refused(file("none.npz", zip({}))), ": an archive without an array (.npy)");
}

TEST_F(Files, ArchivesThatLie) {
  const std::string whole = zip({{"a.npy", npy_of({1, 2, 3}, 1), false}});
  for (std::size_t size = 1; size < whole.size(); ++size)
    EXPECT_NE(refused(file("p.npz", whole.substr(0, size))), "") << size;
  const auto changed = [&](std::size_t from_end, std::uint64_t value, int bytes) {
    std::string broken = whole;
    broken.replace(broken.size() - from_end, static_cast<std::size_t>(bytes), little(value, bytes));
    return refused(file("p.npz", broken));
  };
  EXPECT_TRUE(has(changed(6, 0xFFFFFFF0, 4), "is cut short, or no archive"));
  EXPECT_TRUE(has(changed(10, 0xFFFFFFF0, 4), "directory of"));
  EXPECT_TRUE(has(changed(12, 9, 2), "directory is cut short or corrupt"));
}

TEST_F(Files, SeveralInputsOfWhichSomeArePacked) {
  const std::string a = npy_of({1, 2, 3, 4, 5, 6}, 2), b = npy_of({7, 8, 9}, 1);
  std::vector<std::string> files =
      input_files({file("a.npz", zip({{"p.npy", a, true}, {"q.npy", b, true}})) + ":p",
                   file("b.npy.gz", gz(b))});
  EXPECT_EQ(files.size(), 2U);
  EXPECT_GT(input_bytes(files), 0U);
  EXPECT_TRUE(worth_streaming(files, {}));
  files = input_files({folder_.file("*.npz:q")});
  EXPECT_EQ(files, (std::vector<std::string>{folder_.file("a.npz:q")}));
  EXPECT_EQ(file_of_input(files[0]), folder_.file("a.npz"));
  EXPECT_EQ(in_memory(files[0]), (Rows{{7, 8, 9}}));
}

}  // namespace cullhull::testing::io_packed_test
#endif
