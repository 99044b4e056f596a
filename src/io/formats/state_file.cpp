// HullState as a file.
#include <array>

#include "cullhull/point_blocks.hpp"
#include "io/file_formats.hpp"
#include "io/mapped_file.hpp"
#include "io/records.hpp"
#include "io/source.hpp"
#include "io/write/output_file.hpp"

namespace cullhull::internal {
namespace {

std::string_view as_text(const void* data, std::size_t size) {
  return {static_cast<const char*>(data), size};
}

std::uint32_t crc32(std::string_view bytes) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      t[i] = i;
      for (int k = 0; k < 8; ++k) t[i] = t[i] >> 1 ^ (t[i] & 1 ? 0xEDB88320U : 0);
    }
    return t;
  }();
  std::uint32_t c = 0xFFFFFFFFU;
  for (const char b : bytes) c = table[(c ^ static_cast<unsigned char>(b)) & 255] ^ c >> 8;
  return ~c;
}

void append(std::string& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out += static_cast<char>(value >> 8 * i & 255);
}

/// Writes members of a ZIP archive, uncompressed, as numpy.savez does.
class ZipWriter {
 public:
  explicit ZipWriter(OutputFile& out) : out_(out) {}

  void add(const std::string& name, const std::string& head, std::string_view body) {
    const std::string bytes = head + std::string(body);
    constexpr std::uint64_t most = 0xFFFFFFFF;
    if (bytes.size() + at_ > most)
      throw Error(ErrorCode::invalid_argument,
                  "a state of more than 4 GiB does not fit an .npz; write .hullstate");
    std::string record;
    append(record, 20, 2);                       // version needed
    append(record, 0, 4);                        // no flags, stored
    append(record, std::uint64_t{33} << 16, 4);  // time and date: 1980-01-01
    append(record, crc32(bytes), 4);
    append(record, bytes.size(), 4);
    append(record, bytes.size(), 4);
    append(record, name.size(), 2);
    append(record, 0, 2);
    central_ += "PK\x01\x02";
    append(central_, 20, 2);
    central_ += record;
    central_.append(10, '\0');  // no comment, disk 0, no attributes
    append(central_, at_, 4);
    central_ += name;
    put("PK\x03\x04" + record + name);
    put(bytes);
    ++count_;
  }
  void finish() {
    const std::uint64_t begin = at_;
    put(central_);
    std::string end = "PK\x05\x06";
    append(end, 0, 4);
    append(end, count_, 2);
    append(end, count_, 2);
    append(end, central_.size(), 4);
    append(end, begin, 4);
    append(end, 0, 2);
    put(end);
  }

 private:
  void put(const std::string& bytes) {
    out_.write(bytes);
    at_ += bytes.size();
  }
  OutputFile& out_;
  std::string central_;
  std::uint64_t at_ = 0, count_ = 0;
};

/// The bytes of `count` numbers, little-endian.
std::string packed(const void* numbers, std::size_t count, std::size_t size) {
  std::string bytes(static_cast<const char*>(numbers), count * size);
  little_endian_items(bytes.data(), bytes.size(), size);
  return bytes;
}

void write_npz(OutputFile& out, const HullState& state) {
  const PointView points = state.points();
  ZipWriter zip(out);
  zip.add("ids.npy", npy_header("<u8", {points.count}),
          packed(state.ids().data(), points.count, sizeof(std::uint64_t)));
  zip.add("points.npy",
          npy_header(npy_descr(points.scalar).c_str(), {points.count, points.dimension}),
          packed(points.data, points.count * points.dimension, scalar_size(points.scalar)));
  const std::uint64_t seen = state.point_count();
  zip.add("point_count.npy", npy_header("<u8", {1}), packed(&seen, 1, sizeof seen));
  zip.finish();
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

void write_state(const std::string& path, const HullState& state) {
  const std::string format = internal::output_format(path, "", "hullstate");
  if (!internal::holds(format, {internal::OutputKind::state}))
    internal::refuse_format(path, format, {internal::OutputKind::state});
  internal::OutputFile out(path);
  if (format == "npz") {
    internal::write_npz(out, state);
  } else {
    const std::vector<std::byte> bytes = state.to_bytes();
    out.write(internal::as_text(bytes.data(), bytes.size()));
  }
  out.commit();
}

HullState read_state(const std::string& path) {
  const internal::MappedFile file(path);
  const internal::Source& source = file.source();
  try {
    HullState state =
        HullState::from_bytes({reinterpret_cast<const std::byte*>(source.data), source.size});
    file.check_size();
    return state;
  } catch (const Error& e) {
    if (e.code() != ErrorCode::bad_file) throw;
    throw Error(e.code(), source.name, ": ", e.what());
  }
}

}  // namespace cullhull
