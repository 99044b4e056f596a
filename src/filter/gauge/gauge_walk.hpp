// The cones of a polytope's facets from a point inside, and the walk from cone to cone that bounds
// the gauge of any direction (docs/exactness.md, G1 and G2).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "exact/orientation/orientation_3d.hpp"
#include "filter/gauge/gauge_frame.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "filter/gauge/gauge_table.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

// Example in the plane: the centre is 0 and the polytope the square with corners (+-1, +-1). For v
// = (1, 0.5) the facet x = 1 gives v = 0.75 (1, 1) + 0.25 (1, -1): Sum mu = 1, so g(v) <= 1, and v
// is on the boundary. Had the weights come out as 0.7 and 0.25, the rest r = (0.05, 0.05) would be
// reached by L |r|_1 with L = 1: g(v) <= 0.95 + 0.1 = 1.05: a weaker bound, and still a true one.

/// The cones of a polytope's facets. Its frame is y = (x - centre) * scale, scale powers of two,
/// |y| <= 1 on the polytope.
///
/// Correctness does not depend on the facets. For any weights mu >= 0 on input points q that are
/// found for a direction v, the residual r = v - sum mu q is bounded, and
///   g(v) <= sum mu + L |r|_1,   L >= max g(+-e_j),
/// holds for the gauge of the hull of those points. The facets only help to find good weights.
template <unsigned D>
class ConeWalk {
 public:
  /// The polytope must outlive the object.
  explicit ConeWalk(const InnerPolytope& p)
      : p_(p),
        vertex_count_(p.vertices.size() / D),
        facet_count_(static_cast<std::uint32_t>(p.facets.size() / D)),
        step_limit_(256 + static_cast<unsigned>(16 * std::pow(facet_count_, 1.0 / (D - 1)))) {}

  /// Returns false if the centre is not strictly inside in floating point, or coordinates are too
  /// extreme.
  bool prepare() {
    return vertex_count_ >= D + 1 && facet_count_ >= D + 1 && choose_frame() && bound_axes();
  }

  std::uint32_t facet_count() const { return facet_count_; }
  const GaugeFrame<D>& frame() const { return frame_; }
  double lipschitz() const { return frame_.lipschitz(); }
  /// The facet that the ray along an axis meets; side: 2 * axis + (1 if negative).
  std::uint32_t axis_facet(unsigned side) const { return axis_facets_[side]; }

