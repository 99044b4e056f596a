// Incremental insertion: the exact engine for d >= 4. docs/algorithm.md, "The engine".
//
// There are no conflict lists: a facet visible from a point is found by climbing n . p over
// neighbouring facets, with planes scaled to n . (x - O) = 1 (linear programming on the dual
// polytope). Where the error bounds leave the climb's end undecided, an exact visibility walk
// decides.
//
// Several threads insert points together, each along its own part of the insertion order, and hold
// the facets that they read (insertion_nd_rounds.hpp).
//
// The outermost points are inserted first; facet tests against their hull (insertion_nd_start.hpp)
// discard the points strictly inside it before the rest are sorted into the insertion order.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <deque>
#include <limits>
#include <vector>

#include "cullhull/error.hpp"
#include "exact/determinants/minors.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/planes/exact_plane.hpp"
#include "geometry/box_of_rows.hpp"
#include "geometry/norm_order.hpp"
#include "hull/engine.hpp"
#include "hull/general/cavity.hpp"
#include "hull/general/facet_estimate.hpp"
#include "hull/general/facet_planes.hpp"
#include "hull/general/facet_store.hpp"
#include "parallel/index.hpp"
#include "parallel/random_stream.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

template <unsigned D>
class InsertionNd {
 public:
  InsertionNd(const LocalPoints& points, const std::uint32_t* simplex, const Run& run,
              bool same_facets);
  /// Throws Tied if several threads have inserted points, some points are in the hyperplanes of
  /// facets, and `same_facets` is set: the facets would depend on the threads.
  Boundary run();
  struct Tied {};

 private:
  using Id = std::uint32_t;
  static constexpr Id dead = FacetStore<D>::dead;
  /// Prefetch distance, in iterations, of loops over scattered records. Prefetching saves a tenth
  /// of the time of replace().
  static constexpr std::size_t ahead = 8;
  /// Returned in place of a facet where another thread holds one.
  static constexpr Id busy = no_index - 1;
  enum class Inserted : std::uint8_t { done, busy, full };
  static constexpr Id slab = 64;  ///< slots that a thread takes at once
  /// Facets that a thread keeps while it goes on to the next point, which has many of the same. In
  /// 4D taking each anew takes a tenth of the time, but who holds 1,024 is in the way of others.
  static constexpr std::size_t most_held = 256;
  /// Consecutive points that a thread takes at once: some 150 microseconds of work, a point beyond
  /// 6D.
  static constexpr std::size_t grain = D == 4 ? 64 : D == 5 ? 16 : D == 6 ? 2 : 1;
  /// Set in a visible facet's neighbour entry at a horizon ridge; the other bits then number the
  /// new facet at that ridge.
  static constexpr Id horizon_tag = 0x80000000;

  unsigned dim() const {
    if constexpr (D > 0) return D;
    return dimension_;
  }
  const double* row(Id p) const { return ordered_.data() + std::size_t{p} * dim(); }
  const double* exact_row(Id p) const { return points_.exact_row(order_[p]); }
  float error(Id f) const { return store_.plane(f)[dim()]; }
  float gauge(const float* y, Id f) const {
    const float* n = store_.plane(f);
    float sum = n[0] * y[0];
    for (unsigned j = 1; j < dim(); ++j) sum += n[j] * y[j];
    return sum;
  }
  float gauge(const Lane& lane, Id f) const { return gauge(lane.offset.data(), f); }
  /// The index of x in items[0, dim()), which contain it. Branchless, as branches would be
  /// mispredicted; as a sum, because compilers turn selections into branches.
  unsigned index_of(const Id* items, Id x) const {
    unsigned at = 0;
    for (unsigned i = 1; i < dim(); ++i) at += i * static_cast<unsigned>(items[i] == x);
    return at;
  }

  void choose_centre();
  void measure_reach();
  bool centre_inside(const std::vector<double>& centre) const;
  void build_simplex();
  void reserve(std::size_t facets);

  void append_rounds(NormOrder& order, std::size_t most);
  void insert_outermost(NormOrder& order);
  void list_planes(std::vector<float>& planes) const;
  template <class At>
  void test_block(const std::vector<float>& planes, const At& at, std::uint32_t count,
                  std::uint8_t* inside) const;
  bool sieve_pays(const NormOrder& order, const std::vector<float>& planes,
                  std::size_t worth) const;
  void sieve(NormOrder& order, const std::vector<float>& planes) const;

