#include "arguments.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <optional>
#include <set>

#include "converted.hpp"
#include "cullhull/error.hpp"
#include "cullhull/point_blocks.hpp"
#include "outputs.hpp"
#include "parallel/memory/memory.hpp"
#include "signals.hpp"
#include "terminal.hpp"

namespace app {

using cullhull::Error;
using cullhull::ErrorCode;
using cullhull::PointView;
using cullhull::ScalarType;

namespace {

const std::vector<std::string>& scalar_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    for (int t = 0; t <= static_cast<int>(ScalarType::u32); ++t)
      result.emplace_back(cullhull::scalar_name(static_cast<ScalarType>(t)));
    return result;
  }();
  return names;
}

std::optional<ScalarType> scalar_type(const std::string& name) {
  for (std::size_t t = 0; t < scalar_names().size(); ++t)
    if (scalar_names()[t] == name) return static_cast<ScalarType>(t);
  return std::nullopt;
}

}  // namespace

std::uint64_t parse_size(std::string_view text, std::string_view option) {
  static constexpr struct {
    std::string_view name;
    double factor;
  } units[] = {{"", 1},        {"k", 1e3},     {"m", 1e6},     {"g", 1e9},    {"t", 1e12},
               {"ki", 0x1p10}, {"mi", 0x1p20}, {"gi", 0x1p30}, {"ti", 0x1p40}};
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  std::string unit(end, text.data() + text.size());
  for (char& c : unit)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (!unit.empty() && unit.back() == 'b') unit.pop_back();
  for (const auto& known : units) {
    const double value = number * known.factor;
    if (error != std::errc() || unit != known.name) continue;
    if (!(value >= 0) || value >= 0x1p63 || value != std::floor(value)) break;
    return static_cast<std::uint64_t>(value);
  }
  throw Error(ErrorCode::invalid_argument, option,
              " needs a whole number such as 500000, 8M or 2GiB, not '", text, "'");
}

std::uint64_t parse_whole(std::string_view text, std::string_view option) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc() && end == text.data() + text.size()) return number;
  throw Error(ErrorCode::invalid_argument, option,
              " needs a whole number from 0 to 18446744073709551615, not '", text, "'");
}

std::optional<std::uint64_t> point_of(std::string_view message) {
  constexpr std::string_view begin = "point ";
  std::uint64_t point = 0;
  if (message.starts_with("frame "))
    message.remove_prefix(std::min(message.size(), message.find(": ") + 2));
  if (!message.starts_with(begin)) return std::nullopt;
  const char* const end = message.data() + message.size();
  const auto read = std::from_chars(message.data() + begin.size(), end, point);
  return read.ec == std::errc() ? std::optional(point) : std::nullopt;
}

std::string place_of(const std::string& path, const std::string& message) {
  if (const auto point = point_of(message))
    if (const auto line = cullhull::line_of_point(path, *point))
      return input_name(path) + ":" + std::to_string(*line);
  return input_name(path);
}

std::string Places::of(const std::string& message) const {
  const auto point = point_of(message);
  if (!point) return parts.size() == 1 ? parts[0].name : std::to_string(parts.size()) + " inputs";
  auto part = parts.end();
  while (part != parts.begin() && (--part)->first > *point) {
  }
  const auto& at = part->not_finite;
  return part->name +
         (at && at->first + part->first == *point ? ":" + std::to_string(at->second) : "");
}

std::string input_name(const std::string& path) { return path == "-" ? "standard input" : path; }

void InputArguments::add_to(Parser& command) {
  command.group("Input");
  command.add_option("INPUT", path, "File of points, or - for standard input")
      ->type_name("")
      ->required();
  add_format_to(command);
}

void InputArguments::add_many_to(Parser& command, const std::string& last) {
  command.group("Input");
  command
      .add_option("INPUT", words,
                  "Files of points, read as one set in this order; also folders, quoted\n"
                  "patterns, @LIST (a text file with one input per line) and - for\n"
                  "standard input" +
                      last)
      ->type_name("")
      ->required();
  add_format_to(command);
}

std::vector<std::string> InputArguments::files() const {
  if (words.empty()) return {path};
  cullhull::ReadOptions options = read_options(*this, 0);
  return cullhull::input_files(words, options);
}

