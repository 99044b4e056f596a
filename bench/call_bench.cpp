// Single calls, one after the other over different sets, as a program makes them that needs many
// hulls of small and middle size: the time of a call, median and 99th percentile.
//
//     call_bench [--d 2,3] [--shape ball,sphere] [--n 10,100,1000] [--threads 0,1,2]
//                [--callers 1,4] [--busy K] [--seconds S] [--seed N]
//                [--qhull 0|1] [--rival NAME=PROGRAM ...]
//
// `--threads 0` are the default options. `--callers`: so many threads call at once, each over sets
// of its own. `--busy K`: K processes keep a core each busy meanwhile. `--seconds`: for each row.
// A row's time includes making whatever a result makes when it is asked for, and freeing it. In
// brackets: the median without that. A rival is a program that is given a .npy file and a number of
// sets to cut it into, and writes the seconds of every call as doubles in binary (rival_cgal.cpp).
// Rows of one set take turns, so that what disturbs disturbs all of them.
#include <libqhull_r/qhull_ra.h>
#include <sys/prctl.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <barrier>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "child.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/io.hpp"
#include "timing.hpp"

namespace {

using namespace cullhull;
using bench::seconds_of;

struct Rival {
  std::string name, program;
};

struct Arguments {
  std::vector<std::uint64_t> dimensions{2}, counts{10, 100, 1000, 10000}, threads{0, 1, 2};
  std::vector<std::uint64_t> callers{1};
  std::vector<std::string> shapes{"ball"};
  unsigned busy = 0;
  double seconds = 0.5;
  std::uint64_t seed = 1;
  bool qhull = true;
  std::vector<Rival> rivals{};
};

// ------------------------------------------------------------------------------ the sets

struct Sets {
  std::uint64_t n = 0, count = 0;
  unsigned d = 0;
  std::vector<double> rows;

  PointView operator[](std::uint64_t i) const {
    return PointView::row_major(rows.data() + i % count * n * d, n, d);
  }
};

/// As many as there is time for, in memory that the last cache does not hold.
Sets make_sets(std::string_view shape, std::uint64_t n, unsigned d, std::uint64_t seed) {
  Sets sets;
  sets.n = n;
  sets.d = d;
  sets.count = std::clamp<std::uint64_t>((std::uint64_t{1} << 21) / (n * d), 3, 2000);
  for (std::uint64_t i = 0; i < sets.count; ++i) {
    const std::vector<double> set = generate(shape, n, d, seed + i);
    sets.rows.insert(sets.rows.end(), set.begin(), set.end());
  }
  return sets;
}

// ------------------------------------------------------------------------------ contestants

/// Seconds of calls: complete, and until the result is handed over.
struct Times {
  std::vector<double> complete, handed;
};

/// Reads an item of every list, those too that are made when they are asked for.
std::uint64_t ask_for_all(const Hull& h) {
  return h.vertices.size() + h.simplices.size() + h.simplex_neighbours.size() +
         h.simplex_facets.size() + h.facets.items.size() + h.facet_neighbours.items.size() +
         h.facet_planes.size() + (h.volume > 0 ? 1 : 0);
}

std::atomic<std::uint64_t> sink{0};  // so that no call is left out

void time_ours(const Sets& sets, std::uint64_t i, const Options& options, Times& times) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point t) {
    return std::chrono::duration<double>(Clock::now() - t).count();
  };
  const PointView set = sets[i];
  const Clock::time_point start = Clock::now();
  {
    const Hull hull = convex_hull(set, options);
    times.handed.push_back(since(start));
    sink += ask_for_all(hull);
  }
  times.complete.push_back(since(start));
}

void time_qhull(const Sets& sets, std::uint64_t i, Times& times) {
  const PointView set = sets[i];
  static std::FILE* const nowhere = std::fopen("/dev/null", "w");
  // Qhull reads the points where they are and does not change them without QJ or Qz.
  auto* data = reinterpret_cast<coordT*>(const_cast<std::byte*>(set.data));
  char flags[] = "qhull Qt";
  times.complete.push_back(seconds_of([&] {
    qhT qh;
    qh_zero(&qh, nowhere);
    if (qh_new_qhull(&qh, static_cast<int>(set.dimension), static_cast<int>(set.count), data, 0,
                     flags, nowhere, nowhere) == 0)
      sink += static_cast<std::uint64_t>(qh.num_vertices);
    int a = 0, b = 0;
    qh_freeqhull(&qh, !qh_ALL);
    qh_memfreeshort(&qh, &a, &b);
  }));
  times.handed = times.complete;
}

