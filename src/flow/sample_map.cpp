#include "flow/sample_map.hpp"

#include <algorithm>
#include <utility>

#include "cullhull/error.hpp"
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

std::vector<std::uint64_t> sample_ids(std::uint64_t count, std::uint64_t size) {
  std::vector<std::uint64_t> ids(size);
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

struct Sampled {
  InnerPolytope polytope;
  std::uint64_t size = 0;
  std::uint64_t extreme() const {
    return polytope.dimension == 0 ? 0 : polytope.vertices.size() / polytope.dimension;
  }
};

Sampled hull_of_sample(const SampledPoints& points, std::uint64_t size, const Run& run) {
  const std::vector<std::uint64_t> ids = sample_ids(points.count, size);
  // In 3D few points of a sample are extreme (else no map is built), so its hull takes less than a
  // millisecond: dividing the surface between two threads takes longer than they save.
  constexpr std::uint64_t worth_threads = 1 << 15;
  const unsigned threads = points.dimension == 3 && size < worth_threads ? 1 : run.threads;
  Sampled s;
  s.size = ids.size();
  s.polytope = inner_polytope(points.gather(ids), points.dimension, run.with_threads(threads));
  return s;
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

SampledMap map_of_sample(const SampledPoints& points, Insist insist, std::uint32_t most_nodes,
                         const Run& run, std::uint64_t most_probes) {
  const unsigned d = points.dimension;
  const char* const none = "a sample lies in a flat or its hull is too large";
  Sampled sample = hull_of_sample(points, probe_sample_size(points.count, d), run);
  if (sample.polytope.dimension == 0) return {nullptr, none};
  if (insist == Insist::no && !cull_pays(points.count, d, sample.size, sample.extreme()))
    return {nullptr, sample_finding(sample.size, sample.extreme()) + ", so a filter does not pay"};
  std::uint64_t size = map_sample_size(points.count, d, sample.size, sample.extreme());
  if (size / most_probes >= sample.size) size = most_probes * sample.size;
  if (size > sample.size) sample = hull_of_sample(points, size, run);
  if (sample.polytope.dimension == 0) return {nullptr, none};
  const std::string found = sample_finding(sample.size, sample.extreme());
  if (insist != Insist::yes && !map_pays(points.count, d, sample.size, sample.extreme()))
    return {nullptr, found + ", so a map does not pay"};
  SampledMap result{
      map_of_polytope(std::move(sample.polytope), points.count, insist, most_nodes, run), found};
  result.reason += result.map == nullptr   ? ", but the centre is not safely inside their hull"
                   : insist == Insist::yes ? ", filter as asked"
                                           : ", so the filter pays";
  return result;
}

}  // namespace cullhull::internal
