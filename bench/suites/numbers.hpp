// Formats numbers for readers.
#pragma once

#include <cstdint>
#include <string>

namespace cullhull::bench {

/// 8000000 as "8M", 12500 as "12.5k".
std::string short_count(std::uint64_t n);

/// 12746 as "12,746".
std::string grouped(std::uint64_t number);

}  // namespace cullhull::bench
