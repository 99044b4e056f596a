// A growing array of trivial items: no initialisation, huge pages, and growth that moves page
// tables instead of bytes where the system can. Clearing and copying pages was 28 % of the 3D
// engine.
#pragma once

#include <sys/mman.h>

#include <cstddef>
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
    if (n > (~std::size_t{0} - page) / sizeof(T)) throw std::bad_alloc();
    const std::size_t bytes = (n * sizeof(T) + page - 1) / page * page;
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
  static void* checked(void* p, std::size_t bytes) {
    if (p == MAP_FAILED) throw std::bad_alloc();
    if (bytes >= huge_page) madvise(p, bytes, MADV_HUGEPAGE);  // a wish: failure costs speed only
    return p;
  }
  static void* allocate_pages(std::size_t bytes) {
    return checked(mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0),
                   bytes);
  }
  void* remap(std::size_t bytes) {
    return checked(mremap(data_, bytes_, bytes, MREMAP_MAYMOVE), bytes);
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
