#include "io/formats/las_fields.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>

#include "cullhull/placement.hpp"
#include "io/columns.hpp"
#include "io/grid_axes.hpp"
#include "io/text/lines.hpp"
#include "parallel/byte_order.hpp"

namespace cullhull::internal {
namespace {

using Kind = LasField::Kind;

constexpr unsigned first_extended = 6;  ///< the point formats from here on came with LAS 1.4

void add_colours(std::vector<LasField>& fields, unsigned offset) {
  for (const char* name : {"red", "green", "blue"}) {
    fields.push_back({name, offset, Kind::u16});
    offset += 2;
  }
}

std::vector<LasField> fields_of(unsigned format) {
  if (format < first_extended) {
    std::vector<LasField> fields{{"intensity", 12, Kind::u16},
                                 {"return_number", 14, Kind::bits, 0, 3},
                                 {"number_of_returns", 14, Kind::bits, 3, 3},
                                 {"scan_direction_flag", 14, Kind::bits, 6, 1},
                                 {"edge_of_flight_line", 14, Kind::bits, 7, 1},
                                 {"classification", 15, Kind::bits, 0, 5},
                                 {"synthetic", 15, Kind::bits, 5, 1},
                                 {"key_point", 15, Kind::bits, 6, 1},
                                 {"withheld", 15, Kind::bits, 7, 1},
                                 {"scan_angle_rank", 16, Kind::i8},
                                 {"user_data", 17, Kind::u8},
                                 {"point_source_id", 18, Kind::u16}};
    const bool timed = format != 0 && format != 2;
    if (timed) fields.push_back({"gps_time", 20, Kind::f64});
    if (format == 2) add_colours(fields, 20);
    if (format == 3 || format == 5) add_colours(fields, 28);
    return fields;
  }
  std::vector<LasField> fields{{"intensity", 12, Kind::u16},
                               {"return_number", 14, Kind::bits, 0, 4},
                               {"number_of_returns", 14, Kind::bits, 4, 4},
                               {"synthetic", 15, Kind::bits, 0, 1},
                               {"key_point", 15, Kind::bits, 1, 1},
                               {"withheld", 15, Kind::bits, 2, 1},
                               {"overlap", 15, Kind::bits, 3, 1},
                               {"scanner_channel", 15, Kind::bits, 4, 2},
                               {"scan_direction_flag", 15, Kind::bits, 6, 1},
                               {"edge_of_flight_line", 15, Kind::bits, 7, 1},
                               {"classification", 16, Kind::u8},
                               {"user_data", 17, Kind::u8},
                               {"scan_angle", 18, Kind::i16},
                               {"point_source_id", 20, Kind::u16},
                               {"gps_time", 22, Kind::f64}};
  const bool coloured = format == 7 || format == 8 || format == 10;
  if (coloured) add_colours(fields, 30);
  if (format == 8 || format == 10) fields.push_back({"nir", 36, Kind::u16});
  return fields;
}

/// x, y, z and the fields of one format.
class Columns {
 public:
  explicit Columns(unsigned format) : fields_(las_fields(format)), names_{"x", "y", "z"} {
    for (const LasField& f : fields_) names_.push_back(f.name);
  }
  const std::vector<std::string>& names() const { return names_; }
  static bool is_axis(std::uint32_t column) { return column < axes; }
  const LasField& field(std::uint32_t column) const { return fields_[column - axes]; }

