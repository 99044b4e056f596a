// The first byte chooses between .csv, .xyz, and the format its content suggests; and whether
// columns are asked for, by name or number.
#include "fuzz/read_points.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  cullhull::ReadOptions options;
  options.remark = [](const std::string&) {};
  if (data[0] % 3 < 2) options.format = data[0] % 3 == 0 ? "csv" : "xyz";
  static const char* const columns[] = {"", "x,y", "2,0", "1:", "\"a,b\",z"};
  options.columns = columns[data[0] / 3 % 5];
  cullhull::fuzz::read_all(data + 1, size - 1, options);
  return 0;
}
