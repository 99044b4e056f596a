// Incremental hull of few points: each point is tested against all facets at once, in f32 with an
// error bound; signs that this leaves open are decided in doubles, then exactly. Sets are so small
// that no search pays: planes are stored in arrays for SIMD, and a table (small sets) or links
// (medium sets) give the facet across an edge.
//
// In f32, v = 2^-24, u = 2^-53. Differences are within u, so N in doubles is within 20 u of exact,
// N*P within 100 u; both are far below what follows. N rounded to f32: at most 2 v an entry, 6 v in
// the sum; X rounded: v an entry, 6 v; the offset, at most 6, rounded: 6 v; three products of at
// most 2: 6 v; three sums of at most 8, 10 and 12: 30 v; fusing only leaves roundings out. In all
// less than 54 v + 120 u; used is 64 v = 2^-18. What underflows loses less than 2^-140.
//
// On a device (`src/cuda/kernels/warp_hull.cuh`) the same holds with the same constants. In the
// plane N = (w_2, -w_1) of one direction: N is exact but for the difference, |N_i| <= 1; rounded to
// f32 it is off by v an entry, 2 v in the sum; X rounded: 2 v; the offset, at most 2, rounded: 2 v;
// two products of at most 1: 2 v; sums of at most 3 and 4: 7 v. In all less than 15 v + 200 u; used
// is 16 v = 2^-20. In doubles the bound is determinant_error(2) R e + 2^-800, R the edge's largest
// entry. No sign is ever zero there: what these bounds leave open makes the set the CPU's, so that
// a set that is decided is simplicial with all its vertices, and no other point is on its boundary.
#include "few/small_3d.hpp"

#include "cullhull/hull.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "few/small_3d.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "exact/determinants/cofactors.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/orientation/orientation_3d.hpp"
#include "few/small_3d_surface.hpp"
#include "parallel/threads/thread_memory.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Wide = hn::CappedTag<double, 8>;
using Tag = hn::CappedTag<float, 16>;
using V = hn::Vec<Tag>;

/// The lanes of a mask, as bits.
template <class D>
HWY_INLINE std::uint64_t bits_of(D tag, hn::Mask<D> mask) {
#if HWY_TARGET == HWY_WASM  // Highway goes through memory there
  static_assert(sizeof(hn::TFromD<D>) == 4);
  return wasm_i32x4_bitmask(static_cast<v128_t>(mask.raw));
#endif
  std::uint64_t bits = 0;
  hn::StoreMaskBits(tag, mask, reinterpret_cast<std::uint8_t*>(&bits));
  if constexpr (std::endian::native == std::endian::big) bits = bits >> 56 | (bits >> 40 & 0xFF00);
  return bits;
}

template <class Surface>
class Builder {
  using Hull = typename Surface::Hull;
  using Number = typename Surface::Number;
  using Points = SmallPoints<Hull::max_points>;
  static constexpr unsigned most_points = Surface::most_points;
  static constexpr unsigned capacity = Surface::capacity;

 public:
  bool run(const Points& points, unsigned count, Hull& out) {
    begin(points, count);
    if (count_ < 4 || !measure(out) || !start()) return false;
    if constexpr (Surface::linked)
      insert_apart();
    else
      insert_all();
    if (given_up_) return false;
    if (!touched_) {
      order_small<Surface>(surface_, count_, nullptr, out);
      return true;
    }
    const unsigned pair_count = find_coplanar();
    if (given_up_) return false;
    merge_small(surface_, pairs_, pair_count, lowest_, polygons_);
    order_small<Surface>(surface_, count_, &polygons_, out);
    return true;
  }

 private:
  void begin(const Points& points, unsigned count) {
    points_ = &points;
    count_ = count;
    padded_ = (count + 15) / 16 * 16;
    extent_ = 0;
    surface_.top = free_count_ = exact_signs_ = 0;
    lattice_ = Lattice::unknown;
    touched_ = given_up_ = false;
  }
  const double* axis(unsigned c) const { return points_->axes[c]; }

