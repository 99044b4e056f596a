// Array, the vector that holds large results: a std::vector that does not clear new memory and asks
// the system for huge pages for large blocks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "cullhull/version.hpp"

#pragma GCC visibility push(default)

namespace cullhull::internal {
/// Memory for any trivial type; throws std::bad_alloc. Blocks of 2 MB and more use huge pages where
/// the system provides them.
void* allocate_block(std::size_t bytes);
/// `bytes`: the number passed to allocate_block.
void free_block(void* block, std::size_t bytes) noexcept;

/// An allocator that leaves new items of trivial types uninitialised; std::allocator clears them.
template <class T>
class ArrayAllocator {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  using value_type = T;
  using is_always_equal = std::true_type;

  ArrayAllocator() = default;
  template <class U>
  ArrayAllocator(const ArrayAllocator<U>&) noexcept {}  // NOLINT: allocators convert

  T* allocate(std::size_t n) {
    if (n > std::numeric_limits<std::size_t>::max() / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(allocate_block(n * sizeof(T)));
  }
  void deallocate(T* p, std::size_t n) noexcept { free_block(p, n * sizeof(T)); }

  template <class U>
  void construct(U* p) noexcept {
    ::new (static_cast<void*>(p)) U;
  }
  template <class U, class... Args>
  void construct(U* p, Args&&... args) {
    ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
  }
  friend bool operator==(const ArrayAllocator&, const ArrayAllocator&) noexcept { return true; }
};

}  // namespace cullhull::internal

namespace cullhull {

/// In place of the number of a cell, facet or point where there is none.
inline constexpr std::uint32_t no_index = 0xffffffff;

/// Sets how much freed memory the library keeps for reuse. It keeps freed blocks, its own and those
/// of Arrays, because the system clears new memory, which takes longer than most steps of a hull.
/// It keeps at most 16 MB of blocks smaller than 2 MB, and at most `limit` bytes of larger blocks;
/// the default limit is a sixteenth of the memory that this process may use, at most 1 GiB. Blocks
/// beyond the limit are returned to the system at once. Between calls the system may reclaim the
/// large blocks if it is short of memory. Each thread keeps scratch memory for small sets besides:
/// 1 MB for points in space, up to 2.5 MB for each dimension from 4 to 8 that it has used. 0:
/// nothing is kept between calls, also in the pools of CUDA devices.
void keep_memory(std::size_t limit) noexcept;
/// Bytes kept now.
std::size_t kept_memory() noexcept;

/// A std::vector with one difference: `Array<T> a(n)` and `a.resize(n)` leave new items
/// uninitialised; `a.resize(n, T())` and `a.assign(n, T())` set them.
template <class T>
using Array = std::vector<T, internal::ArrayAllocator<T>>;

}  // namespace cullhull
#pragma GCC visibility pop
