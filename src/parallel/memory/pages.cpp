#include "parallel/memory/pages.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <map>
#include <mutex>
#include <new>
#include <optional>

#include "parallel/threads/fork_guard.hpp"

#if defined(__linux__)
#include <sys/mman.h>

#include "parallel/memory/memory.hpp"
#endif

namespace cullhull::internal {
namespace {

constexpr std::align_val_t alignment{64};

/// Unused blocks of less than mapped_block bytes, kept for reuse. Without them malloc returns the
/// end of its heap to the system after nearly every hull of 10,000 points and requests it again for
/// the next hull, and the system clears it page by page. That took half of the time of a hull of
/// 10,000 points on a circle.
class FreeBlocks {
 public:
  void lock() { mutex_.lock(); }
  void unlock() { mutex_.unlock(); }
  void limit(std::size_t bytes) noexcept {
    const std::lock_guard lock(mutex_);
    limit_ = std::min(bytes, most);
    for (unsigned c = classes; kept_ > limit_; --c)
      while (counts_[c - 1] > 0 && kept_ > limit_) drop(c - 1);
  }
  std::size_t kept() noexcept {
    const std::lock_guard lock(mutex_);
    return kept_;
  }
  void* take(std::size_t bytes) {
    const unsigned c = class_of(bytes);
    {
      const std::lock_guard lock(mutex_);
      if (counts_[c] > 0) {
        kept_ -= size_of(c);
        return blocks_[c][--counts_[c]];
      }
    }
    return ::operator new(size_of(c), alignment);
  }
  void give(void* block, std::size_t bytes) noexcept {
    const unsigned c = class_of(bytes);
    {
      const std::lock_guard lock(mutex_);
      if (counts_[c] < room && kept_ + size_of(c) <= limit_) {
        blocks_[c][counts_[c]++] = block;
        kept_ += size_of(c);
        return;
      }
    }
    ::operator delete(block, alignment);
  }

 private:
  /// The most bytes kept: enough for the arrays of one call and its result, for several callers.
  static constexpr std::size_t most = std::size_t{16} << 20;

  /// Block sizes are rounded up to one of four sizes in each octave, which wastes at most a fifth
  /// of a block.
  static constexpr unsigned octaves = std::countr_zero(mapped_block) - std::countr_zero(kept_block);
  static constexpr unsigned classes = 4 * octaves + 1;

  static constexpr unsigned room = 64;  // most blocks kept of a class; a guess, not tuned

  static unsigned class_of(std::size_t bytes) {
    const std::size_t quarter = std::bit_floor(bytes) / 4;
    const auto octave = static_cast<unsigned>(std::countr_zero(4 * quarter / kept_block));
    return 4 * octave + static_cast<unsigned>((bytes - 4 * quarter + quarter - 1) / quarter);
  }
  static std::size_t size_of(unsigned c) { return (kept_block << c / 4) / 4 * (4 + c % 4); }

  void drop(unsigned c) noexcept {
    ::operator delete(blocks_[c][--counts_[c]], alignment);
    kept_ -= size_of(c);
  }

  std::mutex mutex_;
  std::size_t limit_ = most, kept_ = 0;
  std::uint8_t counts_[classes] = {};
  void* blocks_[classes][room];  ///< not initialised: pages that the first call need not touch
};

FreeBlocks& free_blocks() {
  static auto* blocks = new FreeBlocks;  // outlives every static array
  return *blocks;
}

const ForkGuard blocks_guard(
    ForkGuard::Order::inner, [] { free_blocks().lock(); }, [] { free_blocks().unlock(); });

}  // namespace

#if defined(__linux__)

namespace {

constexpr std::size_t page = std::size_t{2} << 20;
std::size_t whole_pages(std::size_t bytes) { return (bytes + page - 1) / page * page; }

char* map_pages(std::size_t bytes) {
  // The system often chooses an aligned address next to an earlier block. When freed, the two can
  // then be kept as one range.
  void* p = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (p == MAP_FAILED) throw std::bad_alloc();
  if (reinterpret_cast<std::uintptr_t>(p) % page == 0) {
    madvise(p, bytes, MADV_HUGEPAGE);  // advice only: affects nothing but speed
    return static_cast<char*>(p);
  }
  munmap(p, bytes);
  // Otherwise map one page more and unmap the parts before and after the aligned pages.
  p = mmap(nullptr, bytes + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (p == MAP_FAILED) throw std::bad_alloc();
  const auto address = reinterpret_cast<std::uintptr_t>(p);
  const std::size_t before = (page - address % page) % page;
  if (before > 0) munmap(p, before);
  char* start = static_cast<char*>(p) + before;
  if (before < page) munmap(start + bytes, page - before);
  madvise(start, bytes, MADV_HUGEPAGE);
  return start;
}

}  // namespace

void prefer_huge_pages(void* begin, std::size_t bytes) noexcept {
  const auto address = reinterpret_cast<std::uintptr_t>(begin);
  const std::uintptr_t first = (address + page - 1) / page * page;
  const std::uintptr_t last = (address + bytes) / page * page;
  if (last > first) madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
}

namespace {

std::size_t usual_limit() noexcept {
  // The most bytes kept between calls, even on a machine with much memory.
  constexpr std::size_t most = std::size_t{1} << 30;
  try {
    const std::uint64_t memory = machine_memory();
    return memory == 0 ? most / 4 : std::min<std::size_t>(most, memory / 16);
  } catch (const std::bad_alloc&) {
    return 0;
  }
}

/// PageScopes of the calling thread.
thread_local unsigned scopes_here = 0;

/// Unused ranges of whole huge pages, kept for reuse. Adjacent ranges are joined.
class FreePages {
 public:
  void lock() { mutex_.lock(); }
  void unlock() { mutex_.unlock(); }
  /// Unlocks in a forked child, which has none of the other threads and so none of their scopes.
  void unlock_in_child() {
    scopes_ = scopes_here;
    mutex_.unlock();
  }
  void open() {
    const std::lock_guard lock(mutex_);
    ++scopes_;
    ++scopes_here;
  }
  void close() {
    const std::lock_guard lock(mutex_);
    --scopes_here;
    if (--scopes_ > 0 || kept_ == 0) return;
    shrink(most_kept());
    for (auto& [start, range] : ranges_) {
      if (range.written_end > range.written) offer(range.written, range.written_end);
      range.written = range.written_end = nullptr;
    }
  }
  void limit(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    limit_ = bytes;
    if (scopes_ == 0) shrink(bytes);
  }
  void trim(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    shrink(bytes);
  }
  std::size_t kept() {
    const std::lock_guard lock(mutex_);
    return kept_;
  }

