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
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

using DoubleDoubles = WideLanes<true>;
static_assert(sides_block == 8);  // as many lanes as Lanes has at most

// Why the rows are c_i - p: the determinant of the k + 2 rows (x, lift(x), 1) does not change when
// one row is subtracted from all others. Subtracting c_0 leaves E; subtracting p, which stands
// last, leaves the rows c_0 - p .. c_k - p and the sign (-1)^(k + 1). The number of differences is
// the same, and so is the bound. Example, k = 1: det [0 0 1; 2 4 1; p p^2 1] is E = 2 p^2 - 4 p by
// c_0 = 0, and by p it is (-p)(4 - p^2) - (-p^2)(2 - p) = 2 p^2 - 4 p: (-1)^2 = 1.

/// Computes the signs of one vector of cells. `corners`, `signs`: the data of the first cell.
template <unsigned K>
HWY_INLINE void sides_of_vector(const double* corners, const double* p, double tiny,
                                double* signs) {
  constexpr unsigned columns = K + 1, full = 1U << columns;
  // The rows of all corners relative to p: up to the sign (-1)^columns, their determinant is that
  // of lifted_rows(), whose rows are relative to the first corner.
  DoubleDoubles m[columns][columns];
  Lanes largest[columns];
  for (Lanes& v : largest) v = 0.0;
  for (unsigned i = 0; i < columns; ++i) {
    for (unsigned j = 0; j < K; ++j) {
      const DoubleDoubles v =
          DoubleDoubles::sum(hn::LoadU(D(), corners + (i * K + j) * sides_block), -p[j]);
      largest[j] = greater_of(largest[j], absolute(v.high));
      const DoubleDoubles square = v * v;
      m[i][j] = v;
      m[i][K] = j == 0 ? square : m[i][K] + square;
    }
    largest[K] = greater_of(largest[K], absolute(m[i][K].high));
  }
  DoubleDoubles det[full];
  minors_of_lanes<full>(m, det);
  Lanes value = det[full - 1].high;
  if (columns % 2 == 1) value = -value;
  constexpr double roundings = lift_roundings(K, K);
  Lanes bound = roundings * double_double_roundoff * factorial(columns);
  for (const Lanes& v : largest) bound = bound * v;
  bound = bound + tiny;
  const Lanes one = 1.0;
  const Lanes above = chosen(value > bound, one, 0.0);
  hn::StoreU(chosen(value < -bound, -one, above).v, D(), signs);
}

template <unsigned K>
void sides_of_block(const double* corners, const double* p, double tiny, double* signs) {
  for (std::size_t lane = 0; lane < sides_block; lane += lane_count())
    sides_of_vector<K>(corners + lane, p, tiny, signs + lane);
}

}  // namespace

void sides_of_cells(unsigned k, const double* corners, const double* p, double tiny,
                    double* signs) {
  with_dimension<3, 5, 6>(
      k, [&](auto dimension) { sides_of_block<dimension()>(corners, p, tiny, signs); });
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(sides_of_cells);

void lift_sides_double_double(unsigned k, const double* corners, const double* p, double tiny,
                              double* signs) {
  HWY_DYNAMIC_DISPATCH(sides_of_cells)(k, corners, p, tiny, signs);
}

}  // namespace cullhull::internal
#endif
