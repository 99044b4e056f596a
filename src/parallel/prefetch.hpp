// Prefetches a cache line that will be needed soon. The functions do nothing on compilers without
// such an instruction.
#pragma once

#if defined(_MSC_VER) && !defined(__clang__) && defined(_M_X64)
#include <xmmintrin.h>
#endif

namespace cullhull::internal {

#if defined(__GNUC__)
inline void prefetch_line(const void* p) { __builtin_prefetch(p); }
/// For data that are used once: fetches the line without filling the first-level cache.
inline void prefetch_passing_line(const void* p) { __builtin_prefetch(p, 0, 2); }
inline void prefetch_line_to_write(const void* p) { __builtin_prefetch(p, 1); }
#elif defined(_MSC_VER) && defined(_M_X64)
inline void prefetch_line(const void* p) { _mm_prefetch(static_cast<const char*>(p), _MM_HINT_T0); }
inline void prefetch_passing_line(const void* p) {
  _mm_prefetch(static_cast<const char*>(p), _MM_HINT_T1);
}
inline void prefetch_line_to_write(const void* p) { prefetch_line(p); }
#else
inline void prefetch_line(const void*) {}
inline void prefetch_passing_line(const void*) {}
inline void prefetch_line_to_write(const void*) {}
#endif

}  // namespace cullhull::internal
