#include "result/measures/simplex_measures.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <utility>

#include "cullhull/hull.hpp"
#include "exact/numbers/exact_float.hpp"
#include "exact/numbers/gmpxx.hpp"
#include "exact/points/integer_points.hpp"
#include "parallel/threads/run.hpp"
#include "result/measures/totals.hpp"

namespace cullhull::internal {
namespace {

// With the edges E from point 0 as rows and G = E E^T, the rows g_i of G^-1 E are the gradients of
// the barycentric coordinates. The facet beyond point i has the normal -g_i / |g_i|; g_0 = -Sum
// g_i; the volume times k! is sqrt det G, and each facet's measure is that times |g_i|, but for (k
// - 1)! in place of k!. E and G are exact integers, rows scaled by powers of two so that G's
// diagonal is in [1/4, 1]. X ~ G^-1 in fixed-point numbers of b bits comes from a Cholesky factor
// R, however right that is: I - X G is computed exactly, and where its rows add up to eps <= 1/2,
// |G^-1 - X| <= 2 eps max|X| entry by entry, so g_i is off by at most k times that, where |g_i| >=
// 1 (1 over its point's height, which is no longer than its edge). R R^T differs from G by at most
// 2^(1-b) an entry, as its quotients and roots are cut off there, and det G from (Prod r_ii)^2 by
// k^3 max|X| 2^(3-b) of itself. b grows until all this is below 2^-330; results are then rounded
// once more, to doubles. Components of a normal below that are 0.
using Integer = mpz_class;
using Matrix = std::vector<Integer>;

long bit_count(const Integer& v) {
  return v == 0 ? 0 : static_cast<long>(mpz_sizeinbase(v.get_mpz_t(), 2));
}
long most_bits(const Matrix& m) {
  long most = 0;
  for (const Integer& v : m) most = std::max(most, bit_count(v));
  return most;
}
Integer shifted(const Integer& v, long left) {
  Integer r;
  if (left >= 0)
    mpz_mul_2exp(r.get_mpz_t(), v.get_mpz_t(), static_cast<mp_bitcnt_t>(left));
  else
    mpz_fdiv_q_2exp(r.get_mpz_t(), v.get_mpz_t(), static_cast<mp_bitcnt_t>(-left));
  return r;
}
void add_product(Integer& sum, const Integer& a, const Integer& b) {
  mpz_addmul(sum.get_mpz_t(), a.get_mpz_t(), b.get_mpz_t());
}
void subtract_product(Integer& sum, const Integer& a, const Integer& b) {
  mpz_submul(sum.get_mpz_t(), a.get_mpz_t(), b.get_mpz_t());
}
void divide(Integer& v, const Integer& by) {
  mpz_fdiv_q(v.get_mpz_t(), v.get_mpz_t(), by.get_mpz_t());
}

/// The edges from vertex 0, as integers in one unit, and the gradients of the barycentric
/// coordinates: with the edges as the rows of E and G = E E', the rows of G^-1 E. Row i of E counts
/// in units of 2^scale(i), so that G has a diagonal in [1/4, 1]; fixed-point numbers approximate
/// G^-1, and the exact rest I - X G bounds their error.
class SimplexGradients {
 public:
  SimplexGradients(const Frame& frame, const Run& run)
      : run_(run), k_(frame.k), d_(frame.dimension) {
    long unit = 0;
    bool any = false;
    for (std::uint32_t v = 0; v <= k_; ++v)
      for (unsigned c = 0; c < d_; ++c) {
        const double x = frame.raw_at(v)[c];
        if (x == 0) continue;
        const long e = lowest_bit_exponent(x);
        unit = any ? std::min(unit, e) : e;
        any = true;
      }
    unit_ = unit;
    const auto whole = [&](double x) -> Integer {
      Integer r;
      set_in_units(r.get_mpz_t(), double_parts(x), unit_);
      return r;
    };
    edges_.resize(std::size_t{k_} * d_);
    gram_.resize(std::size_t{k_} * k_);
    for (unsigned i = 0; i < k_; ++i)
      for (unsigned c = 0; c < d_; ++c)
        edges_[i * std::size_t{d_} + c] = whole(frame.raw_at(i + 1)[c]) - whole(frame.raw_at(0)[c]);
    for (unsigned i = 0; i < k_; ++i) {
      run_.check();
      for (unsigned j = 0; j <= i; ++j) {
        Integer& g = gram(i, j);
        for (unsigned c = 0; c < d_; ++c)
          add_product(g, edges_[i * std::size_t{d_} + c], edges_[j * std::size_t{d_} + c]);
        gram(j, i) = g;
      }
      scale_.push_back((bit_count(gram(i, i)) + 1) / 2);
    }
    most_scale_ = *std::max_element(scale_.begin(), scale_.end());
    bits_ = std::max(512L, most_scale_ + 64);
    for (long lack; (lack = approximate()) > 0;) bits_ += std::max(lack, bits_ / 4);
    set_gradients();
  }

