// Kernels for many small sets, a warp a set; a thread a set where sums have an order.

#include <algorithm>
#include <iterator>

#include "cuda/kernels/coordinate.cuh"
#include "cuda/kernels/set_hulls_kernel.hpp"
#include "cuda/kernels/warp_hull.cuh"
#include "cuda/runtime.hpp"
#include "result/facets/facet_math.hpp"

namespace cullhull::internal {
namespace {

/// With some 82 registers a thread, blocks of four warps leave fewest of a processor's unused.
constexpr unsigned most_warps = 4;
/// Blocks may have so much shared memory without asking for more.
constexpr std::size_t block_memory = 48 << 10;

static_assert(WarpMemory<3, false>::bytes(std::end(set_classes)[-1]) <= block_memory);

__device__ inline unsigned lane_of() { return threadIdx.x % lanes; }
__device__ inline std::uint64_t warp_of() {
  return std::uint64_t{blockIdx.x} * (blockDim.x / lanes) + threadIdx.x / lanes;
}

/// A warp has its own part of its block's memory. All lanes of a warp leave together. One block a
/// processor is asked for so that ptxas spills nothing (before, 16 bytes on some architectures).
template <unsigned D, class T, bool Near>
__global__ void __launch_bounds__(most_warps* lanes, 1)
    set_hulls(const __grid_constant__ DevicePointView points, const __grid_constant__ WarpSets sets,
              unsigned least, unsigned most) {
  extern __shared__ double shared[];
  const std::uint64_t set = warp_of();
  if (set >= sets.sets) return;
  const std::uint64_t first = sets.starts[set], count = sets.starts[set + 1] - first;
  if (count < least || count > most) return;
  using Memory = WarpMemory<D, Near>;
  const Memory memory(reinterpret_cast<char*>(shared) + threadIdx.x / lanes * Memory::bytes(most),
                      most);
  WarpHull<D, T, Near> hull(memory, points, first, static_cast<unsigned>(count), lane_of());
  const SetCounts counts =
      hull.run(sets.vertices + first, sets.simplices + simplex_room(D) * first);
  if (lane_of() == 0) sets.counts[set] = counts;
}

// Planes and measures of the hulls found, in the CPU's operations and order, so that their bits are
// the CPU's. What these leave uncertain is the CPU's.

/// The simplices of one set's hull, its coordinates scaled by a power of two.
template <unsigned D, class T>
class FoundHullOfSet {
 public:
  __device__ FoundHullOfSet(const DevicePointView& points, const WarpSets& sets, std::uint64_t set)
      : vertex_count(sets.counts[set].vertices),
        simplex_count(sets.counts[set].simplices),
        points_(points),
        first_(sets.starts[set]),
        vertices_(sets.vertices + first_),
        simplices_(sets.simplices + simplex_room(D) * first_) {}

  const unsigned vertex_count, simplex_count;
  int exponent = 0;

  /// Scales by the power of two that make_frame chooses. False where that is far from 1 or the hull
  /// is thin along an axis.
  __device__ bool find_exponent() {
    double low[D], high[D], largest = 0;
#pragma unroll
    for (unsigned c = 0; c < D; ++c) low[c] = 0x1p1000, high[c] = -0x1p1000;
    for (unsigned v = 0; v < vertex_count; ++v)
#pragma unroll
      for (unsigned c = 0; c < D; ++c) {
        const double x = given(vertices_[v], c);
        low[c] = x < low[c] ? x : low[c];
        high[c] = x > high[c] ? x : high[c];
        largest = greater_of(largest, absolute(x));
      }
    const auto field = static_cast<int>(__double_as_longlong(largest) >> 52);
    scale_to(field == 0 ? -2000 : field - 1022);  // ilogb + 1
    if (exponent < -most_quick_exponent || exponent > most_quick_exponent) return false;
    bool wide = true;
#pragma unroll
    for (unsigned c = 0; c < D; ++c)
      wide = wide && high[c] * scale_ - low[c] * scale_ > (D == 2 ? 0x1p-200 : 0x1p-133);
    return wide;
  }
  __device__ void scale_to(int e) {
    exponent = e;
    scale_ = scale_by(1, -e);
  }

  /// Plane and share of a simplex. False where they need more than doubles.
  __device__ bool facet(unsigned i, double (&plane)[D + 1], Share<D>& share) const {
    double corner[D][D], origin[D];
#pragma unroll
    for (unsigned j = 0; j < D; ++j) scaled(simplices_[D * i + j], corner[j]);
    scaled(vertices_[0], origin);
    return plain_facet<D>(corner, origin, scale_by(1, exponent), plane, share);
  }

