// Marks what host and device share: the compiler of device code sees it twice, all others once.
#pragma once

#if defined(__CUDACC__)
#define CULLHULL_HD __host__ __device__
#else
#define CULLHULL_HD
#endif
