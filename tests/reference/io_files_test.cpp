// Opening and writing: what the operating system is involved in.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#if !defined(_WIN32)
#include <signal.h>
#endif

#include <cstdlib>
#include <thread>

#include "cullhull/hull.hpp"
#include "io/mapped_file.hpp"
#include "io/write/output_file.hpp"
#include "tests/io_fixtures.hpp"
#include "thrown.hpp"

namespace cullhull::testing::io_files_test {

TEST(Open, RefusalsOfTheSystem) {
  const TemporaryFolder folder;
  const std::string missing = folder.file("none.npy");
  EXPECT_EQ(error_of(ErrorCode::io, [&] { open_points(missing); }),
            missing + ": cannot open: No such file or directory");
  EXPECT_TRUE(has(error_of(ErrorCode::io, [&] { open_points(folder.file("")); }), "directory"));
  EXPECT_FALSE(has(error_of(ErrorCode::io, [&] { open_points(folder.file("a\nb")); }), "\n"));
#if !defined(_WIN32)  // where a file can be locked against writing alone
  const std::string locked = folder.write("locked.txt", "1 2\n");
  chmod(locked.c_str(), 0);
  if (access(locked.c_str(), R_OK) != 0) {  // root may read everything
    const std::string message = error_of(ErrorCode::io, [&] { open_points(locked); });
    EXPECT_TRUE(has(message, "Permission denied"));
  }
#endif
}

TEST(Open, EmptyFile) {
  const TemporaryFolder folder;
  for (const char* name : {"a.npy", "a.ply", "a.obj", "a.off", "a.stl", "a.xyz", "a.csv", "a"}) {
    const std::string path = folder.write(name, "");
    EXPECT_EQ(error_of(ErrorCode::bad_file, [&] { open_points(path); }), path + ": empty file");
  }
  error_of(ErrorCode::bad_file, [&] { hull_from_json(folder.write("a.json", "")); });
}

TEST(Open, FormatByExtensionThenContent) {
  const TemporaryFolder folder;
  EXPECT_EQ(open_points(folder.write("a.XYZ", "1 2 3\n")).format(), "xyz");
  EXPECT_EQ(open_points(folder.write("b", "v 1 2 3\n")).format(), "obj");
  EXPECT_EQ(open_points(folder.write("c", "OFF\n1 0 0\n1 2 3\n")).format(), "off");
  EXPECT_EQ(open_points(folder.write("d.unknown", "solid\nendsolid\n")).format(), "stl (ASCII)");
  EXPECT_EQ(open_points(folder.write("e", "# c\n1 2 3\n")).format(), "text");
  EXPECT_EQ(open_points(folder.write("f",
                                     "ply\nformat ascii 1.0\nelement vertex 0\nproperty int "
                                     "x\nproperty int y\nend_header\n"))
                .format(),
            "ply (ASCII)");
  EXPECT_EQ(
      open_points(folder.write("g", npy("{'descr':'|u1','fortran_order':False,'shape':(1,)}", "a")))
          .format(),
      "npy");
  // The extension wins over the content.
  error_of(ErrorCode::bad_file, [&] { open_points(folder.write("h.npy", "1 2 3\n")); });
  const std::string zeros = folder.write("i", std::string(100, '\0'));
  EXPECT_TRUE(has(error_of(ErrorCode::bad_file, [&] { open_points(zeros); }), "raw numbers"));
  EXPECT_TRUE(
      has(error_of(ErrorCode::bad_file, [&] { open_points(folder.write("j", "{\"a\": 1}")); }),
          "JSON"));
  ReadOptions options;
  options.format = "dwg";
  error_of(ErrorCode::invalid_argument, [&] { open_points(folder.file("c"), options); });
}

TEST(Open, Raw) {
  const TemporaryFolder folder;
  ReadOptions options;
  options.raw_dimension = 3;
  options.raw_scalar = ScalarType::i16;
  const std::string path =
      folder.write("a", bytes_of(std::int16_t{1}, std::int16_t{-2}, std::int16_t{3}));
  const PointFile file = open_points(path, options);
  EXPECT_EQ(file.mapped(), lies_ready);
  EXPECT_EQ(rows_of(file.points()), (Rows{{1, -2, 3}}));
  const std::string shorter = folder.write("b.raw", std::string(13, 'x'));
  EXPECT_EQ(error_of(ErrorCode::bad_file, [&] { open_points(shorter, options); }),
            shorter + ": byte 12: ends within a point: one takes 6 bytes");
  error_of(ErrorCode::invalid_argument, [&] { open_points(shorter); });
}

/// Number of the point in the file, in both orders of .npy, raw, or text.
std::string numbered_points(const TemporaryFolder& folder, const std::string& kind,
                            std::uint64_t count) {
  std::vector<double> numbers(2 * count);
  std::string text;
  for (std::uint64_t i = 0; i < count; ++i) {
    numbers[2 * i] = numbers[2 * i + 1] = static_cast<double>(i);
    text += std::to_string(i) + " " + std::to_string(i) + "\n";
  }
  if (kind == "fortran.npy")
    for (std::uint64_t i = 0; i < 2 * count; ++i) numbers[i] = static_cast<double>(i % count);
  std::string bytes(reinterpret_cast<const char*>(numbers.data()), 16 * count);
  const std::string shape = "'shape':(" + std::to_string(count) + ",2)}";
  if (kind == "rows.npy") bytes = npy("{'descr':'<f8','fortran_order':False," + shape, bytes);
  if (kind == "fortran.npy") bytes = npy("{'descr':'<f8','fortran_order':True," + shape, bytes);
  return folder.write(kind, kind == "text.xyz" ? text : bytes);
}

TEST(Open, PartsAreTheWholeFile) {
  const TemporaryFolder folder;
  for (const std::string kind : {"rows.npy", "fortran.npy", "points.raw", "text.xyz"})
    for (const std::uint64_t count : {1, 2, 7, 30000}) {
      const std::string path = numbered_points(folder, kind, count);
      BlockOptions options;
      options.readers = 1;  // blocks in order
      options.block_bytes = 1 << 16;
      if (kind == "points.raw") {
        options.read.raw_dimension = 2;
        options.read.raw_scalar = ScalarType::f64;
      }
      const std::vector<std::string> files{path, path};
      for (const std::uint64_t parts : {1, 2, 3, 5}) {
        if (parts > 2 * count) {
          error_of(ErrorCode::invalid_argument, [&] { rows_of_part(files, 0, parts, options); });
          continue;
        }
        std::uint64_t next = 0;
        for (std::uint64_t part = 0; part < parts; ++part) {
          options.rows = rows_of_part(files, part, parts, options);
          const std::uint64_t begin = next;
          BlockVisitor visitor;
          visitor.points = [&](const PointView& block, std::uint64_t first_id) {
            if (block.count > 0) {
              ASSERT_EQ(first_id, next);
            }
            for (std::uint64_t i = 0; i < block.count; ++i, ++next) {
              ASSERT_EQ(block.at(i, 0), static_cast<double>(next % count)) << kind;
              ASSERT_EQ(block.at(i, 1), static_cast<double>(next % count)) << kind;
            }
          };
          visit_blocks(files, visitor, options);
          EXPECT_EQ(next - begin, 2 * count / parts + (part < 2 * count % parts ? 1 : 0)) << kind;
        }
        EXPECT_EQ(next, 2 * count) << kind << ' ' << parts;
      }
      error_of(ErrorCode::invalid_argument, [&] { rows_of_part(files, 5, 5, options); });
    }
}

#if !defined(_WIN32)  // a pipe has no name there that a file could have
TEST(Open, StreamsAreReadWhole) {
  const TemporaryFolder folder;
  const std::string pipe = folder.file("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::string text;
  for (int i = 0; i < 50000; ++i) text += std::to_string(i) + " 2\n";
  std::thread writer([&] { std::ofstream(pipe) << text; });
  const PointFile file = open_points(pipe);
  writer.join();
  EXPECT_FALSE(file.mapped());
  EXPECT_EQ(file.points().count, 50000U);
  EXPECT_EQ(file.points().at(49999, 0), 49999);
}
#endif

TEST(Open, StandardInput) {
  const TemporaryFolder folder;
  const int keep = dup(STDIN_FILENO);
  const int replaced = open(folder.write("in", "1 2\n3 4 5\n").c_str(), O_RDONLY);
  dup2(replaced, STDIN_FILENO);
  close(replaced);
  const std::string message = error_of(ErrorCode::bad_file, [] { open_points("-"); });
  if (keep >= 0) dup2(keep, STDIN_FILENO);
  EXPECT_EQ(message, "standard input:2: 3 coordinates where the first point has 2");
}

TEST(Open, MovesKeepTheMemory) {
  const TemporaryFolder folder;
  PointFile a = open_points(folder.write("a.npy", npy("{'descr':'<f8','fortran_order':False,"
                                                      "'shape':(1,1)}",
                                                      bytes_of(7.0))));
  PointFile b = open_points(folder.write("b.txt", "1 2\n"));
  b = std::move(a);
  const PointFile c(std::move(b));
  EXPECT_EQ(rows_of(c.points()), (Rows{{7}}));
  EXPECT_GE(c.read_seconds(), 0);
}

#if !defined(_WIN32)  // where a mapped file cannot be cut
void on_bus_error(int, siginfo_t* info, void*) {
  const char* name = describe_mapped_fault(info->si_addr);
  if (name == nullptr) _exit(9);
  [[maybe_unused]] const auto sent = write(STDERR_FILENO, name, std::strlen(name));
  _exit(1);
}

TEST(MappedFault, NamesTheFileThatShrank) {
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "shrinks.npy",
      npy("{'descr':'|u1','fortran_order':False,'shape':(1000000,)}", std::string(1000000, 'x')));
  const PointFile file = open_points(path);
  ASSERT_TRUE(file.mapped());
  EXPECT_STREQ(describe_mapped_fault(file.points().data + 999999), path.c_str());
  EXPECT_EQ(describe_mapped_fault(&path), nullptr);
  EXPECT_EXIT(
      {
        struct sigaction action {};
        action.sa_sigaction = on_bus_error;
        action.sa_flags = SA_SIGINFO;
        sigaction(SIGBUS, &action, nullptr);
        if (truncate(path.c_str(), 100) != 0) _exit(8);
        const double seen = file.points().at(999999, 0);
        _exit(seen > 0 ? 7 : 6);
      },
      ::testing::ExitedWithCode(1), "shrinks.npy");
}
#endif

TEST(MappedFault, ForgetsClosedFiles) {
  const TemporaryFolder folder;
  const std::string path =
      folder.write("a.npy", npy("{'descr':'|u1','fortran_order':False,'shape':(1,)}", "x"));
  for (int i = 0; i < 200; ++i) {  // more than the registry's slots
    const PointFile file = open_points(path);
    ASSERT_STREQ(describe_mapped_fault(file.points().data), path.c_str()) << i;
  }
  std::vector<PointFile> many;
  for (int i = 0; i < 100; ++i) many.push_back(open_points(path));
  EXPECT_EQ(rows_of(many.back().points()), (Rows{{'x'}}));
}

#if !defined(_WIN32)
TEST(MappedFile, ShrinkingIsSeenBeforeHandingOut) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a", std::string(5000, 'x'));
  const internal::MappedFile file(path);
  file.check_size();
  ASSERT_EQ(truncate(path.c_str(), 4999), 0);
  EXPECT_EQ(error_of(ErrorCode::io, [&] { file.check_size(); }),
            path + ": shrank while it was being read");
}
#endif

