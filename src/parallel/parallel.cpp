#include "parallel/parallel.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "parallel/thread_sanitizer.hpp"

namespace cullhull::internal {

#ifdef CULLHULL_THREAD_SANITIZER
namespace {

/// ThreadSanitizer does not see the synchronisation inside oneTBB's library and would report every
/// hand-over as a race; plain threads let it look at our own code.
template <class Run>
void run_on_threads(std::uint64_t chunks, unsigned threads, const Run& run) {
  std::atomic<std::uint64_t> next{0};
  std::exception_ptr error;
  std::mutex error_mutex;
  std::vector<std::thread> pool;
  for (std::uint64_t t = 0; t < std::min<std::uint64_t>(threads, chunks); ++t)
    pool.emplace_back([&] {
      try {
        for (std::uint64_t c = next++; c < chunks; c = next++) run(c);
      } catch (...) {
        const std::lock_guard lock(error_mutex);
        error = std::current_exception();
        next = chunks;
      }
    });
  for (std::thread& t : pool) t.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace
#endif

unsigned resolve_threads(unsigned requested) {
  const auto machine =
      static_cast<unsigned>(std::max(1, oneapi::tbb::this_task_arena::max_concurrency()));
  return requested > 0 ? std::min(requested, 1024U) : machine;
}

void for_each_chunk(
    std::uint64_t count, std::uint64_t chunk_size, unsigned threads,
    const std::function<void(std::uint64_t chunk, std::uint64_t begin, std::uint64_t end)>& body) {
  const std::uint64_t chunks = chunk_count(count, chunk_size);
  const auto run = [&](std::uint64_t c) {
    body(c, c * chunk_size, std::min(count, (c + 1) * chunk_size));
  };
  if (threads <= 1 || chunks <= 1) {
    for (std::uint64_t c = 0; c < chunks; ++c) run(c);
    return;
  }
#ifdef CULLHULL_THREAD_SANITIZER
  run_on_threads(chunks, threads, run);
#else
  // oneTBB warns on standard error about arenas wider than the machine; the library never prints.
  const int machine = oneapi::tbb::this_task_arena::max_concurrency();
  oneapi::tbb::task_arena arena(std::min(static_cast<int>(threads), std::max(1, machine)));
  arena.execute([&] {
    oneapi::tbb::parallel_for(std::uint64_t{0}, chunks, run, oneapi::tbb::simple_partitioner{});
  });
#endif
}

}  // namespace cullhull::internal
