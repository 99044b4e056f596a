// The hull of a set by one warp: points are inserted one after another, each tested against all
// facets at once, a facet a lane. A sign that arithmetic in doubles leaves open ends the attempt,
// and with it goes every set whose hull is not simplicial: the CPU's exact code takes those.
// docs/exactness.md, "Few points in space", has the bounds, which are the CPU's.
//
// A set of few points is `near`: a copy of it is in shared memory, and all points are inserted, the
// outermost first. Of a larger one, in space, the outermost points of some cells of directions are
// inserted; of all others those that this hull does not contain, each tested by a lane.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "cuda/kernels/coordinate.cuh"
#include "cuda/kernels/set_hulls_kernel.hpp"
#include "result/facets/facet_math.hpp"

namespace cullhull::internal {

inline constexpr unsigned lanes = 32;

__device__ inline unsigned ballot(bool predicate) { return __ballot_sync(0xFFFFFFFFU, predicate); }
/// Of a warp's values.
template <class Value>
__device__ Value largest(Value value) {
#pragma unroll
  for (int apart = lanes / 2; apart > 0; apart /= 2) {
    const Value other = __shfl_xor_sync(0xFFFFFFFFU, value, apart);
    value = other > value ? other : value;
  }
  return value;
}

/// A warp's part of its block's shared memory, for sets of up to `most` points, a multiple of 32.
template <unsigned D, bool Near>
struct WarpMemory {
  /// Numbers of points and of facets; three or four points.
  using Number = std::conditional_t<Near, std::uint8_t, std::uint16_t>;
  using Key = std::conditional_t<Near, std::uint32_t, std::uint64_t>;
  /// Cells of a cube; those on its faces, 98 in space, are cells of directions.
  static constexpr unsigned cells_along = 5, cells = 5 * 5 * 5;

  static constexpr std::size_t facets(unsigned most) {
    const std::size_t all = D == 2 ? most : 2 * most;
    return Near || all < most_far_facets ? all : most_far_facets;
  }
  static constexpr std::size_t candidates(unsigned most) { return Near ? most : cells; }
  static constexpr std::size_t bytes(unsigned most) {
    return (Near ? D * (sizeof(double) + sizeof(float)) * most : 0) +
           ((D + 1) * sizeof(float) + 2 * sizeof(Key) + 2 * sizeof(Number)) * facets(most) +
           (most / 8 + sizeof(Number) * candidates(most) + 7) / 8 * 8;
  }

  __device__ WarpMemory(void* begin, unsigned most)
      : most(most), slots(static_cast<unsigned>(facets(most))) {
    place = static_cast<double*>(begin);
    local = reinterpret_cast<float*>(place + (Near ? D * most : 0));
    plane = local + (Near ? D * most : 0);
    corners = reinterpret_cast<Key*>(plane + (D + 1) * slots);
    made = corners + slots;
    bits = reinterpret_cast<std::uint32_t*>(made + slots);
    visible = reinterpret_cast<Number*>(bits + most / 32);
    spare = visible + slots;
    order = spare + slots;
  }
  /// Of candidates: how far out they are, then `none` minus their number. Before there are facets.
  __device__ unsigned long long* keys() const {
    return reinterpret_cast<unsigned long long*>(plane);
  }

  unsigned most, slots;
  double* place;        ///< of a near set coordinate c of point i at c * most + i, as given
  float* local;         ///< the same relative to the middle, in units that make it less than 1
  float* plane;         ///< normals' coordinates and offsets, `slots` of each
  Key* corners;         ///< of facets: in space a, b, c, in the plane from, to
  Key* made;            ///< those of new ones
  std::uint32_t* bits;  ///< a bit a point: inserted; in the end, a vertex
  Number* visible;      ///< slots that the point sees
  Number* spare;        ///< slots that are not in use
  Number* order;        ///< candidates, the outermost first
};

template <unsigned D, class T, bool Near>
class WarpHull {
  using Memory = WarpMemory<D, Near>;
  using Number = typename Memory::Number;
  using Key = typename Memory::Key;

 public:
  /// The set of the `count` points from `first` on.
  __device__ WarpHull(const Memory& memory, const DevicePointView& points, std::uint64_t first,
                      unsigned count, unsigned lane)
      : m_(memory),
        points_(points),
        first_(first),
        count_(count),
        lane_(lane),
        below_((1U << lane) - 1) {}

