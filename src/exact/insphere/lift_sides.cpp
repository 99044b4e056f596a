// In-sphere tests, one cell in each lane of a vector; compiled once per instruction set.
#include "exact/insphere/lift_sides.hpp"

#include <cstdint>

#include "exact/insphere/lift_filter.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "exact/insphere/lift_sides.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "exact/determinants/minors-inl.hpp"
#include "exact/numbers/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::inline exact::HWY_NAMESPACE {
namespace {

using DoubleDoubles = WideLanes<true>;
static_assert(sides_block == 8);  // as many lanes as Lanes has at most

HWY_INLINE Lanes high_of(const Lanes& v) { return v; }
HWY_INLINE Lanes high_of(const DoubleDoubles& v) { return v.high; }
HWY_INLINE Lanes difference(const Lanes& a, const Lanes& b, const Lanes&) { return a - b; }
HWY_INLINE DoubleDoubles difference(const Lanes& a, const Lanes& b, const DoubleDoubles&) {
  return DoubleDoubles::sum(a, -b);
}

/// Computes the determinant of one vector of cells, negative if p is below, and a bound of the sum
/// of the magnitudes of its products, but for roundings. `corners`: the data of the first cell.
template <unsigned K, class Real>
HWY_INLINE void value_of_vector(const double* corners, const Lanes* p, Lanes& value,
                                Lanes& products) {
  constexpr unsigned columns = K + 1, full = 1U << columns;
  // The rows of all corners relative to p: up to the sign (-1)^columns, their determinant is that
  // of lifted_rows(), whose rows are relative to the first corner.
  Real m[columns][columns];
  Lanes largest[columns];
  for (Lanes& v : largest) v = 0.0;
  for (unsigned i = 0; i < columns; ++i) {
    for (unsigned j = 0; j < K; ++j) {
      const Real v = difference(hn::LoadU(D(), corners + (i * K + j) * sides_block), p[j], Real());
      largest[j] = greater_of(largest[j], absolute(high_of(v)));
      const Real square = v * v;
      m[i][j] = v;
      m[i][K] = j == 0 ? square : m[i][K] + square;
    }
    largest[K] = greater_of(largest[K], absolute(high_of(m[i][K])));
  }
  Real det[full];
  minors_of_lanes<full>(m, det);
  value = high_of(det[full - 1]);
  if (columns % 2 == 1) value = -value;
  products = factorial(columns);
  for (const Lanes& v : largest) products = products * v;
}

template <unsigned K>
void sides_of_block(const double* corners, const double* p, double tiny, double* signs) {
  Lanes point[K], value, products;
  for (unsigned j = 0; j < K; ++j) point[j] = p[j];
  for (std::size_t lane = 0; lane < sides_block; lane += lane_count()) {
    value_of_vector<K, DoubleDoubles>(corners + lane, point, value, products);
    const Lanes bound = lift_roundings(K, K) * double_double_roundoff * products + tiny;
    const Lanes one = 1.0;
    const Lanes above = chosen(value > bound, one, 0.0);
    hn::StoreU(chosen(value < -bound, -one, above).v, D(), signs + lane);
  }
}

template <unsigned K>
void values_of_block(const double* corners, const double* points, double* values,
                     double* products) {
  Lanes point[K], value, magnitudes;
  for (std::size_t lane = 0; lane < sides_block; lane += lane_count()) {
    for (unsigned j = 0; j < K; ++j) point[j] = hn::LoadU(D(), points + j * sides_block + lane);
    value_of_vector<K, Lanes>(corners + lane, point, value, magnitudes);
    hn::StoreU(value.v, D(), values + lane);
    hn::StoreU(magnitudes.v, D(), products + lane);
  }
}

}  // namespace

void sides_of_cells(unsigned k, const double* corners, const double* p, double tiny,
                    double* signs) {
  with_dimension<3, 5, 6>(
      k, [&](auto dimension) { sides_of_block<dimension()>(corners, p, tiny, signs); });
}

void values_of_cells(unsigned k, const double* corners, const double* points, double* values,
                     double* products) {
  with_dimension<2, 5, 6>(
      k, [&](auto dimension) { values_of_block<dimension()>(corners, points, values, products); });
}

}  // namespace cullhull::internal::inline exact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal::inline exact {

HWY_EXPORT(sides_of_cells);

void lift_sides_double_double(unsigned k, const double* corners, const double* p, double tiny,
                              double* signs) {
  HWY_DYNAMIC_DISPATCH(sides_of_cells)(k, corners, p, tiny, signs);
}

HWY_EXPORT(values_of_cells);

void lift_values(unsigned k, const double* corners, const double* points, double* values,
                 double* products) {
  HWY_DYNAMIC_DISPATCH(values_of_cells)(k, corners, points, values, products);
}

}  // namespace cullhull::internal::inline exact
#endif
