// How an old spelling is reported to those who still use it: the compiler's message says what to
// write instead.
#pragma once

/// A static member without storage; its type allows nothing that the old one allowed.
#if (defined(__clang__) || (defined(__GNUC__) && __GNUC__ >= 12)) && !defined(__CUDACC__)
#define CULLHULL_UNAVAILABLE(now) __attribute__((unavailable(now)))
#define CULLHULL_RENAMED(name, now) \
  CULLHULL_UNAVAILABLE(now) static constexpr decltype(nullptr) name = nullptr
#else  // a warning says it, and the type, which is never defined, makes the error
namespace cullhull::internal {
class Renamed;
}
#define CULLHULL_UNAVAILABLE(now) [[deprecated(now)]]
#define CULLHULL_RENAMED(name, now) \
  CULLHULL_UNAVAILABLE(now) static const ::cullhull::internal::Renamed name
#endif

/// An enumeration in the place of text: streams print it as before; comparing it with text does not
/// compile (there is no such function).
#define CULLHULL_WAS_TEXT(Enumeration, name_of)                                          \
  CULLHULL_UNAVAILABLE("compare with an enumerator, or use " #name_of "() for the text") \
  bool operator==(Enumeration, std::string_view);                                        \
  template <class Traits>                                                                \
  std::basic_ostream<char, Traits>& operator<<(std::basic_ostream<char, Traits>& out,    \
                                               Enumeration value) {                      \
    return out << name_of(value);                                                        \
  }
