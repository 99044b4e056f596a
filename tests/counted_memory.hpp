// Counts what operator new gives, so that a test sees whether something grows, or is made again and
// again. For one source of a program: it replaces the operators.
#pragma once

#include <malloc.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace cullhull::testing_support {

inline std::atomic<std::int64_t> live_bytes{0}, allocated_bytes{0};

inline void* counted(void* p) {
  if (p == nullptr) throw std::bad_alloc();
  const auto size = static_cast<std::int64_t>(malloc_usable_size(p));
  live_bytes += size;
  allocated_bytes += size;
  return p;
}
inline void uncounted(void* p) {
  if (p == nullptr) return;
  live_bytes -= static_cast<std::int64_t>(malloc_usable_size(p));
  std::free(p);
}

}  // namespace cullhull::testing_support

void* operator new(std::size_t n) {
  return cullhull::testing_support::counted(std::malloc(n > 0 ? n : 1));
}
void* operator new(std::size_t n, std::align_val_t a) {
  const auto align = static_cast<std::size_t>(a);
  return cullhull::testing_support::counted(
      std::aligned_alloc(align, (n + align - 1) / align * align));
}
void* operator new(std::size_t n, const std::nothrow_t&) noexcept {
  void* const p = std::malloc(n > 0 ? n : 1);
  return p == nullptr ? p : cullhull::testing_support::counted(p);
}
void operator delete(void* p, const std::nothrow_t&) noexcept {
  cullhull::testing_support::uncounted(p);
}
void operator delete(void* p) noexcept { cullhull::testing_support::uncounted(p); }
void operator delete(void* p, std::size_t) noexcept { cullhull::testing_support::uncounted(p); }
void operator delete(void* p, std::align_val_t) noexcept {
  cullhull::testing_support::uncounted(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  cullhull::testing_support::uncounted(p);
}
