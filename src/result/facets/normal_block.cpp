// The arithmetic of NormalBlock: elimination with complete pivoting of a vector of matrices, each
// with pivots of its own. It is compiled for several instruction sets, of which one is chosen at
// run time.
//
// Rows and columns are exchanged one number at a time. Exchanges by selections, without branches,
// take 0.7 of the time in 9D and 1.4 times as long in 20D.
#include "result/facets/normal_block.hpp"

#include <limits>
#include <type_traits>
#include <utility>

#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "result/facets/normal_block.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "result/facets/facet_lanes-inl.hpp"

#ifndef CULLHULL_NORMAL_KERNEL
#define CULLHULL_NORMAL_KERNEL
namespace cullhull::internal {

/// The memory of a NormalBlock as arrays of rows of NormalBlock::lanes doubles.
struct NormalKernel {
  unsigned k;
  const double* corners;  ///< k x k
  double* normals;        ///< k
  double *length, *edges;
  double* scratch;  ///< a matrix and a normal, twice, as in double-doubles

  static constexpr std::size_t scratch_rows(std::size_t k) { return 2 * (k - 1) * k + 2 * k; }
  explicit NormalKernel(NormalBlock& b)
      : k(b.k_),
        corners(b.corners_.data()->of),
        normals(b.normals_.data()->of),
        length(b.length_.of),
        edges(b.edges_.of),
        scratch(b.scratch_.data()->of) {}
};

}  // namespace cullhull::internal
#endif

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

constexpr std::size_t width = NormalBlock::lanes;

using DoubleDoubles = WideLanes<false>;  // the bits of simplex_normal

HWY_INLINE Lanes leading(Lanes a) { return a; }
HWY_INLINE Lanes leading(const DoubleDoubles& a) { return a.high; }
HWY_INLINE Lanes rounded(Lanes a) { return a; }
HWY_INLINE Lanes rounded(const DoubleDoubles& a) { return a.high + a.low; }
template <class Real>
HWY_INLINE Real difference_of(Lanes a, Lanes b) {
  if constexpr (std::is_same_v<Real, Lanes>)
    return a - b;
  else
    return DoubleDoubles::sum(a, -b);
}

/// An array of vectors in memory, `width` doubles apart.
template <class Real>
struct Cells;
template <>
struct Cells<Lanes> {
  double* at;
  HWY_INLINE Cells(double* from, std::size_t) : at(from) {}
  HWY_INLINE Lanes get(std::size_t i) const { return load(at + i * width); }
  HWY_INLINE void set(std::size_t i, Lanes v) const { store(v, at + i * width); }
  HWY_INLINE void exchange(unsigned l, std::size_t a, std::size_t b) const {
    std::swap(at[a * width + l], at[b * width + l]);
  }
};
template <>
struct Cells<DoubleDoubles> {
  double *high, *low;
  HWY_INLINE Cells(double* from, std::size_t count) : high(from), low(from + count * width) {}
  HWY_INLINE DoubleDoubles get(std::size_t i) const {
    return {load(high + i * width), load(low + i * width)};
  }
  HWY_INLINE void set(std::size_t i, const DoubleDoubles& v) const {
    store(v.high, high + i * width);
    store(v.low, low + i * width);
  }
  HWY_INLINE void exchange(unsigned l, std::size_t a, std::size_t b) const {
    std::swap(high[a * width + l], high[b * width + l]);
    std::swap(low[a * width + l], low[b * width + l]);
  }
};

/// The first largest entry of each lane, by rows and then by columns. An entry's place is a number
/// of its row and column.
struct Largest {
  Lanes size, place;
  HWY_INLINE Largest() : size(0.0), place(0.0) {}
  HWY_INLINE void see(Lanes entry, Lanes at) {
    const Lanes magnitude = absolute(entry);
    const M more = magnitude > size;
    size = chosen(more, magnitude, size);
    place = chosen(more, at, place);
  }
  /// Adds what a later row has.
  HWY_INLINE void add(const Largest& row) {
    const M more = row.size > size;
    size = chosen(more, row.size, size);
    place = chosen(more, row.place, place);
  }
};
constexpr unsigned column_bits = 6;
static_assert(NormalBlock::most_dimensions <= 1U << column_bits);
HWY_INLINE Lanes place_of(unsigned i, unsigned j) {
  return {static_cast<double>(i << column_bits | j)};
}

