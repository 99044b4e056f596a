#include "filter/gauge/gauge_build.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/gauge/gauge_planes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Computes largest_gauges. On any target, with or without fused operations, the sums are within
/// the slack.
void largest_gauges_in(const GaugePlanes& planes, unsigned cells, const float* x, const float* y,
                       const float* z, std::uint32_t count, float* gauges) {
  const hn::CappedTag<float, 16> f;
  using V = hn::Vec<decltype(f)>;
  const std::size_t lanes = hn::Lanes(f), size = planes.slack.size();
  const float *q0 = planes.q[0].data(), *q1 = planes.q[1].data(), *q2 = planes.q[2].data(),
              *slack = planes.slack.data();
  const V times = hn::Set(f, static_cast<float>(cells));
  constexpr std::uint32_t together = 4;  // directions for which a plane is read once
  for (std::uint32_t i = 0; i < count; i += together) {
    const auto at = [&](const float* v, std::uint32_t k)
                        HWY_ATTR { return hn::Set(f, v[std::min(i + k, count - 1)]); };
    const V x0 = at(x, 0), x1 = at(x, 1), x2 = at(x, 2), x3 = at(x, 3);
    const V y0 = at(y, 0), y1 = at(y, 1), y2 = at(y, 2), y3 = at(y, 3);
    const V z0 = at(z, 0), z1 = at(z, 1), z2 = at(z, 2), z3 = at(z, 3);
    V m0 = hn::Zero(f), m1 = m0, m2 = m0, m3 = m0;  // no gauge is below 0
    for (std::size_t p = 0; p < size; p += lanes) {
      const V a = hn::LoadU(f, q0 + p), b = hn::LoadU(f, q1 + p), c = hn::LoadU(f, q2 + p);
      const V s = hn::Mul(hn::LoadU(f, slack + p), times);
      const auto gauge = [&](V u, V v, V w) HWY_ATTR {
        return hn::MulAdd(a, u, hn::MulAdd(b, v, hn::MulAdd(c, w, s)));
      };
      m0 = hn::Max(m0, gauge(x0, y0, z0));
      m1 = hn::Max(m1, gauge(x1, y1, z1));
      m2 = hn::Max(m2, gauge(x2, y2, z2));
      m3 = hn::Max(m3, gauge(x3, y3, z3));
    }
    const float found[together] = {
        hn::GetLane(hn::MaxOfLanes(f, m0)), hn::GetLane(hn::MaxOfLanes(f, m1)),
        hn::GetLane(hn::MaxOfLanes(f, m2)), hn::GetLane(hn::MaxOfLanes(f, m3))};
    for (std::uint32_t k = 0; k < together && i + k < count; ++k) gauges[i + k] = found[k];
  }
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(largest_gauges_in);

void largest_gauges(const GaugePlanes& planes, unsigned cells, const float* x, const float* y,
                    const float* z, std::uint32_t count, float* gauges) {
  HWY_DYNAMIC_DISPATCH(largest_gauges_in)(planes, cells, x, y, z, count, gauges);
}

namespace {

/// Chooses as centre the vertices' mean, which is inside, and powers of two that scale the vertices
/// to |y| <= 1.
bool choose_frame(const InnerPolytope& p, double* centre, double* scale) {
  const std::size_t count = p.vertices.size() / 3;
  for (unsigned j = 0; j < 3; ++j) {
    double mean = 0, reach = 0;
    for (std::size_t v = 0; v < count; ++v)
      mean += p.vertices[v * 3 + j] / static_cast<double>(count);
    const auto reach_from = [&](double c) {
      double r = 0;
      for (std::size_t v = 0; v < count; ++v) r = std::max(r, std::abs(p.vertices[v * 3 + j] - c));
      return r;
    };
    // The centre is rounded to f32 if that moves it little, so that f32 input is processed in f32.
    const double single = static_cast<float>(mean);
    reach = reach_from(mean);
    if (std::abs(single - mean) <= 0x1p-7 * reach) {
      mean = single;
      reach = reach_from(mean);
    }
    if (!(reach > 0x1p-500 && reach < 0x1p500)) return false;
    centre[j] = mean;
    scale[j] = std::ldexp(1.0, -(std::ilogb(reach) + 1));
    const double offset = centre[j] * scale[j];
    // An inexact product would shift the centre; only subnormal numbers can do that.
    if (!std::isfinite(offset) || offset / scale[j] != centre[j]) return false;
  }
  return true;
}

// The bound. Edges are differences of the points as given, each rounded once and scaled exactly:
// off by u relatively. A product of two is off by 3 u, the difference of two products by one more.
// With Pi the sum of the magnitudes of all six products the normal is off by at most 5 u Pi in all.
// The corner q is off by u, and the products and sums of B = N . q add 3 u Sum |N_j q_j| <= 3 u (1
// + 4 u) Pi: so |B~ - B| <= 10 u Pi, and |N~.y - N.y| <= 5 u Pi for |y|_inf <= 1. Both are below e
// = 12 u Pi + 2^-990.
//
// B~ > 16 e is required. With eps = e / B~ < 1/16 and s = Sum |N~_j| / B~ a facet whose value is
// positive has
//
//   N.y / B <= (N~.y / B~ + eps) / (1 - eps) <= N~.y / B~ + 1.067 eps (s + 1).
//
// The quotients are rounded to f32, and nodes are integers up to m, exact in f32. On its way each
// term meets that rounding, a product and at most three sums, so the sum in f32 is an upper bound,
// times m, if sigma >= (1.07 eps (s + 1) + 6 w s) 1.001 + 2^-100: 5.1 w (s + sigma) is needed for
// the roundings.
//
// Example: the facet x + y + z = 1 of an octahedron. N = (1, 1, 1), B = 1, Pi = 3, e = 4e-15, s =
// 3: sigma is about 6 w 3 = 1.1e-6, all of it from f32.

/// Adds a facet's plane; docs/exactness.md, "GaugeMap", G2a, derives the bound. Returns false if
/// the centre is not certainly beneath the plane.
bool add_plane(const double* a, const double* b, const double* c, const double* centre,
               const double* scale, GaugePlanes& out) {
  constexpr double u = 0x1p-53, w = 0x1p-24;
  double e[2][3], y[3], n[3], level = 0, sum = 0, products = 0;
  for (unsigned j = 0; j < 3; ++j) {
    e[0][j] = (b[j] - a[j]) * scale[j];
    e[1][j] = (c[j] - a[j]) * scale[j];
    y[j] = (a[j] - centre[j]) * scale[j];
  }
  for (unsigned j = 0; j < 3; ++j) {
    const unsigned k = (j + 1) % 3, l = (j + 2) % 3;
    const double p = e[0][k] * e[1][l], q = e[0][l] * e[1][k];
    n[j] = p - q;
    products += std::abs(p) + std::abs(q);
    sum += std::abs(n[j]);
    level += n[j] * y[j];
  }
  const double error = 12 * u * products + 0x1p-990;
  if (!(level > 16 * error)) return false;
  const double total = sum / level;
  const double slack = (1.07 * error / level * (total + 1) + 6 * w * total) * 1.001 + 0x1p-100;
  for (unsigned j = 0; j < 3; ++j) out.q[j].push_back(static_cast<float>(n[j] / level));
  out.slack.push_back(round_up(slack));
  return true;
}

bool find_planes(const InnerPolytope& p, const double* centre, const double* scale,
                 GaugePlanes& planes) {
  for (std::size_t f = 0; f < p.facets.size(); f += 3) {
    const double* corner[3];
    for (unsigned j = 0; j < 3; ++j)
      corner[j] = p.vertices.data() + std::size_t{p.facets[f + j]} * 3;
    if (!add_plane(corner[0], corner[1], corner[2], centre, scale, planes)) return false;
  }
  for (auto* list : {&planes.q[0], &planes.q[1], &planes.q[2], &planes.slack})
    list->resize((list->size() + 15) / 16 * 16, list->back());
  return true;
}

/// Returns an upper bound of the gauge of +-e_j for all j.
double lipschitz_of(const GaugePlanes& planes) {
  double most = 0;
  for (std::size_t f = 0; f < planes.slack.size(); ++f)
    for (const auto& q : planes.q)
      most = std::max(most, std::abs(static_cast<double>(q[f])) + planes.slack[f]);
  return most * (1 + 0x1p-20);
}

}  // namespace

bool build_gauge_by_planes(const InnerPolytope& polytope, unsigned cells, GaugeTable& table) {
  double centre[3], scale[3];
  GaugePlanes planes;
  if (polytope.dimension != 3 || polytope.facets.size() < 12 ||
      !choose_frame(polytope, centre, scale) || !find_planes(polytope, centre, scale, planes))
    return false;
  const double allowance = gauge_allowance(3, lipschitz_of(planes));
  if (!(allowance < most_gauge_allowance)) return false;
  table.dimension = 3;
  table.cells = cells;
  const std::uint32_t edge = cells + 1, face = edge * edge;
  fill_gauge_constants(table, centre, scale, face);
  table.nodes.resize(6 * std::size_t{face});
  std::vector<float> v[3];
  for (auto& axis : v) axis.resize(face);
  for (unsigned side = 0; side < 6; ++side) {
    const unsigned axis = side / 2, first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
    const auto whole = static_cast<float>(cells);
    for (std::uint32_t i = 0; i < face; ++i) {
      v[axis][i] = side % 2 != 0 ? -whole : whole;
      v[first][i] = 2 * static_cast<float>(i % edge) - whole;
      v[second][i] = 2 * static_cast<float>(i / edge) - whole;
    }
    float* const nodes = table.nodes.data() + std::size_t{side} * face;
    largest_gauges(planes, cells, v[0].data(), v[1].data(), v[2].data(), face, nodes);
    for (std::uint32_t i = 0; i < face; ++i)
      nodes[i] = round_up((static_cast<double>(nodes[i]) / cells + allowance) * (1 + 0x1p-49));
  }
  return true;
}

}  // namespace cullhull::internal
#endif
