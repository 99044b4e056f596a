// LAS 1.0 to 1.4, all point formats, also compressed (LAZ, COPC): x y z as stored in the file,
// 32-bit integers; and some of a file's records as another.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "io/formats/las_fields.hpp"
#include "io/formats/laz.hpp"
#include "io/mapped_file.hpp"
#include "io/packed/unpack.hpp"
#include "io/records.hpp"
#include "io/source.hpp"
#include "io/write/mesh.hpp"
#include "io/write/output_file.hpp"
#include "parallel/byte_order.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {
namespace {

template <class T>
T field(const Source& head, std::size_t at) {
  return load_little_endian<T>(head.data + at);
}

/// Bytes that each point format has at least (ASPRS LAS 1.4 R15).
constexpr std::uint64_t least_record[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

/// Coordinates need a positive scale and a finite offset. Where the header has others, as one that
/// was never filled in, Numbers::raw alone can read the file, and there is no placement.
Placement placement_of(const Source& head, Numbers numbers) {
  Placement placement;
  for (std::size_t j = 0; j < 3; ++j) {
    const std::size_t at_scale = 131 + 8 * j, at_offset = 155 + 8 * j;
    const auto scale = field<double>(head, at_scale), offset = field<double>(head, at_offset);
    const bool scales = scale > 0 && std::isfinite(scale);
    if (!scales || !std::isfinite(offset)) {
      if (numbers == Numbers::raw) return {};
      std::string value;
      append_number(value, scales ? offset : scale);
      fail_at_byte(
          head, scales ? at_offset : at_scale, "the ", scales ? "offset" : "scale", " of ",
          "xyz"[j], " is ", value,
          ", which gives no coordinates; --raw (Python: raw=True) reads the stored integers");
    }
    placement.scale.push_back(scale);
    placement.offset.push_back(offset);
  }
  return placement;
}

LasHeader parse_header(const Source& head, Numbers numbers) {
  constexpr std::size_t oldest = 227, with_wide_count = 375;
  if (head.size < 4 || std::memcmp(head.data, "LASF", 4) != 0)
    fail_at_byte(head, 0, "does not begin as a .las file does");
  if (head.size < oldest) fail_at_byte(head, head.size, "ends within the LAS header");
  LasHeader h;
  const unsigned major = field<std::uint8_t>(head, 24);
  h.minor = field<std::uint8_t>(head, 25);
  if (major != 1 || h.minor > 4)
    fail_at_byte(head, 24, "LAS version ", major, ".", h.minor, "; 1.0 to 1.4 are known");
  const unsigned header_size = field<std::uint16_t>(head, 94);
  if (header_size < oldest || (h.minor == 4 && header_size < with_wide_count))
    fail_at_byte(head, 94, "LAS header of ", header_size, " bytes");
  h.header_size = header_size;
  h.offset = field<std::uint32_t>(head, 96);
  h.vlrs = field<std::uint32_t>(head, 100);
  const unsigned format = field<std::uint8_t>(head, 104);
  h.format = format & 0x3F;
  h.compressed = format != h.format;
  if (h.format >= std::size(least_record))
    fail_at_byte(head, 104, "LAS point format ", h.format, "; 0 to 10 are known");
  h.record = field<std::uint16_t>(head, 105);
  if (h.record < least_record[h.format])
    fail_at_byte(head, 105, "records of ", h.record, " bytes, but point format ", h.format,
                 " takes ", least_record[h.format]);
  h.count = field<std::uint32_t>(head, 107);
  if (h.minor == 4) {
    if (head.size < with_wide_count) fail_at_byte(head, head.size, "ends within the LAS header");
    h.count = field<std::uint64_t>(head, 247);
  }
  if (h.offset < header_size)
    fail_at_byte(head, 96, "points at byte ", h.offset, ", within the header");
  h.placement = placement_of(head, numbers);
  if (!h.placement.empty()) h.placement.unit = las_unit(head, header_size, h.vlrs);
  return h;
}

void check_room(const Source& head, const LasHeader& h, std::uint64_t size) {
  if (size == unknown_size) return;
  std::uint64_t bytes = 0;
  if (h.offset > size || !multiply(h.count, h.record, bytes) || bytes > size - h.offset)
    fail_at_byte(head, h.offset < size ? h.offset : size, h.count, " points of ", h.record,
                 " bytes need more than the ", h.offset < size ? size - h.offset : 0,
                 " bytes that follow");
}

PointData points_of_records(const std::string& file, const char* records, std::uint64_t count,
                            const LasHeader& h, const ReadOptions& options) {
  PointData data;
  data.format = "las 1." + std::to_string(h.minor) + ", point format " + std::to_string(h.format) +
                (h.compressed ? ", LAZ" : "");
  data.in_place = true;
  data.placement = h.placement;
  data.view = {reinterpret_cast<const std::byte*>(records),
               ScalarType::i32,
               3,
               count,
               static_cast<std::ptrdiff_t>(h.record),
               4};
  data = in_machine_order(std::move(data));
  choose_las_columns(data, records, h.record, h.format, file, options);
  return data;
}

RecordLayout layout_of_header(const Source& head, const LasHeader& h, const ReadOptions& options) {
  RecordLayout layout;
  const PointData none = points_of_records(head.name, nullptr, 0, h, options);
  layout.format = none.format;
  layout.offset = h.offset;
  layout.count = h.count;
  layout.record_bytes = h.record;
  layout.ends_file = false;
  layout.placement = none.placement;
  return layout;
}

/// The points [first, first + count) of a LAZ file, from the bytes of their chunks.
PointData points_of_chunks(const LazLayout& laz, const LasHeader& h, const Source& bytes,
                           std::uint64_t first, std::uint64_t count, const ReadOptions& options) {
  LazRows rows;
  rows.record = h.record;
  rows.needed = las_bytes(h.format, h.record, bytes.name, options);
  LasHeader decoded = h;
  if (!rows.needs(12, h.record - 12)) decoded.record = 12;  // x, y and z are what is needed
  rows.stride = decoded.record;
  const auto [from, to] = chunks_with(laz.chunks, first, count);
  std::uint64_t size = 0;
  for (std::size_t i = from; i < to; ++i) size += laz.chunks[i].count;
  std::optional<ReadLimit> limit;  // else what a header promises might exceed the memory
  if (ReadLimit::current() == nullptr) limit.emplace(bytes.name, options);
  if (!multiply(size, rows.stride, size)) ReadLimit::current()->refuse(size);
  Buffer room(std::max<std::uint64_t>(1, size));
  rows.out = room.as<char>();
  decode_chunks(laz, from, to, bytes, rows, options);
  const std::uint64_t skip = from < to ? first - laz.chunks[from].first : 0;
  PointData data =
      points_of_records(bytes.name, rows.out + skip * rows.stride, count, decoded, options);
  if (data.in_place) data.storage = std::move(room);
  data.in_place = false;
  return data;
}

}  // namespace

std::optional<RecordLayout> las_chunks(const Source& head, std::uint64_t size, const ReadAt& read,
                                       const ReadOptions& options) {
  const LasHeader h = parse_header(head, options.numbers);
  if (!h.compressed) return std::nullopt;
  const auto laz = std::make_shared<const LazLayout>(laz_layout(head.name, h, size, read));
  RecordLayout layout = layout_of_header(head, h, options);
  layout.chunks = laz->chunks;
  if (!laz->chunks.empty()) layout.offset = laz->chunks[0].offset;
  layout.decode = [laz, h, options](const Source& bytes, std::uint64_t first, std::uint64_t count) {
    return points_of_chunks(*laz, h, bytes, first, count, options);
  };
  return layout;
}

std::optional<RecordLayout> las_records(const Source& head, std::uint64_t size,
                                        const ReadOptions& options) {
  const LasHeader h = parse_header(head, options.numbers);
  if (h.compressed) return std::nullopt;
  check_room(head, h, size);
  RecordLayout layout = layout_of_header(head, h, options);
  layout.decode = [h, options](const Source& records, std::uint64_t, std::uint64_t count) {
    return points_of_records(records.name, records.data, count, h, options);
  };
  return layout;
}

namespace {

template <class T>
void put(std::string& head, std::size_t at, T value) {
  value = little_endian(value);
  head.replace(at, sizeof value, reinterpret_cast<const char*>(&value), sizeof value);
}

/// What a header says of the points: how many, how many of each return, where they are.
class Census {
 public:
  explicit Census(const LasHeader& h) : h_(h) {}

