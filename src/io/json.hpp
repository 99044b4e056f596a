// The two JSON documents: the canonical result (a file), and the report of a run (times, threads,
// ...).
#pragma once

#include <functional>
#include <string>

#include "cullhull/hull.hpp"
#include "cullhull/io.hpp"
#include "io/coordinates.hpp"

namespace cullhull::internal {

using TextSink = std::function<void(const std::string&)>;

/// The result alone: the same bytes for every thread count, filter and backend.
void write_result_json(const Coordinates& points, const Hull& hull, const TextSink& sink);

}  // namespace cullhull::internal
