// The 3D engine's inner loops, compiled once per instruction set and chosen at run time.

#include "hull/space/insertion_3d.hpp"

#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hull/space/insertion_3d.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "cullhull/error.hpp"
#include "hull/space/engine_3d.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Id = std::uint32_t;
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;

constexpr Id inside = 0xFFFFFFFF;   // the point is in the hull
constexpr Id foreign = 0xFFFFFFFE;  // another piece's facet is involved

/// The plane of a facet with the corner y0 + O and edges a, b from there: its normal, and returns
/// the error. The bounds: docs/exactness.md, "Cached planes", for d = 3; products may be fused,
/// which rounds less.
HWY_INLINE V plane_of(V ax, V ay, V az, V bx, V by, V bz, V y0x, V y0y, V y0z, V& s0, V& s1,
                      V& s2) {
  const D d;
  const V zero = hn::Zero(d);
  const V zy = hn::Mul(az, by), xz = hn::Mul(ax, bz), yx = hn::Mul(ay, bx);
  const V n0 = hn::MulSub(ay, bz, zy), n1 = hn::MulSub(az, bx, xz), n2 = hn::MulSub(ax, by, yx);
  // |n| + 2 |second product| bounds the magnitudes of both products.
  const V sum = hn::Add(hn::Add(hn::Abs(n0), hn::Abs(n1)), hn::Abs(n2));
  const V second = hn::Add(hn::Add(hn::Abs(zy), hn::Abs(xz)), hn::Abs(yx));
  const V level = hn::MulAdd(n0, y0x, hn::MulAdd(n1, y0y, hn::Mul(n2, y0z)));
  const V bound =
      hn::MulAdd(sum, hn::Set(d, 70 * unit_roundoff),
                 hn::MulAdd(second, hn::Set(d, 60 * unit_roundoff), hn::Set(d, 0x1p-990)));
  const auto good =
      hn::And(hn::Gt(level, hn::Set(d, 0x1p-900)), hn::Gt(level, hn::Mul(bound, hn::Set(d, 8.0))));
  const V scale = hn::Div(hn::Set(d, 1.0), hn::IfThenElse(good, level, hn::Set(d, 1.0)));
  s0 = hn::IfThenElse(good, hn::Mul(n0, scale), zero);
  s1 = hn::IfThenElse(good, hn::Mul(n1, scale), zero);
  s2 = hn::IfThenElse(good, hn::Mul(n2, scale), zero);
  return hn::IfThenElse(good, hn::Mul(bound, scale), hn::Inf(d));
}

/// Planes of the facets (p, a_i, a_(i+1)), i < count. x, y, z hold a_i - p for count + 1 points and
/// padding; y0 = p - O. Writes normal and error, and the gauges of `next`.
HWY_INLINE void planes_around(const double* HWY_RESTRICT x, const double* HWY_RESTRICT y,
                              const double* HWY_RESTRICT z, std::uint32_t count, const double* y0,
                              const double* next, double* HWY_RESTRICT planes,
                              double* HWY_RESTRICT gauges) {
  const D d;
  const V y0x = hn::Set(d, y0[0]), y0y = hn::Set(d, y0[1]), y0z = hn::Set(d, y0[2]);
  const V nx = hn::Set(d, next[0]), ny = hn::Set(d, next[1]), nz = hn::Set(d, next[2]);
  for (std::uint32_t i = 0; i < count; i += static_cast<std::uint32_t>(hn::Lanes(d))) {
    V s0, s1, s2;
    const V error = plane_of(hn::LoadU(d, x + i), hn::LoadU(d, y + i), hn::LoadU(d, z + i),
                             hn::LoadU(d, x + i + 1), hn::LoadU(d, y + i + 1),
                             hn::LoadU(d, z + i + 1), y0x, y0y, y0z, s0, s1, s2);
    hn::StoreInterleaved4(s0, s1, s2, error, d, planes + 4 * i);
    hn::StoreU(hn::MulAdd(s0, nx, hn::MulAdd(s1, ny, hn::Mul(s2, nz))), d, gauges + i);
  }
}

