// The result in space of a surface that doubles prove to be the hull, before it becomes a Hull.
#pragma once

#include <cstdint>

#include "cullhull/array.hpp"
#include "cullhull/hull_fwd.hpp"
#include "cullhull/point_view.hpp"
#include "result/measures/share.hpp"

namespace cullhull::internal {

struct Run;
/// The lists of a hull in space whose facets are triangles, in canonical order. Vertices are
/// numbered by ascending id.
struct TriangleLists {
  Array<std::uint32_t> vertices;    ///< three a triangle
  Array<std::uint32_t> neighbours;  ///< opposite to each of them
  Array<double> planes;             ///< four numbers a triangle
  Share<3, DoubleDouble> sums;      ///< of all triangles, in units of 2^exponent
  int exponent = 0;
  double first[3] = {};  ///< vertex 0, as given

  bool empty() const { return vertices.empty(); }
  std::uint32_t count() const { return static_cast<std::uint32_t>(vertices.size() / 3); }
};

/// Fills the measures. False where doubles do not suffice for them.
bool write_measures(const TriangleLists& lists, Hull& hull);

/// Fills the hull, but for its sizes, statistics and coordinates. `points`: the vertices; `ids`:
/// theirs, ascending; null: 0, 1, ...
void write_lists(TriangleLists&& lists, const PointView& points, const std::uint64_t* ids,
                 const Run& run, Hull& hull);

}  // namespace cullhull::internal