  void insert_round();
  unsigned useful_lanes(std::size_t points) const;
  std::vector<Id> insert_together(const std::vector<Id>& points, unsigned lanes);
  void end_of_pass();
  template <bool shared>
  Inserted insert(Lane& lane, Id point);
  template <bool shared>
  bool start(Lane& lane);
  bool hold(Lane& lane, Id f);
  bool hold_all(Lane& lane, const Id* facets);
  void let_go(Lane& lane);
  template <bool shared>
  bool find_slots(Lane& lane);
  void clear_slots(Id begin, Id end, Lane& lane);
  std::atomic_ref<Id> hint_near(Id point) {
    return std::atomic_ref(hints_[std::uint64_t{point - first_} * hints_.size() / count_]);
  }

  void aim(Lane& lane, Id point) const;
  template <bool shared>
  Id locate(Lane& lane, Id point);
  template <bool shared>
  Id locate_exactly(Lane& lane, Id point);
  template <class Entry>
  Sign lattice_sign(Lane& lane, const Entry& entry) const;
  Sign side(Lane& lane, Id f, Id point) const;
  std::uint32_t seen_among(Lane& lane, const float* y, const Id* facets, unsigned first,
                           Id point) const;
  std::uint32_t seen_exactly(Lane& lane, const Id* facets, std::uint32_t which, Id point) const;
  Sign cone_side(Lane& lane, Id f, unsigned j, Id point) const;
  bool note_duplicate(Lane& lane, Id f, Id point) const;
  template <bool shared>
  bool find_cavity(Lane& lane, Id seed, Id point);

  void replace(Lane& lane, Id point);
  Id turn(const Lane& lane, std::size_t k, unsigned i) const;
  bool proved_convex(Id f) const requires(D == 0);
  void number_canonically(RawArray<Id>& number);
  Boundary collect();

  const LocalPoints& points_;
  const Run& run_;
  unsigned dimension_;
  std::vector<double> centre_, reach_;
  double radius_ = 0;  ///< for D = 0
  /// Whether O is exactly centre_; otherwise O is the exact centroid of the simplex.
  bool centre_exact_ = false;
  PlaneFrame frame_;
  FacetStore<D> store_;
  /// Points in insertion order: an id in this class is a position in `order_`. The simplex is
  /// first.
  std::vector<Id> order_;
  std::vector<Id> starts_;  ///< of the rounds in `order_` so far; then the last one's end
  std::size_t rounds_done_ = 0;
  RawArray<double> ordered_;
  std::size_t expected_ = 0;  ///< number of points to insert, as far as known
  /// Slots up to the last pass, and those that have memory; facets.
  std::size_t facet_slots_ = 0, facet_capacity_ = 0, live_ = 0;
  std::size_t most_facets_ = 0;            ///< that fit the budget
  std::atomic<std::size_t> next_slot_{0};  ///< the first one that no lane has taken
  std::deque<Lane> lanes_;
  bool same_facets_;          ///< for every number of threads
  Id first_ = 0, count_ = 0;  ///< points of the round
  /// For equal parts of the round the facet near the last point that was inserted, in this round or
  /// in the one before: rounds run along the same curve.
  std::vector<Id> hints_;
  unsigned most_lanes_;
  std::size_t inserted_ = 0, made_ = 0;  ///< points, facets
  Boundary result_;
};

// -------------------------------------------------------------------------------- construction

template <unsigned D>
InsertionNd<D>::InsertionNd(const LocalPoints& points, const std::uint32_t* simplex, const Run& run,
                            bool same_facets)
    : points_(points),
      run_(run),
      dimension_(points.dimension),
      centre_(dimension_),
      reach_(dimension_),
      store_(dimension_),
      same_facets_(same_facets),
      hints_(256, 0),
      most_lanes_(run.threads) {
  // The result takes about as much memory as the records.
  const std::uint64_t per_facet = store_.bytes_per_facet();
  most_facets_ = std::min<std::uint64_t>(run.budget / (2 * per_facet), horizon_tag - 1);
  lanes_.emplace_back(dimension_, 1);
  order_.assign(simplex, simplex + dim() + 1);
  starts_ = {dim() + 1};
  ordered_.reserve(std::size_t{points.count} * dim());
  for (Id i = 0; i <= dim(); ++i)
    std::copy_n(points.row(order_[i]), dim(), ordered_.data() + i * dim());
  choose_centre();
  measure_reach();
  frame_ = {dim(),
            ordered_.data(),
            centre_.data(),
            reach_.data(),
            radius_,
            points_.exact == points_.coordinates,
            points_.coordinate_error};
}

