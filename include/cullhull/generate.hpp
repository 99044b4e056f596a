// Test and benchmark point sets, seeded and reproducible.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace cullhull {

struct Shape {
  const char* name;
  const char* description;
};

/// The shapes `generate` knows, in the order a help text should list them.
const std::vector<Shape>& shapes();

/// `count` points of dimension `dimension`, row-major. The same arguments give the same bits on
/// every machine and thread count. Throws Error{invalid_argument} for an unknown shape or a
/// dimension the shape does not have.
std::vector<double> generate(std::string_view shape, std::uint64_t count, std::uint32_t dimension,
                             std::uint64_t seed = 1);

}  // namespace cullhull
