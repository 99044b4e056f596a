// Results as NumPy arrays: read-only over the library's memory, or with memory of their own. Made
// by NumPy's C functions, because most hulls take less time than nanobind's way.
#pragma once

#include <nanobind/nanobind.h>

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>

#include "cullhull/lists.hpp"
#include "cullhull/point_view.hpp"
#include "numpy_api.hpp"

namespace binding {

namespace nb = nanobind;

/// The scalar types of points, with NumPy's numbers.
inline constexpr std::pair<cullhull::ScalarType, int> scalar_types[] = {
    {cullhull::ScalarType::f64, NPY_FLOAT64}, {cullhull::ScalarType::f32, NPY_FLOAT32},
    {cullhull::ScalarType::i8, NPY_INT8},     {cullhull::ScalarType::u8, NPY_UINT8},
    {cullhull::ScalarType::i16, NPY_INT16},   {cullhull::ScalarType::u16, NPY_UINT16},
    {cullhull::ScalarType::i32, NPY_INT32},   {cullhull::ScalarType::u32, NPY_UINT32}};

template <class T>
struct NumpyScalar;
#define CULLHULL_NUMPY_SCALAR(type, number, text)              \
  template <>                                                  \
  struct NumpyScalar<type> {                                   \
    static constexpr int type_number = number;                 \
    static constexpr auto array_name = nb::detail::const_name( \
        "numpy.typing.NDArray["                                \
        "numpy." text "]");                                    \
  }
CULLHULL_NUMPY_SCALAR(bool, NPY_BOOL, "bool_");
CULLHULL_NUMPY_SCALAR(std::int8_t, NPY_INT8, "int8");
CULLHULL_NUMPY_SCALAR(std::int32_t, NPY_INT32, "int32");
CULLHULL_NUMPY_SCALAR(std::int64_t, NPY_INT64, "int64");
CULLHULL_NUMPY_SCALAR(double, NPY_FLOAT64, "float64");
#undef CULLHULL_NUMPY_SCALAR

/// A numpy.ndarray of the type T and any number of axes.
template <class T>
class Array : public nb::object {
 public:
  static constexpr auto Name = NumpyScalar<T>::array_name;
  Array(nb::handle h, nb::detail::borrow_t) : nb::object(h, nb::detail::borrow_t{}) {}
  Array(nb::handle h, nb::detail::steal_t) : nb::object(h, nb::detail::steal_t{}) {}
  static bool check_(nb::handle h) {
    return PyArray_Check(h.ptr()) &&
           PyArray_TYPE(reinterpret_cast<PyArrayObject*>(h.ptr())) == NumpyScalar<T>::type_number;
  }

  /// An array with its own memory, not initialised.
  static Array make(std::initializer_list<std::size_t> shape) {
    return from(PyArray_New(&PyArray_Type, static_cast<int>(shape.size()), Shape(shape).sizes,
                            NumpyScalar<T>::type_number, nullptr, nullptr, 0, 0, nullptr));
  }
  /// A view of `data`, which `owner` keeps alive; read-only.
  static Array view(const T* data, std::initializer_list<std::size_t> shape, nb::handle owner) {
    if (data == nullptr) return make(shape).lock();  // no items, so no memory to view
    Array array = from(PyArray_New(&PyArray_Type, static_cast<int>(shape.size()),
                                   Shape(shape).sizes, NumpyScalar<T>::type_number, nullptr,
                                   const_cast<T*>(data), 0, NPY_ARRAY_CARRAY_RO, nullptr));
    Py_INCREF(owner.ptr());
    if (PyArray_SetBaseObject(array.numpy(), owner.ptr()) != 0) throw nb::python_error();
    return array;
  }

  /// Whether its items are contiguous along one axis.
  bool is_list() { return PyArray_NDIM(numpy()) == 1 && PyArray_IS_C_CONTIGUOUS(numpy()); }
  /// Whether its items are contiguous, row after row.
  bool is_contiguous() { return PyArray_IS_C_CONTIGUOUS(numpy()); }
  T* data() { return static_cast<T*>(PyArray_DATA(numpy())); }
  std::size_t size() { return static_cast<std::size_t>(PyArray_SIZE(numpy())); }
  Array&& lock() {
    PyArray_CLEARFLAGS(numpy(), NPY_ARRAY_WRITEABLE);
    return std::move(*this);
  }
  /// Makes it writable: for memory that nothing else refers to.
  Array&& unlock() {
    PyArray_ENABLEFLAGS(numpy(), NPY_ARRAY_WRITEABLE);
    return std::move(*this);
  }

