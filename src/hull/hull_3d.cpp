// The 3D engine: rounds of sorted insertion, the large ones on several pieces of the surface at
// once.
#include <algorithm>
#include <string>
#include <thread>

#include "cullhull/error.hpp"
#include "hull/engine.hpp"
#include "hull/insertion_3d.hpp"
#include "hull/order_3d.hpp"
#include "parallel/big_array.hpp"
#include "parallel/parallel.hpp"
#include "parallel/raw_array.hpp"

namespace cullhull::internal {
namespace {

using Id = std::uint32_t;
constexpr Id none = Facet3D::none;

class Engine3D {
 public:
  Engine3D(const LocalPoints& points, const Id* simplex, std::uint64_t budget,
           const Control& control, unsigned threads)
      : points_(points),
        control_(control),
        budget_(budget),
        threads_(threads),
        predicates_(points, simplex),
        key_(points, predicates_.centre(), simplex) {
    order_ = insertion_order_3d(points, key_, simplex, threads);
    copy_rows();
    shared_.predicates = &predicates_;
    shared_.control = &control_;
    shared_.order = order_.ids.get();
    shared_.rows = rows_.get();
    shared_.point_count = points.count;
  }

  SimplicialHull run();

 private:
  struct Work {  // of one piece: positions, or a range of them
    std::vector<Id> positions;
    Id begin = 0, end = 0;
  };

  void copy_rows();
  void build_simplex();
  void reserve(std::uint64_t slots);
  void insert_round(Id begin, Id end);
  void insert_in_pieces(Id begin, Id end);
  void cut(const std::vector<Work>& work);
  void own_facets(const std::vector<std::uint32_t>& splitters);
  std::vector<std::pair<Id, Id>> used_slots(Id length) const;
  void find_entries(Id begin, Id end);
  void run_pieces(const std::vector<Work>& work, Id begin, Id end);
  std::vector<Work> join_pieces();
  void take_back_slots();
  SimplicialHull collect();

  const LocalPoints& points_;
  const Control& control_;
  const std::uint64_t budget_;
  const unsigned threads_;
  const Orientation3D predicates_;
  const DirectionKey key_;
  InsertionOrder3D order_;
  BigArray<double> rows_;
  RawArray<Facet3D> facets_;
  Shared3D shared_;
  Id slots_ = 0;  // in use or given to a piece
  std::vector<Piece3D> pieces_;
  std::vector<Entries3D::Entry> entries_;
};

void Engine3D::copy_rows() {
  const Id n = points_.count;
  rows_ = BigArray<double>(std::size_t{n} * Shared3D::row_stride);
  for_each_chunk(n, 1 << 16, threads_, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      const double* from = points_.row(order_.ids[i]);
      double* to = rows_.get() + i * Shared3D::row_stride;
      for (unsigned j = 0; j < 3; ++j) to[j] = from[j];
      to[3] = 0;
    }
  });
}

void Engine3D::reserve(std::uint64_t slots) {
  if (slots >= none)
    throw Error(ErrorCode::out_of_budget, "more facets than the 3D engine can number");
  facets_.reserve(slots);
  shared_.facets = facets_.data();
}

void Engine3D::build_simplex() {
  reserve(4);
  slots_ = 4;
  pieces_.resize(1);
  for (Id i = 0; i < 4; ++i) {
    Facet3D& f = facets_[i];
    unsigned at = 0;
    for (Id k = 0; k < 4; ++k)
      if (k != i) f.vertices[at++] = k;
    Orientation3D::Point p[4];
    for (unsigned k = 0; k < 4; ++k) {
      const Id v = k < 3 ? f.vertices[k] : i;
      p[k] = {shared_.row(v), order_.ids[v]};
    }
    if (predicates_.side(p[0], p[1], p[2], p[3], pieces_[0].rungs) == Sign::positive)
      std::swap(f.vertices[0], f.vertices[1]);
    for (unsigned k = 0; k < 3; ++k) f.neighbours[k] = f.vertices[k];  // facet k lacks vertex k
    f.mark = 0;
    f.owner = 0;
    compute_plane(shared_, f);
  }
}

SimplicialHull Engine3D::run() {
  build_simplex();
  const auto& ends = order_.round_ends;
  for (std::size_t r = 0; r + 1 < ends.size(); ++r) {
    control_.check();
    control_.report("hull", static_cast<double>(ends[r]) / points_.count);
    insert_round(ends[r], ends[r + 1]);
  }
  return collect();
}

/// Below this many points a round is not worth cutting.
constexpr Id smallest_parallel_round = 8192;
/// Records, and the result, which takes about twice as much.
constexpr std::uint64_t bytes_per_facet = 3 * sizeof(Facet3D);

