#include "hull/facet_planes_any.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include "predicates/minors.hpp"
#include "predicates/orientation.hpp"

namespace cullhull::internal {
namespace {

/// Beyond this the 2^d minors are too many, and the cofactors come from exact arithmetic.
constexpr unsigned largest_expansion = 12;

class AnyPlanes {
 public:
  explicit AnyPlanes(const PlaneFrame& frame) : frame_(frame), d_(frame.dimension) {
    normal_.resize(d_);
    rows_.resize(d_);
    if (d_ > largest_expansion) return;
    matrix_.resize(std::size_t{d_} * d_);
    det_.resize(std::size_t{1} << d_);
    perm_.resize(std::size_t{1} << d_);
  }

  void plane(const std::uint32_t* v, float* out) {
    for (unsigned i = 0; i < d_; ++i) rows_[i] = frame_.rows + std::size_t{v[i]} * d_;
    double total_error = 0;
    const bool known =
        d_ > largest_expansion ? exact_cofactors(total_error) : expanded_cofactors(total_error);
    if (!known || !scaled(total_error, out)) {
      for (unsigned j = 0; j < d_; ++j) out[j] = 0;
      out[d_] = std::numeric_limits<float>::infinity();
    }
  }

 private:
  bool exact_cofactors(double& total_error) {
    if (!frame_.exact_rows || !plane_exact(d_, rows_.data(), normal_.data())) return false;
    for (const double n : normal_) total_error += 0x1p-50 * std::abs(n) + 0x1p-1000;
    return true;
  }

  bool expanded_cofactors(double& total_error) {
    for (unsigned i = 1; i < d_; ++i)
      for (unsigned j = 0; j < d_; ++j)
        matrix_[std::size_t{i - 1} * d_ + j] = rows_[i][j] - rows_[0][j];
    expand_minors(matrix_.data(), d_, d_ - 1, det_.data(), perm_.data());
    const double factor = (minor_roundings(d_ - 1) + 2) * unit_roundoff;
    const unsigned full = (1U << d_) - 1;
    for (unsigned j = 0; j < d_; ++j) {
      const double minor = det_[full ^ (1U << j)];
      normal_[j] = (j & 1U) != 0 ? -minor : minor;
      total_error += factor * perm_[full ^ (1U << j)] + 0x1p-1000;
    }
    return true;
  }

  /// The same bounds as the vector code's.
  bool scaled(double total_error, float* out) const {
    double size = 0, reached = 0, level = 0;
    for (unsigned j = 0; j < d_; ++j) {
      size += std::abs(normal_[j]);
      reached += std::abs(normal_[j]) * frame_.reach[j];
      level += normal_[j] * (rows_[0][j] - frame_.centre[j]);
    }
    const double bound = 1.0625 * (4 * total_error + (6.0 * d_ + 18) * unit_roundoff * size);
    const double magnitude = std::abs(level);
    if (!(magnitude > 0x1p-900 && magnitude > 8 * bound)) return false;
    const double scale = 1 / level, absolute = std::abs(scale);
    const double error = bound * absolute * (1 + 0x1p-40) +
                         reached * absolute * (d_ + 3) * 0x1p-24 * (1 + 0x1p-10) + 0x1p-120;
    if (!(error <= 0.5 && size * absolute < 0x1p100)) return false;
    for (unsigned j = 0; j < d_; ++j) out[j] = static_cast<float>(normal_[j] * scale);
    out[d_] = static_cast<float>(error * (1 + 0x1p-22));
    return true;
  }

  const PlaneFrame& frame_;
  const unsigned d_;
  std::vector<double> normal_, matrix_, det_, perm_;
  std::vector<const double*> rows_;
};

}  // namespace

void facet_planes_any(const PlaneFrame& frame, const std::uint32_t* facets, std::size_t count,
                      float* planes) {
  AnyPlanes any(frame);
  for (std::size_t i = 0; i < count; ++i)
    any.plane(facets + i * frame.dimension, planes + i * (frame.dimension + 1));
}

}  // namespace cullhull::internal