HWY_INLINE double gauge_of(const Facet3D& f, const double* y) {
  return f.normal[0] * y[0] + f.normal[1] * y[1] + f.normal[2] * y[2];
}

class Inserter {
 public:
  Inserter(const Shared3D& shared, Piece3D& piece)
      : s_(shared), piece_(piece), facets_(shared.facets), predicates_(*shared.predicates) {
    std::copy_n(predicates_.centre(), 3, centre_);
    use_scratch();
  }

  void insert_all(const Waiting3D* waiting, Id begin, Id end,
                  const std::function<void(double)>* progress) {
    for (Id k = begin; k < end; ++k) {
      if ((k - begin) % 256 == 255) {
        s_.control->check();
        if (progress != nullptr && (k - begin) % 65536 == 65535)
          (*progress)(static_cast<double>(k - begin) / (end - begin));
      }
      const Id p = waiting != nullptr ? waiting[k].point : k;
      const Id next = k + 1 == end ? p : waiting != nullptr ? waiting[k + 1].point : k + 1;
      offset(s_.row(p), y_);
      // Waiting points may be far apart: the walk begins at the better of two facets.
      if (waiting != nullptr && usable(waiting[k].facet) &&
          gauge(waiting[k].facet, y_) > gauge(piece_.hint, y_))
        piece_.hint = waiting[k].facet;
      if (!insert(p, next, waiting != nullptr ? waiting + k : nullptr))
        piece_.deferred.push_back({p, piece_.hint});
    }
  }

  void screen_all(const Id* positions, Id begin, Id end) {
    for (Id k = begin; k < end; ++k) {
      if ((k - begin) % 256 == 255) s_.control->check();
      const Id p = positions != nullptr ? positions[k] : k;
      offset(s_.row(p), y_);
      const Id seen = locate(p);
      if (seen == inside) continue;
      piece_.deferred.push_back({p, seen});
      piece_.hint = seen;
    }
  }

 private:
  HWY_INLINE void offset(const double* p, double* y) const {
    for (unsigned j = 0; j < 3; ++j) y[j] = p[j] - centre_[j];
  }
  HWY_INLINE double gauge(Id f, const double* y) const { return gauge_of(facets_[f], y); }
  Orientation3D::Point point(Id p) const { return {s_.row(p), s_.order[p]}; }

  Sign side(Id f, Id p) {
    const Id* v = facets_[f].vertices;
    return predicates_.side(point(v[0]), point(v[1]), point(v[2]), point(p), piece_.rungs);
  }

  HWY_INLINE bool owns(Facet3D& f) const {
    const Id owner = f.owner_now();
    return HWY_LIKELY(piece_.owns(owner)) || (owner < piece_.old_owners && claims(f));
  }
  /// Notes the owner in facets of this piece, which are visited again and again. Other pieces need
  /// not see it: they come to the same result.
  HWY_NOINLINE bool claims(Facet3D& f) const {
    if (piece_.old_owners + piece_.cut->piece_of(s_, f) != piece_.first_owner) return false;
    f.own(piece_.first_owner);
    return true;
  }
  /// Whether f is a facet of this piece. Called for facets that were so when the surface was cut.
  bool usable(Id f) const { return f != Facet3D::none && owns(facets_[f]); }

  HWY_INLINE bool sees(Id f, Id p) {
    const double g = gauge(f, y_), e = facets_[f].error;
    if (HWY_LIKELY(g > 1 + e)) return true;
    if (HWY_LIKELY(g < 1 - e)) return false;
    return side(f, p) == Sign::positive;
  }

  /// Whether p is equal to a vertex of f.
  bool note_duplicate(Id f, Id p) {
    for (const Id v : facets_[f].vertices) {
      if (!predicates_.equal(point(p), point(v))) continue;
      const Id id = s_.order[p], vertex = s_.order[v];
      if (id < vertex) piece_.duplicates.emplace_back(id, vertex);
      return true;
    }
    return false;
  }

