// Why the core drops nothing that the map would keep. With weights 1 <= omega <= 8 let nu be one of
// four norms: the root of Sum (omega_j y_j)^2, the largest omega_j |y_j|, the sum of all of them
// but the least, the sum of all. Each is at least |y|_inf. F is what the map interpolates, linear
// on simplices of nodes. For a cell, or a part of it, let u be a linear function that is nowhere
// above nu (the tangent at its middle), and r <= t u(v) / F(v) at all of its corners v, t = 1 -
// delta. As both are linear between corners, r F(z) <= t u(z) for every z in the cell. Let z be the
// place that the map computes for y: |z - y / a|_inf <= 2^-19 by G3, and |u|_1 <= 8 d <= 48, as
// u(+-e_j) <= nu(e_j) = omega_j. So
//
//   u(z) <= nu(y) / a + 48 * 2^-19 <= (1 + 2^-13) nu(y) / a.
//
// From nu(y) < (1 - 2^-12) r follows a F(z) <= t a u(z) / r < (1 - 2^-12)(1 + 2^-13) t < (1 -
// 2^-14) t, and what the map computes is at most that times (1 + w)^(d+2): below t. The difference
// between 2^-14 and 0 covers the rounding of F, u, r, and of nu in f32 (terms >= 0: below 2^-19;
// the sum but the least is at least half of the sum). Radii exceed 2^-20, so no square matters that
// underflows; for a < 2^-100 the map drops whatever F is.
//
// The ellipsoid has r = the least over all cells. The box has three norms, and of each cell only
// one need reach: y in the box has all three below their radii. So the first and the last radius
// may be anything if the middle one is within reach of all cells where neither of the two is. A NaN
// makes the sums NaN, an infinity makes them infinite or NaN: such points are not in the core.
//
// Example: a core of 0.95 of a ball's radius spares 0.95^3 = 86 % of its points the look-up.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "filter/gauge/gauge_build.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {
namespace {

/// Returns the values that a 3D map interpolates, at the corners of parts x parts parts of each
/// cell of a face: (cells * parts + 1)^2 values.
std::vector<double> values_on_face(const GaugeTable& t, unsigned face, std::uint32_t parts) {
  const std::uint32_t cells = t.cells * parts, row = t.cells + 1;
  const float* nodes = t.nodes.data() + std::size_t{face} * row * row;
  std::vector<double> values(std::size_t{cells + 1} * (cells + 1));
  std::size_t at = 0;
  for (std::uint32_t j = 0; j <= cells; ++j)
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const std::uint32_t ci = std::min(i / parts, t.cells - 1),
                          cj = std::min(j / parts, t.cells - 1);
      const float* g = nodes + std::size_t{cj} * row + ci;
      const double u = static_cast<double>(i - ci * parts) / parts;
      const double v = static_cast<double>(j - cj * parts) / parts;
      const double low = std::min(u, v), high = std::max(u, v);
      const double between = u > v ? g[1] : g[row];
      values[at++] = (1 - high) * g[0] + (high - low) * between + low * g[row + 1];
    }
  return values;
}

/// Covers the distance between the point's direction and the place where the map is read, and all
/// rounding (docs/exactness.md, G8).
constexpr double margin = 0x1p-12;
/// The largest ratio of the weights, as the margin's proof requires.
constexpr double most_stretch = 8;
/// The least radius: squares of smaller ones could underflow.
constexpr double least_radius = 0x1p-20;
/// The least share of points in a core that saves time: its test takes about a third of the map's
/// (0.8 to 1.3 of 2.5 ns per point).
constexpr double least_share = 0.375;
/// In 3D, the approximate number of cells along an edge of a face. A tangent to a sphere at a
/// cell's middle loses 0.1 % of the radius at the cell's corners (angle sqrt(2) / 32); the time
/// grows with the square, 6 * 32^2 tangents take a fraction of a millisecond. Other values are
/// untested.
constexpr std::uint32_t wanted_cells = 32;
/// Radii tried for each of two of the cut box's norms. A tried radius is less than a sixteenth of
/// the range below the best one; the time grows with the square. Other values are untested.
constexpr unsigned steps = 16;

