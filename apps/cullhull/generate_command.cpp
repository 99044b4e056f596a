// cullhull generate: seeded point sets.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/error.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/io.hpp"
#include "generate/point_generator.hpp"
#include "io/write/npy_writers.hpp"
#include "outputs.hpp"
#include "signals.hpp"
#include "terminal.hpp"

namespace app {
namespace {

struct GenerateArguments {
  std::string shape;
  std::string count;
  std::uint32_t dimension = 0;
  std::string seed = "1";
  std::string type = "f64";
  std::string output;
  std::string frames;
  std::string motion;
  std::string json;
  bool quiet = false;
};

/// The parsed arguments.
struct Made {
  std::uint64_t count = 0, seed = 1, frames = 0;  ///< frames: 0 for points at rest
  std::uint32_t dimension = 0;
  cullhull::ScalarType type = cullhull::ScalarType::f64;
};

std::string footer() {
  std::string text = "Shapes:\n";
  for (const cullhull::Shape& shape : cullhull::shapes())
    text += fmt::format("  {:<13} {}\n", shape.name, shape.description);
  text += "\nMotions (--motion, with --frames T; writes an array (T, N, D)):\n";
  for (const cullhull::Shape& motion : cullhull::motions())
    text += fmt::format("  {:<13} {}\n", motion.name, motion.description);
  return text +
         "\nOutput files (-o, by extension):\n"
         "  .npy .ply .raw        the scalar type of --type\n"
         "  .xyz .txt .csv .obj .off   decimals that read back as the same numbers\n"
         "  .geojson .wkt         one multipoint\n"
         "  .ply .geojson .wkt hold 2D and 3D points, .obj 3D points; --frames writes .npy.\n"
         "\nThe same arguments give the same bits on every machine, for any number of threads. "
         "f32\n"
         "rounds the f64 points.\n"
         "\n"
         "Examples:\n"
         "  cullhull generate ball -n 8M -d 3 -o ball.npy\n"
         "  cullhull generate grid:16 -n 10k -d 5 --type f32 --seed 7 -o grid.npy\n"
         "  cullhull generate disk -n 1000 -o disk.csv          as text with a line x,y\n"
         "  cullhull generate ball -n 1M -o - | cullhull hull -\n"
         "  cullhull generate bumpy -n 1.1M --frames 30 --motion twist -o twist.npy\n"
         "\n"
         "Exit status: 0 success; 1 system error; 2 bad usage; 4 out of memory; 130 cancelled.";
}

// Only one frame is in memory at a time.
void write_sequence(const GenerateArguments& arguments, const Made& made) {
  const cullhull::MovingPoints moving(arguments.shape, arguments.motion, made.count, made.dimension,
                                      made.frames, made.seed);
  const auto total = static_cast<double>(made.frames);
  TerminalProgress progress(arguments.quiet, "frames", total);
  const cullhull::Progress report = progress.callback();
  cullhull::internal::NpySequenceWriter writer(arguments.output, made.frames, made.count,
                                               made.dimension, made.type);
  std::vector<double> points(made.count * made.dimension);
  for (std::uint64_t f = 0; f < made.frames; ++f) {
    if (stop_token().stop_requested()) return;  // the writer removes its unfinished file
    if (report) report("frames", static_cast<double>(f) / total);
    moving.frame(f, points.data(), stop_token());
    writer.write(points.data());
  }
}

/// Points a piece: enough for all threads, and few enough that a file may exceed memory.
std::uint64_t piece_of(std::uint32_t dimension) {
  constexpr std::uint64_t run = cullhull::internal::PointGenerator::run_length;
  constexpr std::uint64_t bytes = std::uint64_t{32} << 20;
  const std::uint64_t runs = bytes / (run * dimension * sizeof(double));
  return run * std::max<std::uint64_t>({1, runs, std::thread::hardware_concurrency()});
}

void write_points(const GenerateArguments& arguments, const Made& made) {
  const cullhull::internal::PointGenerator generator(arguments.shape, made.count, made.dimension,
                                                     made.seed);
  const auto total = static_cast<double>(made.count);
  TerminalProgress progress(arguments.quiet, "points", total);
  const cullhull::Progress report = progress.callback();
  cullhull::PointsWriter writer(arguments.output, made.count, made.dimension, made.type);
  const std::uint64_t piece = std::min(made.count, piece_of(made.dimension));
  std::vector<double> points(piece * made.dimension);
  for (std::uint64_t first = 0; first < made.count; first += piece) {
    if (stop_token().stop_requested()) return;  // the writer removes its unfinished file
    if (report) report("points", static_cast<double>(first) / total);
    const std::uint64_t count = std::min(piece, made.count - first);
    generator.rows(first, count, points.data(), stop_token());
    writer.write(points.data(), count);
  }
}

Made read_arguments(const GenerateArguments& arguments) {
  Made made;
  made.count = parse_size(arguments.count, "-n");
  made.seed = parse_whole(arguments.seed, "--seed");
  made.dimension = arguments.dimension;
  if (made.dimension == 0)
    made.dimension = arguments.shape == "disk" || arguments.shape == "circle" ? 2 : 3;
  if (arguments.type == "f32") made.type = cullhull::ScalarType::f32;
  if (arguments.frames.empty() != arguments.motion.empty())
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                          "--frames and --motion must be given together");
  if (!arguments.frames.empty()) made.frames = parse_size(arguments.frames, "--frames");
  return made;
}

std::string report(const GenerateArguments& arguments, const Made& made) {
  using Json = nlohmann::ordered_json;
  Json json;
  json["shape"] = arguments.shape;
  json["seed"] = made.seed;
  json["motion"] = arguments.motion.empty() ? Json() : Json(arguments.motion);
  json["frames"] = arguments.motion.empty() ? Json() : Json(made.frames);
  json["output"] = arguments.output;
  cullhull::PointView points;
  points.count = made.count;
  points.dimension = made.dimension;
  points.scalar = made.type;
  return report_text("generate_report", points, json);
}

std::string summary(const GenerateArguments& arguments, const Made& made) {
  const std::string frames =
      arguments.motion.empty()
          ? ""
          : fmt::format("frames     {}, {}\n", grouped(made.frames), arguments.motion);
  return fmt::format("points     {} x {} {}, {}, seed {}\n", grouped(made.count), made.dimension,
                     cullhull::scalar_name(made.type), arguments.shape, made.seed) +
         frames + wrote_line(arguments.output) + wrote_line(arguments.json);
}

int run(const GenerateArguments& arguments) {
  FilePlan plan;
  if (arguments.frames.empty())
    plan.writes("-o", arguments.output, {OutputKind::made});
  else
    plan.writes("-o", arguments.output, {".npy"});
  plan.writes_json(arguments.json);
  const Made made = read_arguments(arguments);
  cancellable([&] {
    if (arguments.motion.empty())
      write_points(arguments, made);
    else
      write_sequence(arguments, made);
  });
  if (!arguments.json.empty()) cullhull::write_text(arguments.json, report(arguments, made));
  if (!arguments.quiet && !plan.uses_stdout()) write_stdout(summary(arguments, made));
  return 0;
}

std::vector<std::string> shape_names() {
  std::vector<std::string> names;
  for (const cullhull::Shape& shape : cullhull::shapes()) names.emplace_back(shape.name);
  return names;
}

}  // namespace

