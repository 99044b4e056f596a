// Building the table: centre, frame, and at every node an upper bound of the gauge.
//
// Nothing here trusts a facet. Whatever weights mu >= 0 on input points q (relative to the centre)
// are found for a direction v, the residual r = v - sum mu q is bounded, and
//   g(v) <= sum mu + L |r|_1,   L >= max g(+-e_j),
// holds for the gauge of the hull of those points. The facets only lead to good weights.

#include "cull/gauge_build.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace cullhull::internal {
namespace {

constexpr double half_ulp = 0x1p-53;
constexpr std::uint32_t none = 0xFFFFFFFFU;

/// Smallest float >= v.
float round_up(double v) {
  const auto f = static_cast<float>(v);
  return static_cast<double>(f) >= v ? f
                                     : std::nextafter(f, std::numeric_limits<float>::infinity());
}

/// Translation and scale: y = x * scale - offset, offset = centre * scale exactly.
struct Frame {
  double centre[GaugeTable::max_dimension];
  double scale[GaugeTable::max_dimension];
};

struct Bound {
  double weight;    ///< at least the sum of the mu
  double residual;  ///< at least |v - sum mu q|_1
};

template <unsigned D>
class Builder {
 public:
  explicit Builder(const InnerPolytope& p)
      : p_(p),
        vertex_count_(p.vertices.size() / D),
        facet_count_(static_cast<std::uint32_t>(p.facets.size() / D)),
        step_limit_(256 + static_cast<unsigned>(16 * std::pow(facet_count_, 1.0 / (D - 1)))) {}

  bool build(unsigned resolution, std::uint32_t most_nodes, GaugeTable& t) {
    if (vertex_count_ < D + 1 || facet_count_ < D + 1) return false;
    if (!choose_frame()) return false;
    if (!bound_axes()) return false;
    // cells x interpolation error: see docs/exactness.md. Beyond a quarter nothing would be culled.
    const double allowance = (1 + 0x1p-40) * lipschitz_ * ((D - 1) * 0x1p-19 + D * 0x1p-23);
    if (!(allowance < 0.25)) return false;
    allowance_ = allowance;

    t.dimension = D;
    t.cells = resolution ? resolution : automatic_cells(most_nodes);
    const std::uint64_t face = power(t.cells + 1, D - 1);
    if (2 * D * face >= (std::uint64_t{1} << 23)) return false;  // the kernel's indices are floats
    t.nodes.resize(2 * D * face);
    fill_constants(t, face);
    if (facet_count_ < t.nodes.size() / (2 * D)) invert_facets();
    fill_nodes(t, face);
    return true;
  }

 private:
  static std::uint64_t power(std::uint64_t base, unsigned e) {
    std::uint64_t r = 1;
    while (e-- > 0) r *= base;
    return r;
  }

  const std::uint32_t* facet(std::uint32_t f) const { return &p_.facets[std::size_t{f} * D]; }
  const double* point(std::uint32_t v) const { return &q_[std::size_t{v} * D]; }

  // ------------------------------------------------------------------------------------- frame

  /// The vertices' bounding box around `frame_.centre` decides the scale; fills q_.
  bool apply_centre() {
    for (unsigned j = 0; j < D; ++j) {
      double reach = 0;
      for (std::size_t v = 0; v < vertex_count_; ++v)
        reach = std::max(reach, std::abs(p_.vertices[v * D + j] - frame_.centre[j]));
      if (!(reach > 0) || !std::isfinite(reach)) return false;
      int exponent = 0;
      std::frexp(reach, &exponent);  // reach < 2^exponent
      frame_.scale[j] = std::ldexp(1.0, std::clamp(-exponent, -1020, 1020));
      const double offset = frame_.centre[j] * frame_.scale[j];
      // An inexact product would shift the centre; only subnormal numbers can do that.
      if (!std::isfinite(offset) || offset / frame_.scale[j] != frame_.centre[j]) return false;
    }
    q_.resize(vertex_count_ * D);
    for (std::size_t v = 0; v < vertex_count_; ++v)
      for (unsigned j = 0; j < D; ++j)
        q_[v * D + j] = (p_.vertices[v * D + j] - frame_.centre[j]) * frame_.scale[j];
    return true;
  }

