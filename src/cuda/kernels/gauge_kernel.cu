// The GaugeMap on a CUDA device: one pass over the points that writes one bit for each, then the
// bits are converted to ids. bench/notes/gpu.md counts bytes and operations.
//
// A mask instead of an appended list: a list needs room for every point or a second attempt, and
// its order depends on the race of threads, so it must be sorted. The mask is a bit a point, 1 % of
// what is read, in the points' order. No kernel here uses atomics to place its output.

#include <algorithm>
#include <cub/block/block_reduce.cuh>
#include <cub/block/block_scan.cuh>
#include <cub/device/device_scan.cuh>
#include <map>
#include <mutex>
#include <utility>

#include "cuda/kernels/coordinate.cuh"
#include "cuda/kernels/gauge_kernel.hpp"
#include "cuda/runtime.hpp"
#include "filter/gauge/gauge_lanes.hpp"

namespace cullhull::internal {
namespace {

constexpr unsigned mask_threads = 512;
/// Words of a mask that one block converts to ids, and its threads.
constexpr std::uint32_t tile_words = 1024;
constexpr unsigned tile_threads = 256;
constexpr unsigned thread_words = tile_words / tile_threads;
static_assert(thread_words == 4);
constexpr unsigned every_lane = 0xFFFFFFFFU;

// ---------------------------------------------------------------- the test

/// Combines the lanes' bits to words in the points' order; lane 32 / lane_points * w stores word w.
template <unsigned D, class T>
__device__ void store_words(const PackedRows<D, T>&, std::uint32_t bits, unsigned lane,
                            std::uint32_t* words) {
  constexpr unsigned points = PackedRows<D, T>::lane_points;
  constexpr unsigned lanes_a_word = 32 / points;
  std::uint32_t word = bits << (lane % lanes_a_word * points);
#pragma unroll
  for (unsigned apart = 1; apart < lanes_a_word; apart *= 2)
    word |= __shfl_xor_sync(every_lane, word, static_cast<int>(apart));
  if (lane % lanes_a_word == 0) words[lane / lanes_a_word] = word;
}

template <unsigned D, class T>
__device__ void store_words(const AnyStrides<D, T>&, std::uint32_t bits, unsigned lane,
                            std::uint32_t* words) {
#pragma unroll
  for (unsigned k = 0; k < AnyStrides<D, T>::lane_points; ++k) {
    const std::uint32_t word = __ballot_sync(every_lane, bits >> k & 1);
    if (lane == k) words[k] = word;
  }
}

/// Node values in global memory, through the read-only cache.
struct GlobalNodes {
  const float* values;
  __device__ float operator[](std::uint32_t i) const { return __ldg(values + i); }
};

/// Blocks on a multiprocessor at a time that registers must suffice for. From sm_100 on four points
/// of four and more coordinates do not fit into 64 registers a thread.
template <unsigned D>
constexpr unsigned resident_blocks() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 1000
  return D >= 4 ? 1 : 2;
#else
  return 2;
#endif
}

/// Persistent blocks: each copies the table to its shared memory once, then its warps take evenly
/// spaced groups of points. All lanes of a warp leave the loop together, as the shuffles need.
template <bool Shared, class Layout, class C>
__global__ void __launch_bounds__(mask_threads, resident_blocks<Layout::D>())
    mask_kernel(const __grid_constant__ GaugeConstants<Layout::D, C> t,
                const float* __restrict__ nodes, std::uint32_t node_count, const Layout layout,
                std::uint64_t count, std::uint32_t* __restrict__ mask) {
  extern __shared__ float table[];
  if constexpr (Shared) {
    for (std::uint32_t i = threadIdx.x; i < node_count; i += mask_threads) table[i] = nodes[i];
    __syncthreads();
  }
  constexpr unsigned words = Layout::group_points / 32;
  constexpr unsigned block_warps = mask_threads / warp_lanes;
  const unsigned lane = threadIdx.x % warp_lanes;
  const std::uint64_t groups = group_count<Layout>(count);
  const std::uint64_t warps = std::uint64_t{gridDim.x} * block_warps;
  for (std::uint64_t group = std::uint64_t{blockIdx.x} * block_warps + threadIdx.x / warp_lanes;
       group < groups; group += warps) {
    std::uint32_t bits;
    if constexpr (Shared)
      bits = lane_survivors(t, static_cast<const float*>(table), layout, group, lane, count);
    else
      bits = lane_survivors(t, GlobalNodes{nodes}, layout, group, lane, count);
    store_words(layout, bits, lane, mask + group * words);
  }
}

/// Raises the limit of the shared memory of a kernel to at least `bytes`. The limit belongs to the
/// function, and all threads of the process share it: it is the device's maximum where the driver
/// grants that, and never less than another thread has asked for.
template <class Kernel>
cudaError_t allow_shared(Kernel kernel, std::size_t bytes, const Device& device) {
  const auto limit = cudaFuncAttributeMaxDynamicSharedMemorySize;
  if (cudaFuncSetAttribute(kernel, limit, static_cast<int>(device.shared_per_block)) == cudaSuccess)
    return cudaSuccess;
  (void)cudaGetLastError();  // the driver keeps a part, as tools that watch kernels make it do
  static std::mutex mutex;
  static std::map<std::pair<Kernel, int>, std::size_t> granted;
  const std::lock_guard lock(mutex);
  std::size_t& most = granted[{kernel, device.ordinal}];
  const cudaError_t status =
      cudaFuncSetAttribute(kernel, limit, static_cast<int>(std::max(most, bytes)));
  if (status == cudaSuccess) most = std::max(most, bytes);
  return status;
}

template <bool Shared, class Layout, class C>
cudaError_t launch_mask(const GaugeTable& table, const float* nodes, const Layout& layout,
                        std::uint64_t count, std::uint32_t* mask, const Device& device,
                        cudaStream_t stream) {
  const auto kernel = mask_kernel<Shared, Layout, C>;
  const std::size_t shared = Shared ? table.nodes.size() * sizeof(float) : 0;
  cudaError_t status = cudaSuccess;
  if (Shared) status = allow_shared(kernel, shared, device);
  // The preferred share of shared memory in the memory that it divides with the cache: for two
  // blocks, each with the KiB that the system takes. Only a hint.
  const std::size_t percent = (200 * (shared + 1024) + device.shared_per_multiprocessor - 1) /
                              std::max<std::size_t>(device.shared_per_multiprocessor, 1);
  if (Shared && status == cudaSuccess)
    status = cudaFuncSetAttribute(kernel, cudaFuncAttributePreferredSharedMemoryCarveout,
                                  static_cast<int>(std::min<std::size_t>(percent, 100)));
  int blocks = 0;
  if (status == cudaSuccess)
    status = cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, kernel, mask_threads, shared);
  if (status != cudaSuccess) return status;
  if (blocks == 0) return cudaErrorLaunchOutOfResources;
  constexpr unsigned block_points = Layout::group_points * (mask_threads / warp_lanes);
  const unsigned grid =
      blocks_for(count, block_points, std::uint64_t{device.multiprocessors} * blocks);
  kernel<<<grid, mask_threads, shared, stream>>>(gauge_constants<Layout::D, C>(table), nodes,
                                                 static_cast<std::uint32_t>(table.nodes.size()),
                                                 layout, count, mask);
  return cudaGetLastError();
}

