// All of the library cullhull::cullhull. Include this header, or only those you need. Files are
// read and written by cullhull/io.hpp, which needs the library cullhull::io.
#pragma once

#include "cullhull/alpha_shape.hpp"
#include "cullhull/array.hpp"
#include "cullhull/batch.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/constrained.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/device_batch.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/error.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/growing_hull.hpp"
#include "cullhull/halfspaces.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/interpolate.hpp"
#include "cullhull/lists.hpp"
#include "cullhull/machine.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/proximity_graphs.hpp"
#include "cullhull/query.hpp"
#include "cullhull/renamed.hpp"
#include "cullhull/simplify.hpp"
#include "cullhull/stop_token.hpp"
#include "cullhull/stream.hpp"
#include "cullhull/track.hpp"
#include "cullhull/triangulation.hpp"
#include "cullhull/triangulation_query.hpp"
#include "cullhull/version.hpp"
#include "cullhull/voronoi.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// What converted options before 1.0; each struct of options has a constructor for this now.
template <class To>
[[deprecated("write To(options), for example TriangulationOptions(options)")]] To run_as(
    const RunOptions& options) {
  return To(options);
}

}  // namespace cullhull
#pragma GCC visibility pop
