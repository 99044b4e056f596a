// Large scratch arrays of trivial items: uninitialised, on huge pages that the steps of a call
// reuse (pages.hpp). RawArray can grow, by moving page tables instead of copying bytes if the
// system allows it; BigArray has a fixed size. Clearing and copying pages took 28 % of the 3D
// engine's time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "parallel/memory/pages.hpp"

namespace cullhull::internal {

/// A growing array of trivial items, whose values are indeterminate until written.
template <class T>
class RawArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  RawArray() = default;
  RawArray(const RawArray&) = delete;
  RawArray& operator=(const RawArray&) = delete;
  RawArray(RawArray&& o) noexcept
      : data_(std::exchange(o.data_, nullptr)), bytes_(std::exchange(o.bytes_, 0)) {}
  RawArray& operator=(RawArray&& o) noexcept {
    std::swap(data_, o.data_);
    std::swap(bytes_, o.bytes_);
    return *this;
  }
  ~RawArray() { release(); }

  T* data() { return data_; }
  const T* data() const { return data_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  std::size_t capacity() const { return bytes_ / sizeof(T); }

  /// Makes room for at least n items and keeps the present ones. Throws std::bad_alloc.
  void reserve(std::size_t n) {
    if (n <= capacity()) return;
    if (n > (~std::size_t{0} - page) / sizeof(T)) throw std::bad_alloc();
    std::size_t bytes = (n * sizeof(T) + page - 1) / page * page;
    data_ =
        static_cast<T*>(bytes_ >= mapped_block ? grow_block(data_, bytes_, bytes) : move_to(bytes));
    bytes_ = bytes;
  }

  void release() {
    free_block(data_, bytes_);
    data_ = nullptr;
    bytes_ = 0;
  }

 private:
  static constexpr std::size_t page = kept_block;  // each capacity is a block that is reused

  void* move_to(std::size_t bytes) {
    void* p = allocate_block(bytes);
    if (data_ != nullptr) std::memcpy(p, static_cast<const void*>(data_), bytes_);
    free_block(data_, bytes_);
    return p;
  }

  T* data_ = nullptr;
  std::size_t bytes_ = 0;
};

/// An array of fixed size of trivial items, whose values are indeterminate until written.
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

/// v.resize(count) for a large result. Requests huge pages before the memory is first written.
template <class T>
void resize_big(std::vector<T>& v, std::size_t count) {
  v.reserve(count);
  prefer_huge_pages(v.data(), count * sizeof(T));
  v.resize(count);
}
/// The same for an Array, whose allocator requests huge pages itself.
template <class T>
void resize_big(Array<T>& v, std::size_t count) {
  v.resize(count);
}

}  // namespace cullhull::internal
