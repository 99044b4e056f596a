// Whether a result is the same, bit for bit, for any number of threads and any filter, at full
// size.
//
//     identity_bench [--threads 1,2,3,4,8] [--cull auto,none,gauge,pseudo-hull] [--no-certify]
//                    [WORKLOAD ...]
//
// Workloads are named as in `cullhull bench rivals`: cone-3d-1M, ball-4d-8M-f32. For each run it
// prints the seconds and a hash of every list and number of the hull; the first hull of a workload
// is certified. Ends with status 1 where a hash differs or a hull is not certified.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "agreement/canonical_hash.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "families.hpp"
#include "rivals.hpp"

namespace {

using namespace cullhull;
using Clock = std::chrono::steady_clock;

struct Settings {
  std::vector<std::string> threads{"1", "2", "3", "4", "8"}, culls{"auto"}, workloads;
  bool certify = true;
};

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> words(1);
  for (const char c : list) {
    if (c == ',')
      words.emplace_back();
    else
      words.back() += c;
  }
  return words;
}

CullMethod method_named(const std::string& name) {
  if (name == "auto") return CullMethod::automatic;
  if (name == "none") return CullMethod::none;
  if (name == "gauge") return CullMethod::gauge;
  if (name == "pseudo-hull") return CullMethod::pseudo_hull;
  throw Error(ErrorCode::invalid_argument, "no filter '" + name + "'");
}

/// The points in the workload's scalar type.
struct Points {
  std::vector<double> doubles;
  std::vector<float> floats;
  PointView view;

  explicit Points(const bench::Workload& w)
      : doubles(bench::make_family(w.family, w.count, w.dimension)) {
    const std::uint64_t n = doubles.size() / w.dimension;
    if (w.scalar == ScalarType::f64) {
      view = PointView::row_major(doubles.data(), n, w.dimension);
      return;
    }
    if (w.scalar != ScalarType::f32)
      throw Error(ErrorCode::invalid_argument, w.name() + ": only f64 and f32");
    for (const double v : doubles) floats.push_back(static_cast<float>(v));
    view = PointView::row_major(floats.data(), n, w.dimension);
  }
};

bool is_certified(const PointView& points, const Hull& hull) {
  const auto start = Clock::now();
  const Certificate c = certify(points, hull);
  std::printf("  %s, %.2f s\n", c.valid ? "certified" : c.reason.c_str(), seconds_since(start));
  return c.valid;
}

bool holds(const Settings& settings, const std::string& name) {
  const Points points(bench::workload_named(name));
  std::printf("%s\n", name.c_str());
  bool good = true, first = true;
  std::uint64_t expected = 0;
  for (const std::string& cull : settings.culls)
    for (const std::string& threads : settings.threads) {
      Options options;
      options.cull = method_named(cull);
      options.threads = static_cast<unsigned>(std::stoul(threads));
      const auto start = Clock::now();
      const Hull hull = convex_hull(points.view, options);
      const double seconds = seconds_since(start);
      const std::uint64_t hash = testing_support::canonical_hash(hull);
      if (first) expected = hash;
      std::printf("  cull %-11s %s threads %8.3f s, %zu vertices, %llu facets, hash %016llx%s\n",
                  cull.c_str(), threads.c_str(), seconds, hull.vertices.size(),
                  static_cast<unsigned long long>(hull.facet_count()),
                  static_cast<unsigned long long>(hash), hash == expected ? "" : " DIFFERS");
      good = good && hash == expected;
      if (first && settings.certify) good = is_certified(points.view, hull) && good;
      first = false;
      std::fflush(stdout);
    }
  return good;
}

int run(int argc, char** argv) {
  Settings settings;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    if (i + 1 < argc && a == "--threads")
      settings.threads = split(argv[++i]);
    else if (i + 1 < argc && a == "--cull")
      settings.culls = split(argv[++i]);
    else if (a == "--no-certify")
      settings.certify = false;
    else
      settings.workloads.push_back(a);
  }
  if (settings.workloads.empty())
    for (const bench::Workload& w : bench::rival_workloads())
      if (w.scalar != ScalarType::i32) settings.workloads.push_back(w.name());
  bool good = true;
  for (const std::string& name : settings.workloads) good = holds(settings, name) && good;
  std::printf("%s\n", good ? "all the same" : "NOT all the same, or not certified");
  return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) try { return run(argc, argv); } catch (const std::exception& e) {
  std::fprintf(stderr, "identity_bench: %s\n", e.what());
  return 2;
}
