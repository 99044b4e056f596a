// A growing array of trivial items: no initialisation, huge pages, and growth that moves page
// tables instead of bytes where the system can. Clearing and copying pages was 28 % of the 3D
// engine.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <type_traits>
#include <utility>

namespace cullhull::internal {

template <class T>
class RawArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  RawArray() = default;
  RawArray(const RawArray&) = delete;
  RawArray& operator=(const RawArray&) = delete;
  ~RawArray() { release(); }

  T* data() { return data_; }
  const T* data() const { return data_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  std::size_t capacity() const { return bytes_ / sizeof(T); }

  /// Room for at least n items; new ones are undefined. Throws std::bad_alloc.
  void reserve(std::size_t n) {
    if (n <= capacity()) return;
    if (n > (~std::size_t{0} - 2 * huge_page) / sizeof(T)) throw std::bad_alloc();
    const std::size_t least = n * sizeof(T);
    const std::size_t unit = least >= huge_page ? huge_page : page;
    const std::size_t bytes = (least + unit - 1) / unit * unit;
    void* p = mapped(bytes_) ? remap(bytes) : move_to(bytes);
    data_ = static_cast<T*>(p);
    bytes_ = bytes;
  }

  void release() {
    if (data_ == nullptr) return;
#ifdef __linux__
    if (mapped(bytes_))
      munmap(data_, bytes_);
    else
#endif
      std::free(data_);
    data_ = nullptr;
    bytes_ = 0;
  }

 private:
  // Many small hulls at once: a system call for each would be most of their time.
  static constexpr std::size_t page = 4096, small = std::size_t{256} << 10,
                               huge_page = std::size_t{2} << 20;

  static bool mapped([[maybe_unused]] std::size_t bytes) {
#ifdef __linux__
    return bytes > small;
#else
    return false;
#endif
  }

#ifdef __linux__
  static void* checked(void* p) {
    if (p == MAP_FAILED) throw std::bad_alloc();
    return p;
  }
  /// Huge pages begin at multiples of their size: from a larger range, both ends are cut off.
  static void* allocate_pages(std::size_t bytes) {
    constexpr int protection = PROT_READ | PROT_WRITE, flags = MAP_PRIVATE | MAP_ANONYMOUS;
    if (bytes < huge_page) return checked(mmap(nullptr, bytes, protection, flags, -1, 0));
    auto* p = static_cast<std::byte*>(
        checked(mmap(nullptr, bytes + huge_page, protection, flags, -1, 0)));
    const std::size_t before = -reinterpret_cast<std::uintptr_t>(p) % huge_page;
    if (before > 0) munmap(p, before);
    if (before < huge_page) munmap(p + before + bytes, huge_page - before);
    madvise(p + before, bytes, MADV_HUGEPAGE);  // a wish: failure costs speed only
    return p + before;
  }
  /// To an address that is as good for huge pages: those that there are move as a whole.
  void* remap(std::size_t bytes) {
    void* to = allocate_pages(bytes);
    void* p = mremap(data_, bytes_, bytes, MREMAP_MAYMOVE | MREMAP_FIXED, to);
    if (p == MAP_FAILED) {
      munmap(to, bytes);
      throw std::bad_alloc();
    }
    if (bytes >= huge_page) madvise(p, bytes, MADV_HUGEPAGE);
    return p;
  }
#else
  static void* allocate_pages(std::size_t) { return nullptr; }
  void* remap(std::size_t) { return nullptr; }
#endif

  void* move_to(std::size_t bytes) {
    void* p = mapped(bytes) ? allocate_pages(bytes) : std::aligned_alloc(64, bytes);
    if (p == nullptr) throw std::bad_alloc();
    if (data_ != nullptr) std::memcpy(p, static_cast<const void*>(data_), bytes_);
    std::free(data_);
    return p;
  }

  T* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace cullhull::internal
