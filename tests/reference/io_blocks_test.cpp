// visit_blocks against open_points: the same points under the same ids, whatever the block size,
// the number of readers, and wherever a reading was cut off and taken up again.
#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <thread>

#include "cullhull/error.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/io.hpp"
#include "cullhull/point_blocks.hpp"
#include "io_fixtures.hpp"

namespace cullhull::testing::io_blocks_test {

/// Row by id, of blocks that come from several threads. An id twice, or none, is a failure.
class Collected {
 public:
  BlockVisitor visitor() {
    BlockVisitor v;
    v.points = [this](const PointView& block, std::uint64_t first) {
      const std::lock_guard lock(mutex_);
      rows_.resize(std::max<std::size_t>(rows_.size(), first + block.count));
      for (std::uint64_t i = 0; i < block.count; ++i) {
        std::vector<double>& row = rows_[first + i];
        EXPECT_TRUE(row.empty()) << "point " << first + i << " twice";
        for (std::uint32_t j = 0; j < block.dimension; ++j) row.push_back(block.at(i, j));
      }
    };
    return v;
  }
  const Rows& rows() const { return rows_; }

 private:
  std::mutex mutex_;
  Rows rows_;
};

Rows all_rows(const std::vector<std::string>& files) {
  Rows all;
  for (const std::string& file : files)
    for (std::vector<double>& row : rows_of(open_points(file).points())) all.push_back(row);
  return all;
}

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", v);
  return text;
}

/// The same kind of points in every format there is, unequal numbers of them.
std::vector<std::string> write_all_formats(const TemporaryFolder& folder) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name, const std::string& bytes) {
    names.push_back(folder.write(name, bytes));
  };
  const auto rows = [](std::uint64_t n, std::uint64_t seed) {
    std::vector<double> r = generate("ball", n, 3, seed);
    for (double& v : r) v = static_cast<float>(v);
    return r;
  };
  const auto lines = [&](const std::vector<double>& r, const char* before, char separator) {
    std::string text;
    for (std::size_t i = 0; i < r.size(); i += 3)
      text += before + number(r[i]) + separator + number(r[i + 1]) + separator + number(r[i + 2]) +
              "\n";
    return text;
  };
  const std::vector<double> a = rows(257, 1), b = rows(100, 2), c = rows(64, 3), e = rows(31, 4);
  names.push_back(folder.file("a.npy"));
  write_npy_points(names.back(), a.data(), 257, 3, ScalarType::f32);
  add("b.xyz", "# a comment\n" + lines(b, "", ' ') + "\n# the end");
  add("c.csv", "x,y,z\n" + lines(c, "", ','));
  add("d.obj", lines(e, "v ", ' '));
  names.push_back(folder.file("e.ply"));
  std::vector<std::uint64_t> ids(100);
  for (std::size_t i = 0; i < 100; ++i) ids[i] = i;
  write_points(names.back(), PointView::row_major(b.data(), 100, 3), ids);
  add("f.txt", "3 as Qhull has it\n64\n" + lines(c, "", ' '));
  names.push_back(folder.file("g.npy"));
  write_npy_points(names.back(), a.data(), 1, 3, ScalarType::f64);
  names.push_back(folder.file("h.npy"));
  write_npy_points(names.back(), nullptr, 0, 3, ScalarType::f64);
  names.push_back(folder.file("i.npy"));
  write_npy_points(names.back(), e.data(), 31, 3, ScalarType::f64);
  return names;
}

TEST(IoBlocks, TheSamePointsWhateverTheBlocks) {
  const TemporaryFolder folder;
  const std::vector<std::string> files = write_all_formats(folder);
  const Rows expected = all_rows(files);
  for (const std::size_t block : {std::size_t{1}, std::size_t{100}, std::size_t{1} << 20})
    for (const unsigned readers : {1U, 2U, 7U}) {
      SCOPED_TRACE(std::to_string(block) + " bytes, " + std::to_string(readers) + " readers");
      Collected found;
      BlockOptions options;
      options.block_bytes = block;
      options.readers = readers;
      const BlockSummary summary = visit_blocks(files, found.visitor(), options);
      EXPECT_EQ(found.rows(), expected);
      EXPECT_EQ(summary.end.points, expected.size());
      EXPECT_EQ(summary.end.bytes, input_bytes(files));
      EXPECT_EQ(summary.dimension, 3U);
      EXPECT_EQ(summary.scalar, ScalarType::f64);
    }
}

// Whatever position a pause has told, reading from there gives all that had not been visited.
TEST(IoBlocks, GoesOnFromEveryPause) {
  const TemporaryFolder folder;
  const std::vector<std::string> files = write_all_formats(folder);
  const Rows expected = all_rows(files);
  Collected first;
  BlockOptions options;
  options.block_bytes = 200;
  options.readers = 3;
  BlockVisitor visitor = first.visitor();
  const auto collect = visitor.points;
  visitor.points = [&](const PointView& block, std::uint64_t id) {
    collect(block, id);
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  };
  std::vector<std::pair<BlockPosition, std::size_t>> pauses;
  visitor.pause_seconds = 0;
  visitor.pause = [&](const BlockPosition& at) { pauses.push_back({at, first.rows().size()}); };
  visit_blocks(files, visitor, options);
  EXPECT_EQ(first.rows(), expected);
  ASSERT_GT(pauses.size(), 1U);
  for (const auto& [position, seen] : pauses) {
    EXPECT_EQ(position.points, seen);
    Collected rest;
    BlockOptions later;
    later.block_bytes = 333;
    later.readers = 2;
    later.from = position;
    const BlockSummary summary = visit_blocks(files, rest.visitor(), later);
    EXPECT_EQ(summary.end.points, expected.size());
    EXPECT_EQ(summary.end.bytes, input_bytes(files));
    for (std::size_t i = 0; i < expected.size(); ++i) {
      if (i < seen) {
        ASSERT_TRUE(i >= rest.rows().size() || rest.rows()[i].empty()) << i << " again";
      } else {
        ASSERT_EQ(rest.rows()[i], expected[i]) << i;
      }
    }
  }
}

