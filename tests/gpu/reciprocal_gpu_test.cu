// The device's reciprocal, an approximation and one Newton step, is the correctly rounded one for
// every mantissa (docs/exactness.md, G3). Only a device can tell: were its approximation off by a
// unit in the last place in any direction, as the emulated device's is, some would be wrong.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <vector>

#include "filter/gauge/gauge_lanes.hpp"
#include "gpu/device.hpp"

namespace cullhull::internal {
namespace {

__global__ void reciprocals(std::uint32_t first, std::uint32_t step, std::uint32_t count,
                            float* out) {
  for (std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x; i < count;
       i += gridDim.x * blockDim.x)
    out[i] = lanes::reciprocal(std::bit_cast<float>(first + i * step));
}

TEST(ReciprocalGpu, EveryMantissaIsRoundedCorrectly) {
  CULLHULL_NEEDS_DEVICE();
  constexpr std::uint32_t mantissas = 1U << 23;
  const std::uint32_t step = testing::short_run() ? 61 : 1;
  const std::uint32_t count = mantissas / step;
  std::vector<float> found(count);
  const testing::OnDevice there(found);
  // Magnitudes of the map's frame and the ends of what is promised.
  for (const int exponent : {0, -1, -100, 125}) {
    const std::uint32_t first = static_cast<std::uint32_t>(exponent + 127) << 23;
    reciprocals<<<132, 256>>>(first, step, count, there.data<float>());
    testing::check(cudaGetLastError());
    testing::check(cudaMemcpy(found.data(), there.data<float>(), count * sizeof(float),
                              cudaMemcpyDeviceToHost));
    std::uint32_t wrong = 0, example = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const float v = std::bit_cast<float>(first + i * step);
      if (found[i] == 1.0F / v) continue;
      example = wrong++ == 0 ? i : example;
    }
    EXPECT_EQ(wrong, 0U) << "of exponent " << exponent << ", the first at mantissa "
                         << example * step;
  }
}

}  // namespace
}  // namespace cullhull::internal
