// Checks at full size that a result is the same, bit for bit, for any number of threads and any
// filter.
//
//     identity_bench [--threads 1,2,3,4,8] [--cull auto,none,gauge,pseudo-hull] [--no-certify]
//                    [WORKLOAD ...]
//     identity_bench --small COUNT [--seed N] [--threads ...] [--no-certify]
//
// Workloads are named as in `cullhull-bench rivals`: cone-3d-1M, ball-4d-8M-f32. For each run it
// prints the seconds and a hash of every list and number of the hull; the first hull of a workload
// is certified. --small uses COUNT random sets of up to 200 points in 1D to 6D, many of them
// degenerate, certifies each hull and prints a hash per thousand sets, for comparison with another
// version. Exit status 1 if a hash differs or a hull is not certified.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
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
  std::uint64_t small = 0, seed = 1;
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

/// Random points in d dimensions: general position, lattices, a sphere, axes of very different
/// extents, flats, equal points, corners that differ in their last bits.
class SmallSets {
 public:
  explicit SmallSets(std::uint64_t seed) : random_(seed) {}

  std::vector<double> next(unsigned& d) {
    static constexpr unsigned most[] = {8, 20, 60, 200};
    d = 1 + below(6);
    const unsigned n = 1 + below(std::min(most[below(4)], d < 5 ? 200U : 30U));
    std::vector<double> v(std::size_t{n} * d);
    const unsigned kind = below(8);
    for (double& x : v) x = kind == 1 ? integer(3) : kind == 6 ? integer(1) : normal();
    if (kind == 2) onto_sphere(v, d);
    if (kind == 3) scale_axes(v, d);
    if (kind == 4) flatten(v, d);
    if (kind == 5)
      for (double& x : v) x = static_cast<float>(x);
    if (kind == 6)
      for (double& x : v) x += 1e-15 * integer(1);
    if (kind == 7)
      for (std::size_t i = v.size() / 3 / d * d; i < v.size(); ++i)
        v[i] = v[i % std::max<std::size_t>(v.size() / 3 / d * d, d)];
    return v;
  }

 private:
  unsigned below(unsigned end) { return static_cast<unsigned>(random_() % end); }
  double integer(unsigned most) { return static_cast<double>(below(2 * most + 1)) - most; }
  /// The sum of four uniform numbers, because the standard library's distributions vary.
  double normal() {
    double sum = -2;
    for (int i = 0; i < 4; ++i) sum += static_cast<double>(random_() >> 11) * 0x1p-53;
    return sum;
  }
  static void onto_sphere(std::vector<double>& v, unsigned d) {
    for (std::size_t i = 0; i < v.size(); i += d) {
      double square = 1e-300;
      for (unsigned k = 0; k < d; ++k) square += v[i + k] * v[i + k];
      for (unsigned k = 0; k < d; ++k) v[i + k] /= std::sqrt(square);
    }
  }
  void scale_axes(std::vector<double>& v, unsigned d) {
    for (unsigned k = 0; k < d; ++k) {
      const int exponent = static_cast<int>(below(1200)) - 600;
      for (std::size_t i = k; i < v.size(); i += d) v[i] = std::ldexp(v[i], exponent);
    }
  }
  /// Replaces further coordinates by integer combinations of the first few.
  void flatten(std::vector<double>& v, unsigned d) {
    const unsigned kept = below(d + 1);
    for (double& x : v) x = integer(9);
    for (unsigned k = kept; k < d; ++k) {
      double factors[6];
      for (double& f : factors) f = integer(3);
      for (std::size_t i = 0; i < v.size(); i += d) {
        v[i + k] = factors[5];
        for (unsigned j = 0; j < kept; ++j) v[i + k] += factors[j % 5] * v[i + j];
      }
    }
  }

  std::mt19937_64 random_;
};

bool small_hold(const Settings& settings) {
  SmallSets sets(settings.seed);
  bool good = true;
  testing_support::Fnv all;
  for (std::uint64_t i = 0; i < settings.small; ++i) {
    unsigned d = 0;
    const std::vector<double> v = sets.next(d);
    const PointView points = PointView::row_major(v.data(), v.size() / d, d);
    std::uint64_t expected = 0;
    bool first = true;
    for (const std::string& threads : settings.threads) {
      Options options;
      options.threads = static_cast<unsigned>(std::stoul(threads));
      const Hull hull = convex_hull(points, options);
      const std::uint64_t hash = testing_support::canonical_hash(hull);
      if (first) expected = hash;
      const bool certified = !first || !settings.certify || certify(points, hull).valid;
      if (hash != expected || !certified) {
        std::printf("set %llu, %s threads: %s\n", static_cast<unsigned long long>(i),
                    threads.c_str(), certified ? "DIFFERS" : "NOT certified");
        good = false;
      }
      first = false;
    }
    all.word(expected);
    if ((i + 1) % 1000 == 0 || i + 1 == settings.small) {
      std::printf("%llu sets: hash %016llx\n", static_cast<unsigned long long>(i + 1),
                  static_cast<unsigned long long>(all.value()));
      std::fflush(stdout);
    }
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
    else if (i + 1 < argc && a == "--small")
      settings.small = std::stoull(argv[++i]);
    else if (i + 1 < argc && a == "--seed")
      settings.seed = std::stoull(argv[++i]);
    else if (a == "--no-certify")
      settings.certify = false;
    else
      settings.workloads.push_back(a);
  }
  bool good = settings.small == 0 || small_hold(settings);
  if (settings.workloads.empty() && settings.small == 0)
    for (const bench::Workload& w : bench::rival_workloads())
      if (w.scalar != ScalarType::i32) settings.workloads.push_back(w.name());
  for (const std::string& name : settings.workloads) good = holds(settings, name) && good;
  std::printf("%s\n", good ? "all the same" : "NOT all the same, or not certified");
  return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) try { return run(argc, argv); } catch (const std::exception& e) {
  std::fprintf(stderr, "identity_bench: %s\n", e.what());
  return 2;
}
