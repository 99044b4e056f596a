// CGAL, exact as we are: a rival, and in 2D and 3D the reference for our vertices.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "child.hpp"

namespace cullhull::bench {

struct CgalRun {
  double seconds = 0;  ///< of convex_hull_2 or convex_hull_3 alone, one core
  bool finished = true;
  std::vector<double> extreme;  ///< rows of the extreme points, in no order
};

/// The program that runs CGAL (bench/rival_cgal.cpp), in our folder; empty if it was not built.
std::string cgal_program();

/// `rows` of dimension d; empty without a program, beyond 3D, and where it failed.
std::optional<CgalRun> run_cgal(const std::string& program, const std::vector<double>& rows,
                                unsigned d, const ChildLimits& limits);

/// The difference of two sets of rows: how many are only in one, and only in the other.
struct Difference {
  std::uint64_t first = 0, second = 0;
};
Difference difference(const std::vector<double>& first, const std::vector<double>& second,
                      unsigned d);

}  // namespace cullhull::bench
