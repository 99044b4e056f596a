// What files of groups have in common: a record for each group, named by its key.
#pragma once

#include <chrono>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cullhull/group_hulls.hpp"
#include "io/formats/geometry_text.hpp"
#include "io/groups/collected.hpp"
#include "io/json/json_writer.hpp"
#include "io/write/output_file.hpp"
#include "parallel/memory/memory.hpp"

namespace cullhull::internal {

/// The format of a file of groups. Throws Error{invalid_argument} for another one.
std::string checked_format(const std::string& path, const std::string& format);

/// The key's name in the output: its own, or "column" and its number.
std::string name_of_key(const std::string& key);

/// One kind of file: how its members and columns are called.
struct GroupKind {
  std::string_view document;             ///< the kind of the JSON document
  const char* shapes;                    ///< "hulls", for messages
  const char* limit = nullptr;           ///< the name of GroupRecord::limit, where there is one
  std::vector<const char*> counts = {};  ///< the names of GroupRecord::counts, in .csv
};

/// What a file tells of one group. Numbers are in world units.
struct GroupRecord {
  std::string_view key;
  bool numeric = false;
  std::size_t number = 0;                     ///< among all groups
  std::span<const PointColumn> columns = {};  ///< of which the group has the value `number`
  std::uint64_t points = 0;
  int affine_dimension = 0;
  double limit = 0;  ///< alpha, or the length of edges
  std::vector<std::uint64_t> counts{};
  double area = 0, volume = 0;                    ///< named as put_measures() does
  std::function<PlanePolygons()> polygons{};      ///< asked for in the plane alone
  std::function<void(JsonWriter& json)> lists{};  ///< writes the members that are lists
};

/// Writes a file of groups, record by record; it appears once it is committed.
class GroupFile {
 public:
  /// `format`: as checked_format() returns it.
  GroupFile(const std::string& path, std::string format, std::string key_name,
            const GroupKind& kind, const JsonPoints& points, const MapExtras& extras);
  void add(const GroupRecord& group);
  void commit();

 private:
  bool plane() const { return points_.dimension == 2; }
  std::pair<double, double> measures_of(const GroupRecord& group) const;
  void append_key(const GroupRecord& group);
  void append_feature(const GroupRecord& group);
  void append_row(const GroupRecord& group);
  void write_record(const GroupRecord& group);

  JsonPoints points_;
  std::string format_, key_name_;
  GroupKind kind_;
  OutputFile out_;
  std::string text_;
  JsonWriter json_;
  bool first_ = true;
};

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
