// The program where the system gives less than it asks for: address space, processes, file size,
// room on a disk, the rest of a file that is being read. One line and a status, never an abort.
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "agreement/run_app.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/io.hpp"

namespace cullhull::cli_limits_test {

using namespace testing;

void write_ball(const std::string& path, std::uint64_t n, std::uint32_t d = 3) {
  write_npy_points(path, generate("ball", n, d, 3).data(), n, d, ScalarType::f64);
}

void limit_to(int resource, rlim_t most) {
  const rlimit limit{most, most};
  ::setrlimit(static_cast<__rlimit_resource_t>(resource), &limit);
}

/// A program that could not be loaded never ran: the loader says so itself, or is killed, or there
/// is no memory for what precedes main and the run-time library gives up (from main on the
/// program's own handler would speak).
bool loaded(const Ran& ran) {
  if (ran.status == 1000 + SIGABRT && ran.err == "terminate called without an active exception\n")
    return false;
  return ran.status != 127 && !(ran.status == 1000 + SIGSEGV && ran.err.empty() && ran.out.empty());
}

// Four million points take 96 MB; more than 64 MB at once would be all of them or most.
TEST(Limits, MakingPointsTakesNoMoreMemoryTheMoreThereAre) {
  const Folder f;
  const auto make = [&](const char* count, const std::string& name) {
    return run_well({"generate", "gauss", "-n", count, "--seed", "3", "-o", f / name}).peak_bytes;
  };
  const std::uint64_t besides = make("10", "few.npy"), peak = make("4000001", "many.npy");
  if (!testing::sanitized) {
    EXPECT_LE(peak, besides + (std::uint64_t{64} << 20));
  }
  const std::vector<double> rows = generate("gauss", 4000001, 3, 3);
  const PointFile file = open_points(f / "many.npy");
  ASSERT_EQ(file.points().count, 4000001U);
  EXPECT_EQ(std::memcmp(file.points().data, rows.data(), 8 * rows.size()), 0);
}

TEST(Limits, AddressSpace) {
  if (testing::sanitized) GTEST_SKIP() << "a sanitizer needs more addresses than that";
  const Folder f;
  write_ball(f / "p.npy", 100000);
  rlim_t least = 8 << 20;  // what the loader needs
  const auto version = [&](rlim_t bytes) {
    return run_limited({"--version"}, [&] { limit_to(RLIMIT_AS, bytes); });
  };
  while (!loaded(version(least))) least += 512 << 10;
  unsigned refused = 0, done = 0;
  for (rlim_t bytes = least; bytes < least + (60 << 20); bytes += 768 << 10) {
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"hull", f / "p.npy"}, {"info", f / "p.npy"}}) {
      const Ran ran = run_limited(arguments, [&] { limit_to(RLIMIT_AS, bytes); });
      if (ran.status == 0) {
        ++done;
        EXPECT_EQ(ran.err, "") << (bytes >> 10) << " KiB";
        continue;
      }
      ++refused;
      EXPECT_TRUE(ran.status == 1 || ran.status == 4)
          << ran.status << ", " << (bytes >> 10) << " KiB";
      EXPECT_TRUE(one_line(ran.err)) << (bytes >> 10) << " KiB";
    }
  }
  EXPECT_GT(refused, 0U);
  EXPECT_GT(done, 0U);
}

TEST(Limits, TooFewProcesses) {
  if (testing::sanitized) GTEST_SKIP() << "a sanitizer needs a process of its own";
  if (::geteuid() != 0) GTEST_SKIP() << "only root can become a user without processes";
  const Folder f;
  write_ball(f / "p.npy", 100000);
  std::filesystem::permissions(f / "", std::filesystem::perms::all);
  std::filesystem::permissions(f / "p.npy", std::filesystem::perms::all);
  constexpr uid_t user = 54321;  // nobody else's, so that only our own processes count
  const auto as_user = [](rlim_t processes) {
    return [processes] {
      limit_to(RLIMIT_NPROC, processes);
      if (::setresuid(user, user, user) != 0) ::_exit(125);
    };
  };
  const Ran free = run_limited({"info", f / "p.npy"}, as_user(1000));
  if (free.status != 0) GTEST_SKIP() << "another user may not run the program: " << free.err;
  for (const rlim_t processes : {1, 2, 3, 4}) {
    for (const std::string threads : {"1", "2", "64"}) {
      const Ran ran = run_limited({"hull", f / "p.npy", "--cull", "none", "--threads", threads},
                                  as_user(processes));
      if (ran.status == 0) continue;
      EXPECT_TRUE(ran.status == 1 || ran.status == 4)
          << ran.status << ", " << processes << " processes, " << threads << " threads";
      EXPECT_TRUE(one_line(ran.err)) << processes << " processes, " << threads << " threads";
    }
  }
  const Ran one = run_limited({"hull", f / "p.npy"}, as_user(1));
  EXPECT_EQ(one.status, 1);
  EXPECT_TRUE(has(one.err, "thread"));
}

