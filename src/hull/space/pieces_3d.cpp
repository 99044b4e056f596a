// The 3D engine on several threads: the surface is cut into pieces, and where their borders were it
// is cut again along others.
#include <algorithm>
#include <thread>

#include "hull/space/engine_3d.hpp"
#include "parallel/scan.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

/// For rounds with few points outside: all threads search for these.
void Engine3D::screen_and_insert(Id begin, Id end) {
  constexpr std::uint64_t chunk = 1 << 13;
  pieces_.resize(chunk_count(end - begin, chunk));
  const Id start = live_facet();
  run_.each_chunk(end - begin, chunk,
                  [&](std::uint64_t c, std::uint64_t first, std::uint64_t last) {
    pieces_[c].owner_count = none;  // all facets
    pieces_[c].hint = start;
    screen_points(shared_, pieces_[c], nullptr, static_cast<Id>(begin + first),
                  static_cast<Id>(begin + last));
  });
  Array<Waiting3D> seen = join_pieces();
  give_slots(static_cast<Id>(seen.size()));
  insert_waiting(std::move(seen));
}

/// Cuts the surface into pieces with about equally many new points, inserts into them in parallel,
/// and then the points at the borders.
void Engine3D::insert_in_pieces(Id begin, Id end) {
  const Id count = std::min<Id>(run_.threads, (end - begin) / (smallest_parallel_round / 4));
  std::vector<Work> work(count);
  const std::uint64_t points = end - begin;
  for (Id t = 0; t < count; ++t)
    work[t] = {static_cast<Id>(begin + points * t / count),
               static_cast<Id>(begin + points * (t + 1) / count)};
  cut_ = choose_cut(work);
  own_facets();
  find_entries(begin, end);
  if (cut_.planes())
    work = deal(
        end - begin, count,
        [&](std::uint64_t i) {
      const Entries3D::Entry& e =
          entries_[(begin + i) / Entries3D::block - begin / Entries3D::block];
      const auto p = static_cast<Id>(begin + i);
      return Waiting3D{p, e.owner == cut_.piece_of(shared_.row(p)) ? e.facet : none};
        },
        [&](std::uint64_t i) { return cut_.piece_of(shared_.row(static_cast<Id>(begin + i))); });
  give_slots(end - begin);
  make_pieces(work);
  for (std::size_t b = entries_.size(); b-- > 0;)  // the first of each piece stays
    pieces_[entries_[b].owner].hint = entries_[b].facet;
  for (Piece3D& piece : pieces_) piece.entries = {entries_.data(), begin / Entries3D::block};
  run_pieces(work, cut_.planes());
  owners_ = count;
  insert_waiting(join_pieces());
}

/// Inserts points between pieces: again in pieces, with other borders, for as long as these suit
/// most points and are worth it; the last points into the whole surface.
void Engine3D::insert_waiting(Array<Waiting3D> left) {
  // Fewer points take less time than a cut: 10,000 points on two threads, some 2,500 of them at the
  // border, took 13 % more instructions when these were cut again.
  constexpr std::size_t least = 4096, share = 512;
  std::uint64_t slots = 0;
  for (const auto& [begin, end] : pieces_[0].spare) slots += end - begin;
  for (std::size_t before = none; run_.threads > 1 && left.size() >= least &&
                                  left.size() <= 3 * (before / 4) && 2 * left.size() <= slots;) {
    before = left.size();
    const std::vector<Work> work =
        cut_again(left, static_cast<Id>(std::min<std::size_t>(run_.threads, before / share)));
    make_pieces(work);
    for (std::size_t t = 0; t < work.size(); ++t) {
      pieces_[t].old_owners = owners_;
      pieces_[t].first_owner += owners_;
      pieces_[t].cut = &cut_;
      if (work[t].begin < work[t].end) pieces_[t].hint = waiting_[work[t].begin].facet;
    }
    run_pieces(work, true);
    owners_ += static_cast<Id>(work.size());
    left = join_pieces();
    slots -= 2 * (before - left.size());
  }
  insert_points(shared_, pieces_[0], left.data(), 0, static_cast<Id>(left.size()), nullptr);
  take_back_slots();
}

/// Chooses other borders for points that wait at the present ones, and deals the points to the
/// pieces that their facets belong to.
std::vector<Engine3D::Work> Engine3D::cut_again(Array<Waiting3D>& left, Id count) {
  constexpr std::uint32_t block = DirectionKey::block;
  cut_.key = cut_.key.turned();
  cut_.levels.clear();
  const Id start = live_facet();
  BigArray<Id> keys(left.size());
  run_.each(left.size(), 8 * block, [&](std::uint64_t begin, std::uint64_t end) {
    const auto live = [&](const Waiting3D& w) {
      return w.facet != none && facets_[w.facet].live();
    };
    // Along slivers a walk from afar takes milliseconds.
    const auto* near = std::find_if(left.data() + begin, left.data() + end, live);
    Id f = near != left.data() + end ? near->facet : start;
    for (std::uint64_t i = begin; i < end; ++i) {
      Waiting3D& w = left[i];
      w.facet = f = climb(shared_, f, live(w) ? w.facet : f, shared_.row(w.point));
    }
    for (std::uint64_t i = begin; i < end; i += block)
      cut_.keys_of(shared_, &left[i], static_cast<Id>(std::min<std::uint64_t>(block, end - i)),
                   keys.get() + i);
  });
  choose_next_cut(left, keys.get(), count);
  return deal(
      left.size(), count, [&](std::uint64_t i) { return left[i]; },
      [&](std::uint64_t i) {
    return cut_.planes() ? cut_.piece_of(shared_, facets_[left[i].facet])
                         : cut_.piece_of_key(keys[i]);
      });
}

