// What the emulated device takes for a race, and what not: kernels of a few lines, each with
// several orders of threads. A race ends the process, with a line that says which.
#include <cuda_runtime.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <type_traits>
#include <vector>

#include "emulation.hpp"
#include "gpu/device.hpp"

namespace cullhull::testing {
namespace {

enum class Between { nothing, ballot, warp, block };

__device__ void wait(Between between) {
  if (between == Between::ballot) (void)__ballot_sync(0xFFFFFFFFU, 1);
  if (between == Between::warp) __syncwarp();
  if (between == Between::block) __syncthreads();
}

/// Thread 0 of all writes an item, and all others read it.
template <class T>
__global__ void write_and_read(T* items, T* seen, Between between) {
  const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i == 0) items[0] = T(7);
  wait(between);
  if (i != 0) seen[i] = items[0];
}

/// All read an item, then thread 0 writes it.
__global__ void read_and_write(std::uint32_t* items, std::uint32_t* seen, Between between) {
  seen[threadIdx.x] = items[0];
  wait(between);
  if (threadIdx.x == 0) items[0] = 7;
}

/// Through the block's own memory.
__global__ void write_and_read_shared(std::uint32_t* seen, Between between) {
  __shared__ std::uint32_t items[64];
  items[threadIdx.x] = threadIdx.x;
  wait(between);
  seen[threadIdx.x] = items[threadIdx.x ^ 1];
}

__global__ void read_shared_unwritten(std::uint32_t* seen) {
  __shared__ std::uint32_t items[64];
  if (threadIdx.x % 2 == 0) items[threadIdx.x] = 1;
  __syncthreads();
  seen[threadIdx.x] = items[threadIdx.x];
}

/// All write an item: the same value, or each another.
__global__ void all_write(std::uint32_t* items, bool same) { items[0] = same ? 7 : threadIdx.x; }

struct Four {
  std::uint64_t values[4];
};
__global__ void all_write_much(Four* items) { items[0] = Four{{threadIdx.x, 1, 2, 3}}; }

/// The first threads count by an atomic operation, the others do it as `Other` says.
enum class Other { atomic, read, write, volatile_read };
__global__ void count(std::uint32_t* items, std::uint32_t* seen, unsigned counting, Other other) {
  if (threadIdx.x < counting || other == Other::atomic)
    atomicAdd(items, 1U);
  else if (other == Other::read)
    seen[threadIdx.x] = items[0];
  else if (other == Other::write)
    items[0] = 7;
  else
    seen[threadIdx.x] = *const_cast<const volatile std::uint32_t*>(items);
}

/// A half of what another thread writes as a whole.
__global__ void read_halves(std::uint64_t* items, std::uint32_t* seen) {
  if (threadIdx.x == 0)
    items[0] = 7;
  else
    seen[threadIdx.x] = reinterpret_cast<const std::uint32_t*>(items)[1];
}

/// Each writes its item and looks at the next one's: one of them after it was written.
__global__ void look_around(std::uint32_t* items, std::uint32_t* seen) {
  items[threadIdx.x] = 7;
  seen[threadIdx.x] = const_cast<const volatile std::uint32_t*>(items)[(threadIdx.x + 1) % 32];
}

class EmulatedRaces : public ::testing::Test {
 protected:
  template <class Launch>
  void expect_none(const Launch& launch) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      emulation::restart(seed);
      launch();
      check(cudaDeviceSynchronize());
    }
  }
  template <class Launch>
  void expect_race(const Launch& launch, const char* said) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed)
      EXPECT_DEATH(
          {
            emulation::restart(seed);
            launch();
            check(cudaDeviceSynchronize());
          },
          said)
          << "seed " << seed;
  }

  const OnDevice items_{std::vector<std::uint64_t>(16)}, seen_{std::vector<std::uint64_t>(256)};
  std::uint32_t* const items = items_.data<std::uint32_t>();
  std::uint32_t* const seen = seen_.data<std::uint32_t>();
  const char* const either = "a read after a write|a write after a read";
};

