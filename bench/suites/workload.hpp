// Sets of points that suites measure on, by name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cullhull/point_view.hpp"

namespace cullhull::bench {

/// A set of points to measure on.
struct Workload {
  std::string family;  ///< as make_family knows it
  unsigned dimension = 3;
  std::uint64_t count = 0;
  ScalarType scalar = ScalarType::f64;

  std::string name() const;   ///< "ball-3d-8M", "grid-3d-2M-i32"
  std::string title() const;  ///< "3D ball 8M", "3D sphere surface 1M, f32"
};

/// The workload that has this name. Throws Error{invalid_argument}.
Workload workload_named(const std::string& name);

/// The same values as ours sees them and, as doubles, the rivals. Movable: views stay valid.
struct Points {
  std::vector<double> rows;
  std::vector<float> floats;
  std::vector<std::int32_t> integers;
  PointView view, doubles;
};

/// `rows` are doubles, row-major; floats and integers of `w` are made of them by rounding. Throws
/// Error{invalid_argument} beyond 32-bit integers.
Points points_of(const Workload& w, std::vector<double> rows);

}  // namespace cullhull::bench