/// Writes the waiting points at(i) to waiting_, piece by piece, in each in order. Returns the
/// pieces' shares.
template <class At, class PieceOf>
std::vector<Engine3D::Work> Engine3D::deal(std::uint64_t points, Id count, const At& at,
                                           const PieceOf& piece_of) {
  constexpr std::uint64_t chunk = 1 << 12;
  std::vector<Id> places(chunk_count(points, chunk) * count, 0), starts;
  run_.each_chunk(points, chunk, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) ++places[c * count + piece_of(i)];
  });
  scan_buckets(places, count, &starts);
  waiting_ = BigArray<Waiting3D>(points);
  run_.each_chunk(points, chunk, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) waiting_[places[c * count + piece_of(i)]++] = at(i);
  });
  std::vector<Work> work(count);
  for (Id t = 0; t < count; ++t) work[t] = {starts[t], starts[t + 1]};
  return work;
}

/// Makes a piece for each share of the points, with as many slots as these can use; the first piece
/// keeps the rest.
void Engine3D::make_pieces(const std::vector<Work>& work) {
  pieces_.resize(work.size());
  auto& spare = pieces_[0].spare;
  for (auto t = static_cast<Id>(work.size()); t-- > 0;) {
    Piece3D& piece = pieces_[t];
    piece.first_owner = t;
    piece.owner_count = 1;
    piece.epoch = pieces_[0].epoch;
    piece.hint = none;
    for (Id need = t > 0 ? 2 * (work[t].end - work[t].begin) : 0; need > 0 && !spare.empty();) {
      auto& [begin, end] = spare.back();
      const Id some = std::min(need, end - begin);
      need -= some;
      end -= some;
      piece.spare.emplace_back(end, end + some);
      if (begin == end) spare.pop_back();
    }
  }
}

/// Writes to each facet which piece it belongs to.
void Engine3D::own_facets() {
  const auto runs = used_slots(1 << 11);
  run_.each_item(runs.size(), [&](std::uint64_t c) {
    constexpr std::uint32_t block = DirectionKey::block;
    Waiting3D facets[block];
    std::uint32_t keys[block];
    for (Id at = runs[c].first; at < runs[c].second;) {
      Id size = 0;
      for (; at < runs[c].second && size < block; ++at)
        if (facets_[at].live()) facets[size++].facet = at;
      if (!cut_.planes() && !cut_.by_normals) cut_.keys_of(shared_, facets, size, keys);
      for (Id i = 0; i < size; ++i) {
        Facet3D& f = facets_[facets[i].facet];
        f.owner = cut_.planes()     ? cut_.piece_of(shared_, f)
                  : cut_.by_normals ? cut_.piece_of_key(rank_[facets[i].facet])
                                    : cut_.piece_of_key(keys[i]);
      }
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

/// Inserts each piece's share, of waiting_ or of the positions.
void Engine3D::run_pieces(const std::vector<Work>& work, bool waiting) {
  const auto caller = std::this_thread::get_id();
  run_.each_item(pieces_.size(), [&](std::uint64_t t) {
    Piece3D& piece = pieces_[t];
    const auto& [begin, end] = work[t];
    const std::function<void(double)> progress = [&](double share) {
      if (std::this_thread::get_id() == caller)
        run_.report("hull", (work.front().begin + share * (work.back().end - work.front().begin)) /
                                points_.count);
    };
    if (piece.hint != none) {
      insert_points(shared_, piece, waiting ? waiting_.get() : nullptr, begin, end,
                    waiting ? nullptr : &progress);
    } else {  // it owns no facet
      for (Id i = begin; i < end; ++i)
        piece.deferred.push_back(waiting ? waiting_[i] : Waiting3D{i, none});
    }
  });
}

/// Joins all pieces to one; returns the points that they deferred.
Array<Waiting3D> Engine3D::join_pieces() {
  std::vector<std::size_t> before;
  for (const Piece3D& piece : pieces_) before.push_back(piece.deferred.size());
  Array<Waiting3D> left(exclusive_scan(before));
  run_.each_item(pieces_.size(), [&](std::uint64_t t) {
    std::copy(pieces_[t].deferred.begin(), pieces_[t].deferred.end(), left.data() + before[t]);
    pieces_[t].deferred.clear();
  });
  Piece3D& all = pieces_[0];
  for (Piece3D& piece : pieces_) {
    if (piece.next_slot < piece.end_slot) piece.spare.emplace_back(piece.next_slot, piece.end_slot);
    piece.next_slot = piece.end_slot = 0;
    if (&piece == &all) continue;
    all.epoch = std::max(all.epoch, piece.epoch);
    all.free.insert(all.free.end(), piece.free.begin(), piece.free.end());
    all.spare.insert(all.spare.end(), piece.spare.begin(), piece.spare.end());
    all.add_counts(piece);
  }
  pieces_.resize(1);
  all.first_owner = all.old_owners = 0;
  all.owner_count = none;  // all facets
  all.entries = {};        // valid for this round's points only
  all.hint = live_facet();
  return left;
}

}  // namespace cullhull::internal
