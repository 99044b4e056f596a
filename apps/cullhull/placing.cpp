#include "placing.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "io/json/json_writer.hpp"
#include "io/records.hpp"
#include "io/source.hpp"
#include "terminal.hpp"

namespace app {
namespace {

using Json = nlohmann::ordered_json;

struct Range {
  double least = 0, greatest = 0;
};

std::vector<Range> box_of(const cullhull::PointView& points) {
  std::vector<Range> box;
  for (std::uint32_t j = 0; points.count > 0 && j < points.dimension; ++j) {
    Range axis{points.at(0, j), points.at(0, j)};
    for (std::uint64_t i = 1; i < points.count; ++i) {
      axis.least = std::min(axis.least, points.at(i, j));
      axis.greatest = std::max(axis.greatest, points.at(i, j));
    }
    box.push_back(axis);
  }
  return box;
}

}  // namespace

void Placing::note_columns(std::vector<std::string> names, const std::string& format,
                           const std::string& chosen) {
  columns = std::move(names);
  const std::string kind = format.substr(0, format.find(' '));
  shows_columns = !chosen.empty();
  shows_columns = shows_columns || cullhull::internal::is_text(kind);
}

std::string columns_line(const Placing& placing) {
  if (!placing.shows_columns || placing.columns.empty()) return "";
  constexpr std::size_t most = 12;
  std::string text = "columns    ";
  for (std::size_t j = 0; j < placing.columns.size() && j < most; ++j)
    text += (j > 0 ? ", " : "") + cullhull::internal::printable_text(placing.columns[j]);
  return text + (placing.columns.size() > most ? ", ...\n" : "\n");
}

std::string skipped_line(const Placing& placing) {
  if (!placing.skipped) return "";
  return fmt::format("skipped    {} point{} with a NaN coordinate\n", grouped(*placing.skipped),
                     *placing.skipped == 1 ? "" : "s");
}

std::string units_lines(const Placing& placing, const cullhull::PointView& points) {
  std::string text = columns_line(placing) + crs_line(placing) + skipped_line(placing);
  if (!placing.any) return text;
  text += "units      ";
  if (placing.raw)
    text += "stored numbers, a .las without its scale and offset";
  else
    text += placing.placement.unit.empty() ? "the file's" : placing.placement.unit;
  if (!placing.grid.empty())
    text += fmt::format(", exact on the grid of {}", placing.grid.unit());
  else if (!placing.raw)
    text += ", coordinates rounded to doubles";
  if (!placing.placement.empty())
    text += fmt::format("; scale {}, offset {}", fmt::join(placing.placement.scale, " "),
                        fmt::join(placing.placement.offset, " "));
  text += "\nextent     ";
  const std::vector<Range> box = box_of(points);
  for (std::size_t j = 0; j < box.size(); ++j)
    text += fmt::format("{}{} to {}", j > 0 ? ", " : "", box[j].least, box[j].greatest);
  return text + (box.empty() ? "no points\n" : "\n");
}

std::string crs_line(const Placing& placing) {
  return placing.crs.empty() ? "" : fmt::format("crs        {}\n", placing.crs);
}

Json placing_json(const Placing& placing, const cullhull::PointView& points) {
  const cullhull::Placement& p = placing.placement;
  Json json;
  json["numbers"] = placing.raw ? "file" : placing.grid.empty() ? "rounded" : "grid";
  json["grid"] = placing.grid.empty() ? Json() : Json(placing.grid.unit());
  json["scale"] = p.empty() ? Json() : Json(p.scale);
  json["offset"] = p.empty() ? Json() : Json(p.offset);
  json["unit"] = p.unit.empty() || placing.raw ? Json() : Json(p.unit);
  json["extent"] = Json::array();
  for (const Range& axis : box_of(points))
    json["extent"].push_back(Json::array({axis.least, axis.greatest}));
  return json;
}

void Extent::add(const cullhull::PointView& points) {
  Extent other;
  for (const Range& axis : box_of(points)) {
    other.least_.push_back(axis.least);
    other.greatest_.push_back(axis.greatest);
  }
  add(other);
}

void Extent::add(const Extent& other) {
  if (least_.empty()) {
    *this = other;
    return;
  }
  for (std::size_t j = 0; j < other.least_.size(); ++j) {
    least_[j] = std::min(least_[j], other.least_[j]);
    greatest_[j] = std::max(greatest_[j], other.greatest_[j]);
  }
}

std::vector<double> Extent::corners(const cullhull::Grid& grid) const {
  std::vector<double> rows = least_;
  rows.insert(rows.end(), greatest_.begin(), greatest_.end());
  cullhull::to_world(rows, grid);
  return rows;
}

std::string with_placing(std::string report, const Placing& placing,
                         const std::vector<double>& corners) {
  const auto d = static_cast<std::uint32_t>(corners.size() / 2);
  return with_placing(std::move(report), placing,
                      cullhull::PointView::row_major(corners.data(), d > 0 ? 2 : 0, d));
}

void add_placing(Json& report, const Placing& placing, const cullhull::PointView& points) {
  if (placing.skipped) report["skipped"] = *placing.skipped;
  if (!placing.crs.empty()) report["crs"] = placing.crs;
  if (!placing.columns.empty()) {
    report["columns"] = Json::array();
    for (const std::string& name : placing.columns)
      report["columns"].push_back(cullhull::internal::printable_text(name));
  }
  if (placing.any) report["placement"] = placing_json(placing, points);
}

std::string with_placing(std::string report, const Placing& placing,
                         const cullhull::PointView& points) {
  if (!placing.any && !placing.skipped && placing.crs.empty() && placing.columns.empty())
    return report;
  Json json = Json::parse(report);
  add_placing(json, placing, points);
  return cullhull::internal::json_text(json);
}

}  // namespace app
