// Whether a test runs under a sanitizer: for tests of limits of memory and processes.
#pragma once

namespace cullhull::testing {

/// Sanitizers reserve terabytes of addresses and hold memory beside ours; their leak check is a
/// process of its own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // GCC
inline constexpr bool sanitized = true;
#elif defined(__clang__)
inline constexpr bool sanitized =
    __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
inline constexpr bool sanitized = false;
#endif

}  // namespace cullhull::testing
