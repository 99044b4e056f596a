// The hull of a small set by one warp: points are inserted one after another, each tested against
// all facets at once, a facet a lane. A sign that arithmetic in doubles leaves open ends the
// attempt, and with it goes every set whose hull is not simplicial: the CPU's exact code takes
// those. docs/exactness.md, "Few points in space", has the bounds, which are the CPU's.
#pragma once

#include <cstddef>
#include <cstdint>

#include "cuda/kernels/coordinate.cuh"
#include "exact/determinants/cofactors.hpp"

namespace cullhull::internal {

inline constexpr unsigned lanes = 32;

__device__ inline unsigned ballot(bool predicate) { return __ballot_sync(0xFFFFFFFFU, predicate); }

/// A warp's part of its block's shared memory, for sets of up to `most` points, a multiple of 32.
template <unsigned D>
struct WarpMemory {
  static constexpr std::size_t facets(unsigned most) { return D == 2 ? most : 2 * most; }
  static constexpr std::size_t edge_words(unsigned most) {
    return D == 2 ? most / 16 : std::size_t{most} * (most / 32);
  }
  static constexpr std::size_t bytes(unsigned most) {
    return D * sizeof(double) * most + D * sizeof(float) * most +
           ((D + 1) * sizeof(float) + sizeof(std::uint32_t) + sizeof(std::uint16_t) + 2) *
               facets(most) +
           sizeof(std::uint32_t) * edge_words(most) + most;
  }

  __device__ WarpMemory(void* begin, unsigned most)
      : most(most), slots(static_cast<unsigned>(facets(most))) {
    place = static_cast<double*>(begin);
    local = reinterpret_cast<float*>(place + D * most);
    plane = local + D * most;
    corners = reinterpret_cast<std::uint32_t*>(plane + (D + 1) * slots);
    edges = corners + slots;
    horizon = reinterpret_cast<std::uint16_t*>(edges + edge_words(most));
    visible = reinterpret_cast<std::uint8_t*>(horizon + slots);
    spare = visible + slots;
    order = spare + slots;
  }

  unsigned most, slots;
  double* place;           ///< coordinate c of point i at c * most + i, as given
  float* local;            ///< the same relative to the middle, in units that make it less than 1
  float* plane;            ///< normals' coordinates and offsets, `slots` of each
  std::uint32_t* corners;  ///< from the highest byte: in space a, b, c, in the plane from, to
  std::uint32_t* edges;  ///< in space a bit an edge, row a, column b; in the plane starts and ends
  std::uint16_t* horizon;  ///< edges of what is seen, a << 8 | b
  std::uint8_t* visible;   ///< slots that the point sees
  std::uint8_t* spare;     ///< slots that are not in use
  std::uint8_t* order;     ///< points, the outermost first
};

template <unsigned D>
class WarpHull {
 public:
  __device__ WarpHull(const WarpMemory<D>& memory, unsigned count, unsigned lane)
      : m_(memory), count_(count), lane_(lane), below_((1U << lane) - 1) {}

  /// Vertices and simplices in the order of a result; the numbers of both, or 0 where the hull is
  /// not decided.
  template <class T>
  __device__ unsigned run(const DevicePointView& points, std::uint64_t first,
                          std::uint8_t* vertices, std::uint8_t* simplices) {
    if (!load<T>(points, first)) return 0;
    outermost_first();
    if (!start()) return 0;
    for (unsigned k = 0; k < count_; ++k)
      if (!insert(m_.order[k])) return 0;
    return write(vertices, simplices);
  }

 private:
  static constexpr std::uint32_t none = 0xFFFFFFFFU;
  /// Upper bounds of what rounding to f32 does to a side; with 2^-100 < extent < 2^100.
  static constexpr float doubt = D == 2 ? 0x1p-20F : 0x1p-18F;
  static constexpr double tiny = 0x1p-800;

  // ------------------------------------------------------------------------------------ points

