#include "query/facet_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "exact/determinants/cofactors.hpp"
#include "exact/orientation/orientation.hpp"
#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"
#include "result/vertex_coordinates.hpp"

namespace cullhull::internal {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The vertices of a simplex of the boundary and one off its facet: they span the flat.
std::vector<std::uint32_t> flat_basis(const QueryPoints& points, const Hull& hull) {
  if (points.k == 0) return {0};
  std::vector<std::uint32_t> basis;
  for (unsigned i = 0; i < points.k; ++i) basis.push_back(points.corners[i]);
  const auto first = hull.facets.items.begin();
  const auto last = first + static_cast<std::ptrdiff_t>(hull.facets.offsets[1]);
  for (std::uint32_t v = 0; v < points.count(); ++v)
    if (std::find(first, last, points.ids[v]) == last) {
      basis.push_back(v);
      return basis;
    }
  throw Error(ErrorCode::invalid_argument, "all vertices of the hull are on one facet");
}

double largest_of(const double* x, unsigned k) {
  double m = 0;
  for (unsigned j = 0; j < k; ++j) m = std::max(m, std::fabs(x[j]));
  return m;
}

}  // namespace

QueryPoints make_query_points(const PointView* points, const Hull& hull, const Control& control) {
  if (hull.affine_dimension < 0)
    throw Error(ErrorCode::invalid_argument, "an empty hull answers no questions");
  if (points != nullptr &&
      (points->dimension != hull.dimension || points->count != hull.point_count))
    throw Error(ErrorCode::invalid_argument, "these are not the points the hull was computed from");
  if (points != nullptr) require_points(*points);
  QueryPoints q;
  q.dimension = hull.dimension;
  q.k = static_cast<unsigned>(hull.affine_dimension);
  q.ids = hull.vertices;
  std::sort(q.ids.begin(), q.ids.end());
  if (points != nullptr && q.ids.back() >= points->count)  // of a stream's hull
    throw Error(ErrorCode::invalid_argument, "vertex ", q.ids.back(), " is not one of the ",
                points->count, " points");
  q.plain = q.ids.back() + 1 == q.ids.size();
  q.corners.resize(hull.simplices.size());
  for (std::size_t i = 0; i < q.corners.size(); ++i) {
    if (i % 8192 == 0) control.check();
    q.corners[i] = q.index_of(hull.simplices[i]);
  }
  const unsigned d = q.dimension;
  q.full.resize(q.ids.size() * d);
  const auto copy = [&](const PointView& from, const auto& row_of) {
    for (std::size_t i = 0; i < q.ids.size(); ++i)
      for (unsigned j = 0; j < d; ++j) q.full[i * d + j] = from.at(row_of(i), j) + 0.0;
  };
  if (points != nullptr)
    copy(*points, [&](std::size_t i) { return q.ids[i]; });
  else
    copy(OwnVertices(hull).points(), [](std::size_t i) { return i; });
  for (std::size_t i = 0; i < q.full.size(); ++i)
    if (!std::isfinite(q.full[i]))
      throw Error(ErrorCode::not_finite, "point ", q.ids[i / d], ", coordinate ", i % d,
                  " is not finite, and no point of this hull");
  q.low.assign(q.full.begin(), q.full.begin() + d);
  q.high = q.low;
  for (std::size_t i = 0; i < q.full.size(); ++i) {
    q.low[i % d] = std::min(q.low[i % d], q.full[i]);
    q.high[i % d] = std::max(q.high[i % d], q.full[i]);
  }
  q.axes.resize(q.k);
  if (q.k == d) {
    for (unsigned j = 0; j < d; ++j) q.axes[j] = j;
    q.on_axes = q.full;
    return q;
  }
  q.basis = flat_basis(q, hull);
  std::vector<const double*> rows;
  for (const std::uint32_t v : q.basis) rows.push_back(q.full.data() + std::size_t{v} * d);
  affine_rank_exact(d, rows.data(), q.k + 1, q.axes.data());
  q.on_axes.resize(q.ids.size() * q.k);
  for (std::size_t i = 0; i < q.ids.size(); ++i)
    for (unsigned j = 0; j < q.k; ++j) q.on_axes[i * q.k + j] = q.full[i * d + q.axes[j]];
  return q;
}

