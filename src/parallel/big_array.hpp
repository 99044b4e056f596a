// Large scratch arrays: uninitialised, and on huge pages where the system grants them (first touch
// and random access to tens of megabytes cost a third less so).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <type_traits>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace cullhull::internal {

/// `count` items of a trivial type whose values are indeterminate until written.
template <class T>
class BigArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
  static constexpr std::size_t page = std::size_t{2} << 20;

 public:
  BigArray() = default;
  explicit BigArray(std::size_t count) {
    const bool big = count * sizeof(T) >= 2 * page;
    const std::align_val_t alignment{big ? page : alignof(std::max_align_t)};
    data_ = {static_cast<T*>(::operator new(count * sizeof(T), alignment)), Free{alignment}};
#if defined(__linux__)
    // Advice: whether it is taken changes nothing but time.
    if (big) madvise(data_.get(), count * sizeof(T) / page * page, MADV_HUGEPAGE);
#endif
  }

  T* get() { return data_.get(); }
  const T* get() const { return data_.get(); }
  T& operator[](std::size_t i) { return data_.get()[i]; }
  const T& operator[](std::size_t i) const { return data_.get()[i]; }

 private:
  struct Free {
    std::align_val_t alignment{};
    void operator()(T* p) const { ::operator delete(p, alignment); }
  };
  std::unique_ptr<T, Free> data_;
};

/// v.resize(count) for a large result: the pages are asked to be huge before they are touched.
template <class T>
void resize_big(std::vector<T>& v, std::size_t count) {
  v.reserve(count);
#if defined(__linux__)
  constexpr std::uintptr_t page = std::uintptr_t{2} << 20;
  const auto begin = (reinterpret_cast<std::uintptr_t>(v.data()) + page - 1) / page * page;
  const auto end = reinterpret_cast<std::uintptr_t>(v.data() + count) / page * page;
  if (end > begin) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
#endif
  v.resize(count);
}

}  // namespace cullhull::internal
