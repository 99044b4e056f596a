// What both modules share: a call fills a table of arrays that JavaScript copies, or leaves an
// error.
#pragma once

#include <cstdint>
#include <iterator>
#include <memory>
#include <new>
#include <string>
#include <utility>

#include "cullhull/error.hpp"

namespace cullhull::js {

/// The bytes of an array of the last result. JavaScript knows its type.
struct Part {
  const void* data;
  std::uint32_t size;
};

inline std::shared_ptr<const void> held;  ///< owns what `parts` point to
inline Part parts[8];
inline std::string error;  ///< the code's name, a line feed, and the line

/// Keeps a result until the next call or cullhull_free_result().
template <class T>
const T& keep(T&& result) {
  const auto kept = std::make_shared<const T>(std::forward<T>(result));
  held = kept;
  return *kept;
}

/// Makes these arrays the result.
template <class... Arrays>
void hand_out(const Arrays&... arrays) {
  static_assert(sizeof...(arrays) <= std::size(parts));
  Part* part = parts;
  ((*part++ = {arrays.data(), static_cast<std::uint32_t>(arrays.size() * sizeof(*arrays.data()))}),
   ...);
  while (part != std::end(parts)) *part++ = {};
}

/// Runs a call; returns 0, or 1 with `error` set.
template <class Body>
int guarded(const Body& body) noexcept {
  held.reset();
  try {
    body();
    return 0;
  } catch (const Error& e) {
    error = std::string(error_name(e.code())) + '\n' + e.what();
  } catch (const std::bad_alloc&) {
    held.reset();
    error = "out_of_memory\nnot enough memory for the call";
  }
  return 1;
}

}  // namespace cullhull::js

extern "C" {
[[gnu::used]] inline const cullhull::js::Part* cullhull_parts() { return cullhull::js::parts; }
[[gnu::used]] inline const char* cullhull_error() { return cullhull::js::error.c_str(); }
[[gnu::used]] inline void cullhull_free_result() { cullhull::js::held.reset(); }
}
