#include "report.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cullhull/version.hpp"
#include "parallel/parallel.hpp"

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

std::string number(double v, const std::string& unit) {
  if (std::isnan(v)) return "-";
  if (unit == "s")
    return v < 1e-3 ? fmt::format("{:.1f} us", v * 1e6)
           : v < 1  ? fmt::format("{:.2f} ms", v * 1e3)
                    : fmt::format("{:.2f} s", v);
  if (unit == "%")
    return v != 0 && v < 0.1 ? fmt::format("{:.4f} %", v) : fmt::format("{:.2f} %", v);
  return fmt::format("{:.3g} {}", v, unit);
}

/// The names of values, in the order in which they first appear.
std::vector<std::string> columns(const Figure& figure) {
  std::vector<std::string> names;
  for (const Row& row : figure.rows)
    for (const auto& [name, value] : row.values)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

std::string figure_table(const Figure& figure) {
  std::vector<std::vector<std::string>> cells(1);
  const std::vector<std::string> names = columns(figure);
  const bool ratios =
      std::any_of(figure.rows.begin(), figure.rows.end(), [](const Row& r) { return r.ratio > 0; });
  const bool paper = std::any_of(figure.rows.begin(), figure.rows.end(),
                                 [](const Row& r) { return !r.paper.empty(); });
  cells[0] = {""};
  cells[0].insert(cells[0].end(), names.begin(), names.end());
  if (ratios) cells[0].emplace_back("ratio");
  if (paper) cells[0].emplace_back("the paper");
  cells[0].emplace_back("check");
  for (const Row& row : figure.rows) {
    std::vector<std::string> line{row.name};
    for (const std::string& name : names) {
      const auto at = std::find_if(row.values.begin(), row.values.end(),
                                   [&](const auto& v) { return v.first == name; });
      line.push_back(at == row.values.end() ? "" : number(at->second, figure.unit));
    }
    if (ratios) line.push_back(row.ratio > 0 ? fmt::format("{:.3g}x", row.ratio) : "");
    if (paper) line.push_back(row.paper);
    line.push_back(row.agrees ? row.check : "DIFFER: " + row.check);
    cells.push_back(std::move(line));
  }
  std::vector<std::size_t> width(cells[0].size(), 0);
  for (const auto& line : cells)
    for (std::size_t c = 0; c < line.size(); ++c) width[c] = std::max(width[c], line[c].size());
  std::string text = fmt::format("{}: {}\n", figure.id, figure.title);
  for (const auto& line : cells) {
    std::string row;
    for (std::size_t c = 0; c < line.size(); ++c)
      row += c == 0 || c + 1 == line.size() ? fmt::format("{:<{}}  ", line[c], width[c])
                                            : fmt::format("{:>{}}  ", line[c], width[c]);
    row.erase(row.find_last_not_of(' ') + 1);
    text += row + '\n';
  }
  if (!figure.note.empty()) text += figure.note + '\n';
  return text;
}

}  // namespace

std::string short_count(std::uint64_t n) {
  if (n >= 1'000'000) return fmt::format("{:g}M", std::round(static_cast<double>(n) / 1e4) / 100);
  if (n >= 1'000) return fmt::format("{:g}k", std::round(static_cast<double>(n) / 1e1) / 100);
  return std::to_string(n);
}

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

std::string report_table(const Report& report) {
  std::string text;
  for (const Figure& figure : report.figures) text += figure_table(figure) + '\n';
  text += fmt::format("{}; {} threads; {}", report.command,
                      report.threads == 0 ? "all" : std::to_string(report.threads), report.date);
  for (const auto& [key, value] : report.machine) text += fmt::format("; {} {}", key, value);
  return text + '\n';
}

std::string report_json(const Report& report) {
  using Json = nlohmann::ordered_json;
  Json json;
  json["version"] = CULLHULL_VERSION;
  json["suite"] = report.suite;
  json["date"] = report.date;
  json["command"] = report.command;
  json["scale"] = report.scale;
  json["threads"] = report.threads;
  for (const auto& [key, value] : report.machine) json["machine"][key] = value;
  json["figures"] = Json::array();
  for (const Figure& figure : report.figures) {
    Json rows = Json::array();
    for (const Row& row : figure.rows) {
      Json r{{"name", row.name}, {"points", row.points}, {"dimension", row.dimension}};
      r["values"] = Json::object();
      for (const auto& [name, value] : row.values)
        r["values"][name] = std::isnan(value) ? Json(nullptr) : Json(value);
      r["ratio"] = row.ratio > 0 ? Json(row.ratio) : Json(nullptr);
      r["paper"] = row.paper.empty() ? Json(nullptr) : Json(row.paper);
      r["check"] = row.check;
      r["agrees"] = row.agrees;
      rows.push_back(std::move(r));
    }
    json["figures"].push_back(Json{{"id", figure.id},
                                   {"title", figure.title},
                                   {"unit", figure.unit},
                                   {"note", figure.note},
                                   {"series", figure.series},
                                   {"rows", std::move(rows)}});
  }
  return json.dump(2) + '\n';
}

}  // namespace cullhull::bench