TEST(Limits, FileSize) {
  const Folder f;
  write_ball(f / "p.npy", 20000);
  for (const std::vector<std::string>& arguments :
       command_lines(f, {"generate ball -n 100k -o @big.npy", "hull @p.npy -q -o @hull.json",
                         "hull @p.npy -q -o @hull.ply", "view @p.npy -q -o @page.html",
                         "cull @p.npy -q --cull none -o @ids.npy"})) {
    const Ran ran = run_limited(arguments, [] { limit_to(RLIMIT_FSIZE, 10000); });
    EXPECT_EQ(ran.status, 1) << arguments[0];
    EXPECT_TRUE(one_line(ran.err)) << arguments[0];
    EXPECT_TRUE(has(ran.err, "File too large"));
    EXPECT_EQ(f.entries(), 1U) << arguments[0] << ": something was left over";
  }
}

TEST(Limits, FullDisk) {
  const Folder f;
  write_ball(f / "p.npy", 20000);
  for (const std::vector<std::string>& arguments :
       command_lines(f, {"hull @p.npy -q --vertices /dev/full", "hull @p.npy -q -o /dev/full",
                         "hull @p.npy -q --json=/dev/full", "cull @p.npy -q --json=/dev/full"}))
    expect_error(arguments, 1, "/dev/full: cannot write: No space left");
}

TEST(Limits, FullFileSystem) {
  const Folder f;
  write_ball(f / "p.npy", 20000);
  std::filesystem::create_directory(f / "small");
  if (::mount("tmpfs", (f / "small").c_str(), "tmpfs", 0, "size=64k") != 0)
    GTEST_SKIP() << "no file system can be mounted here";
  expect_error({"hull", f / "p.npy", "-q", "-o", f / "small/hull.json"}, 1, "No space left");
  EXPECT_TRUE(std::filesystem::is_empty(f / "small"));
  ::umount((f / "small").c_str());
}

/// Standard error of a program that finds no room in it until it is drained.
class FullPipe {
 public:
  FullPipe() {
    if (::pipe2(ends_, O_CLOEXEC | O_NONBLOCK) != 0) std::abort();
    const std::string filling(4096, '.');
    while (::write(ends_[1], filling.data(), filling.size()) > 0) filled_ += filling.size();
    ::fcntl(ends_[1], F_SETFL, 0);
    ::fcntl(ends_[0], F_SETFL, 0);
  }
  int writer() const { return ends_[1]; }
  /// What was written behind the filling; to be called once.
  std::string drain() {
    ::close(ends_[1]);
    std::string text;
    char buffer[4096];
    for (ssize_t n = 0; (n = ::read(ends_[0], buffer, sizeof buffer)) > 0;)
      text.append(buffer, static_cast<std::size_t>(n));
    ::close(ends_[0]);
    return text.substr(std::min(filled_, text.size()));
  }

 private:
  int ends_[2] = {};
  std::size_t filled_ = 0;
};

// Every thread that reads the file meets the hole; the first one tells, although it has to wait for
// room to do so.
TEST(Limits, AFileCutShortIsToldOnce) {
  const Folder f;
  const std::string path = f / "p.npy";
  write_ball(path, 1000000);
  FullPipe err;
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  const pid_t child = start_app({"hull", path, "-q", "--cull", "gauge", "--repeat", "1000000"},
                                null, null, err.writer());
  const std::string maps = "/proc/" + std::to_string(child) + "/maps";
  while (testing::read_file(maps).find(path) == std::string::npos) ::usleep(1000);
  ::usleep(300000);  // the header has been read by now, and the points are, again and again
  std::filesystem::resize_file(path, 4096);
  ::usleep(300000);
  const std::string said = err.drain();
  EXPECT_EQ(wait_for(child), 1);
  ::close(null);
  EXPECT_EQ(said, "cullhull: " + path + ": the file was cut short while it was being read\n");
}

}  // namespace cullhull::cli_limits_test
