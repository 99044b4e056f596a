#include "distributed/job.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cullhull/error.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "filter/planner.hpp"
#include "flow/sample_map.hpp"
#include "geometry/gather.hpp"
#include "parallel/memory/memory.hpp"
#include "parallel/threads/parallel.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull::internal {
namespace {

constexpr std::uint64_t any = std::numeric_limits<std::uint64_t>::max();

/// The minimum and the maximum of a value over all ranks, encoded as two numbers that
/// Communicator::least() combines. none(): no rank had a value; one(): all had the same.
struct Range {
  std::uint64_t places[2];
  explicit Range(std::uint64_t value, bool has = true)
      : places{has ? value : any, has ? ~value : any} {}
  bool none() const { return places[0] == any && places[1] == any; }
  bool one() const { return places[0] == ~places[1]; }
  std::uint64_t low() const { return places[0]; }
  std::uint64_t high() const { return ~places[1]; }
};

bool finite(const PointView& view, std::uint64_t i) {
  for (std::uint32_t j = 0; j < view.dimension; ++j)
    if (!std::isfinite(view.at(i, j))) return false;
  return true;
}

void drop_not_finite(NumberedPoints& points) {
  const PointView view = points.view();
  std::vector<std::uint64_t> places;
  for (std::uint64_t i = 0; i < view.count; ++i)
    if (finite(view, i)) places.push_back(i);
  if (places.size() < points.size()) points.keep(places);
}

}  // namespace

Job::Job(MPI_Comm comm, const mpi::JobOptions& options)
    : options_(options),
      ranks_(comm, options.run),
      beside_(options.run),
      alone_(options.run),
      budget_(options.run.memory_budget) {
  const auto sharers = static_cast<unsigned>(ranks_.machine_ranks());
  if (beside_.threads == 0) beside_.threads = std::max(1U, resolve_threads(0) / sharers);
  if (budget_ == 0) budget_ = resolve_budget(0) / sharers;
  beside_.memory_budget = budget_;
  report_.ranks = ranks_.size();
}

// ------------------------------------------------------------------------------- agreement

void Job::check_local(bool numbered) const {
  const mpi::Block* first = nullptr;
  for (const mpi::Block& b : blocks_) {
    if (b.points.count == 0) continue;
    if (first == nullptr) first = &b;
    check_block(b.points, numbered ? b.first_id : 0, first->points.dimension);
  }
}

void Job::agree(std::vector<mpi::Block> blocks, bool numbered) {
  blocks_ = std::move(blocks);
  ranks_.together([&] {
    if (options_.root < mpi::every_rank || options_.root >= ranks_.size())
      refuse("root ", options_.root, " is no rank of ", ranks_.size());
    check_local(numbered);
  });
  for (const mpi::Block& b : blocks_) local_ += b.points.count;
  agree_on_points();
  if (!numbered) {
    const std::uint64_t before = ranks_.sum_before(local_);
    const std::uint64_t first = options_.first_id.value_or(before);
    for (mpi::Block& b : blocks_) b.first_id = first;
    ranks_.together([&] { check_local(true); });
  }
  std::erase_if(blocks_, [](const mpi::Block& b) { return b.points.count == 0; });
}

void Job::agree_on_points() {
  // The dimension and scalar type of ranks without points matter only if no rank has points.
  std::uint32_t d = 0, d_of_none = 0;
  ScalarType scalar = ScalarType::f64, scalar_of_none = ScalarType::f64;
  std::uint64_t count = 0;
  for (const mpi::Block& b : blocks_) {
    (b.points.count > 0 ? d : d_of_none) = b.points.dimension;
    if (b.points.count > 0)
      scalar = common_scalar(scalar, count, b.points.scalar, b.points.count);
    else
      scalar_of_none = b.points.scalar;
    count += b.points.count;
  }
  const auto known = static_cast<std::uint64_t>(options_.root + 1);
  const auto number = [](ScalarType s) { return static_cast<std::uint64_t>(s); };
  Range of[] = {Range(d, local_ > 0),
                Range(number(scalar), local_ > 0),
                Range(d_of_none, d_of_none > 0),
                Range(number(scalar_of_none), d_of_none > 0),
                Range(known),
                Range(options_.first_id.has_value() ? 1 : 0)};
  ranks_.least({of[0].places, 2 * std::size(of)});
  if (!of[4].one()) refuse("the ranks differ in their root");
  if (!of[5].one()) refuse("some ranks have given a first id, others have not");
  const bool empty = of[0].none();
  const Range& dimension = of[empty ? 2 : 0];
  const Range& scalars = of[empty ? 3 : 1];
  if (dimension.none()) refuse("points need at least one dimension");
  if (!dimension.one())
    refuse("the ranks have points of dimension ", dimension.low(), " and ", dimension.high());
  dimension_ = static_cast<std::uint32_t>(dimension.low());
  scalar_ = scalars.one() ? static_cast<ScalarType>(scalars.low()) : ScalarType::f64;
  total_ = local_;
  ranks_.sum({&total_, 1});
  report_.points = total_;
}

// ------------------------------------------------------------------------------- the common map