  /// Centre: the centroid of the polytope (of up to 8192 of its facets' cones), which stays deep
  /// inside however the vertices crowd; then the nearest f32 numbers if they are as good.
  bool choose_frame() {
    for (unsigned j = 0; j < D; ++j) {
      double mean = 0;
      for (std::size_t v = 0; v < vertex_count_; ++v)
        mean += p_.vertices[v * D + j] / static_cast<double>(vertex_count_);
      frame_.centre[j] = mean;
    }
    if (!apply_centre()) return false;
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
    for (unsigned j = 0; j < D; ++j) {
      if (volume > 0) frame_.centre[j] += shift[j] / volume / frame_.scale[j];
      const double single = static_cast<float>(frame_.centre[j]);
      if (std::abs(single - frame_.centre[j]) * frame_.scale[j] <= 0x1p-7)
        frame_.centre[j] = single;
    }
    return apply_centre();
  }

  double determinant(std::uint32_t f) const {
    double a[D][D];
    for (unsigned i = 0; i < D; ++i)
      for (unsigned j = 0; j < D; ++j) a[j][i] = point(facet(f)[i])[j];
    double b[D] = {};
    return eliminate(a, b);
  }

  // ------------------------------------------------------------------------------------ bounds

  /// Gaussian elimination with partial pivoting: solves a x = b into b, returns det a.
  static double eliminate(double (&a)[D][D], double (&b)[D]) {
    double det = 1;
    for (unsigned k = 0; k < D; ++k) {
      unsigned pivot = k;
      for (unsigned r = k + 1; r < D; ++r)
        if (std::abs(a[r][k]) > std::abs(a[pivot][k])) pivot = r;
      if (pivot != k) {
        std::swap(a[pivot], a[k]);
        std::swap(b[pivot], b[k]);
        det = -det;
      }
      det *= a[k][k];
      // A flat cone: any huge solution will lead the walk out of it.
      const double inverse = 1 / (a[k][k] != 0 ? a[k][k] : 0x1p-80);
      a[k][k] = inverse;
      for (unsigned r = k + 1; r < D; ++r) {
        const double factor = a[r][k] * inverse;
        for (unsigned c = k + 1; c < D; ++c) a[r][c] -= factor * a[k][c];
        b[r] -= factor * b[k];
      }
    }
    for (unsigned k = D; k-- > 0;) {
      for (unsigned c = k + 1; c < D; ++c) b[k] -= a[k][c] * b[c];
      b[k] *= a[k][k];
    }
    return det;
  }

  /// Solves for the weights of v on the vertices of facet f, in or out of its cone.
  void weights(std::uint32_t f, const double* v, double (&mu)[D]) const {
    if (!inverses_.empty()) {
      const double* row = &inverses_[std::size_t{f} * D * D];
      for (unsigned i = 0; i < D; ++i, row += D) {
        mu[i] = 0;
        for (unsigned j = 0; j < D; ++j) mu[i] += row[j] * v[j];
      }
      return;
    }
    solve(f, v, mu);
  }

  /// Pays when every facet is met many times.
  void invert_facets() {
    std::vector<double> inverses(std::size_t{facet_count_} * D * D);
    for (std::uint32_t f = 0; f < facet_count_; ++f) {
      for (unsigned j = 0; j < D; ++j) {
        double unit[D] = {};
        unit[j] = 1;
        double column[D];
        solve(f, unit, column);
        for (unsigned i = 0; i < D; ++i) inverses[(std::size_t{f} * D + i) * D + j] = column[i];
      }
    }
    inverses_ = std::move(inverses);
  }

