// The first byte chooses between .csv, .xyz, .pts, .node, and the format its content suggests;
// whether columns are asked for, by name or number; and the decimal mark.
#include "fuzz/read_points.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  cullhull::ReadOptions options;
  options.remark = [](const std::string&) {};
  static const char* const formats[] = {"csv", "xyz", ""};
  static const char* const columns[] = {"", "x,y", "2,0", "1:", "\"a,b\",z"};
  const unsigned choice = data[0];
  options.format = formats[choice % 3];
  options.columns = columns[choice / 3 % 5];
  const unsigned more = choice / 15;  // 0 keeps what older seeds chose
  if (more % 3 > 0 && choice % 3 < 2) options.format = choice % 3 == 0 ? "pts" : "node";
  if (more % 3 == 2 && choice % 3 == 2) options.decimal = '.';
  if (more / 3 % 3 > 0) options.decimal = more / 3 % 3 == 1 ? ',' : '.';
  cullhull::fuzz::read_all(data + 1, size - 1, options);
  return 0;
}
