// Points in a device's memory, as Python hands them in.
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <memory>

#include "cullhull/device_points.hpp"

namespace binding {

/// A stream of the library's, behind which a producer puts its work.
struct DeviceStream {
  std::shared_ptr<void> stream;
};

/// A view, and the Python object that owns its memory.
struct DevicePoints {
  cullhull::DevicePointView view;
  nanobind::object owner;
  std::shared_ptr<void> stream;  ///< the view's, if it is the library's
  /// For an array of sets, shape (sets, n, d): how many, and the points of each; else -1.
  std::int64_t sets = -1, set_size = 0;
};

}  // namespace binding
