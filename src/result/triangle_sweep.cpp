// The inner loops of the result in 3D, compiled once per instruction set and chosen at run time.

#include "result/triangle_sweep.hpp"

#include "parallel/prefetch.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "result/triangle_sweep.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstring>

#include "geometry/cofactors.hpp"
#include "result/facet_plane.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Id = std::uint32_t;
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

constexpr unsigned row_stride = Shared3D::row_stride;
static_assert(row_stride == 4);  // rows are read as vectors of four

struct Triple {
  V x, y, z;
  // Constructors of the compiler's making are not compiled for this target.
  HWY_INLINE Triple() {}
  HWY_INLINE Triple(V x0, V y0, V z0) : x(x0), y(y0), z(z0) {}
};

HWY_INLINE Triple load_rows(const double* rows) {
  Triple t;
  V unused;
  hn::LoadInterleaved4(D(), rows, t.x, t.y, t.z, unused);
  return t;
}
HWY_INLINE Triple times(Triple a, Triple b) {
  return {hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)};
}
HWY_INLINE Triple minus(Triple a, Triple b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Triple plus(Triple a, Triple b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE V square(Triple a) {
  return hn::Add(hn::Add(hn::Mul(a.x, a.x), hn::Mul(a.y, a.y)), hn::Mul(a.z, a.z));
}
HWY_INLINE V largest(Triple a) {
  return hn::Max(hn::Max(hn::Abs(a.x), hn::Abs(a.y)), hn::Abs(a.z));
}
HWY_INLINE Triple constant(const double* v) {
  const D d;
  return {hn::Set(d, v[0]), hn::Set(d, v[1]), hn::Set(d, v[2])};
}
/// Bit i: lane i.
HWY_INLINE unsigned bits_of(M mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(D(), mask, bytes);
  return bytes[0];
}

/// Facets that are worked on together, small enough for the first cache.
struct Batch {
  static constexpr unsigned size = 16;
  alignas(64) double corner[3][size * 4];  // rows
  alignas(64) double across[3][size * 4];  // of the vertices beyond the ridges
  alignas(64) double normal[size * 4];
  alignas(64) double sum[size * 4];
  Id across_id[3][size];
  struct alignas(32) Numbers {  // as in TriangleRecord
    Id vertex[3], slot, neighbour[3], thin;
  } numbers[size];
  Id slot[size];
};

class Sweep {
 public:
  Sweep(const TriangleSource& source, unsigned shift, Id* next, TriangleRecord* region,
        std::vector<OpenRidge>& open)
      : s_(source), shift_(shift), next_(next), region_(region), open_(open) {}

  bool run(Id begin, Id end) {
    for (Id at = begin; at < end;) {
      unsigned count = 0;
      for (; at < end && count < Batch::size; ++at) {
        b_.slot[count] = at;
        count += static_cast<unsigned>(s_.facets[at].live());
      }
      if (count == 0) break;
      Id wrong = 0;
      for (unsigned k = 0; k < count; ++k) wrong |= collect(k);
      if (HWY_UNLIKELY(wrong != 0)) return false;
      for (unsigned k = count; k % hn::Lanes(D()) != 0; ++k) repeat_last(k);
      for (unsigned k = 0; k < count; k += static_cast<unsigned>(hn::Lanes(D()))) compute(k, count);
      for (unsigned k = 0; k < count; ++k) write(k);
    }
    return true;
  }

 private:
  /// 1 if a < b; comparisons of ids are as good as random, and compilers make branches of them.
  static HWY_INLINE std::uint64_t below(Id a, Id b) {
    return (std::uint64_t{a} - std::uint64_t{b}) >> 63;
  }

  /// Numbers and rows of one facet, in stored order, and the vertices beyond its ridges. Not 0:
  /// a ridge does not belong to two facets that are oriented alike.
  HWY_INLINE Id collect(unsigned k) {
    const Facet3D* HWY_RESTRICT const facets = s_.facets;
    const double* HWY_RESTRICT const rows = s_.rows;
    const Id f = b_.slot[k];
    const Facet3D& facet = facets[f];
    const Id* const v = facet.vertices;
    const Id* const n = facet.neighbours;
    const Id* HWY_RESTRICT const places = s_.place;
    const Id first = places[v[0]], second = places[v[1]], third = places[v[2]];
    const std::uint64_t two = below(std::min(second, third), first), three = below(third, second);
    const auto turn = two + (two & three);
    static constexpr unsigned after[3] = {1, 2, 0}, before[3] = {2, 0, 1};
    const std::uint64_t at[3] = {turn, after[turn], before[turn]};
    const Id turned[3] = {v[at[0]], v[at[1]], v[at[2]]};
    Batch::Numbers& out = b_.numbers[k];
    out.slot = f;
    Id wrong = 0;
    for (unsigned j = 0; j < 3; ++j) {
      out.vertex[j] = places[turned[j]];
      std::memcpy(b_.corner[j] + 4 * k, rows + std::size_t{turned[j]} * row_stride, 32);
      const Id g = n[at[j]];
      out.neighbour[j] = g;
      const Facet3D& other = facets[g];
      // Of two facets that share more than one ridge some are found wrong here.
      const std::uint64_t at_one = below(other.neighbours[1] ^ f, 1);
      const std::uint64_t at_two = below(other.neighbours[2] ^ f, 1) & (at_one ^ 1);
      const std::uint64_t back = at_one + 2 * at_two;
      const Id x = other.vertices[back];
      wrong |= other.neighbours[back] ^ f;
      wrong |= other.vertices[after[back]] ^ turned[before[j]];
      wrong |= other.vertices[before[back]] ^ turned[after[j]];
      wrong |= static_cast<Id>(below(Facet3D::none - 1, other.owner));  // dead
      b_.across_id[j][k] = x;
      std::memcpy(b_.across[j] + 4 * k, rows + std::size_t{x} * row_stride, 32);
    }
    return wrong;
  }

  void repeat_last(unsigned k) {
    for (unsigned j = 0; j < 3; ++j) {
      std::memcpy(b_.corner[j] + 4 * k, b_.corner[j] + 4 * (k - 1), 32);
      std::memcpy(b_.across[j] + 4 * k, b_.across[j] + 4 * (k - 1), 32);
    }
  }

  /// Normals, sums and sides of a vector of facets from k on. As facet_block computes them.
  HWY_INLINE void compute(unsigned k, unsigned count) {
    const D d;
    const Triple factor = constant(s_.factor), origin = constant(s_.origin);
    const Triple p = times(load_rows(b_.corner[0] + 4 * k), factor);
    const Triple q = times(load_rows(b_.corner[1] + 4 * k), factor);
    const Triple r = times(load_rows(b_.corner[2] + 4 * k), factor);
    const Triple a = minus(q, p), b = minus(r, p);
    const V edges = hn::Mul(hn::Sqrt(square(a)), hn::Sqrt(square(b)));
    const V reach = hn::Mul(largest(a), largest(b));
    const Triple n = {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
                      hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
                      hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
    const V length = hn::Sqrt(square(n));
    const Triple zero = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    const Triple sum = plus(plus(plus(zero, minus(p, origin)), minus(q, origin)), minus(r, origin));
    hn::StoreInterleaved4(n.x, n.y, n.z, length, d, b_.normal + 4 * k);
    hn::StoreInterleaved4(sum.x, sum.y, sum.z, length, d, b_.sum + 4 * k);
    const unsigned thin = ~bits_of(hn::Gt(length, hn::Mul(hn::Set(d, conditioned), edges)));
    for (unsigned i = 0; i < hn::Lanes(d) && k + i < count; ++i)
      b_.numbers[k + i].thin = thin >> i & 1U;

    // Outward oriented, so the side is negative where the ridge is convex.
    const V relative = hn::Mul(reach, hn::Set(d, s_.exact_doubles ? 0 : -determinant_error(3)));
    const V tiny = hn::Set(d, s_.exact_doubles ? 0 : -determinant_tiny);
    for (unsigned j = 0; j < 3; ++j) {
      const Triple x = minus(times(load_rows(b_.across[j] + 4 * k), factor), p);
      const V side = hn::Add(hn::Add(hn::Mul(n.x, x.x), hn::Mul(n.y, x.y)), hn::Mul(n.z, x.z));
      const M convex = hn::Lt(side, hn::Add(hn::Mul(relative, largest(x)), tiny));
      if (HWY_UNLIKELY(!hn::AllTrue(d, convex))) keep_open(k, count, j, ~bits_of(convex));
    }
  }

  /// From the side of the facet with the lower number.
  HWY_NOINLINE void keep_open(unsigned k, unsigned count, unsigned j, unsigned lanes) {
    for (unsigned i = 0; i < hn::Lanes(D()) && k + i < count; ++i)
      if ((lanes >> i & 1U) != 0 && b_.slot[k + i] < b_.numbers[k + i].neighbour[j])
        open_.push_back({b_.slot[k + i], b_.across_id[j][k + i]});
  }

  HWY_INLINE void write(unsigned k) {
    const Batch::Numbers& numbers = b_.numbers[k];
    auto* to = reinterpret_cast<unsigned char*>(region_ + next_[numbers.vertex[0] >> shift_]++);
    std::memcpy(to, b_.normal + 4 * k, 32);  // the last eight bytes are the next line's
    std::memcpy(to + 24, b_.sum + 4 * k, 32);
    std::memcpy(to + 48, &numbers, 32);
  }

  const TriangleSource& s_;
  const unsigned shift_;
  Id* const next_;
  TriangleRecord* const region_;
  std::vector<OpenRidge>& open_;
  Batch b_;
};

}  // namespace

bool sweep_triangles_in(const TriangleSource& source, Id begin, Id end, unsigned shift, Id* next,
                        TriangleRecord* region, std::vector<OpenRidge>& open) {
  return Sweep(source, shift, next, region, open).run(begin, end);
}

std::uint32_t triangle_shares_in(const TriangleRecord* const* records, unsigned count,
                                 const double* vertices, const double* from, double unit,
                                 TriangleShares& shares, double* planes) {
  const D d;
  alignas(64) double normals[4 * TriangleShares::most], sums[4 * TriangleShares::most],
      corners[4 * TriangleShares::most];
  std::uint32_t left = 0;
  for (unsigned k = 0; k < count; ++k) {
    const TriangleRecord& r = *records[k];
    std::memcpy(normals + 4 * k, r.normal, 32);
    std::memcpy(sums + 4 * k, r.sum, 32);
    std::memcpy(corners + 4 * k, vertices + std::size_t{r.vertex[0]} * 3, 24);
    left |= std::uint32_t{r.thin} << k;
  }
  for (unsigned k = count; k % hn::Lanes(d) != 0; ++k) {
    std::memcpy(normals + 4 * k, normals + 4 * k - 4, 32);
    std::memcpy(sums + 4 * k, sums + 4 * k - 4, 32);
    std::memcpy(corners + 4 * k, corners + 4 * k - 4, 32);
  }
  const Triple origin = constant(from);
  const V zero = hn::Zero(d);
  for (unsigned k = 0; k < count; k += static_cast<unsigned>(hn::Lanes(d))) {
    const Triple n = load_rows(normals + 4 * k), sum = load_rows(sums + 4 * k);
    const Triple p = load_rows(corners + 4 * k);
    const Triple step = minus(p, origin);
    const V area = hn::Sqrt(square(n));
    const V volume = hn::Add(hn::Add(hn::Add(zero, hn::Mul(n.x, step.x)), hn::Mul(n.y, step.y)),
                             hn::Mul(n.z, step.z));
    hn::Store(area, d, shares.area + k);
    hn::Store(area, d, shares.area_error + k);
    hn::Store(volume, d, shares.volume + k);
    hn::Store(hn::Mul(area, largest(step)), d, shares.error + k);
    hn::Store(hn::Mul(volume, sum.x), d, shares.moment[0] + k);
    hn::Store(hn::Mul(volume, sum.y), d, shares.moment[1] + k);
    hn::Store(hn::Mul(volume, sum.z), d, shares.moment[2] + k);
    const V most = largest(n);
    const M usual = hn::And(hn::Gt(most, hn::Set(d, 0x1p-400)), hn::Lt(most, hn::Set(d, 0x1p400)));
    if (HWY_UNLIKELY(!hn::AllTrue(d, usual)))
      left |= (~bits_of(usual) & ((1U << hn::Lanes(d)) - 1)) << k;
    const V x = hn::Div(n.x, area), y = hn::Div(n.y, area), z = hn::Div(n.z, area);
    const V offset =
        hn::Sub(hn::Sub(hn::Sub(zero, hn::Mul(x, p.x)), hn::Mul(y, p.y)), hn::Mul(z, p.z));
    hn::StoreInterleaved4(x, y, z, hn::Mul(offset, hn::Set(d, unit)), d, planes + 4 * k);
  }
  return count < 32 ? left & ((1U << count) - 1) : left;
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(sweep_triangles_in);
HWY_EXPORT(triangle_shares_in);

bool sweep_triangles(const TriangleSource& source, std::uint32_t begin, std::uint32_t end,
                     unsigned shift, std::uint32_t* next, TriangleRecord* region,
                     std::vector<OpenRidge>& open) {
  return HWY_DYNAMIC_DISPATCH(sweep_triangles_in)(source, begin, end, shift, next, region, open);
}

std::uint32_t triangle_shares(const TriangleRecord* const* records, unsigned count,
                              const double* vertices, const double* origin, double unit,
                              TriangleShares& shares, double* planes) {
  return HWY_DYNAMIC_DISPATCH(triangle_shares_in)(records, count, vertices, origin, unit, shares,
                                                  planes);
}

std::uint32_t count_triangles(const TriangleSource& source, std::uint32_t begin, std::uint32_t end,
                              unsigned shift, std::uint32_t* counts, const void* region) {
  std::uint32_t live = 0;
  const auto* to_write = static_cast<const unsigned char*>(region);
  for (std::uint32_t f = begin; f < end; ++f) {
    const Facet3D& facet = source.facets[f];
    if (!facet.live()) continue;
    const std::uint32_t* v = facet.vertices;
    ++counts[std::min({source.place[v[0]], source.place[v[1]], source.place[v[2]]}) >> shift];
    // What the sweep over these facets will look at, and where it will write, all over the region.
    for (unsigned j = 0; j < 3; ++j) {
      prefetch_passing_line(source.facets + facet.neighbours[j]);
      prefetch_passing_line(source.rows + std::size_t{v[j]} * Shared3D::row_stride);
    }
    prefetch_line_to_write(to_write);
    prefetch_line_to_write(to_write + 40);
    to_write += sizeof(TriangleRecord);
    ++live;
  }
  return live;
}

}  // namespace cullhull::internal
#endif
