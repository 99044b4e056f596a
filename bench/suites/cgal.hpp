// CGAL, an exact rival; in 2D and 3D also the reference for cullhull's vertices.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "child.hpp"

namespace cullhull::bench {

struct CgalRun {
  double seconds = 0;  ///< of convex_hull_2 or convex_hull_3 only, on one core
  bool finished = true;
  std::vector<double> extreme;  ///< rows of the extreme points, unordered
};

/// The program that runs CGAL (bench/rival_cgal.cpp), in this program's folder; empty if absent.
std::string cgal_program();

/// Runs it on `rows` of dimension d; empty without a program, beyond 3D, and on failure.
std::optional<CgalRun> run_cgal(const std::string& program, const std::vector<double>& rows,
                                unsigned d, const ChildLimits& limits);

/// The difference of two sets of rows: the number of rows only in the first, and only in the
/// second.
struct Difference {
  std::uint64_t first = 0, second = 0;
};
Difference difference(const std::vector<double>& first, const std::vector<double>& second,
                      unsigned d);

}  // namespace cullhull::bench