  /// Whether p lies on the facet's side (positive), on (zero) or beyond (negative) the plane
  /// through O and the edge opposite to vertex j.
  Sign cone_side(Id f, unsigned j, Id p) {
    const Facet3D& a = facets_[f];
    const Facet3D& b = facets_[a.neighbours[j]];
    const double g = gauge(f, y_), h = gauge(a.neighbours[j], y_);
    const double e = 2 * (a.error * (1 + std::abs(g)) + b.error * (1 + std::abs(h)));
    if (g - h > e) return Sign::positive;
    if (h - g > e) return Sign::negative;
    return predicates_.cone_side(point(a.vertices[(j + 1) % 3]), point(a.vertices[(j + 2) % 3]),
                                 point(p), piece_.rungs);
  }

  /// Climbs from the hint to a facet visible from p. Returns that facet, or `inside` if there is
  /// none, or `foreign` if the way leads into another piece.
  Id locate(Id p) {
    Id f = piece_.hint;
    double g = gauge(f, y_);
    for (;;) {
      const Facet3D& facet = facets_[f];
      if (g > 1 + facet.error) return f;
      ++piece_.steps;
      Id best = f;
      double best_gauge = g;
      for (const Id n : facet.neighbours) {
        const double h = gauge(n, y_);
        best = h > best_gauge ? n : best;
        best_gauge = std::max(h, best_gauge);
      }
      if (best == f) return judge(f, g, p);
      if (HWY_UNLIKELY(!owns(facets_[best]))) {
        piece_.hint = f;
        return foreign;
      }
      f = best;
      g = best_gauge;
    }
  }

  /// Decides at a local maximum of the gauge: where it is strict beyond the bounds, p is inside.
  Id judge(Id f, double g, Id p) {
    piece_.hint = f;
    const double e = facets_[f].error;
    double highest = -std::numeric_limits<double>::infinity();
    for (const Id n : facets_[f].neighbours)
      highest = std::max(highest, gauge(n, y_) + facets_[n].error);
    if (g > e && g + e < 1 && highest < g - e) {
      piece_.rungs.count(Rung::plane);
      return inside;
    }
    return locate_exactly(f, p);
  }

  /// A visibility walk on the projection of the hull from O. The projection is a regular
  /// subdivision except for its coplanar pieces, so a walk that chooses the edge at random ends
  /// with probability 1 (Devillers, Pion, Teillaud 2002).
  Id locate_exactly(Id f, Id p) {
    if (note_duplicate(f, p)) return inside;
    for (Id step = 1;; ++step) {
      if (step % 1024 == 0) s_.control->check();
      ++piece_.steps;
      const auto first = static_cast<unsigned>(piece_.random.next() % 3);
      Id next = inside;
      for (unsigned k = 0; k < 3 && next == inside; ++k) {
        const unsigned j = (first + k) % 3;
        if (cone_side(f, j, p) == Sign::negative) next = facets_[f].neighbours[j];
      }
      if (next == inside) break;
      if (!owns(facets_[next])) return foreign;
      f = next;
      if (gauge(f, y_) > 1 + facets_[f].error) return f;
    }
    piece_.hint = f;
    const Sign s = side(f, p);
    if (s == Sign::positive) return f;
    if (s == Sign::zero) note_duplicate(f, p);
    return inside;
  }

  /// The facet where the walk to p can begin; `none` where that facet is not certainly this
  /// piece's, as the slot of another piece's facet must not be read.
  Id entry_of(Id p) const {
    if (piece_.entries.entries == nullptr) return Facet3D::none;
    const Entries3D::Entry& e =
        piece_.entries.entries[p / Entries3D::block - piece_.entries.first_block];
    return piece_.owns(e.owner) ? e.facet : Facet3D::none;
  }

