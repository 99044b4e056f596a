// The inner loops of the result in 3D, where every facet is a triangle: a vector of facets at a
// time. docs/exactness.md, "Ridges".
#pragma once

#include <cstdint>
#include <vector>

#include "hull/space/insertion_3d.hpp"
#include "result/measures/totals.hpp"

namespace cullhull::internal::inline result {

/// The data of a facet for the second sweep. Vertices by position, in stored order: the lowest
/// first, counter-clockwise seen from outside.
struct TriangleRecord {
  double normal[3];  // as `cofactors` computes it, bit for bit
  double sum[3];     // of the corners' differences from vertex 0
  std::uint32_t vertex[3];
  std::uint32_t slot;          // the engine's number of the facet
  std::uint32_t neighbour[3];  // their slots; entry j lies across the ridge without vertex j
  std::uint32_t thin;          // nonzero: the normal must be computed with more bits
};
static_assert(sizeof(TriangleRecord) == 80);

/// A ridge whose side doubles did not decide: the facet, and the neighbour's vertex off it.
struct OpenRidge {
  std::uint32_t facet, across;  // vertex numbers of the engine
};

/// The engine's facets, and the frame's coordinates: row i times `factor`, exactly.
struct TriangleSource {
  const Facet3D* facets = nullptr;
  const std::uint32_t* place = nullptr;  // by vertex number: the position in the hull
  const double* rows = nullptr;          // Shared3D::row_stride apart
  double factor[3] = {1, 1, 1};
  double origin[3] = {0, 0, 0};  // the frame's vertex 0
  bool exact_doubles = false;    // no operation on differences rounds (small lattices)
};

/// Counts the live facets of slots [begin, end) by bucket: the position of the lowest vertex,
/// shifted right by `shift`. Returns their number.
std::uint32_t count_triangles(const TriangleSource& source, std::uint32_t begin, std::uint32_t end,
                              unsigned shift, std::uint32_t* counts, const void* region);

/// Writes the records of the same facets to region[next[bucket]++]. Returns false if a ridge does
/// not belong to two facets of the same orientation; ridges that are not certainly convex are
/// appended to `open`, once.
bool sweep_triangles(const TriangleSource& source, std::uint32_t begin, std::uint32_t end,
                     unsigned shift, std::uint32_t* next, TriangleRecord* region,
                     std::vector<OpenRidge>& open);

inline constexpr unsigned shares_at_once = 32;
using TriangleShares = ShareArrays<shares_at_once>;

/// The shares and planes of at most `shares_at_once` facets, as facet_share computes them, bit for
/// bit; `vertices`: rows of the frame, three doubles each; `unit`: a power of two. Returns a bit
/// mask of the facets that facet_share must compute. Planes are written for whole vectors: to
/// planes[0 .. 128).
std::uint32_t triangle_shares(const TriangleRecord* const* records, unsigned count,
                              const double* vertices, const double* origin, double unit,
                              TriangleShares& shares, double* planes);

}  // namespace cullhull::internal::inline result
