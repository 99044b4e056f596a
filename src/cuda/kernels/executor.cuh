// The data-parallel primitives on a CUDA device, in one stream. The results are those of the serial
// reference: sums of integers, maxima and minima do not depend on the order; scans and stable
// selections are CUB's.
#pragma once

#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <cub/block/block_reduce.cuh>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>
#include <deque>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "cuda/kernels/device_kernels.hpp"
#include "cuda/runtime.hpp"
#include "cullhull/error.hpp"
#include "filter/pseudo_hull/primitives.hpp"

namespace cullhull::internal {

namespace cuda_kernels {

// Launch bounds ask for one block a multiprocessor for kernels that need many registers: with more,
// ptxas would spill registers to fit.
constexpr unsigned block_size = 256;
constexpr unsigned reduce_block_size = 128;  // of structs, a guess

__device__ inline GridThread here() { return {blockIdx.x, threadIdx.x, blockDim.x, gridDim.x}; }

template <class Body>
__global__ void __launch_bounds__(block_size, 1)
    for_each(const __grid_constant__ ForEachKernel<Body> kernel) {
  kernel.run(here());
}

/// The blocks on a multiprocessor that a body asks for, if it does. Before sm_90 ptxas would spill.
template <class Body>
constexpr unsigned resident_blocks() {
#if !defined(__CUDA_ARCH__) || __CUDA_ARCH__ >= 900
  if constexpr (requires { Body::resident_blocks; }) return Body::resident_blocks;
#endif
  return 1;
}

template <class Keep, class Body>
__global__ void __launch_bounds__(block_size, resident_blocks<Body>())
    tiles(const __grid_constant__ TileKernel<Keep, Body> kernel) {
  using Kernel = TileKernel<Keep, Body>;
  __shared__ std::uint32_t list[Kernel::items_a_thread * block_size];
  __shared__ typename Kernel::Shared shared;
  const GridThread at = here();
  const std::uint32_t of_all = kernel.tiles(block_size);
  for (std::uint32_t t = at.block; t < of_all; t += at.blocks) {
    if (at.thread == 0) shared.count = 0;
    __syncthreads();
    kernel.find(t, at, list, shared);
    __syncthreads();
    if constexpr (requires { kernel.body(0U, 0U); }) {
      if (at.thread == 0) kernel.place(shared);
      __syncthreads();
    }
    kernel.use(at, list, shared);
    __syncthreads();
  }
}

/// Rounds from `first` to `last` by one block, which waits for nobody else: for few items.
constexpr unsigned rounds_block_size = 512;
template <class Steps>
__global__ void __launch_bounds__(rounds_block_size, 1)
    rounds_of_block(const __grid_constant__ Steps steps, std::uint32_t first, std::uint32_t last,
                    ItemCount listed, std::uint32_t* done) {
  const GridThread at = here();
  if (at.thread == 0) steps.count[first] = listed.get();
  __syncthreads();
  std::uint32_t round = first;
  for (; round <= last && steps.items(round) != 0; ++round) {
    run_step<true>(steps, round, at);
    __syncthreads();
    run_step<false>(steps, round, at);
    __syncthreads();
  }
  if (at.thread == 0) *done = round - first;
}

/// Every thread combines its items, and every block the results of its threads: partial[b].
template <class T, class Map, class Combine>
__global__ void __launch_bounds__(reduce_block_size, 1)
    reduce(const __grid_constant__ Map map, const __grid_constant__ Combine combine,
           const __grid_constant__ T identity, std::uint32_t count, T* partial) {
  using Reduce = cub::BlockReduce<T, reduce_block_size>;
  __shared__ typename Reduce::TempStorage storage;
  const GridThread at = here();
  T sum = identity;
  for (std::uint64_t i = at.first(); i < count; i += at.stride())
    sum = combine(sum, map(static_cast<std::uint32_t>(i)));
  sum = Reduce(storage).Reduce(sum, combine);
  if (at.thread == 0) partial[at.block] = sum;
}

template <class Body>
__global__ void __launch_bounds__(block_size)
    scatter_max(const __grid_constant__ ScatterMaxKernel<Body> kernel, std::uint32_t* none_of_all) {
  std::uint32_t none = kernel.run(here());
  for (unsigned other = 16; other > 0; other /= 2)
    none += __shfl_down_sync(0xFFFFFFFF, none, other);
  if (threadIdx.x % 32 == 0 && none != 0) atomicAdd(none_of_all, none);
}

/// keep(i) as 0 or 1; 0 from the item after the last on: a scan goes one item beyond the most that
/// there may be.
template <class Keep>
struct KeepAsNumber {
  Keep keep;
  ItemCount items;
  __host__ __device__ std::uint32_t operator()(std::uint32_t i) const {
    return i < items.get() && keep(i) ? 1 : 0;
  }
};

/// What follows such a scan: number[i] is the number of items kept before item i, number[last] that
/// of all.
template <class Then>
struct AfterNumbers {
  Then then;
  const std::uint32_t* number;
  std::uint32_t last;
  std::uint32_t* all;
  CULLHULL_HD void operator()(std::uint32_t i) const {
    if (i == 0) *all = number[last];
    then(i);
  }
};
template <class Keep, class Emit>
struct EmitKept {
  Keep keep;
  Emit emit;
  const std::uint32_t* number;
  CULLHULL_HD void operator()(std::uint32_t i) const {
    if (keep(i)) emit(i, number[i]);
  }
};

template <class Key>
struct KeyOfItem {
  Key key;
  std::uint32_t* items;
  std::uint32_t* keys;
  CULLHULL_HD void operator()(std::uint32_t i) const {
    items[i] = i;
    keys[i] = key(i);
  }
};

}  // namespace cuda_kernels

class CudaExecutor : public DeviceAtomics {
 public:
  template <class T>
  using Array = CudaArray<T>;
  /// Neighbouring threads read neighbouring items.
  static constexpr std::uint32_t grain = 1;
  static constexpr bool many_threads = true;

