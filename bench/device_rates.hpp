// The bandwidth of the link to the device and of the device's memory.
#pragma once

#include <cuda_runtime_api.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>

#include "cuda/runtime.hpp"
#include "parallel/memory/raw_array.hpp"

/// Bytes per second; a copy within the device counts both the bytes read and the bytes written.
struct DeviceRates {
  double link_pinned = 0, link_pageable = 0;  ///< from host memory to device memory
  double copy = 0;                            ///< within the device
};

/// The best of the passes, on the host's clock from the call until the device is done: the time
/// that a caller waits.
inline double copy_rate(void* to, const void* from, std::uint64_t bytes, cudaMemcpyKind kind,
                        unsigned passes) {
  double best = 0;
  for (unsigned pass = 0; pass <= passes; ++pass) {
    const auto start = std::chrono::steady_clock::now();
    cullhull::internal::check(cudaMemcpyAsync(to, from, bytes, kind, nullptr), "copying");
    cullhull::internal::check(cudaStreamSynchronize(nullptr), "copying");
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    if (pass > 0)  // the first pass touches all memory
      best = std::max(best, static_cast<double>(bytes) / std::max(took.count(), 1e-9));
  }
  return best;
}

inline DeviceRates measure_device() {
  constexpr std::uint64_t bytes = std::uint64_t{512} << 20;
  constexpr unsigned passes = 9;
  struct FreePinned {
    void operator()(void* p) const { (void)cudaFreeHost(p); }
  };
  DeviceRates rates;
  const cullhull::internal::DeviceArray<unsigned char> first(bytes, nullptr),
      second(bytes, nullptr);
  {
    void* p = nullptr;
    cullhull::internal::check(cudaMallocHost(&p, bytes), "pinned memory");
    const std::unique_ptr<void, FreePinned> pinned(p);
    std::fill_n(static_cast<unsigned char*>(p), bytes, static_cast<unsigned char>(1));
    rates.link_pinned = copy_rate(first.data(), p, bytes, cudaMemcpyHostToDevice, passes);
  }
  {
    cullhull::internal::BigArray<unsigned char> pageable(bytes);
    std::fill_n(pageable.get(), bytes, static_cast<unsigned char>(1));
    rates.link_pageable =
        copy_rate(first.data(), pageable.get(), bytes, cudaMemcpyHostToDevice, passes);
  }
  rates.copy =
      2 * copy_rate(second.data(), first.data(), bytes, cudaMemcpyDeviceToDevice, 4 * passes);
  return rates;
}
