#include "filter/gauge/gauge_map.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>
#include <vector>

#include "cullhull/error.hpp"
#include "filter/gauge/gauge_build.hpp"
#include "filter/gauge/gauge_table.hpp"
#include "geometry/gather.hpp"
#include "parallel/scan.hpp"
#include "parallel/threads/parallel.hpp"
#include "parallel/threads/run.hpp"
#include "parallel/threads/thread_memory.hpp"

namespace cullhull::internal {

struct GaugeMap::Table : GaugeTable {
  std::unique_ptr<GaugeCones> cones;
};

GaugeMap::GaugeMap(std::unique_ptr<Table> table) : table_(std::move(table)) {}
GaugeMap::~GaugeMap() = default;

const GaugeTable& GaugeMap::table() const noexcept { return *table_; }

std::unique_ptr<GaugeMap> GaugeMap::build(InnerPolytope polytope, const GaugeSettings& settings) {
  auto table = std::make_unique<Table>();
  if (!build_gauge_table(std::move(polytope), settings, *table,
                         settings.cones ? &table->cones : nullptr))
    return nullptr;
  return std::unique_ptr<GaugeMap>(new GaugeMap(std::move(table)));
}

std::unique_ptr<GaugeMap> GaugeMap::of_few_facets(const InnerPolytope& polytope,
                                                  unsigned resolution) {
  auto table = std::make_unique<Table>();
  if (!build_gauge_by_planes(polytope, resolution, *table)) return nullptr;
  return std::unique_ptr<GaugeMap>(new GaugeMap(std::move(table)));
}

std::unique_ptr<GaugeMap> GaugeMap::of_leaders(const Array<double>& rows, const GaugeMap& before,
                                               const LeaderCells& cells, const Run& run) {
  if (before.table().dimension < 3) return nullptr;
  auto table = std::make_unique<Table>();
  if (!build_gauge_of_leaders(rows, before.table(), cells, run, *table)) return nullptr;
  return std::unique_ptr<GaugeMap>(new GaugeMap(std::move(table)));
}

bool GaugeMap::inside_cones(const double* row) const { return table_->cones->inside(row); }

std::vector<std::uint64_t> GaugeMap::outside_cones(const Array<double>& rows,
                                                   const std::vector<char>& certain,
                                                   const Run& run) const {
  if (table_->cones == nullptr)
    throw Error(ErrorCode::internal, "the gauge map was built without cones");
  constexpr std::uint64_t block = 256;  // a point takes some 90 ns
  const unsigned d = table_->dimension;
  const std::uint64_t count = rows.size() / d;
  std::vector<std::uint64_t> kept(count);  // each block writes to its own part
  std::vector<std::uint64_t> sizes(chunk_count(count, block));
  run.each_chunk(count, block, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    std::uint64_t k = begin;
    for (std::uint64_t i = begin; i < end; ++i) {
      kept[k] = i;
      k += certain[i] == 0 && table_->cones->inside(&rows[i * d]) ? 0 : 1;
    }
    sizes[c] = k - begin;
  });
  std::uint64_t total = 0;
  for (std::uint64_t c = 0; c < sizes.size(); ++c) {
    std::copy_n(kept.begin() + static_cast<std::ptrdiff_t>(c * block), sizes[c],
                kept.begin() + static_cast<std::ptrdiff_t>(total));
    total += sizes[c];
  }
  kept.resize(total);
  return kept;
}

Array<std::uint64_t> GaugeMap::survivors(const PointView& points, const Run& run,
                                         SurvivorRows* rows) const {
  if (points.dimension != table_->dimension)
    throw Error(ErrorCode::internal, "the gauge map has another dimension than the points");

  // Every chunk fills its own list; their concatenation does not depend on threads.
  const std::uint64_t chunks = chunk_count(points.count, gauge_chunk);
  const unsigned d = points.dimension;
  std::vector<std::vector<std::uint16_t>> kept(chunks);
  std::vector<Array<double>> kept_rows(rows != nullptr ? chunks : 0);
  std::atomic<std::uint64_t> gathered{0};
  const auto core = core_for_pass(*table_, points, points.count, run.threads);
  static_assert(gauge_chunk <= 65536);
  run.each_chunk(points.count, gauge_chunk,
                 [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    auto& ids = thread_memory<std::array<std::uint32_t, gauge_chunk>>();
    const std::size_t n =
        gauge_survivors(*table_, points, begin, end, ids.data(), core ? &*core : nullptr);
    kept[c].assign(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(n));
    if (rows == nullptr || gathered.fetch_add(n) + n > rows->most) return;
    kept_rows[c].resize(n * d);
    gather_rows_at(points, begin, ids.data(), n, kept_rows[c].data());
  });

  std::vector<std::uint64_t> offsets(chunks);
  bool all = rows != nullptr;
  for (std::uint64_t c = 0; c < chunks; ++c) {
    offsets[c] = kept[c].size();
    all = all && kept_rows[c].size() == kept[c].size() * d;
  }
  Array<std::uint64_t> result(exclusive_scan(offsets));
  if (all) rows->rows.resize(result.size() * d);
  run.each(chunks, 8, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t c = begin; c < end; ++c) {
      const std::uint64_t first = c * gauge_chunk;
      const std::vector<std::uint16_t> found = std::move(kept[c]);  // freed by this thread
      std::transform(found.begin(), found.end(),
                     result.begin() + static_cast<std::ptrdiff_t>(offsets[c]),
                     [first](std::uint16_t i) { return first + i; });
      if (!all) continue;
      const Array<double> coordinates = std::move(kept_rows[c]);
      std::copy(coordinates.begin(), coordinates.end(),
                rows->rows.begin() + static_cast<std::ptrdiff_t>(offsets[c] * d));
    }
  });
  return result;
}

namespace {

// The standard deviation of a share q estimated from n points is sqrt(q (1 - q) / n): at most 0.5 /
// sqrt(512) = 2.2 % for 512 points.

/// The sample size: estimates the share of points that a core drops to about 2 % (one standard
/// deviation).
constexpr std::uint32_t probe_count = 512;

/// Samples points from all over the view, in the map's frame, as columns. They only serve to
/// estimate how much a core saves: which points they are, and their rounding, does not affect
/// results.
std::vector<float> probe(const GaugeTable& t, const PointView& points) {
  const unsigned d = t.dimension;
  const std::uint64_t stretch = points.count / probe_count;
  std::vector<float> columns(std::size_t{probe_count} * d);
  for (std::uint64_t i = 0; i < probe_count; ++i) {
    double x[GaugeTable::max_dimension];
    load_row(points, i * stretch + i * 0x9E3779B97F4A7C15ULL % stretch, x);
    for (unsigned j = 0; j < d; ++j)
      columns[j * probe_count + i] = static_cast<float>(x[j] * t.scale[j] - t.offset[j]);
  }
  return columns;
}

}  // namespace

std::optional<GaugeCore> core_for_pass(const GaugeTable& t, const PointView& points,
                                       std::uint64_t count, unsigned threads) {
  if (count < worth_a_core) return std::nullopt;
  return make_core(t, probe(t, points), probe_count, threads);
}

}  // namespace cullhull::internal
