// Quickhull on sets of points that fit two words. Every facet has the set of all points above it
// (not a share of them), so the facets that a point sees are found by one bit each, and a new facet
// needs to ask the points of the two facets beside its horizon edge only (Clarkson and Shor 1989):
// its plane is a combination, with positive weights, of theirs.
#include "hull/small_3d.hpp"

// Vectors are kept in arrays below, which sizeless types do not allow: NEON serves those machines.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hull/small_3d.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>

#include "predicates/cofactors.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<double, 8>;
using V = hn::Vec<Tag>;

/// Points or facets by number.
template <unsigned Words>
struct Bits {
  std::uint64_t word[Words] = {};
  void set(unsigned i) { word[i / 64] |= std::uint64_t{1} << i % 64; }
  void clear(unsigned i) { word[i / 64] &= ~(std::uint64_t{1} << i % 64); }
  bool has(unsigned i) const { return (word[i / 64] >> i % 64 & 1) != 0; }
  bool any() const {
    std::uint64_t all = 0;
    for (const std::uint64_t w : word) all |= w;
    return all != 0;
  }
  template <class Use>
  void each(const Use& use) const {
    for (unsigned w = 0; w < Words; ++w)
      for (std::uint64_t rest = word[w]; rest != 0; rest &= rest - 1)
        use(64 * w + static_cast<unsigned>(std::countr_zero(rest)));
  }
};
using PointSet = Bits<SmallHull3D::max_points / 64>;

PointSet united(const PointSet& a, const PointSet& b) {
  PointSet all;
  for (unsigned w = 0; w < SmallHull3D::max_points / 64; ++w) all.word[w] = a.word[w] | b.word[w];
  return all;
}

class Builder {
 public:
  Builder(const SmallPoints3D& points, unsigned count) : points_(points), count_(count) {}

  bool run(SmallHull3D& out) {
    if (!measure() || !start()) return false;
    while (pending_.any()) {
      unsigned f = 0;
      for (unsigned w = 0; w < std::size(pending_.word); ++w)
        if (pending_.word[w] != 0) {
          f = 64 * w + static_cast<unsigned>(std::countr_zero(pending_.word[w]));
          break;
        }
      if (!insert(farthest_[f])) return false;
    }
    collect(out);
    return true;
  }

 private:
  using Number = std::uint8_t;
  static constexpr unsigned capacity = SmallHull3D::max_facets;

  struct Facet {
    Number v[3], next[3];
  };
  /// An edge between a facet that goes and one that stays.
  struct Edge {
    Number from, to, outside, slot;
    PointSet candidates;
  };

  /// Within this range underflow and overflow are far away: all differences are at most the extent
  /// e <= 2^100, so each of the six products of a determinant loses at most 3 * 2^-1074 * 2^200
  /// through underflow, far below `tiny`, which is far below the bound of any facet that counts.
  bool measure() {
    if (count_ < 4) return false;
    for (const double* axis : points_.axes) {
      double low = axis[0], high = axis[0];
      for (unsigned i = 1; i < count_; ++i) {
        low = std::min(low, axis[i]);
        high = std::max(high, axis[i]);
      }
      extent_ = std::max(extent_, high - low);
    }
    return extent_ > 0x1p-100 && extent_ < 0x1p100;
  }

  struct Plane {
    double origin[3], normal[3];
    double bound;  // of the rounding of side()
  };
  double side(const Plane& plane, unsigned i) const {
    double sum = 0;
    for (unsigned c = 0; c < 3; ++c)
      sum += plane.normal[c] * (points_.axes[c][i] - plane.origin[c]);
    return sum;
  }

  /// |side - exact| <= determinant_error(3) max|edge 1| max|edge 2| max|p - origin| + tiny, and a
  /// difference is not larger than the extent, rounded alike.
  Plane plane_of(unsigned a, unsigned b, unsigned c) const {
    Plane plane;
    double e[2][3], reach[2] = {0, 0};
    for (unsigned j = 0; j < 3; ++j) {
      const double* x = points_.axes[j];
      plane.origin[j] = x[a];
      e[0][j] = x[b] - x[a];
      e[1][j] = x[c] - x[a];
      reach[0] = std::max(reach[0], std::fabs(e[0][j]));
      reach[1] = std::max(reach[1], std::fabs(e[1][j]));
    }
    cofactors<3>(e, plane.normal);
    constexpr double tiny = 0x1p-800;
    plane.bound = determinant_error(3) * reach[0] * reach[1] * extent_ + tiny;
    return plane;
  }

