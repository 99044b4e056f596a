// The version, which CMake, pip, the program and the documentation read here.
#pragma once

#if defined(_MSVC_LANG) ? _MSVC_LANG < 202002L : __cplusplus < 202002L
#error "cullhull needs C++20: compile with -std=c++20 or later"
#endif

#define CULLHULL_VERSION_MAJOR 0
#define CULLHULL_VERSION_MINOR 1
#define CULLHULL_VERSION_PATCH 0
#define CULLHULL_VERSION "0.1.0"
/// For comparisons: 10203 is version 1.2.3.
#define CULLHULL_VERSION_NUMBER \
  (CULLHULL_VERSION_MAJOR * 10000 + CULLHULL_VERSION_MINOR * 100 + CULLHULL_VERSION_PATCH)

#pragma GCC visibility push(default)
namespace cullhull {

/// The version of the library that is linked or loaded, as CULLHULL_VERSION is that of the headers.
const char* version() noexcept;

}  // namespace cullhull
#pragma GCC visibility pop
