// Circumcentres and radii, one cell in each lane of a vector; compiled once per instruction set.
#include "exact/insphere/circumcentres.hpp"

#include <cstdint>
#include <limits>

#include "exact/determinants/minors.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "exact/insphere/circumcentres.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "exact/determinants/minors-inl.hpp"
#include "exact/numbers/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

using DoubleDoubles = WideLanes<true>;
static_assert(centres_block == 8);  // as many lanes as Lanes has at most

/// The first two steps of a division: within 16 u^2, as quotient() of circumcentre.cpp.
HWY_INLINE DoubleDoubles short_quotient(const DoubleDoubles& a, const DoubleDoubles& b) {
  const Lanes q = a.high / b.high;
  return DoubleDoubles::sum(q, (a - b * DoubleDoubles(q)).high / b.high);
}

/// The centre minus corner 0 of the cell in each lane; coordinate j is within error[j] of exact
/// where `good` holds.
template <unsigned K>
struct Offsets {
  DoubleDoubles value[K];
  Lanes error[K];
  M good;
};

HWY_INLINE Lanes corner_of(const double* corners, unsigned k, unsigned i, unsigned j) {
  return Lanes(hn::LoadU(D(), corners + (i * k + j) * centres_block));
}

/// Computes the offsets of one vector of cells: the text, the limits and the bounds are those of
/// circumcentre.cpp. `corners`: the data of the first cell.
template <unsigned K>
HWY_INLINE void offsets_of_vector(const double* corners, Offsets<K>& out) {
  constexpr unsigned columns = K + 1, full = 1U << columns;
  DoubleDoubles m[K][columns];
  Lanes largest[columns];
  for (Lanes& v : largest) v = 0.0;
  for (unsigned i = 0; i < K; ++i) {
    for (unsigned j = 0; j < K; ++j) {
      const DoubleDoubles v =
          DoubleDoubles::sum(corner_of(corners, K, i + 1, j), -corner_of(corners, K, 0, j));
      largest[j] = greater_of(largest[j], absolute(v.high));
      const DoubleDoubles square = v * v;
      m[i][j] = v;
      m[i][K] = j == 0 ? square : m[i][K] + square;
    }
    // A sum of squares: its leading part is within a few roundings of the sum of theirs.
    largest[K] = greater_of(largest[K], Lanes(1.0 + 0x1p-40) * m[i][K].high);
  }
  out.good = largest[K] < Lanes(0x1p164);
  Lanes product = 1.0;
  for (unsigned j = 0; j < K; ++j) {
    out.good = hn::And(out.good, largest[j] > Lanes(0x1p-80));
    out.good = hn::And(out.good, largest[j] < Lanes(0x1p80));
    product = product * largest[j];
  }
  DoubleDoubles det[full];
  minors_of_lanes<full - 1>(m, det);
  constexpr unsigned all = full - 1;
  constexpr double error = (minor_roundings(K) + 3 * K + 12) * 0x1p-101 * factorial(K);
  const DoubleDoubles whole = det[all ^ (1U << K)], twice = whole + whole;
  const Lanes whole_error = Lanes(error) * product + Lanes(0x1p-300);
  const Lanes size = absolute(whole.high);
  out.good = hn::And(out.good, size > Lanes(0x1p20) * whole_error);
  for (unsigned j = 0; j < K; ++j) {
    const Lanes minor_error = Lanes(error) * product / largest[j] * largest[K] + Lanes(0x1p-300);
    DoubleDoubles y = short_quotient(det[all ^ (1U << j)], twice);
    if ((K - 1 - j) % 2 == 1) y = -y;
    const Lanes length = absolute(y.high);
    out.error[j] = Lanes(2.0) * (minor_error + length * Lanes(2.0) * whole_error) / size +
                   Lanes(0x1p-96) * length;
    out.value[j] = y;
  }
}

