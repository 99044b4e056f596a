#include "io/formats/record_fields.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "io/records.hpp"
#include "io/text/lines.hpp"
#include "parallel/byte_order.hpp"

namespace cullhull::internal {

std::optional<ScalarType> FieldType::scalar() const {
  if (kind == 'f') return size == 4 ? ScalarType::f32 : ScalarType::f64;
  const bool u = kind == 'u';
  if (size == 1) return u ? ScalarType::u8 : ScalarType::i8;
  if (size == 2) return u ? ScalarType::u16 : ScalarType::i16;
  if (size == 4) return u ? ScalarType::u32 : ScalarType::i32;
  return std::nullopt;
}

bool FieldType::load(const char* p, double& out) const {
  char bytes[8];
  if (swapped)
    std::reverse_copy(p, p + size, bytes);
  else
    std::memcpy(bytes, p, size);
  if (const std::optional<ScalarType> viewed = scalar()) {
    out = PointView{reinterpret_cast<const std::byte*>(bytes), *viewed, 1, 1, 0, 0}.at(0, 0);
    return true;
  }
  std::uint64_t bits;
  std::memcpy(&bits, bytes, 8);
  return kind == 'i' ? exact_double(static_cast<std::int64_t>(bits), out) : exact_double(bits, out);
}

FieldType field_type(ScalarType type, bool big_endian) {
  return {scalar_name(type)[0], scalar_size(type), big_endian == little_endian_machine};
}

namespace {

PointData as_doubles(const Source& records, const std::vector<NumberField>& fields,
                     std::uint64_t count, std::uint64_t first, std::string format,
                     const ReadOptions& options) {
  const auto d = static_cast<std::uint32_t>(fields.size());
  PointData data = parsed_points(count, d, std::move(format));
  double* const out = data.storage.as<double>();
  std::atomic<std::uint64_t> bad{count * d};
  for_each_chunk(count, std::uint64_t{1} << 16, resolve_threads(options.threads),
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
    check_stop(options);
    for (std::uint64_t i = begin * d; i < end * d; ++i) {
      const NumberField& f = fields[i % d];
      if (f.type.load(records.data + f.begin + i / d * f.step, out[i])) continue;
      std::uint64_t seen = bad.load();
      while (i < seen && !bad.compare_exchange_weak(seen, i)) {
      }
      return;
    }
  });
  if (bad < count * d)
    fail({records.name, nullptr, 0}, "field ", quoted_text(fields[bad % d].name), " of point ",
         first + bad / d, " is a 64-bit integer that no double equals");
  return data;
}

}  // namespace

PointData points_of_fields(const Source& records, const std::vector<NumberField>& fields,
                           std::uint64_t count, std::uint64_t first, std::string format,
                           const ReadOptions& options) {
  const NumberField& x = fields[0];
  const auto apart = [&](std::size_t j) {
    return static_cast<std::ptrdiff_t>(fields[j].begin - fields[j - 1].begin);
  };
  bool alike = x.type.scalar().has_value();
  for (std::size_t j = 1; j < fields.size(); ++j) {
    const FieldType& other = fields[j].type;
    alike = alike && other.kind == x.type.kind && other.size == x.type.size &&
            other.swapped == x.type.swapped && apart(j) == apart(1);
  }
  if (!alike || (x.type.swapped && little_endian_machine))
    return as_doubles(records, fields, count, first, std::move(format), options);
  PointData data;
  data.format = std::move(format);
  data.in_place = true;
  data.view = {reinterpret_cast<const std::byte*>(records.data + x.begin),
               *x.type.scalar(),
               static_cast<std::uint32_t>(fields.size()),
               count,
               static_cast<std::ptrdiff_t>(x.step),
               fields.size() > 1 ? apart(1) : 0};
  if (x.type.swapped) return with_reversed_bytes(std::move(data));
  return data;
}

ChosenFields fields_to_read(const ReadOptions& options, const std::string& file,
                            std::vector<std::uint32_t> axes,
                            const std::vector<std::pair<std::string, std::uint32_t>>& others) {
  if (options.columns.empty() && options.key.empty()) return {std::move(axes), false, {}};
  std::vector<std::string> names{"x", "y", "z"};
  names.resize(axes.size());
  const auto width = static_cast<std::uint32_t>(axes.size());
  for (const auto& [name, field] : others) {
    names.push_back(name);
    axes.push_back(field);
  }
  ChosenFields chosen = choose_fields(options, file, names, width);
  for (std::uint32_t& c : chosen.columns) c = axes[c];
  return chosen;
}

}  // namespace cullhull::internal
