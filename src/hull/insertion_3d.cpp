// The 3D engine's inner loops, compiled once per instruction set and chosen at run time.

#include "hull/insertion_3d.hpp"

// More targets than these would not run faster.
#define HWY_DISABLED_TARGETS \
  (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3 | HWY_SSE4)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hull/insertion_3d.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "cullhull/error.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Id = std::uint32_t;
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;

constexpr Id inside = 0xFFFFFFFF;   // the point is in the hull
constexpr Id foreign = 0xFFFFFFFE;  // another piece has to say

/// Planes of the facets (p, a_i, a_(i+1)), i < count, where x, y, z hold a_i - p, count + 1 and
/// padding of them; y0 = p - O. Writes normal and error, and the gauges of `next`.
/// The bounds: docs/exactness.md, "Cached planes", for d = 3; products may be fused, which rounds
/// less.
HWY_INLINE void planes_around(const double* HWY_RESTRICT x, const double* HWY_RESTRICT y,
                              const double* HWY_RESTRICT z, std::uint32_t count, const double* y0,
                              const double* next, double* HWY_RESTRICT planes,
                              double* HWY_RESTRICT gauges) {
  const D d;
  const V zero = hn::Zero(d);
  const V y0x = hn::Set(d, y0[0]), y0y = hn::Set(d, y0[1]), y0z = hn::Set(d, y0[2]);
  const V nx = hn::Set(d, next[0]), ny = hn::Set(d, next[1]), nz = hn::Set(d, next[2]);
  for (std::uint32_t i = 0; i < count; i += static_cast<std::uint32_t>(hn::Lanes(d))) {
    const V ax = hn::LoadU(d, x + i), ay = hn::LoadU(d, y + i), az = hn::LoadU(d, z + i);
    const V bx = hn::LoadU(d, x + i + 1), by = hn::LoadU(d, y + i + 1),
            bz = hn::LoadU(d, z + i + 1);
    const V zy = hn::Mul(az, by), xz = hn::Mul(ax, bz), yx = hn::Mul(ay, bx);
    const V n0 = hn::MulSub(ay, bz, zy), n1 = hn::MulSub(az, bx, xz), n2 = hn::MulSub(ax, by, yx);
    // |second product| twice and |n| bound both products' magnitudes.
    const V sum = hn::Add(hn::Add(hn::Abs(n0), hn::Abs(n1)), hn::Abs(n2));
    const V second = hn::Add(hn::Add(hn::Abs(zy), hn::Abs(xz)), hn::Abs(yx));
    const V level = hn::MulAdd(n0, y0x, hn::MulAdd(n1, y0y, hn::Mul(n2, y0z)));
    const V bound = hn::MulAdd(
        sum, hn::Set(d, 70 * unit_roundoff),
        hn::MulAdd(second, hn::Set(d, 60 * unit_roundoff), hn::Set(d, 0x1p-990)));
    const auto good = hn::And(hn::Gt(level, hn::Set(d, 0x1p-900)),
                              hn::Gt(level, hn::Mul(bound, hn::Set(d, 8.0))));
    const V scale = hn::Div(hn::Set(d, 1.0), hn::IfThenElse(good, level, hn::Set(d, 1.0)));
    const V s0 = hn::IfThenElse(good, hn::Mul(n0, scale), zero);
    const V s1 = hn::IfThenElse(good, hn::Mul(n1, scale), zero);
    const V s2 = hn::IfThenElse(good, hn::Mul(n2, scale), zero);
    const V error = hn::IfThenElse(good, hn::Mul(bound, scale), hn::Inf(d));
    hn::StoreInterleaved4(s0, s1, s2, error, d, planes + 4 * i);
    hn::StoreU(hn::MulAdd(s0, nx, hn::MulAdd(s1, ny, hn::Mul(s2, nz))), d, gauges + i);
  }
}

class Inserter {
 public:
  Inserter(const Shared3D& shared, Piece3D& piece)
      : s_(shared), piece_(piece), facets_(shared.facets), predicates_(*shared.predicates) {
    std::copy_n(predicates_.centre(), 3, centre_);
  }

