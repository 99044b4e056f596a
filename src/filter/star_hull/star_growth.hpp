// A star-shaped surface of triangles grown from points in space, round by round over the
// data-parallel primitives: every point lies in the cone of one facet around a centre, and each
// facet is replaced by three through the farthest point outside of it (Gao, Cao, Tan and Huang,
// gHull, 2013; here the cones are tested, no Voronoi diagram is needed).
//
// What is proved (docs/exactness.md, H2 and H3). A facet (a, b, d) is used only where each of its
// vertices is proved to be on the inner side of the plane through the centre c and the other two. A
// point of its cone is assigned to the cone of the new facet (p, a, b) where it is proved to be on
// b's side of the plane c p a and on a's side of c p b; as it was on the inner side of c a b
// before, it is strictly in the new cone. It is dropped if it is also proved to be on c's side of
// the plane p a b: strictly inside of the tetrahedron c p a b. c is strictly inside of the first
// simplex, so of the hull, and so is the tetrahedron but for its boundary. What cannot be proved
// leaves the point aside: it survives.
//
// Example: c = (0, 0, 0), the facet (1, 0, 0), (0, 1, 0), (0, 0, 1) and its farthest point p = (1,
// 1, 1). The point (0.75, 0.5, 0.25) has its smallest coordinate in z: it is in the cone of (p, a,
// b), a = (1, 0, 0) and b = (0, 1, 0). Their plane is x + y - z = 1; 0.75 + 0.5 - 0.25 = 1 is on it
// and survives, (0.5, 0.375, 0.125) gives 0.75: dropped.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "filter/pseudo_hull/growth_rounds.hpp"
#include "filter/pseudo_hull/primitives.hpp"
#include "filter/pseudo_hull/pseudo_hull.hpp"
#include "filter/pseudo_hull/pseudo_hull_math.hpp"
#include "filter/pseudo_hull/pseudo_hull_start.hpp"
#include "filter/pseudo_hull/pseudo_hull_steps.hpp"
#include "filter/star_hull/star_math.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

/// The facets that replace one, for the points in its cone. Plane `between[k]` goes through centre,
/// apex and vertex k of the facet, with vertex k + 1 on its inner side; facet i of the new ones
/// lacks vertex i.
struct alignas(16) StarFan {
  double apex[3];
  PseudoPlane<3> between[3], plane[3];
};

/// The simplex: facet f lacks corner f. The plane of a pair of corners goes through them and the
/// centre, with the lowest other corner on its inner side.
struct StarSimplex {
  double centre[3], base[4][3];
  PseudoPlane<3> plane[4];
  PseudoPlane<3> between[6];
};
/// The number of the pair a < b of 4.
CULLHULL_HD constexpr unsigned pair_of_four(unsigned a, unsigned b) {
  return a == 0 ? b - 1 : a + b;  // 01 02 03 12 13 23
}

/// Assigns every row to the facet of the simplex whose cone it is in.
template <class Rows>
struct AssignToCones {
  Rows rows;
  StarSimplex simplex;
  PlaceArrays arrays;

  CULLHULL_HD Offer operator()(std::uint32_t i) const {
    double x[3];
    rows.load(i, x);
    int side[6];
    for (unsigned p = 0; p < 6; ++p) {
      const double at = pseudo_distance<3>(simplex.between[p].normal, simplex.centre, x);
      side[p] = at > simplex.between[p].error ? 1 : at < -simplex.between[p].error ? -1 : 0;
    }
    Place place = {place_uncertain, 0};
    for (unsigned f = 0; f < 4; ++f) {
      bool in_cone = true;
      for (unsigned a = 0; a < 4; ++a)
        for (unsigned b = a + 1; b < 4; ++b) {
          if (a == f || b == f) continue;
          // Of the two corners that are not a and b, f is the one beyond.
          const unsigned other = 6 - a - b - f;
          in_cone = in_cone && side[pair_of_four(a, b)] == (other < f ? -1 : 1);
        }
      if (in_cone)
        place = star_place(f, pseudo_distance<3>(simplex.plane[f].normal, simplex.base[f], x),
                           simplex.plane[f].error);
    }
    return arrays.settle(i, i, place);
  }
  CULLHULL_HD static Place star_place(std::uint32_t facet, double at, double error) {
    if (at > error) return {facet, at};
    return {at < -error ? place_inside : place_uncertain, 0};
  }
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
      place = AssignToCones<Rows>::star_place(
          3 * p.facet + k, pseudo_distance<3>(f.plane[k].normal, f.apex, x), f.plane[k].error);
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

/// Grows one surface. Reusable: memory is kept.
template <class Executor, class Rows>
class StarGrowth {
 public:
  explicit StarGrowth(Executor executor) : executor_(std::move(executor)) {}

