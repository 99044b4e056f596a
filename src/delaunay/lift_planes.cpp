// Planes of lifted cells, one cell per vector lane; compiled once per instruction set.
//
// The bound (2 <= k <= 6 dimensions). A product of the determinant meets, on its way into the dot
// product: k - 1 differences and a lift of k + 2 roundings (a difference's error twice, a square, k
// - 1 sums), k - 1 products and k (k - 1) / 2 sums in the cofactor, then the difference of p, the
// product with it and k sums: 4 k + 2 + k (k - 1) / 2. The product with the lift of p meets fewer.
// One more (plane_roundings) covers the roundings of the bound, which are relative ones of positive
// numbers. With no coordinate of p - o above m the error is below a m + b |p - o|^2, where a is the
// sum, over the k coordinate columns left out, of k! times the product of the other columns'
// maxima, and b that of the column of lifts, both times plane_roundings(k) u.
//
// Example in space: k = 3 gives 4 * 3 + 3 + 3 = 18 roundings. A cell with edges of 0.01 has
// coordinate maxima of 0.01 and lifts of 1e-4: a is 3 * 18 u * 6 * 1e-8 = 3.6e-22 and b 18 u * 6 *
// 1e-6 = 1.2e-20. For a point at 0.01 the bound is 5e-24; values are about 0.01^3 * 1e-4 = 1e-10.
//
// Zero on lattices: the bound divided by plane_roundings(k) u is at least the sum of the magnitudes
// of all products. If that is at most 2^53 units of the lattice's power k + 2, nothing is rounded,
// and 0 is exact: a tie.
#include "delaunay/lift_planes.hpp"

#include <cstddef>

#include "parallel/dispatch.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "delaunay/lift_planes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "exact/determinants/minors-inl.hpp"
#include "exact/numbers/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

static_assert(lift_block == 8);  // as many lanes as Lanes has at most

/// Computes the planes of one vector of cells. `m`, `sizes`, `out`: the data of the first cell.
template <unsigned K, bool given_lifts>
HWY_INLINE void planes_of_vector(const double* m, const double* sizes, double* out) {
  constexpr unsigned columns = K + 1, full = 1U << columns;
  const auto loaded = [](const double* from) HWY_ATTR { return Lanes(hn::LoadU(D(), from)); };
  const auto write = [&](Lanes v, unsigned to)
                         HWY_ATTR { hn::StoreU(v.v, D(), out + to * lift_block); };
  Lanes row[K][columns], largest[columns];
  for (Lanes& v : largest) v = 0.0;
  for (unsigned i = 0; i < K; ++i) {
    Lanes lift = 0.0;
    for (unsigned j = 0; j < K; ++j) {
      row[i][j] = loaded(m + (i * columns + j) * lift_block);
      largest[j] = greater_of(largest[j], absolute(row[i][j]));
      if (!given_lifts) lift = add_product<false>(lift, row[i][j], row[i][j]);
    }
    row[i][K] = given_lifts ? loaded(m + (i * columns + K) * lift_block) : lift;
    largest[K] = greater_of(largest[K], given_lifts ? loaded(sizes + i * lift_block) : lift);
  }
  Lanes det[full];
  minors_of_lanes<full - 1>(row, det);
  // The cofactors of the last of K + 1 rows.
  for (unsigned j = 0; j < columns; ++j) {
    const Lanes d = det[(full - 1) ^ (1U << j)];
    write((K + j) % 2 == 0 ? d : -d, j);
  }
  constexpr double factor = plane_roundings(K) * unit_roundoff * factorial(K);
  Lanes linear = 0.0;
  for (unsigned left = 0; left < columns; ++left) {
    Lanes product = factor;
    for (unsigned j = 0; j < columns; ++j)
      if (j != left) product = product * largest[j];
    if (left < K)
      linear = linear + product;
    else
      write(product, K + 2);
  }
  write(linear, K + 1);
}

template <unsigned K>
void planes_of_block(const double* rows, const double* sizes, double* planes) {
  for (std::size_t lane = 0; lane < lift_block; lane += lane_count())
    if (sizes != nullptr)
      planes_of_vector<K, true>(rows + lane, sizes + lane, planes + lane);
    else
      planes_of_vector<K, false>(rows + lane, nullptr, planes + lane);
}

}  // namespace

void planes_of_cells(unsigned k, const double* rows, const double* sizes, double* planes) {
  constexpr unsigned most = plane_only ? 2 : 5;
  with_dimension<2, most, most + !plane_only>(
      k, [&](auto dimension) { planes_of_block<dimension()>(rows, sizes, planes); });
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(planes_of_cells);

void lift_planes(unsigned k, const double* rows, const double* sizes, double* planes) {
  HWY_DYNAMIC_DISPATCH(planes_of_cells)(k, rows, sizes, planes);
}

}  // namespace cullhull::internal
#endif
