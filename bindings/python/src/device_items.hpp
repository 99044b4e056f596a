// Arrays of results in a device's memory.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace binding {

namespace nb = nanobind;

/// An array of a result in a device's memory: cullhull.DeviceArray wraps it.
struct DeviceItems {
  const void* data = nullptr;
  std::vector<std::size_t> shape;
  nb::dlpack::dtype dtype;
  int device = 0;
  std::shared_ptr<const void> memory;

  /// As NumPy spells the type of an item.
  std::string typestr() const {
    const char kind = dtype.code == static_cast<std::uint8_t>(nb::dlpack::dtype_code::Bool) ? 'b'
                      : dtype.code == static_cast<std::uint8_t>(nb::dlpack::dtype_code::Float)
                          ? 'f'
                          : 'i';
    return std::string(dtype.bits == 8 ? "|" : "<") + kind + std::to_string(dtype.bits / 8);
  }
};

/// The memory of a result, for objects of Python: the last of them frees it, which waits for all
/// work of its device, and other threads run meanwhile. Python destroys its objects with the GIL
/// held.
inline std::shared_ptr<const void> freed_without_gil(std::shared_ptr<const void> memory) {
  const void* const address = memory.get();
  return {address, [kept = std::move(memory)](const void*) mutable {
            const nb::gil_scoped_release release;
            kept.reset();
          }};
}

}  // namespace binding
