// A NumPy array as a PointView, read where it lies.
#pragma once

#include <nanobind/nanobind.h>

#include "cullhull/point_view.hpp"

namespace binding {

/// Keeps a two-dimensional array alive, and so the memory it lies in: nobody can free it meanwhile.
/// Created and destroyed with the GIL held; view() needs none.
class Points {
 public:
  /// Throws TypeError for what is no NumPy array or of a scalar type that cannot be read in place
  /// (cullhull/_arguments.py converts those first), ValueError for another number of axes.
  explicit Points(nanobind::handle array);

  const cullhull::PointView& view() const noexcept { return view_; }

 private:
  nanobind::object owner_;
  cullhull::PointView view_;
};

}  // namespace binding
