// Hulls of dimension d <= 6 whose largest extent e lies in 2^-100 < e < 2^100; a point outside the
// vertices' box is outside, for others no difference to a corner exceeds e. N is the cofactor
// normal of a simplex as given, not scaled, so N*(x - a) is off by at most determinant_error(d) R
// max|x - a|, R the product of the edges' largest entries (`normal_and_reach`). What underflows: d!
// products of d factors below 2^100, each off by at most d 2^-1074 * 2^(100 (d - 1)): in all below
// 720 * 6 * 2^-574 < 2^-561; used is 2^-540. The kernel rounds the bound itself, which the factor
// 1.01 covers. N leads out where the mean of the vertices, any point near it, is certainly on the
// other side; else the factor is infinite and the simplex certain of nothing. A point is inside
// where it is certainly beneath all simplices, outside where it is certainly above one. Sides by
// cells of directions do on the device what the CPU does, operation by operation, compiled without
// fused multiply-adds (`-fmad=false`): docs/exactness.md, "Cells of directions", holds as it
// stands, for hulls of any extent. Vertices for `supports` are taken relative to a centre, a
// rounding each, so that a product is off by at most gamma_{d+1} Sum |u_j| E, E their largest
// coordinate; 1.01 (d + 1) u Sum |u_j| E + 2^-900 is used (components of the scaled direction that
// underflow lose less than 2^-970), and the best must be ahead of every other by 2.01 times that.

#include "query/device_questions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "cuda/backend.hpp"
#include "exact/determinants/cofactors.hpp"
#include "flow/pipeline.hpp"
#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"

