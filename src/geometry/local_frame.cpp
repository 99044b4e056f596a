#include "geometry/local_frame.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <utility>

#include "exact/determinants/determinant_sign.hpp"
#include "exact/determinants/minors.hpp"
#include "exact/determinants/modular.hpp"
#include "exact/numbers/double_parts.hpp"
#include "exact/orientation/difference_products.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/planes/exact_plane.hpp"
#include "geometry/box_of_rows.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/random_stream.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

/// The start simplex is sought first in a sample of this many points, then in all. Any simplex is
/// correct; a wide one makes the engine's first facets better conditioned. Searching all of 1,000
/// points took a tenth of a call in 4D, hence 256. The sample is pseudo-random with a fixed seed,
/// because points at even steps of a grid may all lie in a plane.
constexpr std::uint32_t small_sample = 256, large_sample = 1024, many_points = 1U << 16;

std::vector<std::uint32_t> draw_sample(std::uint32_t count) {
  const std::uint32_t wanted = count < many_points ? small_sample : large_sample;
  std::vector<std::uint32_t> sample(std::min(count, wanted));
  if (count <= wanted) {
    std::iota(sample.begin(), sample.end(), 0U);
    return sample;
  }
  XorShift random;
  for (std::uint32_t& v : sample) v = random.below(count);
  return sample;
}

/// Rows per chunk.
constexpr std::uint64_t sweep = std::uint64_t{1} << 15;

/// Subtracts from r its components along the first `rank` orthonormal rows of `basis`; returns the
/// squared norm of the rest. D: the dimension if known at compile time, else 0.
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

struct Candidate {
  std::uint32_t point;
  double square;
};

/// Returns the first of the points at(begin), ..., at(end - 1) that is farthest from the flat
/// through `origin` spanned by `basis`.
template <unsigned D, class At>
Candidate farthest_row(const double* rows, unsigned dimension, std::uint32_t origin,
                       const double* basis, unsigned rank, std::uint64_t begin, std::uint64_t end,
                       const At& at) {
  const unsigned d = D ? D : dimension;
  const double* o = rows + std::size_t{origin} * d;
  double few[D ? D : 1];
  std::vector<double> many(D ? 0 : d);
  double* r = D ? few : many.data();
  Candidate best{origin, -1};
  for (std::uint64_t i = begin; i < end; ++i) {
    const std::uint32_t point = at(i);
    const double* p = rows + std::size_t{point} * d;
    for (unsigned j = 0; j < d; ++j) r[j] = p[j] - o[j];
    const double square = remove_components<D>(r, d, basis, rank);
    if (square > best.square) best = {point, square};
  }
  return best;
}

/// Returns true only if the filter or the exact rung of `orientation` shows that p[1 .. rank] -
/// p[0] are independent, by a nonzero determinant on the axes that elimination in doubles selects.
/// False proves nothing.
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

LocalFrame::LocalFrame(Array<double>&& rows, std::uint32_t count, unsigned dimension,
                       const Run& run)
    : raw_(std::move(rows)), count_(count), dimension_(dimension), frame_(dimension) {
  if (count == 0) return;
  measure_axes(run);
  find_inexact_axes(run);
  const bool exact =
      std::all_of(frame_.begin(), frame_.end(), [](const Axis& a) { return a.exact; });
  if (exact) {
    scale_rows(raw_, run);
    find_simplex(raw_, run);
    keep_axes(raw_, run);
  } else {
    scaled_ = raw_;
    scale_rows(scaled_, run);
    find_simplex(scaled_, run);
    keep_axes(scaled_, run);
    keep_axes(raw_, run);
  }
  points_.dimension = static_cast<unsigned>(affine_dimension_);
  points_.count = count_;
  points_.exact = raw_.data();
  points_.coordinates = exact ? raw_.data() : scaled_.data();
  if (exact) detect_lattice(run);
}

template <class Body>
void LocalFrame::each_chunk(const Run& run, const Body& body) const {
  run.each_chunk(count_, sweep, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    body(c, begin, end);
  });
}