TEST_F(EmulatedRaces, ThreadsOfAWarpAreOrderedByItsBarrierAlone) {
  for (const Between between : {Between::nothing, Between::ballot})
    expect_race([&] { write_and_read<<<1, 32>>>(items, seen, between); }, either);
  for (const Between between : {Between::warp, Between::block})
    expect_none([&] { write_and_read<<<1, 32>>>(items, seen, between); });
}

TEST_F(EmulatedRaces, WarpsOfABlockAreOrderedByTheBlocksBarrierAlone) {
  for (const Between between : {Between::nothing, Between::ballot, Between::warp})
    expect_race([&] { write_and_read<<<1, 64>>>(items, seen, between); }, either);
  expect_none([&] { write_and_read<<<1, 64>>>(items, seen, Between::block); });
}

TEST_F(EmulatedRaces, BlocksAreOrderedByNothingAndLaunchesAre) {
  expect_race([&] { write_and_read<<<2, 32>>>(items, seen, Between::block); }, either);
  expect_none([&] {
    write_and_read<<<1, 32>>>(items, seen, Between::block);
    write_and_read<<<1, 32>>>(items, seen, Between::block);
  });
}

TEST_F(EmulatedRaces, WritesAfterReads) {
  for (const Between between : {Between::nothing, Between::ballot, Between::warp})
    expect_race([&] { read_and_write<<<1, 64>>>(items, seen, between); }, either);
  expect_none([&] { read_and_write<<<1, 64>>>(items, seen, Between::block); });
}

TEST_F(EmulatedRaces, AccessesOfEverySize) {
  const auto race = [&](auto* of_size) {
    using T = std::remove_pointer_t<decltype(of_size)>;
    T* const there = items_.data<T>();
    T* const out = seen_.data<T>();
    expect_race([&] { write_and_read<T><<<1, 64>>>(there, out, Between::nothing); }, either);
    expect_none([&] { write_and_read<T><<<1, 64>>>(there, out, Between::block); });
  };
  race(static_cast<std::uint8_t*>(nullptr));
  race(static_cast<std::uint16_t*>(nullptr));
  race(static_cast<std::uint64_t*>(nullptr));
  race(static_cast<double*>(nullptr));
  expect_race([&] { read_halves<<<1, 32>>>(items_.data<std::uint64_t>(), seen); }, either);
}

TEST_F(EmulatedRaces, MemoryOfTheBlock) {
  for (const Between between : {Between::nothing, Between::ballot})
    expect_race([&] { write_and_read_shared<<<1, 64>>>(seen, between); },
                "a read after a write|that nobody wrote");
  for (const Between between : {Between::warp, Between::block})
    expect_none([&] { write_and_read_shared<<<1, 64>>>(seen, between); });
  expect_race([&] { read_shared_unwritten<<<1, 64>>>(seen); },
              "a read of shared memory that nobody wrote");
}

TEST_F(EmulatedRaces, WritesOfOneValueAreNone) {
  expect_none([&] { all_write<<<1, 64>>>(items, true); });
  expect_race([&] { all_write<<<1, 64>>>(items, false); }, "threads write different values");
  expect_race([&] { all_write_much<<<1, 64>>>(items_.data<Four>()); },
              "different values|a write of many bytes");
}

TEST_F(EmulatedRaces, AtomicOperations) {
  expect_none([&] { count<<<2, 64>>>(items, seen, 32, Other::atomic); });
  expect_none([&] { count<<<1, 64>>>(items, seen, 32, Other::volatile_read); });
  expect_race([&] { count<<<1, 64>>>(items, seen, 32, Other::read); },
              "a read after a write|an atomic operation after a read");
  expect_race([&] { count<<<1, 64>>>(items, seen, 32, Other::write); },
              "a plain write after an atomic operation|an atomic operation after a plain write");
}

TEST_F(EmulatedRaces, VolatileReadsOfPlainWrites) {
  expect_race([&] { look_around<<<1, 32>>>(items, seen); }, "a volatile read after a plain write");
}

}  // namespace
}  // namespace cullhull::testing
