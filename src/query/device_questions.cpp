#include "query/device_questions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cuda/backend.hpp"
#include "exact/determinants/cofactors.hpp"
#include "flow/pipeline.hpp"
#include "geometry/gather.hpp"

namespace cullhull::internal::inline query {
namespace {

/// Points per piece: bounds the device memory for answers (at most 9 bytes a point, 38 MB) at the
/// cost of a launch and a copy per piece. Untested.
constexpr std::uint64_t piece = std::uint64_t{1} << 22;

/// Appends for each simplex a corner, the normal that points away from the centre, and the normal's
/// error factor, which is infinite where the centre's side is not certain.
template <unsigned D>
void add_simplices(const InnerPolytope& hull, const double* centre, cuda::HullTables& tables) {
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

std::optional<cuda::HullTables> hull_tables(const InnerPolytope& hull,
                                            const std::vector<double>& planes) {
  const unsigned d = hull.dimension;
  if (d < 2 || d > cuda::HullTables::most_dimensions) return std::nullopt;
  cuda::HullTables tables;
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
  switch (d) {
    case 2:
      add_simplices<2>(hull, mean.data(), tables);
      break;
    case 3:
      add_simplices<3>(hull, mean.data(), tables);
      break;
    case 4:
      add_simplices<4>(hull, mean.data(), tables);
      break;
    case 5:
      add_simplices<5>(hull, mean.data(), tables);
      break;
    default:
      add_simplices<6>(hull, mean.data(), tables);
  }
  return tables;
}

namespace {

Options on_host(const Options& options) {
  Options o = options;
  o.backend = Backend::cpu;
  return o;
}

}  // namespace

DeviceQuestions::DeviceQuestions(const DevicePointView& points, const cuda::HullTables* tables,
                                 const Options& options)
    : points_(points),
      tables_(options.backend == Backend::cpu ? nullptr : tables),
      options_(on_host(options)),
      run_(options_),
      must_(options.backend == Backend::cuda) {
  check_arguments(points);
  run_.check();
  if (points.count == 0)
    require_cuda();
  else
    device_.emplace(points, tables_);
}

/// there(first, count, open): gets the device's answers about a piece, and appends to `open` the
/// ids of the points that it left undecided, about which the host is asked.
template <class Out, class There>
void DeviceQuestions::answer(Out* out, Question question, std::uint64_t tests, const There& there,
                             const Here<Out>& here) {
  if (points_.count == 0) return;
  const std::uint64_t bytes = points_.dimension * scalar_size(points_.scalar);
  const AskedPoints asked{question, points_.count, points_.dimension, bytes, run_.threads, tests};
  if (tables_ != nullptr && (must_ || device_answers_sooner(asked, options_.machine))) try {
      for (std::uint64_t first = 0; first < points_.count; first += piece) {
        run_.report("query", static_cast<double>(first) / static_cast<double>(points_.count));
        run_.check();
        std::vector<std::uint64_t> open;
        there(first, std::min(piece, points_.count - first), open);
        ask_rest(open, out, here);
      }
      return;
    } catch (const cuda::OutOfMemory&) {
      if (must_) throw;
    }
  const Array<double> rows = device_->all_rows(run_);
  here(PointView::row_major(rows.data(), points_.count, points_.dimension), out, options_);
}

template <class Out>
void DeviceQuestions::ask_rest(const std::vector<std::uint64_t>& open, Out* out,
                               const Here<Out>& here) const {
  if (open.empty()) return;
  const Array<double> rows = device_->rows(open, run_);
  check_rows_finite(rows.data(), open.size(), points_.dimension, open.data(), run_);
  std::vector<Out> answers(open.size());
  here(PointView::row_major(rows.data(), open.size(), points_.dimension), answers.data(), options_);
  for (std::size_t k = 0; k < open.size(); ++k) out[open[k]] = answers[k];
}

/// Throws the error that names point `id`, which is not finite.
void DeviceQuestions::refuse(std::uint64_t id) const {
  const Array<double> row = device_->rows({id}, run_);
  check_rows_finite(row.data(), 1, points_.dimension, &id, run_);
  throw Error(ErrorCode::internal, "points on the device changed during the call");
}

void DeviceQuestions::sides(const GaugeTable* inner, Side* out, const Here<Side>& here) {
  std::vector<cuda::PointAnswer> found;
  answer(
      out, Question::sides, tables_ != nullptr ? tables_->simplex_count() : 0,
      [&](std::uint64_t first, std::uint64_t count, std::vector<std::uint64_t>& open) {
    found.resize(count);
    device_->sides(inner, first, count, found.data(), nullptr);
    for (std::uint64_t i = 0; i < count; ++i) {
      if (found[i] == cuda::PointAnswer::not_finite) refuse(first + i);
      if (found[i] == cuda::PointAnswer::open)
        open.push_back(first + i);
      else
        out[first + i] = found[i] == cuda::PointAnswer::inside ? Side::inside : Side::outside;
    }
      },
      here);
}

void DeviceQuestions::supports(const std::vector<std::uint64_t>& ids, std::uint64_t* out,
                               const Here<std::uint64_t>& here) {
  std::vector<std::uint32_t> found;
  answer(
      out, Question::supports, ids.size(),
      [&](std::uint64_t first, std::uint64_t count, std::vector<std::uint64_t>& open) {
    found.resize(count);
    device_->supports(first, count, found.data());
    for (std::uint64_t i = 0; i < count; ++i)
      if (found[i] == cuda::open_vertex)
        open.push_back(first + i);
      else
        out[first + i] = ids[found[i]];
      },
      here);
}

void DeviceQuestions::distances(double* out, const Here<double>& here) {
  constexpr double least = std::numeric_limits<double>::denorm_min();
  std::vector<cuda::PointAnswer> found;
  answer(
      out, Question::distances,
      tables_ != nullptr ? 2 * tables_->simplex_count() : 0,  // and as many planes
      [&](std::uint64_t first, std::uint64_t count, std::vector<std::uint64_t>& open) {
    found.resize(count);
    device_->sides(nullptr, first, count, found.data(), out + first);
    for (std::uint64_t i = 0; i < count; ++i) {
      if (found[i] == cuda::PointAnswer::not_finite) refuse(first + i);
      if (found[i] == cuda::PointAnswer::inside)
        out[first + i] = std::min(out[first + i], -least);
      else
        open.push_back(first + i);
    }
      },
      here);
}

}  // namespace cullhull::internal::inline query