  void solve(std::uint32_t f, const double* v, double (&mu)[D]) const {
    double a[D][D];
    const std::uint32_t* ids = facet(f);
    for (unsigned i = 0; i < D; ++i) {
      const double* q = point(ids[i]);
      for (unsigned j = 0; j < D; ++j) a[j][i] = q[j];
      mu[i] = v[i];
    }
    eliminate(a, mu);
  }

  /// Makes the weights non-negative and bounds what is then missing from v (exactness.md, G2).
  Bound bound(std::uint32_t f, const double* v, const double (&mu)[D]) const {
    double weight = 0;
    double rest[D];
    double size[D];
    for (unsigned j = 0; j < D; ++j) rest[j] = v[j], size[j] = std::abs(v[j]);
    const std::uint32_t* ids = facet(f);
    for (unsigned i = 0; i < D; ++i) {
      const double m = mu[i] > 0 ? mu[i] : 0;
      const double* q = point(ids[i]);
      weight += m;
      for (unsigned j = 0; j < D; ++j) {
        rest[j] -= m * q[j];
        size[j] += m * std::abs(q[j]);
      }
    }
    double residual = 0;
    for (unsigned j = 0; j < D; ++j)
      residual += std::abs(rest[j]) + (2 * D + 8) * half_ulp * size[j];
    return {weight * (1 + 0x1p-49), residual + (1 + weight) * 0x1p-1000};
  }