/// Chooses O: the simplex's centroid, rounded to the fewest bits that keep it strictly inside, so
/// that exact arithmetic on lattices stays short. Where even the centroid rounded to doubles is not
/// inside, or the coordinates are scaled copies of the exact ones, O is the exact centroid.
template <unsigned D>
void InsertionNd<D>::choose_centre() {
  const unsigned d = dim();
  std::vector<double> centroid(d, 0.0);
  for (unsigned j = 0; j < d; ++j) {
    for (unsigned i = 0; i <= d; ++i) centroid[j] += row(i)[j];
    centroid[j] /= d + 1;
  }
  centre_ = centroid;
  if (points_.exact == points_.coordinates) {
    for (const double grid : {0x1p6, 0x1p12, 0x1p24}) {
      for (unsigned j = 0; j < d; ++j) centre_[j] = std::round(centroid[j] * grid) / grid;
      centre_exact_ = centre_inside(centre_);
      if (centre_exact_) break;
    }
    if (!centre_exact_) {
      centre_ = centroid;
      centre_exact_ = centre_inside(centre_);
    }
  }
}

template <unsigned D>
void InsertionNd<D>::measure_reach() {
  const BoxOfRows box = box_of_rows(
      points_.count, dim(), [&](std::uint64_t k) { return points_.row(static_cast<Id>(k)); }, run_);
  for (unsigned j = 0; j < dim(); ++j)
    reach_[j] =
        std::max(box.high[j] - centre_[j], centre_[j] - box.low[j]) * (1 + 0x1p-30) + 0x1p-40;
  if constexpr (D > 0) return;
  for (Id k = 0; k < points_.count; ++k) {
    if (k % 65536 == 0) run_.check();
    const double* p = points_.row(k);
    double square = 0;
    for (unsigned j = 0; j < dim(); ++j) square += (p[j] - centre_[j]) * (p[j] - centre_[j]);
    radius_ = std::max(radius_, square);
  }
  radius_ = std::sqrt(radius_) * (1 + 0x1p-30) + 0x1p-40;
}

template <unsigned D>
bool InsertionNd<D>::centre_inside(const std::vector<double>& centre) const {
  const unsigned d = dim();
  std::vector<const double*> p(d + 1);
  for (unsigned i = 0; i <= d; ++i) p[i] = row(i);
  const Sign whole = orientation(d, p.data());
  for (unsigned i = 0; i <= d; ++i) {
    p[i] = centre.data();
    if constexpr (D == 0) run_.check();  // in 50D an exact sign can take a tenth of a second
    if (orientation(d, p.data()) != whole) return false;
    p[i] = row(i);
  }
  return true;
}

template <unsigned D>
Boundary InsertionNd<D>::run() {
  build_simplex();
  {
    NormOrder order(points_, order_, run_);
    insert_outermost(order);
    append_rounds(order, order.left());
    expected_ = order_.size();
  }
  while (rounds_done_ + 1 < starts_.size()) insert_round();
  if (same_facets_ && lanes_.size() > 1)
    for (const Lane& lane : lanes_)
      if (lane.tied) throw Tied{};
  return collect();
}

template <unsigned D>
void InsertionNd<D>::build_simplex() {
  const unsigned d = dim();
  const Id slots = (d / slab + 1) * slab;
  reserve(std::max<std::size_t>(1024, slots));
  clear_slots(0, slots, lanes_[0]);
  lanes_[0].unused.resize(slots - (d + 1));
  next_slot_ = slots;
  for (Id i = 0; i <= d; ++i) {
    Id* v = store_.vertices(i);
    Id* n = store_.neighbours(i);
    for (Id k = 0, at = 0; k <= d; ++k) {
      if (k == i) continue;
      v[at] = k;
      n[at] = k;
      ++at;
    }
    if (side(lanes_[0], i, i) == Sign::positive) {
      std::swap(v[0], v[1]);
      std::swap(n[0], n[1]);
    }
    [[maybe_unused]] const std::uint8_t first = 0;
    std::vector<float> plane(d + 1);
    if constexpr (D == 0)
      facet_planes_any(frame_, v, 1, plane.data(), store_.wide(i), true);
    else
      facet_planes(frame_, v[0], v, &first, 1, plane.data());
    std::copy(plane.begin(), plane.end(), store_.plane(i));
  }
  live_ = d + 1;
  facet_slots_ = slots;
}

template <unsigned D>
void InsertionNd<D>::reserve(std::size_t facets) {
  if (facets <= facet_capacity_) return;
  const std::size_t capacity = std::max(facets, facet_capacity_ + facet_capacity_ / 2);
  if (capacity > most_facets_) {
    throw Error(ErrorCode::out_of_budget, "the hull has more than ", live_, " facets in dimension ",
                dim(), ", which exceeds the memory budget of ", run_.budget >> 20,
                " MiB; raise the budget or use fewer dimensions");
  }
  store_.reserve(capacity);
  facet_capacity_ = capacity;
}

