// The vector that large results are kept in: std::vector, except that memory is not cleared before
// it is written, and that large ones ask the system for huge pages.
#pragma once

#include <cstddef>
#include <limits>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#pragma GCC visibility push(default)

namespace cullhull::internal::inline parallel {
/// Memory for any trivial type; throws std::bad_alloc. Blocks of megabytes lie on huge pages where
/// the system grants them.
void* allocate_block(std::size_t bytes);
/// `bytes` as they were asked for.
void free_block(void* block, std::size_t bytes) noexcept;
}  // namespace cullhull::internal::inline parallel

namespace cullhull::inline v1 {

/// The library keeps freed blocks, its own and those of Arrays, and reuses them: the system has to
/// clear new memory, which takes longer than most steps of a hull. It keeps at most 16 MB of blocks
/// of less than 2 MB, and larger ones up to a limit, which is at first a sixteenth of what this
/// process may use, at most 1 GiB. Between calls the system may reclaim the large blocks whenever
/// it is short of memory. keep_memory sets the limit; blocks beyond it are returned at once. 0:
/// nothing is kept between calls.
void keep_memory(std::size_t limit) noexcept;
/// Bytes that are kept now.
std::size_t kept_memory() noexcept;

/// Leaves new items of trivial types indeterminate where std::allocator would clear them.
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
    return static_cast<T*>(internal::allocate_block(n * sizeof(T)));
  }
  void deallocate(T* p, std::size_t n) noexcept { internal::free_block(p, n * sizeof(T)); }

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

/// A std::vector in everything but one thing: `Array<T> a(n)` and `a.resize(n)` leave new items
/// indeterminate; `a.resize(n, T())` and `a.assign(n, T())` set them.
template <class T>
using Array = std::vector<T, ArrayAllocator<T>>;

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
