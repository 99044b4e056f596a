// HullStream: filters blocks in the caller's memory, collects survivors, and reduces them once
// there are many: by a map of theirs, which later blocks get, too, and if that leaves many, to
// their extreme points.
#include <algorithm>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "cullhull/cull.hpp"
#include "cullhull/error.hpp"
#include "cullhull/stream.hpp"
#include "filter/planner.hpp"
#include "geometry/gather.hpp"
#include "parallel/memory/pages.hpp"
#include "parallel/threads/helpers.hpp"
#include "parallel/threads/run.hpp"
#include "parallel/threads/span_account.hpp"
#include "stream/numbered_points.hpp"
#include "stream/stream_map.hpp"

namespace cullhull {

using namespace internal;

struct HullStream::Impl {
  Options options;
  std::uint64_t budget = 0;

  mutable std::mutex mutex;  ///< guards the members below; held briefly
  NumberedPoints extreme;    ///< of the points reduced so far; others, too, unless `exact`
  /// Survivors since the last reduction, of the dimension and scalar type of `extreme`: in parts,
  /// so that none is copied while `mutex` is held.
  std::vector<NumberedPoints> waiting;
  std::uint64_t waiting_count = 0;
  std::uint64_t known = 0;   ///< number of points that the last reduction left
  bool exact = true;         ///< `extreme` are extreme
  std::uint64_t mapped = 0;  ///< number of points that the map was made from
  std::uint64_t away = 0;    ///< points that a running reduction has taken
  std::shared_ptr<const StreamMap> map;
  bool map_is_late = false;  ///< a reduction has built none, because no block was there to filter
  std::uint64_t seen = 0, next_id = 0;
  std::uint64_t left_out = 0;  ///< by skip(); not in `seen`
  std::uint64_t reduced = 0;   ///< number of points seen that `extreme` represents
  std::uint64_t reductions = 0, maps = 0;

  std::mutex reducing;       ///< held by the reducing thread; locked before `mutex`
  bool leaders_suit = true;  ///< until they drop few points, as of scans; guarded by `reducing`

  /// Locks `mutex`.
  class Guard {
   public:
    explicit Guard(const Impl& impl) : lock_(impl.mutex), held_(&impl.mutex) {}

   private:
    const std::lock_guard<std::mutex> lock_;
    const LockSpan held_;
  };

  // --------------------------------------------------------------------------- the exact step

  /// The number of points that may wait for a reduction, at most: 4 times those that the last one
  /// left, so that all reductions together cost little more than the last one, or 6 times as many
  /// as are worth a second map: of 2 to 96 million points of a 3D ball, 0.69 to 0.99 of the time
  /// with one time as many, on one thread. At most a sixteenth of the budget, because twice as many
  /// may wait during a reduction (reduce_if_worth), and growing vectors may have twice that
  /// capacity.
  std::size_t most_waiting() const {
    const std::size_t worth = smallest_worth_refining(extreme.dimension);
    return std::min<std::size_t>(std::max<std::size_t>(6 * worth, 4 * known),
                                 budget / 16 / extreme.point_bytes());
  }
  /// The number of points that start a reduction. The first one has about one block's: every block
  /// until then is filtered by a map of its own. (In the plane blocks keep less, and such a map
  /// costs little.) The second one has `finer` times those that the map was made from: of 8 million
  /// points of a 3D ball it halves those that are kept.
  std::size_t enough() const {
    constexpr std::size_t finer = 12;
    const std::size_t first =
        smallest_worth_refining(extreme.dimension) / (extreme.dimension == 2 ? 8 : 32);
    const std::size_t wanted = known == 0   ? first
                               : mapped > 0 ? std::max<std::size_t>(finer * mapped, 4 * known)
                                            : most_waiting();
    return std::min(wanted, most_waiting());
  }
  std::uint64_t most_waiting_bytes() const { return 4 * most_waiting() * extreme.point_bytes(); }
  /// Number of points not yet reduced, without those that a running reduction has taken.
  std::size_t unreduced() const { return waiting_count + (away > 0 ? 0 : extreme.size() - known); }
  NumberedPoints no_points() const { return {extreme.dimension, extreme.scalar, {}, {}}; }

  /// `block`: the one that will be filtered next.
  void reduce_if_worth(const PointView& block) {
    std::size_t count, limit;
    {
      const Guard lock(*this);
      count = unreduced();
      if (!map_is_late && (count == 0 || count <= enough())) return;
      limit = most_waiting();
    }
    std::unique_lock alone(reducing, std::defer_lock);
    // While another thread reduces, more points may wait, up to twice the limit.
    if (count < 2 * limit ? !alone.try_lock() : (alone.lock(), false)) return;
    {
      const Guard lock(*this);
      if (!map_is_late && unreduced() <= enough()) return;
    }
    reduce(&block);
  }