/// The normals of one vector of simplices, whose first lane is `lane`.
template <class Real>
void normals_of(const NormalKernel& b, unsigned lane) {
  const unsigned k = b.k, rows = k - 1, used = lane_count();
  const std::size_t cells = std::size_t{rows} * k;
  double* const scratch = b.scratch + lane;
  const Cells<Real> m(scratch, cells), normal(scratch + 2 * cells * width, k);
  const auto corner = [&](unsigned j, unsigned c) {
    return load(b.corners + (std::size_t{j} * k + c) * width + lane);
  };

  const Lanes one = 1.0;
  Largest next;
  Lanes lengths = 1.0;
  for (unsigned i = 0; i < rows; ++i) {
    Largest in_row;
    Lanes square = 0.0, place = place_of(i, 0);
    for (unsigned j = 0; j < k; ++j, place = place + one) {
      const Real edge = difference_of<Real>(corner(i + 1, j), corner(0, j));
      m.set(std::size_t{i} * k + j, edge);
      in_row.see(leading(edge), place);
      square = square + leading(edge) * leading(edge);
    }
    next.add(in_row);
    lengths = lengths * root(square);
  }
  if constexpr (std::is_same_v<Real, Lanes>) store(lengths, b.edges + lane);
  // The matrices differ in their pivots, so their entries are exchanged one by one.
  unsigned column[width][NormalBlock::most_dimensions];
  alignas(64) double place[width] = {}, sign[width];
  for (unsigned l = 0; l < used; ++l) {
    sign[l] = 1;
    for (unsigned j = 0; j < k; ++j) column[l][j] = j;
  }
  Real determinant = one;
  M proper = one > Lanes(0.0);
  const Lanes limit = std::numeric_limits<double>::infinity();
  for (unsigned r = 0; r < rows; ++r) {
    proper = hn::And(proper, hn::And(next.size > Lanes(0.0), next.size < limit));
    store(next.place, place);
    for (unsigned l = 0; l < used; ++l) {
      const auto at = static_cast<unsigned>(place[l]);
      const unsigned row = at >> column_bits, there = at & ((1U << column_bits) - 1);
      if ((row != r) != (there != r)) sign[l] = -sign[l];
      for (unsigned j = r; j < k; ++j)
        m.exchange(l, std::size_t{r} * k + j, std::size_t{row} * k + j);
      for (unsigned i = 0; i < rows; ++i)
        m.exchange(l, std::size_t{i} * k + r, std::size_t{i} * k + there);
      std::swap(column[l][r], column[l][there]);
    }
    const std::size_t top = std::size_t{r} * k;
    const Real pivot = m.get(top + r);
    determinant = determinant * pivot;
    next = Largest();
    for (unsigned i = r + 1; i < rows; ++i) {
      const std::size_t base = std::size_t{i} * k;
      const Real factor = m.get(base + r) / pivot;
      Largest in_row;
      Lanes at = place_of(i, r + 1);
      for (unsigned j = r + 1; j < k; ++j, at = at + one) {
        const Real fresh = m.get(base + j) - factor * m.get(top + j);
        m.set(base + j, fresh);
        in_row.see(leading(fresh), at);
      }
      next.add(in_row);
    }
  }

  // Substitution, in the order of the pivots.
  const M even = load(sign) > Lanes(0.0);
  normal.set(rows, chosen(even, determinant, -determinant));
  for (unsigned r = rows; r-- > 0;) {
    Real sum = Lanes(0.0);
    for (unsigned j = r + 1; j < k; ++j) sum = sum + m.get(std::size_t{r} * k + j) * normal.get(j);
    normal.set(r, -(sum / m.get(std::size_t{r} * k + r)));
  }
  double* const normals = b.normals + lane;
  for (unsigned j = 0; j < k; ++j) {
    store(chosen(proper, rounded(normal.get(j)), Lanes(0.0)), place);
    for (unsigned l = 0; l < used; ++l) normals[column[l][j] * width + l] = place[l];
  }
  Lanes square = 0.0;
  for (unsigned j = 0; j < k; ++j) {
    const Lanes n = load(normals + j * width);
    square = square + n * n;
  }
  store(root(square), b.length + lane);
}

template <class Real>
void all_normals(const NormalKernel& b) {
  for (unsigned lane = 0; lane < width; lane += lane_count()) normals_of<Real>(b, lane);
}

}  // namespace

void normal_block(const NormalKernel& b) { all_normals<Lanes>(b); }
void careful_normal_block(const NormalKernel& b) { all_normals<DoubleDoubles>(b); }

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(normal_block);
HWY_EXPORT(careful_normal_block);

NormalBlock::NormalBlock(unsigned k)
    : k_(k), corners_(std::size_t{k} * k), normals_(k), scratch_(NormalKernel::scratch_rows(k)) {}

void NormalBlock::compute() { HWY_DYNAMIC_DISPATCH(normal_block)(NormalKernel(*this)); }
void NormalBlock::compute_carefully() {
  HWY_DYNAMIC_DISPATCH(careful_normal_block)(NormalKernel(*this));
}

}  // namespace cullhull::internal
#endif
