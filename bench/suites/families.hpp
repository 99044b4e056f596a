// Sets of points for measurements: the shapes of generate(), families that are hard for a hull code
// in 3D, and families that a triangulation depends on.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/generate.hpp"

namespace cullhull::bench {

/// The hard ones, by name, with what they are; all in 3D.
const std::vector<Shape>& hard_families();

/// Those that triangulations are measured on beside the shapes of generate(), of any dimension.
const std::vector<Shape>& spread_families();

/// Every name make_family takes: hard ones, spread ones, and shapes of generate() ("grid:K" too).
bool is_family(std::string_view name, unsigned d);

/// About `count` points (lattices have the nearest number they can), row-major. Reproducible.
std::vector<double> make_family(std::string_view name, std::uint64_t count, unsigned d);

}  // namespace cullhull::bench
