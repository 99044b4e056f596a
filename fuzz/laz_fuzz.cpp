// All fields that a point format has names for: of layered chunks every layer is decoded. What the
// seeds are, tests/reference/io_laz_test.cpp says.
#include "fuzz/read_points.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  cullhull::ReadOptions options;
  options.format = "las";
  options.memory_budget = std::uint64_t{64} << 20;  // a byte of LAZ may hold thousands of points
  for (const char* columns : {"x,y,z,intensity,return_number,classification,user_data,withheld",
                              "gps_time,point_source_id", "scan_angle", "red,green,blue", "nir"}) {
    options.columns = columns;
    cullhull::fuzz::read_all(data, size, options);
  }
  return 0;
}
