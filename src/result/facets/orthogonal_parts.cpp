#include "result/facets/orthogonal_parts.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "cullhull/error.hpp"
#include "exact/points/integer_points.hpp"

namespace cullhull::internal {
namespace {

/// Finds the largest power of two that divides all coordinates added.
class Unit {
 public:
  void add(double v) {
    if (v == 0) return;
    const long e = lowest_bit_exponent(v);
    exponent_ = any_ ? std::min(exponent_, e) : e;
    any_ = true;
  }
  long exponent() const { return exponent_; }

 private:
  bool any_ = false;
  long exponent_ = 0;
};

/// v as an integer multiple of 2^unit.
mpz_class in_units(double v, long unit) {
  mpz_class r;
  set_in_units(r.get_mpz_t(), double_parts(v), unit);
  return r;
}

/// A step of Bareiss's fraction-free elimination: target = (target * pivot - factor * above) /
/// previous. The division is exact.
void eliminate(mpz_class& target, const mpz_class& pivot, const mpz_class& factor,
               const mpz_class& above, const mpz_class& previous) {
  target *= pivot;
  mpz_submul(target.get_mpz_t(), factor.get_mpz_t(), above.get_mpz_t());
  if (previous != 1) mpz_divexact(target.get_mpz_t(), target.get_mpz_t(), previous.get_mpz_t());
}

[[noreturn]] void degenerate() {
  throw Error(ErrorCode::internal, "a simplex of the hull is degenerate");
}

}  // namespace

ExactOrthogonalParts::ExactOrthogonalParts(unsigned d, const double* const* p, unsigned rows)
    : d_(d) {
  Unit unit;
  for (unsigned i = 0; i <= rows; ++i)
    for (unsigned c = 0; c < d; ++c) unit.add(p[i][c]);
  unit_ = unit.exponent();
  rests_.resize(std::size_t{rows} * d);
  for (unsigned i = 0; i < rows; ++i)
    for (unsigned c = 0; c < d; ++c)
      rests_[std::size_t{i} * d + c] = in_units(p[i + 1][c], unit_) - in_units(p[0][c], unit_);
  // Bareiss elimination of [Gram matrix | edges]. After the elimination of the first i rows, the
  // right part of row i is its orthogonal rest times the leading minor of order i, and its diagonal
  // entry is the leading minor of order i + 1.
  std::vector<mpz_class> gram(std::size_t{rows} * rows);
  for (unsigned i = 0; i < rows; ++i)
    for (unsigned j = 0; j < rows; ++j)
      for (unsigned c = 0; c < d; ++c) gram[i * std::size_t{rows} + j] += rest(i)[c] * rest(j)[c];
  minors_.assign(1, 1);
  for (unsigned r = 0; r < rows; ++r) {
    const mpz_class pivot = gram[r * std::size_t{rows} + r];
    const mpz_class& previous = minors_.back();
    if (pivot == 0 && r + 1 < rows) degenerate();
    for (unsigned i = r + 1; i < rows; ++i) {
      const mpz_class factor = gram[i * std::size_t{rows} + r];
      for (unsigned j = r + 1; j < rows; ++j)
        eliminate(gram[i * std::size_t{rows} + j], pivot, factor, gram[r * std::size_t{rows} + j],
                  previous);
      for (unsigned c = 0; c < d; ++c)
        eliminate(rests_[std::size_t{i} * d + c], pivot, factor, rest(r)[c], previous);
    }
    minors_.push_back(pivot);
  }
}

RoundedFloat ExactOrthogonalParts::rest_length(unsigned i) const {
  RoundedFloat square;
  for (unsigned c = 0; c < d_; ++c) {
    const RoundedFloat v(rest(i)[c]);
    square = square + v * v;
  }
  return square.root();
}

std::vector<RoundedFloat> ExactOrthogonalParts::direction(unsigned i) const {
  const RoundedFloat length = rest_length(i);
  std::vector<RoundedFloat> out;
  if (length.zero()) return out;
  for (unsigned c = 0; c < d_; ++c) out.push_back(RoundedFloat(rest(i)[c]) / length);
  return out;
}

ExactNormal::ExactNormal(unsigned d, const double* const* p) {
  std::vector<long> units;
  long all_units = 0;
  for (unsigned c = 0; c < d; ++c) {
    Unit unit;
    for (unsigned i = 0; i <= d; ++i) unit.add(p[i][c]);
    units.push_back(unit.exponent());
    all_units += unit.exponent();
  }
  const auto edge = [&](unsigned i, unsigned c) -> mpz_class {
    return in_units(p[i][c], units[c]) - in_units(p[0][c], units[c]);
  };
  const unsigned rows = d - 1;
  std::vector<mpz_class> m(std::size_t{rows} * d);
  for (unsigned i = 0; i < rows; ++i)
    for (unsigned c = 0; c < d; ++c) m[std::size_t{i} * d + c] = edge(i + 1, c);
  // Fraction-free Gauss-Jordan elimination. In the end every row has the same minor in its pivot
  // column and a cofactor in the column without a pivot.
  std::vector<unsigned> column(d);
  std::iota(column.begin(), column.end(), 0U);
  mpz_class previous = 1;
  for (unsigned r = 0; r < rows; ++r) {
    unsigned c = r;
    while (c < d && m[std::size_t{r} * d + column[c]] == 0) ++c;
    if (c == d) degenerate();
    std::swap(column[r], column[c]);
    const mpz_class pivot = m[std::size_t{r} * d + column[r]];
    for (unsigned i = 0; i < rows; ++i) {
      if (i == r) continue;
      const mpz_class factor = m[std::size_t{i} * d + column[r]];
      for (unsigned j = r + 1; j < d; ++j)
        eliminate(m[std::size_t{i} * d + column[j]], pivot, factor,
                  m[std::size_t{r} * d + column[j]], previous);
    }
    previous = pivot;
  }
  mpz_class height = 0;
  ExactFloat square;
  for (unsigned j = 0; j < d; ++j) {
    const unsigned c = column[j];
    const mpz_class n = j == rows ? mpz_class(-previous) : m[std::size_t{j} * d + column[rows]];
    height += n * edge(d, c);
    const ExactFloat component = ExactFloat(n).times_power_of_two(-units[c]);
    square = square + component * component;
  }
  area_ = square.root().times_power_of_two(all_units);
  volume_ = ExactFloat(height).magnitude().times_power_of_two(all_units);
}

}  // namespace cullhull::internal
