#include "calls.hpp"

#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <barrier>
#include <chrono>
#include <csignal>
#include <cstring>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <thread>

#include "cgal.hpp"
#include "child.hpp"
#include "contest.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/error.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/io.hpp"
#include "families.hpp"
#include "machine.hpp"
#include "qhull.hpp"
#include "timing.hpp"

namespace cullhull::bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// ------------------------------------------------------------------------------------ the sets

/// `count` sets of n points, concatenated.
struct Sets {
  std::uint64_t n = 0, count = 0;
  Points points;

  PointView operator[](std::uint64_t i) const { return part(points.view, i % count * n, n); }
  PointView doubles(std::uint64_t i) const { return part(points.doubles, i % count * n, n); }
  PointView all() const { return points.doubles; }

 private:
  static PointView part(PointView view, std::uint64_t first, std::uint64_t n) {
    view.data = view.address(first, 0);
    view.count = n;
    return view;
  }
};

/// At least three sets, and enough to exceed the last-level cache.
Sets make_sets(const Workload& w, std::uint64_t seed) {
  constexpr std::uint64_t coordinates = std::uint64_t{1} << 21;
  Sets sets;
  sets.n = w.count;
  sets.count = std::clamp<std::uint64_t>(
      coordinates / (std::max<std::uint64_t>(w.count, 1) * w.dimension), 3, 2000);
  std::vector<double> rows;
  for (std::uint64_t i = 0; i < sets.count; ++i) {
    const std::vector<double> set = generate(w.family, w.count, w.dimension, seed + i);
    rows.insert(rows.end(), set.begin(), set.end());
  }
  sets.points = points_of(w, std::move(rows));
  return sets;
}

// ------------------------------------------------------------------------------- who is timed

/// A kind of call on sets of `Sets`; `times` receives the seconds of each call.
struct Contestant {
  std::string name;
  unsigned callers = 1;
  std::function<double(std::uint64_t)> call{};         ///< with set i; thread safe for cullhull
  std::function<std::vector<double>()> all_at_once{};  ///< used instead of `call` for programs
  std::vector<double> times{};
  std::uint64_t next = 0;
};

/// Reads the size of every list, so that lists created on access are created.
std::uint64_t ask_for_all(const Hull& h) {
  return h.vertices.size() + h.simplices.size() + h.simplex_neighbours.size() +
         h.simplex_facets.size() + h.facets.items.size() + h.facet_neighbours.items.size() +
         h.facet_planes.size() + (h.volume > 0 ? 1 : 0);
}

std::atomic<std::uint64_t> sink{0};  // keeps the compiler from removing calls

double time_ours(const PointView& set, const Options& options) {
  const Clock::time_point start = Clock::now();
  sink += ask_for_all(convex_hull(set, options));
  return seconds_since(start);
}

/// Times a separate program, on every set once.
std::vector<double> time_program(const Sets& sets, const RivalProgram& rival,
                                 const ChildLimits& limits) {
  const Scratch file;
  const PointView all = sets.all();
  write_npy_points(file.path, reinterpret_cast<const double*>(all.data), all.count, all.dimension,
                   ScalarType::f64);
  const auto child = run_program({rival.path, file.path, std::to_string(sets.count)}, limits);
  if (child && child->timed_out) return {};
  if (!child || child->output.size() != sets.count * sizeof(double))
    throw Error(ErrorCode::io, rival.path + ": no rival that writes the seconds of " +
                                   std::to_string(sets.count) + " sets");
  std::vector<double> times(sets.count);
  std::memcpy(times.data(), child->output.data(), child->output.size());
  return times;
}

