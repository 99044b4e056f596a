// A star-shaped surface of triangles grown from points in space, round by round over the
// data-parallel primitives: every point lies in the cone of one facet around a centre, and each
// facet is replaced by three through the farthest point outside of it (Gao, Cao, Tan and Huang,
// gHull, 2013; here the cones are tested, no Voronoi diagram is needed).
//
// It begins with a closed surface, in whose cones points are found by walking from facet to facet:
// one of leaders where there are enough points, else a simplex.
//
// What is proved (docs/exactness.md, H2, H3 and H7). A facet (a, b, d) is used only where each of
// its vertices is proved to be on the inner side of the plane through the centre c and the other
// two. A point of its cone is assigned to the cone of the new facet (p, a, b) where it is proved to
// be on b's side of the plane c p a and on a's side of c p b; as it was on the inner side of c a b
// before, it is strictly in the new cone. It is dropped if it is also proved to be on c's side of
// the plane p a b: strictly inside of the tetrahedron c p a b. c is strictly inside of the first
// surface, so of the hull, and so is the tetrahedron but for its boundary. What cannot be proved
// leaves the point aside: it survives.
//
// Example: c = (0, 0, 0), the facet (1, 0, 0), (0, 1, 0), (0, 0, 1) and its farthest point p = (1,
// 1, 1). The point (0.75, 0.5, 0.25) has its smallest coordinate in z: it is in the cone of (p, a,
// b), a = (1, 0, 0) and b = (0, 1, 0). Their plane is x + y - z = 1; 0.75 + 0.5 - 0.25 = 1 is on it
// and survives, (0.5, 0.375, 0.125) gives 0.75: dropped.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "filter/pseudo_hull/growth_rounds.hpp"
#include "filter/pseudo_hull/primitives.hpp"
#include "filter/pseudo_hull/pseudo_hull.hpp"
#include "filter/pseudo_hull/pseudo_hull_start.hpp"
#include "filter/star_hull/star_places.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

/// The facets that replace one, for the points in its cone. Plane `between[k]` goes through centre,
/// apex and vertex k of the facet, with vertex k + 1 on its inner side; facet i of the new ones
/// lacks vertex i.
struct alignas(16) StarFan {
  double apex[3];
  PseudoPlane<3> between[3], plane[3];
};

/// Where the round's new facets go: the first takes the place of the facet that it replaces.
struct StarSlots {
  const std::uint32_t* active;  ///< the facets that are replaced
  ItemCount active_count;
  std::uint32_t* facets;  ///< how many facets there are before the round, and after it
  CULLHULL_HD std::uint32_t slot(std::uint32_t j, unsigned i) const {
    return i == 0 ? active[j] : *facets + 2 * j + (i - 1);
  }
};

// Example: the facet (a, b, d) with neighbours A, B, D opposite to its corners and the apex p
// becomes (p, b, d), (a, p, d) and (a, b, p). Each keeps one outer neighbour (A, B, D) and has the
// two others of the three inside: neighbours are known without a search.

/// Item 3 j + i makes the new facet i of the j-th replaced one, in which the apex takes the place
/// of vertex i; item 3 j + i also computes its planes.
template <class Rows>
struct SplitStarFacet {
  Rows rows;
  StarSlots slots;
  double centre[3];
  StarFacet* facet;
  const std::uint32_t* number;  ///< by facet: its place among the replaced ones, or no_item
  const std::uint32_t* apex;
  StarFan* fan;
  StarFacet* made;

  CULLHULL_HD void operator()(std::uint32_t item) const {
    const std::uint32_t j = item / 3;
    const unsigned i = item % 3, a = next_corner(i), b = last_corner(i);
    if (item == 0) slots.facets[1] = slots.facets[0] + 2 * slots.active_count.get();
    const StarFacet& parent = facet[slots.active[j]];
    StarFacet child;
    child.vertex[0] = apex[j];
    child.vertex[1] = parent.vertex[a];
    child.vertex[2] = parent.vertex[b];
    double tip[3], at_a[3], at_b[3], at_i[3];
    rows.load(child.vertex[0], tip);
    rows.load(child.vertex[1], at_a);
    rows.load(child.vertex[2], at_b);
    rows.load(parent.vertex[i], at_i);
    if (i == 0)
      for (unsigned k = 0; k < 3; ++k) fan[j].apex[k] = tip[k];
    // Opposite to the apex the parent's neighbour, or what replaces that.
    const StarSide beyond = parent.across[i];
    const std::uint32_t split = number[beyond.facet()];
    const std::uint32_t self = slots.slot(j, i);
    child.across[0] =
        split == no_item ? beyond : side_of_facet(slots.slot(split, beyond.corner()), 0);
    if (split == no_item) facet[beyond.facet()].across[beyond.corner()] = side_of_facet(self, 0);
    // Opposite to vertex a lies the new facet that lacks a, and so for b.
    child.across[1] = side_of_facet(slots.slot(j, a), 2);
    child.across[2] = side_of_facet(slots.slot(j, b), 1);
    made[item] = child;
    const double* outer[3] = {tip, at_a, at_b};
    make_plane<3>(outer, centre, fan[j].plane[i]);
    const double* through[3] = {centre, tip, at_i};
    make_plane<3>(through, at_a, fan[j].between[i]);
  }
};

