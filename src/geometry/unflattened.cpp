#include "geometry/unflattened.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "cullhull/array.hpp"
#include "exact/numbers/double_double.hpp"
#include "exact/numbers/gmpxx.hpp"
#include "exact/planes/exact_plane.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

/// Filters in f32 decide most signs of a set that is wider than this.
constexpr double thin = 0x1p-16;

/// Exponents of coordinates and normals that need no care.
constexpr long widest = 900;

/// Returns c 2^-unit but for its bits from the 106th on. Sets `fits` to false if it is too large.
DoubleDouble two_doubles(const ExactPlane::ScaledInteger& c, long unit, bool& fits) {
  if (mpz_sgn(c.value) == 0) return 0;
  long e = 0, f = 0;
  const double high = mpz_get_d_2exp(&e, c.value);
  mpz_class rest(c.value), head(std::ldexp(high, 53));
  if (e > 53)
    head <<= static_cast<mp_bitcnt_t>(e - 53);
  else
    head >>= static_cast<mp_bitcnt_t>(53 - e);
  rest -= head;
  const double low = mpz_get_d_2exp(&f, rest.get_mpz_t());
  const long shift = c.exponent - unit;
  fits = fits && e + shift < widest;
  const auto scaled = [](double v, long by) {
    return std::ldexp(v, static_cast<int>(std::clamp(by, -2 * widest, widest)));
  };
  return {scaled(high, e + shift), scaled(low, f + shift)};
}

/// A coordinate of the image in units of 2^unit, about the simplex's height above a facet: 0 on the
/// facet, from 0.5 to 1 in magnitude at the vertex opposite.
class ImageAxis {
 public:
  ImageAxis(const LocalPoints& points, const std::vector<std::uint32_t>& simplex, unsigned opposite)
      : d_(points.dimension) {
    for (unsigned j = 0; j <= d_; ++j)
      if (j != opposite) facet_.push_back(points.exact_row(simplex[j]));
    plane_.set(d_, facet_.data());
    if (plane_.degenerate()) return;
    proper_ = exactly(points.exact_row(simplex[opposite]), unit_) != 0;
    for (unsigned j = 0; j < d_; ++j)
      normal_.push_back(two_doubles(plane_.cofactor(j), unit_, in_doubles_));
  }
  bool proper() const { return proper_; }

  /// Within 2^-42 + u |result|; infinite if out of range.
  double of(const double* x) {
    // A cofactor is within 2^-105, differences are exact, products within 7 u^2, sums within 3 u^2
    // + 13 u^3: (d + 4) 2^-103 in all.
    DoubleDouble sum;
    double size = 0;
    for (unsigned j = 0; j < d_; ++j) {
      const DoubleDouble term = normal_[j] * DoubleDouble::sum(x[j], -facet_[0][j]);
      size += std::abs(term.high);
      sum = sum + term;
    }
    if (in_doubles_ && (d_ + 5.0) * 0x1p-103 * size < 0x1p-43) return sum.value();
    long exponent = 0;
    const double mantissa = exactly(x, exponent);
    if (mantissa != 0 && exponent - unit_ > widest) return HUGE_VAL;
    return std::ldexp(mantissa, static_cast<int>(std::max(exponent - unit_, -widest)));
  }

 private:
  double exactly(const double* x, long& exponent) {
    const ExactPlane::ScaledInteger v = plane_.determinant(x);
    const double mantissa = mpz_get_d_2exp(&exponent, v.value);
    exponent += v.exponent;
    return mantissa;
  }

  const unsigned d_;
  std::vector<const double*> facet_;
  ExactPlane plane_;
  std::vector<DoubleDouble> normal_;
  long unit_ = 0;
  bool proper_ = false, in_doubles_ = true;
};

/// Sets rows to the points' coordinates relative to `simplex`. Returns false if one is out of
/// range.
bool relative_rows(const LocalPoints& points, const std::vector<std::uint32_t>& simplex,
                   const Run& run, Array<double>& rows) {
  constexpr std::uint64_t chunk = std::uint64_t{1} << 13;
  const unsigned d = points.dimension;
  std::atomic<bool> in_range{true};
  run.each_chunk(points.count, chunk, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
    for (unsigned j = 0; j < d && in_range; ++j) {
      run.check();
      ImageAxis axis(points, simplex, j);
      if (!axis.proper()) in_range = false;
      for (std::uint64_t i = begin; i < end && in_range; ++i) {
        const double v = axis.of(points.exact_row(static_cast<std::uint32_t>(i)));
        if (!std::isfinite(v)) in_range = false;
        rows[i * d + j] = v;
      }
    }
  });
  return in_range;
}

}  // namespace

Unflattened::Unflattened(const LocalFrame& frame, const Run& run) : points_(frame.points()) {
  // One image nearly always suffices; the second begins with a simplex that is chosen in the first.
  for (int images = 0; images < 3; ++images) {
    const LocalFrame& last = image_ ? *image_ : frame;
    if (last.thickness() > thin) return;
    Array<double> rows(std::size_t{points_.count} * points_.dimension);
    if (!relative_rows(points_, last.simplex(), run, rows)) return;
    LocalFrame image(std::move(rows), points_.count, points_.dimension, run);
    if (image.points().dimension != points_.dimension) return;
    image_ = std::move(image);
    points_.coordinates = image_->points().coordinates;
    points_.coordinate_error = error;
    points_.small_lattice = false;
  }
}

}  // namespace cullhull::internal
