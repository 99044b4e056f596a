// Gaussian elimination in vectors, compiled once per instruction set.
#include "exact/planes/elimination.hpp"

#include <cmath>
#include <utility>

#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "exact/planes/elimination.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<double, elimination_lanes>;
using V = hn::Vec<F>;

/// The largest entry in each lane, and the first row that has it.
struct Largest {
  V value, row;

  HWY_INLINE Largest() : value(hn::Zero(F())), row(hn::Zero(F())) {}
  HWY_INLINE void see(V entries, V number) {
    const V size = hn::Abs(entries);
    const auto more = hn::Gt(size, value);
    value = hn::IfThenElse(more, size, value);
    row = hn::IfThenElse(more, number, row);
  }
  HWY_INLINE double find(unsigned& first_row) const {
    const V most = hn::MaxOfLanes(F(), value);
    const V none = hn::Set(F(), 0x1p52);
    const V first = hn::MinOfLanes(F(), hn::IfThenElse(hn::Eq(value, most), row, none));
    first_row = static_cast<unsigned>(hn::GetLane(first));
    return hn::GetLane(most);
  }
};

}  // namespace

unsigned eliminate_matrix(double* matrix, unsigned rows, unsigned columns, unsigned* row,
                          unsigned* column, double least, double most, bool& odd) {
  const F f;
  const std::size_t stride = elimination_stride(columns), lanes = hn::Lanes(f);
  const auto at = [&](unsigned i) { return matrix + std::size_t{i} * stride; };
  odd = false;
  for (unsigned i = 0; i < rows; ++i) row[i] = i;
  for (unsigned j = 0; j < columns; ++j) column[j] = j;
  Largest next;
  for (unsigned i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < columns; j += lanes)
      next.see(hn::LoadU(f, at(i) + j), hn::Set(f, static_cast<double>(i)));
  for (unsigned r = 0; r < rows; ++r) {
    unsigned best = 0;
    const double largest = next.find(best);
    if (!(largest > least && largest < most)) return r;  // NaN, too
    double* const pivots = at(r);
    unsigned place = r;
    while (std::abs(at(best)[place]) != largest) ++place;
    if (best != r) {
      for (std::size_t j = 0; j < columns; j += lanes) {
        const V mine = hn::LoadU(f, pivots + j);
        hn::StoreU(hn::LoadU(f, at(best) + j), f, pivots + j);
        hn::StoreU(mine, f, at(best) + j);
      }
      std::swap(row[r], row[best]);
      odd = !odd;
    }
    if (place != r) {
      for (unsigned i = 0; i < rows; ++i) std::swap(at(i)[r], at(i)[place]);
      std::swap(column[r], column[place]);
      odd = !odd;
    }
    next = Largest();
    for (unsigned i = r + 1; i < rows; ++i) {
      double* const v = at(i);
      const double quotient = v[r] / pivots[r];
      const V factor = hn::Set(f, quotient), number = hn::Set(f, static_cast<double>(i));
      for (std::size_t j = r + 1; j < columns; j += lanes) {  // beyond the columns all is 0
        const V fresh = hn::Sub(hn::LoadU(f, v + j), hn::Mul(factor, hn::LoadU(f, pivots + j)));
        hn::StoreU(fresh, f, v + j);
        next.see(fresh, number);
      }
      v[r] = quotient;
    }
  }
  return rows;
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(eliminate_matrix);

unsigned eliminate(double* matrix, unsigned rows, unsigned columns, unsigned* row, unsigned* column,
                   double least, double most, bool& odd) {
  return HWY_DYNAMIC_DISPATCH(eliminate_matrix)(matrix, rows, columns, row, column, least, most,
                                                odd);
}

}  // namespace cullhull::internal
#endif
