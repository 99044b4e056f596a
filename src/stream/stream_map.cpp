#include "stream/stream_map.hpp"

#include <algorithm>
#include <array>

#include "filter/gauge/gauge_table.hpp"
#include "flow/sample_map.hpp"
#include "geometry/gather.hpp"
#include "parallel/threads/run.hpp"
#include "parallel/threads/thread_memory.hpp"

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

/// Points whose hull tells which of the others are outermost, where there is no map before.
constexpr std::uint64_t rough_corners = 250;

/// The coordinates of all points, or of `most`, evenly spaced.
Array<double> corners_of(const NumberedPoints& points, std::uint64_t most) {
  const std::uint64_t count = points.size(), taken = std::min(count, most);
  Array<double> rows(taken * points.dimension);
  const PointView view = points.view();
  for (std::uint64_t i = 0; i < taken; ++i)
    load_row(view, i * count / taken, rows.data() + i * points.dimension);
  return rows;
}

}  // namespace

std::shared_ptr<const StreamMap> StreamMap::lay(const NumberedPoints& points,
                                                const PointView& block, const Run& run) {
  const unsigned d = points.dimension;
  if (d < GaugeMap::min_dimension || d > GaugeMap::max_dimension || points.size() <= d)
    return nullptr;
  InnerPolytope polytope = inner_polytope(corners_of(points, most_corners[d - 2]), d, run);
  if (polytope.dimension == 0) return nullptr;
  auto map = GaugeMap::build(std::move(polytope),
                             {.share = map_share, .cones = true, .threads = run.threads});
  if (map == nullptr) return nullptr;
  return std::shared_ptr<const StreamMap>(new StreamMap(std::move(map), true, &block, run));
}

std::shared_ptr<const StreamMap> StreamMap::of_leaders(const NumberedPoints& points,
                                                       const StreamMap* before,
                                                       const PointView* block, std::uint64_t tested,
                                                       const Run& run) {
  const unsigned d = points.dimension;
  if (d < 3 || d > GaugeMap::max_dimension) return nullptr;
  std::unique_ptr<GaugeMap> rough;
  if (before == nullptr) {
    rough = map_of_polytope(inner_polytope(corners_of(points, rough_corners), d, run),
                            points.size(), Insist::late, 0, run);
    if (rough == nullptr) return nullptr;
  }
  const std::uint64_t count = points.size();
  auto map = GaugeMap::of_leaders(gather_points(points.view(), nullptr, count, run),
                                  rough != nullptr ? *rough : *before->map_,
                                  cells_of_leaders(static_cast<double>(count), tested, d, 0), run);
  if (map == nullptr) return nullptr;
  return std::shared_ptr<const StreamMap>(new StreamMap(std::move(map), false, block, run));
}

StreamMap::StreamMap(std::unique_ptr<GaugeMap> map, bool cones, const PointView* block,
                     const Run& run)
    : map_(std::move(map)), cones_(cones) {
  // As for a very long pass: many blocks will follow.
  constexpr std::uint64_t enough_to_show = 1 << 14, many = std::uint64_t{1} << 40;
  if (block != nullptr && block->count >= enough_to_show)
    core_ = core_for_pass(map_->table(), *block, many, run.threads);
}

void StreamMap::thin(NumberedPoints& points, const Run& run) const {
  points.keep(map_->survivors(points.view(), run), run);
}

/// Positions, relative to `begin`, of the points kept. Points that the table keeps are tested once
/// more, exactly, against the facet that their ray meets.
std::size_t StreamMap::cull_chunk(const PointView& block, std::uint64_t begin, std::uint64_t end,
                                  std::uint32_t* positions) const {
  const std::size_t doubtful =
      gauge_survivors(map_->table(), block, begin, end, positions, core_ ? &*core_ : nullptr);
  // If most are kept, the block is outside the hull, and exact tests would not discard any.
  if (!cones_ || doubtful > (end - begin) / 2) return doubtful;
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
    auto& positions = thread_memory<std::array<std::uint32_t, gauge_chunk>>();
    const std::size_t left = cull_chunk(block, begin, end, positions.data());
    if (left > 0) of_chunk[c].append(block, begin, positions.data(), left, first_id);
  });
  for (const NumberedPoints& part : of_chunk) kept.append(part);
}

}  // namespace cullhull::internal
