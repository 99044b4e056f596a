// Point sets for measurements: the shapes of generate(), 3D families that are hard for hull codes,
// and families that are hard for triangulations.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/generate.hpp"

namespace cullhull::bench {

/// Names and descriptions of the hard families, all in 3D.
const std::vector<Shape>& hard_families();

/// Families on which triangulations are measured in addition to the shapes of generate(), in any
/// dimension.
const std::vector<Shape>& spread_families();

/// Whether make_family accepts the name: hard and spread families, and shapes of generate()
/// (including "grid:K").
bool is_family(std::string_view name, unsigned d);

/// About `count` points (lattices: the nearest possible number), row-major. Reproducible.
std::vector<double> make_family(std::string_view name, std::uint64_t count, unsigned d);

}  // namespace cullhull::bench