  /// Vertices and simplices in the order of a result; how many, or none where the hull is not
  /// decided or has too many facets. `vertices` has room for all points.
  __device__ SetCounts run(std::uint16_t* vertices, std::uint16_t* simplices) {
    if (!load()) return {};
    list_candidates();
    if (!start()) return {};
    // One loop, so that insert() is inlined, and all that it needs is in registers.
    for (unsigned k = 0, all = candidates_;; ++k) {
      if (!Near && k == candidates_) all += list_outside(vertices);
      if (k == all) break;
      if (!insert(Near || k < candidates_ ? m_.order[k] : vertices[k - candidates_])) return {};
      __syncwarp();
    }
    return write(vertices, simplices);
  }

 private:
  static constexpr std::uint32_t none = 0xFFFFFFFFU;
  static constexpr Key unused = ~Key{0};
  static constexpr unsigned width = 8 * sizeof(Number);  ///< of a point's number in a key
  static constexpr Key number_mask = (Key{1} << width) - 1;
  /// Upper bounds of what rounding to f32 does to a side; with 2^-100 < extent < 2^100.
  static constexpr float doubt = D == 2 ? 0x1p-20F : 0x1p-18F;
  static constexpr double tiny = 0x1p-800;

  // ------------------------------------------------------------------------------------ points

  /// False for coordinates that are not finite and for extreme extents.
  __device__ bool load() {
    bool bad = false;
    double reach = 0, wide[D];
    extent_ = 0;
#pragma unroll
    for (unsigned c = 0; c < D; ++c) {
      double low = 0x1p1000, high = -0x1p1000;
      for (unsigned i = lane_; i < count_; i += lanes) {
        const double x = given(c, i);
        if constexpr (Near) m_.place[c * m_.most + i] = x;
        bad = bad || !(x - x == 0);
        low = x < low ? x : low;
        high = x > high ? x : high;
      }
      low = -largest(-low);
      high = largest(high);
      middle_[c] = low + (high - low) / 2;
      const double beyond = high - middle_[c], beneath = middle_[c] - low;
      reach = greater_of(greater_of(reach, beyond), beneath);
      wide[c] = high - low;
      extent_ = greater_of(extent_, wide[c]);
    }
    if (ballot(bad) != 0 || !(extent_ > 0x1p-100) || !(extent_ < 0x1p100)) return false;
    // 2 to the power of minus the exponent after reach's.
    const long long exponent = __double_as_longlong(reach) >> 52;
    scale_ = __longlong_as_double((2045 - exponent) << 52);
#pragma unroll
    for (unsigned c = 0; c < D; ++c) {
      unit_[c] = __double2float_rn(2 / (wide[c] * scale_));
      if constexpr (Near)
        for (unsigned i = lane_; i < count_; i += lanes)
          m_.local[c * m_.most + i] = relative(c, m_.place[c * m_.most + i]);
    }
    clear_bits();
    return true;
  }

  __device__ double given(unsigned c, unsigned i) const {
    return static_cast<double>(coordinate<T>(points_, first_ + i, c));
  }
  __device__ float relative(unsigned c, double x) const {
    return __double2float_rn((x - middle_[c]) * scale_);
  }
  __device__ double place(unsigned c, unsigned i) const {
    return Near ? m_.place[c * m_.most + i] : given(c, i);
  }
  __device__ float local(unsigned c, unsigned i) const {
    return Near ? m_.local[c * m_.most + i] : relative(c, given(c, i));
  }

  __device__ void clear_bits() {
    for (unsigned i = lane_; i < m_.most / 32; i += lanes) m_.bits[i] = 0;
    __syncwarp();
  }
  __device__ void mark(unsigned i) { atomicOr(m_.bits + i / 32, 1U << i % 32); }
  __device__ bool marked(unsigned i) const { return (m_.bits[i / 32] >> i % 32 & 1) != 0; }

  /// The number of 32 bits whose order is that of `value`, which is not negative, and then that of
  /// falling numbers.
  __device__ static unsigned long long key_of(float value, unsigned i) {
    return static_cast<unsigned long long>(__float_as_uint(value)) << 32 | (none - i);
  }
  __device__ static unsigned number_of(unsigned long long key) {
    return none - static_cast<unsigned>(key);
  }

