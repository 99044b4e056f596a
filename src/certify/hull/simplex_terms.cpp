// The terms of all facets of a simplex from one factorisation, where each facet's own takes as
// long: docs/exactness.md, "Numbers".
#include <cmath>
#include <numeric>

#include "certify/hull/facet_terms.hpp"

namespace cullhull::internal::certify {
namespace {

using Row = std::vector<mpf_class>;

mpf_class dot(const Row& a, const Row& b) {
  mpf_class sum(a[0] * b[0]);
  for (std::size_t c = 1; c < a.size(); ++c) sum += a[c] * b[c];
  return sum;
}

void subtract(Row& row, const mpf_class& factor, const Row& other) {
  for (std::size_t c = 0; c < row.size(); ++c) row[c] -= factor * other[c];
}

void divide(Row& row, const mpf_class& divisor) {
  for (mpf_class& v : row) v /= divisor;
}

}  // namespace

/// With e_i the edges from vertex 0 to vertex i, the dual vectors g_i of the flat (g_i . e_j is 1
/// for i = j, else 0) are inner normals of the facets opposite vertex i, and 1 / |g_i| is its
/// height over that facet; g_0 = -sum g_i is that of the facet opposite vertex 0. The facet's
/// parallelotope measures |g_i| times that of all edges.
///
/// Edges of length 1 are L Q, with Q orthonormal and L lower triangular, whose diagonal has the
/// simplex's share as its product. Minors of unit rows are at most 1, so entries of L's inverse are
/// at most 1 / share, and the error of a dual vector, which is no shorter than 1, is below
/// 2^-bits k^2 / share^2: with a share above 2^-(bits / 3), below k^2 2^-(bits / 3).
bool CheckedFacets::find_simplex_terms(mp_bitcnt_t bits) {
  const auto edge = [&](std::uint32_t from, std::uint32_t to) {
    Row row;
    for (unsigned c = 0; c < d_; ++c)
      row.push_back(mpf_class(s_.full[std::size_t{to} * d_ + c], bits) -
                    mpf_class(s_.full[std::size_t{from} * d_ + c], bits));
    return row;
  };
  const mpf_class one(1, bits);
  mpf_class share(one), least(one);
  mpf_div_2exp(least.get_mpf_t(), least.get_mpf_t(), bits / 3);
  std::vector<Row> units, lower;
  Row lengths{one};  // of the edge to each vertex
  for (std::uint32_t i = 1; i <= k_; ++i) {
    s_.run.check();
    Row row = edge(0, i);
    lengths.push_back(sqrt(dot(row, row)));
    if (!(lengths[i] > 0)) return false;
    divide(row, lengths[i]);
    Row entries(i, mpf_class(0, bits));
    for (unsigned twice = 0; twice < 2; ++twice)
      for (std::uint32_t j = 0; j + 1 < i; ++j) {
        const mpf_class part = dot(units[j], row);
        entries[j] += part;
        subtract(row, part, units[j]);
      }
    entries[i - 1] = sqrt(dot(row, row));
    share *= entries[i - 1];
    if (!(share > least)) return false;
    divide(row, entries[i - 1]);
    units.push_back(std::move(row));
    lower.push_back(std::move(entries));
  }
  std::vector<Row> duals(k_ + 1, Row(d_, mpf_class(0, bits)));
  Row column(k_, mpf_class(0, bits));  // of L's inverse
  for (std::uint32_t i = 1; i <= k_; ++i) {
    s_.run.check();
    for (std::uint32_t j = i - 1; j < k_; ++j) {
      mpf_class sum(j + 1 == i ? one : mpf_class(0, bits));
      for (std::uint32_t m = i - 1; m < j; ++m) sum -= lower[j][m] * column[m];
      column[j] = sum / lower[j][j];
      subtract(duals[i], -column[j], units[j]);
    }
    divide(duals[i], lengths[i]);
    subtract(duals[0], one, duals[i]);
  }
  mpf_class whole(share);
  for (const mpf_class& length : lengths) whole *= length;
  for (std::uint32_t f = 0; f <= k_; ++f) {
    const std::uint32_t* const corners = s_.simplex(f);
    const std::uint32_t lacks =
        std::accumulate(corners, corners + k_, k_ * (k_ + 1) / 2, std::minus<std::uint32_t>());
    const mpf_class size = sqrt(dot(duals[lacks], duals[lacks]));
    Row normal = duals[lacks];
    divide(normal, -size);
    mpf_class product(one);
    for (unsigned j = 1; j < k_; ++j) {
      const Row row = corners[0] == 0 ? Row() : edge(corners[0], corners[j]);
      product *= row.empty() ? lengths[corners[j]] : mpf_class(sqrt(dot(row, row)));
    }
    simplex_terms_.push_back({std::move(normal),
                              std::move(product),
                              mpf_class(whole * size),
                              lacks == 0 ? mpf_class(one / size) : mpf_class(0, bits),
                              {}});
  }
  return true;
}

}  // namespace cullhull::internal::certify
