#include "geometry/norm_order.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "geometry/curve_frame.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/radix_sort.hpp"
#include "parallel/scan.hpp"

namespace cullhull::internal {
namespace {

// The size of the first round, which is inserted before any other point is tested against the hull:
// large enough for a hull that culls well. On 10,000 normal points in 4D the tests against the
// facets of 64 points drop nine of ten.
constexpr std::uint32_t first_round = 64;
/// At least so many of the outermost points are selected and sorted before all points are: if
/// thinning between the rounds drops most of the others, they are never sorted.
constexpr std::uint32_t outermost = 1024;
/// Items in a chunk: 20 to 40 microseconds of work.
constexpr std::uint64_t chunk = std::uint64_t{1} << 13;
/// Returns the size of the sample for the covariance. It grows with the dimension, where the order
/// matters more: with 512 points instead of 4,096 the 6D engine makes a tenth more facets on balls.
std::uint32_t covariance_sample(std::uint32_t count, unsigned d) {
  const std::uint64_t share = std::uint64_t{count} * std::min(d - 3, 8U) / 8;
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(share, 512, 4096));
}

/// Returns a key that ascends as norms descend: non-negative floats are ordered like their bits. A
/// hash of the id in the low eight bits breaks ties.
std::uint32_t key(double norm, std::uint32_t id) {
  const auto v = static_cast<float>(std::min(norm, 1e30));
  const std::uint32_t tie = id * 0x9E3779B1U >> 24;
  return ~((std::bit_cast<std::uint32_t>(v) & ~0xFFU) | tie);
}

/// Computes |L^-1 (x - mean)|^2, where L L^T is the covariance. Only a heuristic: rounding does not
/// affect correctness.
class Norm {
 public:
  explicit Norm(const LocalPoints& points) : d_(points.dimension), mean_(d_, 0.0) {
    const std::uint32_t n = points.count, stride = std::max(1U, n / covariance_sample(n, d_));
    std::uint32_t used = 0;
    for (std::uint64_t i = 0; i < n; i += stride, ++used)
      for (unsigned j = 0; j < d_; ++j) mean_[j] += points.row(static_cast<std::uint32_t>(i))[j];
    for (double& m : mean_) m /= used;
    factor_.assign(std::size_t{d_} * d_, 0.0);
    std::vector<double> y(d_);
    for (std::uint64_t i = 0; i < n; i += stride) {
      const double* x = points.row(static_cast<std::uint32_t>(i));
      for (unsigned j = 0; j < d_; ++j) y[j] = x[j] - mean_[j];
      for (unsigned j = 0; j < d_; ++j)
        for (unsigned k = 0; k <= j; ++k) factor_[j * d_ + k] += y[j] * y[k];
    }
    for (double& f : factor_) f /= used;
    factorise();
  }

  /// Computes the norms of `lanes` consecutive rows. D: the dimension if known at compile time,
  /// else 0.
  static constexpr unsigned lanes = 8;
  template <unsigned D>
  void of_rows(const double* rows, double (*y)[lanes], double* norms) const {
    const unsigned d = D ? D : d_;
    std::fill_n(norms, lanes, 0.0);
    for (unsigned j = 0; j < d; ++j) {
      for (unsigned l = 0; l < lanes; ++l) y[j][l] = rows[l * d + j] - mean_[j];
      for (unsigned k = 0; k < j; ++k)
        for (unsigned l = 0; l < lanes; ++l) y[j][l] -= factor_[j * d + k] * y[k][l];
      for (unsigned l = 0; l < lanes; ++l) {
        y[j][l] *= factor_[j * d + j];
        norms[l] += y[j][l] * y[j][l];
      }
    }
  }

