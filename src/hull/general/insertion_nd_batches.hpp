// A part of insertion_nd.hpp: processes rounds as batches of streams, and chooses the cavities of a
// batch that are replaced in parallel.
#pragma once

#include <algorithm>

#include "hull/general/insertion_nd.hpp"

namespace cullhull::internal {

template <unsigned D>
template <class Body>
void InsertionNd<D>::in_parallel(const Body& body) {
  // Batches of fewer than some 100 facets, tens of microseconds, are done faster by one thread.
  const std::size_t count = batch_.size(), lanes = lanes_.size();
  if (batch_facets_ < 100 || !shared_ || count == 1 || crowded()) {
    for (const Id s : batch_) body(streams_[s], lanes_[0]);
    return;
  }
  // Each worker has its own streams, whose facets are in its cache; one that is done steals from
  // others.
  for (std::size_t k = 0; k < lanes; ++k) {
    shares_[k].next.store(count * k / lanes, std::memory_order_relaxed);
    shares_[k].end = count * (k + 1) / lanes;
  }
  crew_.run(static_cast<std::uint32_t>(lanes), [&](std::uint32_t, unsigned lane) {
    const std::size_t reach = spans::counting() ? 1 : lanes;
    for (std::size_t k = 0; k < reach; ++k) {
      WorkShare& share = shares_[(lane + k) % lanes];
      for (;;) {
        const std::size_t i = share.next.fetch_add(1, std::memory_order_relaxed);
        if (i >= share.end) break;
        body(streams_[batch_[i]], lanes_[lane]);
        ++lanes_[lane].streams_done;
      }
    }
  });
  ++batches_shared_;
}

/// Checks every 64 shared batches whether helpers do their part. Where they did less than an eighth
/// of the work, none is asked for a while (crowding.hpp); after the third time in a row, never
/// again in this session.
template <unsigned D>
void InsertionNd<D>::review_sharing() {
  constexpr unsigned batches = 64, most_absences = 3;
  if (batches_shared_ < batches) return;
  batches_shared_ = 0;
  std::uint64_t all = 0;
  for (const Lane& lane : lanes_) all += lane.streams_done;
  const bool absent = 8 * (all - lanes_[0].streams_done) < all;
  absences_ = absent ? absences_ + 1 : 0;
  if (absent) note_absence();
  if (absences_ == most_absences) {
    shared_ = false;
    if (!same_facets_) width_ = 1;
  }
  for (Lane& lane : lanes_) lane.streams_done = 0;
}

template <unsigned D>
void InsertionNd<D>::insert_round() {
  const Id begin = starts_[rounds_done_], end = starts_[++rounds_done_], count = end - begin;
  const Id width = std::clamp(static_cast<Id>(width_), 1U, std::max(1U, count / 4));
  if (streams_.size() < width) streams_.resize(width);
  batch_.clear();
  for (Id s = 0; s < width; ++s) {
    streams_[s].next = begin + static_cast<Id>(std::uint64_t{count} * s / width);
    streams_[s].end = begin + static_cast<Id>(std::uint64_t{count} * (s + 1) / width);
    streams_[s].hint = recent_;
    if (streams_[s].next < streams_[s].end) batch_.push_back(s);
  }
  std::size_t tried = 0, refused = 0, made = 0;
  while (!batch_.empty()) {
    run_.check();
    in_parallel([this](Stream& s, Lane& lane) { advance(s, lane); });
    settle();
    in_parallel([this](Stream& s, Lane& lane) {
      if (s.accepted) replace(s, lane);
    });
    std::size_t left = 0;
    for (const Id s : batch_) {
      tried += streams_[s].found;
      refused += streams_[s].found && !streams_[s].accepted;
      made += streams_[s].accepted ? streams_[s].horizon.size() : 0;
      if (streams_[s].next < streams_[s].end) batch_[left++] = s;
    }
    batch_.resize(left);
    review_sharing();
  }
  adapt(tried, refused, made);
  run_.report("hull", static_cast<double>(end) / static_cast<double>(expected_));
}

/// Adapts the number of streams. A batch should create about 250 facets for each worker (some tens
/// of microseconds) to be worth its synchronisation; more streams would displace one another's
/// facets from the cache. The share of refused cavities grows with the number of streams: 6 % costs
/// little, and less leaves 6D with too few streams (two to six points a batch).
template <unsigned D>
void InsertionNd<D>::adapt(std::size_t tried, std::size_t refused, std::size_t made) {
  constexpr double wanted = 0.06, batch = 250, fewest = 8, most = 256;
  if (tried < 16 || (!shared_ && !same_facets_)) return;
  const auto lanes = same_facets_ ? 1.0 : static_cast<double>(lanes_.size());
  const double share = static_cast<double>(refused) / static_cast<double>(tried);
  const double cavity = std::max(1.0, static_cast<double>(made) / static_cast<double>(tried));
  const double busy = std::clamp(batch * lanes / cavity, std::min(fewest * lanes, most), most);
  width_ = std::clamp(width_ * std::clamp(wanted / std::max(share, 1e-3), 0.5, 4.0), 2.0, busy);
}

/// Advances the stream to its next point outside of the hull, and finds that point's cavity.
template <unsigned D>
void InsertionNd<D>::advance(Stream& s, Lane& lane) {
  constexpr unsigned at_once = 64;  // so that other streams do not wait for long
  s.found = s.accepted = false;
  for (unsigned k = 0; k < at_once && s.next < s.end; ++k, ++s.next) {
    if (!store_.alive(s.hint)) s.hint = recent_;
    aim(lane, s.next);
    const Id seed = locate(lane, s.hint, s.next, s.hint);
    if (seed == no_index) continue;
    find_cavity(s, lane, seed);
    s.hint = seed;
    s.found = true;
    return;
  }
}

/// Decides, in the order of streams, which cavities are replaced in this batch, and assigns slots
/// to their new facets.
template <unsigned D>
void InsertionNd<D>::settle() {
  if (++batch_number_ >= 0x7FFFFFFF) {
    std::fill_n(claims_.data(), facet_capacity_, 0);
    batch_number_ = 1;
  }
  batch_facets_ = 0;
  std::size_t fresh = 0;
  const bool shared = batch_.size() > 1;
  for (const Id i : batch_) {
    Stream& s = streams_[i];
    if (!s.found || (shared && !clear_of_others(s))) continue;
    s.accepted = true;
    if (shared) claim(s);
    ++s.next;
    batch_facets_ += s.horizon.size();
    if (s.horizon.size() > s.seen) fresh += s.horizon.size() - s.seen;
  }
  reserve(facet_slots_ + fresh);
  for (const Id i : batch_) {
    Stream& s = streams_[i];
    if (!s.accepted) continue;
    for (std::size_t k = s.seen; k < s.horizon.size(); ++k) {
      if (free_.empty()) {
        s.visible.push_back(static_cast<Id>(facet_slots_++));
      } else {
        s.visible.push_back(free_.back());
        free_.pop_back();
      }
    }
    live_ += s.horizon.size();
    live_ -= s.seen;
    recent_ = s.visible[0];
  }
  // Slots freed here are still read until all cavities are replaced: they are reused from the next
  // batch on.
  for (const Id i : batch_) {
    const Stream& s = streams_[i];
    if (!s.accepted) continue;
    for (std::size_t k = s.horizon.size(); k < s.seen; ++k) free_.push_back(s.visible[k]);
  }
}

/// Two cavities can be replaced together if no facet visible from one point is visible from the
/// other or beyond a horizon ridge of the other: a new facet's plane lies between those of the two
/// facets at its ridge, so a point that sees neither of them does not see the new facet either.
template <unsigned D>
bool InsertionNd<D>::clear_of_others(const Stream& s) const {
  const std::uint32_t border = 2 * batch_number_, visible = border + 1;
  for (const Id f : s.visible)
    if (claims_[f] >= border) return false;
  for (const HorizonRidge& r : s.horizon)
    if (claims_[r.outside] == visible) return false;
  return true;
}

template <unsigned D>
void InsertionNd<D>::claim(Stream& s) {
  const std::uint32_t border = 2 * batch_number_;
  for (const Id f : s.visible) claims_[f] = border + 1;
  for (const HorizonRidge& r : s.horizon) claims_[r.outside] = border;
}

}  // namespace cullhull::internal
