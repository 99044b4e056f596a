// The bandwidth of the link to the device and of the device's memory.
#include "machine.hpp"

#if defined(CULLHULL_HAVE_CUDA)
#include <cuda_runtime_api.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "cullhull/device_points.hpp"
#include "cullhull/error.hpp"
#include "parallel/memory/raw_array.hpp"
#endif

namespace cullhull::bench {

#if defined(CULLHULL_HAVE_CUDA)
namespace {

void check(cudaError_t error, const char* what) {
  if (error == cudaSuccess) return;
  (void)cudaGetLastError();
  throw Error(ErrorCode::backend_unavailable, std::string(what) + ": " + cudaGetErrorString(error));
}

struct FreeDevice {
  void operator()(void* p) const { (void)cudaFree(p); }
};
struct FreePinned {
  void operator()(void* p) const { (void)cudaFreeHost(p); }
};

std::unique_ptr<void, FreeDevice> device_memory(std::uint64_t bytes) {
  void* p = nullptr;
  check(cudaMalloc(&p, bytes), "device memory");
  return std::unique_ptr<void, FreeDevice>(p);
}

/// The best of the passes, on the host's clock from the call until the device is done: the time
/// that a caller waits.
double copy_rate(void* to, const void* from, std::uint64_t bytes, cudaMemcpyKind kind,
                 unsigned passes, const std::stop_token& stop) {
  double best = 0;
  for (unsigned pass = 0; pass <= passes; ++pass) {
    if (stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
    const auto start = std::chrono::steady_clock::now();
    check(cudaMemcpyAsync(to, from, bytes, kind, nullptr), "copying");
    check(cudaStreamSynchronize(nullptr), "copying");
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    if (pass > 0)  // the first pass touches all memory
      best = std::max(best, static_cast<double>(bytes) / std::max(took.count(), 1e-9));
  }
  return best;
}

DeviceRates rates_of_device(std::uint64_t bytes, unsigned passes, const Progress& progress,
                            const std::stop_token& stop) {
  int device = 0;
  cudaDeviceProp properties = {};
  check(cudaGetDevice(&device), "device");
  check(cudaGetDeviceProperties(&properties, device), "device");
  DeviceRates rates;
  rates.name = properties.name;
  const auto report = [&](double share) {
    if (progress) progress("device", share);
  };
  const auto first = device_memory(bytes), second = device_memory(bytes);
  check(cudaMemset(second.get(), 0, bytes), "device memory");
  report(0);
  {
    void* p = nullptr;
    check(cudaMallocHost(&p, bytes), "pinned memory");
    const std::unique_ptr<void, FreePinned> pinned(p);
    std::fill_n(static_cast<unsigned char*>(p), bytes, static_cast<unsigned char>(1));
    rates.link_pinned = copy_rate(first.get(), p, bytes, cudaMemcpyHostToDevice, passes, stop);
  }
  report(0.4);
  {
    internal::BigArray<unsigned char> pageable(bytes);
    std::fill_n(pageable.get(), bytes, static_cast<unsigned char>(1));
    rates.link_pageable =
        copy_rate(first.get(), pageable.get(), bytes, cudaMemcpyHostToDevice, passes, stop);
  }
  report(0.8);
  rates.copy =
      2 * copy_rate(second.get(), first.get(), bytes, cudaMemcpyDeviceToDevice, 4 * passes, stop);
  report(1);
  return rates;
}

}  // namespace

std::optional<DeviceRates> measure_device(std::uint64_t bytes, unsigned passes,
                                          const Progress& progress, const std::stop_token& stop,
                                          std::string& reason) {
  const CudaStatus status = cuda_status();
  if (!status.available) {
    reason = status.reason;
    return std::nullopt;
  }
  return rates_of_device(bytes, passes, progress, stop);
}

#else

std::optional<DeviceRates> measure_device(std::uint64_t, unsigned, const Progress&,
                                          const std::stop_token&, std::string& reason) {
  reason = "built without CUDA";
  return std::nullopt;
}

#endif

}  // namespace cullhull::bench
