// CULLHULL_THREAD_SANITIZER is defined where the compiler instruments for ThreadSanitizer, which
// cannot see into oneTBB's library.
#pragma once

#if defined(__SANITIZE_THREAD__)
#define CULLHULL_THREAD_SANITIZER
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define CULLHULL_THREAD_SANITIZER
#endif
#endif
