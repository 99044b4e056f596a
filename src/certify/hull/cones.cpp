#include "certify/hull/cones.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "exact/determinants/minors.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal::certify {
namespace {

constexpr double u = unit_roundoff;
constexpr double infinity = std::numeric_limits<double>::infinity();

template <unsigned K>
double dot(const double* n, const double* y) {
  double sum = 0;
  for (unsigned j = 0; j < K; ++j) sum += n[j] * y[j];
  return sum;
}

}  // namespace

void Cones::place() {
  drop();
  centre_ = s_.centre;
  if (centre_.empty() || k_ < 2 || k_ > max_dimension || !choose_units()) return;
  planes_.resize(std::size_t{s_.simplex_count()} * (k_ + 1));
  with_dimension<2, 7, 8>(k_, [this](auto k) { build<k>(); });
}

/// Chooses powers of two that scale every vertex to within 1 of the centre on each axis; false if
/// out of range.
bool Cones::choose_units() {
  scale_.clear();
  reach_.clear();
  for (unsigned j = 0; j < k_; ++j) {
    // Of all vertices, since rounding keeps the order of differences.
    const double extent =
        std::max(s_.high[s_.axis(j)] - centre_[j], centre_[j] - s_.low[s_.axis(j)]);
    if (!(extent > 0x1p-500 && extent < 0x1p500)) return false;
    scale_.push_back(std::exp2(-std::ilogb(extent) - 1));
    reach_.push_back(extent * scale_.back());
  }
  return true;
}

template <unsigned K>
void Cones::build() {
  constexpr std::uint64_t chunk = std::uint64_t{1} << 12;  // tens of us of work
  std::vector<double> longest(chunk_count(s_.simplex_count(), chunk), 0);
  check_chunks(s_.run, s_.simplex_count(), chunk, [&](std::uint64_t begin, std::uint64_t end) {
    double most = 0;
    for (std::uint64_t i = begin; i < end; ++i) {
      const auto f = static_cast<std::uint32_t>(i);
      double* out = plane(f);
      if (!build_plane<K>(f, out)) {
        for (unsigned j = 0; j < K; ++j) out[j] = 0;
        out[K] = infinity;
      }
      double square = 0;
      for (unsigned j = 0; j < K; ++j) square += out[j] * out[j];
      most = std::max(most, std::sqrt(square) + 2 * out[K]);
    }
    longest[begin / chunk] = most;
  });
  // A lower bound of the planes' distances from the centre. The exact plane differs from n by at
  // most twice its bound, since the reach of an axis is at least 1/2.
  const double radius = (1 - 0x1p-40) / *std::max_element(longest.begin(), longest.end());
  ball_ = radius * radius * (1 - 0x1p-40);
}

/// False if rounding leaves the side of the centre or the plane's distance undecided.
template <unsigned K>
bool Cones::build_plane(std::uint32_t f, double* out) const {
  constexpr double roundings = minor_roundings(K > 1 ? K - 1 : 1) + 3;
  const std::uint32_t* v = s_.simplex(f);
  double edges[K - 1][K], n[K], spread[K], w[K];
  for (unsigned j = 0; j < K; ++j) {
    const double p = s_.row(v[0])[j];
    w[j] = (p - centre_[j]) * scale_[j];
    for (unsigned r = 1; r < K; ++r) edges[r - 1][j] = (s_.row(v[r])[j] - p) * scale_[j];
  }
  normal_and_spread<K>(edges, n, spread);
  double height = 0, lost = 0;
  for (unsigned j = 0; j < K; ++j) {
    spread[j] = roundings * u * spread[j] + 0x1p-1000;
    height += n[j] * w[j];
    lost += spread[j] * std::fabs(w[j]) + (K + 3) * u * std::fabs(n[j] * w[j]);
  }
  lost *= 1.01;
  if (!(height > 0x1p-900 && lost < height / 2)) return false;
  const double relative = lost / (height - lost);
  double bound = 0x1p-900;
  for (unsigned j = 0; j < K; ++j) {
    out[j] = n[j] / height;
    const double off = (spread[j] + (std::fabs(n[j]) + spread[j]) * relative) / height +
                       (K + 5) * u * std::fabs(out[j]);
    bound += off * reach_[j];
  }
  out[K] = 1.02 * bound;
  return out[K] < 0.125;
}

template <unsigned K>
bool Cones::strictly_inside_in(const double* y, std::uint32_t& f) const {
  double own = dot<K>(plane(f), y);
  for (unsigned step = 0; step < 4096; ++step) {
    const std::uint32_t* across = s_.hull.simplex_neighbours.data() + std::size_t{f} * K;
    std::uint32_t best = f;
    double most = own, beside = -infinity;
    for (unsigned j = 0; j < K; ++j) {
      const double* h = plane(across[j]);
      const double value = dot<K>(h, y);
      beside = std::max(beside, value + h[K]);
      if (value > most) {
        most = value;
        best = across[j];
      }
    }
    if (best == f) {
      const double bound = plane(f)[K];
      return beside < own - bound && own + bound < 1;
    }
    f = best;
    own = most;
  }
  return false;
}

bool Cones::strictly_inside(const double* y, std::uint32_t& f) const {
  return with_dimension<2, 7, 8>(k_, [&](auto k) { return strictly_inside_in<k>(y, f); });
}

double Cones::value(std::uint32_t f, const double* y) const {
  double sum = 0;
  for (unsigned j = 0; j < k_; ++j) sum += plane(f)[j] * y[j];
  return sum;
}

}  // namespace cullhull::internal::certify
