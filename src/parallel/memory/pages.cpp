#include "parallel/memory/pages.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <map>
#include <mutex>

#include "parallel/threads/fork_guard.hpp"

#if defined(__linux__)
#include <sys/mman.h>

#include "parallel/memory/memory.hpp"
#endif

namespace cullhull::internal::inline parallel {
namespace {

constexpr std::align_val_t alignment{64};

/// Blocks below mapped_block that nobody uses now. malloc returns what lies at the end of its heap
/// to the system with nearly every hull of 10,000 points, and takes it back, cleared page by page,
/// with the next: half of the time of a hull of 10,000 points on a circle.
class FreeBlocks {
 public:
  void lock() { mutex_.lock(); }
  void unlock() { mutex_.unlock(); }
  void limit(std::size_t bytes) noexcept {
    const std::lock_guard lock(mutex_);
    limit_ = std::min(bytes, most);
    for (unsigned c = classes; kept_ > limit_; --c)
      for (List& list = lists_[c - 1]; list.count > 0 && kept_ > limit_;)
        drop(list, size_of(c - 1));
  }
  std::size_t kept() noexcept {
    const std::lock_guard lock(mutex_);
    return kept_;
  }
  void* take(std::size_t bytes) {
    const unsigned c = class_of(bytes);
    {
      const std::lock_guard lock(mutex_);
      if (List& list = lists_[c]; list.count > 0) {
        kept_ -= size_of(c);
        return list.blocks[--list.count];
      }
    }
    return ::operator new(size_of(c), alignment);
  }
  void give(void* block, std::size_t bytes) noexcept {
    const unsigned c = class_of(bytes);
    {
      const std::lock_guard lock(mutex_);
      List& list = lists_[c];
      if (list.count < List::room && kept_ + size_of(c) <= limit_) {
        list.blocks[list.count++] = block;
        kept_ += size_of(c);
        return;
      }
    }
    ::operator delete(block, alignment);
  }

 private:
  /// The arrays of one call and of its result, a few times over for several callers.
  static constexpr std::size_t most = std::size_t{16} << 20;

  /// Four sizes an octave: at most a quarter of a block lies idle.
  static constexpr unsigned octaves = std::countr_zero(mapped_block) - std::countr_zero(kept_block);
  static constexpr unsigned classes = 4 * octaves + 1;

  struct List {
    static constexpr unsigned room = 64;  // blocks of a class; a guess
    void* blocks[room];
    unsigned count = 0;
  };

  static unsigned class_of(std::size_t bytes) {
    const std::size_t quarter = std::bit_floor(bytes) / 4;
    const auto octave = static_cast<unsigned>(std::countr_zero(4 * quarter / kept_block));
    return 4 * octave + static_cast<unsigned>((bytes - 4 * quarter + quarter - 1) / quarter);
  }
  static std::size_t size_of(unsigned c) { return (kept_block << c / 4) / 4 * (4 + c % 4); }

  void drop(List& list, std::size_t size) noexcept {
    ::operator delete(list.blocks[--list.count], alignment);
    kept_ -= size;
  }

  std::mutex mutex_;
  std::size_t limit_ = most, kept_ = 0;
  List lists_[classes];
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
  // Often the system's choice is aligned, next to an earlier block: then both can be kept as one
  // range.
  void* p = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (p == MAP_FAILED) throw std::bad_alloc();
  if (reinterpret_cast<std::uintptr_t>(p) % page == 0) {
    madvise(p, bytes, MADV_HUGEPAGE);  // only advice: changes nothing but time
    return static_cast<char*>(p);
  }
  munmap(p, bytes);
  // Otherwise map a page more and unmap what is not aligned at both ends.
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

std::size_t usual_limit() {
  // Bytes kept between calls, whatever the machine has.
  constexpr std::size_t most = std::size_t{1} << 30;
  const std::uint64_t memory = machine_memory();
  return memory == 0 ? most / 4 : std::min<std::size_t>(most, memory / 16);
}

/// Scopes that the calling thread has open.
thread_local unsigned scopes_here = 0;

/// Unused ranges of whole pages, adjacent ones joined.
class FreePages {
 public:
  void lock() { mutex_.lock(); }
  void unlock() { mutex_.unlock(); }
  /// A forked child has none of the other threads' scopes.
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
    if (--scopes_ > 0) return;
    shrink(limit_);
    for (const auto& [start, bytes] : ranges_) offer(start, bytes);
  }
  void limit(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    limit_ = bytes;
    if (scopes_ == 0) shrink(limit_);
  }
  void trim(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    shrink(bytes);
  }
  std::size_t kept() {
    const std::lock_guard lock(mutex_);
    return kept_;
  }

