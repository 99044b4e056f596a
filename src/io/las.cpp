// LAS 1.0 to 1.4, all point formats: x y z as they are in the file, whole numbers of 32 bits.
#include <cstring>
#include <memory>

#include "io/records.hpp"
#include "io/source.hpp"
#include "parallel/byte_order.hpp"

namespace cullhull::internal {
namespace {

template <class T>
T field(const Source& head, std::size_t at) {
  return load_little_endian<T>(head.data + at);
}

struct LasHeader {
  unsigned minor = 0, format = 0;
  std::uint64_t offset = 0, record = 0, count = 0;
};

/// Bytes that each point format has at least (ASPRS LAS 1.4 R15).
constexpr std::uint64_t least_record[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

LasHeader parse_header(const Source& head) {
  constexpr std::size_t oldest = 227, with_wide_count = 375;
  if (head.size < 4 || std::memcmp(head.data, "LASF", 4) != 0)
    fail_at_byte(head, 0, "does not begin as a .las file does");
  if (head.size < oldest) fail_at_byte(head, head.size, "ends within the LAS header");
  LasHeader h;
  const unsigned major = field<std::uint8_t>(head, 24);
  h.minor = field<std::uint8_t>(head, 25);
  if (major != 1 || h.minor > 4)
    fail_at_byte(head, 24,
                 "LAS version " + std::to_string(major) + "." + std::to_string(h.minor) +
                     "; 1.0 to 1.4 are known");
  const unsigned header_size = field<std::uint16_t>(head, 94);
  if (header_size < oldest || (h.minor == 4 && header_size < with_wide_count))
    fail_at_byte(head, 94, "LAS header of " + std::to_string(header_size) + " bytes");
  h.offset = field<std::uint32_t>(head, 96);
  const unsigned format = field<std::uint8_t>(head, 104);
  h.format = format & 0x3F;
  if (format != h.format)
    fail(
        head,
        "holds compressed points (LAZ), which the Python package alone reads: cullhull.read(path)");
  if (h.format >= std::size(least_record))
    fail_at_byte(head, 104, "LAS point format " + std::to_string(h.format) + "; 0 to 10 are known");
  h.record = field<std::uint16_t>(head, 105);
  if (h.record < least_record[h.format])
    fail_at_byte(head, 105,
                 "records of " + std::to_string(h.record) + " bytes, but point format " +
                     std::to_string(h.format) + " takes " + std::to_string(least_record[h.format]));
  h.count = field<std::uint32_t>(head, 107);
  if (h.minor == 4) {
    if (head.size < with_wide_count) fail_at_byte(head, head.size, "ends within the LAS header");
    h.count = field<std::uint64_t>(head, 247);
  }
  if (h.offset < header_size)
    fail_at_byte(head, 96, "points at byte " + std::to_string(h.offset) + ", within the header");
  return h;
}

void check_room(const Source& head, const LasHeader& h, std::uint64_t size) {
  if (size == unknown_size) return;
  std::uint64_t bytes = 0;
  if (h.offset > size || !multiply(h.count, h.record, bytes) || bytes > size - h.offset)
    fail_at_byte(head, h.offset < size ? h.offset : size,
                 std::to_string(h.count) + " points of " + std::to_string(h.record) +
                     " bytes need more than the " +
                     std::to_string(h.offset < size ? size - h.offset : 0) + " bytes that follow");
}

PointData points_of_records(const char* records, std::uint64_t count, const LasHeader& h) {
  PointData data;
  data.format = "las 1." + std::to_string(h.minor) + ", point format " + std::to_string(h.format);
  data.in_place = true;
  data.view = {reinterpret_cast<const std::byte*>(records),
               ScalarType::i32,
               3,
               count,
               static_cast<std::ptrdiff_t>(h.record),
               4};
  return in_machine_order(std::move(data));
}

}  // namespace

PointData read_las(const Source& source, const ReadOptions&) {
  const LasHeader h = parse_header(source);
  check_room(source, h, source.size);
  return points_of_records(source.data + h.offset, h.count, h);
}

std::optional<RecordLayout> las_records(const Source& head, std::uint64_t size) {
  const LasHeader h = parse_header(head);
  check_room(head, h, size);
  RecordLayout layout;
  layout.format = points_of_records(nullptr, 0, h).format;
  layout.offset = h.offset;
  layout.count = h.count;
  layout.record_bytes = h.record;
  layout.ends_file = false;
  layout.decode = [h](const Source& records, std::uint64_t, std::uint64_t count) {
    return points_of_records(records.data, count, h);
  };
  return layout;
}

}  // namespace cullhull::internal
