// The instruction sets that kernels are not compiled for; to be included before
// <hwy/foreach_target.h>.
//
// Every set adds to a kernel's compile time, and every machine runs the best of those compiled. All
// sets give the same bits. On x86-64 kernels are compiled for AVX-512, AVX2 and as plain vectors of
// 128 bits that the compiler lowers to SSE2; the filter's kernel, where shuffles count, for SSSE3
// too, which takes half the time of plain vectors there. SSE4 gains nothing over SSSE3, and neither
// gains anything over plain vectors in kernels of doubles, two of which fill a vector (measured on
// hulls of balls, spheres and circles in 2D to 4D).
#pragma once

/// Targets whose vectors have no size at compile time and so cannot be kept in arrays, which most
/// kernels do: NEON or plain code runs on those machines. A kernel writes #define
/// HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#define CULLHULL_SIZELESS_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)

/// These, and the sets that gain nothing over plain vectors.
#define CULLHULL_SPARED_TARGETS (CULLHULL_SIZELESS_TARGETS | HWY_SSSE3 | HWY_SSE4)