/// Processes that keep cores busy until this object is destroyed.
class Busy {
 public:
  explicit Busy(unsigned count) {
    for (unsigned k = 0; k < count; ++k) {
      const pid_t child = ::fork();
      if (child == 0) {
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        for (std::atomic<std::uint64_t> i{0};;) i.store(i.load() + 1, std::memory_order_relaxed);
      }
      if (child < 0) throw Error(ErrorCode::io, "cannot start a process to keep a core busy");
      children_.push_back(child);
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

/// Repeats calls until `seconds` have passed, at least once.
void one_caller(const Contestant& c, std::uint64_t first, double seconds,
                std::vector<double>& times) {
  double spent = 0;
  for (std::uint64_t i = first; spent < seconds || i == first; ++i) {
    times.push_back(c.call(i));
    spent += times.back();
  }
}

void turn(Contestant& c, double seconds, std::uint64_t sets) {
  if (c.callers == 1) {
    const std::size_t before = c.times.size();
    one_caller(c, c.next, seconds, c.times);
    c.next += c.times.size() - before;
    return;
  }
  std::vector<std::vector<double>> times(c.callers);
  std::barrier start(static_cast<std::ptrdiff_t>(c.callers));
  std::vector<std::thread> threads;
  for (unsigned k = 0; k < c.callers; ++k)
    threads.emplace_back([&, k] {
      start.arrive_and_wait();
      one_caller(c, c.next + k * (sets / c.callers), seconds, times[k]);
    });
  for (std::thread& t : threads) t.join();
  ++c.next;
  for (const std::vector<double>& t : times) c.times.insert(c.times.end(), t.begin(), t.end());
}

double quantile(std::vector<double> v, double q) {
  if (v.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto at = static_cast<std::ptrdiff_t>(q * static_cast<double>(v.size() - 1));
  std::nth_element(v.begin(), v.begin() + at, v.end());
  return v[static_cast<std::size_t>(at)];
}

// ----------------------------------------------------------------------------------- the suite

class CallsSuite {
 public:
  CallsSuite(const CallSettings& settings, const Progress& progress, const std::stop_token& stop)
      : settings_(settings), steps_(progress, stop) {
    if (settings.with_cgal && !cgal_program().empty()) rivals_.push_back({"CGAL", cgal_program()});
    rivals_.insert(rivals_.end(), settings.rivals.begin(), settings.rivals.end());
    first_call_ = settings.first_call;
    if (first_call_.empty()) first_call_ = program_beside("cullhull");
  }

  Report run() {
    const std::vector<Workload>& wanted =
        settings_.workloads.empty() ? call_workloads() : settings_.workloads;
    for (const Workload& w : wanted) check(w);
    report_ = begin_report("calls");
    report_.command = command();
    for (const unsigned busy : settings_.busy) report_.figures.push_back(figure_of(busy));
    if (!first_call_.empty()) report_.figures.push_back(first_calls());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      steps_.row(i, wanted.size());
      measure(wanted[i]);
    }
    return std::move(report_);
  }

 private:
  static void check(const Workload& w) {
    try {
      generate(w.family, 1, w.dimension);
    } catch (const Error&) {
      throw Error(ErrorCode::invalid_argument, "bench calls knows no points '" + w.family +
                                                   "' of dimension " + std::to_string(w.dimension));
    }
  }

  std::string command() const {
    std::string text =
        fmt::format("cullhull-bench calls --seconds {:g} --seed {} --threads {}", settings_.seconds,
                    settings_.seed, fmt::join(settings_.threads, ","));
    text += fmt::format(" --callers {} --busy {}", fmt::join(settings_.callers, ","),
                        fmt::join(settings_.busy, ","));
    for (const Workload& w : settings_.workloads) text += " --workload " + w.name();
    for (const RivalProgram& r : settings_.rivals) text += " --rival " + r.name + "=" + r.path;
    if (!settings_.with_qhull) text += " --without qhull";
    if (!settings_.with_cgal) text += " --without cgal";
    return text;
  }

  static Figure figure_of(unsigned busy) {
    Figure f{"calls", "Single calls", "s", "", false, {}};
    if (busy > 0) {
      f.id = fmt::format("calls-{}-busy", busy);
      f.title = fmt::format("Single calls beside {} busy process{}", busy, busy == 1 ? "" : "es");
    }
    f.note =
        "Median and 99th percentile of a call. Ratio: the median of the fastest rival over ours "
        "by default. CGAL and other programs have a turn of their own, after the rest.";
    return f;
  }

  static Figure first_calls() {
    return {"first-calls", "The first call of a process",
            "s",           "Ratio: the first call over the median of those that follow.",
            false,         {}};
  }

  Row row_of(const Workload& w, const Hull& hull, const Certificate& certificate) const {
    Row row = begin_row(w);
    row.vertices = hull.vertices.size();
    row.agrees = certificate.valid;
    row.check = certificate.valid ? "certified" : "NOT certified: " + certificate.reason;
    return row;
  }

  void measure(const Workload& w) {
    steps_.step(w.name() + ", points");
    const Sets sets = make_sets(w, settings_.seed);
    const Hull hull = convex_hull(sets[0]);
    const Row row = row_of(w, hull, certify(sets[0], hull));
    for (std::size_t f = 0; f < settings_.busy.size(); ++f) {
      std::vector<Contestant> contestants = contestants_on(sets);
      take_turns(w, contestants, settings_.busy[f], sets.count);
      report_.figures[f].rows.push_back(filled(row, contestants));
    }
    if (!first_call_.empty()) report_.figures.back().rows.push_back(first_call(w, sets, row));
  }

  std::vector<Contestant> contestants_on(const Sets& sets) const {
    std::vector<Contestant> all;
    for (const unsigned callers : settings_.callers)
      for (const unsigned threads : settings_.threads) {
        Options options;
        options.threads = threads;
        options.stop = steps_.stop();
        std::string name = "cullhull";
        if (threads > 0) name += fmt::format(", {} thread{}", threads, threads == 1 ? "" : "s");
        if (callers > 1) name += fmt::format(", {} callers", callers);
        all.push_back({name, callers,
                       [&sets, options](std::uint64_t i) { return time_ours(sets[i], options); }});
      }
    if (settings_.with_qhull && has_qhull())
      all.push_back(
          {"Qhull", 1, [&sets](std::uint64_t i) { return qhull_seconds(sets.doubles(i)); }});
    for (const RivalProgram& rival : rivals_)
      if (rival.name != "CGAL" || sets.all().dimension <= 3)
        all.push_back({rival.name, 1, {}, [&sets, &rival, this] {
                         return time_program(sets, rival, {settings_.limit, steps_.stop()});
                       }});
    return all;
  }

  void take_turns(const Workload& w, std::vector<Contestant>& contestants, unsigned busy,
                  std::uint64_t sets) const {
    constexpr unsigned slices = 5;
    const Busy others(busy);
    for (unsigned s = 0; s < slices; ++s)
      for (Contestant& c : contestants) {
        if (c.all_at_once && s + 1 < slices) continue;
        steps_.step(w.name() + ", " + c.name);
        if (c.all_at_once)
          c.times = c.all_at_once();
        else
          turn(c, settings_.seconds / slices, sets);
      }
  }

  static Row filled(Row row, const std::vector<Contestant>& contestants) {
    double best = std::numeric_limits<double>::infinity();
    std::string fastest;
    for (const Contestant& c : contestants) {
      const double middle = quantile(c.times, 0.5);
      row.values.emplace_back(c.name, middle);
      row.values.emplace_back(c.name + ", 99 %", quantile(c.times, 0.99));
      if (!c.name.starts_with("cullhull") && middle < best) {
        best = middle;
        fastest = c.name;
      }
    }
    if (fastest.empty()) return row;
    row.ratio = best / row.values.front().second;
    if (row.ratio < 1) row.slower = "than " + fastest;
    return row;
  }

  /// Times set 0 in a new process; reports its first call separately from later ones.
  Row first_call(const Workload& w, const Sets& sets, Row row) const {
    steps_.step(w.name() + ", first call");
    const Scratch file;
    const PointView set = sets.doubles(0);
    write_npy_points(file.path, reinterpret_cast<const double*>(set.data), set.count, set.dimension,
                     w.scalar);
    const auto child = run_program(
        {first_call_, "hull", file.path, "--repeat", "9", "--json", "--quiet"}, {0, steps_.stop()});
    std::vector<double> seconds;
    try {
      const auto json = nlohmann::json::parse(child ? child->output : "");
      seconds = json.at("compute_seconds_all").get<std::vector<double>>();
    } catch (const nlohmann::json::exception&) {
    }
    if (seconds.size() < 2)
      throw Error(ErrorCode::io, first_call_ + ": no program that tells the seconds of its calls");
    const double first = seconds.front();
    const double later = median({seconds.begin() + 1, seconds.end()});
    row.values = {{"first", first}, {"later", later}};
    row.ratio = first / later;
    return row;
  }

  const CallSettings& settings_;
  Steps steps_;
  std::vector<RivalProgram> rivals_;
  std::string first_call_;
  Report report_;
};

}  // namespace

const std::vector<Workload>& call_workloads() {
  static const std::vector<Workload> workloads = [] {
    std::vector<Workload> all;
    for (const unsigned d : {2U, 3U, 4U})
      for (const char* shape : {"ball", "sphere"})
        for (const std::uint64_t n : {10, 100, 1'000, 10'000, 100'000})
          if (d < 4 || n <= 10'000) all.push_back({shape, d, n});
    for (const std::uint64_t n : {1'000, 100'000}) all.push_back({"ball", 3, n, ScalarType::f32});
    return all;
  }();
  return workloads;
}

Report run_calls(const CallSettings& settings, const Progress& progress,
                 const std::stop_token& stop) {
  return CallsSuite(settings, progress, stop).run();
}

}  // namespace cullhull::bench
