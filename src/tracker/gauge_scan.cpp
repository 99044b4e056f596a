#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "cullhull/hull.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "flow/pipeline.hpp"
#include "flow/sample_map.hpp"
#include "parallel/id_places.hpp"
#include "parallel/threads/run.hpp"
#include "tracker/simplex_memory.hpp"

namespace cullhull::internal {
namespace {

/// If the scan keeps a larger share, the leaders no longer span the hull. Exact tests of the
/// survivors against the leaders' facets would then discard few; they are skipped. Untested value.
constexpr double coherent_share = 1.0 / 3;

/// Nodes of the scan's map, as a share of those for a single set. Fewer nodes make a map that is
/// built faster but keeps more points; these are tested once more, exactly, by the cones. Untested
/// value.
constexpr double map_share = 0.5;

/// Marks the survivors that are leaders; both lists ascend. Returns the leaders that are missing.
std::vector<std::uint64_t> mark_leaders(const std::vector<std::uint64_t>& survivors,
                                        const std::vector<std::uint64_t>& leaders, const Run& run,
                                        std::vector<char>& marks) {
  constexpr std::uint64_t grain = 512;
  marks.assign(survivors.size(), 0);
  std::vector<std::vector<std::uint64_t>> lists(chunk_count(leaders.size(), grain));
  run.each_chunk(leaders.size(), grain,
                 [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    auto at = std::lower_bound(survivors.begin(), survivors.end(), leaders[begin]);
    for (std::uint64_t i = begin; i < end; ++i) {
      while (at != survivors.end() && *at < leaders[i]) ++at;
      if (at != survivors.end() && *at == leaders[i])
        marks[static_cast<std::size_t>(at - survivors.begin())] = 1;
      else
        lists[c].push_back(leaders[i]);
    }
  });
  std::vector<std::uint64_t> missing;
  for (const auto& list : lists) missing.insert(missing.end(), list.begin(), list.end());
  return missing;
}

/// Adds the missing leaders, marked, to the survivors.
void add_leaders(const std::vector<std::uint64_t>& missing, std::vector<std::uint64_t>& survivors,
                 std::vector<char>& marks) {
  std::size_t from = survivors.size(), left = missing.size(), to = from + left;
  survivors.resize(to);
  marks.resize(to);
  while (left > 0) {
    const bool leads = from == 0 || survivors[from - 1] < missing[left - 1];
    marks[--to] = leads ? 1 : marks[from - 1];
    survivors[to] = leads ? missing[--left] : survivors[--from];
  }
}

/// The last hull's surface with its vertices at their new positions, `rows`. `leaders`, ascending,
/// are the vertices' ids: vertex i of the surface is leader i.
InnerPolytope moved_surface(const Hull& hull, const std::vector<std::uint64_t>& leaders,
                            std::vector<double>&& rows, const Run& run) {
  InnerPolytope p;
  p.dimension = hull.dimension;
  p.vertices = std::move(rows);
  p.neighbours.assign(hull.simplex_neighbours.begin(), hull.simplex_neighbours.end());
  p.facets.resize(hull.simplices.size());
  const IdPlaces place(leaders, run);
  run.each(hull.simplices.size(), 1024, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) p.facets[i] = place(hull.simplices[i]);
  });
  return p;
}

}  // namespace

bool filter_by_leaders(FramePoints& points, const Hull& last,
                       const std::vector<std::uint64_t>& leaders, const Run& run, Filtered& result,
                       double& scan_seconds) {
  const auto start = Clock::now();
  const unsigned d = points.dimension;
  Array<double> rows = points.gather(leaders);
  run.control.report("scan", 0);
  GaugeSettings settings{.share = map_share,
                         .most_nodes = points.most_nodes(),
                         .cones = true,
                         .convex = false,
                         .threads = run.threads};
  std::unique_ptr<GaugeMap> map;
  if (last.affine_dimension == static_cast<int>(d))
    map = GaugeMap::build(
        moved_surface(last, leaders, std::vector<double>(rows.begin(), rows.end()), run), settings);
  if (map == nullptr) {
    settings.convex = true;
    map = GaugeMap::build(inner_polytope(std::move(rows), d, run), settings);
    if (map == nullptr) return false;
  }
  result.survivors.filter = UsedFilter::gauge;
  result.survivors.reason = "led by the last frame's vertices";
  points.scan(*map, result.survivors);
  // All leaders survive where the last hull may be mended, even those that are inside now.
  std::vector<char> marks;
  const auto missing = mark_leaders(result.survivors.ids, leaders, run, marks);
  if (d == 3 && points.on_host() != nullptr) add_leaders(missing, result.survivors.ids, marks);
  scan_seconds = seconds_since(start);
  points.fetch(result);
  const auto left = static_cast<double>(result.pass_survivors);
  if (left <= coherent_share * static_cast<double>(points.count))
    keep_of_survivors(result, d, map->outside_cones(result.rows, marks, run));
  result.map = std::move(map);
  refine_survivors(result, d, run);
  return true;
}

}  // namespace cullhull::internal
