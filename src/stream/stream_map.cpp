#include "stream/stream_map.hpp"

#include <algorithm>
#include <array>

#include "filter/gauge/gauge_table.hpp"
#include "flow/sample_map.hpp"
#include "geometry/gather.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

/// Vertices of the map's polytope, by dimension from 2D on. The cache limits the map's nodes, so
/// with more vertices the map takes longer to build and keeps hardly fewer points. Derived from the
/// planner's sample sizes; other values are untested.
constexpr std::uint64_t most_corners[] = {1 << 16, 1 << 15, 8000, 2500, 800};

/// Nodes of the map, as a share of those for a single set. The points that its cells keep are
/// tested by its cones. A stream of 8 million points of a 3D ball takes 0.87 of the time with all
/// nodes, one of 300,000 points in 5D 0.9, a 4D ball and a gauss distribution the same.
constexpr double map_share = 0.25;

/// The coordinates of all extreme points, or of that many, evenly spaced by id.
Array<double> corners_of(const NumberedPoints& extreme) {
  const std::uint64_t count = extreme.size(), most = most_corners[extreme.dimension - 2];
  const std::uint64_t taken = std::min(count, most);
  Array<double> rows(taken * extreme.dimension);
  const PointView view = extreme.view();
  for (std::uint64_t i = 0; i < taken; ++i)
    load_row(view, i * count / taken, rows.data() + i * extreme.dimension);
  return rows;
}

}  // namespace

std::shared_ptr<const StreamMap> StreamMap::lay(const NumberedPoints& extreme,
                                                const PointView& block, const Run& run) {
  const unsigned d = extreme.dimension;
  if (d < GaugeMap::min_dimension || d > GaugeMap::max_dimension || extreme.size() <= d)
    return nullptr;
  InnerPolytope polytope = inner_polytope(corners_of(extreme), d, run);
  if (polytope.dimension == 0) return nullptr;
  auto map = GaugeMap::build(std::move(polytope),
                             {.share = map_share, .cones = true, .threads = run.threads});
  if (map == nullptr) return nullptr;
  // As for a very long pass: many blocks will follow.
  constexpr std::uint64_t enough_to_show = 1 << 14, many = std::uint64_t{1} << 40;
  std::optional<GaugeCore> core;
  if (block.count >= enough_to_show) core = core_for_pass(map->table(), block, many, run.threads);
  return std::shared_ptr<const StreamMap>(new StreamMap(std::move(map), core));
}

/// Positions, relative to `begin`, of the points kept. Points that the table keeps are tested once
/// more, exactly, against the facet that their ray meets.
std::size_t StreamMap::cull_chunk(const PointView& block, std::uint64_t begin, std::uint64_t end,
                                  std::uint32_t* positions) const {
  const std::size_t doubtful =
      gauge_survivors(map_->table(), block, begin, end, positions, core_ ? &*core_ : nullptr);
  // If most are kept, the block is outside the hull, and exact tests would not discard any.
  if (doubtful > (end - begin) / 2) return doubtful;
  double row[GaugeMap::max_dimension];
  std::size_t left = 0;
  for (std::size_t i = 0; i < doubtful; ++i) {
    load_row(block, begin + positions[i], row);
    if (!map_->inside_cones(row)) positions[left++] = positions[i];
  }
  return left;
}

void StreamMap::cull(const PointView& block, std::uint64_t first_id, const Run& run,
                     NumberedPoints& kept) const {
  const std::uint64_t chunks = chunk_count(block.count, gauge_chunk);
  std::vector<NumberedPoints> of_chunk(chunks, {kept.dimension, kept.scalar, {}, {}});
  run.each_chunk(block.count, gauge_chunk,
                 [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    std::array<std::uint32_t, gauge_chunk> positions;
    const std::size_t left = cull_chunk(block, begin, end, positions.data());
    if (left > 0) of_chunk[c].append(block, begin, positions.data(), left, first_id);
  });
  for (const NumberedPoints& part : of_chunk) kept.append(part);
}

}  // namespace cullhull::internal