  /// Grows until no point is outside or `max_rounds` are done. Returns false if there is no
  /// simplex. Afterwards culled()[i] is 1 for rows strictly inside; the others are the surface's
  /// vertices, points outside of it after the last round, and those whose place is not certain.
  bool run(const Rows& rows, std::uint32_t count, unsigned max_rounds, const Control& control,
           std::vector<PseudoHullRound>& rounds) {
    if (!start(rows, count, rounds)) {
      executor_.zero(executor_.reserve(culled_, count), count);
      return false;
    }
    const std::uint32_t four = 4;
    executor_.upload(&four, 1, executor_.reserve(facets_before_, max_rounds + 2) + 1);
    for (std::uint32_t r = 1; r <= max_rounds && !growth_.done(); ++r) {
      control.check();
      round(r);
      if (growth_.due()) growth_.read(rounds);
    }
    growth_.read(rounds);
    return true;
  }
  /// The number of rows that are not culled.
  std::uint32_t left() const { return growth_.left(); }
  /// One byte a row, in the executor's memory.
  unsigned char* culled() { return culled_.data(); }
  /// The surface, in the executor's memory: 2 V - 4 facets for V vertices.
  StarFacet* facets() { return facet_.data(); }
  std::uint32_t facet_count() const { return count_ == 0 ? 0 : 4 + 2 * growth_.replaced(); }
  const double* centre() const { return centre_; }
  /// The rows, scaled.
  const Rows& rows() const { return rows_; }
  Executor& executor() { return executor_; }

 private:
  using Count = typename Executor::Count;

  bool start(const Rows& rows, std::uint32_t count, std::vector<PseudoHullRound>& rounds) {
    rows_ = rows;
    count_ = count;
    growth_.begin(count);
    constexpr std::uint32_t grain = Executor::grain;
    const AxisExtremes<3> e =
        executor_.reduce(static_cast<std::uint32_t>(chunk_count(count, grain)), AxisExtremes<3>{},
                         ExtremesOfStep<3, Rows>{rows_, count, grain}, TakeExtremes<3>{});
    double scale[3];
    if (!axis_scales(e, scale)) return false;
    rows_.rescale(executor_, count, scale);
    StartSimplex<3> simplex;
    if (!choose_simplex(executor_, reader_, rows_, count, e, simplex)) return false;
    StarSimplex first;
    if (!first_facets(simplex, first)) return false;
    executor_.reserve(place_, count);
    executor_.reserve(distance_, count);
    executor_.reserve(culled_, count);
    const auto culled = executor_.scatter_max(count, 4, AssignToCones<Rows>{rows_, first, arrays()},
                                              executor_.reserve(best_, 4));
    regroup(0, 4, culled, nullptr, StarSlots{nullptr, {}, nullptr});
    growth_.read(rounds);
    return true;
  }