  /// Takes `bytes` bytes of the smallest range that is large enough. If there is no such range,
  /// takes the whole largest range, provided that it has at least `least` bytes, and sets `bytes`
  /// to its size. Returns nullptr if no range has `least` bytes.
  char* take(std::size_t& bytes, std::size_t least) {
    const std::lock_guard lock(mutex_);
    auto best = ranges_.end(), largest = best;
    for (auto it = ranges_.begin(); it != ranges_.end(); ++it) {
      const std::size_t size = it->second.bytes;
      if (size >= bytes && (best == ranges_.end() || size < best->second.bytes)) best = it;
      if (largest == ranges_.end() || size > largest->second.bytes) largest = it;
    }
    if (best == ranges_.end()) best = largest;
    if (best == ranges_.end() || best->second.bytes < least) return nullptr;
    bytes = std::min(bytes, best->second.bytes);
    char* start = best->first;
    Range rest = best->second;
    rest.bytes -= bytes;
    rest.written = std::max(rest.written, start + bytes);
    ranges_.erase(best);
    kept_ -= bytes;
    if (rest.bytes > 0) ranges_.emplace(start + bytes, rest);
    return start;
  }

  /// Keeps a range for reuse. Returns false, without keeping it, if that would exceed the limit
  /// outside of every PageScope, or if there is no memory for an entry of ranges_.
  bool give(char* start, std::size_t bytes) noexcept {
    const std::lock_guard lock(mutex_);
    if (scopes_ == 0 && (bytes > most_kept() || kept_ > most_kept() - bytes)) return false;
    Range range{bytes, start, start + bytes};
    if (scopes_ == 0) {
      offer(start, start + bytes);
      range.written = range.written_end = nullptr;
    }
    try {
      auto it = ranges_.emplace(start, range).first;
      kept_ += bytes;
      if (const auto after = std::next(it);
          after != ranges_.end() && it->first + it->second.bytes == after->first) {
        it->second.append(after->second);
        ranges_.erase(after);
      }
      if (it != ranges_.begin())
        if (const auto before = std::prev(it); before->first + before->second.bytes == it->first) {
          before->second.append(it->second);
          ranges_.erase(it);
        }
      return true;
    } catch (const std::bad_alloc&) {
      return false;
    }
  }

 private:
  /// An unused range. What may have been written since it was last offered to the system lies in
  /// [written, written_end). Without these, each call offered all kept memory again: 0.3 ms after a
  /// hull of 100,000 points, where the pages are small.
  struct Range {
    std::size_t bytes;
    char *written, *written_end;
    /// Appends the range that begins where this one ends.
    void append(const Range& next) {
      bytes += next.bytes;
      if (next.written_end <= next.written) return;
      if (written_end <= written) written = next.written;
      written_end = next.written_end;
    }
  };

  /// Allows the system to reclaim these pages, discarding their contents, until they are written
  /// again.
  static void offer(char* begin, char* end) {
    madvise(begin, static_cast<std::size_t>(end - begin), MADV_FREE);
  }

  /// The limit is asked of the system when pages are first kept: calls with few points keep none.
  std::size_t most_kept() noexcept {
    if (!limit_) limit_ = usual_limit();
    return *limit_;
  }

