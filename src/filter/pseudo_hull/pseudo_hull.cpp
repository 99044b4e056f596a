#include "filter/pseudo_hull/pseudo_hull.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <mutex>

#include "cullhull/error.hpp"
#include "filter/pseudo_hull/pseudo_hull_growth.hpp"
#include "filter/ways.hpp"
#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

constexpr std::uint64_t block_size = PseudoSubset::block;

/// Sets every coordinate of a point with a NaN or an infinity to NaN, so that no comparison holds.
template <unsigned D>
void blot_out(double* rows, std::uint64_t count) {
  double sum = 0;  // x * 0 is NaN exactly for NaN and infinities
  for (std::uint64_t i = 0; i < count * D; ++i) sum += rows[i] * 0.0;
  if (sum == 0) return;
  for (std::uint64_t i = 0; i < count; ++i) {
    double* row = rows + i * D;
    if (!std::all_of(row, row + D, [](double v) { return std::isfinite(v); }))
      std::fill_n(row, D, std::numeric_limits<double>::quiet_NaN());
  }
}

template <unsigned D, class Executor>
struct Worker {
  explicit Worker(const Executor& e) : executor(e), growth(e) {}
  Executor executor;
  HostArray<double> rows;
  PseudoHullGrowth<D, Executor, StoredRows<D>> growth;
};

/// Records which simplex culled each point of one subset; simplices are numbered within the subset.
struct SubsetRecord {
  std::vector<std::uint64_t> corners;
  std::vector<std::uint32_t>* simplex_of = nullptr;  ///< of all points, shared by all subsets

  template <class Growth>
  void take(const Growth& growth, const PseudoSubset& subset) {
    corners.resize(growth.corners().size());
    std::transform(growth.corners().begin(), growth.corners().end(), corners.begin(),
                   [&](std::uint32_t row) { return subset.point(row); });
    for (std::uint64_t i = 0; i < growth.simplex_of().size(); ++i)
      (*simplex_of)[subset.point(i)] = growth.simplex_of()[i];
  }
};

/// Renumbers the simplices of all subsets consecutively.
void join(std::vector<SubsetRecord>& parts, unsigned corners_each, std::uint64_t points,
          const Run& run, SimplexRecord& record) {
  std::uint64_t total = 0;
  for (const SubsetRecord& p : parts) total += p.corners.size();
  if (total / corners_each >= no_item)
    throw Error(ErrorCode::out_of_budget, "more simplices than 32-bit numbers tell apart");
  record.corners.reserve(total);
  std::vector<std::uint32_t> base;
  for (SubsetRecord& p : parts) {
    base.push_back(static_cast<std::uint32_t>(record.corners.size() / corners_each));
    record.corners.insert(record.corners.end(), p.corners.begin(), p.corners.end());
    p.corners = {};
  }
  run.each(points, block_size * 32, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i)
      if (record.simplex_of[i] != no_item)
        record.simplex_of[i] += base[i / block_size % parts.size()];
  });
}

/// Loads the points of a subset, grows its pseudo-hull and lists the ids of survivors, ascending.
template <unsigned D, class Executor>
void filter_subset(const PointView& view, const PseudoSubset& subset, unsigned max_rounds,
                   Worker<D, Executor>& worker, const Control& control,
                   std::vector<PseudoHullRound>& rounds, std::vector<std::uint64_t>& kept,
                   SubsetRecord* record) {
  const std::uint64_t size = subset.size();
  if (size > pseudo_hull_most_points)
    throw Error(ErrorCode::out_of_budget, size,
                " points are too many for one pseudo-hull; "
                "use more subsets");
  double* rows = worker.rows.reserve(size * D);
  worker.executor.for_each(static_cast<std::uint32_t>(chunk_count(size, block_size)),
                           [&](std::uint32_t b) {
    const std::uint64_t begin = b * block_size, count = std::min(block_size, size - begin);
    const std::uint64_t first = subset.point(begin);
    load_rows(view, first, first + count, rows + begin * D);
    blot_out<D>(rows + begin * D, count);
  });
  if (record != nullptr) worker.growth.record();
  worker.growth.run({rows}, static_cast<std::uint32_t>(size), max_rounds, control, rounds);
  if (record != nullptr) record->take(worker.growth, subset);
  const unsigned char* culled = worker.growth.culled();
  kept.reserve(static_cast<std::size_t>(std::count(culled, culled + size, 0)));
  for (std::uint64_t i = 0; i < size; ++i)
    if (culled[i] == 0) kept.push_back(subset.point(i));
}

/// Scratch memory, one item per subset in progress.
template <class T>
class Pool {
 public:
  std::unique_ptr<T> take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return nullptr;
    std::unique_ptr<T> item = std::move(free_.back());
    free_.pop_back();
    return item;
  }
  void give(std::unique_ptr<T> item) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(item));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<T>> free_;
};

