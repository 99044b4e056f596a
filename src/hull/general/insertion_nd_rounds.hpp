// A part of insertion_nd.hpp: inserts the points of a round, on one thread or on several together.
//
// Why the order of threads does not matter. A thread holds all visible facets and all around them
// from before it changes the first until it lets go of them, so nobody else reads or changes them
// in between. The moments of letting go put all insertions in an order, and the surface is what one
// thread would get by inserting in that order: the convex hull, whatever the order.
//
// Why nobody waits for ever: nobody waits. A thread that finds a facet held by another one puts its
// point off and lets go of all that it holds. One thread inserts the last points alone.
//
// Example: 16 threads insert 37,000 points into a hull of 424,000 facets in 4D. A cavity and its
// border have some 90 facets, so that only threads that happen to be neighbours meet: one point in
// ten is put off, and at its second try, some dozens of points later, one in three of these again.
#pragma once

#include <algorithm>
#include <atomic>
#include <numeric>

#include "hull/general/insertion_nd.hpp"

namespace cullhull::internal {

template <unsigned D>
void InsertionNd<D>::insert_round() {
  const Id begin = starts_[rounds_done_], end = starts_[++rounds_done_];
  first_ = begin;
  count_ = end - begin;
  std::vector<Id> points(count_);
  std::iota(points.begin(), points.end(), begin);
  for (;;) {
    const unsigned lanes = useful_lanes(points.size());
    if (lanes < 2) break;
    const std::size_t before = points.size();
    points = insert_together(points, lanes);
    if (points.size() == before) break;
  }
  for (const Id p : points) {
    run_.check();
    insert<false>(lanes_[0], p);
  }
  end_of_pass();
  run_.report("hull", static_cast<double>(end) / static_cast<double>(expected_));
}

/// How many threads are worth their while for this many points: each should have a chunk of its own
/// and a part of the surface that is large compared with a cavity.
template <unsigned D>
unsigned InsertionNd<D>::useful_lanes(std::size_t points) const {
  constexpr std::size_t cavities = 64;
  const std::size_t room = live_ * inserted_ / (cavities * made_ + 1);
  // More lanes than threads would be worked on by thieves, side by side.
  const unsigned threads =
      counting_spans() ? run_.threads : std::min(run_.threads, machine_threads());
  return static_cast<unsigned>(std::min<std::size_t>({threads, most_lanes_, points / grain, room}));
}

/// Inserts points with several threads. Returns those that were put off, in order.
template <unsigned D>
std::vector<typename InsertionNd<D>::Id> InsertionNd<D>::insert_together(
    const std::vector<Id>& points, unsigned lanes) {
  while (lanes_.size() < lanes)
    lanes_.emplace_back(dim(), static_cast<std::uint16_t>(lanes_.size() + 1));
  // Memory cannot move while several threads use it: points that find none are put off. Where the
  // budget does not allow what may be needed, the thread that inserts them tells whether it is.
  const std::size_t fresh = live_ * points.size() / first_ * dim() / 2 + std::size_t{lanes} * slab;
  if (std::max(facet_slots_ + fresh, facet_capacity_ + facet_capacity_ / 2) <= most_facets_)
    reserve(facet_slots_ + fresh);
  std::atomic<bool> full{false};
  run_.with_threads(lanes).each_in_lane(points.size(), grain,
                                        [&](unsigned k, std::uint64_t begin, std::uint64_t end) {
    Lane& lane = lanes_[k];
    const auto insert_or_put_off = [&](Id point) {
      if (full.load(std::memory_order_relaxed)) return lane.put_off.push_back(point);
      const Inserted how = insert<true>(lane, point);
      if (how == Inserted::done && lane.held.size() < most_held) return;
      let_go(lane);
      if (how == Inserted::done) return;
      if (how == Inserted::full) full = true;
      lane.put_off.push_back(point);
      lane.hint = hint_near(point).load(std::memory_order_acquire);
    };
    lane.hint = hint_near(points[begin]).load(std::memory_order_acquire);
    const auto before = static_cast<std::ptrdiff_t>(lane.put_off.size());
    for (std::uint64_t i = begin; i < end; ++i) insert_or_put_off(points[i]);
    // Once more: who was in the way has left.
    const std::vector<Id> again(lane.put_off.begin() + before, lane.put_off.end());
    lane.put_off.erase(lane.put_off.begin() + before, lane.put_off.end());
    for (const Id p : again) insert_or_put_off(p);
    let_go(lane);
    if (same_facets_ && lane.tied) throw Tied{};
  });
  end_of_pass();
  std::vector<Id> left;
  for (Lane& lane : lanes_) {
    left.insert(left.end(), lane.put_off.begin(), lane.put_off.end());
    lane.put_off.clear();
  }
  std::sort(left.begin(), left.end());
  if (!full && 4 * left.size() > points.size()) most_lanes_ = std::max(1U, lanes / 2);
  if (16 * left.size() < points.size() && lanes == most_lanes_) most_lanes_ *= 2;
  return left;
}

template <unsigned D>
void InsertionNd<D>::end_of_pass() {
  inserted_ = made_ = 0;
  std::size_t removed = 0;
  for (const Lane& lane : lanes_) {
    inserted_ += lane.inserted;
    made_ += lane.made;
    removed += lane.removed;
  }
  live_ = dim() + 1 + made_ - removed;
  facet_slots_ = next_slot_.load(std::memory_order_relaxed);
}

/// Inserts a point, if it is outside of the hull.
template <unsigned D>
template <bool shared>
typename InsertionNd<D>::Inserted InsertionNd<D>::insert(Lane& lane, Id point) {
  aim(lane, point);
  if (!start<shared>(lane)) return Inserted::busy;
  const Id seed = locate<shared>(lane, point);
  if (seed == busy) return Inserted::busy;
  if (seed != no_index) {
    if (!find_cavity<shared>(lane, seed, point)) return Inserted::busy;
    if (!find_slots<shared>(lane)) return Inserted::full;
    replace(lane, point);
  }
  hint_near(point).store(lane.hint, std::memory_order_release);
  return Inserted::done;
}

/// Moves the lane's hint to a facet, if its slot has none. False if other lanes hold all that it
/// tries.
template <unsigned D>
template <bool shared>
bool InsertionNd<D>::start(Lane& lane) {
  constexpr unsigned tries = 64;
  for (unsigned busy_slots = 0; busy_slots < tries;) {
    if (shared && !hold(lane, lane.hint))
      ++busy_slots;
    else if (store_.alive(lane.hint))
      return true;
    if (++lane.hint >= facet_slots_) lane.hint = 0;
  }
  return false;
}

/// Holds slot f for the lane. False if another lane holds it.
template <unsigned D>
bool InsertionNd<D>::hold(Lane& lane, Id f) {
  const std::atomic_ref<std::uint16_t> holder(store_.mark(f).holder);
  std::uint16_t nobody = holder.load(std::memory_order_relaxed);
  if (nobody == lane.number) return true;
  if (nobody != 0 || !holder.compare_exchange_strong(nobody, lane.number, std::memory_order_acquire,
                                                     std::memory_order_relaxed))
    return false;
  lane.held.push_back(f);
  return true;
}

template <unsigned D>
bool InsertionNd<D>::hold_all(Lane& lane, const Id* facets) {
  for (unsigned j = 0; j < dim(); ++j)
    if (!hold(lane, facets[j])) return false;
  return true;
}

template <unsigned D>
void InsertionNd<D>::let_go(Lane& lane) {
  for (const Id f : lane.held)
    std::atomic_ref(store_.mark(f).holder).store(0, std::memory_order_release);
  lane.held.clear();
}

/// Appends unused slots to the lane's visible ones, until there is one for each new facet. False if
/// there are too few, which only a lane of several meets.
template <unsigned D>
template <bool shared>
bool InsertionNd<D>::find_slots(Lane& lane) {
  while (lane.visible.size() < lane.horizon.size()) {
    if (!lane.unused.empty() && (!shared || hold(lane, lane.unused.back()))) {
      lane.visible.push_back(lane.unused.back());
      lane.unused.pop_back();
      continue;
    }
    const std::size_t begin = next_slot_.fetch_add(slab, std::memory_order_relaxed);
    if (begin + slab > facet_capacity_) {
      next_slot_.fetch_sub(slab, std::memory_order_relaxed);
      if (!shared) {
        reserve(begin + slab);
        continue;
      }
      lane.unused.insert(lane.unused.end(), lane.visible.begin() + lane.seen, lane.visible.end());
      return false;
    }
    clear_slots(static_cast<Id>(begin), static_cast<Id>(begin + slab), lane);
  }
  return true;
}

/// Gives unused slots to the lane.
template <unsigned D>
void InsertionNd<D>::clear_slots(Id begin, Id end, Lane& lane) {
  for (Id f = end; f-- > begin;) {
    store_.clear(f);
    lane.unused.push_back(f);
  }
}

}  // namespace cullhull::internal
