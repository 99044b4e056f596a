// Marks functions that run on both sides: inline text for the host compiler, device code for nvcc.
#pragma once

#ifdef __CUDACC__
#define CULLHULL_HD __host__ __device__ __forceinline__
#define CULLHULL_HD_INLINE CULLHULL_HD
#else
#define CULLHULL_HD
#define CULLHULL_HD_INLINE inline  // for functions at namespace scope that are no templates
#endif