  /// The first candidate with the largest value, none of which is negative.
  template <class Value>
  __device__ unsigned farthest(const Value& value) const {
    unsigned long long best = 0;
    for (unsigned k = lane_; k < candidates_; k += lanes) {
      const unsigned i = m_.order[k];
      const unsigned long long key = key_of(value(i), i);
      best = key > best ? key : best;
    }
    return number_of(largest(best));
  }

  /// The points that are inserted first, by descending distance from the middle, so that few inner
  /// points become vertices for a time.
  __device__ void list_candidates() {
    unsigned long long* const keys = m_.keys();
    const unsigned all = Near ? count_ : Memory::cells;
    if constexpr (!Near) {
      for (unsigned k = lane_; k < all; k += lanes) keys[k] = 0;
      __syncwarp();
    }
    for (unsigned i = lane_; i < count_; i += lanes) {
      float q[D], square = 0, most = 0;
      unsigned cell = 0;
#pragma unroll
      for (unsigned c = 0; c < D; ++c) {
        q[c] = local(c, i) * unit_[c];
        square += q[c] * q[c];
        most = fmaxf(most, fabsf(q[c]));
      }
      if constexpr (Near) {
        keys[i] = key_of(square, i);
      } else {
        constexpr float along = Memory::cells_along;
#pragma unroll
        for (unsigned c = 0; c < D; ++c)
          cell =
              cell * Memory::cells_along +
              static_cast<unsigned>(fminf(fmaxf((q[c] / most + 1) * (along / 2), 0.0F), along - 1));
        atomicMax(keys + cell, key_of(square, i));
      }
    }
    __syncwarp();
    candidates_ = 0;
    for (unsigned base = 0; base < all; base += lanes) {
      const unsigned long long key = base + lane_ < all ? keys[base + lane_] : 0;
      unsigned rank = 0;
      for (unsigned j = 0; j < all; ++j) rank += keys[j] > key ? 1 : 0;
      if (key != 0) m_.order[rank] = static_cast<Number>(number_of(key));
      candidates_ += __popc(ballot(key != 0));
    }
    __syncwarp();
  }

  /// Lists the points that are not certainly beneath all facets, and marks those inserted.
  __device__ unsigned list_outside(std::uint16_t* list) {
    for (unsigned k = lane_; k < candidates_; k += lanes) mark(m_.order[k]);
    __syncwarp();
    unsigned listed = 0;
    for (unsigned base = 0; base < count_; base += lanes) {
      const unsigned i = base + lane_;
      const bool out = i < count_ && !beneath_all(i);
      const unsigned word = ballot(out);
      if (out) list[listed + __popc(word & below_)] = static_cast<std::uint16_t>(i);
      listed += __popc(word);
    }
    __syncwarp();
    return listed;
  }

  /// D + 1 candidates, each far from the flat of those before it, and their facets.
  __device__ bool start() {
    Key points = m_.order[0];
    float basis[D][D];  // orthonormal, of the flat
#pragma unroll
    for (unsigned k = 0; k < D; ++k) {
      // What is orthogonal to the flat; returns its square.
      const auto beyond = [&](unsigned i, float(&r)[D]) {
        float square = 0;
#pragma unroll
        for (unsigned c = 0; c < D; ++c) r[c] = local(c, i) - local(c, part(points, 0));
#pragma unroll
        for (unsigned j = 0; j < k; ++j) {
          float along = 0;
#pragma unroll
          for (unsigned c = 0; c < D; ++c) along += r[c] * basis[j][c];
#pragma unroll
          for (unsigned c = 0; c < D; ++c) r[c] -= along * basis[j][c];
        }
#pragma unroll
        for (unsigned c = 0; c < D; ++c) square += r[c] * r[c];
        return square;
      };
      const unsigned next = farthest([&](unsigned i) {
        float r[D];
        return beyond(i, r);
      });
      const float length = sqrtf(beyond(next, basis[k]));
#pragma unroll
      for (unsigned c = 0; c < D; ++c) basis[k][c] /= length;
      points |= Key{next} << width * (k + 1);
    }
    const int sign = side(without(points, D), part(points, D));
    if (sign == 0) return false;
    if (sign > 0) points = swapped(points);  // now the last is beneath the others
    if (lane_ <= D) {
      const Key facet = without(points, lane_);
      create(lane_, (D - lane_) % 2 == 0 ? facet : swapped(facet));
      mark(part(points, lane_));
    }
    top_ = D + 1;
    spares_ = 0;
    __syncwarp();
    return true;
  }

