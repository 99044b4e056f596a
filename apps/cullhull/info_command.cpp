// cullhull info: what is in a file of points.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>
#include <memory>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/io.hpp"
#include "terminal.hpp"

namespace app {
namespace {

constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();

struct Range {
  double least = std::numeric_limits<double>::infinity();
  double greatest = -std::numeric_limits<double>::infinity();
};

struct Scan {
  std::vector<Range> axes;
  std::uint64_t not_finite = 0;
  std::uint64_t first_not_finite = none;
};

Scan scan(const cullhull::PointView& points) {
  Scan result;
  result.axes.resize(points.dimension);
  for (std::uint64_t i = 0; i < points.count; ++i) {
    bool finite = true;
    for (std::uint32_t j = 0; j < points.dimension; ++j) {
      const double x = points.at(i, j);
      finite = finite && std::isfinite(x);
      if (x < result.axes[j].least) result.axes[j].least = x;
      if (x > result.axes[j].greatest) result.axes[j].greatest = x;
    }
    if (finite) continue;
    if (result.not_finite++ == 0) result.first_not_finite = i;
  }
  return result;
}

int run(const InputArguments& arguments) {
  const Input input = open_input(arguments);
  const cullhull::PointView& points = input.points;
  const Scan found = scan(points);
  std::string text = fmt::format(
      "format     {}{}\npoints     {}\ndimension  {}\nscalar     {}\nstrides    {} bytes from "
      "point "
      "to point, {} from coordinate to coordinate\n",
      input.file.format(), input.file.mapped() ? ", read in place" : "", grouped(points.count),
      points.dimension, cullhull::scalar_name(points.scalar), points.point_stride,
      points.coordinate_stride);
  for (std::uint32_t j = 0; points.count > 0 && j < points.dimension; ++j)
    text += fmt::format("axis {:<5} {} to {}\n", j, found.axes[j].least, found.axes[j].greatest);
  text += found.not_finite == 0
              ? std::string("finite     yes\n")
              : fmt::format("finite     no: {} point{} with a NaN or an infinity, first {}\n",
                            grouped(found.not_finite), found.not_finite == 1 ? "" : "s",
                            found.first_not_finite);
  write_stdout(text);
  return 0;
}

}  // namespace

Command add_info(CLI::App& parent) {
  auto a = std::make_shared<InputArguments>();
  CLI::App& command =
      *parent.add_subcommand("info", "What is in a file: format, count, scalar type, ranges");
  a->add_to(command);
  command.footer(std::string(input_help) +
                 "\n\nExit status: 0 success; 1 bad input; 2 bad usage; 130 cancelled.");
  return [a] { return run(*a); };
}

}  // namespace app