  /// Returns memory to the system, highest addresses first, until at most `most` bytes are kept.
  void shrink(std::size_t most) {
    while (kept_ > most) {
      const auto last = std::prev(ranges_.end());
      Range& range = last->second;
      const std::size_t cut = std::min(range.bytes, whole_pages(kept_ - most));
      range.bytes -= cut;
      kept_ -= cut;
      char* const end = last->first + range.bytes;
      munmap(end, cut);
      range.written_end = std::min(range.written_end, end);
      if (range.bytes == 0) ranges_.erase(last);
    }
  }

  std::mutex mutex_;
  unsigned scopes_ = 0;
  std::size_t kept_ = 0;
  std::optional<std::size_t> limit_;
  std::map<char*, Range> ranges_;
};

FreePages& free_pages() {
  static auto* pages = new FreePages;  // outlives every static array
  return *pages;
}

const ForkGuard pages_guard(
    ForkGuard::Order::inner, [] { free_pages().lock(); }, [] { free_pages().unlock(); },
    [] { free_pages().unlock_in_child(); });

}  // namespace

PageScope::PageScope() { free_pages().open(); }
PageScope::~PageScope() { free_pages().close(); }

void* allocate_block(std::size_t bytes) {
  if (bytes < kept_block) return ::operator new(bytes);
  if (bytes < mapped_block) return free_blocks().take(bytes);
  if (bytes > ~std::size_t{0} - 2 * page) throw std::bad_alloc();
  std::size_t size = whole_pages(bytes);
  char* kept = free_pages().take(size, size);
  return kept != nullptr ? kept : map_pages(size);
}

void free_block(void* block, std::size_t bytes) noexcept {
  if (bytes < kept_block) return ::operator delete(block);
  if (bytes < mapped_block) return free_blocks().give(block, bytes);
  const std::size_t size = whole_pages(bytes);
  auto* start = static_cast<char*>(block);
  if (!free_pages().give(start, size)) munmap(start, size);
}

void* grow_block(void* block, std::size_t bytes, std::size_t& more) {
  if (more > ~std::size_t{0} / 16) throw std::bad_alloc();
  const std::size_t old = whole_pages(bytes), size = whole_pages(more);
  more = size;
  if (size <= old) return block;
  // Kept pages need no clearing, but the contents must be copied into them. A block that grows to
  // less than twice its size gets four times the requested size, so that it is copied rarely.
  std::size_t room = old <= size / 2 ? size : 4 * size;
  if (char* kept = free_pages().take(room, std::max(size, 2 * old)); kept != nullptr) {
    std::memcpy(kept, block, bytes);
    free_block(block, bytes);
    more = room;
    return kept;
  }
  if (mremap(block, old, size, 0) != MAP_FAILED) {
    madvise(block, size, MADV_HUGEPAGE);
    return block;
  }
  // mremap fails with EFAULT if the block spans several mappings: it cannot move them as one.
  const bool moves = errno != EFAULT;
  char* place = map_pages(size);  // aligned, so that whole huge pages can be moved
  if (moves) {
    // After a failure it is unknown whether `place` is still mapped, so it is not unmapped. Nothing
    // was written to it, so it uses no memory.
    if (mremap(block, old, size, MREMAP_MAYMOVE | MREMAP_FIXED, place) == MAP_FAILED)
      throw std::bad_alloc();
    madvise(place, size, MADV_HUGEPAGE);
    return place;
  }
  std::memcpy(place, block, bytes);
  free_block(block, bytes);
  return place;
}

void keep_pages(std::size_t limit) noexcept {
  free_pages().limit(limit);
  free_blocks().limit(limit);
}
std::size_t kept_pages() noexcept { return free_pages().kept() + free_blocks().kept(); }
void trim_pages(std::size_t most) noexcept { free_pages().trim(most); }

#else

void prefer_huge_pages(void*, std::size_t) noexcept {}

PageScope::PageScope() = default;
PageScope::~PageScope() {}

void* allocate_block(std::size_t bytes) {
  if (bytes < kept_block) return ::operator new(bytes);
  if (bytes < mapped_block) return free_blocks().take(bytes);
  if (bytes > ~std::size_t{0} / 2) throw std::bad_alloc();  // rounded up, some systems' is small
  return ::operator new(bytes, alignment);
}
void free_block(void* block, std::size_t bytes) noexcept {
  if (bytes < kept_block) return ::operator delete(block);
  if (bytes < mapped_block) return free_blocks().give(block, bytes);
  ::operator delete(block, alignment);
}
void* grow_block(void* block, std::size_t bytes, std::size_t& more) {
  void* larger = allocate_block(more);
  std::memcpy(larger, block, bytes);
  free_block(block, bytes);
  return larger;
}

void keep_pages(std::size_t limit) noexcept { free_blocks().limit(limit); }
std::size_t kept_pages() noexcept { return free_blocks().kept(); }
void trim_pages(std::size_t) noexcept {}

#endif

}  // namespace cullhull::internal
