// Groups facets within a distance of a common plane: each group grows from its largest facet over
// neighbours.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/simplify.hpp"
#include "parallel/index.hpp"
#include "parallel/sort_few.hpp"
#include "query/hull_arguments.hpp"
namespace cullhull {

namespace {

class Planes {
 public:
  Planes(const PointView& points, const Hull& hull, double distance)
      : hull_(hull),
        d_(hull.dimension),
        ids_(internal::sorted(hull.vertices)),
        rows_(internal::rows_of(points, ids_)),
        scale_(internal::power_to_unit(rows_)),
        distance_(distance * scale_) {
    for (double& x : rows_) x *= scale_;
  }

  std::vector<std::uint32_t> share() const {
    std::vector<std::uint32_t> of(hull_.facet_count(), internal::no_index), reached;
    for (const std::uint32_t seed : largest_first()) {
      if (of[seed] != internal::no_index) continue;
      of[seed] = seed;
      reached.assign(1, seed);
      while (!reached.empty()) {
        const std::uint32_t facet = reached.back();
        reached.pop_back();
        for (const std::uint32_t next : hull_.facet_neighbours[facet]) {
          if (of[next] != internal::no_index || !holds(seed, next)) continue;
          of[next] = seed;
          reached.push_back(next);
        }
      }
    }
    return of;
  }

 private:
  const double* plane(std::uint32_t facet) const {
    return hull_.facet_planes.data() + std::size_t{facet} * (d_ + 1);
  }
  const double* row(std::uint64_t id) const {
    return rows_.data() + internal::place_of(ids_, id) * d_;
  }

  /// Whether the plane of `seed` is certainly within the distance of all vertices of `facet`, and
  /// both face the same side. The error bound is that of a sum of d + 1 terms; the plane's normal
  /// is a unit vector up to rounding.
  bool holds(std::uint32_t seed, std::uint32_t facet) const {
    const double* n = plane(seed);
    const double* other = plane(facet);
    double cosine = 0;
    for (unsigned j = 0; j < d_; ++j) cosine += n[j] * other[j];
    if (!(cosine > 0)) return false;
    const double unit = (d_ + 4) * 0x1p-53, offset = n[d_] * scale_;
    for (const std::uint64_t id : hull_.facets[facet]) {
      const double* x = row(id);
      double value = offset, size = std::fabs(offset);
      for (unsigned j = 0; j < d_; ++j) {
        value += n[j] * x[j];
        size += std::fabs(n[j] * x[j]);
      }
      const double most = (std::fabs(value) + unit * size + 0x1p-1000) * (1 + 4 * unit);
      if (!(most <= distance_)) return false;
    }
    return true;
  }

  /// Facets by descending measure, the lowest number first among equals.
  std::vector<std::uint32_t> largest_first() const {
    std::vector<double> measure(hull_.facet_count(), 0);
    const auto width = static_cast<std::size_t>(hull_.affine_dimension);
    for (std::size_t s = 0; s < hull_.simplex_count(); ++s)
      measure[hull_.simplex_facets[s]] +=
          simplex_measure(hull_.simplices.data() + s * width, width);
    std::vector<std::uint32_t> order(measure.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return measure[a] > measure[b]; });
    return order;
  }

  /// The simplex's measure times a constant: the product of its heights, by orthogonalization.
  double simplex_measure(const std::uint64_t* corners, std::size_t width) const {
    std::vector<double> basis((width - 1) * d_);
    double product = 1;
    for (std::size_t i = 0; i + 1 < width; ++i) {
      double* e = basis.data() + i * d_;
      for (unsigned j = 0; j < d_; ++j) e[j] = row(corners[i + 1])[j] - row(corners[0])[j];
      for (std::size_t k = 0; k < i; ++k) {
        const double* q = basis.data() + k * d_;
        const double along = std::inner_product(e, e + d_, q, 0.0);
        for (unsigned j = 0; j < d_; ++j) e[j] -= along * q[j];
      }
      const double height = std::sqrt(std::inner_product(e, e + d_, e, 0.0));
      product *= height;
      if (height > 0)
        for (unsigned j = 0; j < d_; ++j) e[j] /= height;
    }
    return product;
  }

  const Hull& hull_;
  unsigned d_;
  std::vector<std::uint64_t> ids_;
  std::vector<double> rows_;  // scaled
  double scale_, distance_;
};

}  // namespace

std::vector<std::uint32_t> shared_planes(const PointView& points, const Hull& hull,
                                         double distance) {
  internal::check_hull_arguments(points, hull, distance);
  if (distance > 0 && hull.affine_dimension > 1) return Planes(points, hull, distance).share();
  std::vector<std::uint32_t> own(hull.facet_count());
  std::iota(own.begin(), own.end(), 0U);
  return own;
}

}  // namespace cullhull