 private:
  /// Cholesky factorisation; the diagonal holds reciprocals. A direction without extent gets weight
  /// 0.
  void factorise() {
    for (unsigned j = 0; j < d_; ++j) {
      const double whole = factor_[j * d_ + j];
      for (unsigned k = 0; k < j; ++k) {
        double v = factor_[j * d_ + k];
        for (unsigned l = 0; l < k; ++l) v -= factor_[j * d_ + l] * factor_[k * d_ + l];
        factor_[j * d_ + k] = v * factor_[k * d_ + k];
      }
      double v = whole;
      for (unsigned k = 0; k < j; ++k) v -= factor_[j * d_ + k] * factor_[j * d_ + k];
      factor_[j * d_ + j] = v > 0x1p-40 * whole && v > 0x1p-900 ? 1 / std::sqrt(v) : 0;
    }
  }

  unsigned d_;
  std::vector<double> mean_, factor_;
};

}  // namespace

NormOrder::NormOrder(const LocalPoints& points, std::vector<std::uint32_t> left_out, const Run& run)
    : points_(points), run_(run) {
  std::sort(left_out.begin(), left_out.end());
  compute_norms();
  // Moves the points left out to the end, beyond `count_`.
  count_ = points.count;
  for (std::size_t k = left_out.size(); k-- > 0;) items_[left_out[k]] = items_[--count_];
}

void NormOrder::compute_norms() {
  constexpr unsigned lanes = Norm::lanes;
  const Norm norm(points_);
  const std::uint32_t n = points_.count;
  const unsigned d = points_.dimension;
  items_.reserve(n);
  // The last rows, padded to a full vector.
  std::vector<double> end_rows(std::size_t{lanes} * d, 0.0);
  std::copy_n(points_.row(n / lanes * lanes), std::size_t{n % lanes} * d, end_rows.data());
  with_dimension<4, 6, 0>(d, [&](auto dimension) {
    constexpr unsigned D = decltype(dimension)::value;
    run_.each(n, chunk, [&](std::uint64_t begin, std::uint64_t end) {
      double few[D ? D : 1][lanes], norms[lanes];
      std::vector<double> many(D ? 0 : std::size_t{d} * lanes);
      auto* y = D ? few : reinterpret_cast<double(*)[lanes]>(many.data());
      for (auto i = static_cast<std::uint32_t>(begin); i < end; i += lanes) {
        norm.of_rows<D>(i + lanes <= n ? points_.row(i) : end_rows.data(), y, norms);
        for (std::uint32_t l = 0; l < std::min(lanes, n - i); ++l)
          items_[i + l] = {key(norms[l], i + l), i + l};
      }
    });
  });
}

/// Ensures that the outermost `wanted` of all items are sorted.
void NormOrder::sort_outermost(std::uint32_t wanted) {
  if (wanted <= sorted_) return;
  const bool few = wanted <= outermost && count_ > 4 * outermost;
  const std::uint32_t end = few ? select_outermost(wanted) : count_;
  sort(sorted_, end, 32);
  sorted_ = end;
}

/// Moves about 2,048 of the outermost of the items that are not sorted to their front, by a
/// threshold from a sample; returns where they end. All items, if there are fewer than `wanted`.
std::uint32_t NormOrder::select_outermost(std::uint32_t wanted) {
  constexpr std::uint32_t stride = 32;
  std::vector<std::uint32_t> sample;
  for (std::uint32_t i = sorted_; i < count_; i += stride) sample.push_back(items_[i].key);
  const std::size_t rank = std::min<std::size_t>(2 * outermost / stride, sample.size() - 1);
  std::nth_element(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(rank),
                   sample.end());
  const std::uint32_t n = count_ - sorted_, most = sample[rank];
  KeyedId *const from = items_.data() + sorted_, *const to = scratch_.data() + sorted_;
  const auto chosen =
      sum_chunks<std::uint32_t>(n, chunk, run_, [&](std::uint64_t begin, std::uint64_t end) {
        std::uint32_t count = 0;
        for (std::uint64_t i = begin; i < end; ++i) count += from[i].key <= most ? 1 : 0;
        return count;
      });
  if (sorted_ + chosen.total < wanted) return count_;
  std::copy_n(items_.data(), sorted_, scratch_.data());
  run_.each_chunk(n, chunk, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    std::uint64_t place = chosen.before[c], other = chosen.total + begin - place;
    for (std::uint64_t i = begin; i < end; ++i)
      to[from[i].key <= most ? place++ : other++] = from[i];
  });
  std::swap(items_, scratch_);
  return sorted_ + chosen.total;
}

