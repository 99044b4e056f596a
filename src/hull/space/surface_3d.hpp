// What the 3D engine leaves: its own facets and numbers, in which neighbours lie near one another
// in memory. The result of a hull with millions of facets is made from this; everybody else takes
// the SimplicialHull.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/orientation_3d.hpp"
#include "hull/engine.hpp"
#include "hull/space/insertion_3d.hpp"
#include "parallel/big_array.hpp"
#include "parallel/control.hpp"
#include "parallel/raw_array.hpp"

namespace cullhull::internal {

struct Surface3D {
  using Run = std::pair<std::uint32_t, std::uint32_t>;

  RawArray<Facet3D> facets;
  /// Ranges of slots, ascending and not adjoining, that were ever used: facets in them may be live
  /// or dead, elsewhere there is nothing.
  std::vector<Run> used;
  std::uint64_t live = 0;                   ///< facets
  BigArray<std::uint32_t> order;            ///< local id of each vertex number
  BigArray<double> rows;                    ///< of each, Shared3D::row_stride apart
  std::uint32_t count = 0;                  ///< vertex numbers; not all need be in use
  std::optional<Orientation3D> predicates;  ///< of the local points; refers to them
  /// As in SimplicialHull.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> duplicates;
  std::uint64_t rung_counts[3] = {0, 0, 0};

  /// The used slots in runs of at most `length`.
  std::vector<Run> runs(std::uint32_t length) const;
};

/// As hull_3d.
Surface3D surface_3d(const LocalPoints& points, const std::uint32_t* simplex, std::uint64_t budget,
                     unsigned threads, const Control& control);

/// The facets numbered by ascending slot, with local ids.
SimplicialHull to_simplicial(Surface3D&& surface, unsigned threads, const Control& control);

/// The other way, for another engine's facets; throws Error{not_exact} where they refer to points
/// or facets that do not exist.
Surface3D to_surface(const SimplicialHull& hull, const LocalPoints& points, unsigned threads,
                     const Control& control);

}  // namespace cullhull::internal
