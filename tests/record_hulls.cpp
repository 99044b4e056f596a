// Linked into every test where CULLHULL_RECORD_HULLS is on, between convex_hull and those who call
// it from another source: the file that the environment's CULLHULL_RECORD names receives a line
// for every hull of every test, with a hash of the points and one of the whole result. Files of
// two machines are compared by scripts/compare_hulls.py.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <set>
#include <string>
#include <tuple>

#include "agreement/canonical_hash.hpp"
#include "cullhull/hull.hpp"

#define CALL "_ZN8cullhull11convex_hullERKNS_9PointViewERKNS_7OptionsE"

namespace cullhull::testing_support {

Hull real_convex_hull(const PointView& points, const Options& options) asm("__real_" CALL);
Hull recorded_convex_hull(const PointView& points, const Options& options) asm("__wrap_" CALL);

namespace {

std::uint64_t hash_of(const PointView& points) {
  Fnv f;
  f.word(points.dimension);
  f.word(points.count);
  for (std::uint64_t i = 0; i < points.count; ++i)
    for (std::uint32_t j = 0; j < points.dimension; ++j) f.add(points.at(i, j));
  return f.value();
}

class Record {
 public:
  ~Record() {
    const char* const path = std::getenv("CULLHULL_RECORD");
    std::FILE* const file = path != nullptr ? std::fopen(path, "a") : nullptr;
    if (file == nullptr) return;
    for (const auto& [test, points, hull] : lines_)
      std::fprintf(file, "%s %016llx %016llx\n", test.c_str(),
                   static_cast<unsigned long long>(points), static_cast<unsigned long long>(hull));
    std::fclose(file);
  }
  void add(const PointView& points, const Hull& hull) {
    // In a forked child the lock may be held for ever, by a thread that the child does not have.
    if (getpid() != process_) return;
    const ::testing::TestInfo* const test = ::testing::UnitTest::GetInstance()->current_test_info();
    const std::string name =
        test == nullptr ? "-" : std::string(test->test_suite_name()) + "." + test->name();
    const std::uint64_t of_points = hash_of(points), of_hull = canonical_hash(hull);
    const std::lock_guard lock(mutex_);
    lines_.insert({name, of_points, of_hull});
  }

 private:
  const pid_t process_ = getpid();
  std::mutex mutex_;
  std::set<std::tuple<std::string, std::uint64_t, std::uint64_t>> lines_;
};

}  // namespace

Hull recorded_convex_hull(const PointView& points, const Options& options) {
  static Record record;
  Hull hull = real_convex_hull(points, options);
  record.add(points, hull);
  return hull;
}

}  // namespace cullhull::testing_support
