#include <cmath>
#include <limits>
#include <vector>

#include "exact/determinants/minors.hpp"
#include "exact/planes/eliminated_plane.hpp"
#include "hull/general/facet_planes.hpp"

namespace cullhull::internal::inline hull {
namespace {

class AnyPlanes {
 public:
  explicit AnyPlanes(const PlaneFrame& frame)
      : frame_(frame), d_(frame.dimension), normal_(d_), rows_(d_) {}

  void plane(const std::uint32_t* v, float* out) {
    for (unsigned i = 0; i < d_; ++i) rows_[i] = frame_.rows + std::size_t{v[i]} * d_;
    // Rows that are off by 2^-1074 are covered by the terms for underflow, unless scaled up by
    // much.
    const bool known =
        plane_.set(d_, rows_.data()) && (frame_.exact_rows || plane_.largest_scale() < 0x1p50);
    if (known && scaled(out)) return;
    for (unsigned j = 0; j < d_; ++j) out[j] = 0;
    out[d_] = std::numeric_limits<float>::infinity();
  }

 private:
  /// Scales the plane, with the bounds of the vector code.
  bool scaled(float* out) {
    double size = 0, reached = 0, level = 0, total_error = 0;
    for (unsigned j = 0; j < d_; ++j) {
      normal_[j] = plane_.normal(j);
      total_error += plane_.error(j) * (1 + 0x1p-40) + 0x1p-1000;
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
  EliminatedPlane plane_;
  std::vector<double> normal_;
  std::vector<const double*> rows_;
};

}  // namespace

void facet_planes_any(const PlaneFrame& frame, const std::uint32_t* facets, std::size_t count,
                      float* planes) {
  AnyPlanes any(frame);
  for (std::size_t i = 0; i < count; ++i)
    any.plane(facets + i * frame.dimension, planes + i * (frame.dimension + 1));
}

}  // namespace cullhull::internal::inline hull
