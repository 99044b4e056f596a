// In the place of CUB: the same results by loops, through as many barriers as CUB would need, with
// scratch memory that is checked and spoilt.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <numeric>
#include <type_traits>
#include <vector>

#include "device_text.hpp"

namespace cub {

template <class T, int Threads>
class BlockReduce {
 public:
  struct TempStorage {
    T values[Threads];
  };
  explicit BlockReduce(TempStorage& storage) : storage_(storage) {}

  /// Of use to thread 0 alone: the others get garbage.
  template <class Combine>
  T Reduce(T value, const Combine& combine) {
    storage_.values[threadIdx.x] = value;
    emulation::barrier("BlockReduce: written");
    if (threadIdx.x == 0)
      for (int i = 1; i < Threads; ++i) value = combine(value, storage_.values[i]);
    else
      std::memset(static_cast<void*>(&value), 0xAB, sizeof value);
    emulation::barrier("BlockReduce: read");
    return value;
  }
  T Sum(T value) { return Reduce(value, std::plus<T>()); }

 private:
  TempStorage& storage_;
};

template <class T, int Threads>
class BlockScan {
 public:
  struct TempStorage {
    T values[Threads];
  };
  explicit BlockScan(TempStorage& storage) : storage_(storage) {}

  void ExclusiveSum(T value, T& before) {
    storage_.values[threadIdx.x] = value;
    emulation::barrier("BlockScan: written");
    before = std::accumulate(storage_.values, storage_.values + threadIdx.x, T{});
    emulation::barrier("BlockScan: read");
  }

 private:
  TempStorage& storage_;
};

/// An odd size, so that nobody relies on another.
inline constexpr std::size_t stand_in_scratch = 1237;

/// True where the call only asked for the size of the scratch memory, or gave too little.
inline bool scratch_answered(void* scratch, std::size_t& bytes, cudaError_t& status) {
  status = cudaSuccess;
  if (scratch == nullptr) {
    bytes = stand_in_scratch;
    return true;
  }
  if (bytes < stand_in_scratch) status = cudaErrorInvalidValue;
  return status != cudaSuccess;
}

struct DeviceScan {
  template <class In, class Out, class Count>
  static cudaError_t ExclusiveSum(void* scratch, std::size_t& bytes, In in, Out out, Count count,
                                  cudaStream_t stream) {
    cudaError_t status;
    if (scratch_answered(scratch, bytes, status)) return status;
    emulation::enqueue(stream, [=] {
      std::memset(scratch, 0x77, stand_in_scratch);
      std::decay_t<decltype(in[0])> sum{};
      for (Count i = 0; i < count; ++i) {
        const auto value = in[i];
        out[i] = sum;
        sum += value;
      }
    });
    return cudaSuccess;
  }
};

struct DeviceRadixSort {
  template <class Key, class Value, class Count>
  static cudaError_t SortPairs(void* scratch, std::size_t& bytes, const Key* keys, Key* sorted_keys,
                               const Value* values, Value* sorted, Count count, int first_bit,
                               int end_bit, cudaStream_t stream) {
    cudaError_t status;
    if (scratch_answered(scratch, bytes, status)) return status;
    emulation::enqueue(stream, [=] {
      std::memset(scratch, 0x77, stand_in_scratch);
      const auto part = [&](Count i) {
        return (std::uint64_t{keys[i]} & ((std::uint64_t{1} << end_bit) - 1)) >> first_bit;
      };
      std::vector<Count> order(count);
      std::iota(order.begin(), order.end(), Count{0});
      std::stable_sort(order.begin(), order.end(),
                       [&](Count a, Count b) { return part(a) < part(b); });
      for (Count i = 0; i < count; ++i) {
        sorted_keys[i] = keys[order[i]];
        sorted[i] = values[order[i]];
      }
    });
    return cudaSuccess;
  }
};

}  // namespace cub
