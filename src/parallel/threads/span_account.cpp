#include "parallel/threads/span_account.hpp"

#ifdef CULLHULL_SPAN_ACCOUNT

#include <algorithm>
#include <ctime>
#include <limits>
#include <map>
#include <queue>
#include <utility>

namespace cullhull::internal {
namespace {

/// What handing a loop to the helpers takes, in seconds (for_each_chunk).
constexpr double hand_out = 5e-6;

double now() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Keeper {
  unsigned workers = 1;
  bool in_loop = false;
  double mark = 0;  ///< when the last loop ended
  std::string last = "begin";
  std::map<std::string, SpanStretch> stretches;
  std::map<const void*, double> held;  ///< of the loop that runs, by lock
  double serial = 0, looped = 0, spans = 0;
};

thread_local Keeper* keeper = nullptr;

std::string name_of(const CodePlace& where) {
  const std::string file = where.file;
  const std::size_t at = file.rfind("src/");
  return (at == std::string::npos ? file : file.substr(at + 4)) + ":" + std::to_string(where.line);
}

/// When `workers` are done with chunks of these times, each first with its own contiguous part.
double span_of(const std::vector<double>& times, unsigned workers) {
  const std::size_t count = times.size();
  const std::size_t parts = std::min<std::size_t>(workers, count);
  std::vector<std::size_t> next(parts), end(parts);
  for (std::size_t p = 0; p < parts; ++p) {
    next[p] = count * p / parts;
    end[p] = count * (p + 1) / parts;
  }
  using At = std::pair<double, std::size_t>;  // when a worker is free, and its number
  std::priority_queue<At, std::vector<At>, std::greater<>> free;
  for (std::size_t p = 0; p < parts; ++p) free.emplace(0.0, p);
  double last = 0;
  while (!free.empty()) {
    auto [at, worker] = free.top();
    free.pop();
    std::size_t q = 0;
    while (q < parts && next[(worker + q) % parts] == end[(worker + q) % parts]) ++q;
    if (q == parts) {
      last = std::max(last, at);
    } else {
      free.emplace(at + times[next[(worker + q) % parts]++], worker);
    }
  }
  return last;
}

void end_serial(Keeper& k, const std::string& next) {
  const double seconds = now() - k.mark;
  k.serial += seconds;
  SpanStretch& s = k.stretches["from " + k.last + " to " + next];
  s.serial = true;
  ++s.calls;
  s.work += seconds;
  s.span += seconds;
  s.longest = std::max(s.longest, seconds);
}

}  // namespace

bool counting_spans() { return keeper != nullptr; }
bool counts_loop() { return keeper != nullptr && !keeper->in_loop; }

void run_counted_loop(std::uint64_t count, unsigned workers, const CodePlace& where,
                      const std::function<void(std::uint64_t)>& item) {
  Keeper& k = *keeper;
  const std::string name = name_of(where);
  end_serial(k, name);
  k.in_loop = true;
  k.held.clear();
  // The loop ends, too, when an item throws.
  struct End {
    Keeper& k;
    const std::string& name;
    ~End() {
      k.in_loop = false;
      k.last = name;
      k.mark = now();
    }
  } const end{k, name};
  std::vector<double> times(count);
  double at = now();
  for (std::uint64_t i = 0; i < count; ++i) {
    item(i);
    const double next = now();
    times[i] = next - at;
    at = next;
  }
  double span = span_of(times, workers) + hand_out;
  for (const auto& [lock, seconds] : k.held) span = std::max(span, seconds);
  SpanStretch& s = k.stretches[name];
  ++s.calls;
  s.chunks += count;
  s.span += span;
  for (const double t : times) {
    s.work += t;
    k.looped += t;
    s.longest = std::max(s.longest, t);
  }
  k.spans += span;
}

SpanAccount account_of_spans(unsigned workers, const std::function<void()>& work) {
  Keeper kept;
  kept.workers = workers;
  struct Kept {
    explicit Kept(Keeper* k) { keeper = k; }
    ~Kept() { keeper = nullptr; }
  } const scope(&kept);
  kept.mark = now();
  work();
  end_serial(kept, "end");
  SpanAccount account{kept.serial + kept.looped, kept.serial + kept.spans, kept.serial, {}};
  for (auto& [name, stretch] : kept.stretches) {
    stretch.name = name;
    account.stretches.push_back(stretch);
  }
  std::sort(account.stretches.begin(), account.stretches.end(),
            [](const SpanStretch& a, const SpanStretch& b) { return a.span > b.span; });
  return account;
}

LockSpan::LockSpan(const void* lock) : lock_(lock), begin_(keeper != nullptr ? now() : 0) {}
LockSpan::~LockSpan() {
  if (keeper != nullptr) keeper->held[lock_] += now() - begin_;
}

}  // namespace cullhull::internal

#endif