  explicit CudaExecutor(cudaStream_t stream)
      : stream_(stream), processors_(this_device().multiprocessors) {}

  cudaStream_t stream() const { return stream_; }

  template <class T>
  T* reserve(Array<T>& array, std::size_t count) {
    return array.reserve(count, stream_);
  }
  /// Waits for the copy; throws the error of any earlier operation of the stream, too.
  template <class T>
  void fetch(const T* from, std::size_t count, T* to) {
    download(to, from, count, stream_);
  }
  void fetch_all(const std::vector<Transfer>& transfers, const Run& run) {
    download_many(transfers, stream_, run);
  }
  template <class T>
  void zero(T* items, std::size_t count) {
    fill(items, count, 0, stream_);
  }

  /// What the blocks of a reduction found, on its way to the host.
  template <class T, class Combine>
  struct Later {
    T identity;
    Combine combine;
    std::unique_ptr<const Look> parts;  ///< null: of no items

    T get() const {
      T sum = identity, part = identity;
      const std::byte* from = parts == nullptr ? nullptr : parts->wait();
      for (std::size_t at = 0; from != nullptr && at < parts->bytes(); at += sizeof(T)) {
        std::memcpy(static_cast<void*>(&part), from + at, sizeof(T));
        sum = combine(sum, part);
      }
      return sum;
    }
  };
  template <class T, class Map, class Combine>
  Later<T, Combine> begin_reduce(std::uint32_t count, T identity, const Map& map,
                                 const Combine& combine) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (count == 0) return {identity, combine, nullptr};
    constexpr unsigned size = cuda_kernels::reduce_block_size;
    const unsigned blocks = grid(count, size);
    const DeviceArray<T> partial(blocks, stream_);
    zero(partial.data(), blocks);  // their padding is copied, too
    cuda_kernels::reduce<T, Map, Combine>
        <<<blocks, size, 0, stream_>>>(map, combine, identity, count, partial.data());
    launched();
    return {identity, combine, std::make_unique<Look>(partial.data(), blocks * sizeof(T), stream_)};
  }
  template <class T, class Map, class Combine>
  T reduce(std::uint32_t count, T identity, const Map& map, const Combine& combine) {
    return begin_reduce(count, identity, map, combine).get();
  }

  /// A number of items, perhaps a multiple of one that a kernel writes to a word of the executor's.
  /// It must be read before half as many others are asked for as there are words.
  class Count {
   public:
    Count(std::uint32_t value = 0) : most_(value) {}  // NOLINT: a number, as on the host
    operator std::uint32_t() const {                  // NOLINT
      return owner_ == nullptr ? most_ : owner_->number_at(serial_) * each_;
    }