void InputArguments::check_states(const std::vector<std::string>& files) const {
  const bool any_points = std::any_of(files.begin(), files.end(), [](const std::string& file) {
    return ending_of(file) != ".hullstate";
  });
  if (any_points) return;
  for (const auto& [option, given] : {std::pair{"--columns", !columns.empty()},
                                      {"--dim", dimension != 0},
                                      {"--type", !type.empty()},
                                      {"--decimal", !decimal.empty()},
                                      {"--input-format", !format.empty()}})
    if (given)
      throw Error(ErrorCode::invalid_argument, option,
                  " describes files of points, but every input is a .hullstate, which says itself "
                  "what it holds");
}

void InputArguments::check_raw(const std::string& as) const {
  if ((dimension == 0 && type.empty()) || as.starts_with("raw")) return;
  throw Error(ErrorCode::invalid_argument, "--dim and --type describe raw input, but ", path,
              " was read as ", as);
}

std::vector<std::string> InputArguments::find_files() {
  std::vector<std::string> found = files();
  check_states(found);
  path = found.size() == 1 ? found[0] : std::to_string(found.size()) + " inputs";
  check_crs(crs);
  if (crs.empty()) crs = stated_crs(found, *this);
  return found;
}

void InputArguments::add_format_to(Parser& command) {
  allow_words(*command.add_option("--input-format", format,
                                  "Read INPUT in this format, whatever its name and content"),
              cullhull::input_formats());
  allow_range(*command.add_option("--dim", dimension, "Dimension of the points of raw input"), 1,
              1U << 20);
  allow_words(*command.add_option("--type", type, "Scalar type of raw input"), scalar_names());
  needs_value(
      *command.add_option("--columns", columns,
                          "Columns used as coordinates, by name (x,y,z) or by number from 0\n"
                          "(0,2,5, or 1:4 for 1 to 3)"))
      .type_name("COLUMNS");
  allow_words(*command.add_option("--decimal", decimal,
                                  "Decimal mark of the numbers in a text; default: a comma is one\n"
                                  "where it can be nothing else"),
              {",", "."});
  add_raw_option(command, raw);
  add_skip_option(command, skip_nan);
}

void add_skip_option(Parser& command, bool& skip) {
  command.add_flag("--skip-nan", skip,
                   "Leave out points with a NaN coordinate, such as pulses without a\n"
                   "return; ids remain those of INPUT");
}

void add_crs_option(Parser& command, std::string& crs) {
  command.group("Input");
  needs_value(*command.add_option("--crs", crs,
                                  "Coordinate reference system of the points, such as EPSG:25832;\n"
                                  "default: the one that the files state. It is written to\n"
                                  ".geojson; coordinates are not changed"))
      .type_name("EPSG:N");
}

void check_crs(std::string& crs) {
  if (crs.empty()) return;
  const std::string code = cullhull::crs_code(crs);
  if (code.empty())
    throw Error(ErrorCode::invalid_argument, "--crs ", crs,
                ": expected an authority and a code, such as EPSG:25832");
  crs = code;
}

namespace {

/// Whether the first two columns are named as a vertical plane: they are no map then.
bool are_vertical(const std::string& columns) {
  const std::size_t second = columns.find(',');
  const auto is_height = [](std::string_view name) { return name == "z" || name == "Z"; };
  if (second == std::string::npos) return is_height(columns);
  return is_height(std::string_view(columns).substr(0, second)) ||
         is_height(std::string_view(columns).substr(second + 1,
                                                    columns.find(',', second + 1) - second - 1));
}

}  // namespace

std::string stated_crs(const std::vector<std::string>& files, const InputArguments& arguments) {
  if (arguments.raw || are_vertical(arguments.columns)) return "";
  std::pair<std::string, std::string> differing;
  const std::string crs = cullhull::common_crs(files, &differing);
  const auto& [first, other] = differing;
  if (!other.empty())
    print_remark({other, "states " + cullhull::file_crs(other) + ", " + first + " states " +
                             cullhull::file_crs(first) +
                             "; no coordinate reference system is written without --crs"});
  return crs;
}

void add_raw_option(Parser& command, bool& raw) {
  command.add_flag("--raw", raw, "Use the whole numbers of a .las, without its scale and offset");
}

bool columns_can_be_chosen = true;

void print_remark(const cullhull::Remark& remark) {
  const bool of_columns = remark.of_columns;
  if (of_columns && is_converted(remark.file)) return;  // whose columns are of our making
  static std::mutex mutex;
  static std::set<std::string> told;  // once, however many tiles have the same remark
  const std::lock_guard lock(mutex);
  if (!told.insert(remark.message).second) return;
  write_stderr("cullhull: " + remark.line() +
               (of_columns && columns_can_be_chosen ? "; --columns takes others\n" : "\n"));
}

