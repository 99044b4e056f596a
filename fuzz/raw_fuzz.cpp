// The first byte is the scalar type, the next four the dimension.
#include "fuzz/read_points.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 5) return 0;
  cullhull::ReadOptions options;
  options.format = "raw";
  options.raw_scalar = static_cast<cullhull::ScalarType>(data[0] % 8);
  std::memcpy(&options.raw_dimension, data + 1, 4);
  if (options.raw_dimension == 0) return 0;
  cullhull::fuzz::read_all(data + 5, size - 5, options);
  return 0;
}