  /// Drops points that are strictly inside, by a map of the points held and, unless that leaves
  /// few, exactly; keeps the points if that fails. Builds a map for blocks like `block`. Null:
  /// none, as maybe no block follows, but only extreme points are left. `hull`, if given, receives
  /// their hull, unless its facets exceed the budget. Requires `reducing` locked.
  void reduce(const PointView* block, Hull* hull = nullptr) {
    const LockSpan held(&reducing);
    NumberedPoints all;
    std::vector<NumberedPoints> taken;
    std::shared_ptr<const StreamMap> before;
    std::uint64_t count, seen_now, others;
    bool reduced_already;
    {
      const Guard lock(*this);
      reduced_already = exact && unreduced() == 0;
      const bool unasked =
          hull == nullptr || extreme.dimension == 0;  // a push may set it meanwhile
      if (reduced_already && unasked && (block == nullptr || !map_is_late)) {
        reduced = seen;
        return;
      }
      others = most_waiting_bytes();
      away = extreme.size() + waiting_count;
      all = std::exchange(extreme, no_points());
      taken = std::exchange(waiting, {});
      waiting_count = 0;
      seen_now = seen;
      before = map;
    }
    std::shared_ptr<const StreamMap> next;
    bool exactly = false;
    try {
      Options step = options;
      all.take(taken, Run(step));
      count = all.size();
      step.memory_budget = left_beside(all, others);
      const Run run(step);
      const std::size_t worth = smallest_worth_refining(all.dimension);
      // The hull of few points takes less time than leaders do, and its map keeps less.
      const bool leads =
          leaders_suit && !reduced_already &&
          (block != nullptr ? count >= worth / 8 : count >= worth && count < seen_now / 2);
      if (leads)
        next = StreamMap::of_leaders(all, before.get(), block,
                                     block == nullptr ? count : 4 * seen_now, run);
      if (next != nullptr) next->thin(all, run);
      const auto most_left = [&] { return all.size() >= seen_now / 2; };
      // In the plane the hull takes no longer than the map of so few points.
      const std::uint64_t few = all.dimension == 2 ? 0 : worth;
      exactly =
          !reduced_already && (block == nullptr || most_left() ||
                               all.size() > (next == nullptr ? few : std::max(few, count / 2)));
      if (leads) leaders_suit = next != nullptr && (block == nullptr || !exactly);
      if (exactly || hull != nullptr) keep_extreme(all, step, hull);
      // Pages freed by the reduction are still resident; return them, as the points held need
      // memory, too.
      trim_pages(budget / 8);
      // If most points are extreme, a filter is not worthwhile.
      if (most_left())
        next = nullptr;
      else if (block != nullptr && next == nullptr)
        next = StreamMap::lay(all, *block, run);
    } catch (const Error& e) {
      put_back(std::move(all), std::move(taken));
      if (e.code() == ErrorCode::out_of_budget) refuse(e.what());
      throw;
    } catch (...) {
      put_back(std::move(all), std::move(taken));
      throw;
    }
    const Guard lock(*this);
    if (all.scalar != extreme.scalar) all.widen();
    extreme = std::move(all);
    known = extreme.size();
    exact = exactly || reduced_already;
    away = 0;
    reduced = seen_now;
    reductions += exactly ? 1 : 0;
    map_is_late = block == nullptr;
    if (block == nullptr) return;
    map = std::move(next);
    mapped = map != nullptr ? count : 0;
    if (map != nullptr) ++maps;
  }

  /// The memory left for an exact step beside `all`, which is sorted first, and `others`, in bytes.
  std::uint64_t left_beside(const NumberedPoints& all, std::uint64_t others) const {
    const std::uint64_t held = all.size() * all.point_bytes() + others;
    const std::uint64_t sorting = all.size() * (all.point_bytes() + sizeof(std::uint64_t));
    require_budget(budget, held + sorting + 1,
                   std::to_string(all.size()) + " points that may be extreme");
    return budget - held;
  }

  void put_back(NumberedPoints&& all, std::vector<NumberedPoints>&& taken) {
    trim_pages(budget / 8);
    const Guard lock(*this);
    if (all.scalar != extreme.scalar) all.widen();
    extreme = std::move(all);
    exact = false;
    away = 0;
    for (NumberedPoints& part : taken) wait(std::move(part));
  }

  /// Adds points to the waiting ones. Few are copied behind others: a part takes memory beside its
  /// points. Requires `mutex`.
  void wait(NumberedPoints&& part) {
    constexpr std::size_t few = 1024;
    if (part.scalar != extreme.scalar) part.widen();
    const std::size_t count = part.size();
    if (!waiting.empty() && waiting.back().size() < few)
      waiting.back().append(part);
    else
      waiting.push_back(std::move(part));
    waiting_count += count;
  }

  [[noreturn]] void refuse(const std::string& why) const {
    const Guard lock(*this);
    throw Error(ErrorCode::out_of_budget, "the stream holds ", extreme.size() + waiting_count,
                " points that may be extreme, of ", seen, " so far, and cannot go on: ", why);
  }

  // --------------------------------------------------------------------------- blocks

