// The memory that reading takes: its limit, what an opened file holds, and cancellation between
// pieces of work. Pipes whose beginning was read ahead.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <thread>

#include "call_options.hpp"
#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "cullhull/point_blocks.hpp"
#include "io_fixtures.hpp"

namespace cullhull::io_memory_test {

using namespace testing_support;

std::string rows_of_text(std::size_t n) {
  std::string text;
  for (std::size_t i = 0; i < n; ++i) text += std::to_string(i) + " 0 1\n";
  return text;
}

std::string refusal(const std::string& path, const ReadOptions& options) {
  return error_of(ErrorCode::out_of_budget, [&] { (void)open_points(path, options); });
}

TEST(IoMemory, ParsedPointsMustFitTheBudget) {
  const testing::TemporaryFolder folder;
  const std::string text = folder.write("a.xyz", rows_of_text(1000));
  ReadOptions options;
  options.memory_budget = 1000 * 3 * sizeof(double);
  EXPECT_EQ(open_points(text, options).held_bytes(), options.memory_budget);
  --options.memory_budget;
  EXPECT_TRUE(has(refusal(text, options), "the memory budget is 23999 bytes"));
  options.blocks_hint = "blocks are smaller";
  EXPECT_TRUE(refusal(text, options).ends_with("; blocks are smaller"));
  // Formats that are read whole need the memory in any case.
  std::string obj;
  for (int i = 0; i < 1000; ++i) obj += "v 1 2 3\n";
  EXPECT_FALSE(has(refusal(folder.write("a.obj", obj), options), "blocks"));
}

TEST(IoMemory, ARemarkIsMadeOnce) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.write("a.csv", "id,a,b\n0,1,2\n1,3,4\n2,4,4\n");
  int remarks = 0;
  ReadOptions options;
  options.remark = [&](const Remark&) { ++remarks; };
  (void)open_points(path, options);
  EXPECT_EQ(remarks, 1);
}

TEST(IoMemory, MappedPointsTakeNone) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.write("a.npy", "");
  const std::vector<double> rows(3000);
  write_npy_points(path, rows.data(), 1000, 3, ScalarType::f64);
  ReadOptions options;
  options.memory_budget = 1;
  const PointFile file = open_points(path, options);
  EXPECT_EQ(file.points().count, 1000U);
  EXPECT_EQ(file.held_bytes(), 0U);
}

#if !defined(_WIN32)  // a pipe has no name there that a file could have
/// A named pipe that delivers these bytes once.
class Pipe {
 public:
  Pipe(const testing::TemporaryFolder& folder, std::string bytes)
      : path_(folder.file("pipe")), bytes_(std::move(bytes)) {
    std::remove(path_.c_str());
    EXPECT_EQ(::mkfifo(path_.c_str(), 0600), 0);
    writer_ = std::thread([this] { std::ofstream(path_, std::ios::binary) << bytes_; });
  }
  ~Pipe() { writer_.join(); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_, bytes_;
  std::thread writer_;
};

TEST(IoMemory, APipeIsReadAheadAndThenFromItsBeginning) {
  const testing::TemporaryFolder folder;
  const Options options;
  for (const std::size_t rows : {std::size_t{1}, std::size_t{1000}, std::size_t{400000}}) {
    const std::string text = rows_of_text(rows);
    const bool many = text.size() > BlockOptions().block_bytes;
    {
      const Pipe pipe(folder, text);
      EXPECT_EQ(worth_streaming({pipe.path()}, options), many);
      EXPECT_EQ(worth_streaming({pipe.path()}, options), many) << "asked again";
      const PointFile file = open_points(pipe.path());
      EXPECT_EQ(file.points().count, rows);
      EXPECT_EQ(file.points().at(rows - 1, 0), static_cast<double>(rows - 1));
    }
    const Pipe pipe(folder, text);
    EXPECT_EQ(worth_streaming({pipe.path()}, options), many);
    std::atomic<std::uint64_t> seen{0};
    BlockVisitor visitor;
    visitor.points = [&](const PointView& block, std::uint64_t) { seen += block.count; };
    EXPECT_EQ(visit_blocks({pipe.path()}, visitor).end.points, rows);
    EXPECT_EQ(seen, rows);
  }
}

TEST(IoMemory, AnIdlePipeHearsAStop) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("pipe");
  std::remove(path.c_str());
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const int writer = ::open(path.c_str(), O_RDWR);
  const ReadOptions options = stopped<ReadOptions>();
  error_of(ErrorCode::cancelled, [&] { (void)open_points(path, options); });
  ::close(writer);
}
#endif

TEST(IoMemory, PlacingTheNumbersOfAScanCanBeCancelled) {
  const testing::TemporaryFolder folder;
  std::string las(227 + 20, '\0');
  las.replace(0, 4, "LASF");
  las[24] = 1;
  las[25] = 2;
  las[94] = static_cast<char>(227);
  las[96] = static_cast<char>(227);
  las[105] = 20;
  las[107] = 1;
  const double scale = 0.01;
  for (std::size_t j = 0; j < 3; ++j)
    las.replace(131 + 8 * j, 8, reinterpret_cast<const char*>(&scale), 8);
  std::stop_source stop;
  ReadOptions options;
  options.stop = stop.get_token();
  const std::string path = folder.write("a.las", las);
  EXPECT_EQ(open_points(path, options).points().count, 1U);
  stop.request_stop();
  error_of(ErrorCode::cancelled, [&] { (void)open_points(path, options); });
}

}  // namespace cullhull::io_memory_test