  void count(const char* record) {
    ++count_;
    const unsigned bits = static_cast<unsigned char>(record[14]);
    const unsigned nth = h_.format < 6 ? bits & 7 : bits & 15;
    if (nth > 0) ++returns_[nth - 1];
    for (std::size_t j = 0; j < 3; ++j) {
      const auto x = load_little_endian<std::int32_t>(record + 4 * j);
      least_[j] = count_ == 1 ? x : std::min(least_[j], x);
      greatest_[j] = count_ == 1 ? x : std::max(greatest_[j], x);
    }
  }
  /// The numbers of 32 bits are zero where they cannot tell, as LAS 1.4 wants it.
  void write(std::string& head) const {
    const bool legacy = h_.minor < 4 || h_.format < 6;
    const bool narrow = legacy && count_ <= std::numeric_limits<std::uint32_t>::max();
    put(head, 107, static_cast<std::uint32_t>(narrow ? count_ : 0));
    for (std::size_t i = 0; i < 5; ++i)
      put(head, 111 + 4 * i, static_cast<std::uint32_t>(narrow ? returns_[i] : 0));
    if (h_.minor == 4) {
      put(head, 247, count_);
      for (std::size_t i = 0; i < 15; ++i) put(head, 255 + 8 * i, returns_[i]);
    }
    for (std::size_t j = 0; j < 3 && count_ > 0; ++j) {
      const auto scale = load_little_endian<double>(head.data() + 131 + 8 * j);
      const auto offset = load_little_endian<double>(head.data() + 155 + 8 * j);
      double ends[] = {greatest_[j] * scale + offset, least_[j] * scale + offset};
      // No box can be told where scale or offset give no coordinates (Numbers::raw).
      if (!std::isfinite(ends[0]) || !std::isfinite(ends[1])) ends[0] = ends[1] = 0;
      put(head, 179 + 16 * j, std::max(ends[0], ends[1]));
      put(head, 187 + 16 * j, std::min(ends[0], ends[1]));
    }
  }

