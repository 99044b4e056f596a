// Answers by maps of cells, compiled once per instruction set.
#include "diagrams/locate/cell_maps.hpp"

#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "diagrams/locate/cell_maps.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "exact/numbers/double_double.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

/// Sets shares of a point inside a cell to the doubles nearest to the exact ones: the part of q
/// that they leave is computed as if by twice the precision, and mapped once more. False, and
/// shares near by, where that leaves a doubt about a rounding. docs/exactness.md, "Points in
/// cells", has the bound.
template <unsigned K>
HWY_INLINE bool refine(const MappedCell<K>& cell, const double* q, double* shares) {
  double left[K];
  for (unsigned j = 0; j < K; ++j) {
    DoubleDouble rest = DoubleDouble::sum(q[j], -cell.origin[j]);
    for (unsigned i = 0; i < K; ++i) {
      const double share = shares[i + 1];
      const DoubleDouble edge = DoubleDouble::sum(cell.corners[i][j], -cell.origin[j]);
      const DoubleDouble product = DoubleDouble::product(share, edge.high);
      const DoubleDouble sum = DoubleDouble::sum(rest.high, -product.high);
      rest = {sum.high, rest.low + (sum.low - product.low - share * edge.low)};
    }
    left[j] = rest.value();
  }
  double more[K + 1] = {}, largest = 0;
  for (unsigned j = 0; j < K; ++j)
    for (unsigned i = 0; i < K; ++i) more[i + 1] += cell.columns[j][i] * left[j];
  double first = 1;
  for (unsigned i = 1; i <= K; ++i) {
    const DoubleDouble sum = DoubleDouble::sum(first, -shares[i]);
    more[0] += sum.low - more[i];
    first = sum.high;
    largest = std::max(largest, std::abs(more[i]));
  }
  shares[0] = first;
  const double doubt = cell.doubt * (largest + 0x1p-50);
  bool sure = true;
  for (unsigned i = 0; i <= K; ++i) {
    const double least = shares[i] + (more[i] - doubt);
    shares[i] += more[i] + doubt;
    sure &= shares[i] == least;
  }
  return sure;
}

/// All questions walk at once, a cell each in turn, without jumps: which facet one crosses, and
/// whether it goes on, cannot be foreseen.
template <unsigned K>
HWY_INLINE void answer_all(const CellMaps<K>& maps, const double* rows, std::size_t n, bool refined,
                           double margin, MappedAnswer<K>* out) {
  std::uint32_t walking[answered_at_once];
  std::size_t left = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    bool far = false;
    out[i].place = maps.start(rows + i * K, margin, far);
    out[i].found = Found::far;
    out[i].refined = false;
    walking[left] = i;
    left += !far;
  }
  for (std::size_t steps = 0; left > 0; ++steps) {
    if (steps > maps.cells().size()) bad_neighbours();
    std::size_t still = 0;
    for (std::size_t at = 0; at < left; ++at) {
      const std::uint32_t i = walking[at];
      MappedAnswer<K>& a = out[i];
      const MappedCell<K>& cell = maps.cells()[a.place];
      map_to_shares(cell, rows + i * K, a.shares);
      unsigned least = 0;
      double lowest = a.shares[0];
      for (unsigned j = 1; j <= K; ++j) {
        least += (j - least) & (0U - static_cast<unsigned>(a.shares[j] < lowest));
        lowest = a.shares[j] < lowest ? a.shares[j] : lowest;
      }
      // After an overflow the first share, and so the lowest, is infinite or NaN.
      const bool inside = lowest > cell.doubt;
      const bool beyond = (lowest < -cell.doubt) & (lowest > -0x1p1000);
      const std::uint32_t next = cell.next[least];
      const bool goes_on = beyond & (next != no_index);
      static_assert(static_cast<int>(Found::inside) == 0 && static_cast<int>(Found::outside) == 1);
      a.found = static_cast<Found>(2 - int{beyond} - 2 * int{inside});
      a.facet = static_cast<std::uint8_t>(least);
      a.refined = refined & inside & (cell.doubt < 0x1p-32);
      a.place = goes_on ? next : a.place;
      walking[still] = i;
      still += goes_on;
    }
    left = still;
  }
  for (std::size_t i = 0; i < n; ++i)
    if (out[i].refined)
      out[i].refined = refine(maps.cells()[out[i].place], rows + i * K, out[i].shares);
}

}  // namespace

void answer2(const CellMaps<2>& maps, const double* rows, std::size_t n, bool refined,
             double margin, MappedAnswer<2>* out) {
  answer_all(maps, rows, n, refined, margin, out);
}
void answer3(const CellMaps<3>& maps, const double* rows, std::size_t n, bool refined,
             double margin, MappedAnswer<3>* out) {
  answer_all(maps, rows, n, refined, margin, out);
}
void answer4(const CellMaps<4>& maps, const double* rows, std::size_t n, bool refined,
             double margin, MappedAnswer<4>* out) {
  answer_all(maps, rows, n, refined, margin, out);
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(answer2);
HWY_EXPORT(answer3);
HWY_EXPORT(answer4);

void answer(const CellMaps<2>& maps, const double* rows, std::size_t n, bool refined, double margin,
            MappedAnswer<2>* out) {
  HWY_DYNAMIC_DISPATCH(answer2)(maps, rows, n, refined, margin, out);
}
void answer(const CellMaps<3>& maps, const double* rows, std::size_t n, bool refined, double margin,
            MappedAnswer<3>* out) {
  HWY_DYNAMIC_DISPATCH(answer3)(maps, rows, n, refined, margin, out);
}
void answer(const CellMaps<4>& maps, const double* rows, std::size_t n, bool refined, double margin,
            MappedAnswer<4>* out) {
  HWY_DYNAMIC_DISPATCH(answer4)(maps, rows, n, refined, margin, out);
}

}  // namespace cullhull::internal
#endif
