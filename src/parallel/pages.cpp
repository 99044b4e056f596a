#include "parallel/pages.hpp"

#include <atomic>
#include <cstdint>
#include <iterator>
#include <map>
#include <mutex>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace cullhull::internal {

#if defined(__linux__)

namespace {

constexpr std::size_t page = std::size_t{2} << 20;
/// Smaller blocks are the allocator's business.
constexpr std::size_t large = 2 * page;

std::size_t whole_pages(std::size_t bytes) { return (bytes + page - 1) / page * page; }

char* map_pages(std::size_t bytes) {
  // Aligned by cutting off what is too much at both ends.
  void* p = mmap(nullptr, bytes + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (p == MAP_FAILED) throw std::bad_alloc();
  const auto address = reinterpret_cast<std::uintptr_t>(p);
  const std::size_t before = (page - address % page) % page;
  if (before > 0) munmap(p, before);
  char* start = static_cast<char*>(p) + before;
  if (before < page) munmap(start + bytes, page - before);
  madvise(start, bytes, MADV_HUGEPAGE);  // advice: whether it is taken changes nothing but time
  return start;
}

/// Ranges of whole pages that nobody uses now, joined where they touch.
class FreePages {
 public:
  void open() { ++scopes_; }
  void close() {
    if (--scopes_ > 0) return;
    std::map<char*, std::size_t> left;
    {
      const std::lock_guard lock(mutex_);
      // What `give` kept before the count fell is here; after that it keeps nothing.
      if (scopes_ == 0) left.swap(ranges_);
    }
    for (const auto& [start, bytes] : left) munmap(start, bytes);
  }

  /// The smallest range that is large enough, or nullptr.
  char* take(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    auto best = ranges_.end();
    for (auto it = ranges_.begin(); it != ranges_.end(); ++it)
      if (it->second >= bytes && (best == ranges_.end() || it->second < best->second)) best = it;
    if (best == ranges_.end()) return nullptr;
    char* start = best->first;
    const std::size_t rest = best->second - bytes;
    ranges_.erase(best);
    if (rest > 0) ranges_.emplace(start + bytes, rest);
    return start;
  }

  /// Whether the range was kept.
  bool give(char* start, std::size_t bytes) noexcept {
    const std::lock_guard lock(mutex_);
    if (scopes_ == 0) return false;
    try {
      auto it = ranges_.emplace(start, bytes).first;
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
  std::mutex mutex_;
  std::atomic<unsigned> scopes_{0};
  std::map<char*, std::size_t> ranges_;
};

FreePages& free_pages() {
  static auto* pages = new FreePages;  // outlives every static array
  return *pages;
}

}  // namespace

PageScope::PageScope() { free_pages().open(); }
PageScope::~PageScope() { free_pages().close(); }

void* allocate_block(std::size_t bytes) {
  if (bytes < large) return ::operator new(bytes);
  if (bytes > ~std::size_t{0} - 2 * page) throw std::bad_alloc();
  const std::size_t size = whole_pages(bytes);
  char* kept = free_pages().take(size);
  return kept != nullptr ? kept : map_pages(size);
}

void free_block(void* block, std::size_t bytes) noexcept {
  if (bytes < large) return ::operator delete(block);
  const std::size_t size = whole_pages(bytes);
  auto* start = static_cast<char*>(block);
  if (!free_pages().give(start, size)) munmap(start, size);
}

#else

PageScope::PageScope() = default;
PageScope::~PageScope() {}

void* allocate_block(std::size_t bytes) { return ::operator new(bytes); }
void free_block(void* block, std::size_t) noexcept { ::operator delete(block); }

#endif

}  // namespace cullhull::internal