void LocalFrame::measure_axes(const Run& run) {
  const unsigned d = dimension_;
  const BoxOfRows box = box_of_rows(
      count_, d, [&](std::uint64_t i) { return raw_.data() + i * d; }, run);
  for (unsigned j = 0; j < d; ++j) {
    const double low = box.low[j], high = box.high[j];
    Axis& a = frame_[j];
    a.constant = low == high;
    // Subtraction is exact for numbers of one sign within a factor of two of one another (Sterbenz
    // 1974).
    if (low > 0 && high <= 2 * low) a.shift = low;
    if (high < 0 && low >= 2 * high) a.shift = high;
    const double largest = std::max(std::abs(low - a.shift), std::abs(high - a.shift));
    if (largest > 0) std::frexp(largest, &a.exponent);
  }
}

/// Finds the axes where scaling by 2^-e loses bits because results are below the normal range.
void LocalFrame::find_inexact_axes(const Run& run) {
  const unsigned d = dimension_;
  for (unsigned j = 0; j < d; ++j) {
    Axis& a = frame_[j];
    if (a.exponent <= 0) continue;
    const double safe = std::ldexp(1.0, std::max(-1022 + a.exponent, -1074));
    std::atomic<bool> exact{true};
    each_chunk(run, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      bool small = false;
      for (std::uint64_t i = begin; i < end; ++i) {
        const double v = std::abs(raw_[i * d + j] - a.shift);
        small |= v < safe;
      }
      if (!small) return;
      for (std::uint64_t i = begin; i < end; ++i) {
        const double v = std::abs(raw_[i * d + j] - a.shift);
        if (v != 0 && v < safe && std::ldexp(std::ldexp(v, -a.exponent), a.exponent) != v)
          exact = false;
      }
    });
    a.exact = exact;
  }
}

void LocalFrame::scale_rows(Array<double>& rows, const Run& run) const {
  const unsigned d = dimension_;
  std::vector<double> factor(d), shift(d);
  bool plain = true, identity = true;
  for (unsigned j = 0; j < d; ++j) {
    factor[j] = std::ldexp(1.0, std::clamp(-frame_[j].exponent, -1022, 1022));
    shift[j] = frame_[j].shift;
    plain = plain && std::abs(frame_[j].exponent) <= 1022;
    identity = identity && frame_[j].exponent == 0 && shift[j] == 0;
  }
  if (identity) return;
  each_chunk(run, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
    if (!plain) {
      for (std::uint64_t i = begin; i < end; ++i)
        for (unsigned j = 0; j < d; ++j) {
          double& v = rows[i * d + j];
          v = std::ldexp(v - shift[j], -frame_[j].exponent);
        }
      return;
    }
    with_dimension<2, 4, 0>(d, [&](auto known) {
      const unsigned dimension = known() != 0 ? known() : d;
      for (std::uint64_t i = begin; i < end; ++i) {
        double* p = rows.data() + i * dimension;
        for (unsigned j = 0; j < dimension; ++j) p[j] = (p[j] - shift[j]) * factor[j];
      }
    });
  });
}

// ----------------------------------------------------------------------- the simplex, and flats

std::uint32_t LocalFrame::lowest_row(const Array<double>& scaled, const Run& run) const {
  const unsigned d = dimension_;
  const auto less = [&](std::uint64_t a, std::uint64_t b) {
    const double* p = scaled.data() + a * d;
    const double* q = scaled.data() + b * d;
    for (unsigned j = 0; j < d; ++j)
      if (p[j] != q[j]) return p[j] < q[j];
    return false;
  };
  std::vector<std::uint64_t> first(chunk_count(count_, sweep));
  each_chunk(run, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    std::uint64_t lowest = begin;
    double level = scaled[begin * d];  // skips most rows after one comparison
    for (std::uint64_t i = begin + 1; i < end; ++i) {
      if (scaled[i * d] > level || !less(i, lowest)) continue;
      lowest = i;
      level = scaled[i * d];
    }
    first[c] = lowest;
  });
  std::uint64_t lowest = first[0];
  for (const std::uint64_t i : first)
    if (less(i, lowest)) lowest = i;
  return static_cast<std::uint32_t>(lowest);
}

