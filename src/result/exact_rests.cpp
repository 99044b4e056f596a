#include "result/exact_rests.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "cullhull/error.hpp"

namespace cullhull::internal {
namespace {

/// Exponent of the last place of a non-zero double, as frexp sees it.
long last_place(double v) {
  int e = 0;
  std::frexp(v, &e);
  return e - 53L;
}

mpz_class in_units(double v, long unit) {
  if (v == 0) return 0;
  int e = 0;
  mpz_class r(std::ldexp(std::frexp(v, &e), 53));
  mpz_mul_2exp(r.get_mpz_t(), r.get_mpz_t(), static_cast<mp_bitcnt_t>(e - 53L - unit));
  return r;
}

}  // namespace

ExactRests::ExactRests(unsigned d, const double* const* p, unsigned rows) : d_(d) {
  bool any = false;
  for (unsigned i = 0; i <= rows; ++i)
    for (unsigned c = 0; c < d; ++c)
      if (p[i][c] != 0) {
        unit_ = any ? std::min(unit_, last_place(p[i][c])) : last_place(p[i][c]);
        any = true;
      }
  rests_.resize(std::size_t{rows} * d);
  for (unsigned i = 0; i < rows; ++i)
    for (unsigned c = 0; c < d; ++c)
      rests_[std::size_t{i} * d + c] = in_units(p[i + 1][c], unit_) - in_units(p[0][c], unit_);
  // Bareiss on [Gram matrix | edges]: with the first i rows eliminated, row i's right part is the
  // Schur complement times the leading minor, and its diagonal entry the next minor.
  std::vector<mpz_class> gram(std::size_t{rows} * rows);
  for (unsigned i = 0; i < rows; ++i)
    for (unsigned j = 0; j < rows; ++j)
      for (unsigned c = 0; c < d; ++c) gram[i * std::size_t{rows} + j] += rest(i)[c] * rest(j)[c];
  minors_.assign(1, 1);
  for (unsigned r = 0; r < rows; ++r) {
    const mpz_class pivot = gram[r * std::size_t{rows} + r];
    const mpz_class& previous = minors_.back();
    if (pivot == 0 && r + 1 < rows)
      throw Error(ErrorCode::internal, "a simplex of the hull is degenerate");
    const auto eliminate = [&](mpz_class& target, const mpz_class& factor, const mpz_class& above) {
      target = target * pivot - factor * above;
      mpz_divexact(target.get_mpz_t(), target.get_mpz_t(), previous.get_mpz_t());
    };
    for (unsigned i = r + 1; i < rows; ++i) {
      const mpz_class factor = gram[i * std::size_t{rows} + r];
      for (unsigned j = r + 1; j < rows; ++j)
        eliminate(gram[i * std::size_t{rows} + j], factor, gram[r * std::size_t{rows} + j]);
      for (unsigned c = 0; c < d; ++c)
        eliminate(rests_[std::size_t{i} * d + c], factor, rest(r)[c]);
    }
    minors_.push_back(pivot);
  }
}

Wide ExactRests::measure(unsigned count) const {
  return Wide(minors_[count]).root().times_power_of_two(unit_ * static_cast<long>(count));
}

Wide ExactRests::rest_length(unsigned i) const {
  Wide square;
  for (unsigned c = 0; c < d_; ++c) {
    const Wide v(rest(i)[c]);
    square = square + v * v;
  }
  return square.root();
}

std::vector<Wide> ExactRests::direction(unsigned i) const {
  const Wide length = rest_length(i);
  std::vector<Wide> out;
  if (length.zero()) return out;
  for (unsigned c = 0; c < d_; ++c) out.push_back(Wide(rest(i)[c]) / length);
  return out;
}

}  // namespace cullhull::internal