  /// Four points far from one another, and their facets.
  bool start() {
    unsigned a = 0, b = 0;
    const double* x = points_.axes[0];
    for (unsigned i = 1; i < count_; ++i) {
      if (x[i] < x[a]) a = i;
      if (x[i] > x[b]) b = i;
    }
    if (a == b) return false;
    unsigned c = a, d = a;
    double most = 0;
    for (unsigned i = 0; i < count_; ++i) {
      const Plane plane = plane_of(a, b, i);
      double square = 0;
      for (const double n : plane.normal) square += n * n;
      if (square > most) most = square, c = i;
    }
    const Plane base = plane_of(a, b, c);
    most = base.bound;
    for (unsigned i = 0; i < count_; ++i) {
      const double height = std::fabs(side(base, i));
      if (height > most) most = height, d = i;
    }
    if (c == a || d == a) return false;
    if (side(base, d) > 0) std::swap(a, b);  // d is below (a, b, c)
    const unsigned v[4] = {a, b, c, d};
    // Facet i is opposite to v[i], counter-clockwise from outside.
    constexpr unsigned order[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};
    PointSet others;
    for (unsigned i = 0; i < count_; ++i) others.set(i);
    for (const unsigned i : v) others.clear(i);
    top_ = 4;
    for (unsigned i = 0; i < 4; ++i) {
      for (unsigned j = 0; j < 3; ++j) {
        facets_[i].v[j] = static_cast<Number>(v[order[i][j]]);
        facets_[i].next[j] = static_cast<Number>(order[i][j]);  // opposite to that vertex
      }
      if (!look(i, others)) return false;
    }
    return true;
  }

  /// Finds which of the candidates are above facet f; false if one cannot be told.
  bool look(unsigned f, const PointSet& candidates) {
    const Facet& facet = facets_[f];
    above_[f] = {};
    pending_.clear(f);
    if (!candidates.any()) return true;
    const Plane plane = plane_of(facet.v[0], facet.v[1], facet.v[2]);
    // All points are asked: whole vectors cost less than the candidates one by one.
    const Tag tag;
    const V bound = hn::Set(tag, plane.bound);
    V normal[3], origin[3];
    for (unsigned c = 0; c < 3; ++c) {
      normal[c] = hn::Set(tag, plane.normal[c]);
      origin[c] = hn::Set(tag, plane.origin[c]);
    }
    PointSet above;
    std::uint64_t doubtful = 0;
    for (unsigned w = 0; w < std::size(above.word); ++w) {
      std::uint64_t higher = 0, lower = 0;
      for (unsigned i = 64 * w; i < std::min(count_, 64 * w + 64);
           i += static_cast<unsigned>(hn::Lanes(tag))) {
        V sum = hn::Zero(tag);
        for (unsigned c = 0; c < 3; ++c)
          sum = hn::Add(sum,
                        hn::Mul(normal[c], hn::Sub(hn::Load(tag, points_.axes[c] + i), origin[c])));
        hn::Store(sum, tag, sides_ + i);
        higher |= bits_of(hn::Gt(sum, bound)) << i % 64;
        lower |= bits_of(hn::Lt(sum, hn::Neg(bound))) << i % 64;
      }
      above.word[w] = candidates.word[w] & higher;
      doubtful |= candidates.word[w] & ~(higher | lower);
    }
    if (doubtful != 0) return false;
    if (!above.any()) return true;
    above_[f] = above;
    pending_.set(f);
    double most = 0;
    unsigned farthest = 0;
    above.each([&](unsigned i) {
      farthest = sides_[i] > most ? i : farthest;
      most = std::max(most, sides_[i]);
    });
    farthest_[f] = static_cast<Number>(farthest);
    return true;
  }