/// About `size` points of this rank, evenly spaced. Points that are not finite are omitted here; a
/// later check of all points reports them.
NumberedPoints Job::sampled(std::uint64_t size) const {
  NumberedPoints all{dimension_, scalar_, {}, {}};
  if (local_ == 0) return all;
  const std::vector<std::uint64_t> places = sample_ids(local_, std::min(size, local_));
  std::uint64_t before = 0;
  auto at = places.begin();
  std::vector<std::uint64_t> of_this;
  for (const mpi::Block& b : blocks_) {
    of_this.clear();
    for (; at != places.end() && *at - before < b.points.count; ++at)
      of_this.push_back(*at - before);
    NumberedPoints of_block{dimension_, b.points.scalar, {}, {}};
    of_block.append(b.points, of_this, b.first_id);
    drop_not_finite(of_block);
    if (of_block.scalar != scalar_) of_block.widen();
    all.append(of_block);
    before += b.points.count;
  }
  return all;
}

/// The extreme points of this rank's share of the sample that a single process would take for its
/// map. Empty if a map would not be worthwhile.
Part Job::local_sample() {
  const std::uint64_t probe_size = probe_sample_size(local_, dimension_);
  Part part{sampled(probe_size), 0};
  if (part.points.size() == 0) return part;
  part.seen = part.points.size();
  keep_extreme(part.points, beside_);
  const std::uint64_t extreme = part.points.size();
  if (!cull_pays(total_, dimension_, part.seen, extreme)) return {{dimension_, scalar_, {}, {}}, 0};
  const double share = static_cast<double>(local_) / static_cast<double>(total_);
  const auto size = static_cast<std::uint64_t>(
      share * static_cast<double>(map_sample_size(total_, dimension_, part.seen, extreme)));
  if (size <= part.seen) return part;
  part.points = sampled(size);
  part.seen = part.points.size();
  keep_extreme(part.points, beside_);
  return part;
}

const Part& Job::share_samples() {
  common_ = {{dimension_, scalar_, {}, {}}, 0};
  if (ranks_.size() == 1 || dimension_ < GaugeMap::min_dimension ||
      dimension_ > GaugeMap::max_dimension || total_ < smallest_worth_culling(dimension_))
    return common_;
  std::exception_ptr failure;
  try {
    common_ = local_sample();
  } catch (...) {
    failure = std::current_exception();
  }
  gather(
      ranks_, root(), common_, [&](Part& part) { reduce(part); },
      [&](std::uint64_t bytes) { check_room(bytes); }, failure);
  on_root([&] {
    keep_extreme(common_.points, beside_);
    report_.sampled = common_.seen;
    if (!common_.few() || common_.points.size() <= dimension_)
      common_ = {{dimension_, scalar_, {}, {}}, 0};
  });
  broadcast(ranks_, root(), common_, [&](std::uint64_t bytes) { check_room(bytes); });
  report_.common = common_.points.size();
  return common_;
}

// ------------------------------------------------------------------------------- parts

void Job::check_room(std::uint64_t bytes) const {
  require_budget(budget_, bytes, "points of other ranks that may be extreme");
}

void Job::reduce(Part& part) const {
  // Joining fewer parts leaves few points that are not extreme, so only the root reduces them. The
  // number is a guess, not tuned.
  constexpr std::uint64_t worth = 4;
  if (part.merged < worth || !part.few()) return;
  keep_extreme(part.points, beside_);
  part.merged = 1;
}

Part Job::local_part() const {
  Part part{{dimension_, scalar_, {}, {}}, local_};
  for (const mpi::Block& b : blocks_) {
    NumberedPoints left = survivors_of(common_.points, b, beside_);
    if (left.scalar != scalar_) left.widen();
    check_room(2 * (part.points.size() + left.size()) * left.point_bytes());
    part.points.append(left);
  }
  // A filter leaves a few times as many points as are extreme. It is not worthwhile to find the
  // extreme ones on this rank, since the root computes the hull of all survivors. But if more than
  // 1/128 of the points survive (a guess, not tuned), they are reduced before they are sent.
  constexpr std::uint64_t most_share = 128;
  if (part.points.size() > local_ / most_share) keep_extreme(part.points, beside_);
  return part;
}

Part Job::gather_parts() {
  Part part{{dimension_, scalar_, {}, {}}, 0};
  std::exception_ptr failure;
  try {
    part = local_part();
  } catch (...) {
    failure = std::current_exception();
  }
  ranks_.agree(failure);
  std::uint64_t contributed = part.points.size();
  ranks_.sum({&contributed, 1});
  report_.contributed = contributed;
  gather(
      ranks_, root(), part, [&](Part& p) { reduce(p); },
      [&](std::uint64_t bytes) { check_room(bytes); }, nullptr);
  on_root([&] { part.points.sort(); });
  return part;
}

// ------------------------------------------------------------------------------- the report

void Job::finish() {
  const Traffic& traffic = ranks_.traffic();
  const double work = std::max(0.0, process_work() - work_before_ - traffic.waiting_work);
  const auto nanoseconds = static_cast<std::uint64_t>(1e9 * work);
  std::uint64_t sums[] = {traffic.messages, traffic.bytes, nanoseconds,
                          is_root() ? report_.sampled : 0};
  std::uint64_t most = ~nanoseconds;
  ranks_.sum(sums);
  ranks_.least({&most, 1});
  report_.messages = sums[0];
  report_.bytes = sums[1];
  report_.work_seconds = 1e-9 * static_cast<double>(sums[2]);
  report_.sampled = sums[3];
  report_.greatest_work_seconds = 1e-9 * static_cast<double>(~most);
  report_.seconds = seconds_since(start_);
  if (options_.report != nullptr) *options_.report = report_;
}

}  // namespace cullhull::internal