TEST(Output, AppearsWholeOrNotAtAll) {
  const TemporaryFolder folder;
  const std::string path = folder.write("out", "old");
  chmod(path.c_str(), 0640);
  {
    internal::OutputFile out(path);
    out.write("never");
    EXPECT_EQ(folder.entries(), 2U);
  }
  EXPECT_EQ(slurp(path), "old");
  EXPECT_EQ(folder.entries(), 1U);
  const std::string big(3 << 20, 'b');
  internal::OutputFile out(path);
  out.write("a");
  out.write(big);
  out.write("c");
  EXPECT_EQ(slurp(path), "old");
  out.commit();
  EXPECT_EQ(slurp(path), "a" + big + "c");
  EXPECT_EQ(folder.entries(), 1U);
#if !defined(_WIN32)
  struct stat status {};
  stat(path.c_str(), &status);
  EXPECT_EQ(status.st_mode & 0777U, 0640U);
#endif
}

#if !defined(_WIN32)  // links are for administrators there
TEST(Output, LinksStayLinks) {
  const TemporaryFolder folder;
  const std::string target = folder.write("target", "old");
  std::filesystem::create_symlink(target, folder.file("link"));
  internal::OutputFile out(folder.file("link"));
  out.write("new");
  out.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link")));
  EXPECT_EQ(slurp(target), "new");
}
#endif