  void insert_all(const Id* positions, Id begin, Id end,
                  const std::function<void(double)>* progress) {
    for (Id k = begin; k < end; ++k) {
      if ((k - begin) % 256 == 255) {
        s_.control->check();
        if (progress != nullptr && (k - begin) % 65536 == 65535)
          (*progress)(static_cast<double>(k - begin) / (end - begin));
      }
      const Id p = positions != nullptr ? positions[k] : k;
      const Id next = k + 1 == end ? p : positions != nullptr ? positions[k + 1] : k + 1;
      // Chosen points may lie far apart.
      if (positions != nullptr && (k == begin || p / Entries3D::block !=
                                                     positions[k - 1] / Entries3D::block))
        enter(p);
      if (!insert(p, next)) piece_.deferred.push_back(p);
    }
  }

  /// Only reads.
  Id climb_from(Id f, const double* p) {
    offset(p, y_);
    double g = gauge(f, y_);
    for (;;) {
      if (g > 1 + facets_[f].error) return f;
      const Id* n = facets_[f].neighbours;
      Id best = f;
      for (unsigned j = 0; j < 3; ++j) {
        const double h = gauge(n[j], y_);
        if (h > g) {
          g = h;
          best = n[j];
        }
      }
      if (best == f) return f;
      f = best;
    }
  }

 private:
  HWY_INLINE void offset(const double* p, double* y) const {
    for (unsigned j = 0; j < 3; ++j) y[j] = p[j] - centre_[j];
  }
  HWY_INLINE double gauge(Id f, const double* y) const {
    const double* n = facets_[f].normal;
    return n[0] * y[0] + n[1] * y[1] + n[2] * y[2];
  }
  Orientation3D::Point point(Id p) const { return {s_.row(p), s_.order[p]}; }

  Sign side(Id f, Id p) {
    const Id* v = facets_[f].vertices;
    return predicates_.side(point(v[0]), point(v[1]), point(v[2]), point(p), piece_.rungs);
  }

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

