// Kernels that ask a hull about points, a thread a point: the facets pass by, the same for all
// threads of a warp. A certain answer is final; the CPU gives the others.

#include "cuda/kernels/coordinate.cuh"
#include "cuda/kernels/hull_questions_kernel.hpp"

namespace cullhull::internal::inline cuda {
namespace {

constexpr unsigned ask_threads = 128;  // a guess

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

template <unsigned D, class T>
__global__ void __launch_bounds__(ask_threads)
    hull_sides(const __grid_constant__ DevicePointView points,
               const std::uint64_t* __restrict__ ids, std::uint64_t count,
               const __grid_constant__ TablesThere hull, PointAnswer* __restrict__ sides,
               double* __restrict__ distances) {
  const std::uint64_t step = std::uint64_t{gridDim.x} * blockDim.x;
  for (std::uint64_t k = std::uint64_t{blockIdx.x} * blockDim.x + threadIdx.x; k < count;
       k += step) {
    const std::uint64_t i = ids != nullptr ? ids[k] : k;
    double x[D];
    const PointAnswer side =
        load<D, T>(points, i, x) ? side_of<D>(hull, x) : PointAnswer::not_finite;
    sides[i] = side;
    if (distances != nullptr && side == PointAnswer::inside)
      distances[i] = largest_value<D>(hull, x);
  }
}

/// Of the vertices' products with u, scaled by a power of two, the largest, if no other comes
/// within the errors of both: docs/exactness.md, "Queries".
template <unsigned D>
__device__ std::uint32_t support_of(const TablesThere& hull, double (&u)[D]) {
  double largest = 0;
#pragma unroll
  for (unsigned j = 0; j < D; ++j) largest = fabs(u[j]) > largest ? fabs(u[j]) : largest;
  if (!(largest > 0x1p-900) || !(largest < 0x1p900)) return open_vertex;
  const long long exponent = __double_as_longlong(largest) & 0x7FFLL << 52;
  const double factor = __longlong_as_double((0x7FELL << 52) - exponent);
  double sum = 0;
#pragma unroll
  for (unsigned j = 0; j < D; ++j) {
    u[j] *= factor;
    sum += fabs(u[j]);
  }
  double best = 0, second = 0;
  std::uint32_t found = open_vertex;
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
  return best - second > 2.01 * bound ? found : open_vertex;
}

template <unsigned D, class T>
__global__ void __launch_bounds__(ask_threads)
    hull_supports(const __grid_constant__ DevicePointView directions,
                  const __grid_constant__ TablesThere hull, std::uint32_t* __restrict__ out) {
  const std::uint64_t step = std::uint64_t{gridDim.x} * blockDim.x;
  for (std::uint64_t i = std::uint64_t{blockIdx.x} * blockDim.x + threadIdx.x; i < directions.count;
       i += step) {
    double u[D];
    out[i] = load<D, T>(directions, i, u) ? support_of<D>(hull, u) : open_vertex;
  }
}

unsigned blocks_for(std::uint64_t threads) {
  constexpr std::uint64_t most = std::uint64_t{1} << 20;
  const std::uint64_t blocks = (threads + ask_threads - 1) / ask_threads;
  return static_cast<unsigned>(blocks < most ? blocks : most);
}

/// call.operator()<D, T>() for the points' dimension and scalar.
template <class Call>
cudaError_t with_types(const DevicePointView& points, const Call& call) {
  const bool wide = points.scalar == ScalarType::f64;
  switch (points.dimension) {
    case 2:
      wide ? call.template operator()<2, double>() : call.template operator()<2, float>();
      break;
    case 3:
      wide ? call.template operator()<3, double>() : call.template operator()<3, float>();
      break;
    case 4:
      wide ? call.template operator()<4, double>() : call.template operator()<4, float>();
      break;
    case 5:
      wide ? call.template operator()<5, double>() : call.template operator()<5, float>();
      break;
    case 6:
      wide ? call.template operator()<6, double>() : call.template operator()<6, float>();
      break;
    default:
      return cudaErrorInvalidValue;
  }
  return cudaGetLastError();
}

}  // namespace

cudaError_t ask_sides(const DevicePointView& points, const std::uint64_t* ids, std::uint64_t count,
                      const TablesThere& hull, PointAnswer* sides, double* distances,
                      cudaStream_t stream) {
  if (count == 0) return cudaSuccess;
  return with_types(points, [&]<unsigned D, class T>() {
    hull_sides<D, T>
        <<<blocks_for(count), ask_threads, 0, stream>>>(points, ids, count, hull, sides, distances);
  });
}

cudaError_t ask_supports(const DevicePointView& directions, const TablesThere& hull,
                         std::uint32_t* out, cudaStream_t stream) {
  if (directions.count == 0) return cudaSuccess;
  return with_types(directions, [&]<unsigned D, class T>() {
    hull_supports<D, T>
        <<<blocks_for(directions.count), ask_threads, 0, stream>>>(directions, hull, out);
  });
}

}  // namespace cullhull::internal::inline cuda