   private:
    friend CudaExecutor;
    CudaExecutor* owner_ = nullptr;  ///< null: known, and most_
    std::uint64_t serial_ = 0;
    std::uint32_t each_ = 1, most_ = 0;
  };
  static Count times(Count count, std::uint32_t factor) {
    count.each_ *= factor;
    count.most_ *= factor;
    return count;
  }
  static std::uint32_t most(const Count& count) { return count.most_; }
  static Count at_most(Count count, std::uint32_t most) {
    count.most_ = std::min(count.most_, most);
    return count;
  }
  void send_counts() {
    if (words_.data() != nullptr && serial_ > (sent_.empty() ? read_ : sent_.back().first))
      sent_.emplace_back(serial_, std::make_unique<Look>(
                                      words_.data(), word_count * sizeof(std::uint32_t), stream_));
  }
  static ItemCount items(const Count& count) {
    if (count.owner_ == nullptr) return {nullptr, count.most_};
    return {count.owner_->word(count), count.each_};
  }
  /// One round with nothing to do takes less time than waiting for the numbers of each.
  static constexpr std::uint32_t rounds_ahead = 1;

  template <class Body>
  void for_each(const Count& count, const Body& body) {
    if (count.most_ == 0) return;
    cuda_kernels::for_each<<<grid(count.most_, cuda_kernels::block_size), cuda_kernels::block_size,
                             0, stream_>>>(ForEachKernel<Body>{body, items(count)});
    launched();
  }

  template <class Keep, class Body>
  void for_each_where(const Count& count, const Keep& keep, const Body& body) {
    tiles(count, keep, body, nullptr);
  }

  template <class Body>
  Count scatter_max(const Count& count, const Count& of_cells, const Body& body,
                    std::uint64_t* best) {
    const std::uint32_t cells = of_cells.most_;
    if (count.most_ == 0) {
      zero(best, cells);
      return 0;
    }
    const Count result = next_count(count.most_);
    const std::uint32_t copies = scatter_copies(cells);
    const std::size_t words = std::size_t{copies} * cells;
    std::uint64_t* copied = copies == 1 ? best : reserve(copies_, words);
    zero(copied, words);
    cuda_kernels::scatter_max<<<grid(count.most_, cuda_kernels::block_size),
                                cuda_kernels::block_size, 0, stream_>>>(
        ScatterMaxKernel<Body>{body, items(count), cells, copies, copied}, word(result));
    launched();
    if (copies != 1) for_each(of_cells, FoldCopies{copied, cells, copies, best});
    return result;
  }

  template <class Keep, class Then>
  Count enumerate(const Count& count, const Keep& keep, std::uint32_t* number, const Then& then) {
    if (count.most_ == 0) return 0;
    const std::uint32_t last = count.most_;
    const auto kept =
        thrust::make_transform_iterator(thrust::make_counting_iterator(std::uint32_t{0}),
                                        cuda_kernels::KeepAsNumber<Keep>{keep, items(count)});
    with_scratch([&](void* scratch, std::size_t& bytes) {
      return cub::DeviceScan::ExclusiveSum(scratch, bytes, kept, number, last + 1, stream_);
    });
    const Count result = next_count(last);
    for_each(count, cuda_kernels::AfterNumbers<Then>{then, number, last, word(result)});
    return result;
  }

  template <class Keep, class Emit>
  Count select(const Count& count, const Keep& keep, const Emit& emit) {
    // First the positions, then `emit`, in two kernels: inlined into CUB's selection, which takes
    // many items a thread, a long emit would not fit into registers.
    std::uint32_t* number = reserve(numbers_, std::size_t{count.most_} + 1);
    return enumerate(count, keep, number, cuda_kernels::EmitKept<Keep, Emit>{keep, emit, number});
  }

  template <class Keep, class Emit>
  Count append(const Count& count, const Keep& keep, const Emit& emit) {
    const Count result = next_count(count.most_);
    tiles(count, keep, emit, word(result));
    return result;
  }