  /// A facet p sees, or `inside`, or `foreign`.
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
      if (HWY_UNLIKELY(!piece_.owns(facets_[best]))) {
        piece_.hint = f;
        return foreign;
      }
      f = best;
      g = best_gauge;
    }
  }

  /// At a local maximum of the gauge: a strict one beyond the bounds proves that p is inside.
  Id judge(Id f, double g, Id p) {
    piece_.hint = f;
    const double e = facets_[f].error;
    double highest = -std::numeric_limits<double>::infinity();
    for (const Id n : facets_[f].neighbours)
      highest = std::max(highest, gauge(n, y_) + facets_[n].error);
    if (g > e && g + e < 1 && highest < g - e) {
      ++piece_.rungs[static_cast<unsigned>(Rung::plane)];
      return inside;
    }
    return locate_exactly(f, p);
  }

  /// A visibility walk on the projection of the hull from O. The projection is a regular
  /// subdivision but for its coplanar pieces, so a walk that picks the edge at random ends with
  /// probability 1 (Devillers, Pion, Teillaud 2002).
  Id locate_exactly(Id f, Id p) {
    if (note_duplicate(f, p)) return inside;
    if (side(f, p) == Sign::positive) return f;
    for (Id step = 1;; ++step) {
      if (step % 1024 == 0) s_.control->check();
      piece_.random ^= piece_.random << 13;
      piece_.random ^= piece_.random >> 7;
      piece_.random ^= piece_.random << 17;
      const auto first = static_cast<unsigned>(piece_.random % 3);
      Id next = inside;
      for (unsigned k = 0; k < 3 && next == inside; ++k) {
        const unsigned j = (first + k) % 3;
        if (cone_side(f, j, p) == Sign::negative) next = facets_[f].neighbours[j];
      }
      if (next == inside) break;
      if (!piece_.owns(facets_[next])) return foreign;
      f = next;
      if (gauge(f, y_) > 1 + facets_[f].error) return f;
    }
    piece_.steps += 1;
    piece_.hint = f;
    const Sign s = side(f, p);
    if (s == Sign::positive) return f;
    if (s == Sign::zero) note_duplicate(f, p);
    return inside;
  }

  /// Begins the walk to p where the surface, when it was cut, was nearest; false where that is not
  /// known to be ours now.
  bool enter(Id p) {
    if (piece_.entries.entries == nullptr) return false;
    const Entries3D::Entry& e =
        piece_.entries.entries[p / Entries3D::block - piece_.entries.first_block];
    // The slot of a facet that was another's is not ours to read.
    if (!piece_.owns(e.owner) || !piece_.owns(facets_[e.facet])) return false;
    piece_.hint = e.facet;
    return true;
  }

  /// False if the point concerns facets of other pieces; then nothing has changed.
  bool insert(Id p, Id next) {
    offset(s_.row(p), y_);
    Id seed = locate(p);
    if (HWY_UNLIKELY(seed == foreign)) {
      // The way may be barred though the goal is ours.
      if (!enter(p)) return false;
      seed = locate(p);
      if (seed == foreign) return false;
    }
    if (seed == inside) return true;
    ++piece_.rungs[static_cast<unsigned>(Rung::plane)];
    if (!find_cavity(p, seed)) {
      piece_.hint = seed;
      return false;
    }
    replace_cavity(p, next);
    return true;
  }

  HWY_NOINLINE void grow_ring() {
    const std::size_t n = std::max<std::size_t>(64, 2 * std::size_t{piece_.ring_capacity});
    // A sentinel, and a vector's worth of padding.
    const std::size_t room = n + 16;
    piece_.ring_start.resize(room);
    piece_.ring_outside.resize(room);
    piece_.ring_back.resize(room);
    piece_.created.resize(room);
    piece_.ring_x.resize(room);
    piece_.ring_y.resize(room);
    piece_.ring_z.resize(room);
    piece_.planes.resize(4 * room);
    piece_.gauges.resize(room);
    piece_.ring_capacity = static_cast<std::uint32_t>(n);
  }

  /// Depth first over the visible facets, edges counter-clockwise: the horizon comes out in order.
  bool find_cavity(Id p, Id seed) {
    const Id epoch = ++piece_.epoch;
    const double* x = s_.row(p);
    auto& stack = piece_.stack;
    auto& visible = piece_.visible;
    stack.clear();
    visible.clear();
    ring_ = 0;
    facets_[seed].mark = epoch;
    visible.push_back(seed);
    stack.push_back({seed, 2});
    stack.push_back({seed, 1});
    Id f = seed;
    unsigned edge = 0;
    for (;;) {
      const Facet3D& facet = facets_[f];
      const Id g = facet.neighbours[edge];
      Facet3D& other = facets_[g];
      // The foreign facet's mark is not ours to read.
      if (HWY_UNLIKELY(!piece_.owns(other))) return false;
      const unsigned back = static_cast<unsigned>(other.neighbours[1] == f) +
                            2 * static_cast<unsigned>(other.neighbours[2] == f);
      if (other.mark != epoch) {
        if (sees(g, p)) {
          other.mark = epoch;
          visible.push_back(g);
          stack.push_back({g, back == 0 ? 2 : back - 1});
          f = g;
          edge = back == 2 ? 0 : back + 1;
          continue;
        }
        if (HWY_UNLIKELY(ring_ == piece_.ring_capacity)) grow_ring();
        const Id start = facet.vertices[edge == 2 ? 0 : edge + 1];
        const double* v = s_.row(start);
        piece_.ring_start[ring_] = start;
        piece_.ring_outside[ring_] = g;
        piece_.ring_back[ring_] = back;
        piece_.ring_x[ring_] = v[0] - x[0];
        piece_.ring_y[ring_] = v[1] - x[1];
        piece_.ring_z[ring_] = v[2] - x[2];
        ++ring_;
      }
      if (stack.empty()) return true;
      f = stack.back().facet;
      edge = stack.back().edge;
      stack.pop_back();
    }
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

  /// A new facet on each horizon edge, in the slots of the visible ones.
  void replace_cavity(Id p, Id next) {
    const Id count = ring_;
    auto& visible = piece_.visible;
    Id* HWY_RESTRICT created = piece_.created.data();
    piece_.ring_x[count] = piece_.ring_x[0];
    piece_.ring_y[count] = piece_.ring_y[0];
    piece_.ring_z[count] = piece_.ring_z[0];
    piece_.ring_start[count] = piece_.ring_start[0];
    const auto reused = static_cast<Id>(std::min<std::size_t>(count, visible.size()));
    std::copy_n(visible.data(), reused, created);
    for (Id i = reused; i < count; ++i) created[i] = new_slot();
    for (std::size_t i = reused; i < visible.size(); ++i) {
      facets_[visible[i]].owner = Facet3D::none;
      piece_.free.push_back(visible[i]);
    }
    double next_offset[3];
    offset(s_.row(next), next_offset);
    planes_around(piece_.ring_x.data(), piece_.ring_y.data(), piece_.ring_z.data(), count, y_,
                  next_offset, piece_.planes.data(), piece_.gauges.data());
    Id best = 0;
    double best_gauge = piece_.gauges[0];
    for (Id i = 0; i < count; ++i) {
      Facet3D& f = facets_[created[i]];
      std::memcpy(f.normal, piece_.planes.data() + 4 * i, 32);
      f.vertices[0] = p;
      f.vertices[1] = piece_.ring_start[i];
      f.vertices[2] = piece_.ring_start[i + 1];
      f.neighbours[0] = piece_.ring_outside[i];
      f.neighbours[1] = created[i + 1 == count ? 0 : i + 1];
      f.neighbours[2] = created[i == 0 ? count - 1 : i - 1];
      f.mark = 0;
      f.owner = piece_.first_owner;
      facets_[piece_.ring_outside[i]].neighbours[piece_.ring_back[i]] = created[i];
      best = piece_.gauges[i] > best_gauge ? i : best;
      best_gauge = std::max(best_gauge, piece_.gauges[i]);
    }
    piece_.hint = created[best];
  }

  const Shared3D& s_;
  Piece3D& piece_;
  Facet3D* HWY_RESTRICT facets_;
  const Orientation3D& predicates_;
  double centre_[3];
  double y_[3];  // the point being inserted, relative to O
  Id ring_ = 0;
};

}  // namespace

