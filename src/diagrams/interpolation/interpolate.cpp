#include "cullhull/interpolate.hpp"

#include <algorithm>
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

  void add(std::uint32_t id, double weight, double* row) const {
    const double* value = of(id);
    for (std::uint32_t c = 0; c < components; ++c) row[c] += weight * value[c];
  }

  /// Calls body(view of a block of points, where to write their results) for each block, so that
  /// the memory does not depend on the number of points.
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
  const unsigned corners = query.corners();
  state_ = std::make_unique<State>(State{std::move(query), components, corners,
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
  s.query.interpolate(points, s.values.data(), s.components, {&outside, 1}, out, options);
}

void Interpolator::natural(const PointView& points, double* out, double outside,
                           const RunOptions& options) const {
  const State& s = *state_;
  s.require_natural();
  const Call call(options);
  s.each_block(points, out, [&](const PointView& part, double* to) {
    Array<std::uint32_t> cells(part.count);
    Array<double> shares(part.count * s.corners);
    s.query.find(part, cells.data(), options);
    s.query.barycentric(part, cells.data(), shares.data(), options);
    call.run.each(part.count, 256, [&](std::uint64_t begin, std::uint64_t end) {
      NaturalWeights natural(s.triangulation);
      NaturalNeighbours found;
      std::vector<double> point(part.dimension);
      for (std::uint64_t i = begin; i < end; ++i) {
        double* row = to + i * s.components;
        std::fill_n(row, s.components, cells[i] == no_index ? outside : 0);
        if (cells[i] == no_index) continue;
        load_row(part, i, point.data());
        natural.find(point.data(), cells[i], shares.data() + i * s.corners, found);
        for (std::size_t n = 0; n < found.ids.size(); ++n)
          s.add(found.ids[n], found.weights[n], row);
      }
    });
  });
}

NaturalNeighbours Interpolator::natural_neighbours(const double* point) const {
  const State& s = *state_;
  s.require_natural();
  NaturalNeighbours found;
  const std::uint32_t cell = s.query.find(point);
  if (cell == no_index) return found;
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
      if (ids[i] == no_index)
        std::fill_n(to + i * s.components, s.components, outside);
      else
        std::copy_n(s.of(ids[i]), s.components, to + i * s.components);
  });
}

}  // namespace cullhull
