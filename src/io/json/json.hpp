// The two documents of a hull: the canonical result (a file), and the report of a run (times,
// threads,
// ...).
#pragma once

#include "cullhull/hull.hpp"
#include "io/coordinates.hpp"
#include "io/json/json_writer.hpp"

namespace cullhull::internal {

/// The result alone: the same bytes for every thread count, filter and backend.
void write_result_json(const Coordinates& points, const Hull& hull, const TextSink& sink);

}  // namespace cullhull::internal
