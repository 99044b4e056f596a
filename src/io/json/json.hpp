// The two documents of a hull: the canonical result (a file), and the report of a run (times,
// threads, ...).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cullhull/hull_fwd.hpp"
#include "io/coordinates.hpp"
#include "io/json/json_writer.hpp"

namespace cullhull::internal {

/// The result alone: the same bytes for every thread count, filter and backend.
void write_result_json(const Coordinates& points, const Hull& hull, const TextSink& sink,
                       const ItemSink& items = {});

struct JsonExtras {
  double read_seconds = 0;
  /// Times of all runs if there were several; the hull's statistics describe the median run.
  std::vector<double> compute_seconds_all{};
  std::uint64_t peak_bytes = 0;
  /// Set if a certificate was requested.
  std::optional<bool> certified{};
};

/// The run's report as JSON; docs/formats.md lists the keys.
std::string hull_to_json(const Hull& hull, const JsonExtras& extras);

}  // namespace cullhull::internal
