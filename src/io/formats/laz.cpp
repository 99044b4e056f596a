#include "io/formats/laz.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "io/formats/laz_models.hpp"
#include "parallel/byte_order.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {
namespace {

constexpr std::uint32_t variable_size = 0xFFFFFFFF;  // of chunks

/// The record of LASzip, which says how points are compressed.
struct Compression {
  enum : unsigned { one_chunk = 1, chunks = 2, layers = 3 };
  unsigned kind = 0;
  std::uint32_t chunk_points = 0;
  std::vector<LazItem> items;
};

/// More points than a byte can hold. Each takes a symbol of a model of at least 64, of which the
/// other 63 keep 2^-15 each: so at least log2(1 / (1 - 63 / 2^15)) bits, and a byte 2881 points.
constexpr std::uint64_t most_points_a_byte = 3000;

class LazParser {
 public:
  LazParser(const std::string& file, const LasHeader& header, std::uint64_t size,
            const ReadAt& read)
      : source_{file, nullptr, 0}, h_(header), size_(size), read_(read) {}

  LazLayout layout() const {
    LazLayout laz;
    const Compression compression = find_compression(laz);
    laz.items = compression.items;
    laz.layered = compression.kind == Compression::layers;
    if (h_.count > 0) laz.chunks = chunks(compression);
    return laz;
  }

 private:
  std::string bytes(std::uint64_t at, std::uint64_t size) const {
    if (at > size_ || size > size_ - at)
      fail_at_byte(source_, size_, "ends before byte ", at, " + ", size);
    std::string all(size, '\0');
    read_(all.data(), size, at);
    return all;
  }
  template <class T>
  static T number(const std::string& bytes, std::size_t at) {
    return load_little_endian<T>(bytes.data() + at);
  }

  Compression find_compression(LazLayout& laz) const {
    constexpr std::uint64_t head = 54;
    constexpr std::string_view user("laszip encoded\0\0", 16);
    std::uint64_t at = h_.header_size;
    for (std::uint64_t i = 0; i < h_.vlrs && at + head <= h_.offset; ++i) {
      const std::string record = bytes(at, head);
      const auto size = number<std::uint16_t>(record, 20);
      if (record.compare(2, user.size(), user) == 0 && number<std::uint16_t>(record, 18) == 22204) {
        laz.vlr = at;
        laz.vlr_bytes = std::min(head + size, h_.offset - at);
        return parse(at + head, bytes(at + head, size));
      }
      at += head + size;
    }
    fail_at_byte(source_, h_.header_size,
                 "the points are compressed (LAZ), but no record 'laszip encoded' says how");
  }

  Compression parse(std::uint64_t at, const std::string& record) const {
    constexpr std::size_t head = 34, item = 6;
    if (record.size() < head)
      fail_at_byte(source_, at, "a laszip record of ", record.size(), " bytes");
    Compression c;
    c.kind = number<std::uint16_t>(record, 0);
    if (c.kind < Compression::one_chunk || c.kind > Compression::layers)
      fail_at_byte(source_, at, "LAZ compressor ", c.kind, "; 1 to 3 are known");
    if (const auto coder = number<std::uint16_t>(record, 2); coder != 0)
      fail_at_byte(source_, at + 2, "LAZ coder ", coder, "; 0 alone is known");
    c.chunk_points = number<std::uint32_t>(record, 12);
    if (c.chunk_points == 0 && c.kind != Compression::one_chunk)
      fail_at_byte(source_, at + 12, "chunks of 0 points");
    const std::size_t items = number<std::uint16_t>(record, 32);
    if (record.size() < head + items * item)
      fail_at_byte(source_, at + 32, items, " items, which the laszip record cannot hold");
    std::uint64_t bytes = 0;
    for (std::size_t i = 0; i < items; ++i) {
      const std::size_t from = head + i * item;
      c.items.push_back({static_cast<LazItem::Type>(number<std::uint16_t>(record, from)),
                         number<std::uint16_t>(record, from + 2),
                         number<std::uint16_t>(record, from + 4)});
      check(c, c.items.back(), i == 0, at + from);
      bytes += c.items.back().size;
    }
    if (bytes != h_.record)
      fail_at_byte(source_, at + head, "LAZ items of ", bytes, " bytes for records of ", h_.record);
    return c;
  }

  void check(const Compression& c, const LazItem& item, bool first, std::uint64_t at) const {
    constexpr unsigned any = 0,
                       sizes[] = {any, any, any, any, any, any, 20, 8, 6, 29, 30, 6, 8, 29, any};
    const bool layered = c.kind == Compression::layers;
    const unsigned type = item.type;
    const bool known = layered ? type >= LazItem::point14 && type <= LazItem::bytes14
                               : type == 0 || (type >= LazItem::point10 && type < LazItem::point14);
    if (!known || (item.type == LazItem::point14 || item.type == LazItem::point10) != first ||
        layered != (h_.format > 5))
      fail_at_byte(source_, at, "LAZ item ", type, ", which is unknown in point format ",
                   h_.format);
    if (item.size == 0 || (sizes[type] != any && item.size != sizes[type]))
      fail_at_byte(source_, at + 2, "LAZ item ", type, " of ", item.size, " bytes");
    const unsigned least = layered ? 3 : 1;
    if (item.version < least || item.version > least + 1)
      fail_at_byte(source_, at + 4, "LAZ item ", type, " of version ", item.version, "; ", least,
                   " and ", least + 1, " are known");
  }

