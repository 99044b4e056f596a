// The text of `cofactors`, for numbers of any kind and for vectors of them: included inside a
// namespace, once for plain numbers (cofactors.hpp) and once for each instruction set
// (facet_lanes-inl.hpp). CULLHULL_MATH defines how its function is inlined.

/// Computes a normal such that normal . (x - p0) = det [p1 - p0; ...; p(K-1) - p0; x - p0], from
/// the rows edges[i] = p(i+1) - p0, by minors of the first r rows over all r-subsets of columns, r
/// = 1, 2, ...
template <unsigned K, class Real>
CULLHULL_MATH void cofactors(const Real (&edges)[K > 1 ? K - 1 : 1][K], Real (&normal)[K]) {
  if constexpr (K == 1) {
    normal[0] = 1;
  } else if constexpr (K == 2) {
    normal[0] = -edges[0][1];
    normal[1] = edges[0][0];
  } else if constexpr (K == 3) {
    normal[0] = edges[0][1] * edges[1][2] - edges[0][2] * edges[1][1];
    normal[1] = edges[0][2] * edges[1][0] - edges[0][0] * edges[1][2];
    normal[2] = edges[0][0] * edges[1][1] - edges[0][1] * edges[1][0];
  } else {
    constexpr unsigned full = (1U << K) - 1;
    Real minor[full + 1];
    for (unsigned c = 0; c < K; ++c) minor[1U << c] = edges[0][c];
    // Every proper subset of a mask is smaller than the mask, so ascending order suffices.
    for (unsigned mask = 3; mask < full; ++mask) {
      const auto rows = static_cast<unsigned>(std::popcount(mask));
      if (rows < 2) continue;
      const Real* row = edges[rows - 1];
      Real sum = 0;
      bool negative = (rows & 1U) == 0;  // sign of (last row, first column)
      for (unsigned rest = mask; rest != 0; rest &= rest - 1) {
        const auto c = static_cast<unsigned>(std::countr_zero(rest));
        const Real term = row[c] * minor[mask & ~(1U << c)];
        if (negative)
          sum = sum - term;
        else
          sum = sum + term;
        negative = !negative;
      }
      minor[mask] = sum;
    }
    for (unsigned c = 0; c < K; ++c) {
      normal[c] = minor[full & ~(1U << c)];
      if (((K - 1 + c) & 1U) != 0) normal[c] = -normal[c];
    }
  }
}