  /// Measure of the parallelotope of all edges: of the simplex, times k!.
  ExactFloat volume() const {
    RoundedFloat product(1.0);
    long exponent = 0;
    for (unsigned i = 0; i < k_; ++i) {
      product = product * RoundedFloat(root_[i * std::size_t{k_} + i]);
      exponent += scale_[i] + unit_ - bits_;
    }
    return ExactFloat(product).times_power_of_two(exponent);
  }
  /// Gradient i, of vertex i's coordinate, times 2^gradient_exponent().
  const Integer* gradient(unsigned i) const { return gradients_.data() + std::size_t{i} * d_; }
  long gradient_exponent() const { return bits_ + 2 * most_scale_ + unit_; }
  /// Components of gradient i that are less than this are zero, as far as is known.
  Integer doubt(unsigned i) const {
    const long scale = i > 0 ? scale_[i - 1] : *std::min_element(scale_.begin(), scale_.end());
    return shifted(1, std::max(0L, error_ + bits_ + 2 * most_scale_ - scale));
  }

 private:
  Integer& gram(unsigned i, unsigned j) { return gram_[i * std::size_t{k_} + j]; }
  static constexpr long wanted = 330;  ///< bits

  /// Sets root_ to G's Cholesky factor and inverse_ to G's inverse, in units of 2^-bits_. Returns
  /// how many bits are missing for results as right as wanted, at most 0 if none are.
  long approximate() {
    root_.assign(std::size_t{k_} * k_, 0);
    const auto root = [&](unsigned i, unsigned j) -> Integer& {
      return root_[i * std::size_t{k_} + j];
    };
    for (unsigned i = 0; i < k_; ++i) {
      run_.check();
      for (unsigned j = 0; j <= i; ++j) {
        Integer rest = shifted(gram(i, j), 2 * bits_ - scale_[i] - scale_[j]);
        for (unsigned m = 0; m < j; ++m) subtract_product(rest, root(i, m), root(j, m));
        if (j < i) {
          divide(rest, root(j, j));
          root(i, j) = std::move(rest);
        } else {
          if (rest <= 0) return bits_;
          mpz_sqrt(root(i, i).get_mpz_t(), rest.get_mpz_t());
          if (root(i, i) == 0) return bits_;
        }
      }
    }
    Matrix back(std::size_t{k_} * k_);  // column j of the inverse of the root is row j
    const auto inverse_root = [&](unsigned i, unsigned j) -> Integer& {
      return back[j * std::size_t{k_} + i];
    };
    for (unsigned j = 0; j < k_; ++j) {
      run_.check();
      inverse_root(j, j) = shifted(1, 2 * bits_);
      divide(inverse_root(j, j), root(j, j));
      for (unsigned i = j + 1; i < k_; ++i) {
        Integer& sum = inverse_root(i, j);
        for (unsigned m = j; m < i; ++m) subtract_product(sum, root(i, m), inverse_root(m, j));
        divide(sum, root(i, i));
      }
    }
    inverse_.assign(std::size_t{k_} * k_, 0);
    for (unsigned i = 0; i < k_; ++i) {
      run_.check();
      for (unsigned j = 0; j <= i; ++j) {
        Integer sum;
        for (unsigned m = i; m < k_; ++m) add_product(sum, inverse_root(m, i), inverse_root(m, j));
        inverse_[i * std::size_t{k_} + j] = inverse_[j * std::size_t{k_} + i] =
            shifted(sum, -bits_);
      }
    }
    return missing_bits();
  }

