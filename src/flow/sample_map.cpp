#include "flow/sample_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "cullhull/error.hpp"
#include "filter/gauge/gauge_build.hpp"
#include "filter/gauge/gauge_table.hpp"
#include "filter/planner.hpp"
#include "geometry/local_frame.hpp"
#include "hull/engine.hpp"
#include "parallel/random_stream.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

InnerPolytope inner_polytope(Array<double>&& rows, unsigned d, const Run& run) {
  InnerPolytope polytope;
  const auto count = static_cast<std::uint32_t>(rows.size() / d);
  const std::vector<double> original(rows.begin(), rows.end());
  const LocalFrame frame(std::move(rows), count, d, run);
  if (frame.affine_dimension() != static_cast<int>(d)) return polytope;
  Boundary hull;
  try {
    hull = d == 2   ? hull_2d(frame.points(), run)
           : d == 3 ? hull_3d(frame.points(), frame.simplex().data(), run)
                    : hull_nd(frame.points(), frame.simplex().data(), run, true);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::out_of_budget) throw;
    return polytope;  // no map; the final hull does not depend on it
  }
  // Renumber the vertices in use.
  constexpr std::uint32_t unused = 0xFFFFFFFF;
  std::vector<std::uint32_t> number(count, unused);
  for (std::uint32_t& v : hull.vertices) {
    if (number[v] == unused) {
      number[v] = static_cast<std::uint32_t>(polytope.vertices.size() / d);
      polytope.vertices.insert(polytope.vertices.end(), original.begin() + std::size_t{v} * d,
                               original.begin() + (std::size_t{v} + 1) * d);
    }
    v = number[v];
  }
  polytope.dimension = d;
  polytope.facets.assign(hull.vertices.begin(), hull.vertices.end());
  polytope.neighbours.assign(hull.neighbours.begin(), hull.neighbours.end());
  return polytope;
}

Array<std::uint64_t> sample_ids(std::uint64_t count, std::uint64_t size) {
  Array<std::uint64_t> ids(size);
  XorShift random;
  const double stretch = static_cast<double>(count) / static_cast<double>(size);
  for (std::uint64_t i = 0; i < size; ++i) {
    const double at =
        (static_cast<double>(i) + static_cast<double>(random.next() >> 11) * 0x1p-53) * stretch;
    ids[i] = std::min(count - 1, static_cast<std::uint64_t>(at));
  }
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

namespace {

/// As sample_ids(), but in runs of neighbours, which take fewer reads.
Array<std::uint64_t> sample_blocks(std::uint64_t count, std::uint64_t size, const Run& run) {
  constexpr std::uint64_t block = 256;
  const std::uint64_t runs = size / block;
  if (runs < 64 || count < 2 * size) return sample_ids(count, size);
  const Array<std::uint64_t> blocks = sample_ids(count / block, runs);
  Array<std::uint64_t> ids(blocks.size() * block);
  run.each(blocks.size(), 32, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin * block; i < end * block; ++i)
      ids[i] = blocks[i / block] * block + i % block;
  });
  return ids;
}

/// Whether few directions from the rows' mean have none of them near: a body, not a scan of the
/// ground, say. Leaders are found in most cells then.
bool around_their_mean(const Array<double>& rows, unsigned d) {
  const std::uint64_t count = rows.size() / d;
  const unsigned edge = d == 3 ? 4 : 2;
  std::vector<double> mean(d, 0), reach(d, 0);
  for (std::size_t e = 0; e < rows.size(); ++e) mean[e % d] += rows[e] / static_cast<double>(count);
  for (std::size_t e = 0; e < rows.size(); ++e)
    reach[e % d] = std::max(reach[e % d], std::abs(rows[e] - mean[e % d]));
  for (const double r : reach)
    if (!(r > 0 && std::isfinite(r))) return false;
  std::vector<char> met(2 * d << (d - 1) * (edge / 2), 0);
  std::vector<double> y(d);
  for (std::uint64_t i = 0; i < count; ++i) {
    unsigned axis = 0;
    for (unsigned j = 0; j < d; ++j) {
      y[j] = (rows[i * d + j] - mean[j]) / reach[j];
      axis = std::abs(y[j]) > std::abs(y[axis]) ? j : axis;
    }
    std::size_t cell = 2 * axis + (y[axis] < 0 ? 1 : 0);
    for (unsigned j = 0; j < d; ++j)
      if (j != axis)
        cell = cell * edge + static_cast<std::size_t>(std::clamp(
                                 (y[j] / std::abs(y[axis]) + 1) / 2 * edge, 0.0, edge - 1.0));
    met[cell] = 1;
  }
  return 4 * std::count(met.begin(), met.end(), 1) >= 3 * static_cast<std::ptrdiff_t>(met.size());
}

