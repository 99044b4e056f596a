// Results as NumPy arrays over the memory they lie in: nothing is copied, nothing can be written.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <type_traits>

#include "cullhull/lists.hpp"

namespace binding {

namespace nb = nanobind;

template <class T>
using ListView = nb::ndarray<nb::numpy, const T, nb::ndim<1>>;
template <class T>
using RowView = nb::ndarray<nb::numpy, const T, nb::ndim<2>>;
template <class T>
using Array = nb::ndarray<nb::numpy, T, nb::ndim<1>>;

/// A list that `owner` keeps alive.
template <class T>
ListView<T> list_of(const T* data, std::size_t size, nb::handle owner) {
  return ListView<T>(data, {size}, owner);
}
/// The same as rows.
template <class T>
RowView<T> rows_of(const T* data, std::size_t rows, std::size_t width, nb::handle owner) {
  return RowView<T>(data, {rows, width}, owner);
}

/// Ids and offsets are below 2^63; NumPy's users want them signed, so that differences are too.
template <class Ids>
const std::int64_t* signed_ids(const Ids& ids) {
  static_assert(std::is_same_v<typename Ids::value_type, std::uint64_t>);
  return reinterpret_cast<const std::int64_t*>(ids.data());
}

/// Numbers of facets or simplices. NumPy sees int32; more than 2^31 - 1 of them would need more
/// memory for their planes than any machine has, but a wrong sign must never pass.
inline void check_numbers(std::size_t count) {
  if (count > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    throw nb::builtin_exception(nb::exception_type::runtime_error,
                                "more facets than int32 can number");
}
template <class Numbers>
const std::int32_t* signed_numbers(const Numbers& numbers, std::size_t count) {
  static_assert(std::is_same_v<typename Numbers::value_type, std::uint32_t>);
  check_numbers(count);
  return reinterpret_cast<const std::int32_t*>(numbers.data());
}

/// An array that owns `size` items of the type T, as yet without values; the memory may be filled
/// without the GIL before to_array() makes a NumPy array of it.
template <class T>
class Output {
 public:
  explicit Output(std::size_t size) : size_(size), data_(new T[size]) {}
  T* data() noexcept { return data_.get(); }
  /// `Shown`: the type NumPy sees, of the same size.
  template <class Shown = T>
  Array<Shown> to_array() && {
    static_assert(sizeof(Shown) == sizeof(T));
    T* const raw = data_.release();
    const nb::capsule owner(raw, [](void* p) noexcept { delete[] static_cast<T*>(p); });
    return Array<Shown>(reinterpret_cast<Shown*>(raw), {size_}, owner);
  }

 private:
  std::size_t size_;
  std::unique_ptr<T[]> data_;
};

/// Over the memory of `owner` where there is any, else an array of its own: properties that give
/// one need the policy `reference`, as the owner may be another than the object asked.
template <class T>
ListView<std::make_signed_t<T>> signed_list(const cullhull::EvenArray<T>& items, nb::handle owner) {
  using Shown = std::make_signed_t<T>;
  if (items.data() != nullptr)
    return list_of(reinterpret_cast<const Shown*>(items.data()), items.size(), owner);
  const std::size_t count = items.size();
  auto raw = std::make_unique<Shown[]>(count);
  for (std::size_t i = 0; i < count; ++i) raw[i] = static_cast<Shown>(items[i]);
  Shown* const data = raw.get();
  const nb::capsule own(data, [](void* p) noexcept { delete[] static_cast<Shown*>(p); });
  raw.release();
  return list_of(data, count, own);
}

}  // namespace binding
