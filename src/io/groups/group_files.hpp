// What files of groups have in common: a record for each group, named by its key.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/group_hulls.hpp"
#include "io/groups/collected.hpp"
#include "io/write/output_file.hpp"
#include "parallel/memory/memory.hpp"

namespace cullhull::internal {

/// Writes and clears a text of more than a megabyte.
void write_if_long(std::string& text, OutputFile& out);

/// The format of a file of groups. Throws Error{invalid_argument} for another one.
std::string checked_format(const std::string& path, const std::string& format);

/// The key's name in the output: its own, or "column" and its number.
std::string name_of_key(const std::string& key);

/// Reads and sorts all points, and their columns; write(collected, sorted, read, report) then
/// writes the file.
template <class Write>
GroupReport write_sorted_groups(const std::vector<std::string>& files, const BlockOptions& reading,
                                const Options& options, const std::vector<PointColumn>& columns,
                                const Write& write) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  CollectedPoints collected(resolve_budget(options.memory_budget));
  const BlockSummary read = collected.read(files, reading);
  const SortedGroups sorted = collected.sort(columns);
  GroupReport report;
  report.points = read.end.points;
  report.skipped = read.end.skipped;
  report.groups = sorted.keys.order.size();
  report.dimension = read.dimension;
  const Clock::time_point sorted_at = Clock::now();
  report.read_seconds = std::chrono::duration<double>(sorted_at - start).count();
  write(collected, sorted, read, report);
  report.hull_seconds = std::chrono::duration<double>(Clock::now() - sorted_at).count();
  return report;
}

}  // namespace cullhull::internal