  /// False for coordinates that are not finite and for extreme extents.
  template <class T>
  __device__ bool load(const DevicePointView& points, std::uint64_t first) {
    bool bad = false;
    double reach = 0;
    extent_ = 0;
#pragma unroll
    for (unsigned c = 0; c < D; ++c) {
      double* const axis = m_.place + c * m_.most;
      double low = 0x1p1000, high = -0x1p1000;
      for (unsigned i = lane_; i < count_; i += lanes) {
        const auto x = static_cast<double>(coordinate<T>(points, first + i, c));
        axis[i] = x;
        bad = bad || !(x - x == 0);
        low = x < low ? x : low;
        high = x > high ? x : high;
      }
#pragma unroll
      for (int apart = lanes / 2; apart > 0; apart /= 2) {
        const double l = __shfl_xor_sync(0xFFFFFFFFU, low, apart),
                     h = __shfl_xor_sync(0xFFFFFFFFU, high, apart);
        low = l < low ? l : low;
        high = h > high ? h : high;
      }
      middle_[c] = low + (high - low) / 2;
      const double beyond = high - middle_[c], beneath = middle_[c] - low;
      reach = beyond > reach ? beyond : reach;
      reach = beneath > reach ? beneath : reach;
      if (high - low > extent_) {
        extent_ = high - low;
        longest_ = c;
      }
    }
    if (ballot(bad) != 0 || !(extent_ > 0x1p-100) || !(extent_ < 0x1p100)) return false;
    // 2 to the power of minus the exponent after reach's.
    const long long exponent = __double_as_longlong(reach) >> 52;
    scale_ = __longlong_as_double((2045 - exponent) << 52);
#pragma unroll
    for (unsigned c = 0; c < D; ++c)
      for (unsigned i = lane_; i < count_; i += lanes)
        m_.local[c * m_.most + i] =
            __double2float_rn((m_.place[c * m_.most + i] - middle_[c]) * scale_);
    for (unsigned i = lane_; i < WarpMemory<D>::edge_words(m_.most); i += lanes) m_.edges[i] = 0;
    __syncwarp();
    return true;
  }

  __device__ float local(unsigned c, unsigned i) const { return m_.local[c * m_.most + i]; }
  __device__ double place(unsigned c, unsigned i) const { return m_.place[c * m_.most + i]; }

  /// The first point with the largest value, none of which is negative.
  template <class Value>
  __device__ unsigned farthest(const Value& value) const {
    unsigned long long best = 0;
    for (unsigned i = lane_; i < count_; i += lanes) {
      const unsigned long long key =
          static_cast<unsigned long long>(__float_as_uint(value(i))) << 32 | (none - i);
      best = key > best ? key : best;
    }
#pragma unroll
    for (int apart = lanes / 2; apart > 0; apart /= 2) {
      const unsigned long long other = __shfl_xor_sync(0xFFFFFFFFU, best, apart);
      best = other > best ? other : best;
    }
    return none - static_cast<unsigned>(best);
  }

  /// By descending distance from the middle, so that few inner points become vertices for a time.
  __device__ void outermost_first() {
    std::uint32_t* const key = m_.corners;  // facets come later
    for (unsigned i = lane_; i < count_; i += lanes) {
      float square = 0;
#pragma unroll
      for (unsigned c = 0; c < D; ++c) square += local(c, i) * local(c, i);
      key[i] = __float_as_uint(square);
    }
    __syncwarp();
    for (unsigned i = lane_; i < count_; i += lanes) {
      unsigned rank = 0;
      for (unsigned j = 0; j < count_; ++j)
        rank += key[j] > key[i] || (key[j] == key[i] && j < i) ? 1 : 0;
      m_.order[rank] = static_cast<std::uint8_t>(i);
    }
    __syncwarp();
  }

