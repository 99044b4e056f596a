// Errors the library reports. The library never prints, exits or aborts: it throws `Error`.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

#include "cullhull/version.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// What went wrong; the command line maps each code to one exit status (docs/formats.md).
enum class ErrorCode {
  invalid_argument,     ///< a caller's mistake: null data, dimension 0, an impossible option
  not_finite,           ///< a NaN or an infinity among the coordinates; the message names the first
  bad_file,             ///< a file is not a valid file of its format
  io,                   ///< the operating system refused: missing file, no permission, disk full
  out_of_budget,        ///< the result would exceed the memory budget or the engine's id range
  backend_unavailable,  ///< the requested backend is not available
  cancelled,            ///< the caller's stop token was triggered
  not_exact,            ///< a surface failed the check that it is the exact hull
  internal,             ///< a broken invariant of the library: always a bug, please report it
};

/// "invalid_argument", "not_finite", ...: the names above. Static storage.
const char* error_name(ErrorCode code) noexcept;

/// The only exception type that the library throws itself (std::bad_alloc may pass through).
/// `what()` is one line without a final full stop; it says what to do where that is known.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  /// Joins the message from parts: text, and integers, which are written in decimal.
  template <class First, class Second, class... More>
  Error(ErrorCode code, const First& first, const Second& second, const More&... more)
      : Error(code, joined(first, second, more...)) {}
  ErrorCode code() const noexcept { return code_; }

 private:
  template <class... Parts>
  static std::string joined(const Parts&... parts) {
    std::string text;
    (append(text, parts), ...);
    return text;
  }

  template <class Part>
  static void append(std::string& text, const Part& part) {
    if constexpr (std::is_same_v<Part, char>) {
      text += part;
    } else if constexpr (std::is_integral_v<Part>) {
      static_assert(!std::is_same_v<Part, bool>);
      text += std::to_string(part);
    } else {
      text += std::string_view(part);
    }
  }

  ErrorCode code_;
};

}  // namespace cullhull
#pragma GCC visibility pop
