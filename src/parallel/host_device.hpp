// Marks functions that run on both sides: inline text for the host compiler, device code for nvcc.
#pragma once

#ifdef __CUDACC__
#define CULLHULL_HD __host__ __device__ __forceinline__
#else
#define CULLHULL_HD
#endif
