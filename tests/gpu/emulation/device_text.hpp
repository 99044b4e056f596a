// What the words of CUDA mean to the host's compiler: included first in every text that
// rewrite_kernels.py makes.
#pragma once

#include <cuda_runtime.h>

#include <cfenv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <utility>

#include "block.hpp"
#include "device.hpp"
#include "planted.hpp"
#include "races.hpp"

#undef __grid_constant__
#undef __launch_bounds__
#undef __forceinline__
#undef __host__
#undef __device__
#undef __global__
#define __grid_constant__
#define __host__
#define __device__
#define __global__
// Always inlined: no copy of a function in its device's form may stand for the host's when linked.
#define __forceinline__ inline __attribute__((always_inline))

#define threadIdx ::emulation::thread_index
#define blockIdx ::emulation::block_index
#define blockDim ::emulation::block_size
#define gridDim ::emulation::grid_size

#define EMULATION_TEXT_2(x) #x
#define EMULATION_TEXT(x) EMULATION_TEXT_2(x)
#define EMULATION_HERE __FILE__ ":" EMULATION_TEXT(__LINE__)

#define __syncthreads() ::emulation::barrier(EMULATION_HERE)
#define __syncwarp() \
  ::emulation::warp_operation(::emulation::WarpOperation::wait, 0xFFFFFFFFU, 0, 0, EMULATION_HERE)
#define __shfl_xor_sync(mask, value, lanes)                                   \
  ::emulation::shuffled(::emulation::WarpOperation::shuffle_xor, mask, value, \
                        static_cast<int>(lanes), EMULATION_HERE)
#define __shfl_down_sync(mask, value, lanes)                                   \
  ::emulation::shuffled(::emulation::WarpOperation::shuffle_down, mask, value, \
                        static_cast<int>(lanes), EMULATION_HERE)
#define __ballot_sync(mask, predicate)                                                    \
  ::emulation::word(::emulation::warp_operation(::emulation::WarpOperation::ballot, mask, \
                                                (predicate) != 0, 0, EMULATION_HERE))

namespace emulation {

inline std::uint32_t word(std::uint64_t value) { return static_cast<std::uint32_t>(value); }

/// Values of up to eight bytes, as a device's shuffles take them.
template <class T>
T shuffled(WarpOperation which, unsigned mask, T value, int lanes, const char* where) {
  static_assert(sizeof(T) == 4 || sizeof(T) == 8);
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof value);
  bits = warp_operation(which, mask, bits, lanes, where);
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

template <class T>
void require_aligned(const T* p, const char* doing) {
  if (reinterpret_cast<std::uintptr_t>(p) % sizeof(T) != 0)
    violation(std::string(doing) + " at an address that is not aligned");
}

template <class T>
T load(const T* p) {
  require_aligned(p, "a vector load");
  return *p;
}

// Other threads may run before an atomic operation and not within it. Its accesses are reported as
// one, so the compiler must not report them.
#define EMULATION_ATOMIC __attribute__((noinline, no_sanitize_thread))
template <class T, class U>
EMULATION_ATOMIC T atomic_max(T* target, U value) {
  require_aligned(target, "an atomic operation");
  atomic_access(target, sizeof(T));
  const T before = *target;
  if (static_cast<T>(value) > before) *target = static_cast<T>(value);
  return before;
}
template <class T, class U>
EMULATION_ATOMIC T atomic_min(T* target, U value) {
  require_aligned(target, "an atomic operation");
  atomic_access(target, sizeof(T));
  const T before = *target;
  if (static_cast<T>(value) < before) *target = static_cast<T>(value);
  return before;
}
template <class T, class U>
EMULATION_ATOMIC T atomic_or(T* target, U value) {
  require_aligned(target, "an atomic operation");
  atomic_access(target, sizeof(T));
  const T before = *target;
  *target = before | static_cast<T>(value);
  return before;
}
template <class T, class U>
EMULATION_ATOMIC T atomic_add(T* target, U value) {
  require_aligned(target, "an atomic operation");
  atomic_access(target, sizeof(T));
  const T before = *target;
  *target = before + static_cast<T>(value);
  return before;
}

/// rcp.approx.ftz.f32: within a unit in the last place, any of the three; subnormals flushed.
inline float approximate_reciprocal(float v) {
  constexpr float least_normal = 0x1p-126F;
  if (v != v) return v;
  const float flushed = std::fabs(v) < least_normal ? std::copysign(0.0F, v) : v;
  float r = 1.0F / flushed;
  if (std::isinf(flushed) || std::fabs(r) < least_normal) return std::copysign(0.0F, v);
  if (std::isinf(r)) return r;
  std::uint32_t bits;
  std::memcpy(&bits, &r, sizeof bits);
  bits += static_cast<std::uint32_t>(static_cast<int>(random64() % 3) - 1);
  std::memcpy(&r, &bits, sizeof bits);
  return r;
}

inline float add_rounding_down(float a, float b) {
  const int before = std::fegetround();
  std::fesetround(FE_DOWNWARD);
  const volatile float x = a, y = b;
  const volatile float sum = x + y;
  std::fesetround(before);
  return sum;
}

inline std::uint32_t bits_of(float v) {
  std::uint32_t bits;
  std::memcpy(&bits, &v, sizeof bits);
  return bits;
}
inline long long bits_of_double(double v) {
  long long bits;
  std::memcpy(&bits, &v, sizeof bits);
  return bits;
}
inline double double_of_bits(long long bits) {
  double v;
  std::memcpy(&v, &bits, sizeof v);
  return v;
}

/// What <<<...>>> becomes.
template <class Call>
struct Launcher {
  Launch launch;
  Call call;

