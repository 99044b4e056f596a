// The first byte chooses between .csv, .xyz, and the format its content suggests.
#include "fuzz/read_points.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  cullhull::ReadOptions options;
  if (data[0] % 3 < 2) options.format = data[0] % 3 == 0 ? "csv" : "xyz";
  cullhull::fuzz::read_all(data + 1, size - 1, options);
  return 0;
}