// ---------------------------------------------------------------- from bits to ids

/// Loads this thread's words of a tile, zero beyond the end.
__device__ void thread_words_of(const std::uint32_t* mask, std::uint64_t words,
                                std::uint32_t (&mine)[thread_words]) {
  const std::uint64_t first = std::uint64_t{blockIdx.x} * tile_words + threadIdx.x * thread_words;
  for (unsigned k = 0; k < thread_words; ++k) mine[k] = first + k < words ? mask[first + k] : 0;
}

__device__ std::uint32_t bits_in(const std::uint32_t (&mine)[thread_words]) {
  std::uint32_t sum = 0;
  for (unsigned k = 0; k < thread_words; ++k) sum += static_cast<std::uint32_t>(__popc(mine[k]));
  return sum;
}

__global__ void __launch_bounds__(tile_threads)
    count_kernel(const std::uint32_t* __restrict__ mask, std::uint64_t words,
                 std::uint64_t* __restrict__ counts) {
  using Reduce = cub::BlockReduce<std::uint32_t, tile_threads>;
  __shared__ typename Reduce::TempStorage storage;
  std::uint32_t mine[thread_words];
  thread_words_of(mask, words, mine);
  const std::uint32_t sum = Reduce(storage).Sum(bits_in(mine));
  if (threadIdx.x == 0) counts[blockIdx.x] = sum;
}

__global__ void __launch_bounds__(tile_threads)
    list_kernel(const std::uint32_t* __restrict__ mask, std::uint64_t words,
                const std::uint64_t* __restrict__ offsets, std::uint64_t* __restrict__ ids) {
  using Scan = cub::BlockScan<std::uint32_t, tile_threads>;
  __shared__ typename Scan::TempStorage storage;
  std::uint32_t mine[thread_words];
  thread_words_of(mask, words, mine);
  std::uint32_t before = 0;
  Scan(storage).ExclusiveSum(bits_in(mine), before);
  std::uint64_t* out = ids + offsets[blockIdx.x] + before;
  const std::uint64_t first = std::uint64_t{blockIdx.x} * tile_words + threadIdx.x * thread_words;
  for (unsigned k = 0; k < thread_words; ++k)
    for (std::uint32_t word = mine[k]; word != 0; word &= word - 1)
      *out++ = (first + k) * 32 + static_cast<std::uint32_t>(__ffs(static_cast<int>(word)) - 1);
}