void add(std::vector<PseudoHullRound>& sum, const std::vector<PseudoHullRound>& rounds) {
  if (sum.size() < rounds.size()) sum.resize(rounds.size());
  for (std::size_t r = 0; r < rounds.size(); ++r) {
    sum[r].facets += rounds[r].facets;
    sum[r].exterior += rounds[r].exterior;
    sum[r].culled += rounds[r].culled;
    sum[r].kept += rounds[r].kept;
  }
}

template <unsigned D>
std::vector<std::uint64_t> survivors_of(const PointView& points, unsigned subsets,
                                        unsigned max_rounds, const Run& run,
                                        std::vector<PseudoHullRound>& rounds,
                                        SimplexRecord* record) {
  std::vector<std::vector<std::uint64_t>> kept(subsets);
  std::vector<SubsetRecord> parts(record != nullptr ? subsets : 0);
  if (record != nullptr) {
    record->corners.clear();
    record->simplex_of.assign(points.count, no_item);
    for (SubsetRecord& p : parts) p.simplex_of = &record->simplex_of;
  }
  const auto part = [&](std::uint64_t s) { return record != nullptr ? &parts[s] : nullptr; };
  // The least number of points for several threads: a small set takes one thread less time than
  // waking the others. Untested value.
  constexpr std::uint64_t least_parallel = 1 << 14;
  if (subsets == 1 && run.threads > 1 && points.count >= least_parallel) {
    Worker<D, ThreadExecutor> worker{ThreadExecutor(run.threads)};
    filter_subset<D>(points, {points.count, 0, 1}, max_rounds, worker, run.control, rounds, kept[0],
                     part(0));
    if (record != nullptr) join(parts, D + 1, points.count, run, *record);
    return merge_subsets(std::move(kept));
  }
  using Serial = Worker<D, SerialExecutor>;
  Pool<Serial> pool;
  std::vector<std::vector<PseudoHullRound>> reports(subsets);
  run.each_item(subsets, [&](std::uint64_t s) {
    std::unique_ptr<Serial> worker = pool.take();
    if (worker == nullptr) worker = std::make_unique<Serial>(SerialExecutor{});
    filter_subset<D>(points, {points.count, s, subsets}, max_rounds, *worker, run.control,
                     reports[s], kept[s], part(s));
    pool.give(std::move(worker));
  });
  for (const auto& r : reports) add(rounds, r);
  if (record != nullptr) join(parts, D + 1, points.count, run, *record);
  return merge_subsets(std::move(kept));
}

// Example: 8M points: 8M / 2^17 = 61, so 64 subsets of 125,000 points; 100M points: 762. A subset
// takes every so-many-th block of 512 points, a fair sample in whatever order the points come: each
// subset's pseudo-hull is nearly as large as that of all points, so it culls nearly as much.

/// Returns the number of subsets: the paper's 64 for sets of the paper's sizes. A subset of more
/// than 2^17 points (3 MB in 3D) does not fit L2; one of fewer than 2^12 keeps too many points.
unsigned subset_count(std::uint64_t points) {
  const std::uint64_t most = std::max<std::uint64_t>(1, points >> 12);
  return static_cast<unsigned>(
      std::min(most, std::clamp<std::uint64_t>(points >> 17, 64, 1U << 20)));
}

}  // namespace

std::vector<std::uint64_t> merge_subsets(std::vector<std::vector<std::uint64_t>> kept) {
  if (kept.size() == 1) return std::move(kept[0]);
  std::size_t total = 0;
  for (const auto& list : kept) total += list.size();
  std::vector<std::uint64_t> ids;
  ids.reserve(total);
  std::vector<std::size_t> next(kept.size(), 0);
  for (std::uint64_t round_end = block_size * kept.size(); ids.size() < total;
       round_end += block_size * kept.size()) {
    for (std::size_t s = 0; s < kept.size(); ++s)
      while (next[s] < kept[s].size() && kept[s][next[s]] < round_end)
        ids.push_back(kept[s][next[s]++]);
  }
  return ids;
}

std::vector<std::uint64_t> pseudo_hull_survivors(const PointView& points,
                                                 const PseudoHullSettings& settings, const Run& run,
                                                 std::vector<PseudoHullRound>* rounds,
                                                 SimplexRecord* record) {
  std::vector<PseudoHullRound> unread;
  std::vector<PseudoHullRound>& report = rounds != nullptr ? *rounds : unread;
  report.clear();
  const unsigned subsets = settings.subsets != 0 ? settings.subsets : subset_count(points.count);
  const unsigned most = settings.max_rounds;
  constexpr const WayRow& way = row_of(Way::pseudo_hull);
  if (points.dimension < way.least_dimension || points.dimension > way.most_dimension)
    throw Error(ErrorCode::invalid_argument, "the pseudo-hull filter is for 2 to 8 dimensions");
  return with_dimension<2, 7, 8>(points.dimension, [&](auto d) {
    return survivors_of<decltype(d)::value>(points, subsets, most, run, report, record);
  });
}

}  // namespace cullhull::internal