  /// Inserts p, which is y_ + O. Returns false, having changed nothing, if p involves facets of
  /// other pieces. `next`: the point after p, whose walk starts at the new facet that is best for
  /// it.
  bool insert(Id p, Id next, const Waiting3D* waiting) {
    Id seed = locate(p);
    if (HWY_UNLIKELY(seed == foreign)) {
      // The walk met another piece, but its goal may belong to this one: retry from p's entry.
      const Id entry = waiting != nullptr ? waiting->facet : entry_of(p);
      if (!usable(entry)) return false;
      piece_.hint = entry;
      seed = locate(p);
      if (seed == foreign) return false;
    }
    if (seed == inside) return true;
    piece_.rungs.count(Rung::plane);
    if (!find_cavity(p, seed)) {
      piece_.hint = seed;
      return false;
    }
    ++piece_.inserted;
    replace_cavity(p, next);
    return true;
  }

  HWY_NOINLINE void grow_ring() {
    piece_.ring_capacity = std::max<Id>(64, 2 * piece_.ring_capacity);
    // Room for a sentinel and for the padding of one vector.
    const std::size_t room = piece_.ring_capacity + std::size_t{16};
    for (auto* ids : {&piece_.ring_start, &piece_.ring_outside, &piece_.ring_back, &piece_.created})
      ids->resize(room);
    for (auto* values : {&piece_.ring_x, &piece_.ring_y, &piece_.ring_z, &piece_.gauges})
      values->resize(room);
    piece_.planes.resize(4 * room);
    use_scratch();
  }
  HWY_NOINLINE void grow_visible() {
    piece_.visible_capacity = std::max<Id>(64, 2 * piece_.visible_capacity);
    piece_.visible.resize(piece_.visible_capacity);
    // The stack holds one edge for each visible facet, and one more of the first.
    piece_.stack.resize(piece_.visible_capacity + std::size_t{1});
    use_scratch();
  }
  void use_scratch() {
    start_ = piece_.ring_start.data();
    outside_ = piece_.ring_outside.data();
    back_ = piece_.ring_back.data();
    created_ = piece_.created.data();
    x_ = piece_.ring_x.data();
    y_ring_ = piece_.ring_y.data();
    z_ = piece_.ring_z.data();
    visible_ = piece_.visible.data();
    stack_ = piece_.stack.data();
  }

  /// Visits the visible facets depth first, edges counter-clockwise, so that horizon edges come in
  /// cyclic order. False if it meets another piece's facet.
  bool find_cavity(Id p, Id seed) {
    const Id epoch = ++piece_.epoch, first_owner = piece_.first_owner, owners = piece_.owner_count;
    const double* point = s_.row(p);
    const double px = point[0], py = point[1], pz = point[2];
    Id ring = 0, visible = 1, waiting = 2;
    if (HWY_UNLIKELY(piece_.visible_capacity == 0)) grow_visible();
    facets_[seed].mark = epoch;
    hwy::Prefetch(&facets_[facets_[seed].neighbours[1]]);
    hwy::Prefetch(&facets_[facets_[seed].neighbours[2]]);
    visible_[0] = seed;
    stack_[0] = {seed, 2};
    stack_[1] = {seed, 1};
    Id f = seed;
    unsigned edge = 0;
    for (;;) {
      const Id g = facets_[f].neighbours[edge];
      Facet3D& other = facets_[g];
      // The mark of another piece's facet must not be read.
      if (HWY_UNLIKELY(other.owner_now() - first_owner >= owners && !owns(other))) return false;
      if (other.mark != epoch) {
        const unsigned back = static_cast<unsigned>(other.neighbours[1] == f) +
                              2 * static_cast<unsigned>(other.neighbours[2] == f);
        if (sees(g, p)) {
          other.mark = epoch;
          if (HWY_UNLIKELY(visible == piece_.visible_capacity)) grow_visible();
          visible_[visible++] = g;
          const unsigned later = back == 0 ? 2 : back - 1;
          stack_[waiting++] = {g, later};
          hwy::Prefetch(&facets_[other.neighbours[later]]);
          f = g;
          edge = back == 2 ? 0 : back + 1;
          continue;
        }
        if (HWY_UNLIKELY(ring == piece_.ring_capacity)) grow_ring();
        const Id start = facets_[f].vertices[edge == 2 ? 0 : edge + 1];
        const double* v = s_.row(start);
        start_[ring] = start;
        outside_[ring] = g;
        back_[ring] = back;
        x_[ring] = v[0] - px;
        y_ring_[ring] = v[1] - py;
        z_[ring] = v[2] - pz;
        ++ring;
      }
      if (waiting == 0) break;
      --waiting;
      f = stack_[waiting].facet;
      edge = stack_[waiting].edge;
    }
    ring_ = ring;
    visible_count_ = visible;
    return true;
  }