  static HWY_INLINE std::uint64_t bits_of(hn::Mask<Tag> mask) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(Tag(), mask, bits);
    return bits[0];
  }

  /// Replaces the facets that point p sees.
  bool insert(unsigned p) {
    unsigned visible = 0, edges = 0;
    for (unsigned f = 0; f < top_; ++f) {  // no branch: it would often be mispredicted
      visible_[visible] = static_cast<Number>(f);
      visible += unsigned{above_[f].has(p)};
    }
    for (unsigned i = 0; i < visible; ++i) {
      const Facet& facet = facets_[visible_[i]];
      for (unsigned j = 0; j < 3; ++j) {
        const unsigned g = facet.next[j];
        const Number* back = facets_[g].next;
        const unsigned slot =
            unsigned{back[1] == visible_[i]} + 2 * unsigned{back[2] == visible_[i]};
        edges_[edges] = {facet.v[j == 2 ? 0 : j + 1], facet.v[j == 0 ? 2 : j - 1],
                         static_cast<Number>(g), static_cast<Number>(slot),
                         united(above_[visible_[i]], above_[g])};
        edges += unsigned{!above_[g].has(p)};
      }
    }
    for (unsigned i = 0; i < edges; ++i) edges_[i].candidates.clear(p);
    // As many facets as edges, in the old slots first.
    for (unsigned i = edges; i < visible; ++i) {
      above_[visible_[i]] = {};
      pending_.clear(visible_[i]);
      free_[free_count_++] = visible_[i];
    }
    for (unsigned i = 0; i < edges; ++i) {
      unsigned f = 0;
      if (i < visible)
        f = visible_[i];
      else
        f = free_count_ > 0 ? free_[--free_count_] : top_++;
      created_[i] = static_cast<Number>(f);
      starting_at_[edges_[i].from] = created_[i];
      ending_at_[edges_[i].to] = created_[i];
    }
    for (unsigned i = 0; i < edges; ++i) {
      const Edge& edge = edges_[i];
      facets_[created_[i]] = {{static_cast<Number>(p), edge.from, edge.to},
                              {edge.outside, starting_at_[edge.to], ending_at_[edge.from]}};
      facets_[edge.outside].next[edge.slot] = created_[i];
      if (!look(created_[i], edge.candidates)) return false;
    }
    return true;
  }

  void collect(SmallHull3D& out) const {
    bool dead[capacity] = {};
    for (unsigned i = 0; i < free_count_; ++i) dead[free_[i]] = true;
    Number number[capacity];
    out.count = 0;
    for (unsigned f = 0; f < top_; ++f)
      if (!dead[f]) number[f] = static_cast<Number>(out.count++);
    for (unsigned f = 0; f < top_; ++f)
      for (unsigned j = 0; j < 3 && !dead[f]; ++j) {
        out.vertices[number[f]][j] = facets_[f].v[j];
        out.neighbours[number[f]][j] = number[facets_[f].next[j]];
      }
  }

  const SmallPoints3D& points_;
  const unsigned count_;
  double extent_ = 0;
  unsigned top_ = 0, free_count_ = 0;
  Facet facets_[capacity];
  PointSet above_[capacity];
  Number farthest_[capacity], free_[capacity];
  Bits<capacity / 64> pending_;  // facets with points above them
  Number visible_[capacity + 1], created_[capacity];
  Number starting_at_[SmallHull3D::max_points], ending_at_[SmallHull3D::max_points];
  Edge edges_[capacity + 1];
  HWY_ALIGN double sides_[SmallHull3D::max_points];
};

}  // namespace

bool small_hull_in(const SmallPoints3D& points, unsigned count, SmallHull3D& out) {
  return Builder(points, count).run(out);
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(small_hull_in);

bool small_hull_3d(const SmallPoints3D& points, unsigned count, SmallHull3D& out) {
  return HWY_DYNAMIC_DISPATCH(small_hull_in)(points, count, out);
}

}  // namespace cullhull::internal
#endif