// Three planes through the centre and the apex part the old cone into the three new ones: the plane
// through vertex k separates the facets on either side of it. A point must be proved to be on the
// right side of two of them; on one of the planes, or within its bound, it is set aside.

/// Reassigns each point in the cone of a replaced facet to the cone of a new one.
template <class Rows>
struct ReassignToCones {
  Rows rows;
  double centre[3];
  const ExteriorPoint* points;
  const StarFan* fan;
  PlaceArrays arrays;

  CULLHULL_HD Offer operator()(std::uint32_t i) const {
    const ExteriorPoint p = points[i];
    double x[3];
    rows.load(p.row, x);
    const StarFan& f = fan[p.facet];
    int side[3];
    for (unsigned k = 0; k < 3; ++k) {
      const double at = pseudo_distance<3>(f.between[k].normal, centre, x);
      side[k] = at > f.between[k].error ? 1 : at < -f.between[k].error ? -1 : 0;
    }
    Place place = {place_uncertain, 0};
    for (unsigned k = 0; k < 3; ++k) {
      if (side[next_corner(k)] != -1 || side[last_corner(k)] != 1) continue;
      place = star_place(3 * p.facet + k, pseudo_distance<3>(f.plane[k].normal, f.apex, x),
                         f.plane[k].error);
    }
    return arrays.settle(i, p.row, place);
  }
};

/// Puts the new facets into their places, and lists those that have points outside of them.
struct ListActive {
  const std::uint64_t* best;
  const std::uint32_t* rank;
  StarSlots slots;
  const StarFacet* made;  ///< null: items are the facets themselves, which are there
  StarFacet* facet;
  std::uint32_t* active;
  std::uint32_t* apex;
  std::uint32_t* number;
  CULLHULL_HD void operator()(std::uint32_t c) const {
    const std::uint32_t slot = made == nullptr ? c : slots.slot(c / 3, c % 3);
    if (made != nullptr) facet[slot] = made[c];
    if (best[c] == 0) {
      number[slot] = no_item;
      return;
    }
    number[slot] = rank[c];
    active[rank[c]] = slot;
    apex[rank[c]] = no_item;
  }
};

/// `leaders`: not where a closed surface of them cannot be found.
enum class StarBegin : unsigned char { any, leaders };

/// Grows one surface. Reusable: memory is kept.
template <class Executor, class Rows>
class StarGrowth {
 public:
  explicit StarGrowth(Executor executor) : executor_(std::move(executor)) {}