/// The least number of nodes of a 3D map. A hull of few facets has long creases, which a coarse map
/// cuts off, so more nodes than the facet count suggests are worthwhile. A node takes as long as
/// testing some 40 points, or as the engine on one point: hence a node per 1,024 points in the
/// first map and per 16 survivors in the second. At most 6,144 and 12,288 nodes leave 32,000 points
/// of an octahedron of 15 million instead of 60,000.
std::uint32_t least_nodes(std::uint64_t count, unsigned d, Insist insist) {
  if (d != 3) return 0;
  const std::uint64_t worth = insist == Insist::late ? std::min<std::uint64_t>(count / 16, 12288)
                                                     : std::min<std::uint64_t>(count / 1024, 6144);
  return static_cast<std::uint32_t>(worth);
}

}  // namespace

std::unique_ptr<GaugeMap> map_of_polytope(InnerPolytope polytope, std::uint64_t count,
                                          Insist insist, std::uint32_t most_nodes, const Run& run) {
  const GaugeSettings settings{.least_nodes = least_nodes(count, polytope.dimension, insist),
                               .most_nodes = most_nodes,
                               .threads = run.threads};
  return GaugeMap::build(std::move(polytope), settings);
}

LeaderCells cells_of_leaders(double outside, std::uint64_t tested, unsigned d,
                             std::uint32_t most_nodes) {
  const LeaderCounts counts = leader_counts(outside, tested, d);
  const double most = most_nodes > 0 ? most_nodes : counts.nodes;
  const bool sample = static_cast<double>(tested) > outside;
  return {cells_for(counts.leaders, d), cells_for(std::min(counts.nodes, most), d),
          sample && tested >= worth_a_core, sample ? 0.5 : 0};
}

namespace {

/// A probe of some hundred points tells whether a filter pays. From 3D on its hull's map tells
/// which points of a larger sample are outermost, and these leaders make the map: only the probe's
/// hull is one thread's. Where leaders do not suit, and in the plane, the map is that of the hull
/// of a sample. In the plane that takes as long as sorting it and leaves fewer points: of a disc of
/// 10^7 10,800, in 9.0 ms; leaders leave 82,000 in 10.0 ms.
struct MapSearch {
  const SampledPoints& points;
  const Insist insist;
  const std::uint32_t most_nodes;
  const Run& run;
  const std::uint64_t most_probes;
  // The last sample's hull, until a map is made of it; what is known of the sample.
  InnerPolytope polytope{};
  std::uint64_t size = 0, kept = 0;
  bool suits_leaders = false;
  std::string found{};
  std::unique_ptr<GaugeMap> map{};  ///< of leaders

  SampledMap find() {
    const unsigned d = points.dimension;
    const char* const flat = "a sample lies in a flat or its hull is too large";
    if (!take_sample(probe_sample_size(points.count, d))) return {nullptr, flat};
    if (insist == Insist::no && !cull_pays(points.count, d, size, kept))
      return {nullptr, found + ", so a filter does not pay"};
    if (suits_leaders && insist != Insist::late && wanted(true) > size && !try_leaders())
      return {nullptr, found + ", leaders leave nearly all, so a map does not pay"};
    const bool led = map != nullptr;
    if (!led && wanted(false) > size && !take_sample(wanted(false))) return {nullptr, flat};
    if (insist != Insist::yes && !map_pays(points.count, d, size, kept))
      return {nullptr, found + ", so a map does not pay"};
    if (!led) map = map_of_polytope(std::move(polytope), points.count, insist, most_nodes, run);
    found += map == nullptr          ? ", but the centre is not safely inside their hull"
             : insist == Insist::yes ? ", filter as asked"
                                     : ", so the filter pays";
    return {std::move(map), std::move(found), led, led && points.lead != nullptr};
  }

  /// Finds a sample's hull. False if it gives no map.
  bool take_sample(std::uint64_t most) {
    const unsigned d = points.dimension;
    const Array<std::uint64_t> ids = sample_ids(points.count, most);
    // In 3D few points of a sample are extreme (else no map is built), so its hull takes less than
    // a millisecond: dividing the surface between two threads takes longer than they save.
    constexpr std::uint64_t worth_threads = 1 << 15;
    const unsigned threads = d == 3 && most < worth_threads ? 1 : run.threads;
    Array<double> rows = points.gather(ids);
    // Below these counts the hull of a sample takes less time; from 5D on a sample of some hundred
    // points has none in most cells.
    const std::uint64_t least = d == 3 ? 1 << 18 : 1 << 16;
    suits_leaders = d > 2 && points.count >= least && (d > 4 || around_their_mean(rows, d));
    polytope = inner_polytope(std::move(rows), d, run.with_threads(threads));
    if (polytope.dimension == 0) return false;
    size = ids.size();
    kept = polytope.vertices.size() / d;
    found = sample_finding(size, kept);
    return true;
  }