  bool first_facets(const StartSimplex<3>& simplex, StarSimplex& first) {
    for (unsigned k = 0; k < 3; ++k)
      centre_[k] = 0.25 * (simplex.corner[0][k] + simplex.corner[1][k]) +
                   0.25 * (simplex.corner[2][k] + simplex.corner[3][k]);
    std::copy_n(centre_, 3, first.centre);
    StarFacet facet[4];
    for (unsigned f = 0; f < 4; ++f) {
      unsigned v[3];
      for (unsigned k = 0, c = 0; c < 4; ++c)
        if (c != f) v[k++] = c;
      const int sign =
          star_sign(centre_, simplex.corner[v[0]], simplex.corner[v[1]], simplex.corner[v[2]]);
      if (sign == 0) return false;
      if (sign < 0) std::swap(v[1], v[2]);
      for (unsigned k = 0; k < 3; ++k) facet[f].vertex[k] = v[k];
      const double* corner[3] = {simplex.corner[v[0]], simplex.corner[v[1]], simplex.corner[v[2]]};
      std::copy_n(corner[0], 3, first.base[f]);
      if (!make_plane<3>(corner, centre_, first.plane[f])) return false;
      // The centre is on the side of the opposite corner, for all four: it is inside the simplex.
      if (!(pseudo_distance<3>(first.plane[f].normal, first.base[f], simplex.corner[f]) <
            -first.plane[f].error))
        return false;
    }
    for (unsigned a = 0; a < 4; ++a)
      for (unsigned b = a + 1; b < 4; ++b) {
        unsigned inner = 0;
        while (inner == a || inner == b) ++inner;
        const double* corner[3] = {centre_, simplex.corner[a], simplex.corner[b]};
        if (!make_plane<3>(corner, simplex.corner[inner], first.between[pair_of_four(a, b)]))
          return false;
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
    executor_.upload(facet, 4, executor_.reserve(facet_, 2 * std::size_t{count_}));
    executor_.reserve(number_, 2 * std::size_t{count_});
    return true;
  }

  PlaceArrays arrays() { return {place_.data(), distance_.data(), culled_.data()}; }

  void round(std::uint32_t r) {
    const Count cells = Executor::times(growth_.facets(), 3);
    const std::uint32_t most_cells = Executor::most(cells);
    const StarSlots slots{active_.data(), Executor::items(growth_.facets()),
                          facets_before_.data() + r};
    SplitStarFacet<Rows> split{rows_,
                               slots,
                               {},
                               facet_.data(),
                               number_.data(),
                               apex_.data(),
                               executor_.reserve(fan_, Executor::most(growth_.facets())),
                               executor_.reserve(made_, most_cells)};
    std::copy_n(centre_, 3, split.centre);
    executor_.for_each(cells, split);
    ReassignToCones<Rows> assign{rows_, {}, points_.data(), fan_.data(), arrays()};
    std::copy_n(centre_, 3, assign.centre);
    const Count culled = executor_.scatter_max(growth_.exterior(), cells, assign,
                                               executor_.reserve(best_, most_cells));
    regroup(r, cells, culled, points_.data(), slots);
  }

  /// Finds the facets that have points outside of them, those points, and each facet's apex.
  /// `from`: null in round 0, where item i is row i.
  void regroup(std::uint32_t r, const Count& cells, const Count& culled, const ExteriorPoint* from,
               const StarSlots& slots) {
    const std::uint32_t most_cells = Executor::most(cells),
                        most_points = Executor::most(growth_.exterior());
    std::uint32_t* rank = executor_.reserve(rank_, std::size_t{most_cells} + 1);
    std::uint32_t* next_active = executor_.reserve(next_active_, most_cells);
    std::uint32_t* apex = executor_.reserve(apex_, most_cells);
    const Count active = executor_.enumerate(
        cells, CellHasPoints{best_.data()}, rank,
        ListActive{best_.data(), rank, slots, from == nullptr ? nullptr : made_.data(),
                   facet_.data(), next_active, apex, number_.data()});
    // Room for one more, because an executor may emit an item that is not kept.
    ExteriorPoint* next_points = executor_.reserve(next_points_, std::size_t{most_points} + 1);
    const Count exterior =
        executor_.append(growth_.exterior(), HasFacet{place_.data()},
                         MovePoint<Executor>{most_cells, best_.data(), rank, place_.data(),
                                             distance_.data(), from, next_points, apex});
    std::swap(points_, next_points_);
    std::swap(active_, next_active_);
    growth_.add(r, culled, active, exterior);
  }

  template <class T>
  using Array = typename Executor::template Array<T>;

  Executor executor_;
  Rows rows_{};
  double centre_[3] = {};
  std::uint32_t count_ = 0;
  GrowthRounds<Executor> growth_;  ///< of the facets that are replaced
  Array<ExteriorPoint> points_, next_points_;
  Array<std::uint32_t> place_, apex_, rank_, number_, active_, next_active_;
  Array<double> distance_;
  Array<unsigned char> culled_;
  Array<std::uint64_t> best_;
  Array<StarFacet> facet_, made_;
  Array<StarFan> fan_;
  Array<std::uint32_t> facets_before_;  ///< by round
  RowReader<3, Rows, Executor> reader_;
};

}  // namespace cullhull::internal