  /// D + 1 points far from one another, and their facets.
  __device__ bool start() {
    const float* const along = m_.local + longest_ * m_.most;
    unsigned a = farthest([&](unsigned i) { return 2.0F - along[i]; });
    unsigned b = farthest([&](unsigned i) { return 2.0F + along[i]; });
    float e[D];
#pragma unroll
    for (unsigned c = 0; c < D; ++c) e[c] = local(c, b) - local(c, a);
    if constexpr (D == 2) {
      const unsigned c = farthest([&](unsigned i) {
        return fabsf(e[0] * (local(1, i) - local(1, a)) - e[1] * (local(0, i) - local(0, a)));
      });
      const int sign = side(a << 8 | b, c);
      if (sign == 0) return false;
      begin(sign > 0 ? b | a << 8 | c << 16 : a | b << 8 | c << 16, 0);
      if (lane_ < 3) {
        const unsigned to = lane_ == 2 ? 0 : lane_ + 1;
        create(lane_, start_ >> 8 * lane_ & 0xFF, start_ >> 8 * to & 0xFF, 0);
      }
    } else {
      const auto normal = [&](unsigned i, float(&n)[3]) {
        const float x = local(0, i) - local(0, a), y = local(1, i) - local(1, a),
                    z = local(2, i) - local(2, a);
        n[0] = e[1] * z - e[2] * y;
        n[1] = e[2] * x - e[0] * z;
        n[2] = e[0] * y - e[1] * x;
      };
      const unsigned c = farthest([&](unsigned i) {
        float n[3];
        normal(i, n);
        return n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
      });
      float n[3];
      normal(c, n);
      const unsigned d = farthest([&](unsigned i) {
        return fabsf(n[0] * (local(0, i) - local(0, a)) + n[1] * (local(1, i) - local(1, a)) +
                     n[2] * (local(2, i) - local(2, a)));
      });
      const int sign = side(a << 16 | b << 8 | c, d);
      if (sign == 0) return false;
      // d is below (a, b, c). Facet f lacks corner f: the others counter-clockwise from outside,
      // two bits each.
      begin(sign > 0 ? b | a << 8 | c << 16 : a | b << 8 | c << 16, d << 24);
      constexpr unsigned others =
          0b10'01'00 << 18 | 0b01'11'00 << 12 | 0b11'10'00 << 6 | 0b10'11'01;
      if (lane_ < 4) {
        const unsigned mine = others >> 6 * lane_;
        create(lane_, start_ >> 8 * (mine & 3) & 0xFF, start_ >> 8 * (mine >> 2 & 3) & 0xFF,
               start_ >> 8 * (mine >> 4 & 3) & 0xFF);
      }
    }
    __syncwarp();
    return true;
  }

  __device__ void begin(unsigned three, unsigned last) {
    start_ = three | last;
    top_ = D + 1;
    spares_ = 0;
  }

  // ------------------------------------------------------------------------------------ signs

  __device__ static unsigned corner(std::uint32_t key, unsigned j) {
    return key >> 8 * (D - 1 - j) & 0xFF;
  }

  /// The side of a facet's plane on which p is: 1 above, -1 beneath, 0 not known.
  __device__ int side(std::uint32_t key, unsigned p) const {
    constexpr double error = determinant_error(D);
    const unsigned a = corner(key, 0);
    double sum, bound = error * extent_;
    if constexpr (D == 2) {
      const unsigned b = corner(key, 1);
      const double x = place(0, b) - place(0, a), y = place(1, b) - place(1, a);
      bound *= larger(x, y);
      sum = y * (place(0, p) - place(0, a)) - x * (place(1, p) - place(1, a));
    } else {
      const unsigned b = corner(key, 1), c = corner(key, 2);
      const double ux = place(0, b) - place(0, a), uy = place(1, b) - place(1, a),
                   uz = place(2, b) - place(2, a);
      const double vx = place(0, c) - place(0, a), vy = place(1, c) - place(1, a),
                   vz = place(2, c) - place(2, a);
      bound *= larger(larger(ux, uy), uz);
      bound *= larger(larger(vx, vy), vz);
      sum = (uy * vz - uz * vy) * (place(0, p) - place(0, a)) +
            (uz * vx - ux * vz) * (place(1, p) - place(1, a)) +
            (ux * vy - uy * vx) * (place(2, p) - place(2, a));
    }
    bound += tiny;
    return sum > bound ? 1 : sum < -bound ? -1 : 0;
  }