// ---------------------------------------------------------------- gathering

/// One thread a coordinate: rows are written without gaps.
template <class T>
struct GatherCoordinate {
  DevicePointView points;
  const std::uint64_t* ids;
  T* rows;
  __device__ void operator()(std::uint64_t e) const {
    const std::uint64_t row = e / points.dimension;
    rows[e] = coordinate<T>(points, ids != nullptr ? ids[row] : row,
                            static_cast<unsigned>(e % points.dimension));
  }
};
struct GatherId {
  const std::uint64_t *of, *at;
  std::uint64_t* out;
  __device__ void operator()(std::uint64_t i) const { out[i] = of[at[i]]; }
};

}  // namespace

cudaError_t probe_device_code() {
  cudaFuncAttributes attributes;
  return cudaFuncGetAttributes(&attributes, reinterpret_cast<const void*>(&count_kernel));
}

std::uint32_t most_map_nodes(int ordinal) {
  const Device& device = device_or_current(ordinal);
  // The map of highest dimension needs at least 12288 nodes, 48 KiB, which every device has.
  const std::size_t bytes = device.shared_per_multiprocessor * 3 / 8;
  const std::size_t most = bytes < device.shared_per_block ? bytes : device.shared_per_block;
  return static_cast<std::uint32_t>(most / sizeof(float) > 12288 ? most / sizeof(float) : 12288);
}

cudaError_t gauge_mask(const GaugeTable& table, const float* nodes, const DevicePointView& points,
                       std::uint32_t* mask, const Device& device, cudaStream_t stream) {
  if (points.count == 0) return cudaSuccess;
  cudaError_t status = cudaErrorInvalidValue;
  const bool shared = table.nodes.size() * sizeof(float) <= device.shared_per_block;
  with_types(table, points.scalar, [&]<unsigned D, class T, class C>() {
    with_layout<D, T>(points.data, points.point_stride, points.coordinate_stride,
                      [&]<class Layout>(const Layout& layout) {
      status = shared ? launch_mask<true, Layout, C>(table, nodes, layout, points.count, mask,
                                                     device, stream)
                      : launch_mask<false, Layout, C>(table, nodes, layout, points.count, mask,
                                                      device, stream);
    });
  });
  return status;
}

void sum_in_place(std::uint64_t* numbers, std::uint64_t count, cudaStream_t stream) {
  std::size_t bytes = 0;
  check(cub::DeviceScan::ExclusiveSum(nullptr, bytes, numbers, numbers, count, stream), "counting");
  const DeviceArray<std::byte> scratch(std::max<std::size_t>(bytes, 1), stream);
  check(cub::DeviceScan::ExclusiveSum(scratch.data(), bytes, numbers, numbers, count, stream),
        "counting");
}

DeviceIds list_bits(const std::uint32_t* mask, std::uint64_t words, cudaStream_t stream) {
  // One offset more than there are tiles: the last offset is the total.
  const unsigned tiles = blocks_for(words, tile_words);
  const DeviceArray<std::uint64_t> offsets(tiles + std::size_t{1}, stream);
  fill(offsets.data(), offsets.size(), 0, stream);
  if (tiles > 0) count_kernel<<<tiles, tile_threads, 0, stream>>>(mask, words, offsets.data());
  check(cudaGetLastError(), "counting");
  sum_in_place(offsets.data(), tiles + std::uint64_t{1}, stream);
  DeviceIds result;
  download(&result.count, offsets.data() + tiles, 1, stream);
  result.ids = DeviceArray<std::uint64_t>(result.count, stream);
  if (result.count > 0)
    list_kernel<<<tiles, tile_threads, 0, stream>>>(mask, words, offsets.data(), result.ids.data());
  check(cudaGetLastError(), "listing");
  return result;
}

cudaError_t gather_rows(const DevicePointView& points, const std::uint64_t* ids,
                        std::uint64_t count, void* rows, cudaStream_t stream) {
  return with_device_scalar(points, [&]<class T>() {
    return for_each_item(count * points.dimension,
                         GatherCoordinate<T>{points, ids, static_cast<T*>(rows)}, stream);
  });
}

cudaError_t gather_ids(const std::uint64_t* of, const std::uint64_t* at, std::uint64_t count,
                       std::uint64_t* out, cudaStream_t stream) {
  return for_each_item(count, GatherId{of, at, out}, stream);
}

}  // namespace cullhull::internal
