#include "parallel/crew.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cstdint>

#include "parallel/parallel.hpp"

#if defined(__SANITIZE_THREAD__)
#define CULLHULL_THREAD_SANITIZER
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define CULLHULL_THREAD_SANITIZER
#endif
#endif

namespace cullhull::internal {

struct Crew::Arena {
  oneapi::tbb::task_arena arena;
};

// oneTBB warns on standard error about arenas wider than the machine; the library never prints.
Crew::Crew(unsigned threads) : lanes_(std::max(1U, threads)) {
  if (lanes_ == 1) return;
#ifndef CULLHULL_THREAD_SANITIZER
  const int machine = std::max(1, oneapi::tbb::this_task_arena::max_concurrency());
  arena_ = std::make_unique<Arena>();
  arena_->arena.initialize(std::min(static_cast<int>(lanes_), machine));
#endif
}

Crew::~Crew() = default;

void Crew::run(const std::function<void(unsigned lane)>& body) {
  if (lanes_ == 1) {
    body(0);
    return;
  }
#ifdef CULLHULL_THREAD_SANITIZER
  // Plain threads, whose hand-overs the sanitizer sees (parallel.cpp).
  for_each_chunk(lanes_, 1, lanes_, [&](std::uint64_t lane, std::uint64_t, std::uint64_t) {
    body(static_cast<unsigned>(lane));
  });
#else
  arena_->arena.execute([&] {
    oneapi::tbb::parallel_for(0U, lanes_, [&](unsigned lane) { body(lane); },
                              oneapi::tbb::simple_partitioner{});
  });
#endif
}

}  // namespace cullhull::internal
