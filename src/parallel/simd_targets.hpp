// The instruction sets that kernels are not compiled for; to be included before
// <hwy/foreach_target.h>.
#pragma once

/// Targets whose vectors have no size at compile time and so cannot be kept in arrays, which most
/// kernels do: NEON or scalar code serves those machines. A kernel says
///   #define HWY_DISABLED_TARGETS CULLHULL_SIZELESS_TARGETS
#define CULLHULL_SIZELESS_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)

/// Those, and what is hardly faster than SSE2 for loops that are long to compile.
#define CULLHULL_SPARED_TARGETS (CULLHULL_SIZELESS_TARGETS | HWY_SSSE3 | HWY_SSE4)
