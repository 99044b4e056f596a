#include "machine.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>

#include "cullhull/error.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::bench {
namespace {

constexpr std::uint64_t mebibyte = 1U << 20;
/// The unit of work that one core reads at a time.
constexpr std::uint64_t piece = 4 * mebibyte / sizeof(std::uint64_t);

/// Uses eight sums, so that additions do not wait for each other.
std::uint64_t sum_of(const std::uint64_t* p, std::uint64_t count) {
  std::uint64_t sum[8] = {};
  std::uint64_t i = 0;
  for (; i + 8 <= count; i += 8)
    for (unsigned k = 0; k < 8; ++k) sum[k] += p[i + k];
  for (; i < count; ++i) sum[0] += p[i];
  for (unsigned k = 1; k < 8; ++k) sum[0] += sum[k];
  return sum[0];
}

template <class Work>
double best_rate(unsigned passes, double bytes, const std::stop_token& stop, const Work& work) {
  double best = 0;
  for (unsigned pass = 0; pass < passes; ++pass) {
    if (stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    best = std::max(best, bytes / std::max(took.count(), 1e-9));
  }
  return best;
}

std::uint64_t default_bytes() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
  const std::uint64_t memory =
      pages > 0 && page > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page)
                            : 1024 * mebibyte;
  return std::clamp(memory / 16, 16 * mebibyte, 512 * mebibyte);
}

/// An array to be read.
class HostMemory {
 public:
  HostMemory(std::uint64_t bytes, unsigned threads)
      : words_(bytes / sizeof(std::uint64_t)), from_(words_) {
    // First touch by the threads that use the pages later, approximately.
    internal::for_each_chunk(words_, piece, threads,
                             [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      std::fill(from_.get() + begin, from_.get() + end, begin);
    });
  }
  double bytes() const { return static_cast<double>(words_ * sizeof(std::uint64_t)); }
  void read(unsigned threads) const {
    static std::atomic<std::uint64_t> sink;  // keeps the compiler from removing the sums
    internal::for_each_chunk(words_, piece, threads,
                             [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      sink.store(sum_of(from_.get() + begin, end - begin), std::memory_order_relaxed);
    });
  }

 private:
  std::uint64_t words_;
  internal::BigArray<std::uint64_t> from_;
};

}  // namespace

std::string date_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts = {};
  ::gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

double read_bandwidth(unsigned threads, const std::stop_token& stop) {
  constexpr unsigned passes = 5;
  const HostMemory memory(default_bytes(), threads);
  return best_rate(passes, memory.bytes(), stop, [&] { memory.read(threads); });
}

}  // namespace cullhull::bench
