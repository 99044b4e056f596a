// Children that are forked while other threads of the parent are in calls: each finds every lock of
// the library free, and computes what the parent does.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "agreement/point_sets.hpp"
#include "cullhull/array.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/io.hpp"
#include "parallel/memory/pages.hpp"
#include "tests/io_fixtures.hpp"

namespace cullhull::testing_support::fork_test {

/// Runs each work again and again on a thread of its own.
class Busy {
 public:
  explicit Busy(const std::vector<std::function<void()>>& works) {
    for (const auto& work : works)
      threads_.emplace_back([this, work] {
        while (!over_) work();
      });
  }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;
  ~Busy() {
    over_ = true;
    for (std::thread& t : threads_) t.join();
  }

 private:
  std::atomic<bool> over_{false};
  std::vector<std::thread> threads_;
};

struct Children {
  unsigned right = 0, wrong = 0, hanging = 0;
};

/// Forks children that run `work`, which tells whether all is right. Those that take longer than
/// any can are ended.
Children fork_children(unsigned count, const std::function<bool()>& work) {
  constexpr unsigned patience = 20;  // seconds; the work takes milliseconds
  Children all;
  for (unsigned i = 0; i < count && all.hanging < 3; ++i) {
    const pid_t child = ::fork();
    if (child == 0) {
      ::alarm(patience);
      ::_exit(work() ? 0 : 1);
    }
    int status = -1;
    if (child < 0 || ::waitpid(child, &status, 0) != child) break;
    const bool hung = WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM;
    ++(hung ? all.hanging : status == 0 ? all.right : all.wrong);
  }
  return all;
}

void expect_all_right(unsigned count, const std::function<bool()>& work) {
  const Children all = fork_children(count, work);
  EXPECT_EQ(all.hanging, 0U);
  EXPECT_EQ(all.wrong, 0U);
  EXPECT_EQ(all.right, count);
}

#ifdef __SANITIZE_THREAD__
#define SKIP_FORKS GTEST_SKIP() << "ThreadSanitizer ends a forked child that starts threads"
#else
#define SKIP_FORKS
#endif

TEST(Fork, WhileThreadsAllocate) {
  SKIP_FORKS;
  const auto blocks_of = [](std::size_t bytes) {
    return [bytes] { internal::free_block(internal::allocate_block(bytes), bytes); };
  };
  constexpr std::size_t small = internal::kept_block, large = 2 * internal::mapped_block;
  const auto pages = [=] {
    const internal::PageScope scope;
    blocks_of(large)();
  };
  const Busy busy({blocks_of(small), blocks_of(4 * small), pages});
  expect_all_right(200, [&] {
    for (unsigned i = 0; i < 10; ++i) {
      blocks_of(small)();
      pages();
    }
    return true;
  });
}

TEST(Fork, WhileThreadsAreInCalls) {
  SKIP_FORKS;
  const PointSet circle = random_set("sphere", 3000, 2, 1), ball = random_set("ball", 3000, 3, 2),
                 sphere = random_set("sphere", 1000, 3, 3);
  const auto volume = [](const PointSet& s) { return convex_hull(view_of(s)).volume; };
  const double of_circle = volume(circle), of_ball = volume(ball), of_sphere = volume(sphere);
  const Busy busy({[&] { volume(circle); }, [&] { volume(ball); }, [&] { volume(sphere); }});
  expect_all_right(200, [&] {
    return volume(circle) == of_circle && volume(ball) == of_ball && volume(sphere) == of_sphere;
  });
}

/// libhdf5 is called, and refuses the file.
TEST(Fork, WhileThreadsReadHdf5) {
  SKIP_FORKS;
  const testing::TemporaryFolder folder;
  const std::string path =
      folder.write("cut.h5", std::string("\x89HDF\r\n\x1a\n", 8) + std::string(500, '\0'));
  const auto reason = [&] {
    try {
      open_points(path);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  const std::string expected = reason();
  EXPECT_NE(expected, "");
  const Busy busy({[&] { reason(); }, [&] { reason(); }});
  expect_all_right(100, [&] { return reason() == expected; });
}

/// Calls that other threads had begun are none of the child's: after its own, nothing is kept
/// beyond the limit.
TEST(Fork, AChildCountsItsOwnCalls) {
  SKIP_FORKS;
  constexpr std::size_t large = 8 * internal::mapped_block;
  std::atomic<bool> open{false}, over{false};
  std::thread other([&] {
    const internal::PageScope scope;
    open = true;
    while (!over) std::this_thread::yield();
  });
  while (!open) std::this_thread::yield();
  const auto keeps_no_more = [&] {
    keep_memory(0);
    {
      const internal::PageScope scope;
      internal::free_block(internal::allocate_block(large), large);
      if (internal::kept_pages() < large) return false;
    }
    return internal::kept_pages() == 0;
  };
  expect_all_right(1, keeps_no_more);
  {
    const internal::PageScope mine;  // open in the child as well, where it is never closed
    expect_all_right(1, [&] { return !keeps_no_more(); });
  }
  over = true;
  other.join();
}

}  // namespace cullhull::testing_support::fork_test
