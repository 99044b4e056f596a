// The functions of <hwy/targets.h>, which choose the instruction set of each kernel, so that
// programs need not load Highway's library: when it is loaded, it measures the processor's timer
// for its benchmarks, which takes 3 to 4 ms of each process (Highway 1.0.3 and later), half of the
// time that the program takes to start. They are weak: where Highway's static library is linked and
// has more that is needed, its own functions take their place. On Windows they are not: linkers
// find no weak function in an archive there. Other processors and compilers have Highway's alone.
#include "parallel/simd_targets.hpp"

#undef HWY_SHARED_DEFINE  // not exported: other libraries of a process keep Highway's
#include <hwy/targets.h>

#if HWY_ARCH_X86_64 && (HWY_COMPILER_GCC || HWY_COMPILER_CLANG)
#include <cpuid.h>

#include <atomic>
#include <cstdint>
#if defined(__GLIBC__) && !defined(__clang__) && __has_include(<sys/platform/x86.h>)
#include <sys/platform/x86.h>  // of C, but for GCC
#define CULLHULL_GLIBC_CPUID
#endif

#if defined(_WIN32)
#define CULLHULL_WEAK
#else
#define CULLHULL_WEAK [[gnu::weak]]
#endif

namespace hwy {
namespace {

std::atomic<std::int64_t> disabled{0}, for_test{0};

/// Whether all bits of `wanted` are set.
bool has(std::uint32_t value, std::uint32_t wanted) { return (value & wanted) == wanted; }

/// The registers that the system saves for each thread (XCR0).
std::uint32_t saved_registers() {
  std::uint32_t low = 0, high = 0;
  asm("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return low;
}

struct Cpuid {
  std::uint32_t a = 0, b = 0, c = 0, d = 0;
};
/// What CPUID tells of a leaf; zeros if it has none. In virtual machines each of these instructions
/// takes microseconds, a tenth of a process's first call, hence glibc's copy where there is one.
Cpuid cpuid(std::uint32_t leaf) {
  Cpuid found;
#ifdef CULLHULL_GLIBC_CPUID
  const auto& kept = __x86_get_cpuid_feature_leaf(leaf == 1   ? CPUID_INDEX_1
                                                  : leaf == 7 ? CPUID_INDEX_7
                                                              : CPUID_INDEX_80000001)
                         ->cpuid_array;
  found = {kept[0], kept[1], kept[2], kept[3]};
#else
  __get_cpuid_count(leaf, 0, &found.a, &found.b, &found.c, &found.d);
#endif
  return found;
}

/// The instruction sets that processor and system support (Intel's manual, volume 2, CPUID).
std::int64_t detected() {
  std::int64_t found = HWY_EMU128 | HWY_SCALAR;
#ifdef HWY_SSE2
  found |= HWY_SSE2;
#endif
  const std::uint32_t c1 = cpuid(1).c, extended = cpuid(0x80000001).c;
  const std::uint32_t b7 = cpuid(7).b, c7 = cpuid(7).c;
  if (!has(c1, bit_SSE3 | bit_SSSE3)) return found;
  found |= HWY_SSSE3;
  if (!has(c1, bit_SSE4_1 | bit_SSE4_2 | bit_AES | bit_PCLMUL)) return found;
  found |= HWY_SSE4;
  constexpr std::uint32_t vectors_of_256 = 0x6, vectors_of_512 = 0xE6;
  if (!has(c1, bit_OSXSAVE | bit_AVX | bit_FMA | bit_F16C) ||
      !has(b7, bit_AVX2 | bit_BMI | bit_BMI2) || !has(extended, bit_LZCNT) ||
      !has(saved_registers(), vectors_of_256))
    return found;
  found |= HWY_AVX2;
  if (!has(b7, bit_AVX512F | bit_AVX512VL | bit_AVX512DQ | bit_AVX512BW | bit_AVX512CD) ||
      !has(saved_registers(), vectors_of_512))
    return found;
  found |= HWY_AVX3;
  if (has(c7, bit_AVX512VNNI | bit_VPCLMULQDQ | bit_AVX512VBMI | bit_AVX512VBMI2 | bit_VAES |
                  bit_AVX512VPOPCNTDQ | bit_AVX512BITALG | bit_GFNI))
    found |= HWY_AVX3_DL;
  return found;
}

}  // namespace

CULLHULL_WEAK std::int64_t SupportedTargets() {
  static const std::int64_t supported = detected();
  std::int64_t found = for_test.load(std::memory_order_relaxed);
  if (found == 0) found = supported;
  found &= ~disabled.load(std::memory_order_relaxed);
  return found == 0 ? HWY_STATIC_TARGET : found;
}

CULLHULL_WEAK ChosenTarget& GetChosenTarget() {
  static ChosenTarget chosen;
  return chosen;
}

CULLHULL_WEAK void DisableTargets(std::int64_t targets) {
  disabled = targets;
  GetChosenTarget().DeInit();
}

CULLHULL_WEAK void SetSupportedTargetsForTest(std::int64_t targets) {
  for_test = targets;
  GetChosenTarget().DeInit();
}

}  // namespace hwy
#endif