/// The number of norms: the ellipsoid's first, then those of the cut box.
constexpr unsigned all_norms = 1 + GaugeCore::norms;
/// For a cell and each norm: the radius within which the map drops the cell's points. A point needs
/// to be within only one of them.
using Reach = std::array<double, all_norms>;
using Norms = std::array<double, all_norms>;

template <unsigned D>
class CoreBuilder {
 public:
  explicit CoreBuilder(const GaugeTable& t) : t_(t) {
    weigh();
    measure_some_nodes();
  }

  /// Scales the norms from a few nodes, then bounds the radii over all cells.
  void measure(unsigned threads) {
    parts_ = D == 3 ? std::max(1U, wanted_cells / t_.cells) : 1;
    cells_ = t_.cells * parts_;
    face_cells_ = 1;
    for (unsigned k = 0; k + 1 < D; ++k) face_cells_ *= cells_;
    reaches_.assign(2 * D * face_cells_, {});
    for_each_chunk(2 * D, 1, threads, [&](std::uint64_t face, std::uint64_t, std::uint64_t) {
      measure_face(static_cast<unsigned>(face));
    });
  }

  std::optional<GaugeCore> best(const std::vector<float>& probes, std::uint32_t count) const {
    const std::vector<float> norms = norms_of(probes, count);
    const float* const rounds = norms.data();
    std::uint32_t most = 0;
    Reach radius{};
    const double round = least(0);
    for (std::uint32_t i = 0; i < count; ++i) most += rounds[i] < static_cast<float>(round);
    GaugeCore core;
    const std::uint32_t in_box = best_box(norms, count, radius);
    if (std::max(most, in_box) < least_share * count) return std::nullopt;
    core.kind = in_box > most ? GaugeCore::Kind::cut : GaugeCore::Kind::round;
    radius[0] = round;
    for (unsigned n = 0; n < all_norms; ++n)
      if ((n == 0) == (core.kind == GaugeCore::Kind::round) && !(radius[n] > least_radius))
        return std::nullopt;
    for (unsigned j = 0; j < D; ++j)
      core.weight[j] = static_cast<float>(
          core.kind == GaugeCore::Kind::cut ? weight_[j] : weight_[j] * weight_[j]);
    if (core.kind == GaugeCore::Kind::round)
      core.radius[0] = static_cast<float>(round * round * (1 - margin) * (1 - margin));
    else
      for (unsigned n = 0; n < GaugeCore::norms; ++n)
        core.radius[n] = static_cast<float>(radius[1 + n] * (1 - margin));
    return core;
  }

 private:
  /// Weights the axes so that the pseudo-hull extends equally far along all of them.
  void weigh() {
    double reach[D] = {}, longest = 0;
    for_each_node([&](const double(&v)[D], double g) {
      for (unsigned j = 0; j < D; ++j) reach[j] = std::max(reach[j], std::abs(v[j]) / g);
    });
    for (const double r : reach) longest = std::max(longest, r);
    for (unsigned j = 0; j < D; ++j)
      weight_[j] = static_cast<float>(longest / std::max(reach[j], longest / most_stretch));
  }

  /// Estimates from a sample of the nodes whether a core can be worthwhile: cells extend no farther
  /// than their nodes.
  void measure_some_nodes() {
    constexpr std::size_t wanted = 512;
    const std::size_t step = 1 + t_.nodes.size() / wanted;
    std::size_t at = 0;
    for_each_node([&](const double(&v)[D], double g) {
      if (at++ % step != 0) return;
      const Norms n = norms_of(v);
      reaches_.emplace_back();
      for (unsigned k = 0; k < all_norms; ++k) reaches_.back()[k] = t_.threshold * n[k] / g;
    });
  }

  template <class Body>
  void for_each_node(const Body& body) const {
    std::size_t at = 0;
    for (unsigned face = 0; face < 2 * D; ++face) {
      unsigned grid[D] = {};
      do {
        double v[D];
        place(face, t_.cells, grid, 0, v);
        body(v, static_cast<double>(t_.nodes[at++]));
      } while (next(grid, t_.cells + 1));
    }
  }

  /// Computes the point of the cube with grid coordinates (plus `shift`) on a face of `cells` cells
  /// per edge.
  static void place(unsigned face, unsigned cells, const unsigned (&grid)[D], double shift,
                    double (&v)[D]) {
    unsigned k = 0;
    for (unsigned j = 0; j < D; ++j)
      v[j] = j == face / 2 ? (face % 2 ? -1.0 : 1.0) : 2 * (grid[k++] + shift) / cells - 1;
  }

