// Points in a device's memory, as Python hands them in.
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>

#include "cullhull/device_points.hpp"

namespace binding {

/// A view, and the Python object that owns its memory.
struct DevicePoints {
  cullhull::DevicePointView view;
  nanobind::object owner;
  /// For an array of sets, shape (sets, n, d): how many, and the points of each; else -1.
  std::int64_t sets = -1, set_size = 0;
};

}  // namespace binding