void remark_on_shape(const std::string& name, std::uint64_t count, std::uint32_t dimension) {
  constexpr std::uint32_t few = 8;  // dimensions in which a simplex may be what is meant
  if (count <= 1 || count >= dimension || dimension <= few) return;
  print_remark(
      {name, std::to_string(count) + " points in " + std::to_string(dimension) +
                 " dimensions, since each row is a point; transpose the file if each column is "
                 "one"});
}

cullhull::ReadOptions read_options(const InputArguments& arguments, unsigned threads,
                                   std::uint64_t memory) {
  cullhull::ReadOptions options;
  options.threads = threads;
  options.format = arguments.format;
  options.raw_dimension = arguments.dimension;
  options.raw_scalar = scalar_type(arguments.type);
  options.columns = arguments.columns;
  if (!arguments.decimal.empty()) options.decimal = arguments.decimal[0];
  options.weights = arguments.weights;
  options.memory_budget = memory;
  options.numbers = arguments.raw ? cullhull::Numbers::raw : cullhull::Numbers::grid;
  options.grid = arguments.grid;
  options.skip_nan = arguments.skip_nan;
  options.remark = print_remark;
  if (!arguments.blocks_hint.empty()) options.blocks_hint = arguments.blocks_hint.c_str();
  return options;
}

Input open_input(const InputArguments& arguments, unsigned threads, std::uint64_t memory) {
  return open_input(arguments, read_options(arguments, threads, memory));
}

Input open_input(const InputArguments& arguments, const cullhull::ReadOptions& options) {
  Input input;
  cullhull::ReadOptions all = options;
  all.skip_nan = false;  // here, as points are written by their ids in the file
  input.file = cullhull::open_points(arguments.path, all);
  arguments.check_raw(input.file.format());
  input.points = input.file.points();
  input.places.parts = {{input_name(arguments.path), 0, input.file.first_not_finite()}};
  const cullhull::Placement& placement = input.file.placement();
  const bool raw_scan = arguments.raw && input.file.format().starts_with("las");
  input.placing = {placement, input.file.grid(), !placement.empty() || raw_scan, arguments.raw,
                   arguments.crs};
  input.placing.note_columns(input.file.columns(), input.file.format(), arguments.columns);
  input.weights = input.file.weights();
  if (options.skip_nan) input.skip_nan();
  return input;
}

void Input::skip_nan() {
  skipped = Skipped(points);
  placing.skipped = skipped.count();
  if (!skipped.any()) return;
  for (Places::Part& part : places.parts)
    if (part.not_finite && skipped.contains(part.first + part.not_finite->first))
      part.not_finite.reset();
  kept_points = skipped.others(points, others);
  if (kept_points.count == 0) points = kept_points;  // then there is no point
  places.skipped = skipped;
}

void Input::fill_skipped() {
  if (!skipped.any() || kept_points.count == 0) return;
  places.skipped = {};
  points = skipped.with_copies(points, gathered);
  skipped.copy_numbers(weights);
}

void Input::to_grid(const cullhull::ReadOptions& options) {
  if (skipped.any()) return;  // whole numbers have no NaN
  file.to_grid(options);
  points = file.points();
  placing.grid = file.grid();
}

void Input::to_world() {
  if (placing.raw || placing.grid.empty()) return;
  if (gathered.empty()) {
    file.to_world();
    points = file.points();
    return;
  }
  const cullhull::Grid& grid = placing.grid;
  for (std::size_t at = 0; !grid.empty() && at < gathered.size(); at += sizeof(double)) {
    double number = 0;
    std::memcpy(&number, gathered.data() + at, sizeof number);
    number = grid.to_world(number);
    std::memcpy(gathered.data() + at, &number, sizeof number);
  }
}

