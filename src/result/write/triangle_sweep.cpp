// The inner loops of the result in 3D. They are compiled for several instruction sets, of which one
// is chosen at run time.

#include "result/write/triangle_sweep.hpp"

#include "parallel/prefetch.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "result/write/triangle_sweep.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstring>

#include "exact/determinants/cofactors.hpp"
#include "result/facets/facet_lanes-inl.hpp"
#include "result/facets/facet_plane.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

using Id = std::uint32_t;

constexpr unsigned row_stride = Shared3D::row_stride;
static_assert(row_stride == 4);  // rows are read as vectors of four

/// The data of facets that are processed together. 16 facets fit the L1 cache; 32 did not, and were
/// slower.
struct Batch {
  static constexpr unsigned size = 16;
  alignas(64) double corner[3][size * 4];  // rows of the facets' corners
  alignas(64) double across[3][size * 4];  // rows of the neighbours' vertices off the ridges
  alignas(64) double normal[size * 4];
  alignas(64) double sum[size * 4];
  Id across_id[3][size];
  struct alignas(32) Numbers {  // as in TriangleRecord
    Id vertex[3], slot, neighbour[3], thin;
  } numbers[size];
  Id slot[size];
};

/// The work of sweep_triangles: collects batches of facets, computes with vectors, and writes
/// records.
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
      for (unsigned k = count; k % lane_count() != 0; ++k) repeat_last(k);
      for (unsigned k = 0; k < count; k += lane_count()) compute(k, count);
      for (unsigned k = 0; k < count; ++k) write(k);
    }
    return true;
  }

 private:
  /// 1 if a < b, else 0; without a branch, since comparisons of ids are unpredictable.
  static HWY_INLINE std::uint64_t below(Id a, Id b) {
    return (std::uint64_t{a} - std::uint64_t{b}) >> 63;
  }

  /// Collects numbers and rows of one facet, in stored order, and its neighbours' vertices off the
  /// ridges. The result is not 0 if a ridge does not belong to two facets of the same orientation.
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
      // Detects some pairs of facets that share more than one ridge.
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

  /// Fills place k, to complete a vector, with the data of the facet before.
  void repeat_last(unsigned k) {
    for (unsigned j = 0; j < 3; ++j) {
      std::memcpy(b_.corner[j] + 4 * k, b_.corner[j] + 4 * (k - 1), 32);
      std::memcpy(b_.across[j] + 4 * k, b_.across[j] + 4 * (k - 1), 32);
    }
  }

  /// Computes normals and sums of a vector of facets, from facet k on, as facet_block does, and
  /// tests whether their ridges are convex.
  HWY_INLINE void compute(unsigned k, unsigned count) {
    const D d;
    Lanes corner[3][3], origin[3], edge[2][3], n[3], sum[3];
    for (unsigned c = 0; c < 3; ++c) origin[c] = s_.origin[c];
    for (unsigned j = 0; j < 3; ++j) load_scaled(b_.corner[j] + 4 * k, corner[j]);
    edges_of<3>(corner, edge);
    cofactors<3>(edge, n);
    sum_of_corners<3>(corner, origin, sum);
    const Lanes edges = root(square_of<3>(edge[0])) * root(square_of<3>(edge[1]));
    const Lanes reach = largest_of<3>(edge[0]) * largest_of<3>(edge[1]);
    const Lanes length = root(square_of<3>(n));
    store_rows(n, length, b_.normal + 4 * k);
    store_rows(sum, length, b_.sum + 4 * k);
    const unsigned thin = ~bits_of(length > conditioned * edges);
    for (unsigned i = 0; i < lane_count() && k + i < count; ++i)
      b_.numbers[k + i].thin = thin >> i & 1U;

    // The normals point outward, so the side is negative if the ridge is convex.
    const Lanes relative = reach * (s_.exact_doubles ? 0 : -determinant_error(3));
    const Lanes tiny = s_.exact_doubles ? 0 : -determinant_tiny;
    for (unsigned j = 0; j < 3; ++j) {
      Lanes x[3];
      load_scaled(b_.across[j] + 4 * k, x);
      for (unsigned c = 0; c < 3; ++c) x[c] = x[c] - corner[0][c];
      const Lanes side = n[0] * x[0] + n[1] * x[1] + n[2] * x[2];
      const M convex = side < relative * largest_of<3>(x) + tiny;
      if (HWY_UNLIKELY(!hn::AllTrue(d, convex))) keep_open(k, count, j, ~bits_of(convex));
    }
  }

  HWY_INLINE void load_scaled(const double* rows, Lanes (&v)[3]) const {
    load_rows(rows, v);
    for (unsigned c = 0; c < 3; ++c) v[c] = v[c] * s_.factor[c];
  }

  /// Appends the undecided ridges to open_, each only from its facet with the lower number.
  HWY_NOINLINE void keep_open(unsigned k, unsigned count, unsigned j, unsigned lanes) {
    for (unsigned i = 0; i < lane_count() && k + i < count; ++i)
      if ((lanes >> i & 1U) != 0 && b_.slot[k + i] < b_.numbers[k + i].neighbour[j])
        open_.push_back({b_.slot[k + i], b_.across_id[j][k + i]});
  }

  /// Writes the record of facet k to its bucket.
  HWY_INLINE void write(unsigned k) {
    const Batch::Numbers& numbers = b_.numbers[k];
    auto* to = reinterpret_cast<unsigned char*>(region_ + next_[numbers.vertex[0] >> shift_]++);
    std::memcpy(to, b_.normal + 4 * k, 32);  // the last 8 bytes are overwritten next
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
  alignas(64) double normals[4 * shares_at_once], sums[4 * shares_at_once],
      corners[4 * shares_at_once];
  std::uint32_t left = 0;
  for (unsigned k = 0; k < count; ++k) {
    const TriangleRecord& r = *records[k];
    std::memcpy(normals + 4 * k, r.normal, 32);
    std::memcpy(sums + 4 * k, r.sum, 32);
    std::memcpy(corners + 4 * k, vertices + std::size_t{r.vertex[0]} * 3, 24);
    left |= std::uint32_t{r.thin} << k;
  }
  for (unsigned k = count; k % lane_count() != 0; ++k) {
    std::memcpy(normals + 4 * k, normals + 4 * k - 4, 32);
    std::memcpy(sums + 4 * k, sums + 4 * k - 4, 32);
    std::memcpy(corners + 4 * k, corners + 4 * k - 4, 32);
  }
  const Lanes origin[3] = {from[0], from[1], from[2]};
  for (unsigned k = 0; k < count; k += lane_count()) {
    Lanes n[3], sum[3], corner[3];
    load_rows(normals + 4 * k, n);
    load_rows(sums + 4 * k, sum);
    load_rows(corners + 4 * k, corner);
    write_shares(n, root(square_of<3>(n)), corner, origin, sum, unit, k, shares, planes);
    const Lanes most = largest_of<3>(n);
    const M usual = hn::And(most > 0x1p-400, most < 0x1p400);
    if (HWY_UNLIKELY(!hn::AllTrue(d, usual)))
      left |= (~bits_of(usual) & ((1U << lane_count()) - 1)) << k;
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
    // Prefetches the data that sweep_triangles reads for these facets, and the lines it writes.
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