  __device__ static double larger(double x, double y) {
    const double a = fabs(x), b = fabs(y);
    return a > b ? a : b;
  }

  /// -1, 0 or 1 as `side`, first in f32.
  __device__ int quick_side(unsigned f, unsigned p) const {
    float s = -m_.plane[D * m_.slots + f];
#pragma unroll
    for (unsigned c = D; c-- > 0;) s = __fmaf_rn(m_.plane[c * m_.slots + f], local(c, p), s);
    return s > doubt ? 1 : s < -doubt ? -1 : side(m_.corners[f], p);
  }

  // ------------------------------------------------------------------------------------ facets

  /// The direction from a to v, divided by a power of two so that it is at most 1.
  __device__ void direction(unsigned a, unsigned v, double (&d)[D]) const {
    double reach = 0;
#pragma unroll
    for (unsigned c = 0; c < D; ++c) {
      d[c] = place(c, v) - place(c, a);
      reach = larger(d[c], reach);
    }
    const long long exponent = __double_as_longlong(reach) & 0x7FFLL << 52;
    const double factor = __longlong_as_double((0x7FDLL << 52) - exponent);
#pragma unroll
    for (unsigned c = 0; c < D; ++c) d[c] *= factor;
  }

  /// Facet (a, b, c), or in the plane the edge (a, b). One lane's work.
  __device__ void create(unsigned slot, unsigned a, unsigned b, unsigned c) {
    double normal[D];
    if constexpr (D == 2) {
      double u[2];
      direction(a, b, u);
      normal[0] = u[1];
      normal[1] = -u[0];
      m_.corners[slot] = a << 8 | b;
    } else {
      double u[3], v[3];
      direction(a, b, u);
      direction(a, c, v);
      normal[0] = u[1] * v[2] - u[2] * v[1];
      normal[1] = u[2] * v[0] - u[0] * v[2];
      normal[2] = u[0] * v[1] - u[1] * v[0];
      m_.corners[slot] = a << 16 | b << 8 | c;
    }
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
    m_.corners[slot] = none;
  }

  /// Replaces the facets that p sees. False where a sign is not known.
  __device__ bool insert(unsigned p) {
    bool starts = false;
#pragma unroll
    for (unsigned j = 0; j <= D; ++j) starts = starts || (start_ >> 8 * j & 0xFF) == p;
    if (starts) return true;
    bool known = true;
    unsigned seen = 0;
    for (unsigned base = 0; base < top_; base += lanes) {
      const unsigned f = base + lane_;
      const int sign = f < top_ ? quick_side(f, p) : -1;
      known = known && sign != 0;
      const unsigned word = ballot(sign > 0);
      if (sign > 0) m_.visible[seen + __popc(word & below_)] = static_cast<std::uint8_t>(f);
      seen += __popc(word);
    }
    if (ballot(!known) != 0) return false;
    if (seen == 0) return true;
    __syncwarp();
    const unsigned edges = D == 2 ? horizon_in_plane(seen, p) : horizon_in_space(seen);
    replace(p, seen, edges);
    return true;
  }

  __device__ void mark(unsigned row, unsigned bit) {
    atomicOr(m_.edges + row * (m_.most / 32) + bit / 32, 1U << bit % 32);
  }
  __device__ bool marked(unsigned row, unsigned bit) const {
    return (m_.edges[row * (m_.most / 32) + bit / 32] >> bit % 32 & 1) != 0;
  }
  __device__ void unmark(unsigned row, unsigned bit) {
    m_.edges[row * (m_.most / 32) + bit / 32] = 0;
  }

