// HullStream: blocks are culled in the caller's memory; survivors are collected and reduced exactly
// when they are many.
#include <algorithm>
#include <mutex>
#include <string>
#include <utility>

#include "cull/planner.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/error.hpp"
#include "cullhull/stream.hpp"
#include "geometry/gather.hpp"
#include "parallel/helpers.hpp"
#include "parallel/run.hpp"
#include "stream/numbered_points.hpp"
#include "stream/reduce.hpp"
#include "stream/stream_map.hpp"

namespace cullhull {

using namespace internal;

struct HullStream::Impl {
  Options options;
  std::uint64_t budget = 0;

  mutable std::mutex mutex;  ///< of the members below; held briefly
  NumberedPoints extreme;    ///< of the points reduced so far
  NumberedPoints waiting;    ///< survivors since then
  std::shared_ptr<const StreamMap> map;
  std::uint64_t seen = 0, next_id = 0;
  std::uint64_t reduced = 0;  ///< how many of the points seen `extreme` stands for
  std::uint64_t reductions = 0, maps = 0;

  std::mutex reducing;  ///< one thread at a time; locked before `mutex`

  // --------------------------------------------------------------------------- the exact step

  /// How many points may wait. To reduce them and to build a map costs as much as to keep about
  /// `worth` of them; then as many as are extreme, so that all reductions together cost little more
  /// than the last. At most an eighth of the budget, as a reduction takes a multiple of their
  /// memory.
  std::size_t enough() const {
    const std::size_t worth = smallest_worth_refining(waiting.dimension);
    const std::size_t wanted = std::max(reductions == 0 ? worth / 8 : worth, extreme.size());
    return std::min<std::size_t>(wanted, budget / 8 / waiting.point_bytes());
  }

  void reduce_if_worth() {
    std::size_t count, limit;
    {
      const std::lock_guard lock(mutex);
      count = waiting.size();
      if (count == 0) return;
      limit = enough();
    }
    if (count <= limit) return;
    std::unique_lock alone(reducing, std::defer_lock);
    // While another thread reduces, more may wait, but not more than twice the limit.
    if (count < 2 * limit ? !alone.try_lock() : (alone.lock(), false)) return;
    {
      const std::lock_guard lock(mutex);
      if (waiting.size() <= enough()) return;
    }
    reduce();
  }

  /// Replaces all points held by their extreme points; they are unchanged where that fails.
  /// `reducing` is locked.
  void reduce() {
    NumberedPoints taken, all;
    std::uint64_t seen_now;
    {
      const std::lock_guard lock(mutex);
      if (waiting.ids.empty()) {
        reduced = seen;
        return;
      }
      all = extreme;
      all.append(waiting);
      taken = std::exchange(waiting, {waiting.dimension, waiting.scalar, {}, {}});
      seen_now = seen;
    }
    std::shared_ptr<const StreamMap> next;
    try {
      Options exact = options;
      const std::uint64_t held = 3 * all.size() * all.point_bytes();
      require_budget(budget, held, std::to_string(all.size()) + " points that may be extreme");
      exact.memory_budget = budget - held;
      if (exact.memory_budget == 0) exact.memory_budget = 1;  // 0 would be the default
      keep_extreme(all, exact);
      // Where most points are extreme a filter would not pay.
      if (all.size() < seen_now / 2) next = StreamMap::lay(all, Run(exact));
    } catch (const Error& e) {
      put_back(std::move(taken));
      if (e.code() == ErrorCode::out_of_budget) refuse(e.what());
      throw;
    } catch (...) {
      put_back(std::move(taken));
      throw;
    }
    const std::lock_guard lock(mutex);
    if (all.scalar != waiting.scalar) all.widen();
    extreme = std::move(all);
    map = std::move(next);
    reduced = seen_now;
    ++reductions;
    if (map != nullptr) ++maps;
  }

  void put_back(NumberedPoints&& taken) {
    const std::lock_guard lock(mutex);
    if (taken.scalar != waiting.scalar) taken.widen();
    taken.append(waiting);
    waiting = std::move(taken);
  }

  [[noreturn]] void refuse(const std::string& why) const {
    const std::lock_guard lock(mutex);
    throw Error(ErrorCode::out_of_budget,
                "the stream holds " + std::to_string(extreme.size() + waiting.size()) +
                    " points that may be extreme, of " + std::to_string(seen) +
                    " so far, and cannot go on: " + why);
  }

  // --------------------------------------------------------------------------- blocks