  Id new_slot() {
    if (!piece_.free.empty()) {
      const Id f = piece_.free.back();
      piece_.free.pop_back();
      return f;
    }
    if (piece_.next_slot == piece_.end_slot) {
      if (piece_.spare.empty())
        throw Error(ErrorCode::out_of_budget,
                    "the hull's facets exceed the memory budget; raise it or use fewer points");
      piece_.next_slot = piece_.spare.back().first;
      piece_.end_slot = piece_.spare.back().second;
      piece_.spare.pop_back();
    }
    return piece_.next_slot++;
  }

  /// Makes a new facet on each horizon edge, first in the slots of the visible ones.
  void replace_cavity(Id p, Id next) {
    const Id count = ring_;
    x_[count] = x_[0];
    y_ring_[count] = y_ring_[0];
    z_[count] = z_[0];
    start_[count] = start_[0];
    const Id reused = std::min(count, visible_count_);
    std::copy_n(visible_, reused, created_);
    for (Id i = reused; i < count; ++i) created_[i] = new_slot();
    for (Id i = reused; i < visible_count_; ++i) {
      facets_[visible_[i]].owner = Facet3D::none;
      piece_.free.push_back(visible_[i]);
    }
    double next_offset[3];
    offset(s_.row(next), next_offset);
    const double* planes = piece_.planes.data();
    const double* gauges = piece_.gauges.data();
    planes_around(x_, y_ring_, z_, count, y_, next_offset, piece_.planes.data(),
                  piece_.gauges.data());
    const Id owner = piece_.first_owner;
    Id best = created_[0], previous = created_[count - 1];
    double best_gauge = gauges[0];
    created_[count] = best;
    for (Id i = 0; i < count; ++i) {
      const Id created = created_[i];
      Facet3D& f = facets_[created];
      std::memcpy(f.normal, planes + 4 * i, 32);
      f.vertices[0] = p;
      f.vertices[1] = start_[i];
      f.vertices[2] = start_[i + 1];
      f.neighbours[0] = outside_[i];
      f.neighbours[1] = created_[i + 1];
      f.neighbours[2] = previous;
      f.mark = 0;
      f.owner = owner;
      facets_[outside_[i]].neighbours[back_[i]] = created;
      best = gauges[i] > best_gauge ? created : best;
      best_gauge = std::max(best_gauge, gauges[i]);
      previous = created;
    }
    piece_.hint = best;
  }

  const Shared3D& s_;
  Piece3D& piece_;
  Facet3D* HWY_RESTRICT facets_;
  const Orientation3D& predicates_;
  double centre_[3];
  double y_[3];  // the point being inserted, relative to O
  Id ring_ = 0, visible_count_ = 0;
  // Pointers into the piece's scratch.
  Id *start_ = nullptr, *outside_ = nullptr, *back_ = nullptr, *created_ = nullptr;
  double *x_ = nullptr, *y_ring_ = nullptr, *z_ = nullptr;
  Id* visible_ = nullptr;
  Piece3D::Crossing* stack_ = nullptr;
};

}  // namespace