  /// Advances to the next of size^(D - 1) grid points, the first axis fastest.
  static bool next(unsigned (&grid)[D], unsigned size) {
    for (unsigned k = 0; k + 1 < D; ++k) {
      if (++grid[k] < size) return true;
      grid[k] = 0;
    }
    return false;
  }

  /// Returns 1 / F at the corners of the face's cells; F is the function that the map interpolates.
  std::vector<double> inverse_values(unsigned face) const {
    std::vector<double> values;
    if constexpr (D == 3) {
      values = values_on_face(t_, face, parts_);
    } else {
      const std::size_t size = t_.nodes.size() / (2 * D);
      values.assign(t_.nodes.begin() + static_cast<std::ptrdiff_t>(face * size),
                    t_.nodes.begin() + static_cast<std::ptrdiff_t>((face + 1) * size));
    }
    for (double& v : values) v = 1 / v;
    return values;
  }

  /// Computes a linear function that is nowhere above the norm and equals it at z.
  void tangent(unsigned norm, const double (&z)[D], double (&u)[D]) const {
    double size[D], square = 0;
    unsigned lowest = 0, highest = 0;
    for (unsigned j = 0; j < D; ++j) {
      size[j] = weight_[j] * std::abs(z[j]);
      square += size[j] * size[j];
      if (size[j] < size[lowest]) lowest = j;
      if (size[j] > size[highest]) highest = j;
    }
    for (unsigned j = 0; j < D; ++j) {
      const double sign = z[j] > 0 ? weight_[j] : z[j] < 0 ? -weight_[j] : 0;
      u[j] = norm == 0   ? weight_[j] * weight_[j] * z[j] / std::sqrt(square)
             : norm == 1 ? (j == highest ? sign : 0)
             : norm == 2 ? (j == lowest ? 0 : sign)
                         : sign;
    }
  }

  void measure_face(unsigned face) {
    const std::vector<double> inverse = inverse_values(face);
    constexpr unsigned corners = 1U << (D - 1);
    std::size_t offset[corners] = {};
    for (unsigned c = 0; c < corners; ++c) {
      std::size_t stride = 1;
      for (unsigned k = 0; k + 1 < D; ++k, stride *= cells_ + 1)
        if (c >> k & 1) offset[c] += stride;
    }
    const double width = 2.0 / cells_;
    Reach* out = &reaches_[face * face_cells_];
    unsigned grid[D] = {};
    do {
      std::size_t corner = 0, stride = 1;
      for (unsigned k = 0; k + 1 < D; ++k, stride *= cells_ + 1) corner += grid[k] * stride;
      double middle[D], low[D];
      place(face, cells_, grid, 0.5, middle);
      place(face, cells_, grid, 0, low);
      for (unsigned n = 0; n < all_norms; ++n) {
        double u[D], at[corners], edge[D];
        tangent(n, middle, u);
        at[0] = 0;
        unsigned k = 0;
        for (unsigned j = 0; j < D; ++j) {
          at[0] += u[j] * low[j];
          if (j != face / 2) edge[k++] = u[j] * width;
        }
        double reach = at[0] * inverse[corner];
        for (unsigned c = 1; c < corners; ++c) {
          const unsigned axis = highest_bit(c);
          at[c] = at[c - (1U << axis)] + edge[axis];
          reach = std::min(reach, at[c] * inverse[corner + offset[c]]);
        }
        (*out)[n] = t_.threshold * reach;
      }
      ++out;
    } while (next(grid, cells_));
  }

  static constexpr unsigned highest_bit(unsigned c) {
    unsigned bit = 0;
    while (c >> (bit + 1)) ++bit;
    return bit;
  }

  double least(unsigned norm) const {
    double r = std::numeric_limits<double>::infinity();
    for (const Reach& c : reaches_) r = std::min(r, c[norm]);
    return r;
  }

