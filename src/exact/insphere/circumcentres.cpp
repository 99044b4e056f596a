// Circumcentres, one cell in each lane of a vector; compiled once per instruction set.
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
namespace cullhull::internal::inline exact::HWY_NAMESPACE {
namespace {

using DoubleDoubles = WideLanes<true>;
static_assert(centres_block == 8);  // as many lanes as Lanes has at most

/// The first two steps of a division: within 16 u^2, as quotient() of circumcentre.cpp.
HWY_INLINE DoubleDoubles short_quotient(const DoubleDoubles& a, const DoubleDoubles& b) {
  const Lanes q = a.high / b.high;
  return DoubleDoubles::sum(q, (a - b * DoubleDoubles(q)).high / b.high);
}

/// Computes the centres of one vector of cells: the text, the limits and the bounds are those of
/// circumcentre.cpp. `corners`, `centres`: the data of the first cell.
template <unsigned K>
HWY_INLINE void centres_of_vector(const double* corners, double* centres) {
  constexpr unsigned columns = K + 1, full = 1U << columns;
  const auto corner = [&](unsigned i, unsigned j) HWY_ATTR {
    return Lanes(hn::LoadU(D(), corners + (i * K + j) * centres_block));
  };
  DoubleDoubles m[K][columns];
  Lanes largest[columns];
  for (Lanes& v : largest) v = 0.0;
  for (unsigned i = 0; i < K; ++i) {
    for (unsigned j = 0; j < K; ++j) {
      const DoubleDoubles v = DoubleDoubles::sum(corner(i + 1, j), -corner(0, j));
      largest[j] = greater_of(largest[j], absolute(v.high));
      const DoubleDoubles square = v * v;
      m[i][j] = v;
      m[i][K] = j == 0 ? square : m[i][K] + square;
    }
    // A sum of squares: its leading part is within a few roundings of the sum of theirs.
    largest[K] = greater_of(largest[K], Lanes(1.0 + 0x1p-40) * m[i][K].high);
  }
  const Lanes one = 1.0, none = 0.0;
  Lanes good = chosen(largest[K] < Lanes(0x1p164), one, none);
  Lanes product = 1.0;
  for (unsigned j = 0; j < K; ++j) {
    good = chosen(largest[j] > Lanes(0x1p-80), good, none);
    good = chosen(largest[j] < Lanes(0x1p80), good, none);
    product = product * largest[j];
  }
  DoubleDoubles det[full];
  minors_of_lanes<full - 1>(m, det);
  constexpr unsigned all = full - 1;
  constexpr double error = (minor_roundings(K) + 3 * K + 12) * 0x1p-101 * factorial(K);
  const DoubleDoubles whole = det[all ^ (1U << K)], twice = whole + whole;
  const Lanes whole_error = Lanes(error) * product + Lanes(0x1p-300);
  const Lanes size = absolute(whole.high);
  good = chosen(size > Lanes(0x1p20) * whole_error, good, none);
  for (unsigned j = 0; j < K; ++j) {
    const Lanes minor_error = Lanes(error) * product / largest[j] * largest[K] + Lanes(0x1p-300);
    DoubleDoubles y = short_quotient(det[all ^ (1U << j)], twice);
    if ((K - 1 - j) % 2 == 1) y = -y;
    const Lanes length = absolute(y.high), at = corner(0, j);
    const Lanes y_error = Lanes(2.0) * (minor_error + length * Lanes(2.0) * whole_error) / size +
                          Lanes(0x1p-96) * length;
    const DoubleDoubles x = y + DoubleDoubles(at);
    const Lanes doubt = y_error + Lanes(0x1p-96) * (length + absolute(at));
    const Lanes above = x.high + (x.low + doubt), below = x.high + (x.low - doubt);
    Lanes centre = std::numeric_limits<double>::quiet_NaN();
    centre = Lanes(hn::IfThenElse(hn::Eq(above.v, below.v), (x.high + x.low).v, centre.v));
    centre = chosen(good > none, centre, Lanes(std::numeric_limits<double>::quiet_NaN()));
    hn::StoreU(centre.v, D(), centres + j * centres_block);
  }
}

template <unsigned K>
void centres_of_block(const double* corners, double* centres) {
  for (std::size_t lane = 0; lane < centres_block; lane += lane_count())
    centres_of_vector<K>(corners + lane, centres + lane);
}

}  // namespace

void centres_of_cells(unsigned k, const double* corners, double* centres) {
  if (k == 2)
    centres_of_block<2>(corners, centres);
  else if (k == 3)
    centres_of_block<3>(corners, centres);
  else
    centres_of_block<4>(corners, centres);
}

}  // namespace cullhull::internal::inline exact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal::inline exact {

HWY_EXPORT(centres_of_cells);

void circumcentres_double_double(unsigned k, const double* corners, double* centres) {
  HWY_DYNAMIC_DISPATCH(centres_of_cells)(k, corners, centres);
}

}  // namespace cullhull::internal::inline exact
#endif