void insert_points_in(const Shared3D& shared, Piece3D& piece, const Waiting3D* waiting,
                      std::uint32_t begin, std::uint32_t end,
                      const std::function<void(double)>* progress) {
  Inserter(shared, piece).insert_all(waiting, begin, end, progress);
}

void screen_points_in(const Shared3D& shared, Piece3D& piece, const std::uint32_t* positions,
                      std::uint32_t begin, std::uint32_t end) {
  Inserter(shared, piece).screen_all(positions, begin, end);
}

std::uint32_t climb_in(const Shared3D& shared, std::uint32_t start, std::uint32_t other,
                       const double* p) {
  const double* centre = shared.predicates->centre();
  const double y[3] = {p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]};
  const Facet3D* facets = shared.facets;
  Id f = start;
  double g = gauge_of(facets[f], y);
  if (const double h = gauge_of(facets[other], y); h > g) {
    f = other;
    g = h;
  }
  while (g <= 1 + facets[f].error) {
    Id best = f;
    for (const Id n : facets[f].neighbours) {
      const double h = gauge_of(facets[n], y);
      best = h > g ? n : best;
      g = std::max(g, h);
    }
    if (best == f) break;
    f = best;
  }
  return f;
}

void compute_planes_in(const Shared3D& shared, Facet3D* facets, std::uint32_t count) {
  constexpr std::uint32_t lanes = 8;
  const D d;
  const auto width = static_cast<std::uint32_t>(hn::Lanes(d));
  const double* centre = shared.predicates->centre();
  double x[9][lanes] = {}, planes[4 * lanes];  // edges, corners
  for (std::uint32_t at = 0; at < count; at += width) {
    const std::uint32_t some = std::min(width, count - at);
    for (std::uint32_t i = 0; i < some; ++i) {
      const Facet3D& f = facets[at + i];
      const double *const p = shared.row(f.vertices[0]), *const a = shared.row(f.vertices[1]),
                          *const b = shared.row(f.vertices[2]);
      for (unsigned j = 0; j < 3; ++j) {
        x[j][i] = a[j] - p[j];
        x[3 + j][i] = b[j] - p[j];
        x[6 + j][i] = p[j] - centre[j];
      }
    }
    V s0, s1, s2;
    const V error =
        plane_of(hn::LoadU(d, x[0]), hn::LoadU(d, x[1]), hn::LoadU(d, x[2]), hn::LoadU(d, x[3]),
                 hn::LoadU(d, x[4]), hn::LoadU(d, x[5]), hn::LoadU(d, x[6]), hn::LoadU(d, x[7]),
                 hn::LoadU(d, x[8]), s0, s1, s2);
    hn::StoreInterleaved4(s0, s1, s2, error, d, planes);
    for (std::uint32_t i = 0; i < some; ++i) std::memcpy(facets[at + i].normal, planes + 4 * i, 32);
  }
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(insert_points_in);
HWY_EXPORT(screen_points_in);
HWY_EXPORT(climb_in);
HWY_EXPORT(compute_planes_in);

void insert_points(const Shared3D& shared, Piece3D& piece, const Waiting3D* waiting,
                   std::uint32_t begin, std::uint32_t end,
                   const std::function<void(double)>* progress) {
  HWY_DYNAMIC_DISPATCH(insert_points_in)(shared, piece, waiting, begin, end, progress);
}

void screen_points(const Shared3D& shared, Piece3D& piece, const std::uint32_t* positions,
                   std::uint32_t begin, std::uint32_t end) {
  HWY_DYNAMIC_DISPATCH(screen_points_in)(shared, piece, positions, begin, end);
}

std::uint32_t climb(const Shared3D& shared, std::uint32_t start, std::uint32_t other,
                    const double* p) {
  return HWY_DYNAMIC_DISPATCH(climb_in)(shared, start, other, p);
}

void compute_planes(const Shared3D& shared, Facet3D* facets, std::uint32_t count) {
  HWY_DYNAMIC_DISPATCH(compute_planes_in)(shared, facets, count);
}

}  // namespace cullhull::internal
#endif
