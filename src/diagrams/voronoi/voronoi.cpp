// voronoi(): vertices, rays and regions. ridges.cpp writes the ridges, and both in the plane.
#include "cullhull/voronoi.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "cullhull/error.hpp"
#include "diagrams/dual.hpp"
#include "diagrams/memory_needs.hpp"
#include "exact/insphere/circumcentre.hpp"
#include "exact/insphere/circumcentres.hpp"
#include "geometry/gather.hpp"
#include "parallel/adjacency.hpp"
#include "parallel/memory/pages.hpp"

namespace cullhull::internal {
namespace {

void write_rays(const DualPoints& p, const Triangulation& t, Voronoi& out, const Run& run) {
  const unsigned k = t.corners() - 1, d = t.dimension;
  const std::uint64_t count = t.hull_facet_count();
  out.ray_vertices.resize(count);
  out.ray_directions.resize(count * d);
  run.each(count, light_grain / 64, [&](std::uint64_t begin, std::uint64_t end) {
    std::vector<const double*> rows(k);
    for (std::uint64_t f = begin; f < end; ++f) {
      const auto facet = t.hull_facet(f);
      const auto cell = t.cell(t.hull_cells[f]);
      for (unsigned i = 0; i < k; ++i) rows[i] = p.row(facet[i]);
      const auto opposite = std::find_if(cell.begin(), cell.end(), [&](std::uint32_t v) {
        return std::find(facet.begin(), facet.end(), v) == facet.end();
      });
      double* direction = out.ray_directions.data() + f * d;
      outward_direction(d, k, rows.data(), p.row(*opposite), direction);
      if (t.furthest_site)
        for (unsigned j = 0; j < d; ++j) direction[j] = direction[j] == 0 ? 0 : -direction[j];
      out.ray_vertices[f] = t.group(t.hull_cells[f]);
    }
  });
}

/// For k != 2.
void write_regions(const Triangulation& t, const Adjacency<std::uint32_t>& stars, Voronoi& out,
                   const Run& run) {
  std::vector<bool> unbounded(t.point_count);
  for (const std::uint32_t v : t.hull_facets) unbounded[v] = true;
  if (t.corners() == 1) unbounded[t.cells[0]] = true;
  ChunkedListBuilder lists(t.point_count);
  run.each_chunk(t.point_count, lists.grain,
                 [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
    std::vector<std::uint32_t> list;
    for (std::uint64_t v = begin; v < end; ++v) {
      list.clear();
      const auto star = stars[v];
      if (t.corners() > 1)
        for (const std::uint32_t c : star) list.push_back(t.group(c));
      if (unbounded[v]) list.push_back(at_infinity);
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
      lists.add(chunk, list);
    }
  });
  out.regions = lists.join(run);
}

void require_list(bool holds, const char* what) {
  if (!holds)
    throw Error(ErrorCode::invalid_argument, "this is no triangulation: its ", what,
                " are not those of its cells and points");
}

/// Linear time. Groups are numbered in the order of their first cells.
void require_lists(const Triangulation& t, const Run& run) {
  const std::size_t m = t.corners(), cells = t.size();
  require_list(t.affine_dimension >= -1 && t.affine_dimension <= static_cast<int>(t.dimension) &&
                   t.axes.size() + (m == 0 ? 0 : 1) == m &&
                   std::is_sorted(t.axes.begin(), t.axes.end(), std::less_equal<>()) &&
                   (t.axes.empty() || t.axes.back() < t.dimension),
               "axes");
  require_list(t.cells.size() == cells * m && (m != 1 || cells == 1), "cells");
  require_list(t.neighbours.size() == t.cells.size(), "neighbours");
  require_list(t.hull_facets.size() == t.hull_cells.size() * (m == 0 ? 0 : m - 1), "hull_facets");
  const auto below = [](const auto& list, std::uint64_t end) {
    return std::all_of(list.begin(), list.end(), [end](std::uint32_t v) { return v < end; });
  };
  require_list(below(t.hull_facets, t.point_count), "hull_facets");
  require_list(below(t.hull_cells, cells), "hull_cells");
  require_list(t.cell_groups.empty() || t.cell_groups.size() == cells, "cell_groups");
  for (std::uint32_t groups = 0; const std::uint32_t g : t.cell_groups) {
    require_list(g <= groups, "cell_groups");
    if (g == groups) ++groups;
  }
  run.each(cells, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t c = begin; c < end; ++c) {
      const auto v = t.cell(c);
      for (unsigned i = 0; i < m; ++i) {
        require_list(v[i] < t.point_count, "cells");
        for (unsigned j = 0; j < i; ++j) require_list(v[i] != v[j], "cells");
        const std::uint32_t o = t.neighbours_of(c)[i];
        require_list(o < cells || o == no_index, "neighbours");
      }
    }
  });
}

}  // namespace

void bad_neighbours() {
  throw Error(ErrorCode::invalid_argument,
              "this is no triangulation of these points: its neighbours do not fit together");
}