 private:
  const LasHeader& h_;
  std::uint64_t count_ = 0, returns_[15] = {};
  std::int32_t least_[3] = {}, greatest_[3] = {};
};

/// The header's places of records behind the points: waveforms, extended ones.
std::vector<std::size_t> places_behind(const std::string& head, const LasHeader& h) {
  std::vector<std::size_t> places;
  for (const std::size_t at : {std::size_t{227}, std::size_t{235}})
    if (h.minor >= (at == 227 ? 3U : 4U) && at + 8 <= h.header_size &&
        load_little_endian<std::uint64_t>(head.data() + at) > h.offset)
      places.push_back(at);
  return places;
}

/// What is written: the header, records and what is behind them.
class Kept {
 public:
  Kept(const Source& las, const std::vector<std::uint64_t>& ids)
      : las_(las), ids_(ids), h_(parse_header(las, Numbers::raw)) {
    for (std::size_t i = 0; i < ids.size(); ++i)
      if (ids[i] >= h_.count || (i > 0 && ids[i] <= ids[i - 1]))
        throw Error(ErrorCode::invalid_argument, las.name, ": ids must ascend below ", h_.count);
    if (!h_.compressed) check_room(las, h_, las.size);
    head_.assign(las.data, std::min<std::uint64_t>(h_.offset, las.size));
    end_ = h_.offset + h_.count * h_.record;
    if (h_.compressed) unpack();
  }

