#include "group_hulls.hpp"

#include <fmt/format.h>

#include "kept_columns.hpp"
#include "measure.hpp"
#include "outputs.hpp"
#include "signals.hpp"
#include "terminal.hpp"

namespace app {
namespace {

/// `write(files, reading, options)`: writes the file of the groups.
template <class Write>
int write_groups(const InputArguments& input, const std::vector<std::string>& files,
                 const std::string& key, const std::string& output, const RunArguments& run,
                 const char* what, const Write& write) {
  cullhull::Options options = run.options();
  cullhull::BlockOptions reading;
  reading.read = read_options(input, run.threads, run.memory_bytes());
  reading.read.key = key;
  reading.read.stop = options.stop;
  cullhull::GroupReport report;
  {
    TerminalProgress progress(run.quiet, "read", static_cast<double>(cullhull::input_bytes(files)));
    reading.progress = options.progress = progress.callback();
    reading.position = progress.bytes_callback();
    cancellable([&] { report = write(reading, options); });
  }
  if (run.quiet || output == "-") return 0;
  Placing placing;
  if (input.skip_nan) placing.skipped = report.skipped;
  write_stdout(fmt::format("points     {} x {}\n"
                           "{}{}groups     {}\n"
                           "seconds    {:.6f} = reading and sorting {:.6f} + {} {:.6f}\n"
                           "run        peak memory {:.1f} MB\n",
                           grouped(report.points), report.dimension, skipped_line(placing),
                           input.crs.empty() ? "" : "crs        " + input.crs + "\n",
                           grouped(report.groups), report.read_seconds + report.hull_seconds,
                           report.read_seconds, what, report.hull_seconds,
                           static_cast<double>(peak_bytes()) / 1e6) +
               wrote_line(output));
  return 0;
}

}  // namespace

int run_groups(const InputArguments& input, const std::vector<std::string>& files,
               const std::string& key, const std::string& keep, const std::string& output,
               const RunArguments& run) {
  return write_groups(input, files, key, output, run, "hulls",
                      [&](const auto& reading, const auto& options) {
    return cullhull::write_group_hulls(files, output, reading, options,
                                       {input.crs, kept_columns(keep, input, files, run)});
  });
}

int run_group_shapes(const InputArguments& input, const std::vector<std::string>& files,
                     const std::string& key, const std::string& keep, const std::string& output,
                     const cullhull::GroupShape& shape, const RunArguments& run) {
  return write_groups(input, files, key, output, run, "shapes",
                      [&](const auto& reading, const auto& options) {
    return cullhull::write_group_shapes(files, output, shape, reading, options,
                                        {input.crs, kept_columns(keep, input, files, run)});
  });
}

}  // namespace app
