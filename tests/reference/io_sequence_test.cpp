// Frames of moving points: arrays of three axes, window by window, and files one by one.
#include <cmath>
#include <filesystem>

#include "cullhull/generate.hpp"
#include "io/write/npy_writers.hpp"
#include "tests/io_fixtures.hpp"
#include "thrown.hpp"

namespace cullhull::testing::io_sequence_test {

namespace fs = std::filesystem;

class Sequence : public ::testing::Test {
 protected:
  Sequence()
      : folder_(fs::temp_directory_path() /
                ("cullhull-sequence-" + std::to_string(::getpid()) + "-" +
                 ::testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::create_directories(folder_);
  }
  ~Sequence() override { fs::remove_all(folder_); }

  std::string put(const std::string& name, const std::string& bytes) const {
    const std::string path = (folder_ / name).string();
    std::FILE* f = std::fopen(path.c_str(), "wb");
    std::fwrite(bytes.data(), 1, bytes.size(), f);
    std::fclose(f);
    return path;
  }
  static std::vector<Rows> read(PointSequence sequence) {
    std::vector<Rows> frames;
    while (sequence.next()) {
      EXPECT_EQ(sequence.index(), frames.size());
      frames.push_back(rows_of(sequence.points()));
    }
    EXPECT_EQ(frames.size(), sequence.frames());
    EXPECT_FALSE(sequence.next());
    return frames;
  }
  std::string refusal(const std::string& path) const {
    return error_of([&] { read(open_sequence({path})); });
  }

  fs::path folder_;
};

std::string array(const std::string& descr, const std::string& shape, const std::string& data,
                  const char* fortran = "False") {
  return npy(
      "{'descr': '" + descr + "', 'fortran_order': " + fortran + ", 'shape': (" + shape + "), }\n",
      data);
}

TEST_F(Sequence, ArraysOfThreeAxes) {
  const std::string path =
      put("a.npy", array("<f8", "3, 2, 1", bytes_of(1.0, 2.0, 3.0, 4.0, 5.0, 6.0)));
  EXPECT_EQ(read(open_sequence({path})), (std::vector<Rows>{{{1}, {2}}, {{3}, {4}}, {{5}, {6}}}));
  const std::string small = put(
      "b.npy", array("|u1", "2, 1, 2",
                     bytes_of(std::uint8_t{9}, std::uint8_t{8}, std::uint8_t{7}, std::uint8_t{6})));
  EXPECT_EQ(read(open_sequence({small})), (std::vector<Rows>{{{9, 8}}, {{7, 6}}}));
  const std::string wide =
      put("c.npy", array("<i8", "2, 1, 1", bytes_of(std::int64_t{-5}, std::int64_t{1} << 40)));
  EXPECT_EQ(read(open_sequence({wide})), (std::vector<Rows>{{{-5}}, {{0x1p40}}}));
  const std::string big =
      put("d.npy", array(">f8", "2, 1, 1", bytes_of_big_endian(1.5) + bytes_of_big_endian(-3.0)));
  EXPECT_EQ(read(open_sequence({big})), (std::vector<Rows>{{{1.5}}, {{-3}}}));
  EXPECT_EQ(read(open_sequence({put("e.npy", array("<f8", "0, 5, 3", ""))})).size(), 0U);
  EXPECT_EQ(read(open_sequence({put("f.npy", array("<f8", "4, 0, 3", ""))})),
            (std::vector<Rows>(4)));
}

TEST_F(Sequence, WhatArraysMayNotBe) {
  const std::string data = bytes_of(1.0, 2.0, 3.0, 4.0);
  EXPECT_TRUE(has(refusal(put("f.npy", array("<f8", "2, 2, 1", data, "True"))), "Fortran"));
  EXPECT_TRUE(has(refusal(put("s.npy", array("<f8", "3, 2, 1", data))), "needs more"));
  EXPECT_TRUE(has(refusal(put("l.npy", array("<f8", "1, 2, 1", data))), "after the array"));
  EXPECT_TRUE(has(refusal(put("o.npy", array("<f8", "4611686018427387904, 4, 2", data))), "needs"));
  EXPECT_TRUE(has(refusal(put("z.npy", array("<f8", "2, 2, 0", ""))), "dimension 0"));
  EXPECT_TRUE(has(refusal(put("x.npy", array("<f8", "1, 2, 2, 1", data))), "4 axes"));
  EXPECT_TRUE(has(refusal((folder_ / "none.npy").string()), "none.npy"));
  EXPECT_TRUE(has(refusal((folder_ / "q*.xyz").string()), "no file matches"));
  fs::create_directories(folder_ / "empty");
  EXPECT_TRUE(has(refusal((folder_ / "empty").string()), "without files"));
}

#if !defined(_WIN32)  // where a mapped file cannot be cut
TEST_F(Sequence, AFileThatShrinksIsAnError) {
  const std::string path =
      put("a.npy", array("<f8", "3, 2, 1", bytes_of(1.0, 2.0, 3.0, 4.0, 5.0, 6.0)));
  PointSequence sequence = open_sequence({path});
  EXPECT_TRUE(sequence.next());
  fs::resize_file(path, fs::file_size(path) - 8);
  EXPECT_TRUE(sequence.next());
  EXPECT_THROW(sequence.next(), Error);
}
#endif

TEST_F(Sequence, FilesInNaturalOrder) {
  fs::create_directories(folder_ / "frames");
  for (const int k : {10, 9, 1, 100})
    put("frames/f" + std::to_string(k) + ".xyz", std::to_string(k) + " 0\n");
  put("frames/.hidden", "not a frame");
  const std::vector<Rows> want{{{1, 0}}, {{9, 0}}, {{10, 0}}, {{100, 0}}};
  EXPECT_EQ(read(open_sequence({(folder_ / "frames").string()})), want);
  EXPECT_EQ(read(open_sequence({(folder_ / "frames/f*.xyz").string()})), want);
  EXPECT_EQ(read(open_sequence(
                {(folder_ / "frames/f9.xyz").string(), (folder_ / "frames/f1.xyz").string()})),
            (std::vector<Rows>{{{9, 0}}, {{1, 0}}}));
}

TEST_F(Sequence, WriterAndMotions) {
  const std::string path = (folder_ / "moving.npy").string();
  for (const Shape& motion : motions()) {
    const MovingPoints moving("bumpy", motion.name, 50, 3, 4, 3);
    std::vector<Rows> want;
    std::vector<double> frame(150);
    {
      internal::NpySequenceWriter writer(path, 4, 50, 3, ScalarType::f64);
      for (const std::uint64_t f : {0U, 1U, 2U, 3U}) {
        EXPECT_EQ(fs::exists(path), false) << "before the last frame";
        moving.frame(f, frame.data());
        writer.write(frame.data());
        want.push_back(rows_of(PointView::row_major(frame.data(), 50, 3)));
      }
      EXPECT_THROW(writer.write(frame.data()), Error);
    }
    EXPECT_EQ(read(open_sequence({path})), want) << motion.name;
    EXPECT_NE(want[1], want[2]) << motion.name;
    moving.frame(1, frame.data());  // frames do not depend on one another
    EXPECT_EQ(rows_of(PointView::row_major(frame.data(), 50, 3)), want[1]);
    const std::vector<double> rest = generate("bumpy", 50, 3, 3);
    if (std::string(motion.name) != "teleport") {
      for (std::size_t i = 0; i < 50; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          EXPECT_NEAR(want[0][i][j], rest[3 * i + j], 1e-15) << motion.name;
    }
    fs::remove(path);
  }
  EXPECT_THROW(MovingPoints("bumpy", "hop", 5, 3, 2), Error);
  EXPECT_THROW(MovingPoints("ball", "twist", 5, 1, 2), Error);
}

TEST(Motion, SpinKeepsDistances) {
  const MovingPoints moving("ball", "spin", 100, 4, 9, 2);
  std::vector<double> first(400), later(400);
  moving.frame(0, first.data());
  moving.frame(5, later.data());
  const auto distance = [](const std::vector<double>& p, std::size_t a, std::size_t b) {
    double sum = 0;
    for (std::size_t j = 0; j < 4; ++j) sum += std::pow(p[4 * a + j] - p[4 * b + j], 2);
    return std::sqrt(sum);
  };
  for (std::size_t i = 1; i < 100; ++i)
    EXPECT_NEAR(distance(first, 0, i), distance(later, 0, i), 1e-14);
}

}  // namespace cullhull::testing::io_sequence_test