  void write(OutputFile& out) {
    Census census(h_);
    for (std::size_t i = 0; i < ids_.size(); ++i) census.count(record(i));
    census.write(head_);
    const std::uint64_t end = head_.size() + ids_.size() * h_.record;
    for (const std::size_t at : places_behind(head_, h_)) {
      const auto where = load_little_endian<std::uint64_t>(head_.data() + at);
      if (where >= end_) put(head_, at, where - end_ + end);
    }
    out.write(head_);
    for (std::size_t i = 0; i < ids_.size(); ++i) out.write({record(i), h_.record});
    out.write({las_.data + end_, las_.size - end_});
  }

 private:
  const char* record(std::size_t i) const {
    return h_.compressed ? records_.data() + i * h_.record
                         : las_.data + h_.offset + ids_[i] * h_.record;
  }

  /// Decodes the records of a LAZ file and takes from its header that it is one.
  void unpack() {
    const LazLayout laz = laz_layout(las_.name, h_, las_.size, reader_of(las_));
    records_.resize(ids_.size() * h_.record);
    for_each_chunk(laz.chunks.size(), 1, resolve_threads(0),
                   [&](std::uint64_t c, std::uint64_t, std::uint64_t) { unpack(laz, c); });
    end_ = las_.size;
    for (const std::size_t at : places_behind(head_, h_))
      end_ = std::min(end_, load_little_endian<std::uint64_t>(head_.data() + at));
    head_.erase(laz.vlr, laz.vlr_bytes);
    put(head_, 96, static_cast<std::uint32_t>(head_.size()));
    put(head_, 100, static_cast<std::uint32_t>(h_.vlrs - 1));
    put(head_, 104, static_cast<std::uint8_t>(h_.format));
  }
  void unpack(const LazLayout& laz, std::size_t number) {
    const RecordChunk& chunk = laz.chunks[number];
    const auto from = std::lower_bound(ids_.begin(), ids_.end(), chunk.first);
    const auto to = std::lower_bound(from, ids_.end(), chunk.first + chunk.count);
    if (from == to) return;
    const Buffer room(chunk.count * h_.record);
    const LazRows rows{room.as<char>(), h_.record, h_.record, std::vector<bool>(h_.record, true)};
    ReadOptions alone;
    alone.threads = 1;
    decode_chunks(laz, number, number + 1,
                  {las_.name, las_.data + chunk.offset, static_cast<std::size_t>(chunk.bytes)},
                  rows, alone);
    char* out = records_.data() + (from - ids_.begin()) * static_cast<std::ptrdiff_t>(h_.record);
    for (auto id = from; id < to; ++id, out += h_.record)
      std::copy_n(room.as<char>() + (*id - chunk.first) * h_.record, h_.record, out);
  }

  const Source& las_;
  const std::vector<std::uint64_t>& ids_;
  LasHeader h_;
  std::string head_;
  std::string records_;    ///< of LAZ
  std::uint64_t end_ = 0;  ///< of the points in the file
};

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

void write_las_records(const std::string& path, const std::string& las,
                       const std::vector<std::uint64_t>& ids) {
  using namespace internal;
  if (const std::string f = output_format(path, "", "las"); f != "las")
    refuse_format(path, f, {OutputKind::records});
  const InputName input = split_input(las);
  const MappedFile file(input.file);
  Source source = file.source();
  ReadOptions options;
  RawArray<char> unpacked;
  unwrap(input, source, options, unpacked);
  Kept kept(source, ids);
  OutputFile out(path);
  kept.write(out);
  out.commit();
}

}  // namespace cullhull