  /// The size of the map's own sample.
  std::uint64_t wanted(bool leaders) const {
    const std::uint64_t best = map_sample_size(points.count, points.dimension, size, kept, leaders);
    const std::uint64_t most = run.budget / (32 * points.dimension * sizeof(double));
    return std::max(size,
                    std::min({best, most, best / most_probes >= size ? most_probes * size : best}));
  }

  // Where a fifth of the probe is extreme, the points may lie on a surface with relief, on which
  // leaders in valleys bound little: of a scanned body's 2 million points they leave 23 %, the hull
  // of a sample 6 %. An eighth of the sample tells: of a body it leaves less than 0.8 of the
  // probe's share, as more points lie nearer to the surface.

  /// Finds the map of leaders, if these suit. False if they leave nearly all points: no map pays.
  bool try_leaders() {
    const std::uint64_t most = wanted(true);
    const auto probe = map_of_polytope(InnerPolytope(polytope), most, insist, most_nodes, run);
    if (probe == nullptr) return true;
    std::uint64_t count = 0, left = 0;
    if (points.dimension == 3 && 5 * kept >= size) {
      const bool suit =
          lead(*probe, most / 8, count, left) != nullptr && 5 * left * size <= 4 * kept * count;
      if (left > 0 && insist == Insist::no && !map_pays(points.count, 3, count, left)) return false;
      if (!suit) return true;
    }
    map = lead(*probe, most, count, left);
    if (map == nullptr) return true;
    size = count;
    kept = left;
    found += std::string(", the leaders of ") + (points.lead ? "all points, tested with " : "") +
             std::to_string(size) + " leave " + std::to_string(kept);
    return true;
  }

  /// The map of the leaders of a sample of `most` points or, by points.lead, of all. Null unless it
  /// keeps fewer of `count` sampled points, `left`, than that of the probe's hull does, tested with
  /// most / 8 of them: a body must have points in most directions from its centre, which a scan of
  /// the ground has not.
  std::unique_ptr<GaugeMap> lead(const GaugeMap& probe, std::uint64_t most, std::uint64_t& count,
                                 std::uint64_t& left) const {
    const unsigned d = points.dimension;
    const bool all = points.lead != nullptr;
    const unsigned apart = all ? 1 : 8;  // of the sample, the points that are tested
    const Array<double> sample = points.gather(sample_blocks(points.count, most * apart / 8, run));
    count = sample.size() / d;
    const double outside = static_cast<double>(kept) / static_cast<double>(size) *
                           static_cast<double>(all ? points.count : count);
    const LeaderCounts counts = leader_counts_of_all(outside, d);
    const LeaderCells cells =
        all ? LeaderCells{cells_for(counts.leaders, d), cells_for(counts.nodes, d)}
            : cells_of_leaders(outside, points.count, d, most_nodes);
    auto led = all ? points.lead(probe, cells) : GaugeMap::of_leaders(sample, probe, cells, run);
    if (led == nullptr) return nullptr;
    auto rows = PointView::row_major(sample.data(), count / apart, d);
    rows.point_stride *= apart;
    std::uint64_t by[2];
    run.each_item(2, [&](std::uint64_t i) {
      by[i] = (i == 0 ? probe : *led).survivors(rows, run.with_threads(1)).size();
    });
    if (by[1] > by[0]) return nullptr;
    left = apart * by[1];
    return led;
  }
};

}  // namespace

SampledMap map_of_left(const SampledPoints& points, const GaugeMap* before,
                       std::uint32_t most_nodes, const Run& run) {
  if (before != nullptr && points.lead != nullptr) {
    const auto all = static_cast<double>(points.count);
    auto map = points.lead(*before, cells_of_leaders(all, points.count, points.dimension, 0));
    if (map != nullptr)
      return {std::move(map), "of the leaders of all " + std::to_string(points.count) + " left",
              true};
  }
  return map_of_sample(points, Insist::late, most_nodes, run);
}

SampledMap map_of_sample(const SampledPoints& points, Insist insist, std::uint32_t most_nodes,
                         const Run& run, std::uint64_t most_probes) {
  return MapSearch{points, insist, most_nodes, run, most_probes}.find();
}

}  // namespace cullhull::internal