  long missing_bits() {
    const long size = most_bits(inverse_) - bits_, dimension = std::bit_width(k_);
    // Column j of the inverse in units in which row j of the edges is whole.
    for (unsigned i = 0; i < k_; ++i)
      for (unsigned j = 0; j < k_; ++j)
        mpz_mul_2exp(inverse_[i * std::size_t{k_} + j].get_mpz_t(),
                     inverse_[i * std::size_t{k_} + j].get_mpz_t(),
                     static_cast<mp_bitcnt_t>(most_scale_ - scale_[j]));
    long rest = -bits_;  // the rest's rows add up to less than 2^rest
    for (unsigned i = 0; i < k_; ++i) {
      run_.check();
      Integer sum;
      for (unsigned l = 0; l < k_; ++l) {
        Integer entry = i == l ? shifted(-1, bits_ + most_scale_ + scale_[l]) : Integer(0);
        for (unsigned j = 0; j < k_; ++j)
          add_product(entry, inverse_[i * std::size_t{k_} + j], gram(j, l));
        sum += shifted(abs(entry), most_scale_ - scale_[l]);
      }
      rest = std::max(rest, bit_count(sum) - bits_ - 2 * most_scale_);
    }
    if (rest > -1) return bits_;
    // An entry of the inverse is wrong by less than 2^error, a component of a gradient by k times
    // that, the first one's by k^2; their lengths are at least 1 (the first one's 1 over the
    // shortest edge). The root's square is wrong by 2^(1 - bits) an entry.
    error_ = rest + 1 + size + 2 * dimension;
    return std::max(error_, 3 * dimension + size + 3 - bits_) + wanted;
  }

  void set_gradients() {
    gradients_.assign(std::size_t{k_ + 1} * d_, 0);
    for (unsigned i = 0; i < k_; ++i) {
      run_.check();
      for (unsigned c = 0; c < d_; ++c) {
        Integer& g = gradients_[(i + std::size_t{1}) * d_ + c];
        for (unsigned j = 0; j < k_; ++j)
          add_product(g, inverse_[i * std::size_t{k_} + j], edges_[j * std::size_t{d_} + c]);
        g = shifted(g, most_scale_ - scale_[i]);
        gradients_[c] -= g;
      }
    }
  }

  const Run& run_;
  const unsigned k_, d_;
  long unit_ = 0, most_scale_ = 0, bits_ = 0, error_ = 0;
  std::vector<long> scale_;
  Matrix edges_, gram_, root_, inverse_, gradients_;
};

}  // namespace

void measure_simplex(const Frame& frame, const std::vector<std::uint32_t>& index, const Run& run,
                     Hull& hull) {
  const unsigned k = frame.k, d = frame.dimension;
  const SimplexGradients simplex(frame, run);
  Totals<ExactFloat> totals(d);
  totals.volume = simplex.volume();
  hull.facet_planes.resize(std::size_t{k + 1} * (d + 1));
  for (unsigned f = 0; f <= k; ++f) {
    run.check();
    const std::uint32_t* const corners = index.data() + std::size_t{f} * k;
    std::uint32_t apex = k * (k + 1) / 2;
    for (unsigned j = 0; j < k; ++j) apex -= corners[j];
    const Integer* const gradient = simplex.gradient(apex);
    RoundedFloat square;
    for (unsigned c = 0; c < d; ++c) {
      const RoundedFloat g(gradient[c]);
      square = square + g * g;
    }
    const RoundedFloat length = square.root();
    const Integer doubt = simplex.doubt(apex);
    double* const out = hull.facet_planes.data() + std::size_t{f} * (d + 1);
    ExactFloat offset;
    for (unsigned c = 0; c < d; ++c) {
      const bool zero = abs(gradient[c]) < doubt;
      out[c] = zero ? 0 : (-(RoundedFloat(gradient[c]) / length)).to_double();
      offset = offset - ExactFloat(out[c]) * ExactFloat(frame.raw_at(corners[0])[c]);
    }
    out[d] = offset.to_double();
    // The volume is a facet's measure times the height of the vertex beyond it, 1 over the length.
    totals.area = totals.area + totals.volume * ExactFloat(length).times_power_of_two(
                                                    -simplex.gradient_exponent());
  }
  for (unsigned c = 0; c < d; ++c) {
    ExactFloat sum;
    for (std::uint32_t v = 1; v <= k; ++v)
      sum = sum + (ExactFloat(frame.raw_at(v)[c]) - ExactFloat(frame.raw_at(0)[c]));
    totals.moment[c] = totals.volume * sum;
  }
  finish_measures(frame, totals, 1, 0, hull);
}

}  // namespace cullhull::internal
