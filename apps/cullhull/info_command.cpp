// cullhull info: what is in a file of points.
#include <fmt/format.h>

#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>

#include "arguments.hpp"
#include "axis_ranges.hpp"
#include "commands.hpp"
#include "converted.hpp"
#include "cullhull/io.hpp"
#include "filter/ways.hpp"
#include "outputs.hpp"
#include "parallel/threads/parallel.hpp"
#include "streaming.hpp"
#include "terminal.hpp"
#include "topics.hpp"

namespace app {
namespace {

struct Scan : AxisRanges {
  std::string place;  ///< file and, of a text, line of the first point that is not finite; or empty
};

/// The rest of the report.
struct Described {
  std::string file;            ///< the first
  cullhull::PointView points;  ///< only number, dimension, scalar type and strides
  std::string format;
  bool in_place = false;
  double read_seconds = 0;
  Placing placing;
  bool streamed = false;                  ///< read in blocks
  nlohmann::ordered_json plan = nullptr;  ///< of --plan
};

/// The ways that `hull` would try (src/filter/ways.hpp), in their order.
nlohmann::ordered_json plan_of(const Described& input, const RunArguments& run, std::size_t files) {
  using namespace cullhull::internal;
  auto plan = nlohmann::ordered_json::array();
  const auto add = [&](const char* way, const char* tried, const std::string& reason) {
    plan.push_back({{"way", way}, {"tried", tried}, {"reason", reason}});
  };
  if (input.streamed) {
    add("blocks", "yes", "each block is filtered by the hull of those before it");
    return plan;
  }
  const WayQuestion asked = way_question(input.points, run.options());
  WayQuestion behind{.dimension = asked.dimension, .count = asked.count, .budget = asked.budget};
  const bool filter = asked.cull != cullhull::CullMethod::none;
  // One file with a grid: `hull` filters its numbers before few points are hulled.
  const bool filtered = files == 1 && input.placing.any && !input.placing.raw;
  for (const WayRow& r : ways) {
    if (asked.dimension < r.least_dimension || asked.dimension > r.most_dimension) continue;
    // Beyond the plane a way for few points is asked again, about what a filter left.
    const bool few = r.unchosen && r.bytes > 0;
    WayQuestion few_left = behind;
    few_left.count = r.least;
    const bool again = few && asked.dimension > 2 && r.most_left > 0;
    const bool first = takes(r.way, asked) && !(few && filtered);
    if (first || (again && !filter && takes(r.way, behind)))
      add(r.name, "yes", r.reason);
    else if (again && filter && asked.count >= r.least && takes(r.way, few_left))
      add(r.name, "left",
          fmt::format("if a filter leaves at most {} points",
                      grouped(filtered ? r.most : r.most_left)));
    else if (takes(r.way, asked))
      add(r.name, "no", "the file's own numbers are filtered first");
    else
      add(r.name, "no",
          why_not(r.way, !again                   ? asked
                         : takes(r.way, few_left) ? behind
                                                  : few_left));
  }
  return plan;
}

std::string plan_lines(const nlohmann::ordered_json& plan) {
  std::string text;
  for (const auto& row : plan)
    text +=
        fmt::format("{}{:<15}{:<5}{}\n",
                    text.empty() ? "plan       in this order, until one finds the hull:\n  " : "  ",
                    row["way"].get<std::string>(), row["tried"].get<std::string>(),
                    row["reason"].get<std::string>());
  return text;
}

/// Null for an axis without points.
nlohmann::ordered_json number(double value, bool any) {
  if (!any) return nullptr;
  return value;
}

std::string report(const Described& input, const Scan& found) {
  using Json = nlohmann::ordered_json;
  const cullhull::PointView& points = input.points;
  Json json;
  json["format"] = input.format;
  json["in_place"] = input.in_place;
  json["point_stride"] = points.point_stride;
  json["coordinate_stride"] = points.coordinate_stride;
  json["axes"] = Json::array();
  for (const AxisRanges::Range& axis : found.axes) {
    const bool any = axis.least <= axis.greatest;
    json["axes"].push_back(
        {{"least", number(axis.least, any)}, {"greatest", number(axis.greatest, any)}});
  }
  add_users_members(json, input.file);
  add_placing(json, input.placing, cullhull::PointView{});
  json["not_finite"] = found.not_finite;
  json["first_not_finite"] = found.not_finite > 0 ? Json(found.first_not_finite) : Json();
  json["read_seconds"] = input.read_seconds;
  if (!input.plan.is_null()) json["plan"] = input.plan;
  return report_text("info_report", points, json);
}

std::string summary(const Described& input, const Scan& found) {
  const cullhull::PointView& points = input.points;
  std::string text = fmt::format(
      "format     {}{}\npoints     {}\ndimension  {}\nscalar     {}\nstrides    {} bytes from "
      "point to point, {} from coordinate to coordinate\n",
      input.format, input.in_place ? ", read in place" : "", grouped(points.count),
      points.dimension, cullhull::scalar_name(points.scalar), points.point_stride,
      points.coordinate_stride);
  for (std::uint32_t j = 0; points.count > 0 && j < points.dimension; ++j)
    text += fmt::format("axis {:<5} {} to {}\n", j, found.axes[j].least, found.axes[j].greatest);
  text += users_lines(input.file) + columns_line(input.placing);
  const std::string units = units_lines(input.placing, cullhull::PointView{});
  const std::size_t from = columns_line(input.placing).size();
  text += units.substr(from, units.find("extent ") - from);
  text += found.not_finite == 0
              ? std::string("finite     yes\n")
              : fmt::format("finite     no: {} point{} with a NaN or an infinity, first {}{}\n",
                            grouped(found.not_finite), found.not_finite == 1 ? "" : "s",
                            found.first_not_finite,
                            found.place.empty() ? "" : " (" + found.place + ")");
  return text + plan_lines(input.plan);
}

struct InfoArguments {
  InputArguments input;
  RunArguments run;
  StreamArguments stream;
  std::string json;
  bool plan = false;
};

Described describe(const InfoArguments& a, const std::vector<std::string>& files, Scan& found) {
  Input input = open_inputs(a.input, files, a.run.threads, a.run.memory_bytes());
  input.to_world();
  found.add(axis_ranges(input.kept(), cullhull::internal::resolve_threads(a.run.threads)));
  if (found.not_finite > 0) {
    found.first_not_finite = input.skipped.id_of(found.first_not_finite);
    found.place = input.places.of(fmt::format("point {},", found.first_not_finite));
  }
  return {
      files[0],     input.points, format_of(input), is_in_place(input), input.file.read_seconds(),
      input.placing};
}

Described describe_streamed(const InfoArguments& a, const std::vector<std::string>& files,
                            Scan& found) {
  std::mutex mutex;
  cullhull::PointView shape;
  const cullhull::BlockSummary read = stream_blocks(
      a.input, files, a.run, [&](const cullhull::PointView& block, std::uint64_t first) {
        const AxisRanges part = axis_ranges(block, 1, first);
        const std::lock_guard lock(mutex);
        found.add(part);
        if (shape.data == nullptr) shape = block;
      });
  shape.count = read.end.points;
  shape.scalar = read.scalar;
  for (AxisRanges::Range& axis : found.axes) {
    axis.least = read.grid.to_world(axis.least);
    axis.greatest = read.grid.to_world(axis.greatest);
  }
  return {files[0], shape, read.format, false, 0, placing_of(read, a.input), true};
}

int run(InfoArguments arguments) {
  const std::vector<std::string> files = arguments.input.find_files();
  FilePlan plan;
  plan.reads_inputs(arguments.input.words, files);
  plan.writes_json(arguments.json);
  Scan found;
  // As `hull` would read them.
  const std::string whole = arguments.run.cull != "auto"      ? "--cull " + arguments.run.cull
                            : arguments.run.backend == "cuda" ? "--backend cuda"
                                                              : "";
  const bool streamed = arguments.stream.wanted(files, arguments.run, whole);
  arguments.input.blocks_hint = StreamArguments::hint(whole);
  Described input =
      streamed ? describe_streamed(arguments, files, found) : describe(arguments, files, found);
  if (arguments.plan) input.plan = plan_of(input, arguments.run, files.size());
  if (!arguments.json.empty()) cullhull::write_text(arguments.json, report(input, found));
  if (!arguments.run.quiet && !plan.uses_stdout())
    write_stdout(summary(input, found) + wrote_line(arguments.json));
  return 0;
}

}  // namespace

Command add_info(Parser& parent) {
  auto a = std::make_shared<InfoArguments>();
  Parser& command =
      *parent.add_subcommand("info", "Describe files: format, points, scalar type, ranges");
  a->input.add_many_to(command);
  add_json_option(command, a->json, "Report the same");
  command.add_flag("--plan", a->plan,
                   "List the ways that 'hull' would try with these options, and\n"
                   "why each applies or not");
  a->run.add_to(command, true);
  a->stream.add_to(command, false);
  command.footer(std::string(input_footer) +
                 "\n\nExamples:\n"
                 "  cullhull info cloud.npy             number of points, dimension, ranges\n"
                 "  cullhull info tile.las --json       the same as JSON; with scale and offset\n"
                 "  cullhull info table.csv             which columns are the coordinates\n"
                 "  cullhull info cloud.npy --plan      by which way its hull would be found\n"
                 "\n"
                 "Exit status: 0 success; 1 bad input; 2 bad usage; 130 cancelled.");
  return [a] { return run(*a); };
}

}  // namespace app