  /// The survivors of a block: by the current map, or by a map of the block itself if there is
  /// none.
  NumberedPoints survivors(const PointView& block, std::uint64_t first_id, const Run& run) const {
    std::shared_ptr<const StreamMap> filter;
    {
      const Guard lock(*this);
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
    // If the map keeps many points, it represents this block's region badly, as in ordered scans;
    // then a map of the block itself discards more.
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
        if (e.code() != ErrorCode::not_finite) throw;  // push() throws the error with the global id
      }
    if (found.all) return kept.append(block, 0, nullptr, block.count, first_id);
    kept.append(block, found.ids, first_id);
  }

  void push(const PointView& block, std::uint64_t first_id) {
    check_block(block, first_id, dimension());
    reduce_if_worth(block);
    const Run run(options);
    run.check();
    NumberedPoints kept{block.dimension, block.scalar, {}, {}};
    if (block.count > 0) {
      kept = survivors(block, first_id, run);
      refuse_not_finite(kept, run.threads);
    }
    take(std::move(kept), block.count, block.count > 0 ? first_id + block.count : 0);
  }

  std::uint32_t dimension() const {
    const Guard lock(*this);
    return extreme.dimension;
  }

  /// Adds survivors to the waiting points; next_id becomes at least `end`.
  void take(NumberedPoints&& kept, std::uint64_t count, std::uint64_t end) {
    const Guard lock(*this);
    if (extreme.dimension == 0) extreme = {kept.dimension, kept.scalar, {}, {}};
    check_block(kept.view(), 0, extreme.dimension);  // another push may have set it
    const ScalarType scalar = common_scalar(extreme.scalar, seen, kept.scalar, count);
    if (seen == 0) {
      extreme.scalar = scalar;
    } else if (scalar != extreme.scalar) {
      for (NumberedPoints& part : waiting) part.widen();
      extreme.widen();
    }
    if (kept.size() > 0) wait(std::move(kept));
    seen += count;
    next_id = std::max(next_id, end);
  }

  /// `hull`, if given, receives the hull of these points, if its facets fit the budget.
  HullState state(Hull* hull = nullptr) {
    const std::lock_guard alone(reducing);
    reduce(nullptr, hull);
    const Guard lock(*this);
    return StateParts::state(extreme, reduced + (extreme.size() > 0 ? left_out : 0));
  }
};

HullStream::HullStream(Options options) : impl_(std::make_unique<Impl>()) {
  impl_->options = std::move(options);
  // A fifth is kept free. Up to a tenth more than the counted memory was resident, because arrays
  // use huge pages where available and the allocator keeps freed blocks. On a busy machine, where
  // threads take turns, each kept some more: of 80 MiB a quarter is needed, hence up to 4 MiB.
  const std::uint64_t budget = resolve_budget(impl_->options.memory_budget);
  impl_->budget = budget - budget / 5 - std::min<std::uint64_t>(budget / 20, 4U << 20);
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
    // Reserves the ids at once, so that concurrent pushes get other ids.
    const Impl::Guard lock(*impl_);
    check_block(block, impl_->next_id, impl_->extreme.dimension);
    first_id = impl_->next_id;
    impl_->next_id += block.count;
  }
  try {
    impl_->push(block, first_id);
  } catch (...) {
    const Impl::Guard lock(*impl_);
    if (impl_->next_id == first_id + block.count) impl_->next_id = first_id;
    throw;
  }
}

void HullStream::push(const HullState& state) {
  if (state.dimension_ == 0) return;
  if (state.decimals_ > 0)
    throw Error(ErrorCode::invalid_argument,
                "a stream compares the rounded coordinates of a state ", "of numbers with ",
                int{state.decimals_}, " decimals; merge() compares such states on their grid");
  impl_->reduce_if_worth({});
  NumberedPoints points = StateParts::points(state);
  const std::uint64_t end = state.ids_.empty() ? 0 : std::max(state.ids_.back() + 1, state.seen_);
  impl_->take(std::move(points), state.seen_, end);
}

void HullStream::skip(std::uint64_t first_id, std::uint64_t count) {
  if (first_id + count < first_id)
    throw Error(ErrorCode::invalid_argument, "ids of the points exceed 2^64");
  const Impl::Guard lock(*impl_);
  impl_->left_out += count;
  impl_->next_id = std::max(impl_->next_id, first_id + count);
}

HullState HullStream::state() { return impl_->state(); }

Hull HullStream::hull() {
  Hull hull;
  const HullState state = impl_->state(&hull);
  if (hull.dimension == 0) {
    Options options = impl_->options;
    // The rest of the budget, beside the state and the stream's own copy of its points.
    const PointView points = state.points();
    const std::uint64_t held =
        2 * points.count * (points.dimension * scalar_size(points.scalar) + sizeof(std::uint64_t));
    options.memory_budget = impl_->budget - std::min(held, impl_->budget - 1);
    return state.hull(options);
  }
  hull.point_count = state.point_count();
  return hull;
}

StreamReport HullStream::report() const {
  const Impl::Guard lock(*impl_);
  const std::uint64_t held = impl_->extreme.size() + impl_->waiting_count + impl_->away;
  const std::uint64_t extreme = impl_->exact ? impl_->known : 0;
  return {impl_->seen, extreme, held - extreme, impl_->reductions, impl_->maps};
}

}  // namespace cullhull
