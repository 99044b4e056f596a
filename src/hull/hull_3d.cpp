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
  bool cut(Id begin, Id end, unsigned count);
  void own_facets(const std::vector<Id>& splitters);
  void find_entries(Id begin, Id end);
  void run_pieces(const std::vector<Work>& work, bool report);
  void join_pieces(unsigned width);
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
  Id epoch_ = 0;
  std::vector<Piece3D> pieces_;
  std::vector<Id> entries_;
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
  if (false && threads_ > 1 && end - begin >= smallest_parallel_round && bound <= allowed) {
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
  for (const auto& [begin, end] : pieces_[0].spare)
    for (Id f = begin; f < end; ++f) facets_[f].owner = none;
  constexpr std::uint64_t chunk = 1 << 15;
  const std::uint64_t chunks = chunk_count(slots_, chunk);
  std::vector<Id> first(chunks + 1, 0);
  BigArray<Id> number(slots_);
  const auto end_of = [&](std::uint64_t end) { return static_cast<Id>(end); };
  for_each_chunk(slots_, chunk, threads_,
                 [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                   Id count = 0;
                   for (Id f = end_of(begin); f < end_of(end); ++f) count += facets_[f].live();
                   first[c + 1] = count;
                 });
  for (std::uint64_t c = 0; c < chunks; ++c) first[c + 1] += first[c];
  for_each_chunk(slots_, chunk, threads_,
                 [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                   Id count = first[c];
                   for (Id f = end_of(begin); f < end_of(end); ++f) {
                     number[f] = count;
                     count += facets_[f].live();
                   }
                 });
  SimplicialHull hull;
  hull.dimension = 3;
  resize_big(hull.vertices, std::size_t{first[chunks]} * 3);
  resize_big(hull.neighbours, std::size_t{first[chunks]} * 3);
  for_each_chunk(slots_, chunk, threads_,
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                   for (Id f = end_of(begin); f < end_of(end); ++f) {
                     const Facet3D& facet = facets_[f];
                     if (!facet.live()) continue;
                     const std::size_t base = std::size_t{number[f]} * 3;
                     for (unsigned j = 0; j < 3; ++j) {
                       hull.vertices[base + j] = order_.ids[facet.vertices[j]];
                       hull.neighbours[base + j] = number[facet.neighbours[j]];
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

void Engine3D::insert_in_pieces(Id, Id) {}

}  // namespace

SimplicialHull hull_3d(const LocalPoints& points, const std::uint32_t* simplex,
                       std::uint64_t budget, const Control& control, unsigned threads) {
  return Engine3D(points, simplex, budget, control, threads).run();
}

}  // namespace cullhull::internal
