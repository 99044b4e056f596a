#include "kept_columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <mutex>

#include "cullhull/error.hpp"
#include "cullhull/point_blocks.hpp"
#include "io/groups/collected.hpp"
#include "outputs.hpp"
#include "parallel/memory/memory.hpp"
#include "signals.hpp"

namespace app {

using cullhull::Error;
using cullhull::ErrorCode;

namespace {

/// Splits at commas outside of double quotes, which stay.
std::vector<std::string> items_of(const std::string& keep) {
  std::vector<std::string> items(1);
  bool quoted = false;
  for (const char c : keep) {
    quoted = quoted != (c == '"');
    if (c == ',' && !quoted)
      items.emplace_back();
    else
      items.back() += c;
  }
  return items;
}

/// A column's name as it is written: without quotes, and of a number with a word.
std::string name_of(const std::string& item) {
  if (item.find_first_not_of("0123456789") == std::string::npos) return "column " + item;
  std::string name;
  for (std::size_t i = 0; i < item.size(); ++i) {
    if (item[i] == '"' && (i + 1 == item.size() || item[i + 1] != '"')) continue;
    if (item[i] == '"') ++i;
    name += item[i];
  }
  return name;
}

void require_memory(const RunArguments& run, std::uint64_t bytes) {
  const std::uint64_t budget = run.options().memory_budget;
  if (budget > 0) cullhull::internal::require_budget(budget, bytes, "the columns of --keep");
}

}  // namespace

void add_keep_option(Parser& command, std::string& keep, const std::string& where) {
  command.group("Output");
  needs_value(*command.add_option("--keep", keep,
                                  "Write these columns of INPUT beside the results, by name or\n"
                                  "number: " +
                                      where))
      .type_name("COLUMN,..");
}

void check_keep(const std::string& keep, const std::vector<std::string>& files,
                const std::vector<std::string>& outputs, const std::vector<std::string>& endings,
                std::uint64_t first_id) {
  if (keep.empty()) return;
  if (first_id > 0)
    throw Error(ErrorCode::invalid_argument,
                fmt::format("--keep {}: --first-id and --keep exclude one another", keep));
  for (const std::string& path : outputs)
    if (std::find(endings.begin(), endings.end(), ending_of(path)) == endings.end())
      throw Error(ErrorCode::invalid_argument,
                  fmt::format("--keep {}: {} holds no columns; {} {}", keep, path,
                              fmt::join(endings, " and "), endings.size() > 1 ? "do" : "does"));
  if (outputs.empty())
    throw Error(ErrorCode::invalid_argument,
                fmt::format("--keep {}: needs an output that ends in {}", keep,
                            fmt::join(endings, " or ")));
  for (const std::string& file : files)
    if (file == "-" || ending_of(file) == ".hullstate")
      throw Error(ErrorCode::invalid_argument,
                  fmt::format("--keep {}: reads the inputs once more, which {} does not have", keep,
                              input_name(file)));
}

std::vector<std::string> maps_among(const std::vector<std::string>& outputs) {
  std::vector<std::string> maps;
  for (const std::string& path : outputs)
    if (ending_of(path) == ".geojson") maps.push_back(path);
  return maps;
}

std::vector<cullhull::PointColumn> kept_columns(const std::string& keep,
                                                const InputArguments& input,
                                                const std::vector<std::string>& files,
                                                const RunArguments& run) {
  std::vector<cullhull::PointColumn> columns;
  if (keep.empty()) return columns;
  std::uint64_t bytes = 0;
  for (const std::string& name : items_of(keep)) {
    cullhull::BlockOptions reading;
    reading.read = read_options(input, run.threads, run.memory_bytes());
    reading.read.remark = {};       // told when the points were read
    reading.read.skip_nan = false;  // values are found by the points' ids in the file
    reading.read.key = name;
    reading.read.stop = stop_token();
    std::mutex mutex;
    std::map<std::uint64_t, cullhull::PointKeys> blocks;  // by their first points
    cullhull::BlockVisitor visitor;
    visitor.keyed =
        [&](const cullhull::PointView&, std::uint64_t first, const cullhull::PointKeys& keys) {
      const std::lock_guard lock(mutex);
      bytes += 2 * (keys.text.size() + 8 * keys.size());  // in blocks, then in one piece
      require_memory(run, bytes);
      blocks[first] = keys;
    };
    cancellable([&] { (void)cullhull::visit_blocks(files, visitor, reading); });
    cullhull::PointColumn column;
    column.name = name_of(name);
    column.numeric = true;
    for (auto& [first, keys] : blocks) {
      for (std::size_t i = 0; i < keys.size(); ++i) {
        column.numeric =
            column.numeric && (keys[i].empty() || cullhull::internal::is_json_number(keys[i]));
        column.values.add(keys[i]);
      }
      keys = {};
    }
    bytes -= (column.values.text.size() + 8 * column.values.size());
    columns.push_back(std::move(column));
  }
  return columns;
}

}  // namespace app