void require_points_of(const Triangulation& t, const PointView& points,
                       std::span<const double> weights, const Run& run) {
  if (points.dimension != t.dimension || points.count != t.point_count)
    throw Error(ErrorCode::invalid_argument, "the triangulation is of ", t.point_count,
                " points in dimension ", t.dimension, ", not of ", points.count, " in dimension ",
                points.dimension);
  if (points.count > 0) require_points(points);
  if (!weights.empty()) require_weights(weights, points.count);
  require_lists(t, run);
}

void require_unweighted(const Triangulation& t, const char* what) {
  if (t.furthest_site || !t.hidden.empty())
    throw Error(ErrorCode::invalid_argument, what,
                " are of Delaunay triangulations without weights, not of the "
                "furthest site");
}

DualPoints::DualPoints(const PointView& points, const Triangulation& t,
                       std::span<const double> weights, const Run& run)
    : stride_(t.dimension + (weights.empty() ? 0 : 1)), weighted_(!weights.empty()) {
  require_points_of(t, points, weights, run);
  rows_ = gather_points(points, nullptr, points.count, run);
  if (!weighted_) return;
  const unsigned d = t.dimension;
  Array<double> rows(points.count * stride_);
  for (std::uint64_t i = 0; i < points.count; ++i) {
    std::copy_n(rows_.data() + i * d, d, rows.data() + i * stride_);
    rows[i * stride_ + d] = weights[i];
  }
  rows_ = std::move(rows);
}

Array<std::uint32_t> first_cells(const Triangulation& t) {
  Array<std::uint32_t> first;
  if (t.cell_groups.empty()) return first;
  for (std::uint32_t c = 0; c < t.size(); ++c)
    if (t.group(c) == first.size()) first.push_back(c);
  return first;
}

void write_vertices(const DualPoints& p, const Triangulation& t, Voronoi& out, const Run& run) {
  const unsigned k = t.corners() - 1, d = t.dimension;
  if (k == 0) return;
  const Array<std::uint32_t> first = first_cells(t);
  const std::uint64_t groups = first.empty() ? t.size() : first.size();
  out.vertices.resize(groups * d);
  const auto cell_of = [&](std::uint64_t g) { return t.cell(first.empty() ? g : first[g]); };
  const bool by_blocks = d == k && !p.weighted() && has_centres_block(k);
  run.each(groups, light_grain / 64, [&](std::uint64_t begin, std::uint64_t end) {
    std::vector<const double*> rows(k + 1);
    const auto write = [&](std::uint64_t g) {
      const auto cell = cell_of(g);
      for (unsigned i = 0; i <= k; ++i) rows[i] = p.row(cell[i]);
      circumcentre(d, k, p.weighted(), rows.data(), out.vertices.data() + g * d);
    };
    if (!by_blocks) {
      for (std::uint64_t g = begin; g < end; ++g) write(g);
      return;
    }
    std::vector<double> corners(std::size_t{k + 1} * k * centres_block), centres(corners.size());
    for (std::uint64_t base = begin; base < end; base += centres_block) {
      const std::uint64_t count = std::min<std::uint64_t>(centres_block, end - base);
      load_block(p, k, base, count, cell_of, corners.data());
      circumcentres_double_double(k, corners.data(), centres.data());
      for (std::uint64_t lane = 0; lane < count; ++lane) {
        double* const centre = out.vertices.data() + (base + lane) * k;
        bool known = true;
        for (unsigned j = 0; j < k; ++j) {
          centre[j] = centres[j * centres_block + lane];
          known = known && !std::isnan(centre[j]);
        }
        if (!known) write(base + lane);
      }
    }
  });
}

}  // namespace cullhull::internal

namespace cullhull {

Voronoi voronoi(const PointView& points, const Triangulation& triangulation,
                std::span<const double> weights, const RunOptions& options) {
  using namespace internal;
  const Call call(options);
  const Run& run = call.run;
  const Triangulation& t = triangulation;
  const std::uint64_t k = t.corners() == 0 ? 0 : t.corners() - 1;
  begin_step(run, voronoi_bytes(t.point_count, t.size(), t.dimension, static_cast<unsigned>(k)),
             "the cells of the Voronoi diagram");
  Voronoi out;
  out.dimension = t.dimension;
  out.point_count = t.point_count;
  out.scalar = t.scalar;
  out.affine_dimension = t.affine_dimension;
  out.furthest_site = t.furthest_site;
  const DualPoints p(points, t, weights, run);
  if (t.corners() == 0) return out;
  run.report("vertices", 0);
  write_vertices(p, t, out, run);
  if (k > 0) write_rays(p, t, out, run);
  run.report("ridges", 0.4);
  const Adjacency<std::uint32_t> stars = k == 2 ? Adjacency<std::uint32_t>() : stars_of(t, run);
  write_ridges(p, t, stars, out, run);
  run.report("regions", 0.8);
  if (k != 2) write_regions(t, stars, out, run);
  run.report("done", 1);
  return out;
}

}  // namespace cullhull
