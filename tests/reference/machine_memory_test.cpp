// How much memory there is: limits of control groups, as a container has them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "parallel/memory/memory.hpp"

namespace cullhull::internal::machine_memory_test {

constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();

class MachineMemory : public ::testing::Test {
 protected:
  MachineMemory() : root_(::testing::TempDir() + "groups-" + std::to_string(::getpid())) {
    std::filesystem::create_directories(root_);
  }
  ~MachineMemory() override { std::filesystem::remove_all(root_); }

  void write(const std::string& name, const std::string& text) const {
    const std::filesystem::path path = root_ + name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }
  std::uint64_t limit(const std::string& groups) const {
    write("/groups", groups);
    return group_memory_limit(root_ + "/groups", root_);
  }

  std::string root_;
};

TEST_F(MachineMemory, VersionTwo) {
  write("/memory.max", "max\n");
  write("/a/memory.max", "3000000\n");
  write("/a/b/memory.max", "5000000\n");
  EXPECT_EQ(limit("0::/\n"), none);
  EXPECT_EQ(limit("0::/a\n"), 3000000U);
  EXPECT_EQ(limit("0::/a/b\n"), 3000000U);  // the outer group's is the less
  EXPECT_EQ(limit("0::/x/y\n"), none);
  write("/memory.max", "2000000\n");  // a container sees its own group at the root
  EXPECT_EQ(limit("0::/x/y\n"), 2000000U);
}

TEST_F(MachineMemory, VersionOne) {
  write("/memory/memory.limit_in_bytes", "9223372036854771712\n");
  write("/memory/a/memory.limit_in_bytes", "4000000\n");
  const std::string others = "9:name=systemd:/\n6:freezer:/a\n";
  EXPECT_EQ(limit(others + "4:cpu,memory:/a\n0::/\n"), 4000000U);
  EXPECT_EQ(limit(others + "4:memory:/\n0::/\n"), 9223372036854771712U);
}

TEST_F(MachineMemory, NoGroupsAndNonsense) {
  EXPECT_EQ(group_memory_limit(root_ + "/absent", root_), none);
  EXPECT_EQ(limit(""), none);
  EXPECT_EQ(limit("nonsense\n:\n::\n4:memory\n4:memory:\n0::relative\n"), none);
}

#if !defined(_WIN32)
TEST_F(MachineMemory, IsNotMoreThanThereIs) {
  const auto physical = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                        static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  EXPECT_GT(machine_memory(), 0U);
  EXPECT_LE(machine_memory(), physical);
}
#endif

}  // namespace cullhull::internal::machine_memory_test