  /// Inverts the matrix of every facet; worthwhile if each facet is visited many times. Returns
  /// false unless all cones have the same orientation, as those of a convex polytope have:
  /// otherwise walks may end at a wrong cone.
  bool invert_facets(unsigned threads) {
    BigArray<double> inverses(std::size_t{facet_count_} * D * D);
    RawArray<Cone> cones;
    cones.reserve(facet_count_);
    std::vector<unsigned> signs(chunk_count(facet_count_, 1024));  // bit 0: positive, bit 1: not
    for_each_chunk(facet_count_, 1024, threads,
                   [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t f = begin; f < end; ++f) {
        double* const inverse = &inverses[f * D * D];
        signs[c] |= invert(static_cast<std::uint32_t>(f), inverse) > 0 ? 1U : 2U;
        for (unsigned i = 0; i < D * D; ++i) cones[f].inverse[i] = static_cast<float>(inverse[i]);
        std::copy_n(&p_.neighbours[f * D], D, cones[f].next);
      }
    });
    inverses_ = std::move(inverses);
    cones_ = std::move(cones);
    unsigned met = 0;
    for (const unsigned s : signs) met |= s;
    return met != 3;
  }

  /// Makes the weights non-negative and bounds the rest of v that they do not reach (exactness.md,
  /// G2).
  GaugeBound bound(std::uint32_t f, const double* v, const double (&mu)[D]) const {
    return frame_.bound(facet(f), v, mu);
  }

  // A negative weight mu_i says that v is on the other side of the ridge opposite to vertex i, so
  // the walk crosses it. Example in the plane: the facet with corners (1, 1) and (1, -1) and v =
  // (0.2, 1): v = 0.6 (1, 1) - 0.4 (1, -1): the second weight is negative, so the walk crosses the
  // ridge that lacks (1, -1), the corner (1, 1), to the facet y = 1.

  /// Walks across ridges with a negative weight to the cone that contains v. By convexity sum mu
  /// grows with every step, except at coplanar facets and by rounding: hence the step limit, and a
  /// random choice of the ridge after half the limit. Returns the best facet visited; `best`
  /// receives its weights.
  std::uint32_t walk(std::uint32_t from, const double* v, double (&best)[D],
                     std::uint64_t& random) const {
    if (cones_.capacity() != 0 && walk_roughly(from, v)) {
      weights(from, v, best);
      return from;
    }
    std::uint32_t best_facet = from;
    double best_lack = std::numeric_limits<double>::infinity();
    std::uint32_t f = from;
    for (unsigned step = 0; step < step_limit_; ++step) {
      double mu[D];
      weights(f, v, mu);
      unsigned lowest = 0;
      double size = 0;
      for (unsigned i = 0; i < D; ++i) {
        if (mu[i] < mu[lowest]) lowest = i;
        size = std::max(size, std::abs(mu[i]));
      }
      const double lack = -mu[lowest];
      if (lack < best_lack || step == 0) {
        best_lack = lack;
        best_facet = f;
        std::copy(mu, mu + D, best);
      }
      if (!(lack > 0x1p-40 * size)) break;  // within rounding: the residual bounds it
      if (2 * step > step_limit_) {
        for (unsigned tries = 0; tries < 4 * D; ++tries) {
          const auto i =
              static_cast<unsigned>((random = random * 6364136223846793005U + 1) >> 33) % D;
          if (mu[i] < 0) {
            lowest = i;
            break;
          }
        }
      }
      f = p_.neighbours[std::size_t{f} * D + lowest];
    }
    return best_facet;
  }

  static constexpr std::uint64_t random_seed = 88172645463325252U;

 private:
  // A walk in f32 may end at a neighbour of the right cone. The bound that is computed from there,
  // in doubles, is then a little larger, since a negative weight is cut to 0 and its rest is paid
  // for with L: still a bound.

  /// The cone over a facet, seen from the centre: what a step of the walk from cone to cone reads,
  /// one to three cache lines. Single precision suffices to find the way: any cone gives a bound.
  struct alignas(64) Cone {
    float inverse[D * D];
    std::uint32_t next[D];
  };

  /// Moves `f` to the cone that contains v, or to a neighbour of it within rounding. Returns false
  /// after 128 steps, far more than a walk from a near start takes; then the caller walks in
  /// doubles.
  bool walk_roughly(std::uint32_t& f, const double* v) const {
    float w[D];
    for (unsigned j = 0; j < D; ++j) w[j] = static_cast<float>(v[j]);
    for (unsigned step = 0; step < 128; ++step) {
      const Cone& cone = cones_[f];
      float lowest = 0, size = 0;
      unsigned at = 0;
      for (unsigned i = 0; i < D; ++i) {
        float mu = 0;
        for (unsigned j = 0; j < D; ++j) mu += cone.inverse[i * D + j] * w[j];
        at = mu < lowest ? i : at;
        lowest = std::min(mu, lowest);
        size = std::max(size, std::abs(mu));
      }
      if (!(-lowest > 0x1p-18F * size)) return true;
      f = cone.next[at];
    }
    return false;
  }

  const std::uint32_t* facet(std::uint32_t f) const { return &p_.facets[std::size_t{f} * D]; }
  const double* point(std::uint32_t v) const { return frame_.point(v); }

  /// Sets the frame around a centre.
  bool set_frame(const double* centre) {
    double reach[D] = {};
    for (std::size_t v = 0; v < vertex_count_; ++v)
      for (unsigned j = 0; j < D; ++j)
        reach[j] = std::max(reach[j], std::abs(p_.vertices[v * D + j] - centre[j]));
    if (!frame_.set(centre, reach, false)) return false;
    frame_.make_room(vertex_count_);
    for (std::size_t v = 0; v < vertex_count_; ++v) frame_.place(v, &p_.vertices[v * D]);
    return true;
  }

  // Any centre strictly inside is right; a deep one makes gauges smooth, so that interpolation
  // loses less. Example: a cap of a sphere whose points crowd at the rim: the mean of the points is
  // near the rim's plane, the centroid of the body is half-way up. An f32 centre lets f32 points be
  // subtracted in f32.

  /// Chooses the centre: the centroid of the polytope (estimated from at most 8,192 of its cones),
  /// which is deep inside even where vertices crowd; it is rounded to f32 if that moves it by at
  /// most 2^-7 of the extent.
  bool choose_frame() {
    double centre[D] = {};
    for (std::size_t v = 0; v < vertex_count_; ++v)
      for (unsigned j = 0; j < D; ++j)
        centre[j] += p_.vertices[v * D + j] / static_cast<double>(vertex_count_);
    if (!set_frame(centre)) return false;
    double shift[D] = {};
    double volume = 0;
    const std::uint32_t stride = 1 + facet_count_ / 8192;
    for (std::uint32_t f = 0; f < facet_count_; f += stride) {
      const double w = std::abs(determinant(f));
      volume += w;
      for (unsigned j = 0; j < D; ++j) {
        double sum = 0;
        for (unsigned i = 0; i < D; ++i) sum += point(facet(f)[i])[j];
        shift[j] += w * sum / (D + 1);
      }
    }
    if (volume > 0)
      for (unsigned j = 0; j < D; ++j) shift[j] /= volume;
    frame_.moved(shift, centre);
    return set_frame(centre);
  }

  double determinant(std::uint32_t f) const {
    if constexpr (D == 3)
      return determinant_3(point(facet(f)[0]), point(facet(f)[1]), point(facet(f)[2]));
    double a[D][D];
    for (unsigned i = 0; i < D; ++i)
      for (unsigned j = 0; j < D; ++j) a[j][i] = point(facet(f)[i])[j];
    double b[D] = {};
    return GaugeFrame<D>::eliminate(a, b);
  }

  /// Solves for the weights of v on the vertices of facet f, positive or not.
  void weights(std::uint32_t f, const double* v, double (&mu)[D]) const {
    if (inverses_.get() != nullptr) {
      const double* row = &inverses_[std::size_t{f} * D * D];
      for (unsigned i = 0; i < D; ++i, row += D) {
        mu[i] = 0;
        for (unsigned j = 0; j < D; ++j) mu[i] += row[j] * v[j];
      }
      return;
    }
    solve(f, v, mu);
  }

  /// Computes the inverse of the matrix whose columns are the facet's vertices; returns its
  /// determinant.
  double invert(std::uint32_t f, double* inverse) const {
    if constexpr (D == 3) {
      const double *a = point(facet(f)[0]), *b = point(facet(f)[1]), *c = point(facet(f)[2]);
      const auto cross = [](const double* u, const double* v, double* out) {
        for (unsigned j = 0; j < 3; ++j)
          out[j] = u[(j + 1) % 3] * v[(j + 2) % 3] - u[(j + 2) % 3] * v[(j + 1) % 3];
      };
      cross(b, c, inverse);
      cross(c, a, inverse + 3);
      cross(a, b, inverse + 6);
      const double det = a[0] * inverse[0] + a[1] * inverse[1] + a[2] * inverse[2];
      if (std::abs(det) > 0x1p-80) {
        for (unsigned i = 0; i < 9; ++i) inverse[i] /= det;
        return det;
      }
    }
    double det = 0;
    for (unsigned j = 0; j < D; ++j) {
      double unit[D] = {};
      unit[j] = 1;
      double column[D];
      det = solve(f, unit, column);
      for (unsigned i = 0; i < D; ++i) inverse[i * D + j] = column[i];
    }
    return det;
  }

  double solve(std::uint32_t f, const double* v, double (&mu)[D]) const {
    return frame_.weights(facet(f), v, mu);
  }

  bool bound_axes() {
    std::uint32_t f = 0;
    std::uint64_t random = random_seed;
    return frame_.bound_axes([&](const double* v, std::uint32_t* ids, double(&mu)[D]) {
      f = walk(f, v, mu, random);
      axis_facets_.push_back(f);
      std::copy_n(facet(f), D, ids);
    });
  }

  const InnerPolytope& p_;
  std::size_t vertex_count_;
  std::uint32_t facet_count_;
  unsigned step_limit_;
  GaugeFrame<D> frame_;
  std::vector<std::uint32_t> axis_facets_;
  BigArray<double> inverses_;  ///< empty, or for each facet the inverse of its vertices' matrix
  RawArray<Cone> cones_;       ///< empty, or the cones of all facets
};

}  // namespace cullhull::internal
