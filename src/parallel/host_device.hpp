// Marks functions that run on the host and on a CUDA device: ordinary inline functions for the host
// compiler, host and device functions for nvcc.
#pragma once

#ifdef __CUDACC__
#define CULLHULL_HD __host__ __device__ __forceinline__
#define CULLHULL_HD_INLINE CULLHULL_HD
#else
#define CULLHULL_HD
#define CULLHULL_HD_INLINE inline  // for non-template functions at namespace scope
#endif