Input open_inputs(const InputArguments& arguments, const std::vector<std::string>& files,
                  unsigned threads, std::uint64_t memory) {
  InputArguments one = arguments;
  one.path = files[0];
  one.skip_nan = arguments.skip_nan && files.size() == 1;
  if (files.size() == 1) {
    Input input = open_input(one, threads, memory);
    remark_on_shape(input_name(one.path), input.points.count, input.points.dimension);
    return input;
  }
  if (!one.grid && !one.raw)
    one.grid = cullhull::common_grid(files, read_options(arguments, threads, memory));
  std::vector<Input> parts;
  Input all;
  const std::uint64_t limit = cullhull::internal::resolve_budget(memory);
  std::uint64_t held = 0;
  for (const std::string& file : files) {
    one.path = file;
    parts.push_back(open_input(one, threads, limit - std::min(held, limit - 1)));
    held += parts.back().held();
    const PointView& part = parts.back().points;
    if (all.points.count == 0) all.points.scalar = part.scalar;
    if (part.count > 0 && part.scalar != all.points.scalar) all.points.scalar = ScalarType::f64;
    if (part.dimension != parts[0].points.dimension)
      throw Error(ErrorCode::bad_file, file, ": points of dimension ", part.dimension, ", but of ",
                  parts[0].points.dimension, " in ", files[0]);
    all.places.parts.push_back(parts.back().places.parts[0]);
    all.places.parts.back().first = all.points.count;
    all.points.count += part.count;
    const std::vector<double>& weights = parts.back().weights;
    all.weights.insert(all.weights.end(), weights.begin(), weights.end());
  }
  remark_on_shape(arguments.path, all.points.count, parts[0].points.dimension);
  all.placing = parts[0].placing;
  for (const Input& part : parts) all.placing.any = all.placing.any || part.placing.any;
  const std::uint32_t d = parts[0].points.dimension;
  const std::size_t size = cullhull::scalar_size(all.points.scalar);
  const std::uint64_t bytes = all.points.count * d * size;
  if (held + bytes > limit)
    throw Error(ErrorCode::out_of_budget, arguments.path, ": ", grouped(all.points.count),
                " points need ", (held + bytes) >> 20, " MiB in memory, the memory budget is ",
                cullhull::internal::size_text(limit), arguments.blocks_hint.empty() ? "" : "; ",
                arguments.blocks_hint);
  all.gathered.resize(bytes);
  std::byte* out = all.gathered.data();
  for (const Input& part : parts)
    for (std::uint64_t i = 0; i < part.points.count; ++i)
      for (std::uint32_t j = 0; j < d; ++j, out += size) {
        const double wide = part.points.at(i, j);
        const bool same = part.points.scalar == all.points.scalar;
        std::memcpy(out,
                    same ? part.points.address(i, j) : reinterpret_cast<const std::byte*>(&wide),
                    size);
      }
  all.file = std::move(parts[0].file);
  const auto stride = static_cast<std::ptrdiff_t>(size);
  all.points = {all.gathered.data(), all.points.scalar, d, all.points.count, stride * d, stride};
  if (arguments.skip_nan) all.skip_nan();
  return all;
}

void RunArguments::add_to(Parser& command, bool filter) {
  if (filter) {
    command.group("Filter");
    auto& method =
        *command.add_option("--cull", cull,
                            "Filter that discards interior points first; auto (default) decides\n"
                            "from a sample whether filtering is worthwhile");
    allow_words(method, {"auto", "gauge", "pseudo-hull", "none"});
    auto& where = *command.add_option("--backend", backend,
                                      "Processor that filters; auto (default) uses the\n"
                                      "one that is expected to be faster");
    allow_words(where, {"auto", "cpu", "cuda"});
    add_memory_to(command);
  } else {
    backend = "cpu";  // nothing to choose, so the planner's file is not read
  }
  command.group("Limits");
  auto& count =
      *command.add_option("--threads", threads, "Number of threads; 0 (default): all available");
  allow_range(count, 0, 1024);
  command.group("Other");
  command.add_flag("-q,--quiet", quiet, "Print no summary and no progress");
}

void RunArguments::add_memory_to(Parser& command) {
  command.group("Limits");
  needs_value(
      *command.add_option("--memory", memory,
                          "Memory limit beyond the pages of mapped input files, e.g. 2G or\n"
                          "512MiB; default: half of the machine's memory. Piped and parsed\n"
                          "points count. What needs more is refused with status 4"))
      .type_name("BYTES");
}

std::uint64_t RunArguments::memory_bytes() const {
  return memory.empty() ? 0 : parse_size(memory, "--memory");
}

cullhull::Options RunArguments::options() const {
  cullhull::Options options;
  if (cull == "gauge") options.cull = cullhull::CullMethod::gauge;
  if (cull == "pseudo-hull") options.cull = cullhull::CullMethod::pseudo_hull;
  if (cull == "none") options.cull = cullhull::CullMethod::none;
  if (backend == "cpu") options.backend = cullhull::Backend::cpu;
  if (backend == "cuda") options.backend = cullhull::Backend::cuda;
  options.threads = threads;
  options.memory_budget = memory_bytes();
  if (held > 0) {
    const std::uint64_t limit = cullhull::internal::resolve_budget(options.memory_budget);
    options.memory_budget = limit - std::min(held, limit - 1);
  }
  options.stop = stop_token();
  return options;
}

}  // namespace app