 private:
  struct Shape {
    explicit Shape(std::initializer_list<std::size_t> shape) {
      int axis = 0;
      for (const std::size_t size : shape) sizes[axis++] = static_cast<npy_intp>(size);
    }
    npy_intp sizes[3];
  };
  static Array from(PyObject* array) {
    if (array == nullptr) throw nb::python_error();
    return Array(nb::handle(array), nb::detail::steal_t{});
  }
  PyArrayObject* numpy() { return reinterpret_cast<PyArrayObject*>(ptr()); }
};

/// A numpy.ndarray of int32, or int64 where int32 is too small.
class IdArray : public nb::object {
 public:
  static constexpr auto Name = nb::detail::const_name("numpy.typing.NDArray[typing.Any]");
  IdArray(nb::handle h, nb::detail::borrow_t) : nb::object(h, nb::detail::borrow_t{}) {}
  IdArray(nb::handle h, nb::detail::steal_t) : nb::object(h, nb::detail::steal_t{}) {}
  template <class T>
  IdArray(Array<T>&& array) : nb::object(std::move(array)) {}  // NOLINT: implicit
  static bool check_(nb::handle h) { return PyArray_Check(h.ptr()); }
};

/// A list that `owner` keeps alive.
template <class T>
Array<T> list_of(const T* data, std::size_t size, nb::handle owner) {
  return Array<T>::view(data, {size}, owner);
}
/// The same as rows.
template <class T>
Array<T> rows_of(const T* data, std::size_t rows, std::size_t width, nb::handle owner) {
  return Array<T>::view(data, {rows, width}, owner);
}

/// The type that NumPy shows for the library's: ids and offsets are below 2^63 and signed there, so
/// that differences can be negative; no_index and at_infinity are -1.
template <class T, bool = std::is_integral_v<T>>
struct Shown {
  using type = T;
};
template <class T>
struct Shown<T, true> {
  using type = std::make_signed_t<T>;
};
template <class T>
using shown_t = typename Shown<std::remove_const_t<T>>::type;

template <class List>
const shown_t<typename List::value_type>* shown_data(const List& list) {
  return reinterpret_cast<const shown_t<typename List::value_type>*>(list.data());
}
/// A view of a list of the library, whose memory `owner` keeps.
template <class List>
auto list_in(const List& list, nb::handle owner) {
  return list_of(shown_data(list), list.size(), owner);
}
template <class List>
auto rows_in(const List& list, std::size_t width, nb::handle owner) {
  return rows_of(shown_data(list), width == 0 ? 0 : list.size() / width, width, owner);
}

/// A writable copy with items of the type T.
template <class T, class List>
Array<T> copied(const List& list, std::initializer_list<std::size_t> shape) {
  Array<T> array = Array<T>::make(shape);
  std::transform(list.begin(), list.end(), array.data(), [](auto v) { return static_cast<T>(v); });
  return array;
}
template <class T, class List>
Array<T> copied(const List& list) {
  return copied<T>(list, {list.size()});
}
/// A read-only copy.
template <class List>
auto kept(const List& list) {
  return copied<shown_t<typename List::value_type>>(list).lock();
}

/// Numbers of facets or simplices as int32. More than 2^31 - 1 of them need more memory for their
/// planes than any machine has, but a wrong sign must not be possible.
inline void check_numbers(std::size_t count) {
  if (count > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    throw nb::builtin_exception(nb::exception_type::runtime_error,
                                "more facets than int32 can number");
}

/// Memory for `size` items of the type T, not initialised, that can be allocated and filled without
/// the GIL, before to_array() makes a NumPy array of it.
template <class T>
class Output {
 public:
  explicit Output(std::size_t size) : size_(size), data_(new T[size]) {}
  T* data() noexcept { return data_.get(); }
  /// `Shown`: the item type for NumPy, of the same size.
  template <class Shown = T>
  Array<Shown> to_array() && {
    static_assert(sizeof(Shown) == sizeof(T));
    T* const raw = data_.get();
    const nb::capsule owner(raw, [](void* p) noexcept { delete[] static_cast<T*>(p); });
    data_.release();
    return Array<Shown>::view(reinterpret_cast<Shown*>(raw), {size_}, owner).unlock();
  }

 private:
  std::size_t size_;
  std::unique_ptr<T[]> data_;
};

/// Views the memory of `owner` if there is any, else makes an array of its own.
template <class T>
Array<shown_t<T>> list_in(const cullhull::EvenArray<T>& items, nb::handle owner) {
  if (items.data() != nullptr) return list_of(shown_data(items), items.size(), owner);
  Array<shown_t<T>> all = Array<shown_t<T>>::make({items.size()});
  for (std::size_t i = 0; i < items.size(); ++i) all.data()[i] = static_cast<shown_t<T>>(items[i]);
  return std::move(all).lock();
}

}  // namespace binding