  // ------------------------------------------------------------------------------------ keys

  /// Number j of a key, from the lowest bits.
  __device__ static unsigned part(Key key, unsigned j) {
    return static_cast<unsigned>(key >> width * j & number_mask);
  }
  /// A facet's key begins with the highest bits.
  __device__ static unsigned corner(Key key, unsigned j) { return part(key, D - 1 - j); }
  /// The facet of the D + 1 points of a key but number j.
  __device__ static Key without(Key points, unsigned j) {
    Key facet = 0;
#pragma unroll
    for (unsigned k = 0; k <= D; ++k)
      if (k != j) facet = facet << width | part(points, k);
    return facet;
  }
  /// With numbers 0 and 1 in each other's place.
  __device__ static Key swapped(Key key) {
    const Key change = (key ^ key >> width) & number_mask;
    return key ^ change ^ change << width;
  }

  // ------------------------------------------------------------------------------------ signs

  /// The side of a facet's plane on which p is: 1 above, -1 beneath, 0 not known.
  __device__ int side(Key key, unsigned p) const {
    const unsigned a = corner(key, 0);
    double edges[D - 1][D], normal[D], bound = determinant_error(D) * extent_, sum = 0;
#pragma unroll
    for (unsigned e = 0; e + 1 < D; ++e) bound *= edge(a, corner(key, e + 1), edges[e]);
    cross(edges, normal);
#pragma unroll
    for (unsigned c = 0; c < D; ++c) sum += normal[c] * (place(c, p) - place(c, a));
    bound += tiny;
    return sum > bound ? 1 : sum < -bound ? -1 : 0;
  }

  __device__ void locate(unsigned p, float (&q)[D]) const {
#pragma unroll
    for (unsigned c = 0; c < D; ++c) q[c] = local(c, p);
  }
  /// How far a located point is above a facet, within `doubt`.
  __device__ float height(unsigned f, const float (&q)[D]) const {
    float s = -m_.plane[D * m_.slots + f];
#pragma unroll
    for (unsigned c = D; c-- > 0;) s = __fmaf_rn(m_.plane[c * m_.slots + f], q[c], s);
    return s;
  }
  /// -1, 0 or 1 as `side`, first in f32.
  __device__ int quick_side(unsigned f, unsigned p, const float (&q)[D]) const {
    const float s = height(f, q);
    return s > doubt ? 1 : s < -doubt ? -1 : side(m_.corners[f], p);
  }
  /// Whether f32 says so. Then p is inside, and never a vertex.
  __device__ bool beneath_all(unsigned p) const {
    float q[D];
    locate(p, q);
    for (unsigned f = 0; f < top_; ++f)
      if (!(height(f, q) < -doubt)) return false;
    return true;
  }

  // ------------------------------------------------------------------------------------ facets

  /// From a to v; returns the largest entry.
  __device__ double edge(unsigned a, unsigned v, double (&d)[D]) const {
    double reach = 0;
#pragma unroll
    for (unsigned c = 0; c < D; ++c) {
      d[c] = place(c, v) - place(c, a);
      reach = greater_of(reach, absolute(d[c]));
    }
    return reach;
  }
  /// The normal that points out of a facet of these edges.
  __device__ static void cross(const double (&edges)[D - 1][D], double (&normal)[D]) {
    cofactors<D>(edges, normal);
#pragma unroll
    for (unsigned c = 0; D == 2 && c < D; ++c) normal[c] = -normal[c];
  }