  /// Grows until no point is outside or `max_rounds` are done. Returns false if there is no
  /// surface to begin with. Afterwards culled()[i] is 1 for rows strictly inside; the others are
  /// the surface's vertices, points outside of it after the last round, and those whose place is
  /// not certain.
  bool run(const Rows& rows, std::uint32_t count, unsigned max_rounds, const Control& control,
           std::vector<PseudoHullRound>& rounds, StarBegin begin = StarBegin::any) {
    if (!start(rows, count, begin)) {
      executor_.zero(executor_.reserve(culled_, count), count);
      return false;
    }
    executor_.for_each(
        1, Put<std::uint32_t, 1>{{first_}, executor_.reserve(facets_before_, max_rounds + 2) + 1});
    for (std::uint32_t r = 1; r <= max_rounds && !growth_.done(); ++r) {
      control.check();
      round(r);
      growth_.read(rounds, Executor::rounds_ahead);
    }
    growth_.read(rounds, 0);
    return true;
  }
  /// Keeps the surface, of which `live` facets are left, for the next run() with as many rows: its
  /// vertices may have moved.
  void keep(std::uint32_t live) {
    const std::uint32_t slots = facet_count();
    StarFacet* kept = executor_.reserve(made_, live);
    std::uint32_t* number = executor_.reserve(rank_, std::size_t{slots} + 1);
    executor_.enumerate(slots, FacetIsLive{facet_.data()}, number,
                        CompactFacet{facet_.data(), number, kept});
    executor_.for_each(live, CopyFacet{kept, facet_.data()});
    const bool fresh = nodes_.m == 0;
    if (fresh) nodes_.m = leaders_.m == 0 ? 16 : 2 * leaders_.m;
    std::uint32_t* of = executor_.reserve(facet_of_node_, nodes_.facets());
    executor_.for_each(nodes_.facets(), RenumberNode{nodes_, leaders_, fresh, number, live, of});
    kept_ = live;
    kept_rows_ = count_;
  }
  /// The number of rows that are not culled.
  std::uint32_t left() const { return growth_.left(); }
  /// One byte a row, in the executor's memory.
  unsigned char* culled() { return culled_.data(); }
  /// The surface, in the executor's memory: 2 V - 4 facets for V vertices.
  StarFacet* facets() { return facet_.data(); }
  std::uint32_t facet_count() const { return count_ == 0 ? 0 : first_ + 2 * growth_.replaced(); }
  bool moved() const { return moved_; }                  ///< whether it began with the last surface
  std::uint32_t first_facets() const { return first_; }  ///< of the surface that it began with
  const double* centre() const { return centre_; }
  /// Of the rows, as they were given.
  const AxisExtremes<3>& box() const { return box_; }
  /// The rows, scaled.
  const Rows& rows() const { return rows_; }
  Executor& executor() { return executor_; }

 private:
  using Count = typename Executor::Count;

  bool start(const Rows& rows, std::uint32_t count, StarBegin begin) {
    rows_ = rows;
    count_ = count;
    listed_ = false;
    growth_.begin(count, 3);
    const auto box = extremes_of<3>(executor_, rows_, count);
    executor_.reserve(place_, count);
    executor_.reserve(distance_, count);
    executor_.reserve(culled_, count);
    executor_.reserve(facet_, 2 * std::size_t{count});
    executor_.reserve(number_, 2 * std::size_t{count});
    moved_ = start_from_last(box);
    if (moved_) return true;
    rows_ = rows;
    growth_.begin(count, 3);
    box_ = box.get();
    double scale[3];
    if (!axis_scales(box_, scale)) return false;
    const LeaderFrame frame = framed(scale);
    nodes_.m = leaders_.m = 0;
    if (start_from_leaders(frame)) return true;
    if (begin == StarBegin::leaders && !listed_) return false;
    StartSimplex<3> simplex;
    return choose_simplex(executor_, reader_, rows_, count, box_, simplex) &&
           start_from_simplex(simplex);
  }

  /// Scales the rows, and chooses the middle of the box as the centre.
  LeaderFrame framed(const double* scale) {
    rows_.rescale(executor_, count_, scale);
    LeaderFrame frame;
    for (unsigned k = 0; k < 3; ++k) {
      frame.centre[k] = 0.5 * scale[k] * box_.low[k] + 0.5 * scale[k] * box_.high[k];
      frame.unit[k] = 2 / (scale[k] * box_.high[k] - scale[k] * box_.low[k]);
    }
    std::copy_n(frame.centre, 3, centre_);
    return frame;
  }

  // Leaders cut off what is inside in one pass, whatever the points are. Where most of them are
  // vertices of the hull, the surface grows on from them. Where many are not, as on the faces of a
  // cube, flips would have to remove each: a simplex begins again, with the points that are left.
  //
  // About 1.5 sqrt(n) leaders serve best, more where most points are near the surface. Share of
  // reflex edges: balls and spheres 0.16 to 0.29, with four times as many leaders 0.37; a cube or
  // normal points 0.45 (docs/gpu.md, "The hull in space", counts rounds).

  /// Returns whether the surface begins with leaders. If not, points may have been culled.
  bool start_from_leaders(const LeaderFrame& frame) {
    LeaderGrid3 grid{2};
    while (grid.m < 16 && 8 * std::pow(2.0 * grid.m, 4) <= count_) grid.m *= 2;
    if (grid.m == 2) return false;
    bool refined = false;
    for (;;) {
      executor_.scatter_max(count_, grid.cells(), OfferLeader<Rows>{rows_, grid, frame},
                            executor_.reserve(best_, grid.cells()));
      first_ = grid.facets();
      executor_.for_each(first_, JoinLeaders{grid, best_.data(), facet_.data()});
      const FromNearestNode from{grid, frame};
      constexpr std::uint32_t sample = 1024;  // at least 2^11 rows are there
      const StarCheck found = make_cones(from, sample).get();
      if (!found.good() && !refined) return false;
      if (!found.good()) {
        grid.m /= 2;  // which had no open facet
      } else if (!refined && 2 * found.outside > sample && count_ / (4 * grid.cells()) >= 64) {
        grid.m *= 2;
      } else {
        const bool grows = found.reflex < first_ / 2;  // a third of the edges
        if (grows) leaders_ = grid;
        place(from, grows);
        return grows;
      }
      refined = true;
    }
  }