  template <class Key>
  const std::uint32_t* sort(std::uint32_t count, const Key& key, unsigned bits,
                            Array<std::uint32_t>& out) {
    if (count == 0) return nullptr;
    std::uint32_t* const items = reserve(numbers_, 3 * std::size_t{count});
    std::uint32_t* const keys = items + count;
    std::uint32_t* const sorted = reserve(out, count);
    for_each(count, cuda_kernels::KeyOfItem<Key>{key, items, keys});
    with_scratch([&](void* scratch, std::size_t& bytes) {
      return cub::DeviceRadixSort::SortPairs(scratch, bytes, keys, keys + count, items, sorted,
                                             count, 0, static_cast<int>(bits), stream_);
    });
    return sorted;
  }

  /// Listing what to look at takes as long as a round, and the look no longer than the four rounds
  /// after it, of two kernels each.
  static constexpr std::uint32_t rounds_at_once = 16, rounds_after_look = 4;
  /// Rounds of so few items are one block's, which waits for nobody else and needs no host.
  static constexpr std::uint32_t few_items = 512;
  template <class Steps>
  Count rounds(const Steps& steps, std::uint32_t first, std::uint32_t last, const Count& listed,
               const Control&) {
    const Count done = next_count(last + 1 - first);
    cuda_kernels::rounds_of_block<<<1, cuda_kernels::rounds_block_size, 0, stream_>>>(
        steps, first, last, items(listed), word(done));
    launched();
    return done;
  }

 private:
  static constexpr std::uint32_t word_count = 256;  ///< half of them may wait to be read

  /// Enough blocks to fill the device a few times over, no more: work that each block does once
  /// (clearing and writing its table, folding) is then rarely done.
  unsigned grid(std::uint32_t count, unsigned size) const {
    const std::uint64_t wanted = chunk_count(count, size);
    return static_cast<unsigned>(std::min<std::uint64_t>(wanted, std::uint64_t{processors_} * 8));
  }
  template <class Keep, class Body>
  void tiles(const Count& count, const Keep& keep, const Body& body, std::uint32_t* appended) {
    using Kernel = TileKernel<Keep, Body>;
    if (count.most_ == 0) return;
    const unsigned blocks = grid(count.most_, Kernel::items_a_thread * cuda_kernels::block_size);
    cuda_kernels::tiles<<<blocks, cuda_kernels::block_size, 0, stream_>>>(
        Kernel{keep, body, items(count), appended});
    launched();
  }
  static void launched() { check(cudaGetLastError(), "starting a kernel"); }

  /// A number, zero until a kernel writes it.
  Count next_count(std::uint32_t most) {
    constexpr std::uint32_t half = word_count / 2;
    // All of them: a look copies those that have not been asked for, too.
    if (words_.data() == nullptr) zero(reserve(words_, word_count), word_count);
    ++serial_;
    if (serial_ % half == 1) zero(words_.data() + (serial_ - 1) % word_count, half);
    Count count(most);
    count.owner_ = this;
    count.serial_ = serial_;
    return count;
  }
  std::uint32_t* word(const Count& count) const {
    return words_.data() + (count.serial_ - 1) % word_count;
  }
  std::uint32_t number_at(std::uint64_t serial) {
    if (serial > (sent_.empty() ? read_ : sent_.back().first)) send_counts();
    for (; serial > read_; sent_.pop_front()) {
      (void)sent_.front().second->wait();
      std::tie(read_, numbers_here_) = std::move(sent_.front());
    }
    if (serial + word_count / 2 <= read_)
      throw Error(ErrorCode::internal, "a number of the device is read too late");
    const auto* numbers = reinterpret_cast<const std::uint32_t*>(numbers_here_->wait());
    return numbers[(serial - 1) % word_count];
  }

  /// Calls CUB twice: the first call returns the size of the scratch memory.
  template <class Call>
  void with_scratch(const Call& call) {
    std::size_t bytes = 0;
    check(call(nullptr, bytes), "preparing a scan");
    std::uint64_t* scratch = reserve(scratch_, bytes / 8 + 1);
    check(call(scratch, bytes), "starting a scan");
  }

  cudaStream_t stream_;
  unsigned processors_;
  std::uint64_t serial_ = 0, read_ = 0;  ///< of the last number asked for, and that is here
  std::deque<std::pair<std::uint64_t, std::unique_ptr<const Look>>> sent_;  ///< up to a serial
  std::unique_ptr<const Look> numbers_here_;
  CudaArray<std::uint32_t> words_, numbers_;
  CudaArray<std::uint64_t> copies_, scratch_;
};

}  // namespace cullhull::internal
