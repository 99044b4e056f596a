// The unit of a LAS file's coordinates, by its coordinate reference system.
#pragma once

#include <cstddef>
#include <string>

#include "io/source.hpp"

namespace cullhull::internal::inline io {

/// "metre", "foot", "US survey foot", "degree", or the name that the WKT has for the unit of x and
/// y; empty where the records behind the header, `count` from byte `begin` on, do not tell.
std::string las_unit(const Source& head, std::size_t begin, std::size_t count);

}  // namespace cullhull::internal::inline io
