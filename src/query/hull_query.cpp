// HullQuery: single queries and batches.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>

#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/query.hpp"
#include "exact/orientation/flat_test.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "filter/gauge/gauge_table.hpp"
#include "geometry/gather.hpp"
#include "parallel/adjacency.hpp"
#include "parallel/threads/once.hpp"
#include "parallel/threads/run.hpp"
#include "parallel/threads/thread_memory.hpp"
#include "query/device_questions.hpp"
#include "query/facet_search.hpp"
#include "query/vertex_search.hpp"

namespace cullhull::internal {
namespace {

/// Points per chunk: some 20 to 100 microseconds of single queries.
constexpr std::uint64_t chunk = std::uint64_t{1} << 12;
static_assert(chunk <= gauge_chunk);
/// The least batch for which a gauge map is built: the map decides most inner points without a
/// climb, but costs its construction once. Untested.
constexpr std::uint64_t worth_a_map = 2048;

FlatTest flat_of(const QueryPoints& points) {
  std::vector<const double*> basis;
  for (const std::uint32_t v : points.basis)
    basis.push_back(points.full.data() + std::size_t{v} * points.dimension);
  return {points.dimension, points.axes, basis};
}

/// The hull as an InnerPolytope; moves the corners out of `points`.
InnerPolytope polytope_of(QueryPoints& points, const Hull& hull) {
  InnerPolytope p;
  p.dimension = points.dimension;
  p.vertices = points.full;
  p.facets = std::move(points.corners);
  p.neighbours.assign(hull.simplex_neighbours.begin(), hull.simplex_neighbours.end());
  return p;
}

/// Copies coordinate j of point begin + ids[i] to columns[j * FacetCells::block + i].
void load_columns(const PointView& view, std::uint64_t begin, const std::uint32_t* ids,
                  std::uint32_t count, double* columns) {
  if (view.scalar == ScalarType::f64) {
    for (unsigned j = 0; j < view.dimension; ++j) {
      const std::byte* from = view.address(begin, j);
      double* const to = columns + j * FacetCells::block;
      for (std::uint32_t i = 0; i < count; ++i)
        std::memcpy(to + i, from + static_cast<std::ptrdiff_t>(ids[i]) * view.point_stride,
                    sizeof(double));
    }
    return;
  }
  double p[FacetCellTable::max_k];
  for (std::uint32_t i = 0; i < count; ++i) {
    load_row(view, begin + ids[i], p);
    for (unsigned j = 0; j < view.dimension; ++j) columns[j * FacetCells::block + i] = p[j];
  }
}

void refuse_non_finite(const double* p, unsigned d) {
  for (unsigned j = 0; j < d; ++j)
    if (!std::isfinite(p[j]))
      throw Error(ErrorCode::not_finite, "coordinate ", j, " is ",
                  (std::isnan(p[j]) ? "NaN" : "infinite"));
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

using namespace internal;

struct HullQuery::State {
  State(const PointView* view, const Hull& hull, const Control& control)
      : points(make_query_points(view, hull, control)),
        flat(flat_of(points)),
        vertices(points, control),
        planes(hull.facet_planes.begin(), hull.facet_planes.end()),
        facet_start(hull.facets.offsets.begin(), hull.facets.offsets.end()) {
    if (points.k >= 2) facets.emplace(points, hull, control);
    if (points.k >= 1) tree.emplace(planes, points.dimension, control);
    facet_vertices.reserve(hull.facets.items.size());
    for (const std::uint64_t id : hull.facets.items) {
      if (facet_vertices.size() % 8192 == 0) control.check();
      facet_vertices.push_back(points.index_of(id));
    }
    vertex_facets = Adjacency<std::uint32_t>(points.count(), [&](const auto& add) {
      for (std::uint32_t f = 0; f + 1 < facet_start.size(); ++f)
        for (std::uint64_t i = facet_start[f]; i < facet_start[f + 1]; ++i)
          add(facet_vertices[i], f);
    });
    if (points.k == points.dimension && points.dimension >= GaugeMap::min_dimension &&
        points.dimension <= GaugeMap::max_dimension)
      polytope = polytope_of(points, hull);
    points.corners = {};
  }

  bool in_box(const double* p) const {
    for (unsigned j = 0; j < points.dimension; ++j)
      if (p[j] < points.low[j] || p[j] > points.high[j]) return false;
    return true;
  }
  void on_axes(const double* p, double* q) const {
    for (unsigned j = 0; j < points.k; ++j) q[j] = p[points.axes[j]];
  }
  Side side(const double* p) const;
  double plane_value(std::uint32_t f, const double* p) const {
    const unsigned d = points.dimension;
    const double* plane = planes.data() + std::size_t{f} * (d + 1);
    double sum = plane[d];
    for (unsigned j = 0; j < d; ++j) sum += plane[j] * p[j];
    return sum;
  }
  NearestFacet nearest(const double* p) const;
  std::uint32_t facet_of(const std::vector<std::uint32_t>& corners, const double* p) const;
  /// The gauge map of the whole hull, built at the first call; null where there is none.
  const GaugeMap* map() const {
    map_once.call([this] {
      if (polytope.dimension != 0) gauge_map = GaugeMap::build(polytope);
    });
    return gauge_map.get();
  }
  /// The facet cells, built at the first call; null where there are none.
  const FacetCells* facet_cells(const Run& run) const {
    cells_once.call([&] {
      if (points.k == points.dimension && facets) cells = FacetCells::build(*facets, points, run);
      cells_built = true;
    });
    return cells.get();
  }
  SideTables side_tables(std::uint64_t count) const {
    return {points.k == points.dimension && facets ? FacetCells::count(*facets) : 0, cells_built,
            asked_there.fetch_add(count), [this](const Run& run) { return facet_cells(run); },
            [this, count] { return count >= worth_a_map ? map() : nullptr; }};
  }
  /// The tables for a device, built at the first call; null where it does not support the hull.
  const HullTables* tables() const {
    tables_once.call([this] { device_tables = hull_tables(polytope, planes); });
    return device_tables ? &*device_tables : nullptr;
  }
  DeviceQuestions there(const DevicePointView& view, const Options& options,
                        AnswersIn answers_in) const {
    check(view);
    return {view, tables(), kept_there, options, answers_in};
  }
  RayHit ray(const double* origin, const double* direction) const;
  RayHit ray_on_line(double origin, double direction) const;  // d = 1
  RayHit ray_past_all(const double* origin, const double* direction) const;
  RayHit ray_by_climbs(const double* origin, const double* direction) const;
  double end_of_line(const std::vector<double>& x, const std::vector<double>& u,
                     std::uint32_t& facet) const;
  template <class View>
  void check(const View& view) const {
    require_points(view.dimension, view.data, view.count);
    if (view.dimension != points.dimension)
      throw Error(ErrorCode::invalid_argument, "points of dimension ", view.dimension,
                  " asked of a hull in dimension ", points.dimension);
  }
  template <class Body>
  void each(const PointView& view, const Options& options, Body&& body) const;
  struct ManySides;
  template <class Out, class Of>
  void sides(const PointView& view, Out* out, const Options& options, Of&& of) const;

  QueryPoints points;
  FlatTest flat;
  std::optional<FacetSearch> facets;
  VertexSearch vertices;
  std::vector<double> planes;
  std::optional<PlaneTree> tree;
  std::vector<std::uint64_t> facet_start;
  std::vector<std::uint32_t> facet_vertices;
  Adjacency<std::uint32_t> vertex_facets;
  InnerPolytope polytope;
  mutable Once map_once;
  mutable std::unique_ptr<GaugeMap> gauge_map;
  mutable Once tables_once;
  mutable std::optional<HullTables> device_tables;
  mutable KeptTables kept_there;
  mutable Once cells_once;
  mutable std::atomic<bool> cells_built = false;
  mutable std::atomic<std::uint64_t> asked_there = 0;  // points on devices, of their sides
  mutable std::unique_ptr<FacetCells> cells;
};

Side HullQuery::State::side(const double* p) const {
  if (!in_box(p)) return Side::outside;
  if (points.k == 0) return Side::boundary;  // the box is a single point
  if (points.k < points.dimension && !flat.contains(p)) return Side::outside;
  if (points.k == 1) {
    const unsigned a = points.axes[0];
    return p[a] > points.low[a] && p[a] < points.high[a] ? Side::inside : Side::boundary;
  }
  if (points.k == points.dimension) return facets->side(p);
  std::vector<double> q(points.k);
  on_axes(p, q.data());
  return facets->side(q.data());
}

/// The facet through all corners that p is farthest above.
std::uint32_t HullQuery::State::facet_of(const std::vector<std::uint32_t>& corners,
                                         const double* p) const {
  std::uint32_t best = no_index;
  double best_value = 0;
  const std::uint32_t v = corners[0];
  for (const std::uint32_t f : vertex_facets[v]) {
    const auto first = facet_vertices.begin() + static_cast<std::ptrdiff_t>(facet_start[f]);
    const auto last = facet_vertices.begin() + static_cast<std::ptrdiff_t>(facet_start[f + 1]);
    const bool all = std::all_of(corners.begin(), corners.end(), [&](std::uint32_t c) {
      return std::find(first, last, c) != last;
    });
    const double value = plane_value(f, p);
    if (all && (best == no_index || value > best_value)) {
      best = f;
      best_value = value;
    }
  }
  return best;
}

NearestFacet HullQuery::State::nearest(const double* p) const {
  constexpr double least = std::numeric_limits<double>::denorm_min();
  const Side where = side(p);
  NearestFacet out;
  if (where == Side::outside) {
    const VertexSearch::Nearest near = vertices.nearest(p);
    out.distance = std::max(near.distance, least);  // rounding must not contradict the exact side
    if (points.k == 0) return out;
    const std::uint32_t f = facet_of(near.corners, p);
    if (f != no_index) {
      out.facet = f;
      return out;
    }
    // Rounding chose corners that no facet has in common: takes the facet that p is farthest above.
    double value = 0;
    out.facet = tree->largest(p, 0, value);
    return out;
  }
  if (points.k == 0) return out;
  double value = 0;
  out.facet = tree->largest(p, 0, value);
  out.distance = where == Side::boundary ? 0 : std::min(value, -least);
  return out;
}

RayHit HullQuery::State::ray(const double* origin, const double* direction) const {
  const unsigned d = points.dimension;
  if (points.k < d)
    throw Error(ErrorCode::invalid_argument,
                "rays need a full-dimensional hull; this one lies in a flat of dimension ",
                points.k);
  if (std::all_of(direction, direction + d, [](double v) { return v == 0; }))
    throw Error(ErrorCode::invalid_argument, "a ray needs a direction that is not zero");
  const RayHit hit = d == 1                 ? ray_on_line(*origin, *direction)
                     : facets->exhaustive() ? ray_past_all(origin, direction)
                                            : ray_by_climbs(origin, direction);
  return hit.hit ? hit : RayHit{};
}

RayHit HullQuery::State::ray_on_line(double origin, double direction) const {
  RayHit hit;
  hit.hit = true;
  const auto end_at = [&](double v) {
    return static_cast<std::uint32_t>(points.full[facet_vertices[0]] == v ? 0 : 1);
  };
  hit.enter = (points.low[0] - origin) / direction;
  hit.exit = (points.high[0] - origin) / direction;
  hit.enter_facet = end_at(points.low[0]);
  hit.exit_facet = end_at(points.high[0]);
  if (hit.enter > hit.exit) {
    std::swap(hit.enter, hit.exit);
    std::swap(hit.enter_facet, hit.exit_facet);
  }
  return hit;
}

RayHit HullQuery::State::ray_past_all(const double* origin, const double* direction) const {
  const unsigned d = points.dimension;
  RayHit hit;
  hit.enter = -std::numeric_limits<double>::infinity();
  hit.exit = -hit.enter;
  for (std::uint32_t f = 0; f + 1 < facet_start.size(); ++f) {
    double rise = 0;
    for (unsigned j = 0; j < d; ++j) rise += planes[std::size_t{f} * (d + 1) + j] * direction[j];
    const double height = plane_value(f, origin);
    if (rise == 0 && height > 0) return hit;
    if (rise == 0) continue;
    const double t = -height / rise;
    if (rise > 0 && t < hit.exit) hit.exit = t, hit.exit_facet = f;
    if (rise < 0 && t > hit.enter) hit.enter = t, hit.enter_facet = f;
  }
  hit.hit = hit.enter <= hit.exit;
  return hit;
}

RayHit HullQuery::State::ray_by_climbs(const double* origin, const double* direction) const {
  const unsigned d = points.dimension;
  std::vector<double> x(d), u(d);
  if (!facets->localise(origin, x.data()))
    throw Error(ErrorCode::invalid_argument, "a ray begins more than 2^500 extents away");
  facets->localise_direction(direction, u.data());
  RayHit hit;
  hit.exit = end_of_line(x, u, hit.exit_facet);
  if (std::isnan(hit.exit)) return hit;
  for (double& v : u) v = -v;
  hit.enter = -end_of_line(x, u, hit.enter_facet);
  hit.hit = hit.enter <= hit.exit;  // false for a NaN
  return hit;
}

// Finds the last zero of G(t) = max over facets of value(f, x + t u) - 1, which is convex and
// piecewise linear, by Newton's method from beyond that zero. If the method meets a piece of slope
// <= 0 first, the line misses the hull, and the result is a NaN. Exact planes are not needed:
// parameters are doubles.
double HullQuery::State::end_of_line(const std::vector<double>& x, const std::vector<double>& u,
                                     std::uint32_t& facet) const {
  const auto zero_of = [&](std::uint32_t f) {
    const double slope = facets->value<0>(f, u.data());
    return slope > 0 ? (1 - facets->value<0>(f, x.data())) / slope
                     : std::numeric_limits<double>::quiet_NaN();
  };
  facet = facets->climb(facets->start(u.data()), u.data());
  std::vector<double> at(x.size());
  for (double t = zero_of(facet);;) {
    for (std::size_t j = 0; j < x.size(); ++j) at[j] = x[j] + t * u[j];
    const std::uint32_t next = facets->climb(facet, at.data());
    if (next == facet) return t;
    const double step = zero_of(next);
    if (std::isnan(step)) return step;
    if (!(step < t)) return t;
    t = step;
    facet = next;
  }
}

/// Calls body(i, coordinates) for every point, in parallel, once all are known to be finite.
template <class Body>
void HullQuery::State::each(const PointView& view, const Options& options, Body&& body) const {
  check(view);
  const Run run(options);
  const unsigned d = points.dimension;
  check_finite(view, nullptr, run);
  constexpr std::uint64_t block = std::uint64_t{1} << 18;  // between two progress reports
  for (std::uint64_t first = 0; first < view.count; first += block) {
    run.report("query", static_cast<double>(first) / static_cast<double>(view.count));
    run.each(std::min(block, view.count - first), chunk,
             [&](std::uint64_t begin, std::uint64_t end) {
      std::vector<double> p(d);
      for (std::uint64_t i = first + begin; i < first + end; ++i) {
        for (unsigned j = 0; j < d; ++j) p[j] = view.at(i, j) + 0.0;
        body(i, p.data());
      }
    });
  }
}

/// Finds the sides of one chunk of points.
struct HullQuery::State::ManySides {
  const State& state;
  const PointView& view;
  const GaugeMap* inner;    // may be null
  const FacetCells* cells;  // may be null

  /// Returns the index of the first point that is not finite, or view.count.
  template <class Out, class Of>
  std::uint64_t ask(std::uint64_t begin, std::uint64_t end, Out* out, const Of& of) const {
    auto& ids = thread_memory<std::array<std::uint32_t, gauge_chunk>>();
    auto count = static_cast<std::uint32_t>(end - begin);
    if (inner != nullptr) {
      std::fill(out + begin, out + end, of(Side::inside));
      count =
          static_cast<std::uint32_t>(gauge_survivors(inner->table(), view, begin, end, ids.data()));
    } else {
      std::iota(ids.begin(), ids.begin() + count, 0U);
    }
    for (std::uint32_t i = 0; i < count; i += FacetCells::block) {
      const std::uint32_t n = std::min(FacetCells::block, count - i);
      const std::uint64_t bad = cells != nullptr ? ask_cells(begin, ids.data() + i, n, out, of)
                                                 : ask_each(begin, ids.data() + i, n, out, of);
      if (bad != view.count) return bad;
    }
    return view.count;
  }

  template <class Out, class Of>
  std::uint64_t ask_each(std::uint64_t begin, const std::uint32_t* ids, std::uint32_t count,
                         Out* out, const Of& of) const {
    std::vector<double> p(view.dimension);
    for (std::uint32_t i = 0; i < count; ++i) {
      load_row(view, begin + ids[i], p.data());
      if (!std::all_of(p.begin(), p.end(), [](double v) { return std::isfinite(v); }))
        return begin + ids[i];
      out[begin + ids[i]] = of(state.side(p.data()));
    }
    return view.count;
  }

  template <class Out, class Of>
  std::uint64_t ask_cells(std::uint64_t begin, const std::uint32_t* ids, std::uint32_t count,
                          Out* out, const Of& of) const {
    constexpr std::uint32_t block = FacetCells::block;
    alignas(64) double columns[FacetCellTable::max_k * block];
    std::int8_t sides[block];
    load_columns(view, begin, ids, count, columns);
    if (!cells->sides(columns, count, sides)) return ask_each(begin, ids, count, out, of);
    for (std::uint32_t i = 0; i < count; ++i) {
      Side side = static_cast<Side>(sides[i]);
      if (side == Side::boundary) {  // or undecided
        double p[FacetCellTable::max_k];
        load_row(view, begin + ids[i], p);
        side = state.facets->side(p);
      }
      out[begin + ids[i]] = of(side);
    }
    return view.count;
  }
};

/// Processes each chunk while it is in the cache: first by the map, which decides points well
/// inside, then by bounding box and cells, then one by one. `of` converts a side to an output
/// value.
template <class Out, class Of>
void HullQuery::State::sides(const PointView& view, Out* out, const Options& options,
                             Of&& of) const {
  check(view);
  const Run run(options);
  const ManySides many{
      *this, view, worth_a_map <= view.count ? map() : nullptr,
      facets && view.count >= FacetCells::worthwhile(*facets) ? facet_cells(run) : nullptr};
  constexpr std::uint64_t block = std::uint64_t{1} << 20;  // between two progress reports
  const std::uint64_t size = view.count >= block / 4 ? gauge_chunk : chunk;
  for (std::uint64_t first = 0; first < view.count; first += block) {
    run.report("query", static_cast<double>(first) / static_cast<double>(view.count));
    const std::uint64_t count = std::min(block, view.count - first);
    std::vector<std::uint64_t> bad(chunk_count(count, size), view.count);
    run.each_chunk(count, size, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      bad[c] = many.ask(first + begin, first + end, out, of);
    });
    const std::vector<std::uint64_t> lowest{*std::min_element(bad.begin(), bad.end())};
    if (lowest[0] < view.count)
      check_finite(view, &lowest, run.with_threads(1));  // throws the error that names it
  }
}

// ------------------------------------------------------------------------------ the public face

HullQuery::HullQuery(const PointView& points, const Hull& hull, const Options& options) {
  const Control control(options);
  control.check();
  state_ = std::make_unique<State>(&points, hull, control);
}
HullQuery::HullQuery(const Hull& hull, const Options& options) {
  const Control control(options);
  control.check();
  state_ = std::make_unique<State>(nullptr, hull, control);
}
HullQuery::~HullQuery() = default;
HullQuery::HullQuery(HullQuery&&) noexcept = default;
HullQuery& HullQuery::operator=(HullQuery&&) noexcept = default;

std::uint32_t HullQuery::dimension() const noexcept { return state_->points.dimension; }

Side HullQuery::side(const double* point) const {
  refuse_non_finite(point, state_->points.dimension);
  return state_->side(point);
}

std::vector<std::uint32_t> HullQuery::visible_facets(const double* point) const {
  const State& s = *state_;
  refuse_non_finite(point, s.points.dimension);
  if (s.points.k == 0) return {};
  if (s.points.k < s.points.dimension && !s.flat.contains(point)) return {};
  if (s.points.k == 1) {  // the two ends
    const unsigned a = s.points.axes[0];
    const auto at = [&](std::uint32_t f) { return s.points.row(s.facet_vertices[f])[0]; };
    if (point[a] < s.points.low[a]) return {at(0) == s.points.low[a] ? 0U : 1U};
    if (point[a] > s.points.high[a]) return {at(0) == s.points.high[a] ? 0U : 1U};
    return {};
  }
  std::vector<double> q(s.points.k);
  s.on_axes(point, q.data());
  return s.facets->visible(q.data());
}

std::uint64_t HullQuery::support(const double* direction) const {
  refuse_non_finite(direction, state_->points.dimension);
  return state_->points.ids[state_->vertices.support(direction)];
}

NearestFacet HullQuery::nearest_facet(const double* point) const {
  refuse_non_finite(point, state_->points.dimension);
  return state_->nearest(point);
}

RayHit HullQuery::ray(const double* origin, const double* direction) const {
  refuse_non_finite(origin, state_->points.dimension);
  refuse_non_finite(direction, state_->points.dimension);
  return state_->ray(origin, direction);
}

void HullQuery::contains(const PointView& points, std::uint8_t* out, const Options& options) const {
  state_->sides(points, out, options,
                [](Side s) { return static_cast<std::uint8_t>(s != Side::outside); });
}

void HullQuery::sides(const PointView& points, Side* out, const Options& options) const {
  state_->sides(points, out, options, [](Side s) { return s; });
}

void HullQuery::supports(const PointView& directions, std::uint64_t* out,
                         const Options& options) const {
  state_->each(directions, options, [&](std::uint64_t i, const double* p) {
    out[i] = state_->points.ids[state_->vertices.support(p)];
  });
}

void HullQuery::nearest_facets(const PointView& points, NearestFacet* out,
                               const Options& options) const {
  state_->each(points, options,
               [&](std::uint64_t i, const double* p) { out[i] = state_->nearest(p); });
}

void HullQuery::signed_distances(const PointView& points, double* out,
                                 const Options& options) const {
  state_->each(points, options,
               [&](std::uint64_t i, const double* p) { out[i] = state_->nearest(p).distance; });
}

// Points in a device's memory.

namespace {

/// The CPU's answers to a question, for what a device leaves open.
template <class Out>
DeviceQuestions::Here<Out> cpu_answers(const HullQuery& query,
                                       void (HullQuery::*question)(const PointView&, Out*,
                                                                   const Options&) const) {
  return [&query, question](const PointView& points, Out* out, const Options& options) {
    (query.*question)(points, out, options);
  };
}

}  // namespace

void HullQuery::sides(const DevicePointView& points, Side* out, const Options& options) const {
  state_->there(points, options, AnswersIn::host)
      .sides(state_->side_tables(points.count), out, cpu_answers<Side>(*this, &HullQuery::sides));
}
void HullQuery::sides_on_device(const DevicePointView& points, Side* out,
                                const Options& options) const {
  state_->there(points, options, AnswersIn::device)
      .sides(state_->side_tables(points.count), out, cpu_answers<Side>(*this, &HullQuery::sides));
}

void HullQuery::contains(const DevicePointView& points, std::uint8_t* out,
                         const Options& options) const {
  state_->there(points, options, AnswersIn::host)
      .sides(state_->side_tables(points.count), out,
             cpu_answers<std::uint8_t>(*this, &HullQuery::contains));
}
void HullQuery::contains_on_device(const DevicePointView& points, std::uint8_t* out,
                                   const Options& options) const {
  state_->there(points, options, AnswersIn::device)
      .sides(state_->side_tables(points.count), out,
             cpu_answers<std::uint8_t>(*this, &HullQuery::contains));
}

void HullQuery::supports(const DevicePointView& directions, std::uint64_t* out,
                         const Options& options) const {
  state_->there(directions, options, AnswersIn::host)
      .supports(state_->points.ids, out, cpu_answers<std::uint64_t>(*this, &HullQuery::supports));
}
void HullQuery::supports_on_device(const DevicePointView& directions, std::uint64_t* out,
                                   const Options& options) const {
  state_->there(directions, options, AnswersIn::device)
      .supports(state_->points.ids, out, cpu_answers<std::uint64_t>(*this, &HullQuery::supports));
}

void HullQuery::signed_distances(const DevicePointView& points, double* out,
                                 const Options& options) const {
  state_->there(points, options, AnswersIn::host)
      .distances(out, cpu_answers<double>(*this, &HullQuery::signed_distances));
}
void HullQuery::signed_distances_on_device(const DevicePointView& points, double* out,
                                           const Options& options) const {
  state_->there(points, options, AnswersIn::device)
      .distances(out, cpu_answers<double>(*this, &HullQuery::signed_distances));
}

void HullQuery::rays(const PointView& origins, const PointView& directions, RayHit* out,
                     const Options& options) const {
  state_->check(directions);
  if (origins.count != directions.count)
    throw Error(ErrorCode::invalid_argument, "there must be as many directions as origins");
  check_finite(directions, nullptr, Run(options));
  const unsigned d = state_->points.dimension;
  state_->each(origins, options, [&](std::uint64_t i, const double* p) {
    std::vector<double> u(d);
    for (unsigned j = 0; j < d; ++j) u[j] = directions.at(i, j);
    out[i] = state_->ray(p, u.data());
  });
}

}  // namespace cullhull
