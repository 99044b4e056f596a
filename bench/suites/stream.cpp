#include "stream.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "child.hpp"
#include "contest.hpp"
#include "cullhull/error.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/io.hpp"
#include "las_bytes.hpp"
#include "machine.hpp"
#include "timing.hpp"
#include "workload.hpp"

namespace cullhull::bench {
namespace {

namespace fs = std::filesystem;

/// A new, empty folder; removed with its contents in the end.
class Folder {
 public:
  explicit Folder(const std::string& parent)
      : path_((parent.empty() ? fs::temp_directory_path() : fs::path(parent)) /
              fmt::format("cullhull-stream-{}", ::getpid())) {
    std::error_code error;
    if (!fs::create_directory(path_, error))
      throw Error(ErrorCode::io, path_.string() + ": " + error.message());
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

/// Reads a file as `dd bs=1M` does; returns the number of bytes.
std::uint64_t read_plainly(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  std::vector<char> block(std::size_t{1} << 20);
  std::uint64_t total = 0;
  for (ssize_t got = 0; file >= 0 && (got = ::read(file, block.data(), block.size())) > 0;)
    total += static_cast<std::uint64_t>(got);
  if (file >= 0) ::close(file);
  return total;
}

class StreamSuite {
 public:
  StreamSuite(const StreamSettings& settings, const Progress& progress, const std::stop_token& stop)
      : settings_(settings), steps_(progress, stop), folder_(settings.folder) {
    if (settings_.formats.empty()) settings_.formats = stream_formats();
    for (const std::string& format : settings_.formats)
      if (std::find(stream_formats().begin(), stream_formats().end(), format) ==
          stream_formats().end())
        throw Error(ErrorCode::invalid_argument, "no format '" + format + "' to measure");
    if (settings_.program.empty()) settings_.program = program_beside("cullhull");
    if (settings_.program.empty())
      throw Error(ErrorCode::io, "there is no cullhull beside this program");
  }

  Report run() {
    Report report = begin_report("stream");
    report.scale = settings_.scale;
    report.command = fmt::format("cullhull-bench stream --scale {:g} --repeat {} --memory {}",
                                 settings_.scale, settings_.repeat, settings_.memory);
    for (const std::string& f : settings_.formats) report.command += " --format " + f;
    Figure rates{"rates",
                 "Files in the page cache: megabytes of the file a second",
                 "MB/s",
                 "Plain read: blocks of a mebibyte, as dd reads. Streamed: a process from start to "
                 "end, hull --stream on. Medians of runs by turns.",
                 false,
                 {}};
    Figure memory{"memory", "Peak resident set of the process that streams", "MB", "", false, {}};
    for (std::size_t i = 0; i < settings_.formats.size(); ++i) {
      steps_.row(i, settings_.formats.size());
      measure(settings_.formats[i], rates, memory);
    }
    report.figures = {std::move(rates), std::move(memory)};
    return report;
  }

 private:
  struct Run {
    double seconds = 0, peak = 0;
    nlohmann::json hull;
  };

  Run run_program_on(const std::string& file, const char* stream) const {
    Run run;
    std::optional<ChildRun> child;
    run.seconds = seconds_of([&] {
      child = run_program({settings_.program, "hull", file, "--stream", stream, "--memory",
                           settings_.memory, "--json", "--quiet"},
                          {0, steps_.stop()});
    });
    const auto json = nlohmann::json::parse(child ? child->output : "", nullptr, false);
    if (!child || !json.is_object())
      throw Error(ErrorCode::io, settings_.program + " does not hull " + file);
    run.peak = json.value("peak_bytes", 0.0);
    for (const char* key : {"vertex_count", "facet_count", "area", "volume", "centroid"})
      run.hull[key] = json[key];
    return run;
  }

  /// Writes the file; returns the number of its points.
  std::uint64_t make(const std::string& format, const std::string& path) const {
    const bool text = format == "csv" || format.ends_with(".gz");
    const double wanted = (text ? 2e6 : 2e7) * settings_.scale;
    const auto count = static_cast<std::uint64_t>(std::max(1000.0, std::round(wanted)));
    std::vector<double> rows = generate("ball", count, 3, 1);
    const std::string npy = format == "npy.gz" ? path.substr(0, path.size() - 3) : path;
    if (format == "las") {
      std::vector<std::int32_t> whole(rows.size());
      for (std::size_t i = 0; i < rows.size(); ++i)
        whole[i] = static_cast<std::int32_t>(std::lround(rows[i] * 1e9));
      std::ofstream(path, std::ios::binary) << las_bytes(whole);
    } else if (format == "ply" || format == "csv") {
      std::vector<std::uint64_t> all(count);
      for (std::uint64_t i = 0; i < count; ++i) all[i] = i;
      const std::vector<float> narrow(rows.begin(), rows.end());
      write_points(path, PointView::row_major(narrow.data(), count, 3), all);
    } else {
      write_npy_points(npy, rows.data(), count, 3, ScalarType::f32);
    }
    if (npy != path) {
      const auto packed =
          run_program({"/bin/sh", "-c", "exec gzip -1 \"$0\"", npy}, {0, steps_.stop()});
      if (!packed) throw Error(ErrorCode::io, "no gzip that packs " + npy);
    }
    return count;
  }

  void measure(const std::string& format, Figure& rates, Figure& memory) const {
    const std::string path = folder_.file("points." + format);
    Row row;
    row.name = format;
    row.dimension = 3;
    row.scalar = format == "las" ? "i32" : format == "csv" ? "f64" : "f32";
    row.points = make(format, path);
    const auto bytes = static_cast<double>(fs::file_size(path));
    const Run whole = run_program_on(path, "off");
    std::vector<double> plain, streamed, peaks;
    for (unsigned k = 0; k < settings_.repeat; ++k) {
      steps_.step(format);
      plain.push_back(seconds_of([&] {
        if (static_cast<double>(read_plainly(path)) != bytes)
          throw Error(ErrorCode::io, path + ": cannot be read");
      }));
      const Run run = run_program_on(path, "on");
      streamed.push_back(run.seconds);
      peaks.push_back(run.peak / 1e6);
      row.agrees = row.agrees && run.hull == whole.hull;
    }
    row.vertices = whole.hull["vertex_count"].get<std::uint64_t>();
    row.check = fmt::format("{} vertices, {}", row.vertices,
                            row.agrees ? "as in memory" : "NOT as in memory");
    Row peak = row;
    row.values = {{"plain read", bytes / 1e6 / median(plain)},
                  {"streamed", bytes / 1e6 / median(streamed)}};
    row.reads = median(streamed) / median(plain);
    peak.values = {{"file", bytes / 1e6}, {"streamed", median(peaks)}};
    rates.rows.push_back(std::move(row));
    memory.rows.push_back(std::move(peak));
    fs::remove(path);
  }

  StreamSettings settings_;
  Steps steps_;
  Folder folder_;
};

}  // namespace

const std::vector<std::string>& stream_formats() {
  static const std::vector<std::string> all = {"npy", "ply", "las", "csv", "npy.gz"};
  return all;
}

Report run_stream(const StreamSettings& settings, const Progress& progress,
                  const std::stop_token& stop) {
  return StreamSuite(settings, progress, stop).run();
}

}  // namespace cullhull::bench