  /// Volume, area and centroid. False where doubles leave any of them, or a plane, uncertain.
  __device__ bool measure(double& volume, double& area, double (&centroid)[D]) const {
    Share<D, DoubleDouble> all;
    Share<D> run;
    for (unsigned i = 0; i < simplex_count; ++i) {
      double plane[D + 1];
      Share<D> share;
      if (!facet(i, plane, share)) return false;
      run.add(share);
      if ((i + 1) % measure_run != 0 && i + 1 != simplex_count) continue;
      all.add(run);
      run = {};
    }
    double origin[D];
    scaled(vertices_[0], origin);
    return settled(all, 0x1p-53) && finish_quickly(D, exponent, origin, all.volume, all.area,
                                                   all.moment, &volume, &area, centroid);
  }

 private:
  __device__ double given(unsigned v, unsigned c) const {
    return static_cast<double>(coordinate<T>(points_, first_ + v, c));
  }
  __device__ void scaled(unsigned v, double (&x)[D]) const {
#pragma unroll
    for (unsigned c = 0; c < D; ++c) x[c] = given(v, c) * scale_;
  }

  const DevicePointView& points_;
  const std::uint64_t first_;
  const std::uint16_t *const vertices_, *const simplices_;
  double scale_ = 1;
};

template <unsigned D, class T, class Id>
__global__ void pack_lists(const __grid_constant__ DevicePointView points,
                           const __grid_constant__ WarpSets sets,
                           const __grid_constant__ PlacedLists at, Id* __restrict__ vertices,
                           Id* __restrict__ simplices, T* __restrict__ rows) {
  const std::uint64_t set = warp_of();
  if (set >= sets.sets) return;
  const SetCounts counts = sets.counts[set];
  if (counts.vertices == 0) return;
  const std::uint64_t first = sets.starts[set], vertex_at = at.vertex_at[set],
                      simplex_at = at.simplex_at[set] * D;
  const std::uint16_t* const corners = sets.simplices + simplex_room(D) * first;
  for (unsigned i = lane_of(); i < counts.simplices * D; i += lanes)
    simplices[simplex_at + i] = corners[i];
  // With rows the vertices are listed ascending; in the plane they begin the edges in this order.
  const bool ascending = D == 2 && rows != nullptr;
  const std::uint16_t* const ids = ascending ? corners : sets.vertices + first;
  const unsigned step = ascending ? 2 : 1;
  for (unsigned i = lane_of(); i < counts.vertices; i += lanes)
    vertices[vertex_at + i] = ids[step * i];
  if (rows == nullptr) return;
  for (unsigned e = lane_of(); e < counts.vertices * D; e += lanes)
    rows[vertex_at * D + e] = coordinate<T>(points, first + ids[step * (e / D)], e % D);
}

/// Of the sets `found` and, by item, of others.
struct PlaceList {
  PlacedLists out;
  WarpSets found;
  std::int32_t dimension;
  const SetLengths* others;