  // Rows are placed before it is known whether the surface serves: a device need not wait for the
  // host. Centre and scale are those of the last box, the scale half as large: errors are bounded
  // for extents up to 1 (docs/exactness.md, P1), and no axis is often twice as long as a frame ago.
  // A surface that is star-shaped around the centre has it in the box (H7).

  /// Begins with the surface of the last frame, if there is one that is still star-shaped. `box`:
  /// of the rows, when it is found.
  template <class Box>
  bool start_from_last(const Box& box) {
    first_ = kept_;
    kept_ = 0;
    if (first_ == 0 || kept_rows_ != count_) return false;
    double scale[3], now[3];
    axis_scales(box_, scale);
    for (double& s : scale) s *= 0.5;
    const FromNode from{{nodes_, framed(scale)}, facet_of_node_.data()};
    const auto check = make_cones(from, 0);
    executor_.for_each(nodes_.facets(), WalkNode{places(from), facet_of_node_.data()});
    place(from, true);
    box_ = box.get();
    if (!check.get().good() || !axis_scales(box_, now)) return false;
    return scale[0] <= now[0] && scale[1] <= now[1] && scale[2] <= now[2];
  }

  template <class From>
  StarPlaces<From> places(const From& from) const {
    return {from, {centre_[0], centre_[1], centre_[2]}, facet_.data(), cone_.data()};
  }

  /// Makes the cones of the first surface, and begins to check them, with so many of the rows.
  template <class From>
  auto make_cones(const From& from, std::uint32_t sample) {
    StarCone* cones = executor_.reserve(cone_, first_);
    const double* c = centre_;
    executor_.for_each(first_, MakeCone<Rows>{rows_, {c[0], c[1], c[2]}, facet_.data(), cones});
    return executor_.begin_reduce(
        first_ + sample, StarCheck{},
        CheckStart<Rows, From>{rows_, places(from), first_, count_ / std::max(sample, 1U)},
        AddChecks{});
  }

  /// Finds the facet of each row that is not culled. If the surface does not grow, what is inside
  /// is culled, and the rest listed.
  template <class From>
  void place(const From& from, bool grows) {
    const ExteriorPoint* points = listed_ ? points_.data() : nullptr;
    const Count culled =
        executor_.scatter_max(growth_.exterior(), first_,
                              AssignToCones<Rows, From>{rows_, places(from), points, arrays()},
                              executor_.reserve(best_, first_));
    if (grows) {
      regroup(0, first_, culled, points, nullptr, StarSlots{nullptr, {}, nullptr});
    } else {
      const Count left =
          executor_.append(count_, NotCulled{culled_.data()},
                           EmitPoint{executor_.reserve(points_, std::size_t{count_} + 1)});
      growth_.add(0, culled, 0, left);
      listed_ = true;
    }
  }

  bool start_from_simplex(const StartSimplex<3>& simplex) {
    for (unsigned k = 0; k < 3; ++k)
      centre_[k] = 0.25 * (simplex.corner[0][k] + simplex.corner[1][k]) +
                   0.25 * (simplex.corner[2][k] + simplex.corner[3][k]);
    Put<StarFacet, 4> put{{}, facet_.data()};
    StarFacet(&facet)[4] = put.items;
    for (unsigned f = 0; f < 4; ++f) {
      unsigned v[3];
      for (unsigned k = 0, c = 0; c < 4; ++c)
        if (c != f) v[k++] = c;
      if (star_sign(centre_, simplex.corner[v[0]], simplex.corner[v[1]], simplex.corner[v[2]]) < 0)
        std::swap(v[1], v[2]);
      for (unsigned k = 0; k < 3; ++k) facet[f].vertex[k] = v[k];
    }
    // Facet f and facet c = vertex k of f share the side opposite to c in f and to f in c.
    for (unsigned f = 0; f < 4; ++f)
      for (unsigned k = 0; k < 3; ++k) {
        const std::uint32_t c = facet[f].vertex[k];
        unsigned corner = 0;
        while (facet[c].vertex[corner] != f) ++corner;
        facet[f].across[k] = side_of_facet(c, corner);
      }
    for (auto& f : facet)
      for (auto& v : f.vertex) v = simplex.row[v];
    first_ = 4;
    executor_.for_each(4, put);
    if (!make_cones(FromFirstFacet{}, 0).get().good()) return false;
    place(FromFirstFacet{}, true);
    return true;
  }

