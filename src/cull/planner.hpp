#pragma once
#include <cstdint>
namespace cullhull::internal {
inline std::uint64_t smallest_worth_culling(unsigned) { return 5000; }
inline std::uint64_t smallest_worth_refining(unsigned) { return 20000; }
inline std::uint64_t probe_sample_size(std::uint64_t, unsigned) { return 1000; }
inline bool cull_pays(std::uint64_t, unsigned, std::uint64_t m, std::uint64_t v) { return v < m / 2; }
inline std::uint64_t map_sample_size(std::uint64_t n, unsigned d, std::uint64_t, std::uint64_t) { std::uint64_t cap = d==2? 4000 : d<=4?40000:5000; return n/16<cap? n/16: cap; }
}
