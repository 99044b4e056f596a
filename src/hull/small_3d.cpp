// Insertion of points one by one: each is held against all facets at once, in f32 with a bound, and
// what that leaves open is decided in doubles, then exactly. Sets are so small that nothing has to
// be searched: the facets' planes lie in vectors, and an edge's facet is found in a table.
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

#include "predicates/cofactors.hpp"
#include "predicates/orientation.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Wide = hn::CappedTag<double, 8>;
using Tag = hn::CappedTag<float, 16>;
using V = hn::Vec<Tag>;

/// The first lanes of a mask, as bits.
template <class D>
HWY_INLINE std::uint64_t bits_of(D tag, hn::Mask<D> mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(tag, mask, bits);
  return bits[0] | std::uint64_t{bits[1]} << 8;
}

class Builder {
 public:
  Builder(const SmallPoints3D& points, unsigned count)
      : points_(points), count_(count), padded_((count + 15) / 16 * 16) {}

  bool run(SmallHull3D& out) {
    if (count_ < 4 || !measure(out) || !start()) return false;
    Number order[most_points];
    const unsigned left = outer_first(order);
    for (unsigned i = 0; i < left; ++i)
      if (!insert(order[i])) return false;
    collect(out);
    return true;
  }

 private:
  using Number = std::uint8_t;
  static constexpr unsigned most_points = SmallHull3D::max_points;
  static constexpr unsigned capacity = SmallHull3D::max_facets;

  // ------------------------------------------------------------------------------------ the points

  /// Where the points lie and how far they reach; f32 copies in units that make |x - O| < 1. Within
  /// this range underflow and overflow are far away: all differences are at most the extent
  /// e <= 2^100, so each of the six products of a determinant loses at most 3 * 2^-1074 * 2^200
  /// through underflow, far below `tiny`, which is far below the bound of any facet that counts.
  bool measure(SmallHull3D& out) {
    const Wide tag;
    const auto lanes = static_cast<unsigned>(hn::Lanes(tag));
    auto wrong = hn::Zero(tag);
    for (unsigned c = 0; c < 3; ++c) {
      const double* const axis = points_.axes[c];
      auto low = hn::Load(tag, axis), high = low;
      for (unsigned i = 0; i < padded_; i += lanes) {
        const auto x = hn::Load(tag, axis + i);
        wrong = hn::Or(wrong, hn::Sub(x, x));  // 0 or not a number
        low = hn::Min(low, x);
        high = hn::Max(high, x);
      }
      const double least = hn::GetLane(hn::MinOfLanes(tag, low)),
                   most = hn::GetLane(hn::MaxOfLanes(tag, high));
      out.low[c] = least;
      out.high[c] = most;
      middle_[c] = least + (most - least) / 2;  // between them, rounded or not
      if (most - least > extent_) {
        extent_ = most - least;
        longest_ = c;
      }
    }
    if (!hn::AllTrue(tag, hn::Eq(wrong, hn::Zero(tag))) || !(extent_ > 0x1p-100) ||
        !(extent_ < 0x1p100))
      return false;
    scale_ = std::ldexp(1.0, -(std::ilogb(extent_) + 1));
    const hn::Rebind<float, Wide> narrow;
    for (unsigned c = 0; c < 3; ++c) {
      const auto middle = hn::Set(tag, middle_[c]), scale = hn::Set(tag, scale_);
      for (unsigned i = 0; i < padded_; i += lanes)
        hn::Store(hn::DemoteTo(narrow,
                               hn::Mul(hn::Sub(hn::Load(tag, points_.axes[c] + i), middle), scale)),
                  narrow, near_[c] + i);
    }
    return true;
  }

  /// A point for which `value` is largest.
  template <class Value>
  HWY_INLINE unsigned farthest(const Value& value, float* most) {
    const Tag tag;
    const auto lanes = static_cast<unsigned>(hn::Lanes(tag));
    V best = hn::Set(tag, -1.0F);
    for (unsigned i = 0; i < padded_; i += lanes) {
      const V v = value(hn::Load(tag, near_[0] + i), hn::Load(tag, near_[1] + i),
                        hn::Load(tag, near_[2] + i));
      hn::Store(v, tag, values_ + i);
      best = hn::Max(best, v);
    }
    best = hn::MaxOfLanes(tag, best);
    *most = hn::GetLane(best);
    for (unsigned i = 0; i < padded_; i += lanes) {
      const std::uint64_t bits = bits_of(tag, hn::Eq(hn::Load(tag, values_ + i), best));
      if (bits != 0) return i + static_cast<unsigned>(std::countr_zero(bits));
    }
    return 0;
  }

