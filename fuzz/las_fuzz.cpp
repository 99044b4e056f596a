#include "fuzz/read_points.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  cullhull::ReadOptions options;
  options.format = "las";
  options.memory_budget = std::uint64_t{64} << 20;  // a byte of LAZ may hold thousands of points
  cullhull::fuzz::read_all(data, size, options);
  return 0;
}
