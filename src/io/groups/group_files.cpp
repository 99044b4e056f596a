#include "io/groups/group_files.hpp"

#include "cullhull/error.hpp"
#include "io/file_formats.hpp"
#include "io/formats/crs.hpp"
#include "io/write/mesh.hpp"

namespace cullhull::internal {
namespace {

void require_plane(const std::string& format, const GroupKind& kind, std::uint32_t dimension) {
  if (format == "geojson" && dimension != 2 && dimension != 0)
    throw Error(ErrorCode::invalid_argument, ".geojson holds ", kind.shapes, " of 2D points, not ",
                dimension, "D; .csv and .json hold any");
}

}  // namespace

std::string checked_format(const std::string& path, const std::string& format) {
  std::string found = output_format(path, format, "json");
  if (!holds(found, {OutputKind::group_hulls}))
    refuse_format(path, found, {OutputKind::group_hulls});
  return found;
}

std::string name_of_key(const std::string& key) {
  return key.find_first_not_of("0123456789") == std::string::npos ? "column " + key : key;
}

GroupFile::GroupFile(const std::string& path, std::string format, std::string key_name,
                     const GroupKind& kind, const JsonPoints& points, const MapExtras& extras)
    : points_((require_plane(format, kind, points.dimension), points)),
      format_(std::move(format)),
      key_name_(std::move(key_name)),
      kind_(kind),
      out_(path),
      json_(text_) {
  if (format_ == "geojson") {
    text_ += "{\"type\": \"FeatureCollection\", " + crs_member(extras.crs) + "\"features\": [";
  } else if (format_ == "csv") {
    append_csv(text_, key_name_);
    text_ += plane() ? ",points" : ",points,affine_dimension";
    if (kind_.limit != nullptr) (text_ += ',') += kind_.limit;
    for (const char* const name : kind_.counts) (text_ += ',') += name;
    text_ += plane() ? ",perimeter,area,wkt\n" : ",area,volume\n";
  } else {
    json_.begin_document(kind_.document, points_);
    json_.member("by", key_name_);
    json_.key("groups");
    json_.begin_list(true);
  }
}

void GroupFile::add(const GroupRecord& group) {
  if (format_ == "csv")
    append_row(group);
  else if (format_ == "json")
    write_record(group);
  else
    append_feature(group);
  constexpr std::size_t long_text = std::size_t{1} << 20;
  if (text_.size() <= long_text) return;
  out_.write(text_);
  text_.clear();
}

void GroupFile::commit() {
  if (format_ == "geojson") text_ += "\n]}\n";
  if (format_ == "json") {
    json_.end_list();
    json_.end_document();
  }
  out_.write(text_);
  out_.commit();
}

/// In the plane the perimeter (twice a segment's length) and the area; else area and volume.
std::pair<double, double> GroupFile::measures_of(const GroupRecord& group) const {
  if (plane() && group.affine_dimension < 2) return {2 * group.volume, 0};
  return {group.area, group.volume};
}

void GroupFile::append_key(const GroupRecord& group) {
  if (group.numeric)
    text_ += group.key;
  else
    append_json_string(text_, group.key);
}

void GroupFile::append_feature(const GroupRecord& group) {
  const auto [perimeter, area] = measures_of(group);
  text_ += std::exchange(first_, false) ? "\n" : ",\n";
  text_ += "{\"type\": \"Feature\", \"properties\": {";
  append_json_string(text_, key_name_);
  text_ += ": ";
  append_key(group);
  text_ += ", \"points\": ";
  append_number(text_, group.points);
  const auto append_real = [&](const char* name, double value) {
    text_ += std::string(", \"") + name + "\": ";
    append_json_number(text_, value);
  };
  if (kind_.limit != nullptr) append_real(kind_.limit, group.limit);
  append_real("perimeter", perimeter);
  append_real("area", area);
  const char* const limit = kind_.limit != nullptr ? kind_.limit : "points";
  for (const PointColumn& column : group.columns)
    append_property(text_, column, group.number, {key_name_, "points", limit, "perimeter", "area"});
  text_ += "}, \"geometry\": ";
  append_geojson(text_, group.polygons());
  text_ += '}';
}

void GroupFile::append_row(const GroupRecord& group) {
  const auto append = [&](auto number) { append_number(text_ += ',', number); };
  append_csv(text_, group.key);
  append(group.points);
  if (!plane()) text_ += ',' + std::to_string(group.affine_dimension);
  if (kind_.limit != nullptr) append(group.limit);
  for (std::size_t i = 0; i < kind_.counts.size(); ++i) append(group.counts[i]);
  const auto [boundary, inside] = measures_of(group);
  append(boundary);
  append(inside);
  if (plane()) {
    text_ += ",\"";
    append_wkt(text_, group.polygons());
    text_ += '"';
  }
  text_ += '\n';
}

void GroupFile::write_record(const GroupRecord& group) {
  json_.item();
  json_.begin_object();
  json_.key("key");
  append_key(group);
  json_.member("points", group.points);
  json_.member("affine_dimension", group.affine_dimension);
  if (kind_.limit != nullptr) json_.member(kind_.limit, group.limit);
  put_measures(group.affine_dimension, group.area, group.volume,
               [&](const char* name, double measure) { json_.member(name, measure); });
  group.lists(json_);
  json_.end_object();
}

}  // namespace cullhull::internal
