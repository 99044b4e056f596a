// The 3D engine on several threads: the surface is cut into pieces, which are joined pairwise.
#include <algorithm>
#include <thread>

#include "hull/space/engine_3d.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

/// For rounds with few points outside: all threads search for these, one inserts them.
void Engine3D::screen_and_insert(Id begin, Id end) {
  constexpr std::uint64_t chunk = 1 << 13;
  std::vector<Piece3D> readers(chunk_count(end - begin, chunk));
  const Id start = live_facet();
  run_.each_chunk(end - begin, chunk,
                  [&](std::uint64_t c, std::uint64_t first, std::uint64_t last) {
    readers[c].owner_count = none;  // all facets
    readers[c].hint = start;
    screen_points(shared_, readers[c], nullptr, static_cast<Id>(begin + first),
                  static_cast<Id>(begin + last));
  });
  Piece3D& all = pieces_[0];
  std::vector<Id> seen;
  for (Piece3D& r : readers) {
    seen.insert(seen.end(), r.deferred.begin(), r.deferred.end());
    all.duplicates.insert(all.duplicates.end(), r.duplicates.begin(), r.duplicates.end());
    all.rungs += r.rungs;
    all.steps += r.steps;
  }
  give_slots(static_cast<Id>(seen.size()));
  insert_points(shared_, all, seen.data(), 0, static_cast<Id>(seen.size()), nullptr);
  take_back_slots();
}

/// Cuts the surface into pieces with about equally many new points, inserts into them in parallel,
/// and joins neighbouring pieces pairwise until the points at the last border are inserted.
void Engine3D::insert_in_pieces(Id begin, Id end) {
  const Id count = std::min<Id>(run_.threads, (end - begin) / (smallest_parallel_round / 4));
  std::vector<Work> work(count);
  for (Id t = 0; t < count; ++t) {
    const std::uint64_t points = end - begin;
    work[t].begin = begin + static_cast<Id>(points * t / count);
    work[t].end = begin + static_cast<Id>(points * (t + 1) / count);
  }
  cut(work);
  run_pieces(work, begin, end);
  while (pieces_.size() > 1) {
    work = join_pieces();
    run_pieces(work, begin, end);
  }
  pieces_[0].entries = {};  // valid for this round's points only
  take_back_slots();
}

void Engine3D::cut(std::vector<Work>& work) {
  const auto count = static_cast<Id>(work.size());
  const Id begin = work.front().begin, end = work.back().end;
  const Cut3D cut = choose_cut(work);
  own_facets(cut);
  find_entries(begin, end);
  if (cut.planes()) divide(work, cut);

  pieces_.resize(count);
  const Id first_block = begin / Entries3D::block;
  for (Id t = 0; t < count; ++t) {
    Piece3D& piece = pieces_[t];
    piece.first_owner = t;
    piece.owner_count = 1;
    piece.epoch = pieces_[0].epoch;
    piece.entries = {entries_.data(), first_block};
    const Id points = work[t].end - work[t].begin + static_cast<Id>(work[t].positions.size());
    const Id slots = 2 * points + 64;
    piece.spare.emplace_back(slots_, slots_ + slots);
    slots_ += slots;
    piece.hint = none;
    for (const Entries3D::Entry& e : entries_)
      if (e.owner == t) {
        piece.hint = e.facet;
        break;
      }
  }
}

/// Redistributes points from ranges of the order to the pieces between planes.
void Engine3D::divide(std::vector<Work>& work, const Cut3D& cut) const {
  const Id begin = work.front().begin, end = work.back().end;
  constexpr std::uint64_t chunk = 1 << 14;
  std::vector<std::vector<Id>> found(chunk_count(end - begin, chunk) * work.size());
  run_.each_chunk(end - begin, chunk,
                  [&](std::uint64_t c, std::uint64_t first, std::uint64_t last) {
    for (std::uint64_t i = begin + first; i < begin + last; ++i) {
      const auto p = static_cast<Id>(i);
      found[c * work.size() + cut.piece_of(shared_.row(p))].push_back(p);
    }
  });
  for (std::size_t t = 0; t < work.size(); ++t) {
    work[t].begin = work[t].end = 0;
    for (std::size_t k = t; k < found.size(); k += work.size())
      work[t].positions.insert(work[t].positions.end(), found[k].begin(), found[k].end());
  }
}

