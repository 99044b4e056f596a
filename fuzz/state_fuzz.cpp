// A hull state from any bytes: refused in one line, or one whose hull can be asked for.

#include "cullhull/hull.hpp"
#include "cullhull/stream.hpp"
#include "fuzz/read_points.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<std::byte> bytes(reinterpret_cast<const std::byte*>(data),
                                     reinterpret_cast<const std::byte*>(data) + size);
  cullhull::HullState state;
  try {
    state = cullhull::HullState::from_bytes(bytes);
  } catch (const cullhull::Error& error) {
    cullhull::fuzz::check_refusal(error);
    return 0;
  }
  if (state.to_bytes() != bytes) std::abort();
  if (state.dimension() == 0 || state.dimension() > 4 || state.ids().size() > 100) return 0;
  if (state.hull().point_count != state.point_count()) std::abort();
  return 0;
}