/// Every set once, by a program of its own.
void time_program(const Sets& sets, const std::string& program, Times& times) {
  const std::string path = (std::filesystem::temp_directory_path() /
                            ("cullhull-calls-" + std::to_string(::getpid()) + ".npy"))
                               .string();
  write_npy_points(path, sets.rows.data(), sets.n * sets.count, sets.d, ScalarType::f64);
  const auto child = bench::run_program({program, path, std::to_string(sets.count)}, {});
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
  if (!child || child->output.size() != sets.count * sizeof(double)) return;
  times.complete.resize(sets.count);
  std::memcpy(times.complete.data(), child->output.data(), child->output.size());
  times.handed = times.complete;
}

// ------------------------------------------------------------------------------ measuring

double quantile(std::vector<double>& v, double q) {
  if (v.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(q * static_cast<double>(v.size() - 1));
  std::nth_element(v.begin(), v.begin() + at, v.end());
  return v[static_cast<std::size_t>(at)];
}

/// Processes that compute until this is destroyed.
class Busy {
 public:
  explicit Busy(unsigned count) {
    for (unsigned k = 0; k < count; ++k) {
      const pid_t child = ::fork();
      if (child == 0) {
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        for (std::atomic<std::uint64_t> i{0};;) i.store(i.load() + 1, std::memory_order_relaxed);
      }
      if (child > 0) children_.push_back(child);
    }
  }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;
  ~Busy() {
    for (const pid_t child : children_) {
      ::kill(child, SIGKILL);
      ::waitpid(child, nullptr, 0);
    }
  }

 private:
  std::vector<pid_t> children_;
};

/// One row of the table: call(i, times) makes a call with set i. Thread safe for ours.
struct Contestant {
  std::string name;
  std::uint64_t callers = 1;
  std::function<void(std::uint64_t, Times&)> call;
  std::function<void(Times&)> all_at_once{};  ///< instead, where it is a program
  Times times{};
  std::uint64_t next = 0;
};

/// A slice of a contestant's turn: calls until `seconds` are over, one at least.
void calls_of_slice(Contestant& c, double seconds, std::uint64_t sets) {
  if (c.callers == 1) {
    double spent = 0;
    do {
      c.call(c.next++, c.times);
      spent += c.times.complete.back();
    } while (spent < seconds);
    return;
  }
  std::vector<Times> times(c.callers);
  std::barrier start(static_cast<std::ptrdiff_t>(c.callers));
  std::vector<std::thread> threads;
  for (std::uint64_t k = 0; k < c.callers; ++k)
    threads.emplace_back([&, k] {
      std::uint64_t i = c.next + k * (sets / c.callers);
      start.arrive_and_wait();
      double spent = 0;
      do {
        c.call(i++, times[k]);
        spent += times[k].complete.back();
      } while (spent < seconds);
    });
  for (std::thread& t : threads) t.join();
  ++c.next;
  for (const Times& t : times) {
    c.times.complete.insert(c.times.complete.end(), t.complete.begin(), t.complete.end());
    c.times.handed.insert(c.times.handed.end(), t.handed.begin(), t.handed.end());
  }
}

void measure(std::vector<Contestant>& contestants, const Arguments& given, std::uint64_t sets) {
  constexpr unsigned slices = 5;
  const Busy busy(given.busy);
  for (unsigned s = 0; s < slices; ++s)
    for (Contestant& c : contestants)
      if (!c.all_at_once)
        calls_of_slice(c, given.seconds / slices, sets);
      else if (s == 0)
        c.all_at_once(c.times);
}

void print(const std::string& title, std::vector<Contestant>& contestants) {
  const auto qhull = std::find_if(contestants.begin(), contestants.end(),
                                  [](const Contestant& c) { return c.name == "Qhull"; });
  const double theirs = qhull == contestants.end() ? 0 : 1e6 * quantile(qhull->times.complete, 0.5);
  std::printf("%s\n", title.c_str());
  for (Contestant& c : contestants) {
    const double middle = 1e6 * quantile(c.times.complete, 0.5);
    std::printf("  %-24s %10.2f us  p99 %10.2f  [%.2f]  %zu calls", c.name.c_str(), middle,
                1e6 * quantile(c.times.complete, 0.99), 1e6 * quantile(c.times.handed, 0.5),
                c.times.complete.size());
    if (theirs > 0 && middle > 0) std::printf("  %.1fx Qhull", theirs / middle);
    std::printf("\n");
  }
  std::fflush(stdout);
}

void run(std::string_view shape, std::uint64_t n, unsigned d, const Arguments& given) {
  const Sets sets = make_sets(shape, n, d, given.seed);
  std::vector<Contestant> contestants;
  for (const std::uint64_t callers : given.callers)
    for (const std::uint64_t threads : given.threads) {
      Options options;
      options.threads = static_cast<unsigned>(threads);
      std::string name = threads == 0 ? "ours" : "ours, threads " + std::to_string(threads);
      if (callers > 1) name += ", callers " + std::to_string(callers);
      contestants.push_back({name, callers, [&sets, options](std::uint64_t i, Times& times) {
                               time_ours(sets, i, options, times);
                             }});
    }
  if (given.qhull)
    contestants.push_back(
        {"Qhull", 1, [&sets](std::uint64_t i, Times& times) { time_qhull(sets, i, times); }});
  for (const Rival& rival : given.rivals)
    contestants.push_back({rival.name, 1, {}, [&sets, rival](Times& times) {
                             time_program(sets, rival.program, times);
                           }});
  measure(contestants, given, sets.count);
  std::string title = std::to_string(d) + "D " + std::string(shape) + ", " + std::to_string(n) +
                      " points" +
                      (given.busy > 0 ? ", " + std::to_string(given.busy) + " busy" : "");
  print(title, contestants);
}

// ------------------------------------------------------------------------------ command line

std::vector<std::string> words(const std::string& list) {
  std::vector<std::string> out{""};
  for (const char c : list)
    if (c == ',')
      out.emplace_back();
    else
      out.back() += c;
  return out;
}

std::vector<std::uint64_t> numbers(const std::string& list) {
  std::vector<std::uint64_t> out;
  for (const std::string& word : words(list)) {
    char* end = nullptr;
    out.push_back(std::strtoull(word.c_str(), &end, 10));
    if (word.empty() || *end != 0) {
      std::fprintf(stderr, "call_bench: '%s' is no list of numbers\n", list.c_str());
      std::exit(2);
    }
  }
  return out;
}

Arguments parse(int argc, char** argv) {
  Arguments given;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string_view word = argv[i];
    const std::string value = argv[i + 1];
    if (word == "--d")
      given.dimensions = numbers(value);
    else if (word == "--shape")
      given.shapes = words(value);
    else if (word == "--n")
      given.counts = numbers(value);
    else if (word == "--threads")
      given.threads = numbers(value);
    else if (word == "--callers")
      given.callers = numbers(value);
    else if (word == "--busy")
      given.busy = static_cast<unsigned>(numbers(value)[0]);
    else if (word == "--seconds")
      given.seconds = std::atof(value.c_str());
    else if (word == "--seed")
      given.seed = numbers(value)[0];
    else if (word == "--qhull")
      given.qhull = numbers(value)[0] != 0;
    else if (word == "--rival" && value.find('=') != std::string::npos)
      given.rivals.push_back({value.substr(0, value.find('=')), value.substr(value.find('=') + 1)});
    else
      argc = 0;
  }
  if (argc == 0 || argc % 2 == 0) {
    std::fprintf(stderr,
                 "usage: call_bench [--d 2,3] [--shape ball,sphere] [--n 10,100] [--threads 0,1,2]"
                 " [--callers 1,4]\n                  [--busy K] [--seconds S] [--seed N]"
                 " [--qhull 0|1] [--rival NAME=PROGRAM ...]\n");
    std::exit(2);
  }
  return given;
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments given = parse(argc, argv);
  for (const std::uint64_t d : given.dimensions)
    for (const std::string& shape : given.shapes)
      for (const std::uint64_t n : given.counts) run(shape, n, static_cast<unsigned>(d), given);
  return sink == 1 ? 1 : 0;
}
