// The inner loops of the result in 3D, where every facet is a triangle. They process a vector of
// facets at a time. docs/exactness.md, "Ridges".
#pragma once

#include <cstdint>
#include <vector>

#include "hull/space/insertion_3d.hpp"
#include "result/measures/totals.hpp"

namespace cullhull::internal {

/// The data of a facet for the second sweep. Vertices are given by their positions in the hull and
/// in stored order: lowest first, counter-clockwise seen from outside.
struct TriangleRecord {
  double normal[3];  // with the bits that `cofactors` computes
  double sum[3];     // sum of the corners' differences from the hull's vertex 0
  std::uint32_t vertex[3];
  std::uint32_t slot;          // the engine's number of the facet
  std::uint32_t neighbour[3];  // slots; neighbour j lies across the ridge without vertex j
  std::uint32_t thin;          // nonzero: the normal must be computed with more bits
};
static_assert(sizeof(TriangleRecord) == 80);

/// A ridge whose convexity doubles could not decide: a facet, and its neighbour's vertex off the
/// ridge.
struct OpenRidge {
  std::uint32_t facet, across;  // vertex numbers of the engine
};

/// The engine's facets and the coordinates of their vertices. Rows times `factor` are the frame's
/// coordinates, exactly.
struct TriangleSource {
  const Facet3D* facets = nullptr;
  const std::uint32_t* place = nullptr;  // position in the hull of each vertex number
  const double* rows = nullptr;          // Shared3D::row_stride apart
  double factor[3] = {1, 1, 1};
  double origin[3] = {0, 0, 0};  // the frame's vertex 0
  bool exact_doubles = false;    // no operation on differences rounds (small lattices)
};

/// Counts the live facets in slots [begin, end), adding to counts[bucket]; the bucket is the
/// position of the lowest vertex, shifted right by `shift`. Returns their number. Also prefetches
/// data for sweep_triangles, among them `region`, which it does not access.
std::uint32_t count_triangles(const TriangleSource& source, std::uint32_t begin, std::uint32_t end,
                              unsigned shift, std::uint32_t* counts, const void* region);

/// Writes the records of the same facets to region[next[bucket]++], and appends each ridge that is
/// not certainly convex to `open`, once. Returns false if a ridge does not belong to two facets of
/// the same orientation.
bool sweep_triangles(const TriangleSource& source, std::uint32_t begin, std::uint32_t end,
                     unsigned shift, std::uint32_t* next, TriangleRecord* region,
                     std::vector<OpenRidge>& open);

/// The most facets of one call of triangle_shares: a run of the sums.
inline constexpr unsigned shares_at_once = 32;
using TriangleShares = ShareArrays<shares_at_once>;

/// Computes shares and planes of `count` <= `shares_at_once` facets, with the bits of facet_share.
/// `vertices`: rows of the frame, three doubles each; `unit`: the power of two that scales the
/// planes' offsets. Returns a bit mask of the facets that facet_share must compute instead. Writes
/// planes of whole vectors, so `planes` needs room for 128 doubles.
std::uint32_t triangle_shares(const TriangleRecord* const* records, unsigned count,
                              const double* vertices, const double* origin, double unit,
                              TriangleShares& shares, double* planes);

}  // namespace cullhull::internal
