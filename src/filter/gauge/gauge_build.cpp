// Builds the table, an upper bound of the gauge at every node of the cube map, and the test of
// single points by their cones.

#include "filter/gauge/gauge_build.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "filter/gauge/gauge_walk.hpp"
#include "parallel/dispatch.hpp"

namespace cullhull::internal {
namespace {

// Neighbouring nodes lie in the same or in neighbouring cones, so a walk that starts at the last
// node's facet is a step or two long.

/// Fills a table. With cones, it also stores the facet at which the walk to each node ended, as the
/// start of later walks.
template <unsigned D>
class Builder final : public GaugeCones {
 public:
  explicit Builder(InnerPolytope&& p) : polytope_(std::move(p)), walk_(polytope_) {}

  bool build(const GaugeSettings& settings, GaugeTable& t) {
    if (!walk_.prepare()) return false;
    const double allowance = gauge_allowance(D, walk_.lipschitz());
    if (!(allowance < most_gauge_allowance)) return false;
    allowance_ = allowance;

    t.dimension = D;
    t.cells = settings.resolution != 0 ? settings.resolution : automatic_cells(settings);
    cells_ = t.cells;
    if (!walk_.frame().fill(t)) return false;
    face_ = power(t.cells + 1, D - 1);
    t.nodes.resize(2 * D * face_);
    // Inverting all facets is worthwhile when each is visited many times.
    if ((settings.cones || walk_.facet_count() < t.nodes.size() / (2 * D)) &&
        !walk_.invert_facets(settings.threads) && !settings.convex)
      return false;
    if (settings.cones) hints_.resize(t.nodes.size());
    // Parts of faces are filled independently, so that no value depends on the thread.
    const unsigned parts = std::min(8U, t.cells + 1);
    for_each_chunk(2 * D * parts, 1, t.nodes.size() < least_parallel ? 1 : settings.threads,
                   [&](std::uint64_t i, std::uint64_t, std::uint64_t) {
      fill_part(t, static_cast<unsigned>(i / parts), static_cast<unsigned>(i % parts), parts);
    });
    return true;
  }

  // GaugeCones
  bool inside(const double* x) const override {
    double y[D], norm = 0;
    unsigned axis = 0;
    for (unsigned j = 0; j < D; ++j) {
      y[j] = (x[j] - walk_.frame().centre(j)) * walk_.frame().scale(j);
      if (std::abs(y[j]) > norm) {
        norm = std::abs(y[j]);
        axis = j;
      }
    }
    if (!(norm <= 1)) return false;  // beyond the polytope's box; also infinities
    std::uint64_t random = ConeWalk<D>::random_seed;
    double mu[D] = {};
    const std::uint32_t f = walk_.walk(hint(y, axis), y, mu, random);
    double weight = 0;
    for (unsigned i = 0; i < D; ++i) weight += mu[i];
    if (!(weight < 1)) return false;
    const GaugeBound b = walk_.bound(f, y, mu);
    return (b.weight + walk_.lipschitz() * b.residual) * (1 + 0x1p-49) < 1;
  }

 private:
  // Nodes; filling fewer takes less time than waking a thread.
  static constexpr std::uint64_t least_parallel = 1024;

  static std::uint64_t power(std::uint64_t base, unsigned e) {
    std::uint64_t r = 1;
    while (e-- > 0) r *= base;
    return r;
  }

  /// Returns the facet found at the node nearest to y; |y_axis| is the largest coordinate.
  std::uint32_t hint(const double (&y)[D], unsigned axis) const {
    if (y[axis] == 0) return 0;
    const double half = 0.5 * cells_, stretch = half / std::abs(y[axis]);
    std::uint64_t node = (2 * axis + (y[axis] < 0 ? 1 : 0)) * face_, stride = 1;
    for (unsigned k = 0; k + 1 < D; ++k, stride *= cells_ + 1) {
      const double place = y[k < axis ? k : k + 1] * stretch + half + 0.5;
      node += stride * std::min(cells_, static_cast<unsigned>(std::max(place, 0.0)));
    }
    return hints_[node];
  }

  // Example: a sample's hull of 1,000 facets in 3D asks for 6,000 nodes: six faces of 1,000, so an
  // edge of sqrt(1,000) = 31.6 nodes, 31 cells, made even: 32. The table has 6 * 33^2 = 6,534
  // floats, 26 KB, which the L1 cache holds; with twice the cells it would not.