TEST(Output, RefusalsOfTheSystem) {
  const TemporaryFolder folder;
  error_of(ErrorCode::io, [&] { write_npy_ids(folder.file("no/such/file"), {1}); });
  error_of(ErrorCode::io, [&] { write_npy_ids(folder.file(""), {1}); });
#if !defined(_WIN32)
  EXPECT_EQ(error_of(ErrorCode::io, [] { write_npy_ids("/dev/full", {1}); }),
            "/dev/full: cannot write: No space left on device");
  EXPECT_EQ(
      error_of(
          ErrorCode::io,
          [] { write_npy_ids("/dev/full", std::vector<std::uint64_t>(std::size_t{1} << 18)); }),
      "/dev/full: cannot write: No space left on device");
  EXPECT_TRUE(std::filesystem::exists("/dev/full"));
#endif
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(Output, InterruptRemovesTemporaries) {
  const TemporaryFolder folder;
  {
    internal::OutputFile a(folder.file("a")), b(folder.file("b"));
    a.write(std::string(2 << 20, 'a'));
    EXPECT_EQ(folder.entries(), 2U);
    remove_unfinished_files();
#if !defined(_WIN32)  // where the name of an open file goes with the file, when it is closed
    EXPECT_EQ(folder.entries(), 0U);
#endif
  }
  folder.write("c", "kept");
  remove_unfinished_files();
  EXPECT_EQ(folder.entries(), 1U);
}

}  // namespace cullhull::testing::io_files_test