void insert_points_in(const Shared3D& shared, Piece3D& piece, const std::uint32_t* positions,
                      std::uint32_t begin, std::uint32_t end,
                      const std::function<void(double)>* progress) {
  Inserter(shared, piece).insert_all(positions, begin, end, progress);
}

std::uint32_t climb_in(const Shared3D& shared, std::uint32_t start, const double* p) {
  Piece3D none;
  return Inserter(shared, none).climb_from(start, p);
}

void compute_plane_in(const Shared3D& shared, Facet3D& facet) {
  const double* centre = shared.predicates->centre();
  const double* p = shared.row(facet.vertices[0]);
  const double* a = shared.row(facet.vertices[1]);
  const double* b = shared.row(facet.vertices[2]);
  constexpr std::size_t room = 2 * 8 + 2;
  double ring[3][room] = {}, planes[4 * room], gauges[room];
  double offset[3];
  for (unsigned j = 0; j < 3; ++j) {
    ring[j][0] = a[j] - p[j];
    ring[j][1] = b[j] - p[j];
    offset[j] = p[j] - centre[j];
  }
  planes_around(ring[0], ring[1], ring[2], 1, offset, offset, planes, gauges);
  std::copy_n(planes, 3, facet.normal);
  facet.error = planes[3];
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(insert_points_in);
HWY_EXPORT(climb_in);
HWY_EXPORT(compute_plane_in);

void insert_points(const Shared3D& shared, Piece3D& piece, const std::uint32_t* positions,
                   std::uint32_t begin, std::uint32_t end,
                   const std::function<void(double)>* progress) {
  HWY_DYNAMIC_DISPATCH(insert_points_in)(shared, piece, positions, begin, end, progress);
}

std::uint32_t climb(const Shared3D& shared, std::uint32_t start, const double* p) {
  return HWY_DYNAMIC_DISPATCH(climb_in)(shared, start, p);
}

void compute_plane(const Shared3D& shared, Facet3D& facet) {
  HWY_DYNAMIC_DISPATCH(compute_plane_in)(shared, facet);
}

}  // namespace cullhull::internal
#endif