  /// A facet of these corners, counter-clockwise from outside. One lane's work.
  __device__ void create(unsigned slot, Key facet) {
    const unsigned a = corner(facet, 0);
    double edges[D - 1][D], normal[D];
#pragma unroll
    for (unsigned e = 0; e + 1 < D; ++e) {
      // Divided by a power of two so that it is at most 1.
      const long long exponent =
          __double_as_longlong(edge(a, corner(facet, e + 1), edges[e])) & 0x7FFLL << 52;
      const double factor = __longlong_as_double((0x7FDLL << 52) - exponent);
#pragma unroll
      for (unsigned c = 0; c < D; ++c) edges[e][c] *= factor;
    }
    cross(edges, normal);
    m_.corners[slot] = facet;
    double offset = 0;
#pragma unroll
    for (unsigned j = 0; j < D; ++j) {
      offset += normal[j] * ((place(j, a) - middle_[j]) * scale_);
      m_.plane[j * m_.slots + slot] = __double2float_rn(normal[j]);
    }
    m_.plane[D * m_.slots + slot] = __double2float_rn(offset);
  }

  /// An unused slot's plane is far above every point.
  __device__ void remove(unsigned slot) {
#pragma unroll
    for (unsigned c = 0; c < D; ++c) m_.plane[c * m_.slots + slot] = 0;
    m_.plane[D * m_.slots + slot] = 1;
    m_.corners[slot] = unused;
  }

  /// Replaces the facets that p sees. False where a sign is not known, and for too many facets.
  __device__ bool insert(unsigned p) {
    if (marked(p)) return true;
    float q[D];
    locate(p, q);
    bool known = true;
    unsigned seen = 0;
    for (unsigned base = 0; base < top_; base += lanes) {
      const unsigned f = base + lane_;
      const int sign = f < top_ ? quick_side(f, p, q) : -1;
      known = known && sign != 0;
      const unsigned word = ballot(sign > 0);
      if (sign > 0) m_.visible[seen + __popc(word & below_)] = static_cast<Number>(f);
      seen += __popc(word);
    }
    if (ballot(!known) != 0) return false;
    if (seen == 0) return true;
    __syncwarp();
    const unsigned made = list_new(seen, p);
    if (!Near && top_ + made > m_.slots + seen + spares_) return false;
    replace(seen, made);
    return true;
  }

  /// Lists the facets that p makes with the ridges (in space edges, in the plane vertices) between
  /// what it sees and the rest; returns how many. Mostly some six facets are seen, so each is
  /// compared with all.
  __device__ unsigned list_new(unsigned seen, unsigned p) {
    unsigned listed = 0;
    for (unsigned base = 0; base < seen; base += lanes) {
      const unsigned mine = base + lane_;
      const Key facet = mine < seen ? m_.corners[m_.visible[mine]] : 0;
      bool borders[D];  // whether the ridge without this corner does
#pragma unroll
      for (bool& b : borders) b = mine < seen;
      for (unsigned j = 0; j < seen; ++j) {
        const Key other = m_.corners[m_.visible[j]];
        unsigned shared = 0;
#pragma unroll
        for (unsigned k = 0; k < D; ++k)
#pragma unroll
          for (unsigned l = 0; l < D; ++l)
            shared |= part(other, l) == part(facet, k) ? 1U << k : 0U;
#pragma unroll
        for (unsigned k = 0; k < D; ++k)
          borders[k] = borders[k] && (j == mine || (shared | 1U << k) != (1U << D) - 1);
      }
#pragma unroll
      for (unsigned k = 0; k < D; ++k) {
        const unsigned word = ballot(borders[k]);
        if (borders[k])
          m_.made[listed + __popc(word & below_)] =
              (facet & ~(number_mask << width * k)) | Key{p} << width * k;
        listed += __popc(word);
      }
    }
    __syncwarp();
    return listed;
  }

  /// The new facets first take the slots of what was seen.
  __device__ void replace(unsigned seen, unsigned made) {
    for (unsigned i = lane_; i < made || i < seen; i += lanes) {
      unsigned slot;
      if (i < seen)
        slot = m_.visible[i];
      else if (i - seen < spares_)
        slot = m_.spare[spares_ - 1 - (i - seen)];
      else
        slot = top_ + (i - seen - spares_);
      if (i < made) {
        create(slot, m_.made[i]);
      } else {
        remove(slot);
        m_.spare[spares_ + (i - made)] = static_cast<Number>(slot);
      }
    }
    if (made > seen) {
      const unsigned more = made - seen, old = more < spares_ ? more : spares_;
      spares_ -= old;
      top_ += more - old;
    } else {
      spares_ += seen - made;
    }
  }