  /// Lists the edges of what is seen whose other side is not; returns how many.
  __device__ unsigned horizon_in_space(unsigned seen) {
    for (unsigned i = lane_; i < seen; i += lanes) {
      const std::uint32_t key = m_.corners[m_.visible[i]];
      const unsigned a = corner(key, 0), b = corner(key, 1), c = corner(key, 2);
      mark(a, b);
      mark(b, c);
      mark(c, a);
    }
    __syncwarp();
    unsigned edges = 0;
    for (unsigned base = 0; base < seen; base += lanes) {
      const unsigned i = base + lane_;
      const std::uint32_t key = i < seen ? m_.corners[m_.visible[i]] : 0;
      const unsigned a = corner(key, 0), b = corner(key, 1), c = corner(key, 2);
      edges = list_edge(i < seen && !marked(b, a), a, b, edges);
      edges = list_edge(i < seen && !marked(c, b), b, c, edges);
      edges = list_edge(i < seen && !marked(a, c), c, a, edges);
    }
    __syncwarp();
    for (unsigned i = lane_; i < seen; i += lanes) {
      const std::uint32_t key = m_.corners[m_.visible[i]];
      const unsigned a = corner(key, 0), b = corner(key, 1), c = corner(key, 2);
      unmark(a, b);
      unmark(b, c);
      unmark(c, a);
    }
    __syncwarp();
    return edges;
  }

  __device__ unsigned list_edge(bool listed, unsigned a, unsigned b, unsigned edges) {
    const unsigned word = ballot(listed);
    if (listed) m_.horizon[edges + __popc(word & below_)] = static_cast<std::uint16_t>(a << 8 | b);
    return edges + __popc(word);
  }

  /// The two new edges: from where what is seen begins to p, and from p to where it ends.
  __device__ unsigned horizon_in_plane(unsigned seen, unsigned p) {
    for (unsigned i = lane_; i < seen; i += lanes) {
      const std::uint32_t key = m_.corners[m_.visible[i]];
      mark(0, corner(key, 0));
      mark(1, corner(key, 1));
    }
    __syncwarp();
    for (unsigned i = lane_; i < seen; i += lanes) {
      const std::uint32_t key = m_.corners[m_.visible[i]];
      const unsigned from = corner(key, 0), to = corner(key, 1);
      if (!marked(1, from)) m_.horizon[0] = static_cast<std::uint16_t>(from << 8 | p);
      if (!marked(0, to)) m_.horizon[1] = static_cast<std::uint16_t>(p << 8 | to);
    }
    __syncwarp();
    for (unsigned i = lane_; i < WarpMemory<D>::edge_words(m_.most); i += lanes) m_.edges[i] = 0;
    __syncwarp();
    return 2;
  }

  /// As many new facets as edges, first in the slots of what was seen.
  __device__ void replace(unsigned p, unsigned seen, unsigned edges) {
    for (unsigned i = lane_; i < edges || i < seen; i += lanes) {
      unsigned slot;
      if (i < seen)
        slot = m_.visible[i];
      else if (i - seen < spares_)
        slot = m_.spare[spares_ - 1 - (i - seen)];
      else
        slot = top_ + (i - seen - spares_);
      if (i < edges) {
        const unsigned edge = m_.horizon[i];
        if constexpr (D == 2)
          create(slot, edge >> 8, edge & 0xFF, 0);
        else
          create(slot, p, edge >> 8, edge & 0xFF);
      } else {
        remove(slot);
        m_.spare[spares_ + (i - edges)] = static_cast<std::uint8_t>(slot);
      }
    }
    if (edges > seen) {
      const unsigned more = edges - seen, old = more < spares_ ? more : spares_;
      spares_ -= old;
      top_ += more - old;
    } else {
      spares_ += seen - edges;
    }
    __syncwarp();
  }

  // ------------------------------------------------------------------------------------ the result

