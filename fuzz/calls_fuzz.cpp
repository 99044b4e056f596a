// Calls of the C interface in any order: each gives a status and a line, none crashes or leaks.
#include "tests/c/random_calls.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  random_calls::Calls(data, size).run(200);
  return 0;
}
