#include "parallel/threads/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <vector>

#include "parallel/threads/crowding.hpp"
#include "parallel/threads/helpers.hpp"

namespace cullhull::internal {
namespace {

using Body = std::function<void(const Chunk&)>;
using Clock = std::chrono::steady_clock;

/// A loop that several threads run. Each thread begins with a contiguous part of the chunks, so
/// that it touches few memory pages that others use, and then steals chunks from the back of other
/// parts, which their owners reach last. The object may outlive the call, but uses `body` only for
/// chunks that the caller waits for.
class Loop : public SharedWork {
 public:
  Loop(std::uint64_t items, std::uint64_t chunk_size, unsigned parts, const Body& body)
      : items_(items),
        size_(chunk_size),
        count_(chunk_count(items, chunk_size)),
        body_(&body),
        parts_(parts) {
    for (unsigned p = 0; p < parts; ++p)
      parts_[p].left.store(count_ * p / parts << 32 | count_ * (p + 1) / parts,
                           std::memory_order_relaxed);
  }

  void join(unsigned k) noexcept override { work(k); }

  /// Runs chunks until all chunks have begun, first those of part k. Returns how many it ran.
  std::uint64_t work(unsigned k) noexcept {
    std::uint64_t done = 0;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      Part& part = parts_[(k + p) % parts_.size()];
      for (std::uint64_t c = part.take(p == 0); c != none; c = part.take(p == 0)) {
        std::uint64_t over = 1;
        try {
          (*body_)({c, c * size_, std::min(items_, (c + 1) * size_), k});
        } catch (...) {
          if (!failed_.exchange(true)) error_ = std::current_exception();
          over += give_up();
        }
        over_.fetch_add(over, std::memory_order_release);
        ++done;
      }
    }
    return done;
  }

  /// Waits for the chunks that helpers have begun and rethrows the first exception. `each`: the
  /// mean time of the caller's own chunks.
  void wait(Clock::duration each) const {
    if (over_.load(std::memory_order_acquire) < count_) {
      const Clock::time_point begin = Clock::now();
      Patience patience;
      while (over_.load(std::memory_order_acquire) < count_) patience.wait_a_little();
      note_wait(each, Clock::now() - begin);
    }
    if (error_) std::rethrow_exception(error_);
  }

 private:
  static constexpr std::uint64_t none = ~std::uint64_t{0};

  struct alignas(64) Part {
    /// The first chunk that has not begun, above the end of those: taking from either end is one
    /// compare-and-exchange.
    std::atomic<std::uint64_t> left{0};

    std::uint64_t take(bool front) {
      std::uint64_t l = left.load(std::memory_order_relaxed);
      do {
        if (l >> 32 >= (l & 0xFFFFFFFF)) return none;
      } while (!left.compare_exchange_weak(l, front ? l + (std::uint64_t{1} << 32) : l - 1));
      return front ? l >> 32 : (l & 0xFFFFFFFF) - 1;
    }
  };

  /// Prevents every thread from beginning another chunk. Returns how many had not begun.
  std::uint64_t give_up() noexcept {
    std::uint64_t left = 0;
    for (Part& part : parts_) {
      const std::uint64_t l = part.left.exchange(0);
      left += (l & 0xFFFFFFFF) - (l >> 32);
    }
    return left;
  }

  const std::uint64_t items_, size_, count_;
  const Body* const body_;
  std::vector<Part> parts_;
  alignas(64) std::atomic<std::uint64_t> over_{0};
  std::atomic<bool> failed_{false};
  std::exception_ptr error_;
};

}  // namespace

unsigned resolve_threads(unsigned requested) {
  return requested > 0 ? std::min(requested, 1024U) : machine_threads();
}

void run_chunks(std::uint64_t count, std::uint64_t chunk_size, unsigned threads, const Body& body,
                [[maybe_unused]] CodePlace where) {
  const std::uint64_t chunks = chunk_count(count, chunk_size);
  const auto chunk = [&](std::uint64_t c, unsigned lane) {
    body({c, c * chunk_size, std::min(count, (c + 1) * chunk_size), lane});
  };
  if (threads <= 1 || chunks <= 1 || chunks >> 32 != 0) {  // a chunk's number has 32 bits
    for (std::uint64_t c = 0; c < chunks; ++c) chunk(c, 0);
    return;
  }
  const auto parts = static_cast<unsigned>(std::min<std::uint64_t>(threads, chunks));
#ifdef CULLHULL_SPAN_ACCOUNT
  if (counting_spans()) {
    const auto one = [&](std::uint64_t c) {
      chunk(c, static_cast<unsigned>((c * parts + parts - 1) / chunks));
    };
    if (counts_loop()) return run_counted_loop(chunks, parts, where, one);
    for (std::uint64_t c = 0; c < chunks; ++c) one(c);
    return;
  }
#endif
  const Clock::time_point begin = Clock::now();
  const auto loop = std::make_shared<Loop>(count, chunk_size, parts, body);
  std::uint64_t done = 0;
  {
    const OpenWork open(parts - 1, loop);
    done = loop->work(0);
  }
  const Clock::duration each = (Clock::now() - begin) / std::max<std::uint64_t>(done, 1);
  loop->wait(each);
}

}  // namespace cullhull::internal
