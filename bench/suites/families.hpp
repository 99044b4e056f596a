// Sets of points for measurements: the shapes of generate(), and families that are hard for a hull
// code in 3D.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/generate.hpp"

namespace cullhull::bench {

/// The hard ones, by name, with what they are; all in 3D.
const std::vector<Shape>& hard_families();

/// Every name make_family takes: hard ones, and shapes of generate() ("grid:K" too).
bool is_family(std::string_view name, unsigned d);

/// About `count` points (lattices have the nearest number they can), row-major. Reproducible.
std::vector<double> make_family(std::string_view name, std::uint64_t count, unsigned d);

}  // namespace cullhull::bench