FacetSearch::FacetSearch(const QueryPoints& points, const Hull& hull, const Control& control)
    : points_(&points),
      k_(points.k),
      neighbour_start_(hull.facet_neighbours.offsets.begin(), hull.facet_neighbours.offsets.end()),
      neighbours_(hull.facet_neighbours.items.begin(), hull.facet_neighbours.items.end()) {
  scale_points();
  choose_simplices(hull, control);
  exhaustive_ = k_ > 8 || !centre_inside();
  if (!exhaustive_) fill_hints(control);
}

void FacetSearch::scale_points() {
  const std::size_t n = points_->count();
  factor_.resize(k_);
  centre_.assign(k_, 0);
  scaled_.resize(n * k_);
  for (unsigned j = 0; j < k_; ++j) {
    const unsigned a = points_->axes[j];
    int exponent = 0;
    std::frexp(std::max(std::fabs(points_->low[a]), std::fabs(points_->high[a])), &exponent);
    factor_[j] = std::ldexp(1.0, std::min(-exponent, 1023));
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double v = points_->on_axes[i * k_ + j];
      scaled_[i * k_ + j] = v * factor_[j];
      scaled_exactly_ = scaled_exactly_ && scaled_[i * k_ + j] / factor_[j] == v;
      sum += scaled_[i * k_ + j];
    }
    centre_[j] = sum / static_cast<double>(n);
  }
}

/// Chooses for each facet the simplex with the smallest error bound of its plane.
void FacetSearch::choose_simplices(const Hull& hull, const Control& control) {
  corners_.resize(count() * k_);
  planes_.assign(count() * stride(), 0);
  std::vector<std::uint8_t> seen(count(), 0);
  std::vector<double> before(stride());
  for (std::size_t s = 0; s < hull.simplex_count(); ++s) {
    if (s % 4096 == 0) control.check();
    const std::uint32_t f = hull.simplex_facets[s];
    const std::uint32_t* const corners = points_->corners.data() + s * k_;
    double* plane = planes_.data() + f * stride();
    std::copy(plane, plane + stride(), before.begin());
    set_plane(f, corners);
    if (!seen[f] || plane[k_] < before[k_])
      std::copy_n(corners, k_, corners_.data() + std::size_t{f} * k_);
    else
      std::copy(before.begin(), before.end(), plane);
    seen[f] = 1;
  }
}

/// With M = max|v0 - c| <= 2, reach that of normal_and_reach and b the computed N . (v0 - c),
/// positive inside: |b - exact| <= reach M. Dividing N by b first costs one more rounding per
/// product, so |value - exact| <= e (1.5 max|x| + 2 |exact|), e = reach / b, and for e <= 1/8 at
/// most 3.03 e (max|x| + |value|) + value_tiny.
void FacetSearch::set_plane(std::uint32_t f, const std::uint32_t* corners) {
  double* plane = planes_.data() + f * stride();
  std::fill(plane, plane + k_, 0.0);
  plane[k_] = infinity;
  if (k_ > 8) return;
  double normal[8], reach = 0;
  with_dimension<2, 7, 8>(k_, [&](auto k) {
    double n[k()];
    reach = normal_and_reach<k()>(
        [&](unsigned i) { return scaled_.data() + std::size_t{corners[i]} * k(); }, n);
    std::copy_n(n, k(), normal);
  });
  const double* origin = scaled_.data() + std::size_t{corners[0]} * k_;
  // The stored orientation is negative inside, so N . (v0 - c) is positive.
  double b = 0;
  for (unsigned j = 0; j < k_; ++j) b += normal[j] * (origin[j] - centre_[j]);
  if (!(b >= least_denominator) || !(reach <= b / 8)) return;
  for (unsigned j = 0; j < k_; ++j) plane[j] = normal[j] / b;
  plane[k_] = 3.03 * (reach / b);
}