TEST(IoBlocks, StopsAtTheErrorOfTheLowestBlock) {
  const TemporaryFolder folder;
  std::string text;
  for (int i = 0; i < 1000; ++i) text += i == 700 || i == 900 ? "1 2\n" : "1 2 3\n";
  const std::vector<std::string> files{folder.write("a.xyz", text)};
  for (int round = 0; round < 20; ++round) {
    BlockOptions options;
    options.block_bytes = 64;
    options.readers = 6;
    EXPECT_TRUE(
        has(error_of(ErrorCode::bad_file, [&] { visit_blocks(files, no_visitor(), options); }),
            "a.xyz:701: "));
  }
}

// Line ends are counted in vectors of bytes, which hold no more than 255 each.
TEST(IoBlocks, LinesOfEarlierBlocksAreCounted) {
  const TemporaryFolder folder;
  for (const int empty : {0, 1, 63, 64, 300, 16319, 16320, 16384, 100000}) {
    const std::string text =
        "1 2 3\n" + std::string(static_cast<std::size_t>(empty), '\n') + "4 5 6\n7 8 9\n1 2\n";
    const std::vector<std::string> files{folder.write("a.xyz", text)};
    BlockOptions options;
    options.block_bytes = 30000;
    EXPECT_TRUE(
        has(error_of(ErrorCode::bad_file, [&] { visit_blocks(files, no_visitor(), options); }),
            "a.xyz:" + std::to_string(empty + 4) + ": "));
  }
}

TEST(IoBlocks, MixedDimensionsAreToldOfTheLowestBlockThatDiffers) {
  const TemporaryFolder folder;
  std::vector<std::string> files;  // arrays, whose blocks are loaded in any order
  const std::vector<double> numbers = generate("ball", 20000, 3, 1);
  for (const std::uint32_t d : {3, 3, 2, 2, 3}) {
    files.push_back(folder.file("part-" + std::to_string(files.size()) + ".npy"));
    const std::uint64_t count = files.size() == 1 ? 20000 : 10;  // the first ones take longest
    write_npy_points(files.back(), numbers.data(), count, d, ScalarType::f64);
  }
  for (unsigned round = 0; round < 1000; ++round) {
    BlockOptions options;
    options.readers = 2 + round % 4;
    EXPECT_TRUE(
        has(error_of(ErrorCode::bad_file, [&] { visit_blocks(files, no_visitor(), options); }),
            "part-2.npy: points of dimension 2, but of 3 in", "part-0.npy"));
  }
}

TEST(IoBlocks, CancelledWithAPositionToGoOnFrom) {
  const TemporaryFolder folder;
  const std::vector<std::string> files = write_all_formats(folder);
  std::stop_source stop;
  std::atomic<std::uint64_t> visited{0};
  BlockVisitor visitor;
  visitor.points = [&](const PointView& block, std::uint64_t) {
    visited += block.count;
    if (visited > 50) stop.request_stop();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  };
  BlockPosition told;
  visitor.pause = [&](const BlockPosition& at) { told = at; };
  BlockOptions options;
  options.block_bytes = 64;
  options.read.stop = stop.get_token();
  error_of(ErrorCode::cancelled, [&] { visit_blocks(files, visitor, options); });
  EXPECT_EQ(told.points, visited);
  EXPECT_GT(told.points, 50U);
}

TEST(IoBlocks, PromisesThatAreNotKept) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& name, const std::string& bytes) {
    const std::string path = folder.write(name, bytes);
    return error_of(ErrorCode::bad_file, [&] { visit_blocks({path}, no_visitor(), {}); });
  };
  EXPECT_TRUE(has(error("a.txt", "3\n4\n1 2 3\n4 5 6\n1 1 1\n"), "promises 4 points, but 3"));
  EXPECT_TRUE(has(error("b.npy", "\x93NUMPY"), "b.npy: byte 0"));
  EXPECT_TRUE(has(error("c.xyz", ""), "c.xyz: empty file"));
  EXPECT_TRUE(has(error("d.hullstate", "no state"), "d.hullstate: hull state: too short"));
  BlockOptions raw;
  raw.read.format = "raw";
  raw.read.raw_dimension = 2;
  raw.read.raw_scalar = ScalarType::f32;
  EXPECT_THROW(visit_blocks({folder.write("e.raw", "123456789")}, no_visitor(), raw), Error);
}

TEST(IoBlocks, StatesAreFiles) {
  const TemporaryFolder folder;
  const std::vector<double> rows = generate("ball", 500, 3, 1);
  const HullState state(PointView::row_major(rows.data(), 500, 3), 7);
  write_state(folder.file("a.hullstate"), state);
  EXPECT_EQ(read_state(folder.file("a.hullstate")), state);
  EXPECT_THROW(write_state(folder.file("a.npy"), state), Error);
  BlockVisitor visitor = no_visitor();
  EXPECT_THROW(visit_blocks({folder.file("a.hullstate")}, visitor, {}), Error);
  std::uint64_t first_id = 1;
  visitor.state = [&](const HullState& read, std::uint64_t first) {
    EXPECT_EQ(read, state);
    first_id = first;
  };
  EXPECT_EQ(visit_blocks({folder.file("a.hullstate")}, visitor, {}).end.points, 500U);
  EXPECT_EQ(first_id, 0U);
}

}  // namespace cullhull::testing::io_blocks_test