  __device__ void operator()(std::uint64_t i) const {
    if (others != nullptr) return place(others[i]);
    const SetCounts counts = found.counts[i];  // none for sets that are not decided
    place({static_cast<std::uint32_t>(i), counts.vertices, counts.simplices, dimension});
  }
  __device__ void place(const SetLengths& s) const {
    out.vertex_at[s.set] = out.vertex_width != 0 ? s.set * out.vertex_width : s.vertices;
    out.simplex_at[s.set] = out.simplex_width != 0 ? s.set * out.simplex_width : s.simplices;
    if (out.vertex_counts != nullptr) {
      out.vertex_counts[s.set] = static_cast<std::int32_t>(s.vertices);
      out.simplex_counts[s.set] = static_cast<std::int32_t>(s.simplices);
    }
    if (out.affine_dimensions != nullptr) out.affine_dimensions[s.set] = s.affine_dimension;
  }
};

/// A thread a set: a hull's shares are added one after another.
template <unsigned D, class T>
__global__ void measure_hulls(const __grid_constant__ DevicePointView points,
                              const __grid_constant__ WarpSets sets,
                              const __grid_constant__ SetMeasures out) {
  const std::uint64_t set = std::uint64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (set >= sets.sets || sets.counts[set].vertices == 0) return;
  FoundHullOfSet<D, T> hull(points, sets, set);
  double volume, area, centroid[D];
  if (!hull.find_exponent() || !hull.measure(volume, area, centroid)) {
    sets.counts[set] = {};
    return;
  }
  out.volumes[set] = volume;
  out.areas[set] = area;
  out.exponents[set] = static_cast<std::int8_t>(hull.exponent);
#pragma unroll
  for (unsigned c = 0; c < D; ++c) out.centroids[D * set + c] = centroid[c];
}

template <unsigned D, class T>
__global__ void write_planes(const __grid_constant__ DevicePointView points,
                             const __grid_constant__ WarpSets sets,
                             const std::int8_t* __restrict__ exponents,
                             const std::uint64_t* __restrict__ simplex_at,
                             double* __restrict__ planes) {
  const std::uint64_t set = warp_of();
  if (set >= sets.sets || sets.counts[set].vertices == 0) return;
  FoundHullOfSet<D, T> hull(points, sets, set);
  hull.scale_to(exponents[set]);
  for (unsigned i = lane_of(); i < hull.simplex_count; i += lanes) {
    double plane[D + 1];
    Share<D> share;
    hull.facet(i, plane, share);
#pragma unroll
    for (unsigned c = 0; c <= D; ++c) planes[(simplex_at[set] + i) * (D + 1) + c] = plane[c];
  }
}

template <class T>
__global__ void point_runs(const __grid_constant__ DevicePointView points,
                           const ItemRun* __restrict__ runs, std::uint32_t count,
                           T* __restrict__ rows) {
  const unsigned d = points.dimension;
  if (warp_of() >= count) return;
  const ItemRun run = runs[warp_of()];
  for (std::uint64_t e = lane_of(); e < run.length * d; e += lanes)
    rows[run.to * d + e] = coordinate<T>(points, run.from + e / d, static_cast<unsigned>(e % d));
}

constexpr unsigned copying_warps = 4;       // a guess
constexpr unsigned measuring_threads = 64;  // few, so that small batches reach many processors

}  // namespace

cudaError_t find_set_hulls(const DevicePointView& points, const WarpSets& sets, unsigned least,
                           unsigned most, cudaStream_t stream) {
  with_point_types<2, 3>(points, [&]<unsigned D, class T>() {
    const auto launch = [&]<bool Near>() {
      constexpr auto bytes = WarpMemory<D, Near>::bytes;
      const auto warps = std::min(most_warps, static_cast<unsigned>(block_memory / bytes(most)));
      set_hulls<D, T, Near>
          <<<blocks_for(sets.sets, warps), warps * lanes, warps * bytes(most), stream>>>(
              points, sets, least, most);
    };
    if constexpr (D == 3)
      if (most > most_near_points) return launch.template operator()<false>();
    launch.template operator()<true>();
  });
  return cudaGetLastError();
}

cudaError_t place_lists(const WarpSets& sets, std::int32_t dimension, const SetLengths* others,
                        std::uint32_t other_count, const PlacedLists& out, cudaStream_t stream) {
  for (std::uint64_t* const list : {out.vertex_at, out.simplex_at})
    fill(list + sets.sets, 1, 0, stream);
  if (sets.counts != nullptr)
    check(for_each_item(sets.sets, PlaceList{out, sets, dimension, nullptr}, stream), "placing");
  return for_each_item(other_count, PlaceList{out, sets, dimension, others}, stream);
}

cudaError_t measure_sets(const DevicePointView& points, const WarpSets& sets,
                         const SetMeasures& measures, cudaStream_t stream) {
  with_point_types<2, 3>(points, [&]<unsigned D, class T>() {
    measure_hulls<D, T><<<blocks_for(sets.sets, measuring_threads), measuring_threads, 0, stream>>>(
        points, sets, measures);
  });
  return cudaGetLastError();
}

cudaError_t write_set_planes(const DevicePointView& points, const WarpSets& sets,
                             const std::int8_t* exponents, const std::uint64_t* simplex_at,
                             double* planes, cudaStream_t stream) {
  with_point_types<2, 3>(points, [&]<unsigned D, class T>() {
    write_planes<D, T><<<blocks_for(sets.sets, copying_warps), copying_warps * lanes, 0, stream>>>(
        points, sets, exponents, simplex_at, planes);
  });
  return cudaGetLastError();
}

template <class Id>
cudaError_t pack_set_hulls(const DevicePointView& points, const WarpSets& sets,
                           const PlacedLists& at, Id* vertices, Id* simplices, void* rows,
                           cudaStream_t stream) {
  with_point_types<2, 3>(points, [&]<unsigned D, class T>() {
    pack_lists<D, T, Id>
        <<<blocks_for(sets.sets, copying_warps), copying_warps * lanes, 0, stream>>>(
            points, sets, at, vertices, simplices, static_cast<T*>(rows));
  });
  return cudaGetLastError();
}
template cudaError_t pack_set_hulls(const DevicePointView&, const WarpSets&, const PlacedLists&,
                                    std::uint16_t*, std::uint16_t*, void*, cudaStream_t);
template cudaError_t pack_set_hulls(const DevicePointView&, const WarpSets&, const PlacedLists&,
                                    std::int32_t*, std::int32_t*, void*, cudaStream_t);

cudaError_t copy_point_runs(const DevicePointView& points, const ItemRun* runs, std::uint32_t count,
                            void* rows, cudaStream_t stream) {
  with_device_scalar(points, [&]<class T>() {
    point_runs<<<blocks_for(count, copying_warps), copying_warps * lanes, 0, stream>>>(
        points, runs, count, static_cast<T*>(rows));
  });
  return cudaGetLastError();
}

}  // namespace cullhull::internal