  // ------------------------------------------------------------------------------------ the result

  __device__ SetCounts write(std::uint16_t* vertices, std::uint16_t* simplices) {
    clear_bits();
    for (unsigned f = lane_; f < top_; f += lanes) {
      const Key key = m_.corners[f];
      if (key == unused) continue;
#pragma unroll
      for (unsigned j = 0; j < D; ++j) mark(corner(key, j));
    }
    __syncwarp();
    const auto simplex_count = static_cast<std::uint16_t>(top_ - spares_);
    if constexpr (D == 2) {
      write_cycle(vertices, simplices);
      return {simplex_count, simplex_count};
    } else {
      const auto vertex_count = static_cast<std::uint16_t>(write_ids(vertices));
      write_sorted(simplices);
      return {vertex_count, simplex_count};
    }
  }

  __device__ unsigned write_ids(std::uint16_t* vertices) const {
    unsigned before = 0;
    for (unsigned base = 0; base < count_; base += lanes) {
      const std::uint32_t word = m_.bits[base / 32];
      if ((word >> lane_ & 1) != 0)
        vertices[before + __popc(word & below_)] = static_cast<std::uint16_t>(base + lane_);
      before += __popc(word);
    }
    return before;
  }

  /// Each simplex from its lowest corner, the simplices ascending.
  __device__ void write_sorted(std::uint16_t* simplices) {
    constexpr Key all = (Key{1} << 3 * width) - 1;
    for (unsigned f = lane_; f < top_; f += lanes) {
      const Key key = m_.corners[f];
      if (key == unused) continue;
      const Key next = (key << width | key >> 2 * width) & all,
                last = (key << 2 * width | key >> width) & all;
      const Key least = next < last ? next : last;
      m_.corners[f] = key < least ? key : least;
    }
    __syncwarp();
    for (unsigned f = lane_; f < top_; f += lanes) {
      const Key key = m_.corners[f];
      if (key == unused) continue;
      unsigned rank = 0;
      for (unsigned g = 0; g < top_; ++g) rank += m_.corners[g] < key ? 1 : 0;
#pragma unroll
      for (unsigned j = 0; j < 3; ++j)
        simplices[3 * rank + j] = static_cast<std::uint16_t>(corner(key, j));
    }
  }

  /// Vertices counter-clockwise from the lowest; an edge a vertex, by ascending ids: the vertex and
  /// the one before it.
  __device__ void write_cycle(std::uint16_t* vertices, std::uint16_t* simplices) {
    Number *const before = m_.visible, *const after = m_.spare;
    // `spare` lists the slots that are not in use, which nobody needs any more.
    for (unsigned f = lane_; f < top_; f += lanes) {
      const Key key = m_.corners[f];
      if (key == unused) continue;
      after[corner(key, 0)] = static_cast<Number>(corner(key, 1));
      before[corner(key, 1)] = static_cast<Number>(corner(key, 0));
    }
    __syncwarp();
    unsigned rank = 0, lowest = none;
    for (unsigned base = 0; base < count_; base += lanes) {
      const std::uint32_t word = m_.bits[base / 32];
      if ((word >> lane_ & 1) != 0) {
        const unsigned at = 2 * (rank + __popc(word & below_));
        simplices[at] = static_cast<std::uint16_t>(base + lane_);
        simplices[at + 1] = before[base + lane_];
      }
      if (lowest == none && word != 0) lowest = base + static_cast<unsigned>(__ffs(word)) - 1;
      rank += __popc(word);
    }
    // A list's ranks one after another: there are few.
    if (lane_ == 0)
      for (unsigned k = 0, v = lowest; k < rank; ++k, v = after[v])
        vertices[k] = static_cast<std::uint16_t>(v);
  }

  const Memory m_;
  const DevicePointView& points_;
  const std::uint64_t first_;
  const unsigned count_, lane_, below_;
  double middle_[D], extent_, scale_;
  float unit_[D];  ///< of an axis, in which coordinates relative to the middle are at most 1
  unsigned candidates_, top_, spares_;
};

}  // namespace cullhull::internal
