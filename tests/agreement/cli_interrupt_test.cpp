// The program when it is interrupted, or its input changes under it: one line, and no half file.
#include <sys/ioctl.h>

#include <filesystem>

#include "agreement/run_app.hpp"

namespace cullhull::cli_interrupt_test {

using namespace testing;

TEST(CliInterrupt, InterruptedWorkLeavesNoFile) {
  const Folder f;
  write_points(f / "p.npy", "sphere", 20000, 6);  // seconds of work
  for (const int number : {SIGINT, SIGTERM}) {
    OnTerminal app({"hull", f / "p.npy", "-o", f / "hull.json", "--vertices", f / "v.npy"});
    ASSERT_TRUE(app.at_work());
    app.signal(number);
    EXPECT_EQ(app.wait(), 130) << app.shown();
    EXPECT_TRUE(has(app.shown(), "cancelled"));
    EXPECT_EQ(f.entries(), 1U);
  }
}

TEST(CliInterrupt, InterruptedWritingLeavesNoFile) {
  const Folder f;
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  const pid_t child =
      start_app({"generate", "ball", "-n", "8M", "-o", f / "big.npy"}, null, null, null);
  while (f.entries() == 0) ::usleep(100);  // the temporary beside the target
  testing::send(child, SIGTERM);
  EXPECT_EQ(wait_for(child), 130);
  ::close(null);
  EXPECT_EQ(f.entries(), 0U);
}

/// Starts the program with a pipe as its input, and a signal once it has read what is there.
int interrupted_while_reading(const std::vector<std::string>& arguments,
                              const std::string& errors) {
  int ends[2] = {};
  if (::pipe2(ends, O_CLOEXEC) != 0) return -1;
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  const int err = ::open(errors.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  const pid_t child = start_app(arguments, ends[0], null, err);
  (void)!::write(ends[1], "0 0 0\n", 6);
  // Signals are arranged before the first byte is taken: wait until the pipe is empty.
  for (int unread = 1; unread != 0; ::usleep(1000))
    if (::ioctl(ends[0], FIONREAD, &unread) != 0) break;
  testing::send(child, SIGINT);
  const int status = wait_for(child);
  for (const int fd : {ends[0], ends[1], null, err}) ::close(fd);
  return status;
}

TEST(CliInterrupt, EveryCommandSaysThatItWasCancelled) {
  const Folder f;
  const std::string errors = f / "errors.txt";
  const std::vector<std::vector<std::string>> commands =
      command_lines(f, {"hull - -o @hull.ply", "cull - -o @ids.npy", "info -",
                        "certify - @hull.json", "view - -o @page.html"});
  write_points(f / "p.npy", "ball", 100, 3);
  run_well({"hull", f / "p.npy", "-o", f / "hull.json"});
  for (const auto& command : commands) {
    EXPECT_EQ(interrupted_while_reading(command, errors), 130) << command[0];
    EXPECT_EQ(read_file(errors), "cullhull: cancelled\n") << command[0];
  }
  EXPECT_EQ(f.entries(), 3U) << "errors.txt, p.npy and hull.json";
}

TEST(CliInterrupt, AnInputCutShortUnderItsReaderIsOneLine) {
  const Folder f;
  write_points(f / "p.npy", "sphere", 1500, 6);
  OnTerminal app({"hull", f / "p.npy", "--certify", "-o", f / "hull.json"});
  ASSERT_TRUE(app.at_work());
  std::filesystem::resize_file(f / "p.npy", 100);
  EXPECT_EQ(app.wait(), 1);
  EXPECT_TRUE(has(app.shown(), "cullhull: "));
  EXPECT_TRUE(has(app.shown(), "p.npy"));
  EXPECT_EQ(f.entries(), 1U);
}

}  // namespace cullhull::cli_interrupt_test