Command add_generate(Parser& parent) {
  auto a = std::make_shared<GenerateArguments>();
  Parser& command =
      *parent.add_subcommand("generate", "Generate seeded random points in a given shape");
  command.group("Points");
  command.add_option("SHAPE", a->shape, "One of the shapes below")
      ->offers(shape_names())
      ->type_name("")
      ->required();
  command.add_option("-n,--count", a->count, "Number of points, e.g. 100000 or 8M")
      ->type_name("N")
      ->required();
  allow_range(
      *command.add_option("-d,--dim", a->dimension, "Dimension (default: 3; of disk and circle 2)"),
      1, 1U << 20);
  command.add_option("--seed", a->seed, "Seed of the random numbers (default: 1)")->type_name("S");
  allow_words(*command.add_option("--type", a->type, "Scalar type (default: f64)"), {"f32", "f64"});
  command.group("Motion");
  needs_value(*command.add_option("--frames", a->frames, "Number of frames of moving points"))
      .type_name("T");
  std::vector<std::string> motions;
  for (const cullhull::Shape& motion : cullhull::motions()) motions.emplace_back(motion.name);
  allow_words(*command.add_option("--motion", a->motion, "Motion, see below"), motions);
  command.group("Output");
  needs_value(*command.add_option("-o,--output", a->output,
                                  "Write the points in the format of the extension, see below;\n"
                                  "- writes .npy on standard output"))
      .type_name("FILE")
      ->required();
  add_json_option(command, a->json, "Report what was generated");
  command.group("Other");
  command.add_flag("-q,--quiet", a->quiet, "Print no summary and no progress");
  command.footer(footer());
  return [a] { return run(*a); };
}

}  // namespace app