/// Whether the centre is beneath every facet. A facet's finite error bound proves it; the other
/// facets are tested exactly.
bool FacetSearch::centre_inside() const {
  std::vector<const double*> rows(k_ + 1);
  for (std::uint32_t f = 0; f < count(); ++f) {
    if (error_factor(f) < infinity) continue;
    if (!scaled_exactly_) return false;
    for (unsigned i = 0; i < k_; ++i)
      rows[i] = scaled_.data() + std::size_t{corners_[std::size_t{f} * k_ + i]} * k_;
    rows[k_] = centre_.data();
    if (orientation(k_, rows.data()) != Sign::negative) return false;
  }
  return true;
}

bool FacetSearch::localise(const double* q, double* x) const {
  bool finite = true;
  for (unsigned j = 0; j < k_; ++j) {
    x[j] = q[j] * factor_[j] - centre_[j];
    finite &= std::fabs(x[j]) < 0x1p500;
  }
  return finite;
}

void FacetSearch::localise_direction(const double* direction, double* x) const {
  for (unsigned j = 0; j < k_; ++j) x[j] = direction[j] * factor_[j];
}

// ------------------------------------------------------------------------------ where to start

std::uint32_t FacetSearch::start(const double* x) const {
  return hints_.empty() ? 0 : hints_[cube_.cell(x)];
}

void FacetSearch::fill_hints(const Control& control) {
  // Half a megabyte of hints, which fits L2.
  constexpr double most_cells = 1 << 17;
  cube_ = DirectionCube(k_, std::min(most_cells, 2.0 * static_cast<double>(count())));
  if (cube_.empty()) return;
  hints_ =
      cube_.answers(control, [&](std::uint32_t last, const double* x) { return climb(last, x); });
}

// ------------------------------------------------------------------------------------- climbing

template <unsigned K>
std::uint32_t FacetSearch::climb_as(std::uint32_t f, const double* x) const {
  double best = value<K>(f, x);
  for (;;) {
    std::uint32_t next = f;
    for (const std::uint32_t g : neighbours(f)) {
      const double v = value<K>(g, x);
      if (v > best) {
        best = v;
        next = g;
      }
    }
    if (next == f) return f;
    f = next;
  }
}

std::uint32_t FacetSearch::climb(std::uint32_t start, const double* x) const {
  return with_dimension<2, 4, 0>(k_,
                                 [&](auto k) { return climb_as<decltype(k)::value>(start, x); });
}

/// Collects the facets that may have the largest value at x and are not certainly above x. Returns
/// false if some facet is certainly below x; doubt.certain is then that facet.
template <unsigned K>
bool FacetSearch::explore(const double* x, Doubt& doubt) const {
  const unsigned k = K ? K : k_;
  const double reach = largest_of(x, k);
  const auto error = [&](std::uint32_t f, double v) {
    return value_error(error_factor(f), reach, v);
  };
  // Steepest ascent, stopping at the first facet visible from x.
  std::uint32_t f = start(x);
  double best = value<K>(f, x), rival = 0;  // an upper bound for the neighbours of f
  for (;;) {
    if (best > 1 && best - error(f, best) > 1) {
      doubt.certain = f;
      return false;
    }
    std::uint32_t next = f;
    rival = 0;
    for (const std::uint32_t g : neighbours(f)) {
      const double v = value<K>(g, x);
      rival = std::max(rival, v + error(g, v));
      if (v > best) {
        best = v;
        next = g;
      }
    }
    if (next == f) break;
    f = next;
  }
  // The facet with the largest value is connected to f through facets whose values may be at least
  // that of f.
  const double floor = best - error(f, best);
  if (rival < floor) {
    if (!(best + error(f, best) < 1)) doubt.facets.push_back(f);
    return true;
  }
  std::vector<std::uint32_t>& found = doubt.facets;
  std::vector<std::uint32_t> ring{f};
  std::vector<std::uint32_t> seen{f};
  while (!ring.empty()) {
    const std::uint32_t g = ring.back();
    ring.pop_back();
    const double v = value<K>(g, x), e = error(g, v);
    if (v - e > 1) {
      doubt.certain = g;
      return false;
    }
    if (!(v + e < 1)) found.push_back(g);
    for (const std::uint32_t h : neighbours(g)) {
      const double w = value<K>(h, x);
      if (w + error(h, w) < floor) continue;
      const auto at = std::lower_bound(seen.begin(), seen.end(), h);
      if (at != seen.end() && *at == h) continue;
      seen.insert(at, h);
      ring.push_back(h);
    }
  }
  return true;
}