/// Sorts the items [begin, end) by the low bits of their keys.
void NormOrder::sort(std::uint32_t begin, std::uint32_t end, unsigned bits) {
  KeyedId *items = items_.data() + begin, *other = scratch_.data() + begin;
  radix_sort(items, other, end - begin, bits, run_);
  if (items != items_.data() + begin) std::copy_n(items, end - begin, other);
}

void NormOrder::take_rounds(std::size_t most, std::vector<std::uint32_t>& order,
                            std::vector<std::uint32_t>& ends) {
  const std::size_t before = order.size();
  std::vector<std::uint32_t> bounds{taken_};
  while (bounds.size() <= most && left() > 0) {
    std::uint32_t size = taken_ / 2;
    if (size > left() || left() - size < (taken_ + size) / 2) size = left();
    if (taken_ == 0) size = std::min(first_round, left());
    bounds.push_back(taken_ += size);
    ends.push_back(static_cast<std::uint32_t>(before + taken_ - bounds[0]));
  }
  scratch_.reserve(count_);
  sort_outermost(taken_);
  // Small rounds side by side, if there is enough to share; in a large one the threads sort
  // together.
  const auto arrange_round = [&](std::size_t r) { arrange(bounds[r], bounds[r + 1]); };
  std::size_t small = 0;
  while (small + 1 < bounds.size() && bounds[small + 1] - bounds[small] <= radix_alone) ++small;
  if (bounds[small] - bounds[0] <= radix_alone) small = 0;
  run_.each_item(small, arrange_round);
  for (std::size_t r = small; r + 1 < bounds.size(); ++r) arrange_round(r);
  for (std::uint32_t k = bounds[0]; k < taken_; ++k) order.push_back(items_[k].id);
}

/// Sorts a round, the items [begin, end), along a Hilbert curve through a grid of 16^d cells per
/// point, but at most as many cells as 32-bit keys distinguish. The first of all stays as it is.
void NormOrder::arrange(std::uint32_t begin, std::uint32_t end) {
  if (begin == 0) return;
  KeyedId* const items = items_.data() + begin;
  const unsigned d = points_.dimension, used = std::min(d, 32U);
  const unsigned bits = std::clamp(static_cast<unsigned>(std::bit_width(end - begin)) / d + 4, 1U,
                                   std::clamp(32U / d, 1U, 10U));
  run_.each(end - begin, chunk, [&](std::uint64_t from, std::uint64_t to) {
    const double cells = static_cast<double>(1U << bits);
    std::uint32_t cell[32 * curve_block] = {}, keys[curve_block];
    for (std::uint64_t i = from; i < to; i += curve_block) {
      const std::uint64_t count = std::min<std::uint64_t>(curve_block, to - i);
      for (std::uint64_t k = 0; k < count; ++k) {
        const double* x = points_.row(items[i + k].id);
        for (unsigned j = 0; j < used; ++j) {
          const double place = std::clamp((x[j] * 0.5 + 0.5) * cells, 0.0, cells - 1);
          cell[j * curve_block + k] = static_cast<std::uint32_t>(static_cast<std::int32_t>(place));
        }
      }
      curve_keys(used, bits, cell, keys);
      for (std::uint64_t k = 0; k < count; ++k) items[i + k].key = keys[k];
    }
  });
  sort(begin, end, used * bits);
}

void NormOrder::drop(const std::uint8_t* dropped) {
  std::uint32_t to = taken_, sorted = taken_;
  for (std::uint32_t k = taken_; k < count_; ++k) {
    items_[to] = items_[k];
    to += dropped[k - taken_] == 0;
    if (k + 1 == sorted_) sorted = to;
  }
  sorted_ = sorted_ <= taken_ ? taken_ : sorted;
  count_ = to;
}

}  // namespace cullhull::internal
