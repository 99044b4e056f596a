#include "batch/small_sets.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "hull/small_3d.hpp"
#include "result/facet_kernel.hpp"
#include "result/facet_share.hpp"

namespace cullhull::internal {
namespace {

constexpr unsigned lanes = FacetBlock<3>::lanes, most_facets = SmallHull3D::max_facets;
using Number = std::uint8_t;

/// The facets in canonical order. Vertices by their position among all vertices.
struct Canonical {
  std::vector<std::uint64_t> ids;  // of the vertices, ascending
  unsigned count = 0;
  std::uint32_t vertices[most_facets][3];  // counter-clockwise from the lowest: the stored order
  Number neighbours[most_facets][3];       // opposite to each vertex
};

/// One list more, or several.
template <class T>
T* extend(Array<T>& to, std::size_t count) {
  const std::size_t size = to.size();
  to.resize(size + count);
  return to.data() + size;
}

bool load(const PointView& set, SmallPoints3D& points) {
  bool finite = true;
  for (unsigned c = 0; c < 3; ++c) {
    double* const axis = points.axes[c];
    if (set.scalar == ScalarType::f64)
      for (std::uint64_t i = 0; i < set.count; ++i)
        std::memcpy(axis + i, set.address(i, c), sizeof(double));
    else
      for (std::uint64_t i = 0; i < set.count; ++i) axis[i] = set.at(i, c);
    for (std::uint64_t i = 0; i < set.count; ++i)
      finite &= std::fabs(axis[i]) <= std::numeric_limits<double>::max();
    std::fill(axis + set.count, axis + (set.count + 15) / 16 * 16, axis[0]);
  }
  return finite;
}

void order_facets(const SmallHull3D& hull, Canonical& out) {
  // Which points are vertices, and their positions.
  std::uint64_t used[2] = {0, 0};
  for (unsigned f = 0; f < hull.count; ++f)
    for (const Number v : hull.vertices[f]) used[v / 64] |= std::uint64_t{1} << v % 64;
  Number position[SmallHull3D::max_points];
  out.ids.clear();
  for (unsigned w = 0; w < 2; ++w)
    for (std::uint64_t rest = used[w]; rest != 0; rest &= rest - 1) {
      const unsigned v = 64 * w + static_cast<unsigned>(std::countr_zero(rest));
      position[v] = static_cast<Number>(out.ids.size());
      out.ids.push_back(v);
    }
  // Keys: the vertices from the lowest, then the facet and which vertex is its lowest. Sorted by
  // counting on the lowest, then by insertion among the few that share it.
  out.count = hull.count;
  std::uint32_t keys[most_facets], sorted[most_facets];
  Number start[SmallHull3D::max_points + 1] = {};
  for (unsigned f = 0; f < hull.count; ++f) {
    const std::uint32_t a = position[hull.vertices[f][0]], b = position[hull.vertices[f][1]],
                        c = position[hull.vertices[f][2]];
    const unsigned low = a < b ? (a < c ? 0 : 2) : (b < c ? 1 : 2);
    const std::uint32_t x = low == 0 ? b : low == 1 ? c : a, y = low == 0 ? c : low == 1 ? a : b;
    keys[f] = x << 17 | y << 10 | low << 8 | f;
    ++start[(low == 0 ? a : low == 1 ? b : c) + 1];
  }
  for (std::size_t v = 1; v <= out.ids.size(); ++v)
    start[v] = static_cast<Number>(start[v] + start[v - 1]);
  Number end[SmallHull3D::max_points];
  std::copy_n(start, out.ids.size(), end);
  for (unsigned f = 0; f < hull.count; ++f) {
    const unsigned lowest = position[hull.vertices[f][keys[f] >> 8 & 3]];
    unsigned at = end[lowest]++;
    for (; at > start[lowest] && keys[f] < sorted[at - 1]; --at) sorted[at] = sorted[at - 1];
    sorted[at] = keys[f];
  }
  Number rank[most_facets];
  for (unsigned i = 0; i < hull.count; ++i) rank[sorted[i] & 0xFF] = static_cast<Number>(i);
  for (unsigned i = 0; i < hull.count; ++i) {
    const unsigned f = sorted[i] & 0xFF, low = sorted[i] >> 8 & 3;
    for (unsigned j = 0; j < 3; ++j) {
      const unsigned slot = (low + j) % 3;
      out.vertices[i][j] = position[hull.vertices[f][slot]];
      out.neighbours[i][j] = rank[hull.neighbours[f][slot]];
    }
  }
}

/// Planes and measures, as the general path computes them.
bool measure(const Frame& frame, const Canonical& facets, double* planes, Hull& measures) {
  const FacetPlane<3> plane(frame);
  FacetBlock<3> block;
  for (unsigned c = 0; c < 3; ++c) std::fill_n(block.origin[c], lanes, frame.at(0)[c]);
  Share<3> runs[most_facets / measure_run + 1], run;
  for (unsigned first = 0; first < facets.count; first += lanes) {
    const unsigned n = std::min(lanes, facets.count - first);
    for (unsigned lane = 0; lane < lanes; ++lane)
      for (unsigned j = 0; j < 3; ++j) {
        const double* p = frame.at(facets.vertices[first + std::min(lane, n - 1)][j]);
        for (unsigned c = 0; c < 3; ++c) block.corner[j][c][lane] = p[c];
      }
    facet_block(block);
    for (unsigned lane = 0; lane < n; ++lane) {
      const unsigned i = first + lane;
      double normal[3], sum[3];
      for (unsigned c = 0; c < 3; ++c) {
        normal[c] = block.normal[c][lane];
        sum[c] = block.sum[c][lane];
      }
      if (i % measure_run == 0) run = {};
      run.add(facet_share<3>(frame, plane, facets.vertices[i],
                             !(block.length[lane] > conditioned * block.edges[lane]), normal, sum,
                             planes + std::size_t{4} * i));
      if ((i + 1) % measure_run == 0 || i + 1 == facets.count) runs[i / measure_run] = run;
    }
  }
  const Totals<DoubleDouble> all = total_of_runs(runs, chunk_count(facets.count, measure_run), 1);
  if (!settled(all, 0x1p-53)) return false;
  finish_measures(frame, all, measures);
  return true;
}

void write(const PointView& set, const Canonical& facets, const Hull& measures, HullBatch& to) {
  to.point_counts.push_back(set.count);
  to.affine_dimensions.push_back(3);
  to.volumes.push_back(measures.volume);
  to.areas.push_back(measures.area);
  to.centroids.insert(to.centroids.end(), measures.centroid.begin(), measures.centroid.end());
  std::copy(facets.ids.begin(), facets.ids.end(), extend(to.vertices.items, facets.ids.size()));
  to.vertices.offsets.push_back(to.vertices.items.size());

  const std::size_t n = facets.count;
  to.facet_starts.push_back(to.facet_starts.back() + n);
  std::uint64_t at = to.facets.offsets.back(), across_at = to.facet_neighbours.offsets.back();
  for (std::size_t i = 0; i < n; ++i) {
    to.facets.offsets.push_back(at += 3);
    to.facet_neighbours.offsets.push_back(across_at += 3);
  }
  std::uint64_t* facet = extend(to.facets.items, 3 * n);
  std::uint64_t* simplex = extend(to.simplices.items, 3 * n);
  std::uint32_t* beside = extend(to.facet_neighbours.items, 3 * n);
  std::uint32_t* across = extend(to.simplex_neighbours.items, 3 * n);
  std::uint32_t* number = extend(to.simplex_facets.items, n);
  for (std::size_t i = 0; i < n; ++i) {
    number[i] = static_cast<std::uint32_t>(i);
    for (std::size_t j = 0; j < 3; ++j) {
      facet[3 * i + j] = simplex[3 * i + j] = facets.ids[facets.vertices[i][j]];
      across[3 * i + j] = facets.neighbours[i][j];
      beside[3 * i + j] = facets.neighbours[i][(j + 2) % 3];  // across the edge from vertex j
    }
  }
  to.simplices.offsets.push_back(to.simplices.items.size());
  to.simplex_neighbours.offsets.push_back(to.simplex_neighbours.items.size());
  to.simplex_facets.offsets.push_back(to.simplex_facets.items.size());
}

}  // namespace

bool append_small_3d(const PointView& set, HullBatch& to) {
  if (set.dimension != 3 || set.count < 4 || set.count > SmallHull3D::max_points) return false;
  SmallPoints3D points;
  SmallHull3D hull;
  if (!load(set, points) || !small_hull_3d(points, static_cast<unsigned>(set.count), hull))
    return false;
  Canonical facets;
  order_facets(hull, facets);
  constexpr unsigned axes[3] = {0, 1, 2};
  const Frame frame = make_frame(set, facets.ids, axes, 3, 1);
  if (frame.wild) return false;
  const std::size_t planes = to.facet_planes.size();
  Hull measures;
  if (!measure(frame, facets, extend(to.facet_planes, std::size_t{4} * facets.count), measures)) {
    to.facet_planes.resize(planes);
    return false;
  }
  write(set, facets, measures, to);
  return true;
}

}  // namespace cullhull::internal