namespace cullhull::internal {
namespace {

/// Points per piece: bounds the device memory for answers (at most 8 bytes a point) and for the
/// list of open points (4 bytes a point), 50 MB in all, at the cost of a launch and a copy per
/// piece. Untested.
constexpr std::uint64_t piece = std::uint64_t{1} << 22;

/// Appends for each simplex a corner, the normal that points away from the centre, and the normal's
/// error factor, which is infinite where the centre's side is not certain.
template <unsigned D>
void add_simplices(const InnerPolytope& hull, const double* centre, HullTables& tables) {
  const auto corner = [&](std::size_t f, unsigned j) {
    return hull.vertices.data() + std::size_t{hull.facets[f * D + j]} * D;
  };
  tables.simplices.reserve(hull.facets.size() / D * (2 * D + 1));
  for (std::size_t f = 0; f < hull.facets.size() / D; ++f) {
    double normal[D], sum = 0, farthest = 0;
    double factor = normal_and_reach<D>([&](unsigned j) { return corner(f, j); }, normal);
    const double* const first = corner(f, 0);
    for (unsigned j = 0; j < D; ++j) {
      const double apart = centre[j] - first[j];
      sum += normal[j] * apart;
      farthest = std::max(farthest, std::fabs(apart));
    }
    if (!(std::fabs(sum) > factor * farthest + 0x1p-540))
      factor = std::numeric_limits<double>::infinity();
    tables.simplices.insert(tables.simplices.end(), first, first + D);
    for (const double n : normal) tables.simplices.push_back(sum > 0 ? -n : n);
    tables.simplices.push_back(factor);
  }
}

}  // namespace

std::optional<HullTables> hull_tables(const InnerPolytope& hull,
                                      const std::vector<double>& planes) {
  const unsigned d = hull.dimension;
  if (d < 2 || d > HullTables::most_dimensions) return std::nullopt;
  HullTables tables;
  tables.dimension = d;
  tables.planes = planes;
  tables.low.assign(hull.vertices.begin(), hull.vertices.begin() + d);
  tables.high = tables.low;
  for (std::size_t i = 0; i < hull.vertices.size(); ++i) {
    tables.low[i % d] = std::min(tables.low[i % d], hull.vertices[i]);
    tables.high[i % d] = std::max(tables.high[i % d], hull.vertices[i]);
  }
  std::vector<double> centre(d);
  double extent = 0;
  for (unsigned j = 0; j < d; ++j) {
    extent = std::max(extent, tables.high[j] - tables.low[j]);
    centre[j] = tables.low[j] + (tables.high[j] - tables.low[j]) / 2;
  }
  if (!(extent > 0x1p-100) || !(extent < 0x1p100)) return std::nullopt;
  // The middle of the box may be outside of the hull; the vertices' mean is inside, up to rounding.
  std::vector<double> mean(d);
  const double count = static_cast<double>(hull.vertices.size() / d);
  tables.vertices.resize(hull.vertices.size());
  for (std::size_t i = 0; i < hull.vertices.size(); ++i) {
    const double relative = hull.vertices[i] - centre[i % d];
    tables.vertices[i] = relative;
    tables.vertex_reach = std::max(tables.vertex_reach, std::fabs(relative));
    mean[i % d] += relative / count;
  }
  for (unsigned j = 0; j < d; ++j) mean[j] += centre[j];
  with_dimension<2, 5, 6>(d, [&](auto k) { add_simplices<k()>(hull, mean.data(), tables); });
  return tables;
}

namespace {

/// What the device writes for the sides of a point; for the host these are items of an array.
template <class Out>
SideCodes codes_of() {
  static_assert(sizeof(Out) == 1);
  if constexpr (std::is_same_v<Out, Side>)
    return {static_cast<std::uint8_t>(Side::inside), static_cast<std::uint8_t>(Side::outside)};
  else
    return {1, 0};
}

Options on_host(const Options& options) {
  Options o = options;
  o.backend = Backend::cpu;
  return o;
}

}  // namespace

DeviceQuestions::DeviceQuestions(const DevicePointView& points, const HullTables* tables,
                                 KeptTables& kept, const Options& options, AnswersIn answers_in)
    : points_(points),
      tables_(tables),
      options_(on_host(options)),
      run_(options_),
      device_allowed_(options.backend != Backend::cpu),
      must_(options.backend == Backend::cuda),
      answers_stay_(answers_in == AnswersIn::device) {
  check_arguments(points);
  run_.check();
  if (points.count == 0)
    require_cuda();
  else
    device_ = questions_on_device(points, tables_, kept, options_);
}

/// there(way, first, count, out): writes the device's answers about a piece to `out` on the device,
/// and returns the ids of the points that it left open, about which the host is asked.
template <class Out, class There>
void DeviceQuestions::answer(Out* out, AskedPoints asked, const There& there,
                             const Here<Out>& here) {
  if (points_.count == 0) return;
  if (answers_stay_) device_->require_room(out, sizeof(Out));
  asked.count = points_.count;
  asked.dimension = points_.dimension;
  asked.point_bytes = points_.dimension * scalar_size(points_.scalar);
  asked.threads = run_.threads;
  asked.cpu_allowed = !must_;
  asked.answers_stay = answers_stay_;
  const bool can = device_allowed_ && (asked.tests > 0 || asked.cells > 0);
  const Answerer way = can ? choose_answerer(asked) : Answerer::cpu;
  if (way != Answerer::cpu) try {
      for (std::uint64_t first = 0; first < points_.count; first += piece) {
        run_.report("query", static_cast<double>(first) / static_cast<double>(points_.count));
        run_.check();
        const std::uint64_t count = std::min(piece, points_.count - first);
        auto* const found =
            answers_stay_ ? out + first : static_cast<Out*>(device_->room(count * sizeof(Out)));
        const std::vector<std::uint64_t> open = there(way, first, count, found);
        if (!answers_stay_) device_->fetch(out + first, found, count * sizeof(Out));
        ask_rest(open, out, here);
      }
      return;
    } catch (const OutOfMemory&) {
      if (must_) throw;
    }
  ask_all_here(out, here);
}

template <class Out>
void DeviceQuestions::ask_all_here(Out* out, const Here<Out>& here) const {
  const Array<double> rows = device_->all_rows(run_);
  const auto view = PointView::row_major(rows.data(), points_.count, points_.dimension);
  if (!answers_stay_) return here(view, out, options_);
  std::vector<Out> answers(points_.count);
  here(view, answers.data(), options_);
  device_->put(out, answers.data(), answers.size() * sizeof(Out));
}

template <class Out>
void DeviceQuestions::ask_rest(const std::vector<std::uint64_t>& open, Out* out,
                               const Here<Out>& here) const {
  if (open.empty()) return;
  const Array<double> rows = device_->rows(open, run_);
  check_rows_finite(rows.data(), open.size(), points_.dimension, open.data(), run_);
  std::vector<Out> answers(open.size());
  here(PointView::row_major(rows.data(), open.size(), points_.dimension), answers.data(), options_);
  if (answers_stay_) {
    device_->put_items(out, open, answers.data(), sizeof(Out));
  } else {
    for (std::size_t k = 0; k < open.size(); ++k) out[open[k]] = answers[k];
  }
}

template <class Out>
void DeviceQuestions::sides(const SideTables& tables, Out* out, const Here<Out>& here) {
  AskedPoints asked;
  asked.tests = tables_ != nullptr ? tables_->simplex_count() : 0;
  asked.cells = tables.cells;
  asked.cells_built = tables.cells_built;
  asked.asked_before = tables.asked_before;
  answer(
      out, asked,
      [&](Answerer way, std::uint64_t first, std::uint64_t count, Out* found) {
    auto* const bytes = reinterpret_cast<std::uint8_t*>(found);
    if (way == Answerer::device) {
      const GaugeMap* const inner = tables.inner();
      return device_->sides(inner != nullptr ? &inner->table() : nullptr, codes_of<Out>(), first,
                            count, bytes);
    }
    return device_->sides(tables.facet_cells(run_)->table(), codes_of<Out>(), first, count, bytes);
      },
      here);
}

template void DeviceQuestions::sides(const SideTables&, Side*, const Here<Side>&);
template void DeviceQuestions::sides(const SideTables&, std::uint8_t*, const Here<std::uint8_t>&);

void DeviceQuestions::supports(const std::vector<std::uint64_t>& ids, std::uint64_t* out,
                               const Here<std::uint64_t>& here) {
  AskedPoints asked;
  asked.question = Question::supports;
  asked.tests = tables_ != nullptr ? ids.size() : 0;
  answer(
      out, asked,
      [&](Answerer, std::uint64_t first, std::uint64_t count, std::uint64_t* found) {
    return device_->supports(ids, first, count, found);
      },
      here);
}

void DeviceQuestions::distances(double* out, const Here<double>& here) {
  AskedPoints asked;
  asked.question = Question::distances;
  asked.tests = tables_ != nullptr ? 2 * tables_->simplex_count() : 0;  // and as many planes
  answer(
      out, asked,
      [&](Answerer, std::uint64_t first, std::uint64_t count, double* found) {
    return device_->distances(first, count, found);
      },
      here);
}

}  // namespace cullhull::internal
