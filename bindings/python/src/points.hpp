// A Python array as a PointView, read where it lies.
#pragma once

#include <nanobind/nanobind.h>

#include "cullhull/point_view.hpp"

namespace binding {

/// Holds the buffer of a two-dimensional array for as long as it lives: the owner can neither free
/// nor resize it meanwhile. Created and destroyed with the GIL held; view() needs none.
class Points {
 public:
  /// Throws TypeError for what has no buffer or a scalar type that cannot be read in place
  /// (cullhull/_points.py converts those first), ValueError for another number of axes.
  explicit Points(nanobind::handle array);
  Points(const Points&) = delete;
  Points& operator=(const Points&) = delete;
  ~Points() { PyBuffer_Release(&buffer_); }

  const cullhull::PointView& view() const noexcept { return view_; }

 private:
  Py_buffer buffer_{};
  cullhull::PointView view_;
};

}  // namespace binding