void Engine3D::own_facets(const Cut3D& cut) {
  const auto runs = used_slots(1 << 13);
  run_.each_item(runs.size(), [&](std::uint64_t c) {
    constexpr std::uint32_t block = DirectionKey::block;
    double middles[3][block] = {};
    std::uint32_t keys[block];
    for (Id at = runs[c].first; at < runs[c].second; at += block) {
      const Id size = std::min(block, runs[c].second - at);
      for (Id i = 0; i < size; ++i) {
        double m[3] = {0, 0, 0};
        if (facets_[at + i].live()) middle(facets_[at + i], m);
        for (unsigned j = 0; j < 3; ++j) middles[j][i] = m[j];
        if (cut.planes() && facets_[at + i].live()) facets_[at + i].owner = cut.piece_of(m);
      }
      if (cut.planes()) continue;
      key_.keys(middles[0], middles[1], middles[2], order_.key_bits, keys);
      if (by_normals_) std::copy_n(rank_.get() + at, size, keys);
      for (Id i = 0; i < size; ++i)
        if (facets_[at + i].live())
          facets_[at + i].owner = static_cast<Id>(
              std::upper_bound(cut.keys.begin(), cut.keys.end(), keys[i]) - cut.keys.begin());
    }
  });
}

void Engine3D::find_entries(Id begin, Id end) {
  const Id first_block = begin / Entries3D::block;
  entries_.resize(end / Entries3D::block - first_block + 1);
  const Id start = live_facet();
  constexpr std::uint64_t chunk = 64;  // blocks of points
  run_.each(entries_.size(), chunk, [&](std::uint64_t first, std::uint64_t last) {
    Piece3D reader;
    reader.owner_count = none;  // all facets
    reader.hint = start;
    for (std::uint64_t b = first; b < last; ++b) {
      const auto position = static_cast<Id>((first_block + b) * Entries3D::block);
      const Id p = std::clamp(position, begin, end - 1);
      screen_points(shared_, reader, nullptr, p, p + 1);
      entries_[b] = {reader.hint, facets_[reader.hint].owner};
    }
  });
}

void Engine3D::run_pieces(const std::vector<Work>& work, Id begin, Id end) {
  const auto caller = std::this_thread::get_id();
  run_.each_item(pieces_.size(), [&](std::uint64_t t) {
    Piece3D& piece = pieces_[t];
    const Work& w = work[t];
    const std::function<void(double)> progress = [&](double share) {
      if (std::this_thread::get_id() == caller)
        run_.report("hull", (begin + share * (end - begin)) / points_.count);
    };
    if (piece.hint == none) {  // it owns no facet
      piece.deferred = w.positions;
      for (Id p = w.begin; p < w.end; ++p) piece.deferred.push_back(p);
    } else if (w.positions.empty()) {
      insert_points(shared_, piece, nullptr, w.begin, w.end, &progress);
    } else {
      insert_points(shared_, piece, w.positions.data(), 0, static_cast<Id>(w.positions.size()),
                    nullptr);
    }
  });
}

/// Joins pieces 2 k and 2 k + 1, whose common border vanishes; returns their deferred points, to be
/// tried again.
std::vector<Engine3D::Work> Engine3D::join_pieces() {
  const std::size_t count = (pieces_.size() + 1) / 2;
  std::vector<Work> work(count);
  for (std::size_t k = 0; k < count; ++k) {
    Piece3D& a = pieces_[2 * k];
    if (2 * k + 1 < pieces_.size()) {
      Piece3D& b = pieces_[2 * k + 1];
      a.owner_count += b.owner_count;
      a.epoch = std::max(a.epoch, b.epoch);
      if (a.hint == none) a.hint = b.hint;
      a.free.insert(a.free.end(), b.free.begin(), b.free.end());
      if (b.next_slot < b.end_slot) a.spare.emplace_back(b.next_slot, b.end_slot);
      a.spare.insert(a.spare.end(), b.spare.begin(), b.spare.end());
      a.deferred.insert(a.deferred.end(), b.deferred.begin(), b.deferred.end());
      a.duplicates.insert(a.duplicates.end(), b.duplicates.begin(), b.duplicates.end());
      a.rungs += b.rungs;
      a.steps += b.steps;
      a.inserted += b.inserted;
    }
    work[k].positions.swap(a.deferred);
    if (k > 0) pieces_[k] = std::move(a);
  }
  pieces_.resize(count);
  return work;
}

}  // namespace cullhull::internal
