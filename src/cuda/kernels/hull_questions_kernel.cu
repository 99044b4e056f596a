// Kernels that ask a hull about points, a thread a point. All facets pass by, the same for all
// threads of a warp, or, by cells, the few facets through which a ray in the point's direction may
// leave. A certain answer is final; the other points are listed, and the CPU answers for them.

#include "cuda/kernels/coordinate.cuh"
#include "cuda/kernels/hull_questions_kernel.hpp"

namespace cullhull::internal {
namespace {

enum class PointAnswer : std::uint8_t { open, inside, outside };

/// False where a coordinate is not finite.
template <unsigned D, class T>
__device__ bool load(const DevicePointView& points, std::uint64_t i, double (&x)[D]) {
  bool finite = true;
#pragma unroll
  for (unsigned j = 0; j < D; ++j) {
    x[j] = static_cast<double>(coordinate<T>(points, i, j)) + 0.0;  // -0 becomes +0
    finite = finite && x[j] - x[j] == 0;
  }
  return finite;
}

template <unsigned D>
__device__ PointAnswer side_of(const TablesThere& hull, const double (&x)[D]) {
#pragma unroll
  for (unsigned j = 0; j < D; ++j)
    if (x[j] < hull.low[j] || x[j] > hull.high[j]) return PointAnswer::outside;
  bool open = false;
  const double* row = hull.simplices;
  for (std::uint32_t f = 0; f < hull.simplex_count; ++f, row += 2 * D + 1) {
    double sum = 0, farthest = 0;
#pragma unroll
    for (unsigned j = 0; j < D; ++j) {
      const double apart = x[j] - __ldg(row + j);
      sum += __ldg(row + D + j) * apart;
      farthest = fabs(apart) > farthest ? fabs(apart) : farthest;
    }
    const double bound = __ldg(row + 2 * D) * farthest + side_tiny;
    if (sum > bound) return PointAnswer::outside;
    open = open || !(sum < -bound);
  }
  return open ? PointAnswer::open : PointAnswer::inside;
}

/// The operations of the CPU's planes, in their order; a maximum does not depend on the order.
template <unsigned D>
__device__ double largest_value(const TablesThere& hull, const double (&x)[D]) {
  double most = 0;
  const double* row = hull.planes;
  for (std::uint32_t f = 0; f < hull.plane_count; ++f, row += D + 1) {
    double sum = __ldg(row + D);
#pragma unroll
    for (unsigned j = 0; j < D; ++j) sum += __ldg(row + j) * x[j];
    most = f == 0 || sum > most ? sum : most;
  }
  return most;
}

/// The cell of a localised point whose largest |coordinate| is `largest`, as DirectionCube::cell:
/// `axis` is the first whose |coordinate| is that, and grid axis j is axis j below it, j + 1 from
/// it on.
template <unsigned D>
__device__ std::uint32_t cell_of(const double (&x)[D], double largest, std::uint32_t resolution) {
  double other[D - 1], dominant = x[D - 1];
  std::uint32_t axis = D - 1;
  bool passed = false;
#pragma unroll
  for (unsigned j = 0; j + 1 < D; ++j) {
    if (!passed && fabs(x[j]) == largest) {
      passed = true;
      dominant = x[j];
      axis = j;
    }
    other[j] = passed ? x[j + 1] : x[j];
  }
  const double half = 0.5 * resolution, top = resolution - 1.0, scale = half / largest;
  std::uint32_t cell = 2 * axis + (dominant < 0 ? 1 : 0);
#pragma unroll
  for (unsigned j = 0; j + 1 < D; ++j) {
    double at = other[j] * scale + half;
    at = at < 0 ? 0 : at;
    at = at > top ? top : at;
    cell = cell * resolution + static_cast<std::uint32_t>(at);
  }
  return cell;
}

/// The value of a facet at a localised point: the operations of the CPU, in their order.
template <unsigned D>
__device__ double facet_value(const double* __restrict__ normals, std::uint32_t facet,
                              const double (&x)[D]) {
  const auto* const pairs =
      reinterpret_cast<const double2*>(normals + std::uint64_t{facet} * normal_stride(D));
  const double2 first = __ldg(pairs);
  double value = first.x * x[0] + first.y * x[1];
  if constexpr (D > 2) {
    const double2 second = __ldg(pairs + 1);
    value += second.x * x[2];
    if constexpr (D > 3) value += second.y * x[3];
  }
  return value;
}

/// As cell_sides() of query/facet_cells.cpp, whose derivation holds here: the same operations.
template <unsigned D>
__device__ PointAnswer side_of(const CellsThere& hull, const double (&q)[D]) {
  double x[D], reach = 0;
  bool in_box = true;
#pragma unroll
  for (unsigned j = 0; j < D; ++j) {
    in_box = in_box && q[j] >= hull.low[j] && q[j] <= hull.high[j];
    x[j] = q[j] * hull.factor[j] - hull.centre[j];
    reach = fabs(x[j]) > reach ? fabs(x[j]) : reach;
  }
  if (!in_box) return PointAnswer::outside;
  if (!(reach >= CellsThere::least_reach)) return PointAnswer::open;
  const std::uint32_t cell = cell_of<D>(x, reach, hull.resolution);
  const std::uint32_t begin = __ldg(hull.starts + cell), end = __ldg(hull.starts + cell + 1);
  if (begin == end) return PointAnswer::open;
  const auto* const groups = reinterpret_cast<const uint4*>(hull.facets);
  std::uint32_t first = 0;
  double most = -0x1p1000;  // less than any value of a listed facet
  for (std::uint32_t g = begin; g < end; ++g) {
    const uint4 group = __ldg(groups + g);
    if (g == begin) first = group.x;
    const std::uint32_t facets[CellsThere::group] = {group.x, group.y, group.z, group.w};
#pragma unroll
    for (unsigned m = 0; m < CellsThere::group; ++m) {
      if (m > 0 && facets[m] == first) break;  // the last group is filled up with the first facet
      const double value = facet_value<D>(hull.normals, facets[m], x);
      most = value > most ? value : most;
    }
  }
  const double error = hull.error_factor * (reach + fabs(most)) + CellsThere::value_tiny;
  if (most - error > 1) return PointAnswer::outside;
  return most + error < 1 ? PointAnswer::inside : PointAnswer::open;
}

constexpr std::uint32_t no_vertex = 0xFFFFFFFFU;

/// The vertex with the largest product with u, which is scaled by a power of two; no_vertex if
/// another product comes within the errors of both: docs/exactness.md, "Queries".
template <unsigned D>
__device__ std::uint32_t support_of(const TablesThere& hull, double (&u)[D]) {
  double largest = 0;
#pragma unroll
  for (unsigned j = 0; j < D; ++j) largest = fabs(u[j]) > largest ? fabs(u[j]) : largest;
  if (!(largest > 0x1p-900) || !(largest < 0x1p900)) return no_vertex;
  const long long exponent = __double_as_longlong(largest) & 0x7FFLL << 52;
  const double factor = __longlong_as_double((0x7FELL << 52) - exponent);
  double sum = 0;
#pragma unroll
  for (unsigned j = 0; j < D; ++j) {
    u[j] *= factor;
    sum += fabs(u[j]);
  }
  double best = 0, second = 0;
  std::uint32_t found = no_vertex;
  const double* row = hull.vertices;
  for (std::uint32_t v = 0; v < hull.vertex_count; ++v, row += D) {
    double product = __ldg(row) * u[0];
#pragma unroll
    for (unsigned j = 1; j < D; ++j) product += __ldg(row + j) * u[j];
    if (v == 0 || product > best) {
      second = v == 0 ? -0x1p1000 : best;
      best = product;
      found = v;
    } else if (product > second) {
      second = product;
    }
  }
  const double bound = 1.01 * (D + 1) * 0x1p-53 * sum * hull.vertex_reach + 0x1p-900;
  return best - second > 2.01 * bound ? found : no_vertex;
}

// Answers to a question: false where the point is open.

template <class Hull>
struct SideAnswer {
  using Item = std::uint8_t;
  Hull hull;
  SideCodes codes;
  template <unsigned D>
  __device__ bool operator()(const double (&x)[D], Item& item) const {
    const PointAnswer side = side_of<D>(hull, x);
    item = side == PointAnswer::inside ? codes.inside : codes.outside;
    return side != PointAnswer::open;
  }
};
using SideByFacets = SideAnswer<TablesThere>;
using SideByCells = SideAnswer<CellsThere>;

struct Distance {
  using Item = double;
  TablesThere hull;
  template <unsigned D>
  __device__ bool operator()(const double (&x)[D], Item& item) const {
    constexpr double least = 0x1p-1074;  // inside is never at distance 0
    if (side_of<D>(hull, x) != PointAnswer::inside) return false;
    const double value = largest_value<D>(hull, x);
    item = value < -least ? value : -least;
    return true;
  }
};
struct Support {
  using Item = std::uint64_t;
  TablesThere hull;
  const std::uint64_t* ids;
  template <unsigned D>
  __device__ bool operator()(double (&u)[D], Item& item) const {
    const std::uint32_t found = support_of<D>(hull, u);
    if (found != no_vertex) item = __ldg(ids + found);
    return found != no_vertex;
  }
};

constexpr unsigned ask_threads = 256;  // a guess

/// A thread a point; with `ids`, of these alone.
template <class Answer, unsigned D, class T>
__global__ void __launch_bounds__(ask_threads)
    ask_hull(const __grid_constant__ DevicePointView points, const std::uint64_t* __restrict__ ids,
             std::uint64_t count, const __grid_constant__ Answer answer,
             typename Answer::Item* __restrict__ out, OpenList open) {
  const std::uint64_t step = std::uint64_t{gridDim.x} * blockDim.x;
  for (std::uint64_t k = std::uint64_t{blockIdx.x} * blockDim.x + threadIdx.x; k < count;
       k += step) {
    const std::uint64_t i = ids != nullptr ? ids[k] : k;
    double x[D];
    typename Answer::Item item = 0;
    const bool certain = load<D, T>(points, i, x) && answer(x, item);
    out[i] = certain ? item : 0;
    if (!certain) open.points[atomicAdd(open.count, 1U)] = static_cast<std::uint32_t>(i);
  }
}
unsigned ask_blocks(std::uint64_t count) {
  return blocks_for(count == 0 ? 1 : count, ask_threads, std::uint64_t{1} << 20);
}

/// A thread a byte.
struct ScatterByte {
  const std::uint64_t* ids;
  const std::byte* items;
  std::size_t item;
  std::byte* out;
  __device__ void operator()(std::uint64_t k) const {
    out[ids[k / item] * item + k % item] = items[k];
  }
};

}  // namespace

cudaError_t ask_sides(const DevicePointView& points, const std::uint64_t* ids, std::uint64_t count,
                      const TablesThere& hull, SideCodes codes, std::uint8_t* out,
                      const OpenList& open, cudaStream_t stream) {
  with_point_types<2, HullTables::most_dimensions>(points, [&]<unsigned D, class T>() {
    ask_hull<SideByFacets, D, T><<<ask_blocks(count), ask_threads, 0, stream>>>(
        points, ids, count, SideByFacets{hull, codes}, out, open);
  });
  return cudaGetLastError();
}

cudaError_t ask_sides_by_cells(const DevicePointView& points, const CellsThere& cells,
                               SideCodes codes, std::uint8_t* out, const OpenList& open,
                               cudaStream_t stream) {
  with_point_types<2, CellsThere::max_k>(points, [&]<unsigned D, class T>() {
    ask_hull<SideByCells, D, T><<<ask_blocks(points.count), ask_threads, 0, stream>>>(
        points, nullptr, points.count, SideByCells{cells, codes}, out, open);
  });
  return cudaGetLastError();
}

cudaError_t ask_distances(const DevicePointView& points, const TablesThere& hull, double* out,
                          const OpenList& open, cudaStream_t stream) {
  with_point_types<2, HullTables::most_dimensions>(points, [&]<unsigned D, class T>() {
    ask_hull<Distance, D, T><<<ask_blocks(points.count), ask_threads, 0, stream>>>(
        points, nullptr, points.count, Distance{hull}, out, open);
  });
  return cudaGetLastError();
}

cudaError_t ask_supports(const DevicePointView& directions, const TablesThere& hull,
                         const std::uint64_t* ids, std::uint64_t* out, const OpenList& open,
                         cudaStream_t stream) {
  with_point_types<2, HullTables::most_dimensions>(directions, [&]<unsigned D, class T>() {
    ask_hull<Support, D, T><<<ask_blocks(directions.count), ask_threads, 0, stream>>>(
        directions, nullptr, directions.count, Support{hull, ids}, out, open);
  });
  return cudaGetLastError();
}

cudaError_t scatter_items(const std::uint64_t* ids, const std::byte* items, std::size_t item,
                          std::uint64_t bytes, std::byte* out, cudaStream_t stream) {
  return for_each_item(bytes, ScatterByte{ids, items, item, out}, stream);
}

}  // namespace cullhull::internal