  /// Four points far from one another, and their facets. What is chosen decides about speed alone.
  HWY_INLINE bool start() {
    const Tag tag;
    float most = 0;
    const unsigned along = longest_;
    const auto pick = [along](V x, V y, V z) HWY_ATTR {
      return along == 0 ? x : along == 1 ? y : z;
    };
    const V two = hn::Set(tag, 2.0F);  // values are to be positive
    unsigned a =
        farthest([&](V x, V y, V z) HWY_ATTR { return hn::Sub(two, pick(x, y, z)); }, &most);
    unsigned b =
        farthest([&](V x, V y, V z) HWY_ATTR { return hn::Add(two, pick(x, y, z)); }, &most);
    float e[3], n[3];
    V at[3], edge[3];
    for (unsigned i = 0; i < 3; ++i) {
      e[i] = near_[i][b] - near_[i][a];
      at[i] = hn::Set(tag, near_[i][a]);
      edge[i] = hn::Set(tag, e[i]);
    }
    const unsigned c = farthest(
        [&](V x, V y, V z) HWY_ATTR {
          const V d[3] = {hn::Sub(x, at[0]), hn::Sub(y, at[1]), hn::Sub(z, at[2])};
          V square = hn::Zero(tag);
          for (unsigned i = 0; i < 3; ++i) {
            const unsigned j = (i + 1) % 3, k = (i + 2) % 3;
            const V m = hn::Sub(hn::Mul(edge[j], d[k]), hn::Mul(edge[k], d[j]));
            square = hn::Add(square, hn::Mul(m, m));
          }
          return square;
        },
        &most);
    for (unsigned i = 0; i < 3; ++i) {
      const unsigned j = (i + 1) % 3, k = (i + 2) % 3;
      n[i] = e[j] * (near_[k][c] - near_[k][a]) - e[k] * (near_[j][c] - near_[j][a]);
    }
    const V normal[3] = {hn::Set(tag, n[0]), hn::Set(tag, n[1]), hn::Set(tag, n[2])};
    const unsigned d = farthest(
        [&](V x, V y, V z) HWY_ATTR {
          return hn::Abs(hn::Add(
              hn::Add(hn::Mul(normal[0], hn::Sub(x, at[0])), hn::Mul(normal[1], hn::Sub(y, at[1]))),
              hn::Mul(normal[2], hn::Sub(z, at[2]))));
        },
        &most);
    const Sign sign = side(a, b, c, d);
    if (sign == Sign::zero) return false;
    if (sign == Sign::positive) std::swap(a, b);  // d is below (a, b, c)
    begin_[0] = a, begin_[1] = b, begin_[2] = c, begin_[3] = d;
    clear_planes();
    // Counter-clockwise from outside.
    constexpr unsigned order[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};
    top_ = 4;
    for (unsigned f = 0; f < 4; ++f) {
      const unsigned p = begin_[order[f][0]], from = begin_[order[f][1]], to = begin_[order[f][2]];
      look_from(p, from);
      look_from(p, to);
      create(f, p, from, to);
    }
    return true;
  }