void Engine3D::insert_round(Id begin, Id end) {
  Piece3D& all = pieces_[0];
  // An insertion adds two facets, but for a moment it has used at most two more.
  const std::uint64_t bound = slots_ + 2 * std::uint64_t{end - begin + all.deferred.size()} + 64;
  const std::uint64_t allowed = std::min<std::uint64_t>(budget_ / bytes_per_facet, none - 1);
  if (threads_ > 1 && end - begin >= smallest_parallel_round && bound <= allowed) {
    reserve(bound + 64 * threads_);
    insert_in_pieces(begin, end);
    return;
  }
  const std::uint64_t slots = std::max<std::uint64_t>(slots_, std::min(bound, allowed));
  reserve(slots);
  all.spare.emplace_back(slots_, static_cast<Id>(slots));
  slots_ = static_cast<Id>(slots);
  const std::function<void(double)> progress = [&](double share) {
    control_.report("hull", (begin + share * (end - begin)) / points_.count);
  };
  insert_points(shared_, all, nullptr, begin, end, &progress);
  take_back_slots();
}

/// Slots that were never used, at the end, are nobody's; `spare` keeps the others for later.
void Engine3D::take_back_slots() {
  Piece3D& all = pieces_[0];
  if (all.next_slot < all.end_slot) all.spare.emplace_back(all.next_slot, all.end_slot);
  all.next_slot = all.end_slot = 0;
  std::sort(all.spare.begin(), all.spare.end());
  while (!all.spare.empty() && all.spare.back().second == slots_) {
    slots_ = all.spare.back().first;
    all.spare.pop_back();
  }
}

SimplicialHull Engine3D::collect() {
  const auto runs = used_slots(1 << 15);
  const auto each_run = [&](const auto& body) {
    for_each_chunk(runs.size(), 1, threads_, [&](std::uint64_t c, std::uint64_t, std::uint64_t) {
      body(c, runs[c].first, runs[c].second);
    });
  };
  std::vector<Id> first(runs.size() + 1, 0);
  each_run([&](std::uint64_t c, Id begin, Id end) {
    Id count = 0;
    for (Id f = begin; f < end; ++f) count += static_cast<Id>(facets_[f].live());
    first[c + 1] = count;
  });
  for (std::size_t c = 0; c < runs.size(); ++c) first[c + 1] += first[c];
  each_run([&](std::uint64_t c, Id begin, Id end) {  // the mark becomes the number
    Id count = first[c];
    for (Id f = begin; f < end; ++f) {
      facets_[f].mark = count;
      count += static_cast<Id>(facets_[f].live());
    }
  });
  SimplicialHull hull;
  hull.dimension = 3;
  resize_big(hull.vertices, std::size_t{first.back()} * 3);
  resize_big(hull.neighbours, std::size_t{first.back()} * 3);
  each_run([&](std::uint64_t c, Id begin, Id end) {
    std::size_t at = std::size_t{first[c]} * 3;
    for (Id f = begin; f < end; ++f) {
      const Facet3D& facet = facets_[f];
      if (!facet.live()) continue;
      for (unsigned j = 0; j < 3; ++j, ++at) {
        hull.vertices[at] = order_.ids[facet.vertices[j]];
        hull.neighbours[at] = facets_[facet.neighbours[j]].mark;
      }
    }
  });
  for (const Piece3D& p : pieces_) {
    hull.duplicates.insert(hull.duplicates.end(), p.duplicates.begin(), p.duplicates.end());
    for (unsigned r = 0; r < 3; ++r) hull.rung_counts[r] += p.rungs[r];
  }
  return hull;
}

// ------------------------------------------------------------------------------------- pieces

/// Cuts the surface into pieces of about equally many new points, fills them side by side, and joins
/// neighbouring pieces two by two until the points at the last border are in.
void Engine3D::insert_in_pieces(Id begin, Id end) {
  const Id count = std::min<Id>(threads_, (end - begin) / (smallest_parallel_round / 4));
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
  take_back_slots();
}