  /// Its large arrays have left the stack before facets are merged.
  HWY_NOINLINE void insert_apart() { insert_all(); }
  HWY_INLINE void insert_all() {
    Number order[most_points];
    const unsigned left = outer_first(order);
    for (unsigned i = 0; i < left && !given_up_; ++i) insert(order[i]);
  }

  // ------------------------------------------------------------------------------------ the points

  /// Finds the points' bounding box and scale, and makes f32 copies in units with |x - O| < 1.
  /// False where coordinates are not finite or the extent is outside of (2^-100, 2^100); within
  /// this range underflow and overflow are far away: all differences are at most the extent e <=
  /// 2^100, so each of the six products of a determinant loses at most 3 * 2^-1074 * 2^200 through
  /// underflow, far below `tiny`, which is far below the bound of any facet that counts.
  bool measure(Hull& out) {
    const Wide tag;
    const auto lanes = static_cast<unsigned>(hn::Lanes(tag));
    auto wrong = hn::Zero(tag);
    double reach = 0;
    for (unsigned c = 0; c < 3; ++c) {
      const double* const values = axis(c);
      auto low = hn::Load(tag, values), high = low;
      for (unsigned i = 0; i < padded_; i += lanes) {
        const auto x = hn::Load(tag, values + i);
        wrong = hn::Or(wrong, hn::Sub(x, x));  // 0 or not a number
        low = hn::Min(low, x);
        high = hn::Max(high, x);
      }
      const double least = hn::GetLane(hn::MinOfLanes(tag, low)),
                   most = hn::GetLane(hn::MaxOfLanes(tag, high));
      out.low[c] = least;
      out.high[c] = most;
      middle_[c] = least + (most - least) / 2;  // between the two, whatever the rounding
      reach = std::max({reach, most - middle_[c], middle_[c] - least});
      if (most - least > extent_) {
        extent_ = most - least;
        longest_ = c;
      }
    }
    if (!hn::AllTrue(tag, hn::Eq(wrong, hn::Zero(tag))) || !(extent_ > 0x1p-100) ||
        !(extent_ < 0x1p100))
      return false;
    scale_ = std::ldexp(1.0, -(std::ilogb(reach) + 1));
    const hn::Rebind<float, Wide> narrow;
    for (unsigned c = 0; c < 3; ++c) {
      const auto middle = hn::Set(tag, middle_[c]), scale = hn::Set(tag, scale_);
      for (unsigned i = 0; i < padded_; i += lanes)
        hn::Store(hn::DemoteTo(narrow, hn::Mul(hn::Sub(hn::Load(tag, axis(c) + i), middle), scale)),
                  narrow, near_[c] + i);
    }
    return true;
  }

  /// The first point with the largest `value`.
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

  /// Chooses four points far from one another, and makes their facets. The choice affects speed
  /// only.
  HWY_INLINE bool start() {
    const Tag tag;
    float most = 0;
    const unsigned along = longest_;
    const auto pick = [along](V x, V y, V z) HWY_ATTR {
      return along == 0 ? x : along == 1 ? y : z;
    };
    const V two = hn::Set(tag, 2.0F);  // keeps values positive
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
    surface_.top = 4;
    for (unsigned f = 0; f < 4; ++f) {
      const unsigned p = begin_[order[f][0]], from = begin_[order[f][1]], to = begin_[order[f][2]];
      const Number ends[2] = {static_cast<Number>(from), static_cast<Number>(to)};
      const auto slot = static_cast<Number>(f);
      const double apex[3] = {axis(0)[p], axis(1)[p], axis(2)[p]};
      look_from(apex, to);
      create(p, ends, ends + 1, &slot, 1);
    }
    // Facet f lacks corner f: it shares an edge with each other facet, and beyond that edge is the
    // corner that the other facet lacks.
    if constexpr (Surface::linked)
      for (unsigned f = 0; f < 4; ++f)
        for (unsigned j = 0; j < 3; ++j)
          surface_.facets[f].neighbour[j] = static_cast<Number>(order[f][(j + 2) % 3]);
    return true;
  }