  Norms norms_of(const double (&y)[D]) const {
    double square = 0, most = 0, sum = 0, least = std::numeric_limits<double>::infinity();
    for (unsigned j = 0; j < D; ++j) {
      const double z = weight_[j] * std::abs(y[j]);
      square += z * z;
      most = std::max(most, z);
      least = std::min(least, z);
      sum += z;
    }
    return {std::sqrt(square), most, sum - least, sum};
  }

  /// Returns all norms at the probes: `count` values of each.
  std::vector<float> norms_of(const std::vector<float>& probes, std::uint32_t count) const {
    std::vector<float> norms(std::size_t{all_norms} * count);
    for (std::uint32_t i = 0; i < count; ++i) {
      double y[D];
      for (unsigned j = 0; j < D; ++j) y[j] = probes[j * std::size_t{count} + i];
      const Norms n = norms_of(y);
      for (unsigned k = 0; k < all_norms; ++k)
        norms[k * std::size_t{count} + i] = static_cast<float>(n[k]);
    }
    return norms;
  }

  /// Finds the radii of the cut box that contains most probes. A cell is covered if any one of the
  /// three radii is within its reach: the first and the last radius are tried on a grid, and the
  /// middle one is the least reach of the cells that neither covers.
  std::uint32_t best_box(const std::vector<float>& norms, std::uint32_t count,
                         Reach& radius) const {
    double highest[all_norms] = {};
    for (const Reach& c : reaches_)
      for (unsigned n = 1; n < all_norms; ++n) highest[n] = std::max(highest[n], c[n]);
    if (!(highest[1] > 0 && highest[2] > 0 && highest[3] > 0)) return 0;
    const double first = highest[1] / steps, last = highest[3] / steps;
    // middle[i][j]: the least reach of cells not covered by the first radius of step i and the last
    // of step j.
    std::array<std::array<double, steps + 1>, steps + 1> middle;
    for (auto& row : middle) row.fill(highest[2]);
    for (const Reach& c : reaches_) {
      const auto step = [](double reach, double size) {
        return static_cast<unsigned>(std::clamp(reach / size, 0.0, steps - 1.0));
      };
      double& m = middle[step(c[1], first) + 1][step(c[3], last) + 1];
      m = std::min(m, c[2]);
    }
    for (unsigned i = 1; i <= steps; ++i)
      for (unsigned j = 1; j <= steps; ++j)
        middle[i][j] = std::min({middle[i][j], middle[i - 1][j], middle[i][j - 1]});
    std::uint32_t most = 0;
    const float* const n1 = &norms[1 * std::size_t{count}];
    const float* const n2 = &norms[2 * std::size_t{count}];
    const float* const n3 = &norms[3 * std::size_t{count}];
    for (unsigned i = 1; i <= steps; ++i)
      for (unsigned j = 1; j <= steps; ++j) {
        const double tried[3] = {i * first, middle[i][j], j * last};
        const float a = static_cast<float>(tried[0]), b = static_cast<float>(tried[1]),
                    c = static_cast<float>(tried[2]);
        std::uint32_t inside = 0;
        for (std::uint32_t k = 0; k < count; ++k)
          inside += static_cast<std::uint32_t>(n1[k] < a) & static_cast<std::uint32_t>(n2[k] < b) &
                    static_cast<std::uint32_t>(n3[k] < c);
        if (inside <= most) continue;
        most = inside;
        for (unsigned n = 0; n < 3; ++n) radius[1 + n] = tried[n];
      }
    return most;
  }

  const GaugeTable& t_;
  double weight_[D] = {};
  unsigned parts_ = 1, cells_ = 0;
  std::size_t face_cells_ = 0;
  std::vector<Reach> reaches_;  ///< of all cells
};

template <unsigned D>
std::optional<GaugeCore> best_core(const GaugeTable& t, const std::vector<float>& probes,
                                   std::uint32_t count, unsigned threads) {
  CoreBuilder<D> builder(t);
  if (!builder.best(probes, count)) return std::nullopt;
  builder.measure(threads);
  return builder.best(probes, count);
}

}  // namespace

std::optional<GaugeCore> make_core(const GaugeTable& t, const std::vector<float>& probes,
                                   std::uint32_t count, unsigned threads) {
  return with_dimension<2, 5, 6>(t.dimension, [&](auto d) {
    return best_core<decltype(d)::value>(t, probes, count, threads);
  });
}

}  // namespace cullhull::internal
