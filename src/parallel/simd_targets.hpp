// Lists the SIMD instruction sets that kernels are not compiled for. Include it before
// <hwy/foreach_target.h>.
//
// Each set adds to a kernel's compile time. Every machine runs the best set compiled, and all sets
// give the same results, bit for bit. On x86-64, kernels are compiled for AVX-512, for AVX2 and as
// plain 128-bit vectors, which the compiler lowers to SSE2. The filter's kernel depends on shuffles
// and is compiled for SSSE3 as well, which takes half the time of plain vectors there. SSE4 is no
// faster than SSSE3. In kernels of doubles, two of which fill a vector, neither is faster than
// plain vectors (measured on hulls of balls, spheres and circles in 2D to 4D).
#pragma once

/// Targets whose vectors have no size known at compile time. Most kernels keep vectors in arrays,
/// which these targets do not allow; such machines run NEON or plain code instead.
#define CULLHULL_SIZELESS_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)

/// The targets above, and the sets that are no faster than plain vectors. Most kernels write
/// #define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#define CULLHULL_SPARED_TARGETS (CULLHULL_SIZELESS_TARGETS | HWY_SSSE3 | HWY_SSE4)
