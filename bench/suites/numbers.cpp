#include "numbers.hpp"

#include <fmt/format.h>

#include <cmath>

namespace cullhull::bench {

std::string short_count(std::uint64_t n) {
  if (n >= 1'000'000) return fmt::format("{:g}M", std::round(static_cast<double>(n) / 1e4) / 100);
  if (n >= 1'000) return fmt::format("{:g}k", std::round(static_cast<double>(n) / 1e1) / 100);
  return std::to_string(n);
}

std::string grouped(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, 1, ',');
  return text;
}

}  // namespace cullhull::bench
