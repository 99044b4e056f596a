// Large scratch arrays: uninitialised, on huge pages, and reused from step to step (pages.hpp).
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "parallel/memory/pages.hpp"

namespace cullhull::internal::inline parallel {

/// `count` items of a trivial type whose values are indeterminate until written.
template <class T>
class BigArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  BigArray() = default;
  explicit BigArray(std::size_t count) : data_(ArrayAllocator<T>().allocate(count), Free{count}) {}

  T* get() { return data_.get(); }
  const T* get() const { return data_.get(); }
  T& operator[](std::size_t i) { return data_.get()[i]; }
  const T& operator[](std::size_t i) const { return data_.get()[i]; }

 private:
  struct Free {
    std::size_t count = 0;
    void operator()(T* p) const { ArrayAllocator<T>().deallocate(p, count); }
  };
  std::unique_ptr<T, Free> data_;
};

/// v.resize(count) for a large result: huge pages are requested before the memory is first written.
template <class T>
void resize_big(std::vector<T>& v, std::size_t count) {
  v.reserve(count);
  prefer_huge_pages(v.data(), count * sizeof(T));
  v.resize(count);
}
/// An Array requests huge pages itself.
template <class T>
void resize_big(Array<T>& v, std::size_t count) {
  v.resize(count);
}

}  // namespace cullhull::internal::inline parallel
