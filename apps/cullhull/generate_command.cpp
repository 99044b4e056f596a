// cullhull generate: seeded point sets.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <limits>
#include <memory>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/error.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/io.hpp"
#include "signals.hpp"
#include "terminal.hpp"

namespace app {
namespace {

struct GenerateArguments {
  std::string shape;
  std::string count;
  std::uint32_t dimension = 0;
  std::uint64_t seed = 1;
  std::string type = "f64";
  std::string output;
  std::string frames;
  std::string motion;
};

std::string footer() {
  std::string text = "Shapes:\n";
  for (const cullhull::Shape& shape : cullhull::shapes())
    text += fmt::format("  {:<13} {}\n", shape.name, shape.description);
  text += "Motions (--motion, with --frames T; writes an array (T, N, D), frame by frame):\n";
  for (const cullhull::Shape& motion : cullhull::motions())
    text += fmt::format("  {:<13} {}\n", motion.name, motion.description);
  return text +
         "The same arguments give the same bits on every machine and for any number of threads. "
         "f32\n"
         "rounds the f64 points.\n"
         "\n"
         "Examples:\n"
         "  cullhull generate ball -n 8M -d 3 -o ball.npy\n"
         "  cullhull generate grid:16 -n 10k -d 5 --type f32 --seed 7 -o grid.npy\n"
         "  cullhull generate bumpy -n 1.1M --frames 30 --motion twist -o twist.npy\n"
         "\n"
         "Exit status: 0 success; 1 the system refused; 2 bad usage; 4 out of memory; 130 "
         "cancelled.";
}

// One frame is in memory at a time.
void write_sequence(const GenerateArguments& arguments, const cullhull::MovingPoints& moving,
                    std::uint64_t frames, std::uint64_t count, std::uint32_t dimension,
                    cullhull::ScalarType type) {
  TerminalProgress progress(false);
  const cullhull::Progress report = progress.callback();
  cullhull::NpySequenceWriter writer(arguments.output, frames, count, dimension, type);
  std::vector<double> points(count * dimension);
  for (std::uint64_t f = 0; f < frames; ++f) {
    if (stop_token().stop_requested()) return;  // the writer removes what it has begun
    if (report) report("frames", static_cast<double>(f) / static_cast<double>(frames));
    moving.frame(f, points.data(), stop_token());
    writer.write(points.data());
  }
}

int run(const GenerateArguments& arguments) {
  if (std::filesystem::path(arguments.output).extension() != ".npy")
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                          "-o " + arguments.output + ": the name must end in .npy");
  const std::uint64_t count = parse_size(arguments.count, "-n");
  std::uint32_t dimension = arguments.dimension;
  if (dimension == 0) dimension = arguments.shape == "disk" || arguments.shape == "circle" ? 2 : 3;
  const auto type = arguments.type == "f32" ? cullhull::ScalarType::f32 : cullhull::ScalarType::f64;
  if (arguments.frames.empty() != arguments.motion.empty())
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                          "--frames and --motion need one another");
  if (!arguments.frames.empty()) {
    const std::uint64_t frames = parse_size(arguments.frames, "--frames");
    const cullhull::MovingPoints moving(arguments.shape, arguments.motion, count, dimension, frames,
                                        arguments.seed);
    cancellable([&] { write_sequence(arguments, moving, frames, count, dimension, type); });
    return 0;
  }
  const std::vector<double> points =
      cullhull::generate(arguments.shape, count, dimension, arguments.seed);
  cullhull::write_npy_points(arguments.output, points.data(), count, dimension, type);
  return 0;
}

}  // namespace

Command add_generate(CLI::App& parent) {
  auto a = std::make_shared<GenerateArguments>();
  CLI::App& command = *parent.add_subcommand("generate", "Make a seeded set of points");
  command.add_option("SHAPE", a->shape, "One of those below")->type_name("")->required();
  command.add_option("-n,--count", a->count, "How many points, e.g. 100000 or 8M")
      ->type_name("N")
      ->required();
  allow_range(*command.add_option("-d,--dim", a->dimension,
                                  "Dimension; 3 if not given, 2 for disk and circle"),
              1, 1U << 20);
  command.add_option("--seed", a->seed, "Another seed, another set; 1 if not given")
      ->type_name("S");
  allow_words(*command.add_option("--type", a->type, "Scalar type to write; f64 if not given"),
              {"f32", "f64"});
  command.add_option("--frames", a->frames, "Moving points: how many frames")->type_name("T");
  std::vector<std::string> motions;
  for (const cullhull::Shape& motion : cullhull::motions()) motions.emplace_back(motion.name);
  allow_words(*command.add_option("--motion", a->motion, "How they move, see below"), motions);
  command.add_option("-o,--output", a->output, "File to write")->type_name("FILE.npy")->required();
  command.footer(footer());
  return [a] { return run(*a); };
}

}  // namespace app
