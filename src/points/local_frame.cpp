#include "points/local_frame.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "predicates/orientation.hpp"

namespace cullhull::internal {
namespace {

/// Points looked at before all of them are, when the simplex is chosen: any choice is right, a wide
/// simplex only makes the engine's first facets better conditioned.
constexpr std::uint32_t simplex_sample = 1024;

/// Exponent of the lowest set bit; v must not be zero.
int lowest_bit_exponent(double v) {
  const auto bits = std::bit_cast<std::uint64_t>(v);
  const int biased = static_cast<int>((bits >> 52) & 0x7FF);
  std::uint64_t m = bits & ((std::uint64_t{1} << 52) - 1);
  if (biased != 0) m |= std::uint64_t{1} << 52;
  return (biased != 0 ? biased - 1075 : -1074) + std::countr_zero(m);
}

/// Takes from r its components along the first `rank` of the orthonormal rows of `basis`; the
/// square of what is left. D: the dimension where it is known early, else 0.
template <unsigned D>
double remove_components(double* r, unsigned dimension, const double* basis, unsigned rank) {
  const unsigned d = D ? D : dimension;
  for (unsigned b = 0; b < rank; ++b) {
    double dot = 0;
    for (unsigned j = 0; j < d; ++j) dot += r[j] * basis[b * d + j];
    for (unsigned j = 0; j < d; ++j) r[j] -= dot * basis[b * d + j];
  }
  double square = 0;
  for (unsigned j = 0; j < d; ++j) square += r[j] * r[j];
  return square;
}

/// The point (every `stride`-th of them) farthest from the flat through `origin` along `basis`.
template <unsigned D>
std::uint32_t farthest_row(const double* rows, std::uint32_t count, unsigned dimension,
                           std::uint32_t origin, const double* basis, unsigned rank,
                           std::uint32_t stride) {
  const unsigned d = D ? D : dimension;
  const double* o = rows + std::size_t{origin} * d;
  double few[D ? D : 1];
  std::vector<double> many(D ? 0 : d);
  double* r = D ? few : many.data();
  double best = -1;
  std::uint32_t best_point = origin;
  for (std::uint64_t i = 0; i < count; i += stride) {
    const double* p = rows + i * d;
    for (unsigned j = 0; j < d; ++j) r[j] = p[j] - o[j];
    const double square = remove_components<D>(r, d, basis, rank);
    if (square > best) {
      best = square;
      best_point = static_cast<std::uint32_t>(i);
    }
  }
  return best_point;
}

/// Whether doubles and `orientation` can tell that p[1 .. rank] - p[0] are independent: on the axes
/// that elimination in doubles chooses they must have a determinant. False means nothing.
bool surely_independent(unsigned d, const double* const* p, unsigned rank) {
  std::vector<double> m(std::size_t{rank} * d);
  for (unsigned i = 0; i < rank; ++i)
    for (unsigned j = 0; j < d; ++j) m[std::size_t{i} * d + j] = p[i + 1][j] - p[0][j];
  std::vector<unsigned> axes(d);
  for (unsigned j = 0; j < d; ++j) axes[j] = j;
  for (unsigned r = 0; r < rank && rank < d; ++r) {
    double* row = m.data() + std::size_t{r} * d;
    for (unsigned j = r + 1; j < d; ++j)
      if (std::abs(row[axes[j]]) > std::abs(row[axes[r]])) std::swap(axes[j], axes[r]);
    const double pivot = row[axes[r]];
    if (!(std::abs(pivot) > 0)) return false;
    for (unsigned i = r + 1; i < rank; ++i) {
      double* other = m.data() + std::size_t{i} * d;
      const double factor = other[axes[r]] / pivot;
      for (unsigned j = r; j < d; ++j) other[axes[j]] -= factor * row[axes[j]];
    }
  }
  std::vector<double> packed(std::size_t{rank + 1} * rank);
  std::vector<const double*> rows(rank + 1);
  for (unsigned i = 0; i <= rank; ++i) {
    rows[i] = packed.data() + std::size_t{i} * rank;
    for (unsigned j = 0; j < rank; ++j) packed[std::size_t{i} * rank + j] = p[i][axes[j]];
  }
  return orientation(rank, rows.data()) != Sign::zero;
}

}  // namespace

LocalFrame::LocalFrame(std::vector<double>&& rows, std::uint32_t count, unsigned dimension,
                       const Control& control)
    : control_(control),
      raw_(std::move(rows)),
      count_(count),
      dimension_(dimension),
      frame_(dimension) {
  if (count == 0) return;
  measure_axes();
  const bool exact =
      std::all_of(frame_.begin(), frame_.end(), [](const Axis& a) { return a.exact; });
  if (exact) {
    scale_rows(raw_);
    find_simplex(raw_);
    keep_axes(raw_);
  } else {
    scaled_ = raw_;
    scale_rows(scaled_);
    find_simplex(scaled_);
    keep_axes(scaled_);
    keep_axes(raw_);
  }
  points_.dimension = static_cast<unsigned>(affine_dimension_);
  points_.count = count_;
  points_.exact = raw_.data();
  points_.coordinates = exact ? raw_.data() : scaled_.data();
  if (exact) detect_lattice();
}

void LocalFrame::measure_axes() {
  const unsigned d = dimension_;
  std::vector<double> low(raw_.begin(), raw_.begin() + d), high = low;
  for (std::uint32_t i = 1; i < count_; ++i) {
    const double* p = raw_.data() + std::size_t{i} * d;
    for (unsigned j = 0; j < d; ++j) {
      low[j] = std::min(low[j], p[j]);
      high[j] = std::max(high[j], p[j]);
    }
  }
  for (unsigned j = 0; j < d; ++j) {
    Axis& a = frame_[j];
    a.constant = low[j] == high[j];
    // Within a factor of two of one another and of one sign, subtraction is exact (Sterbenz 1974).
    if (low[j] > 0 && high[j] <= 2 * low[j]) a.shift = low[j];
    if (high[j] < 0 && low[j] >= 2 * high[j]) a.shift = high[j];
    const double largest = std::max(std::abs(low[j] - a.shift), std::abs(high[j] - a.shift));
    if (largest > 0) std::frexp(largest, &a.exponent);
  }
  // Scaling by 2^-e loses bits only where the result falls below the normal range.
  for (unsigned j = 0; j < d; ++j) {
    Axis& a = frame_[j];
    if (a.exponent <= 0) continue;
    const double safe = std::ldexp(1.0, std::max(-1022 + a.exponent, -1074));
    for (std::uint32_t i = 0; i < count_ && a.exact; ++i) {
      const double v = std::abs(raw_[std::size_t{i} * d + j] - a.shift);
      if (v != 0 && v < safe) a.exact = std::ldexp(std::ldexp(v, -a.exponent), a.exponent) == v;
    }
  }
}

void LocalFrame::scale_rows(std::vector<double>& rows) const {
  const unsigned d = dimension_;
  std::vector<double> factor(d), shift(d);
  bool plain = true;
  for (unsigned j = 0; j < d; ++j) {
    factor[j] = std::ldexp(1.0, std::clamp(-frame_[j].exponent, -1022, 1022));
    shift[j] = frame_[j].shift;
    plain = plain && std::abs(frame_[j].exponent) <= 1022;
  }
  for (std::uint32_t i = 0; i < count_; ++i) {
    double* p = rows.data() + std::size_t{i} * d;
    if (plain) {
      for (unsigned j = 0; j < d; ++j) p[j] = (p[j] - shift[j]) * factor[j];
    } else {
      for (unsigned j = 0; j < d; ++j) p[j] = std::ldexp(p[j] - shift[j], -frame_[j].exponent);
    }
  }
}

// ----------------------------------------------------------------------- the simplex, and flats

void LocalFrame::find_simplex(const std::vector<double>& scaled) {
  const unsigned d = dimension_;
  const auto varying = static_cast<unsigned>(
      std::count_if(frame_.begin(), frame_.end(), [](const Axis& a) { return !a.constant; }));
  std::uint32_t first = 0;
  for (std::uint32_t i = 1; i < count_ && varying > 0; ++i) {
    const double* p = scaled.data() + std::size_t{i} * d;
    if (std::lexicographical_compare(p, p + d, scaled.data() + std::size_t{first} * d,
                                     scaled.data() + std::size_t{first} * d + d))
      first = i;
  }
  simplex_ = {first};
  std::vector<double> basis;  // orthonormal directions, row-major
  while (simplex_.size() - 1 < varying) {
    control_.check();
    const auto rank = static_cast<unsigned>(simplex_.size() - 1);
    std::uint32_t next = farthest(scaled, basis, rank, std::max(1U, count_ / simplex_sample));
    if (!independent(next)) {
      next = farthest(scaled, basis, rank, 1);
      if (!independent(next)) {
        next = independent_by_scan();
        if (next == count_) break;  // the points lie in a flat
      }
    }
    simplex_.push_back(next);
    // Gram-Schmidt, twice: rounding here costs quality of the choice, never correctness.
    std::vector<double> r(d);
    for (unsigned j = 0; j < d; ++j)
      r[j] = scaled[std::size_t{next} * d + j] - scaled[std::size_t{first} * d + j];
    remove_components<0>(r.data(), d, basis.data(), rank);
    const double norm = std::sqrt(remove_components<0>(r.data(), d, basis.data(), rank));
    for (unsigned j = 0; j < d; ++j) basis.push_back(norm > 0 ? r[j] / norm : 0);
  }
  affine_dimension_ = static_cast<int>(simplex_.size()) - 1;
  if (affine_dimension_ == static_cast<int>(d)) {
    axes_.resize(d);
    std::iota(axes_.begin(), axes_.end(), 0U);
    return;
  }
  std::vector<const double*> p;
  for (const std::uint32_t v : simplex_) p.push_back(raw_.data() + std::size_t{v} * d);
  axes_.resize(static_cast<std::size_t>(affine_dimension_));
  affine_rank_exact(d, p.data(), static_cast<unsigned>(p.size()), axes_.data());
}

std::uint32_t LocalFrame::farthest(const std::vector<double>& scaled,
                                   const std::vector<double>& basis, unsigned rank,
                                   std::uint32_t stride) const {
  const auto run = [&](auto search) {
    return search(scaled.data(), count_, dimension_, simplex_[0], basis.data(), rank, stride);
  };
  switch (dimension_) {
    case 2:
      return run(farthest_row<2>);
    case 3:
      return run(farthest_row<3>);
    case 4:
      return run(farthest_row<4>);
    default:
      return run(farthest_row<0>);
  }
}

bool LocalFrame::independent(std::uint32_t candidate) {
  std::vector<const double*> p;
  for (const std::uint32_t v : simplex_) p.push_back(raw_.data() + std::size_t{v} * dimension_);
  p.push_back(raw_.data() + std::size_t{candidate} * dimension_);
  const auto n = static_cast<unsigned>(p.size());
  return surely_independent(dimension_, p.data(), n - 1) ||
         affine_rank_exact(dimension_, p.data(), n) == n - 1;
}

/// Some point off the flat of simplex_, or count_ if there is none: exact for every point.
std::uint32_t LocalFrame::independent_by_scan() {
  const unsigned d = dimension_;
  const auto rank = static_cast<unsigned>(simplex_.size() - 1);
  std::vector<const double*> flat;
  for (const std::uint32_t v : simplex_) flat.push_back(raw_.data() + std::size_t{v} * d);
  std::vector<unsigned> kept(rank);
  affine_rank_exact(d, flat.data(), rank + 1, kept.data());
  // On the kept axes the flat is all of the space, so a point is off it exactly if it is so on the
  // kept axes and one more.
  std::vector<double> projected((rank + 2) * (rank + 1));
  std::vector<const double*> p(rank + 2);
  for (unsigned axis = 0; axis < d; ++axis) {
    if (frame_[axis].constant || std::find(kept.begin(), kept.end(), axis) != kept.end()) continue;
    const auto project = [&](const double* x, unsigned row) {
      double* out = projected.data() + row * (rank + 1);
      for (unsigned j = 0; j < rank; ++j) out[j] = x[kept[j]];
      out[rank] = x[axis];
      p[row] = out;
    };
    for (unsigned i = 0; i <= rank; ++i) project(flat[i], i);
    for (std::uint32_t i = 0; i < count_; ++i) {
      if (i % 1024 == 0) control_.check();
      project(raw_.data() + std::size_t{i} * d, rank + 1);
      if (orientation(rank + 1, p.data()) != Sign::zero) return i;
    }
  }
  return count_;
}

void LocalFrame::keep_axes(std::vector<double>& rows) const {
  const unsigned d = dimension_, k = static_cast<unsigned>(affine_dimension_);
  if (k == d) return;
  for (std::uint32_t i = 0; i < count_; ++i)
    for (unsigned j = 0; j < k; ++j)  // axes ascend, so nothing is overwritten before it is read
      rows[std::size_t{i} * k + j] = rows[std::size_t{i} * d + axes_[j]];
  rows.resize(std::size_t{count_} * k);
  rows.shrink_to_fit();
}

/// docs/exactness.md, "Small lattices": whether doubles compute determinants without rounding.
void LocalFrame::detect_lattice() {
  const auto k = static_cast<unsigned>(affine_dimension_);
  if (k < 2 || k > 8) return;
  constexpr int factorial_bits[] = {0, 0, 1, 3, 5, 7, 10, 13, 16};
  const int allowed = 53 - factorial_bits[k];
  // |x| <= 1, so differences on a lattice of spacing 2^l are at most 2^(1 - l) spacings.
  std::vector<int> bits(k, 0);
  int sum = 0;
  for (std::uint32_t i = 0; i < count_; ++i)
    for (unsigned j = 0; j < k; ++j) {
      const double v = raw_[std::size_t{i} * k + j];
      if (v == 0) continue;
      const int b = 1 - lowest_bit_exponent(v);
      if (b <= bits[j]) continue;
      sum += b - bits[j];
      bits[j] = b;
      if (sum > allowed) return;
    }
  points_.small_lattice = true;
  // Rows scaled by k + 1, seen from a sum of k + 1 points, are larger by that factor.
  points_.centroid_lattice = sum + static_cast<int>(k * std::bit_width(k)) <= allowed;
}

}  // namespace cullhull::internal
