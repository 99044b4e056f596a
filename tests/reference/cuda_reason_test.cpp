// Every way in which CUDA can be missing has its own line. Needs no device, only CUDA's headers.
#include <gtest/gtest.h>

#include "cuda/reason.hpp"
#include "thrown.hpp"

namespace cullhull::internal::cuda_reason_test {

using testing_support::has;

Probe working() {
  Probe p;
  p.driver_version = 13000;
  p.runtime_version = 13000;
  p.devices = 1;
  p.name = "Some GPU";
  p.capability = 90;
  return p;
}

void expect_reason(const Probe& probe, const std::string& part) {
  const std::string reason = unavailable_reason(probe);
  EXPECT_TRUE(has(reason, part));
  EXPECT_FALSE(has(reason, "\n"));
  EXPECT_TRUE(has(reason, "backend")) << "says what to do: " << reason;
}

TEST(CudaReason, AWorkingDeviceHasNone) { EXPECT_EQ(unavailable_reason(working()), ""); }

TEST(CudaReason, NoDriver) {
  Probe p;
  p.error = cudaErrorInsufficientDriver;  // what the run-time library says without any
  p.runtime_version = 13000;
  expect_reason(p, "no NVIDIA driver");
}

TEST(CudaReason, OldDriver) {
  Probe p = working();
  p.error = cudaErrorInsufficientDriver;
  p.driver_version = 12040;
  expect_reason(p, "knows CUDA 12.4 and this build needs CUDA 13.0");
}

TEST(CudaReason, NoDevice) {
  Probe p = working();
  p.error = cudaErrorNoDevice;
  expect_reason(p, "no CUDA device");
  p.error = cudaSuccess;
  p.devices = 0;
  expect_reason(p, "no CUDA device");
}

TEST(CudaReason, OldDevice) {
  Probe p = working();
  p.capability = 61;
  expect_reason(p, "compute capability 6.1 and 7.5 is needed");
}

TEST(CudaReason, NoCodeForTheDevice) {
  for (const cudaError_t e : {cudaErrorNoKernelImageForDevice, cudaErrorUnsupportedPtxVersion}) {
    Probe p = working();
    p.code_error = e;
    expect_reason(p, "no code for the CUDA device Some GPU");
  }
}

TEST(CudaReason, AnythingElseIsQuoted) {
  Probe p = working();
  p.error = cudaErrorSystemDriverMismatch;
  expect_reason(p, "CUDA cannot be used: ");
  p = working();
  p.code_error = cudaErrorIllegalAddress;
  expect_reason(p, "Some GPU cannot be used: ");
}

}  // namespace cullhull::internal::cuda_reason_test