void Engine3D::cut(const std::vector<Work>& work) {
  const auto count = static_cast<Id>(work.size());
  std::vector<std::uint32_t> splitters;
  for (Id t = 1; t < count; ++t) {
    constexpr std::uint32_t block = DirectionKey::block;
    double x[block] = {}, y[block] = {}, z[block] = {};
    std::uint32_t keys[block];
    const double* p = shared_.row(work[t].begin);
    x[0] = p[0];
    y[0] = p[1];
    z[0] = p[2];
    key_.keys(x, y, z, order_.key_bits, keys);
    splitters.push_back(keys[0]);
  }
  own_facets(splitters);
  find_entries(work.front().begin, work.back().end);

  pieces_.resize(count);
  const Id first_block = work.front().begin / Entries3D::block;
  for (Id t = 0; t < count; ++t) {
    Piece3D& piece = pieces_[t];
    piece.first_owner = t;
    piece.owner_count = 1;
    piece.epoch = pieces_[0].epoch;
    piece.entries = {entries_.data(), first_block};
    const Id slots = 2 * (work[t].end - work[t].begin) + 64;
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

/// The facets' slots in use, in runs of at most `length`.
std::vector<std::pair<Id, Id>> Engine3D::used_slots(Id length) const {
  std::vector<std::pair<Id, Id>> runs;
  const auto& spare = pieces_[0].spare;  // sorted
  Id at = 0;
  for (std::size_t k = 0; k <= spare.size(); ++k) {
    const Id end = k < spare.size() ? spare[k].first : slots_;
    for (; at < end; at = std::min(end, at + length)) runs.emplace_back(at, std::min(end, at + length));
    if (k < spare.size()) at = spare[k].second;
  }
  return runs;
}

void Engine3D::own_facets(const std::vector<std::uint32_t>& splitters) {
  const auto runs = used_slots(1 << 13);
  for_each_chunk(runs.size(), 1, threads_, [&](std::uint64_t c, std::uint64_t, std::uint64_t) {
    constexpr std::uint32_t block = DirectionKey::block;
    double middle[3][block] = {};
    std::uint32_t keys[block];
    for (Id at = runs[c].first; at < runs[c].second; at += block) {
      const Id size = std::min(block, runs[c].second - at);
      for (Id i = 0; i < size; ++i) {
        const Facet3D& f = facets_[at + i];
        for (unsigned j = 0; j < 3; ++j)
          middle[j][i] = !f.live() ? 0
                                   : (shared_.row(f.vertices[0])[j] + shared_.row(f.vertices[1])[j] +
                                      shared_.row(f.vertices[2])[j]) /
                                         3;
      }
      key_.keys(middle[0], middle[1], middle[2], order_.key_bits, keys);
      for (Id i = 0; i < size; ++i)
        if (facets_[at + i].live())
          facets_[at + i].owner = static_cast<Id>(
              std::upper_bound(splitters.begin(), splitters.end(), keys[i]) - splitters.begin());
    }
  });
}

void Engine3D::find_entries(Id begin, Id end) {
  const Id first_block = begin / Entries3D::block;
  entries_.resize(end / Entries3D::block - first_block + 1);
  Id start = 0;
  while (!facets_[start].live()) ++start;
  constexpr std::uint64_t chunk = 64;
  for_each_chunk(entries_.size(), chunk, threads_,
                 [&](std::uint64_t, std::uint64_t first, std::uint64_t last) {
                   Id f = start;
                   for (std::uint64_t b = first; b < last; ++b) {
                     const auto position = static_cast<Id>((first_block + b) * Entries3D::block);
                     f = climb(shared_, f, shared_.row(std::clamp(position, begin, end - 1)));
                     entries_[b] = {f, facets_[f].owner};
                   }
                 });
}

void Engine3D::run_pieces(const std::vector<Work>& work, Id begin, Id end) {
  const auto caller = std::this_thread::get_id();
  for_each_chunk(pieces_.size(), 1, threads_, [&](std::uint64_t t, std::uint64_t, std::uint64_t) {
    Piece3D& piece = pieces_[t];
    const Work& w = work[t];
    const std::function<void(double)> progress = [&](double share) {
      if (std::this_thread::get_id() == caller)
        control_.report("hull", (begin + share * (end - begin)) / points_.count);
    };
    if (piece.hint == none) {  // no facet of its own
      for (Id p = w.begin; p < w.end; ++p) piece.deferred.push_back(p);
    } else if (w.positions.empty()) {
      insert_points(shared_, piece, nullptr, w.begin, w.end, &progress);
    } else {
      insert_points(shared_, piece, w.positions.data(), 0, static_cast<Id>(w.positions.size()),
                    nullptr);
    }
  });
}

/// Joins pieces 2 k and 2 k + 1, whose common border opens; what they deferred is to be tried again.
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
      for (unsigned r = 0; r < 3; ++r) a.rungs[r] += b.rungs[r];
      a.steps += b.steps;
    }
    work[k].positions.swap(a.deferred);
    if (k > 0) pieces_[k] = std::move(a);
  }
  pieces_.resize(count);
  return work;
}

}  // namespace

SimplicialHull hull_3d(const LocalPoints& points, const std::uint32_t* simplex,
                       std::uint64_t budget, unsigned threads, const Control& control) {
  return Engine3D(points, simplex, budget, control, threads).run();
}

}  // namespace cullhull::internal