void LocalFrame::find_simplex(const Array<double>& scaled, const Run& run) {
  const unsigned d = dimension_;
  const auto varying = static_cast<unsigned>(
      std::count_if(frame_.begin(), frame_.end(), [](const Axis& a) { return !a.constant; }));
  const std::uint32_t first = varying > 0 ? lowest_row(scaled, run) : 0;
  simplex_ = {first};
  std::vector<double> basis;  // orthonormal directions, row-major
  const std::vector<std::uint32_t> sample = draw_sample(count_);
  while (simplex_.size() - 1 < varying && simplex_.size() < count_) {
    run.check();
    const auto rank = static_cast<unsigned>(simplex_.size() - 1);
    std::uint32_t next = farthest(scaled, basis, rank, &sample, run);
    if (!independent(next)) {
      next = farthest(scaled, basis, rank, nullptr, run);
      if (!independent(next)) {
        next = independent_by_scan(run);
        if (next == count_) break;  // the points lie in a flat
      }
    }
    simplex_.push_back(next);
    // Gram-Schmidt, twice: rounding affects how good the simplex is, never correctness.
    std::vector<double> r(d);
    for (unsigned j = 0; j < d; ++j)
      r[j] = scaled[std::size_t{next} * d + j] - scaled[std::size_t{first} * d + j];
    remove_components<0>(r.data(), d, basis.data(), rank);
    const double norm = std::sqrt(remove_components<0>(r.data(), d, basis.data(), rank));
    for (unsigned j = 0; j < d; ++j) basis.push_back(norm > 0 ? r[j] / norm : 0);
    thickness_ = std::min(thickness_, norm);
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

std::uint32_t LocalFrame::farthest(const Array<double>& scaled, const std::vector<double>& basis,
                                   unsigned rank, const std::vector<std::uint32_t>* among,
                                   const Run& run) const {
  const auto search = [&](auto dimension, std::uint64_t begin, std::uint64_t end) {
    const auto search_at = [&](const auto& at) {
      return farthest_row<decltype(dimension)::value>(scaled.data(), dimension_, simplex_[0],
                                                      basis.data(), rank, begin, end, at);
    };
    if (among != nullptr) return search_at([&](std::uint64_t i) { return (*among)[i]; });
    return search_at([](std::uint64_t i) { return static_cast<std::uint32_t>(i); });
  };
  const auto search_in = [&](std::uint64_t begin, std::uint64_t end) {
    return with_dimension<2, 6, 0>(dimension_, [&](auto d) { return search(d, begin, end); });
  };
  if (among != nullptr) return search_in(0, among->size()).point;
  std::vector<Candidate> best(chunk_count(count_, sweep));
  each_chunk(run, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    best[c] = search_in(begin, end);
  });
  return std::max_element(
             best.begin(), best.end(),
             [](const Candidate& a, const Candidate& b) { return a.square < b.square; })
      ->point;
}

bool LocalFrame::independent(std::uint32_t candidate) {
  std::vector<const double*> p;
  for (const std::uint32_t v : simplex_) p.push_back(raw_.data() + std::size_t{v} * dimension_);
  p.push_back(raw_.data() + std::size_t{candidate} * dimension_);
  const auto n = static_cast<unsigned>(p.size());
  // In many dimensions an exact rank takes less time than a plane.
  return (!plane_only && n <= ranks_by_primes && surely_independent(dimension_, p.data(), n - 1)) ||
         affine_rank_exact(dimension_, p.data(), n) == n - 1;
}

/// Returns a point off the flat of simplex_, or count_ if there is none; decided exactly.
std::uint32_t LocalFrame::independent_by_scan(const Run& run) {
  const unsigned d = dimension_;
  const auto rank = static_cast<unsigned>(simplex_.size() - 1);
  std::vector<const double*> flat;
  for (const std::uint32_t v : simplex_) flat.push_back(raw_.data() + std::size_t{v} * d);
  std::vector<unsigned> kept(rank);
  affine_rank_exact(d, flat.data(), rank + 1, kept.data());
  // The flat projects one to one onto all of the kept axes, so a point is off the flat exactly if
  // it is off the flat's projection onto the kept axes and one more.
  for (unsigned axis = 0; axis < d; ++axis) {
    if (frame_[axis].constant || std::find(kept.begin(), kept.end(), axis) != kept.end()) continue;
    const auto project = [&](const double* x, double* out) {
      for (unsigned j = 0; j < rank; ++j) out[j] = x[kept[j]];
      out[rank] = x[axis];
    };
    std::atomic<std::uint32_t> found{count_};
    each_chunk(run, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      run.check();
      std::vector<double> projected((rank + 2) * (rank + 1));
      std::vector<const double*> p(rank + 2);
      for (unsigned i = 0; i <= rank + 1; ++i) p[i] = projected.data() + i * (rank + 1);
      for (unsigned i = 0; i <= rank; ++i) project(flat[i], projected.data() + i * (rank + 1));
      // Nearly all points are in the flat, which only integers show: from 4D on those of 128 bits,
      // or a plane's, which is found once for all points.
      OrientedPlane plane;
      if (rank > 2) plane.set(rank + 1, p.data());
      const auto side_of_last = [&] {
        Sign side = Sign::zero;
        if (rank <= 2) return orientation(rank + 1, p.data());
        if (determinant_128(Differences(rank + 1, p.data(), rank + 1), side)) return side;
        return plane.side(p[rank + 1]);
      };
      for (std::uint64_t i = begin; i < end && i < found; ++i) {
        project(raw_.data() + i * d, projected.data() + (rank + 1) * (rank + 1));
        if (side_of_last() == Sign::zero) continue;
        std::uint32_t lowest = found;
        while (i < lowest && !found.compare_exchange_weak(lowest, static_cast<std::uint32_t>(i))) {
        }
      }
    });
    if (found < count_) return found;
  }
  return count_;
}