  __device__ unsigned write(std::uint8_t* vertices, std::uint8_t* simplices) {
    // The first row of edges, all bits of which are 0 again, becomes the set of vertices.
    for (unsigned f = lane_; f < top_; f += lanes) {
      const std::uint32_t key = m_.corners[f];
      if (key == none) continue;
#pragma unroll
      for (unsigned j = 0; j < D; ++j) mark(0, corner(key, j));
    }
    __syncwarp();
    const unsigned simplex_count = top_ - spares_;
    if constexpr (D == 2) {
      write_cycle(vertices, simplices);
      return simplex_count | simplex_count << 8;
    } else {
      const unsigned vertex_count = write_ids(vertices);
      write_sorted(simplices);
      return vertex_count | simplex_count << 8;
    }
  }

  __device__ unsigned write_ids(std::uint8_t* vertices) const {
    unsigned before = 0;
    for (unsigned base = 0; base < count_; base += lanes) {
      const std::uint32_t word = m_.edges[base / 32];
      if ((word >> lane_ & 1) != 0)
        vertices[before + __popc(word & below_)] = static_cast<std::uint8_t>(base + lane_);
      before += __popc(word);
    }
    return before;
  }

  /// Each simplex from its lowest corner, the simplices ascending.
  __device__ void write_sorted(std::uint8_t* simplices) {
    for (unsigned f = lane_; f < top_; f += lanes) {
      const std::uint32_t key = m_.corners[f];
      if (key == none) continue;
      const std::uint32_t next = (key << 8 | key >> 16) & 0xFFFFFF,
                          last = (key << 16 | key >> 8) & 0xFFFFFF;
      const std::uint32_t least = next < last ? next : last;
      m_.corners[f] = key < least ? key : least;
    }
    __syncwarp();
    for (unsigned f = lane_; f < top_; f += lanes) {
      const std::uint32_t key = m_.corners[f];
      if (key == none) continue;
      unsigned rank = 0;
      for (unsigned g = 0; g < top_; ++g) rank += m_.corners[g] < key ? 1 : 0;
#pragma unroll
      for (unsigned j = 0; j < 3; ++j)
        simplices[3 * rank + j] = static_cast<std::uint8_t>(corner(key, j));
    }
  }

  /// Vertices counter-clockwise from the lowest; an edge a vertex, by ascending ids: the vertex and
  /// the one before it.
  __device__ void write_cycle(std::uint8_t* vertices, std::uint8_t* simplices) {
    std::uint8_t *const before = m_.visible, *const after = m_.spare;
    // `spare` lists the slots that are not in use, which nobody needs any more.
    for (unsigned f = lane_; f < top_; f += lanes) {
      const std::uint32_t key = m_.corners[f];
      if (key == none) continue;
      after[corner(key, 0)] = static_cast<std::uint8_t>(corner(key, 1));
      before[corner(key, 1)] = static_cast<std::uint8_t>(corner(key, 0));
    }
    __syncwarp();
    unsigned rank = 0, lowest = none;
    for (unsigned base = 0; base < count_; base += lanes) {
      const std::uint32_t word = m_.edges[base / 32];
      if ((word >> lane_ & 1) != 0) {
        const unsigned at = 2 * (rank + __popc(word & below_));
        simplices[at] = static_cast<std::uint8_t>(base + lane_);
        simplices[at + 1] = before[base + lane_];
      }
      if (lowest == none && word != 0) lowest = base + static_cast<unsigned>(__ffs(word)) - 1;
      rank += __popc(word);
    }
    // A list's ranks one after another: there are few.
    if (lane_ == 0)
      for (unsigned k = 0, v = lowest; k < rank; ++k, v = after[v])
        vertices[k] = static_cast<std::uint8_t>(v);
  }

  const WarpMemory<D> m_;
  const unsigned count_, lane_, below_;
  double middle_[D], extent_, scale_;
  unsigned longest_, start_, top_, spares_;
};

}  // namespace cullhull::internal
