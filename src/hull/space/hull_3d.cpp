#include <algorithm>
#include <cmath>

#include "cullhull/error.hpp"
#include "hull/space/engine_3d.hpp"
#include "parallel/prefetch.hpp"
#include "parallel/random_stream.hpp"

namespace cullhull::internal {
namespace {

using Id = std::uint32_t;

/// A facet's record, and the result, which takes about twice as much.
constexpr std::uint64_t bytes_per_facet = 3 * sizeof(Facet3D);

/// Four affinely independent start points, chosen far apart from a sample of 128, because O, their
/// centroid, should be deep inside. The `given` ones are independent but may all lie near one face.
struct Start {
  Id simplex[4];

  Start(const LocalPoints& points, const Id* given) {
    std::copy_n(given, 4, simplex);
    std::vector<Id> sample(given, given + 4);
    XorShift random;
    for (unsigned k = 0; k < 124 && points.count > 256; ++k)
      sample.push_back(random.below(points.count));
    // In turn: farthest from the first point, from the line, from the plane so far.
    Id best[4] = {given[0], given[0], given[0], given[0]};
    double axis[3][3] = {};
    for (unsigned k = 1; k < 4; ++k) {
      double most = -1;
      for (const Id i : sample) {
        double x[3], square = 0;
        for (unsigned j = 0; j < 3; ++j) x[j] = points.row(i)[j] - points.row(best[0])[j];
        for (unsigned a = 1; a < k; ++a) {
          const double share =
              x[0] * axis[a - 1][0] + x[1] * axis[a - 1][1] + x[2] * axis[a - 1][2];
          for (unsigned j = 0; j < 3; ++j) x[j] -= share * axis[a - 1][j];
        }
        for (const double v : x) square += v * v;
        if (square <= most) continue;
        most = square;
        best[k] = i;
        for (unsigned j = 0; j < 3; ++j) axis[k - 1][j] = x[j];
      }
      if (!(most > 0)) return;
      for (double& v : axis[k - 1]) v /= std::sqrt(most);
    }
    const double* rows[4];
    for (unsigned k = 0; k < 4; ++k) rows[k] = points.exact_row(best[k]);
    if (orientation(3, rows) != Sign::zero) std::copy_n(best, 4, simplex);
  }
};

}  // namespace

Engine3D::Engine3D(const LocalPoints& points, const Id* simplex, const Run& run)
    : points_(points),
      run_(run),
      predicates_(points, simplex),
      key_(points, predicates_.centre(), simplex),
      normal_key_(key_.for_normals()),
      order_(insertion_order_3d(points, key_, simplex, run)) {
  run_.check();
  copy_rows();
  shared_.predicates = &predicates_;
  shared_.control = &run_.control;
  shared_.order = order_.ids.get();
  shared_.rows = rows_.get();
  cut_.key = key_;
  cut_.bits = order_.key_bits;
}

void Engine3D::copy_rows() {
  const Id n = points_.count;
  rows_ = BigArray<double>(std::size_t{n} * Shared3D::row_stride);
  run_.each(n, 1 << 12, [&](std::uint64_t begin, std::uint64_t end) {
    // The order is random in memory. Prefetching saves 2.5 % of the hull of a sphere of 1M points;
    // distances of 8 to 48 differ by less than 2 %.
    constexpr std::uint64_t ahead = 24;
    for (std::uint64_t i = begin; i < end; ++i) {
      if (i + ahead < end) prefetch_line(points_.row(order_.ids[i + ahead]));
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
  }
  compute_planes(shared_, facets_.data(), 4);
}

TriangleMesh Engine3D::run() {
  build_simplex();
  const auto& ends = order_.round_ends;
  for (std::size_t r = 0; r + 1 < ends.size(); ++r) {
    run_.check();
    run_.report("hull", static_cast<double>(ends[r]) / points_.count);
    const std::uint64_t steps = pieces_[0].steps, inserted = pieces_[0].inserted;
    if (by_normals_) sort_by_normals(r);
    insert_round(ends[r], ends[r + 1]);
    // More than 3 steps per point show slivers, along which directions do not order points; 1024
    // points suffice to decide. Walks take fewer steps on a sphere; on a cylinder they take 6 to 7
    // by normals and 80 by directions.
    const Id size = ends[r + 1] - ends[r];
    few_seen_ = pieces_[0].inserted - inserted < size / 8;
    if (size >= 1024 && !few_seen_ && normals_help_ &&
        pieces_[0].steps - steps > 3 * std::uint64_t{size})
      by_normals_ = true;
  }
  return surface();
}

void Engine3D::insert_round(Id begin, Id end) {
  const bool large = run_.threads > 1 && end - begin >= smallest_parallel_round;
  if (large && few_seen_) {
    screen_and_insert(begin, end);
    return;
  }
  // An insertion adds two facets, but temporarily uses up to two more.
  const std::uint64_t bound = slots_ + 2 * std::uint64_t{end - begin} + 64;
  if (large && bound <= std::min<std::uint64_t>(run_.budget / bytes_per_facet, none - 1)) {
    insert_in_pieces(begin, end);
    return;
  }
  give_slots(end - begin);
  const std::function<void(double)> progress = [&](double share) {
    run_.report("hull", (begin + share * (end - begin)) / points_.count);
  };
  insert_points(shared_, pieces_[0], nullptr, begin, end, &progress);
  take_back_slots();
}

/// Gives the only piece as many slots as it can use and the budget allows.
void Engine3D::give_slots(Id points) {
  const std::uint64_t allowed = std::min<std::uint64_t>(run_.budget / bytes_per_facet, none - 1);
  const std::uint64_t bound = slots_ + 2 * std::uint64_t{points} + 64;
  const std::uint64_t slots = std::max<std::uint64_t>(slots_, std::min(bound, allowed));
  reserve(slots);
  // Spare ranges are never empty: where the budget allows no more slots, the next facet must find
  // no range.
  if (slots > slots_) pieces_[0].spare.emplace_back(slots_, static_cast<Id>(slots));
  slots_ = static_cast<Id>(slots);
}

/// Takes back the slots at the end that were never used; `spare` keeps the others for later.
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

std::vector<std::pair<Engine3D::Id, Engine3D::Id>> Engine3D::used_slots(Id length) const {
  std::vector<std::pair<Id, Id>> runs;
  const auto& spare = pieces_[0].spare;  // sorted
  Id at = 0;
  for (std::size_t k = 0; k <= spare.size(); ++k) {
    const Id end = k < spare.size() ? spare[k].first : slots_;
    for (Id next = at; at < end; at = next) {
      next = static_cast<Id>(std::min<std::uint64_t>(end, std::uint64_t{at} + length));
      runs.emplace_back(at, next);
    }
    if (k < spare.size()) at = spare[k].second;
  }
  return runs;
}

bool Engine3D::in_use(Id slot) const {
  const auto& spare = pieces_[0].spare;  // sorted
  auto after = std::upper_bound(spare.begin(), spare.end(), std::pair<Id, Id>{slot, none});
  return after == spare.begin() || slot >= std::prev(after)->second;
}

Engine3D::Id Engine3D::live_facet() const {
  Id f = 0;
  while (!facets_[f].live()) ++f;
  return f;
}

TriangleMesh Engine3D::surface() {
  TriangleMesh s;
  s.used = used_slots(none);
  for (const auto& [begin, end] : s.used) s.live += end - begin;
  s.live -= pieces_[0].free.size();
  s.facets = std::move(facets_);
  s.order = std::move(order_.ids);
  s.rows = std::move(rows_);
  s.count = points_.count;
  s.predicates = predicates_;
  s.duplicates = std::move(pieces_[0].duplicates);
  s.rung_counts = pieces_[0].rungs;
  return s;
}

TriangleMesh triangle_mesh(const LocalPoints& points, const std::uint32_t* simplex,
                           const Run& run) {
  return Engine3D(points, Start(points, simplex).simplex, run).run();
}

Boundary hull_3d(const LocalPoints& points, const std::uint32_t* simplex, const Run& run) {
  return boundary_of(triangle_mesh(points, simplex, run), run);
}

}  // namespace cullhull::internal
