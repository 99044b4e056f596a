// Scans of Leica's.
#include "fuzz/read_points.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  cullhull::ReadOptions options;
  options.format = "ptx";
  cullhull::fuzz::read_all(data, size, options);
  return 0;
}