  /// `bytes` of the smallest range that is large enough, or, where none is, the largest range of at
  /// least `least` bytes: `bytes` becomes its size. nullptr: there is none.
  char* take(std::size_t& bytes, std::size_t least) {
    const std::lock_guard lock(mutex_);
    auto best = ranges_.end(), largest = best;
    for (auto it = ranges_.begin(); it != ranges_.end(); ++it) {
      if (it->second >= bytes && (best == ranges_.end() || it->second < best->second)) best = it;
      if (largest == ranges_.end() || it->second > largest->second) largest = it;
    }
    if (best == ranges_.end()) best = largest;
    if (best == ranges_.end() || best->second < least) return nullptr;
    bytes = std::min(bytes, best->second);
    char* start = best->first;
    const std::size_t rest = best->second - bytes;
    ranges_.erase(best);
    kept_ -= bytes;
    if (rest > 0) ranges_.emplace(start + bytes, rest);
    return start;
  }

  /// Whether the range was kept.
  bool give(char* start, std::size_t bytes) noexcept {
    const std::lock_guard lock(mutex_);
    if (scopes_ == 0 && (bytes > limit_ || kept_ > limit_ - bytes)) return false;
    if (scopes_ == 0) offer(start, bytes);
    try {
      auto it = ranges_.emplace(start, bytes).first;
      kept_ += bytes;
      if (const auto after = std::next(it);
          after != ranges_.end() && it->first + it->second == after->first) {
        it->second += after->second;
        ranges_.erase(after);
      }
      if (it != ranges_.begin())
        if (const auto before = std::prev(it); before->first + before->second == it->first) {
          before->second += it->second;
          ranges_.erase(it);
        }
      return true;
    } catch (const std::bad_alloc&) {
      return false;
    }
  }

 private:
  /// The system may reclaim these pages without saving their contents, until they are written
  /// again.
  static void offer(char* start, std::size_t bytes) { madvise(start, bytes, MADV_FREE); }

  /// Returns ranges to the system, from the highest address on, until so much is kept.
  void shrink(std::size_t most) {
    while (kept_ > most) {
      const auto last = std::prev(ranges_.end());
      const std::size_t cut = std::min(last->second, whole_pages(kept_ - most));
      last->second -= cut;
      kept_ -= cut;
      munmap(last->first + last->second, cut);
      if (last->second == 0) ranges_.erase(last);
    }
  }

  std::mutex mutex_;
  unsigned scopes_ = 0;
  std::size_t limit_ = usual_limit(), kept_ = 0;
  std::map<char*, std::size_t> ranges_;
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
  // Kept pages need no clearing, but the contents must be copied. To copy seldom, a block that
  // grows by little gets four times its size.
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
  // A block that spans several mappings (EFAULT) cannot be moved as one.
  const bool moves = errno != EFAULT;
  char* place = map_pages(size);  // aligned to a huge page, so that whole huge pages move
  if (moves) {
    // After a failure `place` may or may not still be mapped; nothing in it was written.
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
  return bytes < mapped_block ? free_blocks().take(bytes) : ::operator new(bytes, alignment);
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

}  // namespace cullhull::internal::inline parallel
