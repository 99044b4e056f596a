// Tables for cofactors by complementary minors, and the constants of their error bounds.
#pragma once

#include <array>
#include <bit>

#include "exact/determinants/minors.hpp"

namespace cullhull::internal {

/// Sets of columns of a D-column matrix. A set's rank is its number among the sets of its size, in
/// ascending order of bit masks.
template <unsigned D>
struct Subsets {
  static constexpr unsigned count(unsigned size) {
    unsigned n = 1;
    for (unsigned i = 0; i < size; ++i) n = n * (D - i) / (i + 1);
    return n;
  }
  static constexpr unsigned size_of(unsigned mask) {
    return static_cast<unsigned>(std::popcount(mask));
  }
  static constexpr unsigned rank(unsigned mask) {
    unsigned r = 0;
    for (unsigned m = 0; m < mask; ++m) r += size_of(m) == size_of(mask);
    return r;
  }
  static constexpr unsigned mask(unsigned size, unsigned wanted) {
    unsigned m = 0;
    for (;; ++m)
      if (size_of(m) == size && wanted-- == 0) return m;
  }
  static constexpr unsigned column(unsigned set, unsigned k) {  // the k-th column of a set
    for (; k > 0; --k) set &= set - 1;
    return static_cast<unsigned>(std::countr_zero(set));
  }
  static consteval unsigned member(unsigned size, unsigned r, unsigned k) {
    return column(mask(size, r), k);
  }
  /// The number of the set without its k-th column.
  static consteval unsigned without(unsigned size, unsigned r, unsigned k) {
    const unsigned set = mask(size, r);
    return rank(set ^ (1U << column(set, k)));
  }
};

/// The D cofactors of a (D - 1) x D matrix as sums of products of a minor of its first rows and
/// the complementary minor of the others.
template <unsigned D>
struct Laplace {
  static constexpr unsigned rows = D - 1, top_rows = rows / 2, bottom_rows = rows - top_rows;
  static constexpr unsigned binomial() {
    unsigned n = 1;
    for (unsigned i = 0; i < top_rows; ++i) n = n * (rows - i) / (i + 1);
    return n;
  }
  static constexpr unsigned splits = binomial();

  struct Split {
    unsigned top, bottom;
    bool negative;
  };
  /// Term k of cofactor j, (-1)^j times the minor without column j.
  static consteval Split split(unsigned j, unsigned k) {
    const unsigned columns = ((1U << D) - 1) ^ (1U << j);
    unsigned set = 0;
    for (;; ++set)
      if ((set & ~columns) == 0 && Subsets<D>::size_of(set) == top_rows && k-- == 0) break;
    // The number of exchanges that move the columns of `set` before the others.
    unsigned exchanges = j;
    for (unsigned c = 0; c < D; ++c)
      if ((set >> c & 1U) != 0)
        exchanges += Subsets<D>::size_of((columns & ~set) & ((1U << c) - 1));
    return {Subsets<D>::rank(set), Subsets<D>::rank(columns & ~set), (exchanges & 1U) != 0};
  }
};

/// The constants of E: docs/exactness.md, "Cached planes".
template <unsigned D>
struct PlaneBounds {
  /// The most roundings that a product of D - 1 entries meets between the coordinates and a
  /// cofactor.
  static constexpr double roundings() {
    constexpr double a = Laplace<D>::top_rows, b = Laplace<D>::bottom_rows;
    return (D - 1) + (a - 1) + a * (a - 1) / 2 + (b - 1) + b * (b - 1) / 2 + Laplace<D>::splits;
  }
  /// Error of a cofactor in units of the product of the rows' 1-norms.
  static constexpr double per_cofactor = (roundings() + 2) * unit_roundoff;
  /// a + b + (2 D + 6) u S = 4 T + (2 (D + 5) + (2 D + 2) + (2 D + 6)) u S with T = D per_cofactor.
  static constexpr double per_blur = 1.0625 * 4 * D;
  static constexpr double per_norm = per_blur * per_cofactor;
  static constexpr double per_size = 1.0625 * (6.0 * D + 18) * unit_roundoff;
  /// Error of rounding to f32 and of the dot product in f32.
  static constexpr double per_reach = (D + 3) * 0x1p-24 * (1 + 0x1p-10);
};

}  // namespace cullhull::internal
