#include "fuzz/read_points.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  cullhull::ReadOptions options;
  options.format = "geojson";
  cullhull::fuzz::read_all(data, size, options);
  options.columns = "x,y";  // where some positions have heights
  cullhull::fuzz::read_all(data, size, options);
  return 0;
}