  /// Walks over the ridges whose weight is negative to the cone that holds v. Convexity makes
  /// sum mu grow from step to step, but for coplanar facets and rounding: hence the step limit
  /// and the choice at random after the first half. Returns the best facet met.
  std::uint32_t walk(std::uint32_t from, const double* v, double (&best)[D]) {
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
      if (!(lack > 0x1p-40 * size)) break;  // rounding only: the residual accounts for it
      if (2 * step > step_limit_) {
        for (unsigned tries = 0; tries < 4 * D; ++tries) {
          const auto i =
              static_cast<unsigned>((random_ = random_ * 6364136223846793005U + 1) >> 33) % D;
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

  /// L: no point of the unit 1-norm ball has a larger gauge (exactness.md, G1).
  bool bound_axes() {
    double weight = 0;
    double residual = 0;
    std::uint32_t f = 0;
    for (unsigned j = 0; j < 2 * D; ++j) {
      double v[D] = {};
      v[j / 2] = j % 2 ? -1 : 1;
      double mu[D] = {};
      f = walk(f, v, mu);
      const Bound b = bound(f, v, mu);
      if (!(b.residual < 0.5) || !(b.weight < 0x1p20)) return false;
      weight = std::max(weight, b.weight);
      residual = std::max(residual, b.residual);
    }
    lipschitz_ = weight / (1 - residual) * (1 + 0x1p-49);
    return true;
  }

  // ------------------------------------------------------------------------------------- table

  /// Nodes in proportion to facets, the fewest where more would keep hardly fewer points
  /// (measured on balls), the most a share of L2.
  unsigned automatic_cells(std::uint32_t most_nodes) const {
    struct Rule {
      double per_facet;
      double least, most;
    };
    static constexpr Rule rules[] = {{16, 512, 16384},
                                     {6, 1536, 65536},
                                     {1, 5832, 65536},
                                     {0.6, 6250, 65536},
                                     {0.25, 12288, 65536}};
    const Rule& rule = rules[D - 2];
    const double most = most_nodes > 0 ? std::min<double>(most_nodes, rule.most) : rule.most;
    const double nodes =
        std::clamp(rule.per_facet * facet_count_, rule.least, std::max(rule.least, most));
    const double edge = std::pow(nodes / (2 * D), 1.0 / (D - 1));
    unsigned cells = std::max(2U, static_cast<unsigned>(edge + 0.5) - 1);
    while (most_nodes > 0 && cells > 2 && 2 * D * power(cells + 1, D - 1) > most_nodes) --cells;
    return cells;
  }

  void fill_constants(GaugeTable& t, std::uint64_t face) const {
    t.single_precision = true;
    for (unsigned j = 0; j < D; ++j) {
      t.scale[j] = frame_.scale[j];
      t.offset[j] = frame_.centre[j] * frame_.scale[j];
      t.scale_f32[j] = static_cast<float>(t.scale[j]);
      t.offset_f32[j] = static_cast<float>(t.offset[j]);
      t.single_precision = t.single_precision && t.scale[j] >= 0x1p-120 && t.scale[j] <= 0x1p120 &&
                           static_cast<double>(t.offset_f32[j]) == t.offset[j];
    }
    t.middle = static_cast<float>(t.cells) / 2;
    t.half_cells = t.middle * (1 - 0x1p-20F);
    std::uint64_t corners = 0;
    for (unsigned k = 0; k + 1 < D; ++k) {
      const std::uint64_t stride = power(t.cells + 1, k);
      t.stride[k] = static_cast<float>(stride);
      corners += stride;
    }
    t.face_stride = static_cast<float>(face);
    t.last_corner = static_cast<std::uint32_t>(2 * D * face - 1 - corners);
    t.threshold = 1 - (D + 6) * 0x1p-23F;
  }

  /// A node is (+-cells on the face's axis, 2 i - cells on the others) / cells; the walk works on
  /// the integers.
  void fill_nodes(GaugeTable& t, std::uint64_t face) {
    std::uint32_t f = 0;
    for (unsigned side = 0; side < 2 * D; ++side) {
      double v[D];
      v[side / 2] = side % 2 ? -1.0 : 1.0;
      v[side / 2] *= t.cells;
      f = fill_axis(t, t.nodes.data() + side * face, face, side / 2, D - 1, v, f);
    }
  }

  /// Fills the sub-grid of the lowest `axes` grid axes; neighbouring nodes start from each other's
  /// facets. Returns the facet of its first node.
  std::uint32_t fill_axis(const GaugeTable& t, float* nodes, std::uint64_t size, unsigned skip,
                          unsigned axes, double (&v)[D], std::uint32_t from) {
    if (axes == 0) {
      double mu[D] = {};
      const std::uint32_t f = walk(from, v, mu);
      const Bound b = bound(f, v, mu);
      double norm = 0;
      for (unsigned j = 0; j < D; ++j) norm += std::abs(v[j]);
      const double fallback = lipschitz_ * norm;
      double g = b.weight + lipschitz_ * b.residual;
      if (!(g < fallback)) g = fallback;  // also when g is NaN
      *nodes = round_up((g / t.cells + allowance_) * (1 + 0x1p-49));
      return f;
    }
    const unsigned axis = axes - 1 < skip ? axes - 1 : axes;
    const std::uint64_t part = size / (t.cells + 1);
    std::uint32_t first = none;
    for (unsigned i = 0; i <= t.cells; ++i) {
      v[axis] = 2.0 * i - t.cells;
      from = fill_axis(t, nodes + i * part, part, skip, axes - 1, v, from);
      if (i == 0) first = from;
    }
    return first;
  }

  const InnerPolytope& p_;
  std::size_t vertex_count_;
  std::uint32_t facet_count_;
  unsigned step_limit_;
  Frame frame_{};
  std::vector<double> q_;         ///< vertices in the frame
  std::vector<double> inverses_;  ///< empty, or of each facet's matrix of vertices
  double lipschitz_ = 0;
  double allowance_ = 0;
  std::uint64_t random_ = 88172645463325252U;
};

}  // namespace

bool build_gauge_table(const InnerPolytope& polytope, unsigned resolution, std::uint32_t most_nodes,
                       GaugeTable& table) {
  switch (polytope.dimension) {
    case 2:
      return Builder<2>(polytope).build(resolution, most_nodes, table);
    case 3:
      return Builder<3>(polytope).build(resolution, most_nodes, table);
    case 4:
      return Builder<4>(polytope).build(resolution, most_nodes, table);
    case 5:
      return Builder<5>(polytope).build(resolution, most_nodes, table);
    case 6:
      return Builder<6>(polytope).build(resolution, most_nodes, table);
    default:
      return false;
  }
}

}  // namespace cullhull::internal
