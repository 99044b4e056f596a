#include "cullhull/interpolate.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "cullhull/error.hpp"
#include "diagrams/interpolation/natural_weights.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull {

using namespace internal;

struct Interpolator::State {
  TriangulationQuery query;
  std::uint32_t components;
  unsigned corners;
  Array<double> values;
  NaturalTriangulation triangulation;

  void require_natural() const {
    if (corners > 4)
      throw Error(ErrorCode::invalid_argument,
                  "natural neighbours are of points in up to 3 dimensions, not in ", corners - 1);
  }

  const double* of(std::uint32_t id) const { return values.data() + std::size_t{id} * components; }

  /// body(view of a part of the points, where its results go): memory stays the same for any
  /// number of points.
  template <class Body>
  void each_block(const PointView& points, double* out, const Body& body) const {
    constexpr std::uint64_t block = std::uint64_t{1} << 20;
    for (std::uint64_t first = 0; first < points.count; first += block) {
      PointView part = points;
      part.data = points.address(first, 0);
      part.count = std::min(block, points.count - first);
      body(part, out + first * components);
    }
  }

  /// The cell of each point, or no_cell, and its barycentric coordinates there.
  struct Located {
    Array<std::uint32_t> cells;
    Array<double> shares;
  };
  Located locate(const PointView& part, const RunOptions& options) const {
    Located found{Array<std::uint32_t>(part.count), Array<double>(part.count * corners)};
    query.find(part, found.cells.data(), options);
    query.barycentric(part, found.cells.data(), found.shares.data(), options);
    return found;
  }
};

Interpolator::Interpolator(const PointView& points, const Triangulation& triangulation,
                           const double* values, std::uint32_t components,
                           const RunOptions& options) {
  if (components == 0)
    throw Error(ErrorCode::invalid_argument, "values need at least one component");
  if (values == nullptr && points.count > 0)
    throw Error(ErrorCode::invalid_argument, "values is null");
  if (triangulation.furthest_site || triangulation.weighted)
    throw Error(ErrorCode::invalid_argument,
                "interpolation needs a Delaunay triangulation, neither weighted nor of the "
                "furthest site");
  const Call call(options);
  TriangulationQuery query(points, triangulation, {}, options);
  state_ = std::make_unique<State>(State{std::move(query), components, triangulation.corners(),
                                         Array<double>(values, values + points.count * components),
                                         NaturalTriangulation(points, triangulation, call.run)});
}
Interpolator::~Interpolator() = default;
Interpolator::Interpolator(Interpolator&&) noexcept = default;
Interpolator& Interpolator::operator=(Interpolator&&) noexcept = default;

std::uint32_t Interpolator::components() const noexcept { return state_->components; }
const TriangulationQuery& Interpolator::query() const noexcept { return state_->query; }

void Interpolator::linear(const PointView& points, double* out, double outside,
                          const RunOptions& options) const {
  const State& s = *state_;
  const Call call(options);
  const Run& run = call.run;
  s.each_block(points, out, [&](const PointView& part, double* to) {
    const auto located = s.locate(part, options);
    const auto& cells = located.cells;
    const auto& shares = located.shares;
    run.each(part.count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        double* row = to + i * s.components;
        std::fill_n(row, s.components, cells[i] == no_cell ? outside : 0);
        if (cells[i] == no_cell) continue;
        for (unsigned j = 0; j < s.corners; ++j) {
          const double share = shares[i * s.corners + j];
          if (share == 0) continue;  // whatever the value there is
          const double* value = s.of(s.triangulation.cell(cells[i])[j]);
          for (std::uint32_t c = 0; c < s.components; ++c) row[c] += share * value[c];
        }
      }
    });
  });
}

void Interpolator::natural(const PointView& points, double* out, double outside,
                           const RunOptions& options) const {
  const State& s = *state_;
  s.require_natural();
  const Call call(options);
  const Run& run = call.run;
  s.each_block(points, out, [&](const PointView& part, double* to) {
    const auto located = s.locate(part, options);
    const auto& cells = located.cells;
    const auto& shares = located.shares;
    run.each(part.count, 256, [&](std::uint64_t begin, std::uint64_t end) {
      NaturalWeights natural(s.triangulation);
      NaturalNeighbours found;
      std::vector<double> point(part.dimension);
      for (std::uint64_t i = begin; i < end; ++i) {
        double* row = to + i * s.components;
        std::fill_n(row, s.components, cells[i] == no_cell ? outside : 0);
        if (cells[i] == no_cell) continue;
        for (std::uint32_t j = 0; j < part.dimension; ++j) point[j] = part.at(i, j);
        natural.find(point.data(), cells[i], shares.data() + i * s.corners, found);
        for (std::size_t n = 0; n < found.ids.size(); ++n) {
          const double* value = s.of(found.ids[n]);
          for (std::uint32_t c = 0; c < s.components; ++c) row[c] += found.weights[n] * value[c];
        }
      }
    });
  });
}

NaturalNeighbours Interpolator::natural_neighbours(const double* point) const {
  const State& s = *state_;
  s.require_natural();
  NaturalNeighbours found;
  const std::uint32_t cell = s.query.find(point);
  if (cell == no_cell) return found;
  std::vector<double> shares(s.corners);
  s.query.barycentric(point, cell, shares.data());
  NaturalWeights(s.triangulation).find(point, cell, shares.data(), found);
  return found;
}

void Interpolator::nearest(const PointView& points, double* out, double outside,
                           const RunOptions& options) const {
  const State& s = *state_;
  s.each_block(points, out, [&](const PointView& part, double* to) {
    Array<std::uint32_t> ids(part.count);
    s.query.nearest(part, ids.data(), options);
    for (std::uint64_t i = 0; i < part.count; ++i)
      if (ids[i] == no_cell)
        std::fill_n(to + i * s.components, s.components, outside);
      else
        std::copy_n(s.of(ids[i]), s.components, to + i * s.components);
  });
}

}  // namespace cullhull
