// Point sets on which suites measure, by name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cullhull/point_view.hpp"

namespace cullhull::bench {

/// A point set to measure on.
struct Workload {
  std::string family;  ///< a name that make_family accepts
  unsigned dimension = 3;
  std::uint64_t count = 0;
  ScalarType scalar = ScalarType::f64;

  std::string name() const;   ///< "ball-3d-8M", "grid-3d-2M-i32"
  std::string title() const;  ///< "3D ball 8M", "3D sphere surface 1M, f32"
};

/// The workload with this name. Throws Error{invalid_argument}.
Workload workload_named(const std::string& name);

/// The same values for cullhull and, as doubles, for rivals. Movable: views stay valid.
struct Points {
  std::vector<double> rows;
  std::vector<float> floats;
  std::vector<std::int32_t> integers;
  PointView view, doubles;
};

/// `rows`: doubles, row-major; floats and integers of `w` are obtained by rounding. Throws
/// Error{invalid_argument} beyond 32-bit integers.
Points points_of(const Workload& w, std::vector<double> rows);

}  // namespace cullhull::bench
