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
#ifdef __linux__
    if (n * sizeof(T) < mapped) {  // small hulls by the million: no system call for them
      void* small = std::realloc(data_, n * sizeof(T));
      if (small == nullptr) throw std::bad_alloc();
      data_ = static_cast<T*>(small);
      bytes_ = n * sizeof(T);
      return;
    }
    const std::size_t bytes = (n * sizeof(T) + page - 1) / page * page;
    T* const small = bytes_ < mapped ? std::exchange(data_, nullptr) : nullptr;
    void* p = data_ == nullptr
                  ? mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)
                  : mremap(data_, bytes_, bytes, MREMAP_MAYMOVE);
    if (p == MAP_FAILED) {
      if (small != nullptr) data_ = small;
      throw std::bad_alloc();
    }
    if (bytes >= huge_page) madvise(p, bytes, MADV_HUGEPAGE);  // a wish: failure costs speed only
    if (small != nullptr) {
      std::memcpy(p, static_cast<void*>(small), bytes_);
      std::free(small);
    }
#else
    const std::size_t bytes = n * sizeof(T);
    void* p = std::realloc(data_, bytes);
    if (p == nullptr) throw std::bad_alloc();
#endif
    data_ = static_cast<T*>(p);
    bytes_ = bytes;
  }

  void release() {
    if (data_ == nullptr) return;
#ifdef __linux__
    if (bytes_ < mapped)
      std::free(data_);
    else
      munmap(data_, bytes_);
#else
    std::free(data_);
#endif
    data_ = nullptr;
    bytes_ = 0;
  }

 private:
  static constexpr std::size_t page = 4096, huge_page = std::size_t{2} << 20;
  /// Arrays of fewer bytes are the allocator's business.
  static constexpr std::size_t mapped = std::size_t{1} << 18;
  T* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace cullhull::internal
