// How a renamed member is reported to those who still use its old name.
#pragma once

/// A static member without storage: using it does not compile, and the message says what to write.
#if (defined(__clang__) || (defined(__GNUC__) && __GNUC__ >= 12)) && !defined(__CUDACC__)
#define CULLHULL_RENAMED(name, now) \
  __attribute__((unavailable(now))) static constexpr decltype(nullptr) name = nullptr
#else
#define CULLHULL_RENAMED(name, now) static_assert(true)
#endif