  /// The survivors of a block: by the current map, or by a map of the block's own where there is
  /// none.
  NumberedPoints survivors(const PointView& block, std::uint64_t first_id, const Run& run) const {
    std::shared_ptr<const StreamMap> filter;
    {
      const std::lock_guard lock(mutex);
      filter = map;
    }
    NumberedPoints kept{block.dimension, block.scalar, {}, {}};
    if (filter == nullptr) {
      cull_by_itself(block, first_id, kept);
      return kept;
    }
    {
      const CallScope call;
      filter->cull(block, first_id, run, kept);
    }
    // Where it keeps much, the map knows little of this block's region, as in ordered scans: the
    // block's own map culls further.
    if (kept.size() <= block.count / 4) return kept;
    NumberedPoints fewer{block.dimension, block.scalar, {}, {}};
    cull_by_itself(kept.view(), 0, fewer);
    for (std::uint64_t& id : fewer.ids) id = kept.ids[id];
    return fewer;
  }

  void cull_by_itself(const PointView& block, std::uint64_t first_id, NumberedPoints& kept) const {
    Survivors found;
    found.all = true;
    if (block.count >= smallest_worth_culling(block.dimension)) try {
        Options quietly = options;
        quietly.progress = {};
        found = cull(block, quietly);
      } catch (const Error& e) {
        if (e.code() != ErrorCode::not_finite) throw;  // push() throws the error that names it
      }
    if (found.all) return kept.append(block, 0, nullptr, block.count, first_id);
    for (const std::uint64_t i : found.ids) kept.append(block, i, nullptr, 1, first_id);
  }

  void push(const PointView& block, std::uint64_t first_id) {
    reduce_if_worth();
    {
      const std::lock_guard lock(mutex);
      check_block(block, first_id, waiting.dimension);
    }
    const Run run(options);
    run.check();
    NumberedPoints kept{block.dimension, block.scalar, {}, {}};
    if (block.count > 0) {
      kept = survivors(block, first_id, run);
      refuse_not_finite(kept, run.threads);
    }
    take(std::move(kept), block.count, block.count > 0 ? first_id + block.count : 0);
  }

  /// Adds to the waiting points; the ids below `end` are taken.
  void take(NumberedPoints&& kept, std::uint64_t count, std::uint64_t end) {
    const std::lock_guard lock(mutex);
    if (waiting.dimension == 0) {
      extreme = {kept.dimension, kept.scalar, {}, {}};
      waiting = extreme;
    }
    check_block(kept.view(), 0, waiting.dimension);  // the dimension may just have become known
    const ScalarType scalar = common_scalar(waiting.scalar, seen, kept.scalar, count);
    if (seen == 0) {
      waiting.scalar = extreme.scalar = scalar;
    } else if (scalar != waiting.scalar) {
      waiting.widen();
      extreme.widen();
    }
    if (kept.scalar != scalar && count > 0) kept.widen();
    waiting.append(kept);
    seen += count;
    next_id = std::max(next_id, end);
  }

  HullState state() {
    const std::lock_guard alone(reducing);
    reduce();
    const std::lock_guard lock(mutex);
    HullState state;
    state.dimension_ = extreme.dimension;
    state.scalar_ = extreme.scalar;
    state.seen_ = reduced;
    state.ids_ = extreme.ids;
    state.rows_ = extreme.rows;
    return state;
  }
};

HullStream::HullStream(Options options) : impl_(std::make_unique<Impl>()) {
  impl_->options = std::move(options);
  impl_->budget = resolve_budget(impl_->options.memory_budget);
}
HullStream::HullStream(HullStream&&) noexcept = default;
HullStream& HullStream::operator=(HullStream&&) noexcept = default;
HullStream::~HullStream() = default;

void HullStream::push(const PointView& block, std::uint64_t first_id) {
  impl_->push(block, first_id);
}

void HullStream::push(const PointView& block) {
  std::uint64_t first_id;
  {
    // Reserved at once, so that concurrent pushes get other ids.
    const std::lock_guard lock(impl_->mutex);
    check_block(block, impl_->next_id, impl_->waiting.dimension);
    first_id = impl_->next_id;
    impl_->next_id += block.count;
  }
  try {
    impl_->push(block, first_id);
  } catch (...) {
    const std::lock_guard lock(impl_->mutex);
    if (impl_->next_id == first_id + block.count) impl_->next_id = first_id;
    throw;
  }
}

void HullStream::push(const HullState& state) {
  if (state.dimension_ == 0) return;
  impl_->reduce_if_worth();
  NumberedPoints points{state.dimension_, state.scalar_, state.ids_, state.rows_};
  const std::uint64_t end = state.ids_.empty() ? 0 : std::max(state.ids_.back() + 1, state.seen_);
  impl_->take(std::move(points), state.seen_, end);
}

HullState HullStream::state() { return impl_->state(); }

Hull HullStream::hull() { return state().hull(impl_->options); }

StreamReport HullStream::report() const {
  const std::lock_guard lock(impl_->mutex);
  return {impl_->seen, impl_->extreme.size(), impl_->waiting.size(), impl_->reductions,
          impl_->maps};
}

}  // namespace cullhull