void LocalFrame::keep_axes(Array<double>& rows, const Run& run) const {
  const unsigned d = dimension_, k = static_cast<unsigned>(affine_dimension_);
  if (k == d) return;
  Array<double> kept(std::size_t{count_} * k);
  each_chunk(run, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i)
      for (unsigned j = 0; j < k; ++j) kept[i * k + j] = rows[i * d + axes_[j]];
  });
  rows = std::move(kept);
}

/// Finds out whether doubles compute determinants without rounding: docs/exactness.md, "Small
/// lattices".
void LocalFrame::detect_lattice(const Run& run) {
  const auto k = static_cast<unsigned>(affine_dimension_);
  if (k < 2 || k > 8) return;
  const int allowed = 53 - factorial_bits[k];
  // |x| <= 1, so differences on a lattice of spacing 2^l are at most 2^(1 - l) spacings.
  std::vector<int> bits(chunk_count(count_, sweep) * k, 0);
  std::atomic<bool> fine{true};
  each_chunk(run, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    int* most = bits.data() + c * k;
    int sum = 0;
    for (std::uint64_t i = begin; i < end; ++i) {
      if (!fine.load(std::memory_order_relaxed)) return;
      for (unsigned j = 0; j < k; ++j) {
        const double v = raw_[i * k + j];
        if (v == 0) continue;
        const int b = 1 - lowest_bit_exponent(v);
        if (b <= most[j]) continue;
        sum += b - most[j];
        most[j] = b;
        if (sum > allowed) fine = false;
      }
    }
  });
  if (!fine) return;
  int sum = 0;
  for (unsigned j = 0; j < k; ++j) {
    int most = 0;
    for (std::size_t at = j; at < bits.size(); at += k) most = std::max(most, bits[at]);
    sum += most;
  }
  points_.small_lattice = sum <= allowed;
}

}  // namespace cullhull::internal