  /// Chooses the resolution: nodes in proportion to facets; at least as many as reduce the
  /// survivors of balls noticeably (measured for each dimension), at most a share of L2: 64 K
  /// floats are 256 KB.
  unsigned automatic_cells(const GaugeSettings& settings) const {
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
    const std::uint32_t most_nodes = settings.most_nodes;
    const double most = most_nodes > 0 ? std::min<double>(most_nodes, rule.most) : rule.most;
    const double wanted = std::max<double>(settings.share * rule.per_facet * walk_.facet_count(),
                                           settings.least_nodes);
    const double nodes = std::clamp(wanted, rule.least, std::max(rule.least, most));
    const double edge = std::pow(nodes / (2 * D), 1.0 / (D - 1));
    unsigned cells = std::max(2U, static_cast<unsigned>(edge + 0.5) - 1);
    // An even number, so that planes of symmetry through the centre, where bodies often have
    // creases, fall on grid lines.
    if (D == 3) cells += cells % 2;
    while (most_nodes > 0 && cells > 2 && 2 * D * power(cells + 1, D - 1) > most_nodes) --cells;
    return cells;
  }

  /// Fills the nodes of one of `parts` parts of a face. A node is (+-cells on the face's axis, 2 i
  /// - cells on the others) / cells; the walk works on the integers.
  void fill_part(GaugeTable& t, unsigned side, unsigned part, unsigned parts) {
    double v[D];
    v[side / 2] = side % 2 ? -1.0 : 1.0;
    v[side / 2] *= t.cells;
    Filler filler{t, ConeWalk<D>::random_seed, {}};
    std::copy_n(v, D, filler.v);
    const unsigned lines = t.cells + 1;
    fill_axis(filler, side * face_, face_, side / 2, D - 1, walk_.axis_facet(side),
              lines * part / parts, lines * (part + 1) / parts);
  }

  struct Filler {
    GaugeTable& table;
    std::uint64_t random;
    double v[D];
  };

  /// Fills the sub-grid of the lowest `axes` grid axes, lines [begin, end) of the last; the walk to
  /// a node starts at the facet of a neighbouring node. Returns the facet of the first node.
  std::uint32_t fill_axis(Filler& filler, std::uint64_t node, std::uint64_t size, unsigned skip,
                          unsigned axes, std::uint32_t from, unsigned begin, unsigned end) {
    if (axes == 0) return fill_node(filler, node, from);
    const unsigned axis = axes - 1 < skip ? axes - 1 : axes;
    const std::uint64_t part = size / (cells_ + 1);
    std::uint32_t first = 0;
    for (unsigned i = begin; i < end; ++i) {
      filler.v[axis] = 2.0 * i - cells_;
      from = fill_axis(filler, node + i * part, part, skip, axes - 1, from, 0, cells_ + 1);
      if (i == begin) first = from;
    }
    return first;
  }

  std::uint32_t fill_node(Filler& filler, std::uint64_t node, std::uint32_t from) {
    const double* v = filler.v;
    double mu[D] = {};
    const std::uint32_t f = walk_.walk(from, v, mu, filler.random);
    const GaugeBound b = walk_.bound(f, v, mu);
    double norm = 0;
    for (unsigned j = 0; j < D; ++j) norm += std::abs(v[j]);
    const double fallback = walk_.lipschitz() * norm;
    double g = b.weight + walk_.lipschitz() * b.residual;
    if (!(g < fallback)) g = fallback;  // also for NaN
    filler.table.nodes[node] = round_up((g / cells_ + allowance_) * (1 + 0x1p-49));
    if (!hints_.empty()) hints_[node] = f;
    return f;
  }

  InnerPolytope polytope_;
  ConeWalk<D> walk_;
  unsigned cells_ = 0;
  std::uint64_t face_ = 0;  ///< nodes per face
  std::vector<std::uint32_t> hints_;
  double allowance_ = 0;
};

template <unsigned D>
bool build_as(InnerPolytope&& polytope, const GaugeSettings& settings, GaugeTable& table,
              std::unique_ptr<GaugeCones>* cones) {
  auto builder = std::make_unique<Builder<D>>(std::move(polytope));
  if (!builder->build(settings, table)) return false;
  if (cones != nullptr) *cones = std::move(builder);
  return true;
}

}  // namespace

bool build_gauge_table(InnerPolytope&& polytope, const GaugeSettings& settings, GaugeTable& table,
                       std::unique_ptr<GaugeCones>* cones) {
  const unsigned d = polytope.dimension;
  if (d < 2 || d > 6) return false;
  return with_dimension<2, 5, 6>(d, [&](auto k) {
    return build_as<decltype(k)::value>(std::move(polytope), settings, table, cones);
  });
}

}  // namespace cullhull::internal