bool FacetSearch::gather_doubt(const double* q, Doubt& doubt) const {
  std::array<double, 8> x;
  if (!localise(q, x.data())) {
    // So far away that the bounds exclude no facet: all facets are tested.
    doubt.facets.resize(count());
    for (std::uint32_t f = 0; f < count(); ++f) doubt.facets[f] = f;
    return true;
  }
  return with_dimension<2, 4, 0>(
      k_, [&](auto k) { return explore<decltype(k)::value>(x.data(), doubt); });
}

Side FacetSearch::exact_side(std::uint32_t f, const double* q) const {
  std::array<const double*, 9> few;
  std::vector<const double*> many;
  const double** rows = few.data();
  if (k_ > 8) {
    many.resize(k_ + 1);
    rows = many.data();
  }
  for (unsigned i = 0; i < k_; ++i) rows[i] = points_->row(corners_[std::size_t{f} * k_ + i]);
  rows[k_] = q;
  return static_cast<Side>(static_cast<int>(orientation(k_, rows)));
}

Side FacetSearch::side_of_all(const double* q) const {
  Side side = Side::inside;
  for (std::uint32_t f = 0; f < count() && side != Side::outside; ++f)
    side = std::max(side, exact_side(f, q));
  return side;
}

Side FacetSearch::side(const double* q) const {
  if (exhaustive_) return side_of_all(q);
  Doubt doubt;
  if (!gather_doubt(q, doubt)) return Side::outside;
  Side side = Side::inside;
  for (const std::uint32_t f : doubt.facets) {
    side = std::max(side, exact_side(f, q));
    if (side == Side::outside) break;
  }
  return side;
}

std::vector<std::uint32_t> FacetSearch::visible(const double* q) const {
  std::vector<std::uint32_t> out;
  if (exhaustive_) {
    for (std::uint32_t f = 0; f < count(); ++f)
      if (exact_side(f, q) == Side::outside) out.push_back(f);
    return out;
  }
  Doubt doubt;
  std::uint32_t first = no_index;
  if (!gather_doubt(q, doubt)) first = doubt.certain;
  for (std::size_t i = 0; i < doubt.facets.size() && first == no_index; ++i)
    if (exact_side(doubt.facets[i], q) == Side::outside) first = doubt.facets[i];
  if (first == no_index) return out;
  // The visible facets are connected.
  std::vector<std::uint8_t> seen(count(), 0);
  std::vector<std::uint32_t> stack{first};
  seen[first] = 1;
  while (!stack.empty()) {
    const std::uint32_t f = stack.back();
    stack.pop_back();
    out.push_back(f);
    for (const std::uint32_t g : neighbours(f)) {
      if (seen[g]) continue;
      seen[g] = 1;
      if (exact_side(g, q) == Side::outside) stack.push_back(g);
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace cullhull::internal
