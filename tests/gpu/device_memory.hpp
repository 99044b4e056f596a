// What tests on a device share.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>

#include "cullhull/device_points.hpp"
#include "parallel/cuda_runtime.hpp"

namespace cullhull::testing_support {

class GpuTest : public testing::Test {
 protected:
  void SetUp() override {
    const CudaStatus status = cuda_status();
    if (!status.available) GTEST_SKIP() << status.reason;
  }
};

/// A copy of host values in device memory, or room for some.
template <class T>
class OnDevice {
 public:
  explicit OnDevice(std::size_t count) : array_(count, nullptr) {
    internal::cuda::synchronise(nullptr, "allocating");
  }
  OnDevice(const T* values, std::size_t count) : OnDevice(count) {
    internal::cuda::upload(array_.data(), values, count, nullptr);
  }
  T* data() const { return array_.data(); }

 private:
  internal::cuda::DeviceArray<T> array_;
};

}  // namespace cullhull::testing_support
