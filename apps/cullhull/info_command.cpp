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
};

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
  return text;
}

struct InfoArguments {
  InputArguments input;
  StreamArguments stream;
  std::string json;
};

Described describe(const InputArguments& arguments, const std::vector<std::string>& files,
                   Scan& found) {
  Input input = open_inputs(arguments, files, 0);
  input.to_world();
  found.add(axis_ranges(input.kept(), cullhull::internal::resolve_threads(0)));
  if (found.not_finite > 0) {
    found.first_not_finite = input.skipped.id_of(found.first_not_finite);
    found.place = input.places.of(fmt::format("point {},", found.first_not_finite));
  }
  return {
      files[0],     input.points, format_of(input), is_in_place(input), input.file.read_seconds(),
      input.placing};
}

Described describe_streamed(const InputArguments& arguments, const std::vector<std::string>& files,
                            Scan& found) {
  std::mutex mutex;
  cullhull::PointView shape;
  const cullhull::BlockSummary read = stream_blocks(
      arguments, files, RunArguments{}, [&](const cullhull::PointView& block, std::uint64_t first) {
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
  return {files[0], shape, read.format, false, 0, placing_of(read, arguments)};
}

int run(InfoArguments arguments) {
  const std::vector<std::string> files = arguments.input.find_files();
  FilePlan plan;
  plan.reads_inputs(arguments.input.words, files);
  plan.writes_json(arguments.json);
  Scan found;
  const bool streamed = arguments.stream.wanted(files, RunArguments{}, "");
  arguments.input.blocks_hint = StreamArguments::hint("");
  const Described input = streamed ? describe_streamed(arguments.input, files, found)
                                   : describe(arguments.input, files, found);
  if (!arguments.json.empty()) cullhull::write_text(arguments.json, report(input, found));
  if (!plan.uses_stdout()) write_stdout(summary(input, found) + wrote_line(arguments.json));
  return 0;
}

}  // namespace

Command add_info(Parser& parent) {
  auto a = std::make_shared<InfoArguments>();
  Parser& command =
      *parent.add_subcommand("info", "Describe files: format, points, scalar type, ranges");
  a->input.add_many_to(command);
  add_json_option(command, a->json, "Report the same");
  a->stream.add_to(command, false);
  command.footer(std::string(input_footer) +
                 "\n\nExamples:\n"
                 "  cullhull info cloud.npy             number of points, dimension, ranges\n"
                 "  cullhull info tile.las --json       the same as JSON; with scale and offset\n"
                 "  cullhull info table.csv             which columns are the coordinates\n"
                 "\n"
                 "Exit status: 0 success; 1 bad input; 2 bad usage; 130 cancelled.");
  return [a] { return run(*a); };
}

}  // namespace app
