#include "report.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cullhull/hull.hpp"
#include "cullhull/io.hpp"
#include "io/json/json_writer.hpp"
#include "machine.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::bench {
namespace {

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

std::string instruction_sets() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("flags", 0) != 0) continue;
    return line.find(" avx512f") != std::string::npos ? "AVX-512"
           : line.find(" avx2") != std::string::npos  ? "AVX2"
                                                      : "SSE";
  }
  return "unknown";
}

}  // namespace

std::vector<std::pair<std::string, std::string>> describe_machine() {
  const double gib = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) *
                     static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1U << 30);
  return {{"processor", processor()},
          {"instructions", instruction_sets()},
          {"cores", std::to_string(internal::resolve_threads(0))},
          {"memory", fmt::format("{:.0f} GiB", gib)},
          {"compiler", __VERSION__},
          {"version", CULLHULL_VERSION}};
}

Report begin_report(const char* suite) {
  Report report;
  report.suite = suite;
  report.date = date_now();
  report.machine = describe_machine();
  return report;
}

bool Report::agrees() const {
  return std::all_of(figures.begin(), figures.end(), [](const Figure& f) {
    return std::all_of(f.rows.begin(), f.rows.end(), [](const Row& r) { return r.agrees; });
  });
}

double bandwidth_share(const Report& report, const PointView& points,
                       const Statistics& statistics) {
  if (statistics.filter == UsedFilter::none || statistics.cull_seconds <= 0) return 0;
  for (const auto& [threads, rate] : report.read_bandwidth)
    if (threads == statistics.threads)
      return static_cast<double>(points.count * points.dimension * scalar_size(points.scalar)) /
             statistics.cull_seconds / rate;
  return 0;
}

std::string report_json(const Report& report) {
  using Json = nlohmann::ordered_json;
  Json json;
  json["suite"] = report.suite;
  json["date"] = report.date;
  json["command"] = report.command;
  json["scale"] = report.scale;
  json["threads"] = report.threads;
  for (const auto& [key, value] : report.machine) json["machine"][key] = value;
  json["read_bytes_per_second"] = Json::object();
  for (const auto& [threads, rate] : report.read_bandwidth)
    json["read_bytes_per_second"][std::to_string(threads)] = rate;
  json["figures"] = Json::array();
  for (const Figure& figure : report.figures) {
    Json rows = Json::array();
    for (const Row& row : figure.rows) {
      Json r{{"name", row.name}, {"points", row.points}, {"dimension", row.dimension}};
      r["scalar"] = row.scalar;
      r["values"] = Json::object();
      for (const auto& [name, value] : row.values)
        r["values"][name] = std::isnan(value) ? Json(nullptr) : Json(value);
      r["ratio"] = row.ratio > 0 ? Json(row.ratio) : Json(nullptr);
      r["ratio_is_bound"] = row.ratio_is_bound;
      r["paper"] = row.paper.empty() ? Json(nullptr) : Json(row.paper);
      r["check"] = row.check;
      r["agrees"] = row.agrees;
      r["vertices"] = row.vertices > 0 ? Json(row.vertices) : Json(nullptr);
      r["bandwidth_share"] = row.bandwidth > 0 ? Json(row.bandwidth) : Json(nullptr);
      r["reads"] = row.reads > 0 ? Json(row.reads) : Json(nullptr);
      r["slower"] = row.slower.empty() ? Json(nullptr) : Json(row.slower);
      r["unfinished"] = row.unfinished;
      rows.push_back(std::move(r));
    }
    json["figures"].push_back(Json{{"id", figure.id},
                                   {"title", figure.title},
                                   {"unit", figure.unit},
                                   {"note", figure.note},
                                   {"series", figure.series},
                                   {"rows", std::move(rows)}});
  }
  return internal::json_document("bench_report", {}, json);
}

}  // namespace cullhull::bench