// ------------------------------------------------------------------------------------ location

template <unsigned D>
void InsertionNd<D>::aim(Lane& lane, Id point) const {
  const double* p = row(point);
  for (unsigned j = 0; j < dim(); ++j) lane.offset[j] = static_cast<float>(p[j] - centre_[j]);
}

/// Sign of a determinant of points on a small lattice: every operation in doubles is exact.
template <unsigned D>
template <class Entry>
Sign InsertionNd<D>::lattice_sign(Lane& lane, const Entry& entry) const {
  double m[D][D];
  for (unsigned i = 0; i < D; ++i)
    for (unsigned j = 0; j < D; ++j) m[i][j] = entry(i, j);
  expand_minors<D, false>(m, D, lane.minors.data(), static_cast<double*>(nullptr));
  lane.rung_counts.count(Rung::filter);
  return sign_of(lane.minors[(1U << D) - 1]);
}

/// The exact side of the point relative to facet f: positive if the point sees f.
template <unsigned D>
Sign InsertionNd<D>::side(Lane& lane, Id f, Id point) const {
  const unsigned d = dim();
  const Id* v = store_.vertices(f);
  const double** p = lane.rows.data();
  if constexpr (D > 0 && D < elimination_pays) {
    if (points_.small_lattice) {
      const Sign s = lattice_sign(lane, [&](unsigned i, unsigned j) {
        return row(i + 1 < D ? v[i + 1] : point)[j] - row(v[0])[j];
      });
      lane.tied |= s == Sign::zero;
      return s;
    }
  }
  for (unsigned i = 0; i < d; ++i) p[i] = exact_row(v[i]);
  p[d] = exact_row(point);
  if constexpr (D == 0) run_.check();  // beyond 8D a sign can take milliseconds
  Rung rung = Rung::exact;
  const Sign s = orientation(d, p, &rung);
  lane.rung_counts.count(rung);
  lane.tied |= s == Sign::zero;
  return s;
}

/// Bit mask of the facets that the point sees: of all dim() facets, or, for D = 0, of at most 32
/// from `first` on. About every second is visible, unpredictably: comparisons are signs of
/// differences, so that they compile to no branch.
template <unsigned D>
[[gnu::always_inline]] inline std::uint32_t InsertionNd<D>::seen_among(Lane& lane, const float* y,
                                                                       const Id* facets,
                                                                       unsigned first,
                                                                       Id point) const {
  const auto negative = [](float x) { return std::bit_cast<std::uint32_t>(x) >> 31; };
  const unsigned count = D > 0 ? D : std::min(dim() - first, 32U);
  std::uint32_t above = 0, beneath = 0;
  for (unsigned j = 0; j < count; ++j) {
    const float g = gauge(y, facets[first + j]), e = error(facets[first + j]);
    above |= negative((1 + e) - g) << j;
    beneath |= negative(g - (1 - e)) << j;
  }
  const std::uint32_t doubtful = ~std::uint32_t{0} >> (32 - count) & ~(above | beneath);
  if (doubtful == 0) [[likely]]
    return above;
  return above | seen_exactly(lane, facets + first, doubtful, point);
}

template <unsigned D>
std::uint32_t InsertionNd<D>::seen_exactly(Lane& lane, const Id* facets, std::uint32_t which,
                                           Id point) const {
  std::uint32_t seen = 0;
  for (; which != 0; which &= which - 1) {
    const auto j = static_cast<unsigned>(std::countr_zero(which));
    seen |= static_cast<std::uint32_t>(side(lane, facets[j], point) == Sign::positive) << j;
  }
  return seen;
}

/// Whether the point lies on the facet's side (positive), on (zero) or beyond (negative) the
/// hyperplane through O and the ridge opposite to vertex j.
template <unsigned D>
Sign InsertionNd<D>::cone_side(Lane& lane, Id f, unsigned j, Id point) const {
  const unsigned d = dim();
  const Id other = store_.neighbours(f)[j];
  const double g = gauge(lane, f), h = gauge(lane, other);
  const double e = 2 * (error(f) * (1 + std::abs(g)) + error(other) * (1 + std::abs(h)));
  if (g - h > e) return Sign::positive;
  if (h - g > e) return Sign::negative;
  if constexpr (D == 0) run_.check();
  const Id* v = store_.vertices(f);
  // An outward facet has orientation (-1)^(d+1) seen from O.
  const auto outward = [d](Sign s) { return d % 2 == 1 ? s : -s; };
  const double** p = lane.rows.data();
  if (centre_exact_) {
    p[0] = centre_.data();
    for (unsigned i = 0; i < d; ++i) p[i + 1] = exact_row(i == j ? point : v[i]);
    Rung rung = Rung::exact;
    const Sign s = orientation(d, p, &rung);
    lane.rung_counts.count(rung);
    return outward(s);
  }
  for (unsigned i = 0; i < d; ++i) p[i] = exact_row(i == j ? point : v[i]);
  for (unsigned i = 0; i <= d; ++i) lane.simplex_rows[i] = exact_row(i);
  lane.rung_counts.count(Rung::exact);
  return outward(orientation_from_centroid_exact(d, p, lane.simplex_rows.data()));
}