  template <class... Arguments>
  void operator()(Arguments... arguments) const {
    submit(launch, [call = call, arguments...] { call(arguments...); });
  }
};
template <class Call>
Launcher<Call> launch(const char* name, const void* function, Call call, unsigned grid,
                      unsigned block, std::size_t shared = 0, cudaStream_t stream = nullptr) {
  return {{grid, block, shared, stream, function, name}, call};
}

}  // namespace emulation

#define __ldg(p) ::emulation::load(p)
#define __popc(v) __builtin_popcount(v)
#define __ffs(v) __builtin_ffs(v)
#define atomicMax ::emulation::atomic_max
#define atomicMin ::emulation::atomic_min
#define atomicAdd ::emulation::atomic_add
#define atomicOr ::emulation::atomic_or
#define __fadd_rd ::emulation::add_rounding_down
#define __fmaf_rn(a, b, c) \
  std::fma(static_cast<float>(a), static_cast<float>(b), static_cast<float>(c))
#define __fma_rn(a, b, c) \
  std::fma(static_cast<double>(a), static_cast<double>(b), static_cast<double>(c))
#define __double2float_rn(v) static_cast<float>(v)
#define __float_as_uint ::emulation::bits_of
#define __double_as_longlong ::emulation::bits_of_double
#define __longlong_as_double ::emulation::double_of_bits
#define cospi(x) std::cos(3.14159265358979323846 * (x))
using std::isfinite;

// The templates of the run-time library's C++ side.
template <class Result, class... Arguments>
cudaError_t cudaFuncSetAttribute(Result (*f)(Arguments...), cudaFuncAttribute attribute,
                                 int value) {
  return ::cudaFuncSetAttribute(reinterpret_cast<const void*>(f), attribute, value);
}
template <class Result, class... Arguments>
cudaError_t cudaOccupancyMaxActiveBlocksPerMultiprocessor(int* blocks, Result (*f)(Arguments...),
                                                          int threads, std::size_t shared) {
  return ::cudaOccupancyMaxActiveBlocksPerMultiprocessor(blocks, reinterpret_cast<const void*>(f),
                                                         threads, shared);
}