  PlaceArrays arrays() { return {place_.data(), distance_.data(), culled_.data()}; }

  void round(std::uint32_t r) {
    const Count cells = Executor::times(growth_.facets(), 3);
    const std::uint32_t most_cells = Executor::most(cells);
    const StarSlots slots{active_.data(), Executor::items(growth_.facets()),
                          facets_before_.data() + r};
    StarFan* fan = executor_.reserve(fan_, Executor::most(growth_.facets()));
    StarFacet* made = executor_.reserve(made_, most_cells);
    const double* c = centre_;
    executor_.for_each(cells, SplitStarFacet<Rows>{rows_,
                                                   slots,
                                                   {c[0], c[1], c[2]},
                                                   facet_.data(),
                                                   number_.data(),
                                                   apex_.data(),
                                                   fan,
                                                   made});
    const Count culled = executor_.scatter_max(
        growth_.exterior(), cells,
        ReassignToCones<Rows>{rows_, {c[0], c[1], c[2]}, points_.data(), fan, arrays()},
        executor_.reserve(best_, most_cells));
    regroup(r, cells, culled, points_.data(), made, slots);
  }

  /// Finds the facets that have points outside of them, those points, and each facet's apex.
  /// `from`: null where item i is row i; `made`: null in round 0.
  void regroup(std::uint32_t r, const Count& cells, const Count& culled, const ExteriorPoint* from,
               const StarFacet* made, const StarSlots& slots) {
    const std::uint32_t most_cells = Executor::most(cells),
                        most_points = Executor::most(growth_.exterior());
    std::uint32_t* rank = executor_.reserve(rank_, std::size_t{most_cells} + 1);
    std::uint32_t* next_active = executor_.reserve(next_active_, most_cells);
    std::uint32_t* apex = executor_.reserve(apex_, most_cells);
    const Count active =
        executor_.enumerate(cells, CellHasPoints{best_.data()}, rank,
                            ListActive{best_.data(), rank, slots, made, facet_.data(), next_active,
                                       apex, number_.data()});
    if (growth_.are_many(active)) executor_.send_counts();
    // Room for one more, because an executor may emit an item that is not kept.
    ExteriorPoint* next_points = executor_.reserve(next_points_, std::size_t{most_points} + 1);
    const Count exterior =
        executor_.append(growth_.exterior(), HasFacet{place_.data()},
                         MovePoint<Executor>{most_cells, best_.data(), rank, place_.data(),
                                             distance_.data(), from, next_points, apex});
    std::swap(points_, next_points_);
    std::swap(active_, next_active_);
    executor_.send_counts();
    growth_.add(r, culled, active, exterior);
  }

  template <class T>
  using Array = typename Executor::template Array<T>;

  Executor executor_;
  Rows rows_{};
  double centre_[3] = {};
  AxisExtremes<3> box_;
  std::uint32_t count_ = 0;
  std::uint32_t first_ = 0;                 ///< how many facets the first surface has
  std::uint32_t kept_ = 0, kept_rows_ = 0;  ///< facets of the last surface, and of how many rows
  LeaderGrid3 leaders_{0};                  ///< that the surface began with; 0: none
  LeaderGrid3 nodes_{0};                    ///< of facet_of_node_; 0: none
  bool moved_ = false;
  bool listed_ = false;            ///< the rows that are not culled are points_
  GrowthRounds<Executor> growth_;  ///< of the facets that are replaced
  Array<ExteriorPoint> points_, next_points_;
  Array<std::uint32_t> place_, apex_, rank_, number_, active_, next_active_;
  Array<double> distance_;
  Array<unsigned char> culled_;
  Array<std::uint64_t> best_;
  Array<StarFacet> facet_, made_;
  Array<StarFan> fan_;
  Array<StarCone> cone_;
  Array<std::uint32_t> facet_of_node_;  ///< where walks begin in the next frame
  Array<std::uint32_t> facets_before_;  ///< by round
  RowReader<3, Rows, Executor> reader_;
};

}  // namespace cullhull::internal
