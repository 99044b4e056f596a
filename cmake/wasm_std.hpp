// What the C++ library of Debian's emscripten (libc++ 13) lacks of C++20, as far as we use it;
// included before every source there (cmake/CrossToolchain.cmake). There is one thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <charconv>

namespace std {

template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}

template <class T>
class atomic_ref {
 public:
  explicit atomic_ref(T& object) noexcept : object_(&object) {}
  T load(memory_order = memory_order_seq_cst) const noexcept { return *object_; }
  void store(T value, memory_order = memory_order_seq_cst) const noexcept { *object_ = value; }
  T exchange(T value, memory_order = memory_order_seq_cst) const noexcept {
    const T before = *object_;
    *object_ = value;
    return before;
  }
  T fetch_add(T value, memory_order = memory_order_seq_cst) const noexcept {
    return exchange(static_cast<T>(*object_ + value));
  }
  T fetch_sub(T value, memory_order = memory_order_seq_cst) const noexcept {
    return exchange(static_cast<T>(*object_ - value));
  }
  T fetch_or(T value, memory_order = memory_order_seq_cst) const noexcept {
    return exchange(static_cast<T>(*object_ | value));
  }
  bool compare_exchange_strong(T& expected, T value, memory_order = memory_order_seq_cst,
                               memory_order = memory_order_seq_cst) const noexcept {
    if (*object_ == expected) {
      *object_ = value;
      return true;
    }
    expected = *object_;
    return false;
  }
  bool compare_exchange_weak(T& expected, T value, memory_order = memory_order_seq_cst,
                             memory_order = memory_order_seq_cst) const noexcept {
    return compare_exchange_strong(expected, value);
  }

 private:
  T* object_;
};

namespace ranges {
template <class Range, class Other>
bool equal(const Range& a, const Other& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}
}  // namespace ranges

// Defined in src/io/text/wasm_charconv.cpp.
from_chars_result from_chars(const char* first, const char* last, double& value);
to_chars_result to_chars(char* first, char* last, double value, chars_format format);
inline to_chars_result to_chars(char* first, char* last, double value) {
  return to_chars(first, last, value, chars_format{});
}

}  // namespace std