  /// Where the chunk table begins. Its place stands before the points or, where a pipe was written,
  /// at the end of the file.
  std::uint64_t find_table() const {
    std::uint64_t said_at = h_.offset;
    auto at = number<std::int64_t>(bytes(said_at, 8), 0);
    if (at == -1 && size_ > said_at + 8) {
      said_at = size_ - 8;
      at = number<std::int64_t>(bytes(said_at, 8), 0);
    }
    const std::uint64_t first = h_.offset + 8;
    if (at < 0 || static_cast<std::uint64_t>(at) < first ||
        static_cast<std::uint64_t>(at) > size_ - 8)
      fail_at_byte(source_, said_at, "the chunk table is at byte ", at, " of ", size_,
                   "; the file is cut short or was never finished");
    return static_cast<std::uint64_t>(at);
  }

  std::vector<RecordChunk> chunks(const Compression& c) const {
    if (c.kind == Compression::one_chunk) {
      const std::uint64_t bytes = size_ - std::min(size_, h_.offset);
      if (bytes < h_.record || h_.count / most_points_a_byte > bytes)
        fail_at_byte(source_, size_, h_.count, " points cannot be in ", bytes, " bytes");
      return {{0, h_.count, h_.offset, bytes}};
    }
    const std::uint64_t table = find_table(), first = h_.offset + 8;
    const std::string head = bytes(table, 8);
    const std::uint64_t count = number<std::uint32_t>(head, 4);
    if (number<std::uint32_t>(head, 0) != 0)
      fail_at_byte(source_, table, "chunk table of version ", number<std::uint32_t>(head, 0));
    if (count > (table - first) / h_.record)  // each begins with a record as it is
      fail_at_byte(source_, table + 4, count, " chunks in ", table - first, " bytes");
    try {
      return parse_table(c, count, table);
    } catch (const LazDamage& damage) {
      fail_at_byte(source_, table, "the chunk table is damaged: ", damage.what);
    }
  }

  std::vector<RecordChunk> parse_table(const Compression& c, std::uint64_t count,
                                       std::uint64_t table) const {
    constexpr std::uint64_t most = 16;  // bytes of an entry: two numbers of at most 54 bits
    const std::string coded = bytes(table + 8, std::min(size_ - table - 8, most * count + most));
    LazDecoder decoder(coded.data(), coded.data() + coded.size());
    LazIntegers numbers(32, 2);
    std::vector<RecordChunk> chunks;
    std::uint64_t point = 0, at = h_.offset + 8;
    std::int32_t points = 0, size = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
      std::uint64_t here = std::min<std::uint64_t>(c.chunk_points, h_.count - point);
      if (c.chunk_points == variable_size)
        here = static_cast<std::uint32_t>(points = numbers.next(decoder, points, 0));
      size = numbers.next(decoder, size, 1);
      const std::uint64_t taken = static_cast<std::uint32_t>(size);
      if (here > h_.count - point) fail_points(table, i + 1, point + here);
      if (taken > table - at || (here > 0 && taken < h_.record) ||
          here / most_points_a_byte > taken)
        fail_at_byte(source_, table, "chunk ", i, " of ", here, " points takes ", taken,
                     " bytes from byte ", at);
      if (here > 0) chunks.push_back({point, here, at, taken});
      point += here;
      at += taken;
    }
    if (point != h_.count) fail_points(table, count, point);
    return chunks;
  }
  [[noreturn]] void fail_points(std::uint64_t table, std::uint64_t chunks,
                                std::uint64_t points) const {
    fail_at_byte(source_, table, chunks, " chunks hold ", points, " points, the header says ",
                 h_.count);
  }

  Source source_;
  const LasHeader& h_;
  std::uint64_t size_;
  const ReadAt& read_;
};

}  // namespace

LazLayout laz_layout(const std::string& file, const LasHeader& header, std::uint64_t size,
                     const ReadAt& read) {
  return LazParser(file, header, size, read).layout();
}

void decode_chunks(const LazLayout& laz, std::size_t from, std::size_t to, const Source& bytes,
                   const LazRows& rows, const ReadOptions& options) {
  const RecordChunk* const first = laz.chunks.data() + from;
  const auto decode = [&](std::uint64_t i) {
    check_stop(options);
    const RecordChunk& c = first[i];
    const char* const begin = bytes.data + (c.offset - first->offset);
    LazRows own = rows;
    own.out += (c.first - first->first) * rows.stride;
    try {
      (laz.layered ? decode_layers : decode_points)({begin, begin + c.bytes, c.count}, laz.items,
                                                    own, options);
    } catch (const LazDamage& damage) {
      fail_at_byte(bytes, c.offset, "chunk ", from + i, " of ", laz.chunks.size(),
                   " is damaged: ", damage.what);
    }
  };
  for_each_chunk(to - from, 1, resolve_threads(options.threads),
                 [&](std::uint64_t, std::uint64_t i, std::uint64_t) { decode(i); });
}

}  // namespace cullhull::internal