template <unsigned K>
HWY_INLINE void centres_of_vector(const double* corners, double* centres) {
  Offsets<K> y;
  offsets_of_vector(corners, y);
  for (unsigned j = 0; j < K; ++j) {
    const Lanes at = corner_of(corners, K, 0, j);
    const DoubleDoubles x = y.value[j] + DoubleDoubles(at);
    const Lanes doubt = y.error[j] + Lanes(0x1p-96) * (absolute(y.value[j].high) + absolute(at));
    const Lanes above = x.high + (x.low + doubt), below = x.high + (x.low - doubt);
    const M known = hn::And(y.good, hn::Eq(above.v, below.v));
    const Lanes centre =
        chosen(known, x.high + x.low, Lanes(std::numeric_limits<double>::quiet_NaN()));
    hn::StoreU(centre.v, D(), centres + j * centres_block);
  }
}

/// The double that is `steps` up from each positive one.
HWY_INLINE Lanes neighbour(Lanes v, std::int64_t steps) {
  const hn::RebindToSigned<D> bits;
  return hn::BitCast(D(), hn::Add(hn::BitCast(bits, v.v), hn::Set(bits, steps)));
}

/// The radii: the least double r with |offset|^2 < r^2 certainly, if the one below is certainly
/// less; compared as by compare_radius() of circumcentre.cpp.
template <unsigned K>
HWY_INLINE void radii_of_vector(const double* corners, double* radii) {
  Offsets<K> y;
  offsets_of_vector(corners, y);
  DoubleDoubles square;
  Lanes doubt = 0x1p-300, squares = 0.0;
  for (unsigned j = 0; j < K; ++j) {
    const DoubleDoubles term = y.value[j] * y.value[j];
    square = j == 0 ? term : square + term;
    const Lanes size = absolute(y.value[j].high) + y.error[j];
    doubt = doubt + Lanes(4.0) * size * y.error[j];
    squares = squares + size * size;
  }
  doubt = doubt + Lanes(0x1p-96) * squares;
  const Lanes near = root(square.high);
  // How far the exact square is above that of a radius, if more than what is not known.
  const auto excess = [&](Lanes radius) HWY_ATTR {
    const Lanes more = (square - DoubleDoubles::product(radius, radius)).high;
    const Lanes unknown = Lanes(2.0) * (doubt + Lanes(0x1p-96) * radius * radius);
    return chosen(absolute(more) > unknown, more, Lanes(0.0));
  };
  const Lanes zero = 0.0, above = neighbour(near, 1), below = neighbour(near, -1);
  const Lanes of_near = excess(near);
  const M too_small = of_near > zero, large_enough = of_near < zero;
  const M above_reaches = excess(above)<zero, below_does_not = excess(below)> zero;
  const M next = hn::And(too_small, above_reaches);
  M known = hn::And(y.good, hn::Or(next, hn::And(large_enough, below_does_not)));
  known = hn::And(known, hn::And(near > Lanes(0x1p-80), near < Lanes(0x1p300)));
  const Lanes radius = chosen(next, above, near);
  hn::StoreU(chosen(known, radius, Lanes(std::numeric_limits<double>::quiet_NaN())).v, D(), radii);
}

}  // namespace

void centres_of_cells(unsigned k, const double* corners, double* centres) {
  for (std::size_t lane = 0; lane < centres_block; lane += lane_count())
    if (k == 2)
      centres_of_vector<2>(corners + lane, centres + lane);
    else if (k == 3)
      centres_of_vector<3>(corners + lane, centres + lane);
    else
      centres_of_vector<4>(corners + lane, centres + lane);
}

void radii_of_cells(unsigned k, const double* corners, double* radii) {
  for (std::size_t lane = 0; lane < centres_block; lane += lane_count())
    if (k == 2)
      radii_of_vector<2>(corners + lane, radii + lane);
    else if (k == 3)
      radii_of_vector<3>(corners + lane, radii + lane);
    else
      radii_of_vector<4>(corners + lane, radii + lane);
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(centres_of_cells);
HWY_EXPORT(radii_of_cells);

void circumcentres_double_double(unsigned k, const double* corners, double* centres) {
  HWY_DYNAMIC_DISPATCH(centres_of_cells)(k, corners, centres);
}

void circumradii_double_double(unsigned k, const double* corners, double* radii) {
  HWY_DYNAMIC_DISPATCH(radii_of_cells)(k, corners, radii);
}

}  // namespace cullhull::internal
#endif