  /// Lists the other points, roughly by descending distance from the middle, so that few inner
  /// points become temporary vertices.
  HWY_INLINE unsigned outer_first(Number* order) {
    float most = 0;
    farthest([&](V x, V y, V z)
                 HWY_ATTR { return hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)); },
             &most);
    // A counting sort into 32 classes of squared distance: outermost points should come first, but
    // their exact order does not matter.
    constexpr unsigned classes = 32;
    const float factor = (classes - 0.5F) / most;
    Number start[classes + 1] = {}, key[most_points];
    for (const unsigned i : begin_) values_[i] = -1;
    for (unsigned i = 0; i < count_; ++i) {
      key[i] = values_[i] < 0
                   ? classes
                   : static_cast<Number>(classes - 1 - static_cast<unsigned>(values_[i] * factor));
      ++start[key[i]];
    }
    unsigned left = 0;
    for (unsigned k = 0; k <= classes; ++k) {
      const unsigned n = start[k];
      start[k] = static_cast<Number>(left);
      left += n;
    }
    for (unsigned i = 0; i < count_; ++i) order[start[key[i]]++] = static_cast<Number>(i);
    return count_ - 4;
  }

  // ------------------------------------------------------------------------------------ the signs

  /// On which side of (a, b, c) point p is. First in doubles,
  ///   |side - exact| <= determinant_error(3) max|edge 1| max|edge 2| max|p - origin| + tiny,
  /// where no difference is larger than the extent, which is rounded in the same way. Then exactly.
  Sign side(unsigned a, unsigned b, unsigned c, unsigned p) {
    double e[3][3], normal[3], reach[2] = {0, 0};
    for (unsigned j = 0; j < 3; ++j) {
      const double* x = axis(j);
      e[0][j] = x[b] - x[a];
      e[1][j] = x[c] - x[a];
      e[2][j] = x[p] - x[a];
      if (e[0][j] == 0 && e[1][j] == 0 && e[2][j] == 0) return Sign::zero;  // as on a box
      reach[0] = std::max(reach[0], std::fabs(e[0][j]));
      reach[1] = std::max(reach[1], std::fabs(e[1][j]));
    }
    for (unsigned j = 0; j < 3; ++j) {
      const unsigned k = (j + 1) % 3, l = (j + 2) % 3;
      normal[j] = e[0][k] * e[1][l] - e[0][l] * e[1][k];
    }
    const double sum = normal[0] * e[2][0] + normal[1] * e[2][1] + normal[2] * e[2][2];
    if (std::fabs(sum) > determinant_error(3) * reach[0] * reach[1] * extent_ + tiny ||
        lattice_ == Lattice::yes)
      return sign_of(sum);
    return hard_side(a, b, c, p, sum);
  }

  HWY_NOINLINE Sign hard_side(unsigned a, unsigned b, unsigned c, unsigned p, double sum) {
    if (lattice_ == Lattice::unknown) lattice_ = on_lattice() ? Lattice::yes : Lattice::no;
    if (lattice_ == Lattice::yes) return sign_of(sum);
    double rows[4][3];
    for (unsigned j = 0; j < 3; ++j) {
      const double* x = axis(j);
      rows[0][j] = x[a], rows[1][j] = x[b], rows[2][j] = x[c], rows[3][j] = x[p];
    }
    Sign sign = Sign::zero;
    for (unsigned i = 0; i < 3; ++i)
      if (std::equal(rows[i], rows[i] + 3, rows[3])) return sign;
    if (side_in_double_doubles(rows[0], rows[1], rows[2], rows[3], tiny, sign)) return sign;
    // Gives up after 16 exact signs of about a microsecond each, more than a whole hull takes here:
    // the general engine is then faster.
    given_up_ |= ++exact_signs_ > most_exact_signs;
    const double* at[4] = {rows[0], rows[1], rows[2], rows[3]};
    return given_up_ ? Sign::zero : orientation_exact(3, at);
  }

  /// Whether differences from the first point are multiples of 2^-15 of a power of two, and at most
  /// twice that power: then a determinant is a sum of six products of integers below 2^48, and no
  /// operation rounds.
  bool on_lattice() const {
    const double unit = 0x1p15 * scale_;
    for (unsigned c = 0; c < 3; ++c) {
      const double first = axis(c)[0];
      for (unsigned i = 1; i < count_; ++i) {
        const double x = axis(c)[i], d = x - first, back = d - x;
        if ((x - (d - back)) + (-first - back) != 0 || d * unit != std::nearbyint(d * unit))
          return false;
      }
    }
    return true;
  }

  // ---------------------------------------------------------------------------------- the facets

  /// Unused slots get planes far above every point.
  void clear_planes() {
    const Tag tag;
    const unsigned most = std::min(capacity, 2 * padded_);
    for (unsigned f = 0; f < most; f += static_cast<unsigned>(hn::Lanes(tag))) {
      for (unsigned c = 0; c < 3; ++c) hn::Store(hn::Zero(tag), tag, plane_[c] + f);
      hn::Store(hn::Set(tag, 1.0F), tag, plane_[3] + f);
    }
  }

  /// Stores the direction from the point `at` to point v, scaled by a power of two to at most 1.
  HWY_INLINE void look_from(const double* at, unsigned v) {
    double d[3], reach = 0;
    for (unsigned c = 0; c < 3; ++c) {
      d[c] = axis(c)[v] - at[c];
      reach = std::max(reach, std::fabs(d[c]));
    }
    const std::uint64_t exponent = std::bit_cast<std::uint64_t>(reach) & std::uint64_t{0x7FF} << 52;
    const auto factor = std::bit_cast<double>((std::uint64_t{0x7FD} << 52) - exponent);
    for (unsigned c = 0; c < 3; ++c) direction_[v][c] = d[c] * factor;
  }

  /// Makes facet (p, from, to) for each of `count` edges of a closed cycle. A plane is N . x - N .
  /// p for x and p relative to the middle, N the cross product of the directions from p to the
  /// edge's ends; docs/exactness.md, "Few points in space", bounds its error in f32.
  HWY_INLINE void create(unsigned p, const Number* from, const Number* to, const Number* slot,
                         unsigned count) {
    double at[3], place[3];
    for (unsigned c = 0; c < 3; ++c) {
      at[c] = axis(c)[p];
      place[c] = (at[c] - middle_[c]) * scale_;
    }
    for (unsigned i = 0; i < count; ++i) look_from(at, from[i]);
    for (unsigned i = 0; i < count; ++i) {
      const unsigned f = slot[i];
      const double *u = direction_[from[i]], *v = direction_[to[i]];
      const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2],
                   z = u[0] * v[1] - u[1] * v[0];
      plane_[0][f] = static_cast<float>(x);
      plane_[1][f] = static_cast<float>(y);
      plane_[2][f] = static_cast<float>(z);
      plane_[3][f] = static_cast<float>(x * place[0] + y * place[1] + z * place[2]);
      surface_.set(f, p, from[i], to[i]);
    }
  }
  /// An upper bound for the effect of rounding to f32 on a side: docs/exactness.md, "Few points in
  /// space".
  static constexpr float doubt = 0x1p-18F;

  /// Lane i: on which side of facet f + i a point is, above if positive.
  HWY_INLINE V side_of(unsigned f, V x, V y, V z) const {
    const Tag tag;
    return hn::MulAdd(
        hn::Load(tag, plane_[0] + f), x,
        hn::MulAdd(hn::Load(tag, plane_[1] + f), y,
                   hn::MulSub(hn::Load(tag, plane_[2] + f), z, hn::Load(tag, plane_[3] + f))));
  }
  /// Whether the point is certainly beneath all facets from `begin` to `end`, which is rounded up
  /// to whole vectors.
  HWY_INLINE bool all_beneath(unsigned begin, unsigned end, V x, V y, V z) const {
    const Tag tag;
    const auto lanes = static_cast<unsigned>(hn::Lanes(tag));
    V most = side_of(begin, x, y, z);
    for (unsigned f = begin + lanes; f < end; f += lanes) most = hn::Max(most, side_of(f, x, y, z));
    return hn::AllTrue(tag, hn::Lt(most, hn::Set(tag, -doubt)));
  }

  /// The facets that are visible from p, as a bit mask.
  HWY_INLINE void find_visible(unsigned p, std::uint64_t* visible) {
    const Tag tag;
    const auto lanes = static_cast<unsigned>(hn::Lanes(tag));
    const V x = hn::Set(tag, near_[0][p]), y = hn::Set(tag, near_[1][p]),
            z = hn::Set(tag, near_[2][p]);
    const V most = hn::Set(tag, doubt), least = hn::Set(tag, -doubt);
    const unsigned top = surface_.top;
    // Most words of a large surface have no visible facet, and to see this takes half the
    // operations of two masks: a tenth less time for 1,000 points on a sphere, 5 % more for 200 and
    // 400. With four lanes it takes an eighth less for 400 points of a ball.
    const bool look_twice = Surface::linked && top >= (lanes > 4 ? 512 : 128);
    for (unsigned w = 0; 64 * w < top; ++w) {
      std::uint64_t seen = 0, hidden = 0;
      const unsigned end = std::min(top, 64 * w + 64);
      if (look_twice && all_beneath(64 * w, end, x, y, z)) {
        visible[w] = 0;
        continue;
      }
      for (unsigned f = 64 * w; f < end; f += lanes) {
        const V s = side_of(f, x, y, z);
        seen |= bits_of(tag, hn::Gt(s, most)) << f % 64;
        hidden |= bits_of(tag, hn::Lt(s, least)) << f % 64;
      }
      const unsigned used = end - 64 * w;
      std::uint64_t open = ~(seen | hidden) & (~std::uint64_t{0} >> (64 - used));
      for (; open != 0; open &= open - 1) {
        const unsigned f = 64 * w + static_cast<unsigned>(std::countr_zero(open));
        unsigned v[3];
        surface_.corners(f, v);
        const Sign sign = side(v[0], v[1], v[2], p);
        if (sign == Sign::zero) touch(p, v);
        seen |= std::uint64_t{sign == Sign::positive} << f % 64;
      }
      visible[w] = seen;
    }
  }

  /// Records that p is in the plane of the facet with corners v. If it is equal to a corner, the
  /// lowest id of equal points represents all of them.
  void touch(unsigned p, const unsigned* v) {
    if (!touched_)
      for (unsigned i = 0; i < count_; ++i) lowest_[i] = static_cast<Number>(i);
    touched_ = true;
    for (unsigned j = 0; j < 3; ++j) {
      bool equal = true;
      for (unsigned c = 0; c < 3; ++c) equal &= axis(c)[v[j]] == axis(c)[p];
      if (equal) lowest_[v[j]] = std::min(lowest_[v[j]], static_cast<Number>(p));
    }
  }

  /// Inserts p: replaces the facets visible from it.
  HWY_INLINE void insert(unsigned p) {
    std::uint64_t seen[capacity / 64];
    find_visible(p, seen);
    if (given_up_) return;  // a sign is missing, so the visible facets may be no disc
    Number slot[capacity], from[capacity + 1], to[capacity + 1];
    // For linked surfaces: the facet beyond each edge, and the number of the edge in that facet.
    constexpr unsigned linked_room = Surface::linked ? capacity + 1 : 1;
    Number beyond[linked_room], back[linked_room];
    unsigned visible = 0, edges = 0;
    for (unsigned w = 0; 64 * w < surface_.top; ++w)
      for (std::uint64_t rest = seen[w]; rest != 0; rest &= rest - 1) {
        const unsigned f = 64 * w + static_cast<unsigned>(std::countr_zero(rest));
        slot[visible++] = static_cast<Number>(f);
        unsigned v[3];
        surface_.corners(f, v);
        for (unsigned j = 0; j < 3; ++j) {  // branchless: a branch would be mispredicted
          const unsigned across = surface_.across(f, v, j);
          from[edges] = static_cast<Number>(v[j]);
          to[edges] = static_cast<Number>(v[j == 2 ? 0 : j + 1]);
          if constexpr (Surface::linked) {
            const Number* other = surface_.facets[across].neighbour;
            beyond[edges] = static_cast<Number>(across);
            back[edges] = static_cast<Number>((other[1] == f ? 1 : 0) + (other[2] == f ? 2 : 0));
          }
          edges += 1 - static_cast<unsigned>(seen[across / 64] >> across % 64 & 1);
        }
      }
    if (edges == 0) return;
    // One new facet per edge, first in the slots of the visible facets.
    for (unsigned i = edges; i < visible; ++i) remove(slot[i]);
    for (unsigned i = visible; i < edges; ++i)
      slot[i] = free_count_ > 0 ? free_[--free_count_] : static_cast<Number>(surface_.top++);
    create(p, from, to, slot, edges);
    if constexpr (Surface::linked) link(from, to, slot, beyond, back, edges);
  }

  /// Links the new facets with those beyond the edges, and with one another.
  HWY_INLINE void link(const Number* from, const Number* to, const Number* slot,
                       const Number* beyond, const Number* back, unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
      surface_.join(slot[i], 1, beyond[i], back[i]);
      beginning_[from[i]] = slot[i];
    }
    for (unsigned i = 0; i < count; ++i) surface_.join(slot[i], 2, beginning_[to[i]], 0);
  }

  void remove(unsigned f) {
    for (unsigned c = 0; c < 3; ++c) plane_[c][f] = 0;
    plane_[3][f] = 1;
    surface_.remove(f);
    free_[free_count_++] = static_cast<Number>(f);
  }

  /// Lists the pairs of adjacent coplanar facets.
  unsigned find_coplanar() {
    unsigned count = 0;
    for (unsigned f = 0; f < surface_.top; ++f) {
      if (!surface_.live(f)) continue;
      unsigned v[3], o[3];
      surface_.corners(f, v);
      for (unsigned j = 0; j < 3; ++j) {
        const unsigned from = v[j], to = v[j == 2 ? 0 : j + 1], g = surface_.across(f, v, j);
        if (g < f) continue;
        surface_.corners(g, o);
        const unsigned p = o[0] ^ o[1] ^ o[2] ^ from ^ to;  // the corner of the other facet
        const float s = plane_[0][f] * near_[0][p] + plane_[1][f] * near_[1][p] +
                        plane_[2][f] * near_[2][p] - plane_[3][f];
        if (!(s < -doubt) && side(v[0], v[1], v[2], p) == Sign::zero)
          pairs_[count++] = {static_cast<Number>(f), static_cast<Number>(g)};
      }
    }
    return count;
  }

  static constexpr double tiny = 0x1p-800;
  static constexpr unsigned most_exact_signs = 16;
  enum class Lattice : std::uint8_t { unknown, no, yes };

  const Points* points_;
  unsigned count_, padded_;
  double middle_[3], extent_, scale_;
  unsigned longest_, begin_[4];
  unsigned free_count_, exact_signs_;
  Lattice lattice_;
  bool touched_, given_up_;  // some point lies in a facet's plane; too many signs were undecided
  Surface surface_;
  HWY_ALIGN float near_[3][most_points];  // relative to the middle, scaled
  double direction_[most_points][4];      // from the point being inserted
  HWY_ALIGN float values_[most_points];
  HWY_ALIGN float plane_[4][capacity];  // normals and offsets
  Number lowest_[most_points];          // the lowest id of equal points; valid if touched_
  Number free_[capacity];
  CoplanarPair<Surface> pairs_[3 * capacity / 2];
  MergedFacets<Surface> polygons_;
  Number
      beginning_[Surface::linked ? most_points : 1];  // the new facet whose edge begins at a vertex
};

}  // namespace

bool small_hull_in(const SmallPoints3D& points, unsigned count, SmallHull3D& out) {
  Builder<TableSurface> builder;
  return builder.run(points, count, out);
}
bool medium_hull_in(const MediumPoints3D& points, unsigned count, MediumHull3D& out) {
  return thread_memory<Builder<LinkedSurface>>().run(points, count, out);
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(small_hull_in);
HWY_EXPORT(medium_hull_in);

bool small_hull_3d(const SmallPoints3D& points, unsigned count, SmallHull3D& out) {
  return HWY_DYNAMIC_DISPATCH(small_hull_in)(points, count, out);
}
bool small_hull_3d(const MediumPoints3D& points, unsigned count, MediumHull3D& out) {
  return HWY_DYNAMIC_DISPATCH(medium_hull_in)(points, count, out);
}

}  // namespace cullhull::internal
#endif
