#include "planted.hpp"

#include <cstdlib>

namespace emulation {
namespace {

/// The hash of planted_errors.py.
std::uint32_t number_of(const char* name) {
  std::uint32_t value = 0x811C9DC5U;
  for (; *name != 0; ++name) value = (value ^ static_cast<unsigned char>(*name)) * 0x01000193U;
  return value;
}

}  // namespace

const std::uint32_t planted_error =
    number_of(std::getenv("CULLHULL_PLANTED") != nullptr ? std::getenv("CULLHULL_PLANTED") : "");

}  // namespace emulation