template <unsigned D>
bool InsertionNd<D>::note_duplicate(Lane& lane, Id f, Id point) const {
  const double* p = exact_row(point);
  for (unsigned i = 0; i < dim(); ++i) {
    const Id v = store_.vertices(f)[i];
    const double* q = exact_row(v);
    if (std::equal(p, p + dim(), q)) {
      lane.tied = true;
      if (order_[point] < order_[v]) lane.duplicates.emplace_back(order_[point], order_[v]);
      return true;
    }
  }
  return false;
}

/// Finds a facet visible from the point, beginning at lane.hint, which becomes the facet where the
/// search ends; no_index where the point sees none.
template <unsigned D>
template <bool shared>
typename InsertionNd<D>::Id InsertionNd<D>::locate(Lane& lane, Id point) {
  Id f = lane.hint;
  float g = gauge(lane, f);
  for (;;) {
    if (g > 1 + error(f)) {
      lane.rung_counts.count(Rung::plane);
      return lane.hint = f;
    }
    const Id* n = store_.neighbours(f);
    for (unsigned j = 0; j < dim(); ++j) store_.template prefetch<shared>(n[j]);
    if (shared && !hold_all(lane, n)) return busy;
    Id best = f;
    float best_gauge = g, highest = -std::numeric_limits<float>::infinity();
    for (unsigned j = 0; j < dim(); ++j) {
      const float h = gauge(lane, n[j]);
      highest = std::max(highest, h + error(n[j]));
      best = h > best_gauge ? n[j] : best;
      best_gauge = std::max(best_gauge, h);
    }
    if (best == f) {
      lane.hint = f;
      const float e = error(f);
      // A maximum that is strict by more than the error bounds: the ray from O to the point leaves
      // through f, and the point is beneath f. 2^-20 covers the rounding of the sums here, less
      // than 2^-22.
      if (g > e && g + e < 1 - 0x1p-20F && highest < g - e - 0x1p-20F) {
        lane.rung_counts.count(Rung::plane);
        return no_index;
      }
      return locate_exactly<shared>(lane, point);
    }
    f = best;
    g = best_gauge;
  }
}

/// Continues from lane.hint, whose neighbours are held.
template <unsigned D>
template <bool shared>
typename InsertionNd<D>::Id InsertionNd<D>::locate_exactly(Lane& lane, Id point) {
  const unsigned d = dim();
  Id f = lane.hint;
  if (note_duplicate(lane, f, point)) return no_index;
  if (side(lane, f, point) == Sign::positive) return f;
  // A visibility walk on the projection of the hull from O. The projection is a regular subdivision
  // except for its coplanar pieces, so a walk that chooses the ridge at random ends with
  // probability 1 (Devillers, Pion, Teillaud 2002).
  XorShift random(XorShift::golden ^ (std::uint64_t{point} << 20));
  for (std::uint32_t step = 1;; ++step) {
    if (step % 256 == 0) run_.check();
    const auto first = static_cast<unsigned>(random.next() % d);
    Id next = no_index;
    for (unsigned k = 0; k < d && next == no_index; ++k) {
      const unsigned j = (first + k) % d;
      if (cone_side(lane, f, j, point) == Sign::negative) next = store_.neighbours(f)[j];
    }
    if (next == no_index) break;
    lane.hint = f = next;
    if (gauge(lane, f) > 1 + error(f)) return f;
    if (shared && !hold_all(lane, store_.neighbours(f))) return busy;
  }
  const Sign s = side(lane, f, point);
  if (s == Sign::positive) return f;
  if (s == Sign::zero) note_duplicate(lane, f, point);
  return no_index;
}

}  // namespace cullhull::internal

#include "hull/general/insertion_nd_cavity.hpp"
#include "hull/general/insertion_nd_rounds.hpp"
#include "hull/general/insertion_nd_start.hpp"