  /// The other points, roughly by their distance from the middle: few that are inside get to be
  /// vertices for a time.
  HWY_INLINE unsigned outer_first(Number* order) {
    float most = 0;
    farthest([&](V x, V y, V z)
                 HWY_ATTR { return hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)); },
             &most);
    constexpr unsigned classes = 32;
    const float factor = (classes - 0.5F) / most;
    Number start[classes + 1] = {}, key[most_points];
    for (const unsigned i : begin_) values_[i] = -1;
    unsigned left = 0;
    for (unsigned i = 0; i < count_; ++i) {
      key[i] = values_[i] < 0
                   ? classes
                   : static_cast<Number>(classes - 1 - static_cast<unsigned>(values_[i] * factor));
      ++start[key[i]];
    }
    for (unsigned k = 0; k <= classes; ++k) {
      const unsigned n = start[k];
      start[k] = static_cast<Number>(left);
      left += n;
    }
    for (unsigned i = 0; i < count_; ++i) order[start[key[i]]++] = static_cast<Number>(i);
    return count_ - 4;
  }

  // ------------------------------------------------------------------------------------ the signs

  /// On which side of (a, b, c) point p is: in doubles,
  /// |side - exact| <= determinant_error(3) max|edge 1| max|edge 2| max|p - origin| + tiny, and a
  /// difference is not larger than the extent, rounded alike. Then exactly.
  HWY_NOINLINE Sign side(unsigned a, unsigned b, unsigned c, unsigned p) const {
    double e[2][3], normal[3], reach[2] = {0, 0}, rows[4][3];
    for (unsigned j = 0; j < 3; ++j) {
      const double* x = points_.axes[j];
      rows[0][j] = x[a], rows[1][j] = x[b], rows[2][j] = x[c], rows[3][j] = x[p];
      e[0][j] = x[b] - x[a];
      e[1][j] = x[c] - x[a];
      reach[0] = std::max(reach[0], std::fabs(e[0][j]));
      reach[1] = std::max(reach[1], std::fabs(e[1][j]));
    }
    cofactors<3>(e, normal);
    double sum = 0;
    for (unsigned j = 0; j < 3; ++j) sum += normal[j] * (rows[3][j] - rows[0][j]);
    constexpr double tiny = 0x1p-800;
    if (std::fabs(sum) > determinant_error(3) * reach[0] * reach[1] * extent_ + tiny)
      return sign_of(sum);
    const double* at[4] = {rows[0], rows[1], rows[2], rows[3]};
    return orientation(3, at);
  }

  // ---------------------------------------------------------------------------------- the facets

  /// Facets that are none are far above every point.
  void clear_planes() {
    const Tag tag;
    const unsigned most = std::min(capacity, 2 * padded_);
    for (unsigned f = 0; f < most; f += static_cast<unsigned>(hn::Lanes(tag))) {
      for (unsigned c = 0; c < 3; ++c) hn::Store(hn::Zero(tag), tag, plane_[c] + f);
      hn::Store(hn::Set(tag, 1.0F), tag, plane_[3] + f);
    }
  }

  /// The direction from p to v, its largest component 1.
  HWY_INLINE void look_from(unsigned p, unsigned v) {
    double d[3], reach = 0;
    for (unsigned c = 0; c < 3; ++c) {
      d[c] = points_.axes[c][v] - points_.axes[c][p];
      reach = std::max(reach, std::fabs(d[c]));
    }
    const double factor = 1 / reach;
    for (unsigned c = 0; c < 3; ++c) direction_[v][c] = d[c] * factor;
  }

  /// Facet (p, from, to); both directions from p are known. The plane is N . x - N . p for x and p
  /// from the middle, N the product of the directions; docs/exactness.md, "Small sets in a batch",
  /// bounds its error in f32.
  HWY_INLINE void create(unsigned f, unsigned p, unsigned from, unsigned to) {
    const double *u = direction_[from], *v = direction_[to];
    const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                         u[0] * v[1] - u[1] * v[0]};
    double offset = 0;
    for (unsigned c = 0; c < 3; ++c) {
      plane_[c][f] = static_cast<float>(n[c]);
      offset += n[c] * ((points_.axes[c][p] - middle_[c]) * scale_);
    }
    plane_[3][f] = static_cast<float>(offset);
    facets_[f] = p << 16 | from << 8 | to;
    owner_[p][from] = owner_[from][to] = owner_[to][p] = static_cast<Number>(f);
  }
  static constexpr float doubt = 0x1p-18F;

  /// The facets that p sees, as bits; false where p is in the plane of one.
  HWY_INLINE bool find_visible(unsigned p, std::uint64_t* visible) const {
    const Tag tag;
    const auto lanes = static_cast<unsigned>(hn::Lanes(tag));
    const V x = hn::Set(tag, near_[0][p]), y = hn::Set(tag, near_[1][p]),
            z = hn::Set(tag, near_[2][p]), above = hn::Set(tag, doubt),
            below = hn::Set(tag, -doubt);
    for (unsigned w = 0; 64 * w < top_; ++w) {
      std::uint64_t seen = 0, hidden = 0;
      const unsigned end = std::min(top_, 64 * w + 64);
      for (unsigned f = 64 * w; f < end; f += lanes) {
        const V s = hn::MulAdd(
            hn::Load(tag, plane_[0] + f), x,
            hn::MulAdd(hn::Load(tag, plane_[1] + f), y,
                       hn::MulSub(hn::Load(tag, plane_[2] + f), z, hn::Load(tag, plane_[3] + f))));
        seen |= bits_of(tag, hn::Gt(s, above)) << f % 64;
        hidden |= bits_of(tag, hn::Lt(s, below)) << f % 64;
      }
      const unsigned used = end - 64 * w;
      std::uint64_t open = ~(seen | hidden) & (~std::uint64_t{0} >> (64 - used));
      for (; open != 0; open &= open - 1) {
        const unsigned f = 64 * w + static_cast<unsigned>(std::countr_zero(open));
        const std::uint32_t v = facets_[f];
        const Sign sign = side(v >> 16, v >> 8 & 0xFF, v & 0xFF, p);
        if (sign == Sign::zero) return false;
        seen |= std::uint64_t{sign == Sign::positive} << f % 64;
      }
      visible[w] = seen;
    }
    return true;
  }

  /// Replaces the facets that point p sees.
  HWY_INLINE bool insert(unsigned p) {
    std::uint64_t seen[capacity / 64];
    if (!find_visible(p, seen)) return false;
    unsigned visible = 0, edges = 0;
    for (unsigned w = 0; 64 * w < top_; ++w)
      for (std::uint64_t rest = seen[w]; rest != 0; rest &= rest - 1) {
        const unsigned f = 64 * w + static_cast<unsigned>(std::countr_zero(rest));
        visible_[visible++] = static_cast<Number>(f);
        const std::uint32_t v = facets_[f];
        const unsigned a = v >> 16, b = v >> 8 & 0xFF, c = v & 0xFF;
        const auto edge = [&](unsigned from, unsigned to) {  // no branch: it would be mispredicted
          const unsigned across = owner_[to][from];
          from_[edges] = static_cast<Number>(from);
          to_[edges] = static_cast<Number>(to);
          edges += 1 - static_cast<unsigned>(seen[across / 64] >> across % 64 & 1);
        };
        edge(a, b);
        edge(b, c);
        edge(c, a);
      }
    if (edges == 0) return true;
    for (unsigned i = 0; i < edges; ++i) look_from(p, from_[i]);
    // As many facets as edges, in the old slots first.
    for (unsigned i = edges; i < visible; ++i) remove(visible_[i]);
    for (unsigned i = 0; i < edges; ++i) {
      unsigned f = 0;
      if (i < visible)
        f = visible_[i];
      else
        f = free_count_ > 0 ? free_[--free_count_] : top_++;
      create(f, p, from_[i], to_[i]);
    }
    return true;
  }

  void remove(unsigned f) {
    for (unsigned c = 0; c < 3; ++c) plane_[c][f] = 0;
    plane_[3][f] = 1;
    facets_[f] = none;
    free_[free_count_++] = static_cast<Number>(f);
  }

  /// The facets in canonical order, without sorting: those whose lowest vertex is v are found by
  /// the bits of their second vertices, as the facets on the left of edges from v.
  HWY_INLINE void collect(SmallHull3D& out) {
    const unsigned words = (count_ + 63) / 64;
    std::uint64_t second[most_points][2];
    for (unsigned v = 0; v < count_; ++v) second[v][0] = second[v][1] = 0;
    for (unsigned f = 0; f < top_; ++f) {
      if (facets_[f] == none) continue;
      const std::uint32_t key = facets_[f];
      const std::uint32_t least =
          std::min({key, (key << 8 | key >> 16) & 0xFFFFFF, (key << 16 | key >> 8) & 0xFFFFFF});
      facets_[f] = least;
      second[least >> 16][least >> 14 & 1] |= std::uint64_t{1} << (least >> 8 & 63);
    }
    Number rank[capacity], used[most_points] = {};
    unsigned n = 0;
    for (unsigned v = 0; v < count_; ++v)
      for (unsigned w = 0; w < words; ++w)
        for (std::uint64_t rest = second[v][w]; rest != 0; rest &= rest - 1) {
          const unsigned f = owner_[v][64 * w + static_cast<unsigned>(std::countr_zero(rest))];
          const std::uint32_t key = facets_[f];
          rank[f] = static_cast<Number>(n);
          Number* to = out.vertices + std::size_t{3} * n++;
          to[0] = static_cast<Number>(v);
          to[1] = static_cast<Number>(key >> 8);
          to[2] = static_cast<Number>(key);
        }
    out.count = n;
    for (unsigned i = 0; i < 3 * n; i += 3) {
      const unsigned a = out.vertices[i], b = out.vertices[i + 1], c = out.vertices[i + 2];
      used[a] = used[b] = used[c] = 1;
      const Number x = rank[owner_[c][b]], y = rank[owner_[a][c]], z = rank[owner_[b][a]];
      out.opposite[i] = out.beside[i + 1] = x;
      out.opposite[i + 1] = out.beside[i + 2] = y;
      out.opposite[i + 2] = out.beside[i] = z;
    }
    for (unsigned i = 3 * n; i < (n + 7) / 8 * 24; ++i) out.vertices[i] = out.vertices[i - 3];
    out.vertex_count = 0;
    for (unsigned v = 0; v < count_; ++v) {
      out.ids[out.vertex_count] = static_cast<Number>(v);
      out.vertex_count += used[v];
    }
  }

  static constexpr std::uint32_t none = 0xFFFFFFFFU;
  const SmallPoints3D& points_;
  const unsigned count_, padded_;
  double middle_[3], extent_ = 0, scale_ = 1;
  unsigned longest_ = 0, begin_[4];
  unsigned top_ = 0, free_count_ = 0;
  HWY_ALIGN float near_[3][most_points];  // from the middle, scaled
  HWY_ALIGN float values_[most_points];
  HWY_ALIGN float plane_[4][capacity];      // normals and offsets
  std::uint32_t facets_[capacity];          // a << 16 | b << 8 | c, counter-clockwise from outside
  Number owner_[most_points][most_points];  // the facet on the left of a directed edge
  Number free_[capacity];
  Number visible_[capacity + 1], from_[capacity + 1], to_[capacity + 1];
  double direction_[most_points][4];
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
