// Circumcentres and radii, one cell in each lane of a vector; compiled once per instruction set.
#include "exact/insphere/circumcentres.hpp"

#include <cstdint>
#include <limits>

#include "exact/determinants/minors.hpp"
#include "parallel/dispatch.hpp"
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

/// a / b within 16 u^2, u = 2^-53, barring overflow and underflow; faster than operator/, whose
/// last correction it omits. The remainder of the first step is at most 2.1 u |a|, known within 8
/// u^2 |a|; the quotient of its leading part and that of b has three roundings: 6.3 u^2 of the
/// result.
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

/// The corners of a vector of cells; `width`: numbers of a corner.
struct Corners {
  const double* first;
  unsigned width;
  HWY_INLINE Lanes at(unsigned i, unsigned j) const {
    return hn::LoadU(D(), first + (i * width + j) * centres_block);
  }
};

/// Computes the offsets by Cramer's rule over the edges e_i = p_i - p_0 and their lifts |e_i|^2 -
/// (w_i - w_0): coordinate j is a quotient of minors. Every operation of double-doubles errs by
/// less than 2^-101, so a minor is within roundings x 2^-101 x k! x the product of its columns'
/// largest magnitudes; the quotient's error follows.
template <unsigned K>
HWY_INLINE void offsets_of_vector(bool weighted, const Corners& corners, Offsets<K>& out) {
  constexpr unsigned columns = K + 1, full = 1U << columns;
  DoubleDoubles m[K][columns];
  Lanes largest[columns];
  for (Lanes& v : largest) v = 0.0;
  for (unsigned i = 0; i < K; ++i) {
    for (unsigned j = 0; j < K; ++j) {
      const DoubleDoubles v = DoubleDoubles::sum(corners.at(i + 1, j), -corners.at(0, j));
      largest[j] = greater_of(largest[j], absolute(v.high));
      const DoubleDoubles square = v * v;
      m[i][j] = v;
      m[i][K] = j == 0 ? square : m[i][K] + square;
    }
    // A sum of squares: its leading part is within a few roundings of the sum of theirs.
    Lanes size = Lanes(1.0 + 0x1p-40) * m[i][K].high;
    if (weighted) {
      const DoubleDoubles w = DoubleDoubles::sum(corners.at(i + 1, K), -corners.at(0, K));
      m[i][K] = m[i][K] - w;
      size = size + absolute(w.high);
    }
    largest[K] = greater_of(largest[K], size);
  }
  // Within these limits nothing overflows, and underflow adds up to less than 2^-300.
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

/// The rounded centres. A coordinate is known if everything within its error rounds alike (Ziv
/// 1991).
template <unsigned K>
HWY_INLINE void centres_of_vector(bool weighted, const Corners& corners, double* centres) {
  Offsets<K> y;
  offsets_of_vector(weighted, corners, y);
  for (unsigned j = 0; j < K; ++j) {
    const Lanes at = corners.at(0, j);
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
/// less.
template <unsigned K>
HWY_INLINE void radii_of_vector(const Corners& corners, double* radii) {
  Offsets<K> y;
  offsets_of_vector(false, corners, y);
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

template <unsigned K>
void centres_of_block(bool weighted, const double* corners, std::size_t cells, double* centres) {
  for (std::size_t lane = 0; lane < cells; lane += lane_count())
    centres_of_vector<K>(weighted, {corners + lane, K + (weighted ? 1 : 0)}, centres + lane);
}
template <unsigned K>
void radii_of_block(const double* corners, std::size_t cells, double* radii) {
  for (std::size_t lane = 0; lane < cells; lane += lane_count())
    radii_of_vector<K>({corners + lane, K}, radii + lane);
}

}  // namespace

constexpr unsigned most_known = plane_only ? 2 : 5;

void centres_of_cells(unsigned k, bool weighted, const double* corners, std::size_t cells,
                      double* centres) {
  with_dimension<1, most_known, most_known + !plane_only>(
      k, [&](auto d) { centres_of_block<d()>(weighted, corners, cells, centres); });
}
void radii_of_cells(unsigned k, const double* corners, std::size_t cells, double* radii) {
  with_dimension<1, most_known, most_known + !plane_only>(
      k, [&](auto d) { radii_of_block<d()>(corners, cells, radii); });
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(centres_of_cells);
HWY_EXPORT(radii_of_cells);

void centres_double_double(unsigned k, bool weighted, const double* corners, std::size_t cells,
                           double* centres) {
  HWY_DYNAMIC_DISPATCH(centres_of_cells)(k, weighted, corners, cells, centres);
}

void radii_double_double(unsigned k, const double* corners, std::size_t cells, double* radii) {
  HWY_DYNAMIC_DISPATCH(radii_of_cells)(k, corners, cells, radii);
}

}  // namespace cullhull::internal
#endif
