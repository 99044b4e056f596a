// A NumPy array as a PointView, read in place.
#pragma once

#include <nanobind/nanobind.h>

#include <vector>

#include "cullhull/point_view.hpp"

namespace binding {

/// Keeps a two-dimensional array and its memory alive. Created and destroyed with the GIL held;
/// view() does not need it.
class Points {
 public:
  /// Throws TypeError for other objects than NumPy arrays, and for scalar types that cannot be read
  /// in place (cullhull/_arguments.py converts those first), ValueError for another number of axes.
  explicit Points(nanobind::handle array);

  const cullhull::PointView& view() const noexcept { return view_; }

 private:
  nanobind::object owner_;
  cullhull::PointView view_;
};

/// All coordinates of a view as doubles, point after point.
std::vector<double> rows_of_view(const cullhull::PointView& view);

}  // namespace binding