 private:
  static constexpr std::uint32_t axes = 3;
  const std::vector<LasField>& fields_;
  std::vector<std::string> names_;
};

void append(PointKeys& keys, double value) {
  char text[40];
  const auto r = std::to_chars(text, text + sizeof text, value);
  keys.add({text, static_cast<std::size_t>(r.ptr - text)});
}

/// Sets data.view to the chosen columns of all points, in storage of its own. Columns are axes (x,
/// y, z), which data.view has already, and other fields of the records (intensity, GPS time), read
/// from `records`, `record` bytes each. If any chosen field is a double, axes are world coordinates
/// unless options.numbers is file, as there is no grid of all columns; else data.placement keeps
/// the axes' grid.
void gather(PointData& data, const Columns& all, const char* records, std::size_t record,
            const std::vector<std::uint32_t>& columns, const ReadOptions& options) {
  const PointView from = data.view;
  const Placement axes = data.placement;
  const auto is_time = [&](std::uint32_t c) {
    return !Columns::is_axis(c) && all.field(c).kind == Kind::f64;
  };
  const bool timed = std::any_of(columns.begin(), columns.end(), is_time);
  const bool in_world = timed && options.numbers != Numbers::raw;
  const auto d = static_cast<std::uint32_t>(columns.size());
  Buffer room(std::max<std::uint64_t>(1, from.count * d * sizeof(double)));
  auto* out = room.as<double>();
  constexpr std::uint64_t between_checks = std::uint64_t{1} << 16;
  for (std::uint64_t i = 0; i < from.count; ++i) {
    if (i % between_checks == 0) check_stop(options);
    for (const std::uint32_t c : columns) {
      const double x = Columns::is_axis(c) ? from.at(i, c) : all.field(c).of(records + i * record);
      *out++ = in_world && Columns::is_axis(c) ? axes.at(c, x) : x;
    }
  }
  data.placement = {};
  if (!timed && !axes.empty()) data.placement.unit = axes.unit;
  for (const std::uint32_t c : columns) {
    if (timed || axes.empty()) break;
    data.placement.scale.push_back(Columns::is_axis(c) ? axes.scale[c] : 1);
    data.placement.offset.push_back(Columns::is_axis(c) ? axes.offset[c] : 0);
  }
  data.storage = std::move(room);
  data.in_place = false;
  data.view = PointView::row_major(data.storage.as<const double>(), from.count, d);
}

}  // namespace

const std::vector<LasField>& las_fields(unsigned format) {
  static const std::vector<std::vector<LasField>> all = [] {
    std::vector<std::vector<LasField>> fields;
    for (unsigned f = 0; f <= 10; ++f) fields.push_back(fields_of(f));
    return fields;
  }();
  return all[format];
}

double LasField::of(const char* record) const {
  const char* const at = record + offset;
  switch (kind) {
    case Kind::bits:
      return static_cast<unsigned char>(*at) >> shift & ((1U << width) - 1);
    case Kind::i8:
      return load_little_endian<std::int8_t>(at);
    case Kind::u8:
      return load_little_endian<std::uint8_t>(at);
    case Kind::i16:
      return load_little_endian<std::int16_t>(at);
    case Kind::u16:
      return load_little_endian<std::uint16_t>(at);
    case Kind::f64:
      return load_little_endian<double>(at);
  }
  return 0;
}

unsigned LasField::bytes() const {
  if (kind == Kind::f64) return 8;
  return kind == Kind::i16 || kind == Kind::u16 ? 2 : 1;
}

std::vector<bool> las_bytes(unsigned format, std::size_t record, const std::string& file,
                            const ReadOptions& options) {
  std::vector<bool> bytes(record);
  const auto need = [&](std::size_t at, std::size_t size) {
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), size, true);
  };
  const Columns all(format);
  constexpr std::uint32_t axes = 3, axis_bytes = 4;
  std::vector<std::uint32_t> columns =
      find_columns(options.columns.empty() ? ":" : options.columns, file, all.names(), axes);
  if (!options.key.empty()) columns.push_back(find_key(options, file, all.names(), axes, columns));
  for (const std::uint32_t c : columns)
    if (Columns::is_axis(c))
      need(std::size_t{axis_bytes} * c, axis_bytes);
    else
      need(all.field(c).offset, all.field(c).bytes());
  return bytes;
}

void choose_las_columns(PointData& data, const char* records, std::size_t record, unsigned format,
                        const std::string& file, const ReadOptions& options) {
  data.chosen = true;
  if (options.columns.empty() && options.key.empty()) return;
  const Columns all(format);
  constexpr std::uint32_t axes = 3;
  std::vector<std::uint32_t> columns =
      find_columns(options.columns.empty() ? ":" : options.columns, file, all.names(), axes);
  const std::uint32_t key = find_key(options, file, all.names(), axes, columns);
  const bool placed = !stays(options.numbers) && !data.placement.empty();
  const Grid grid = placed ? common_grid({data.placement}) : Grid();
  std::optional<GridAxes> on_grid;
  if (!grid.empty()) on_grid.emplace(data.placement, grid);
  const auto coordinate = [&](std::uint64_t i, std::uint32_t axis) {
    const double number = data.view.at(i, axis);
    if (!placed) return number;
    return on_grid ? grid.to_world(on_grid->at(axis, number)) : data.placement.at(axis, number);
  };
  if (!options.key.empty())
    for (std::uint64_t i = 0; i < data.view.count; ++i)
      append(data.keys,
             Columns::is_axis(key) ? coordinate(i, key) : all.field(key).of(records + i * record));
  data.columns = column_labels(columns, all.names());
  if (std::all_of(columns.begin(), columns.end(), Columns::is_axis))
    take_columns(data, columns);
  else
    gather(data, all, records, record, columns, options);
}

}  // namespace cullhull::internal
