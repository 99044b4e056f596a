#include "io/blocks/block_source.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <string_view>
#include <utility>

#include "io/blocks/byte_stream.hpp"
#include "io/blocks/read_ahead.hpp"
#include "io/columns.hpp"
#include "io/coordinates.hpp"
#include "io/file_formats.hpp"
#include "io/hdf5/hdf5_points.hpp"
#include "io/mapped_file.hpp"
#include "io/packed/archive.hpp"
#include "io/packed/unpack.hpp"
#include "io/records.hpp"
#include "io/system.hpp"
#include "io/text/lines.hpp"
#include "io/text/text.hpp"
#include "io/text/text_scan.hpp"
#include "parallel/byte_order.hpp"
#include "parallel/memory/memory.hpp"
#include "parallel/memory/raw_array.hpp"

namespace cullhull::internal {

char* BlockMemory::room(std::size_t bytes, std::size_t keep) {
  if (bytes > size_) {
    Buffer larger(bytes);
    if (keep > 0) std::memcpy(larger.data(), buffer_.data(), keep);
    buffer_ = std::move(larger);
    size_ = bytes;
  }
  return buffer_.as<char>();
}

void BlockSource::describe(const std::string& name, const RecordLayout& layout) {
  name_ = name;
  format_ = layout.format;
  placement_ = layout.placement;
  grid_ = layout.grid;
}

namespace {

/// Points of a known number, which threads read in any order.
class CountedBlocks : public BlockSource {
 public:
  void go_on_from(const BlockPosition& from) override { next_ = from.file_points; }
  void end_at(const BlockPosition& end) override { end_ = std::min(end_, end.file_points); }
  std::optional<std::uint64_t> count() const override { return count_; }

  bool next(BlockTask& task, BlockMemory& memory) override {
    if (next_ >= end_ && !std::exchange(empty_, false)) return false;
    const std::uint64_t first = next_, most = end_ - first,
                        count = std::min(block_at(first, std::min(per_block_, most)), most);
    next_ += count;
    task.count = count;
    task.file_points = next_;
    task.taken = bytes_before(next_);
    task.load = [this, first, count, &memory] {
      LoadedBlock block;
      block.data = read(first, count, memory);
      return block;
    };
    return true;
  }

 protected:
  /// To be called by the constructor.
  void divide(std::uint64_t count, std::uint64_t per_block) {
    count_ = end_ = count;
    per_block_ = std::max<std::uint64_t>(1, per_block);
    empty_ = count == 0;
  }
  virtual PointData read(std::uint64_t first, std::uint64_t count, BlockMemory& memory) const = 0;
  /// How many points the block takes that begins with this one, about `wanted`.
  virtual std::uint64_t block_at(std::uint64_t, std::uint64_t wanted) const { return wanted; }
  /// The bytes of the file up to this point.
  virtual std::uint64_t bytes_before(std::uint64_t point) const = 0;

 private:
  std::uint64_t count_ = 0, per_block_ = 1, next_ = 0, end_ = 0;
  bool empty_ = false;  ///< no points, of which one empty block is to tell the dimension
};

/// Records of a regular file.
class RecordBlocks : public CountedBlocks {
 public:
  RecordBlocks(OpenedBytes&& from, RecordLayout&& layout, std::size_t block_bytes)
      : from_(std::move(from)), layout_(std::move(layout)) {
    describe(from_.name, layout_);
    std::string().swap(from_.head);  // the next input's has its memory
    divide(layout_.count, block_bytes / (layout_.record_bytes * layout_.columns));
  }

 private:
  PointData read(std::uint64_t first, std::uint64_t count, BlockMemory& memory) const override {
    const std::size_t bytes = count * layout_.record_bytes;
    char* const out = memory.room(bytes * layout_.columns);
    for (std::uint32_t c = 0; c < layout_.columns; ++c)
      read_at(from_, out + c * bytes, bytes,
              layout_.offset + (c * layout_.count + first) * layout_.record_bytes);
    return layout_.decode({name_, out, bytes * layout_.columns}, first, count);
  }
  std::uint64_t bytes_before(std::uint64_t point) const override {
    return point == layout_.count ? from_.size
                                  : layout_.offset + point * layout_.record_bytes * layout_.columns;
  }

  OpenedBytes from_;
  RecordLayout layout_;
};

[[noreturn]] void refuse_whole(const std::string& name, std::uint64_t bytes) {
  throw Error(ErrorCode::out_of_budget, name, ": this format is read whole, and it has more than ",
              bytes >> 20, " MiB, a quarter of the memory budget; .npy or text come in pieces");
}

/// Reads all bytes to `out` and returns how many there are.
std::size_t read_whole(const OpenedBytes& from, RawArray<char>& out, const ReadOptions& options) {
  // As documented, a quarter of the memory: as much for the points, and the rest for the hull.
  const std::uint64_t limit = resolve_budget(options.memory_budget) / 4;
  std::size_t size = 0, capacity = from.head.size() + 1;
  out.reserve(capacity);
  for (;;) {
    size += read_pieces(*from.stream, out.data() + size, capacity - size, options);
    if (size > limit) refuse_whole(from.name, size);
    if (size < capacity) return size;
    capacity *= 2;
    out.reserve(capacity);
  }
}

/// Records that are compressed in chunks: a block is the rest of a chunk and perhaps more chunks.
/// `whole`: all bytes of what is no regular file, else null.
class ChunkBlocks : public CountedBlocks {
 public:
  ChunkBlocks(OpenedBytes&& from, RawArray<char>&& whole, RecordLayout&& layout,
              std::size_t block_bytes)
      : from_(std::move(from)), whole_(std::move(whole)), layout_(std::move(layout)) {
    describe(from_.name, layout_);
    std::string().swap(from_.head);
    divide(layout_.count, block_bytes / layout_.record_bytes);
  }

 private:
  PointData read(std::uint64_t first, std::uint64_t count, BlockMemory& memory) const override {
    const auto [from, to] = chunks_with(layout_.chunks, first, count);
    if (from == to) return layout_.decode({name_, nullptr, 0}, first, count);
    const std::uint64_t begin = layout_.chunks[from].offset;
    const std::size_t bytes = end_of(layout_.chunks[to - 1]) - begin;
    if (whole_.data() != nullptr)
      return layout_.decode({name_, whole_.data() + begin, bytes}, first, count);
    char* const out = memory.room(bytes);
    read_at(from_, out, bytes, begin);
    return layout_.decode({name_, out, bytes}, first, count);
  }
  std::uint64_t block_at(std::uint64_t first, std::uint64_t wanted) const override {
    const auto [from, to] = chunks_with(layout_.chunks, first, wanted);
    if (from == to) return wanted;
    const RecordChunk& last = layout_.chunks[to - 1];
    return last.first + last.count - first;
  }
  std::uint64_t bytes_before(std::uint64_t point) const override {
    if (whole_.data() != nullptr) return from_.stream->taken();
    if (point == layout_.count) return from_.size;
    const auto [from, to] = chunks_with(layout_.chunks, point, 1);
    return from == to ? layout_.offset : layout_.chunks[from].offset;
  }
  static std::uint64_t end_of(const RecordChunk& c) { return c.offset + c.bytes; }

  OpenedBytes from_;
  RawArray<char> whole_;
  RecordLayout layout_;
};

/// Points of HDF5: any thread reads any of them, one at a time.
class Hdf5Blocks : public CountedBlocks {
 public:
  Hdf5Blocks(const InputName& input, std::size_t block_bytes, const ReadOptions& options)
      : points_(input.file, input.member), options_(options) {
    name_ = points_.name();
    format_ = "hdf5";
    const std::uint64_t chunk = points_.chunk_points();
    std::uint64_t per_block = std::max<std::uint64_t>(1, block_bytes / points_.record_bytes());
    if (per_block > chunk) per_block -= per_block % chunk;
    divide(points_.count(), per_block);
  }

 private:
  PointData read(std::uint64_t first, std::uint64_t count, BlockMemory& memory) const override {
    PointData data = points_.read(first, count, memory.room(count * points_.record_bytes()));
    choose_columns(data, name_, {}, options_);
    return data;
  }
  std::uint64_t bytes_before(std::uint64_t point) const override {
    return point * points_.record_bytes();
  }

  Hdf5Points points_;
  ReadOptions options_;
};

/// Records of a pipe: read in order.
class PipedRecords : public BlockSource {
 public:
  PipedRecords(OpenedBytes&& from, RecordLayout&& layout, std::size_t block_bytes)
      : from_(std::move(from)), layout_(std::move(layout)) {
    describe(from_.name, layout_);
    std::string().swap(from_.head);
    per_block_ = std::max<std::uint64_t>(1, block_bytes / layout_.record_bytes);
  }
  void go_on_from(const BlockPosition& from) override { pass_ = from.file_points; }
  void end_at(const BlockPosition& end) override { end_ = end.file_points; }

  bool next(BlockTask& task, BlockMemory& memory) override {
    if (next_ == 0 && !begun_) begin(memory);
    if (next_ >= std::min(end_, layout_.count) && !empty_) {
      if (end_ == unknown_size) drain(memory);
      return false;
    }
    const std::uint64_t wanted = std::min({per_block_, layout_.count - next_, end_ - next_});
    const std::uint64_t first = next_;
    const std::size_t bytes = wanted * layout_.record_bytes;
    char* const out = memory.room(bytes);
    const std::size_t got = from_.stream->read(out, bytes);
    const std::uint64_t count = got / layout_.record_bytes;
    next_ += count;
    if (got < bytes && (got % layout_.record_bytes != 0 || layout_.count != unknown_size))
      fail(
          {name_, nullptr, 0}, "ends within point ", next_,
          (layout_.count == unknown_size ? std::string() : " of " + std::to_string(layout_.count)));
    if (!std::exchange(empty_, false) && count == 0) return false;
    task.count = count;
    task.file_points = next_;
    task.taken = from_.stream->taken();
    task.load = [this, out, got, first, count] {
      LoadedBlock block;
      block.data = layout_.decode({name_, out, got}, first, count);
      return block;
    };
    return true;
  }

 private:
  void skip(std::uint64_t bytes, BlockMemory& memory) {
    constexpr std::size_t piece = std::size_t{1} << 20;  // bytes
    while (bytes > 0) {
      const std::size_t wanted = std::min<std::uint64_t>(bytes, piece);
      if (from_.stream->read(memory.room(wanted), wanted) < wanted)
        fail({name_, nullptr, 0}, "ends before its points");
      bytes -= wanted;
    }
  }
  void begin(BlockMemory& memory) {
    begun_ = true;
    skip(layout_.offset + pass_ * layout_.record_bytes, memory);
    next_ = pass_;
  }
  /// Reads to the end, as the writer of a pipe must not find it closed before.
  void drain(BlockMemory& memory) {
    constexpr std::size_t piece = std::size_t{1} << 20;
    while (from_.stream->read(memory.room(piece), piece) > 0)
      if (layout_.ends_file) fail({name_, nullptr, 0}, "more bytes after the last point");
  }

  OpenedBytes from_;
  RecordLayout layout_;
  std::uint64_t per_block_, next_ = 0, pass_ = 0, end_ = unknown_size;
  bool begun_ = false;
  bool empty_ = true;  ///< no points so far
};

/// One point a line: divided at line ends in order, parsed by any thread.
class TextBlocks : public BlockSource {
 public:
  /// `body`: offset of the first line of points.
  TextBlocks(OpenedBytes&& from, const Preamble& preamble, std::uint64_t body,
             std::size_t block_bytes, const ReadOptions& options)
      : from_(std::move(from)),
        preamble_(preamble),
        options_(options),
        block_bytes_(block_bytes),
        body_(body) {
    name_ = from_.name;
    format_ = preamble.kind == Preamble::qhull ? "text (Qhull)" : "text";
    lines_ = preamble.lines;
    options_.threads = 1;
    std::string().swap(from_.head);
  }
  void go_on_from(const BlockPosition& from) override {
    if (from.file_bytes == 0) return;
    body_ = from.file_bytes;
    lines_ = from.file_lines;
    points_ = from.file_points;
  }
  void end_at(const BlockPosition& end) override { end_ = end.file_bytes; }

  bool next(BlockTask& task, BlockMemory& memory) override {
    if (!begun_) begin(memory);
    const std::size_t size = cut(memory);
    if (!std::exchange(empty_, false) && size == 0) return false;
    const char* const begin = memory.room(0);
    const std::uint64_t before = lines_;
    lines_ += count_line_ends(begin, size);
    at_ += size;
    task.count.reset();
    task.file_bytes = at_;
    task.file_lines = lines_;
    task.taken = from_.stream->taken();
    task.count_points = [this, begin, size, before] {
      const Source piece{name_, begin, size};
      const auto points = index_lines(piece, begin, before, options_, is_point_line).points;
      points_ += points;
      return points;
    };
    task.load = [this, begin, size, before] {
      LoadedBlock block;
      block.data = read_text_piece({name_, begin, size}, before, preamble_, options_);
      points_ += block.data.view.count;
      return block;
    };
    return true;
  }
  void finish() const override {
    const bool promised = preamble_.kind != Preamble::none && end_ == unknown_size;
    if (promised && points_ != preamble_.count)
      fail_at_line({name_, nullptr, 0}, preamble_.promised_at, "promises ", preamble_.count,
                   " points, but ", points_.load(), " lines follow");
  }

 private:
  void begin(BlockMemory& memory) {
    begun_ = true;
    constexpr std::uint64_t piece = std::uint64_t{1} << 20;  // bytes
    for (std::uint64_t left = body_; left > 0;) {
      const std::size_t wanted = std::min(left, piece);
      if (from_.stream->read(memory.room(wanted), wanted) < wanted)
        fail({name_, nullptr, 0}, "is shorter than it was");
      left -= wanted;
    }
    at_ = body_;
  }
  /// Fills the memory with whole lines; the rest of the last line is kept for the next call.
  std::size_t cut(BlockMemory& memory) {
    std::size_t size = rest_.size(), capacity = size + block_bytes_;
    char* out = memory.room(capacity);
    std::memcpy(out, rest_.data(), size);
    for (;;) {
      const std::size_t room = std::min<std::uint64_t>(capacity - size, end_ - at_ - size);
      const std::size_t got = ended_ ? 0 : from_.stream->read(out + size, room);
      if (got < capacity - size) ended_ = true;
      const std::size_t had = size;
      size += got;
      if (ended_) {
        rest_.clear();
        return size;
      }
      const std::size_t newline = std::string_view(out + had, got).rfind('\n');
      if (newline != std::string_view::npos) {
        const char* const end = out + had + newline + 1;
        rest_.assign(end, static_cast<const char*>(out + size));
        return static_cast<std::size_t>(end - out);
      }
      if (capacity > std::size_t{1} << 30)
        fail_at_line({name_, nullptr, 0}, lines_ + 1, "a line of more than a gigabyte");
      capacity *= 2;
      out = memory.room(capacity, size);
    }
  }

  OpenedBytes from_;
  Preamble preamble_;
  ReadOptions options_;
  std::size_t block_bytes_;
  std::uint64_t body_, at_ = 0, lines_ = 0, end_ = unknown_size;
  std::atomic<std::uint64_t> points_{0};
  std::string rest_;
  bool begun_ = false, ended_ = false;
  bool empty_ = true;  ///< as in PipedRecords
};

/// A format that has to be in memory as a whole: a single block.
class WholeInput : public BlockSource {
 public:
  WholeInput(OpenedBytes&& from, std::string format, const ReadOptions& options)
      : from_(std::move(from)), options_(options) {
    name_ = from_.name;
    options_.format = std::move(format);
    options_.threads = 1;
    if (options_.format == "hullstate") note_grid();
  }
  void go_on_from(const BlockPosition& from) override { done_ = from.file_points > 0; }
  void end_at(const BlockPosition&) override {}  // a block, of which the visitor takes rows

  bool next(BlockTask& task, BlockMemory&) override {
    if (std::exchange(done_, true)) return false;
    const std::size_t size = read_whole(from_, bytes_, options_);
    task.count.reset();
    task.taken = from_.stream->taken();
    task.load = [this, size] { return load({name_, bytes_.data(), size}); };
    task.count_points = [this, load = task.load] {
      const LoadedBlock block = load();
      if (block.state)
        throw Error(ErrorCode::invalid_argument, name_,
                    ": holds the extreme points of a part, which are no rows to divide");
      return block.count();
    };
    return true;
  }

 private:
  /// Reads a state's dimension and grid from its first bytes.
  void note_grid() {
    constexpr std::size_t dimension_at = 12, grid_at = 20, head = 24;
    if (from_.head.size() < head) return;
    const auto dimension = load_little_endian<std::uint32_t>(from_.head.data() + dimension_at);
    const auto code = load_little_endian<std::uint32_t>(from_.head.data() + grid_at);
    constexpr std::uint32_t most = 1U << 20;  // of what a damaged one may say
    of_state_ = {static_cast<int>(code & 255) - 1, static_cast<int>(code >> 8 & 255) - 1,
                 static_cast<int>(code >> 16 & 255)};
    if (code == 0 || of_state_.decimals > 15 || of_state_.places > 100 || dimension > most) return;
    if (options_.numbers == Numbers::raw)
      throw Error(ErrorCode::invalid_argument, name_,
                  ": holds coordinates, not the integers of a .las; read it without --raw");
    const Grid own = grid_of_all({}, {of_state_});
    if (own.empty()) return;  // damaged, which loading it says
    placement_ = {std::vector(dimension, own.unit()), std::vector(dimension, 0.0), ""};
    if (options_.numbers == Numbers::grid) grid_ = options_.grid ? *options_.grid : own;
  }
  /// The state's coordinates in units of the grid on which all inputs are compared.
  void to_grid(HullState& state) const {
    if (state.point_count() == 0 || (grid_.decimals() < 0 && state.decimals() <= 0)) return;
    try {
      if (grid_.decimals() >= 0) return state.to_grid(grid_.decimals());
    } catch (const Error&) {  // said below
    }
    throw Error(
        ErrorCode::bad_file, name_, ": the state is of a grid of ",
        std::max(state.decimals(), state.places()),
        " decimals, which does not contain all other inputs, or of these one is a pipe; read "
        "the files that it was made from");
  }
  LoadedBlock load(const Source& source) const {
    ReadOptions quarter = options_;
    quarter.memory_budget = resolve_budget(options_.memory_budget) / 4;
    const ReadLimit limit(name_, quarter);
    LoadedBlock block;
    if (options_.format == "hullstate") {
      try {
        block.state =
            HullState::from_bytes({reinterpret_cast<const std::byte*>(source.data), source.size});
      } catch (const Error& e) {
        throw Error(e.code(), name_, ": ", e.what());
      }
      if (options_.numbers == Numbers::grid) to_grid(*block.state);
    } else {
      block.data = read_points(source, options_);
    }
    return block;
  }

  OpenedBytes from_;
  ReadOptions options_;
  RawArray<char> bytes_;
  bool done_ = false;
};

/// Reads on until the head of a text has a line of points behind its comments, and as much behind
/// that as find_preamble() looks at.
void pass_comments(OpenedBytes& from) {
  constexpr std::size_t most = std::size_t{1} << 30;
  while (from.head.size() < most) {
    const std::string_view head = from.head;
    LineScanner lines(head.data(), head.data() + head.rfind('\n') + 1);
    while (lines.next())
      if (is_point_line(lines.begin(), lines.end())) {
        constexpr std::ptrdiff_t header = std::ptrdiff_t{1} << 17;  // names, units and the like
        if (lines.end() + preview_bytes + header < head.data() + head.rfind('\n')) return;
        break;
      }
    if (!read_more_of_head(from)) return;
  }
}

/// The first lines of a text, which determine its layout.
std::optional<Preamble> preamble_of(OpenedBytes& from, const std::string& format,
                                    const ReadOptions& options) {
  const bool whole = from.head.size() < std::size_t{1} << 20;
  if (!whole) pass_comments(from);
  std::string_view head = from.head;
  if (!whole) head = head.substr(0, head.rfind('\n') + 1);
  if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
  if (head.empty()) return std::nullopt;
  const Source source{from.name, head.data(), head.size()};
  Preamble preamble = find_preamble(source, options, format);
  if (preamble.kind == Preamble::cdd) return std::nullopt;
  return preamble;
}

/// Gives decoded points their place.
void place_points_of(RecordLayout& layout, const ReadOptions& options) {
  if (layout.placement.empty() || stays(options.numbers)) return;
  layout.grid = grid_of(layout.placement, options);
  layout.decode = [decode = layout.decode, options](const Source& records, std::uint64_t first,
                                                    std::uint64_t count) {
    PointData data = decode(records, first, count);
    place(data, options);
    return data;
  };
}

/// Restricts decoded points to the columns asked for.
void choose_columns_of(RecordLayout& layout, const std::string& file,
                       const std::vector<std::string>& names, const ReadOptions& options) {
  layout.decode = [decode = layout.decode, file, names, options](
                      const Source& records, std::uint64_t first, std::uint64_t count) {
    PointData data = decode(records, first, count);
    choose_columns(data, file, names, options);
    return data;
  };
}

/// The placement of a pipe's numbers, from what was read ahead; empty also where it is compressed
/// or a state.
Placement placement_of_pipe(const std::string& path, const BlockOptions& options) {
  read_ahead(path, options.block_bytes, options.read.stop);
  const std::string_view seen = seen_ahead(path);
  const Source head{display_name(path), seen.data(), seen.size()};
  try {
    const auto layout =
        layout_of(choose_format(head, options.read), head, unknown_size, options.read);
    return layout ? layout->placement : Placement();
  } catch (const Error&) {
    return {};  // the reader of the points says what is wrong
  }
}

}  // namespace

namespace {

/// Whether a text has one point a line; a header that cannot be read does not say otherwise.
bool has_point_lines(const Source& head, const ReadOptions& options, const std::string& format) {
  const std::string_view all(head.data, head.size);
  const Source lines{head.name, head.data, all.rfind('\n') + 1};
  try {
    ReadOptions silent = options;  // the reader of the points says its remarks
    silent.remark = {};
    return find_preamble(lines, silent, format).kind != Preamble::cdd;
  } catch (const Error&) {
    return true;
  }
}

}  // namespace

bool comes_in_blocks(const Source& head, const ReadOptions& given, bool unknown) noexcept {
  try {
    ReadOptions options = given;
    options.remark = nullptr;  // the reader of the points has them
    const std::string_view all(head.data, head.size);
    if (begins_archive(all)) return false;
    if (packing_of(all.substr(0, 16), head.name, options) != Packing::none) return true;
    const std::size_t skip = all.starts_with("\xEF\xBB\xBF") ? 3 : 0;
    const Source text{head.name, head.data + skip, head.size - skip};
    const std::string format = choose_format(text, options);
    if (const auto layout = layout_of(format, head, unknown_size, options))
      return layout->columns == 1;
    return is_text(format) && !is_utf16(all) && has_point_lines(text, options, format);
  } catch (...) {
    return unknown;
  }
}

std::unique_ptr<BlockSource> open_source(const std::string& path, const BlockOptions& options) {
  OpenedBytes from = open_bytes(path, options.read);
  const Source head{from.name, from.head.data(), from.head.size()};
  const InputName input = split_input(path);
  if (holds_hdf5(input.file, from.head))
    return std::make_unique<Hdf5Blocks>(input, options.block_bytes, options.read);
  const FileFormat& state = *format_named("hullstate");
  if (state.has_ending(extension_of(unpacked_name(path))) || from.head.starts_with(state.magic))
    return std::make_unique<WholeInput>(std::move(from), "hullstate", options.read);
  const std::string_view bom = "\xEF\xBB\xBF";
  const std::size_t skip = from.head.starts_with(bom) ? bom.size() : 0;
  ReadOptions read = options.read;
  read.threads = 1;
  if (!from.format.empty()) read.format = from.format;
  const std::string format = choose_format({head.name, head.data + skip, head.size - skip}, read);
  check_decimal(head, format, read);
  // A block that was begun is finished, so that its position can be continued from: visit_blocks
  // checks for cancellation between blocks.
  ReadOptions uninterrupted = read;
  uninterrupted.stop = {};
  auto layout = layout_of(format, head, from.size, uninterrupted);
  RawArray<char> whole;
  const bool chunked = !layout && format_named(format)->chunks != nullptr;
  if (chunked && from.file.get() >= 0) {
    const ReadAt read_file = [&](char* out, std::size_t size, std::uint64_t at) {
      read_at(from, out, size, at);
    };
    layout = chunks_of(format, head, from.size, read_file, uninterrupted);
  } else if (chunked) {
    const std::size_t size = read_whole(from, whole, read);
    const Source bytes{from.name, whole.data(), size};
    layout = chunks_of(format, bytes, bytes.size, reader_of(bytes), uninterrupted);
  }
  if (layout) {
    if (!read.columns.empty() || !read.key.empty())
      choose_columns_of(*layout, head.name, column_names(format), read);
    place_points_of(*layout, read);
    if (chunked)
      return std::make_unique<ChunkBlocks>(std::move(from), std::move(whole), std::move(*layout),
                                           options.block_bytes);
    if (from.file.get() >= 0)
      return std::make_unique<RecordBlocks>(std::move(from), std::move(*layout),
                                            options.block_bytes);
    if (layout->columns == 1)
      return std::make_unique<PipedRecords>(std::move(from), std::move(*layout),
                                            options.block_bytes);
  }
  if (is_text(format) && !is_utf16(from.head))
    if (const auto preamble = preamble_of(from, format, read)) {
      const auto body = static_cast<std::uint64_t>(preamble->body - from.head.data());
      return std::make_unique<TextBlocks>(std::move(from), *preamble, body, options.block_bytes,
                                          read);
    }
  return std::make_unique<WholeInput>(std::move(from), format == "text" ? "txt" : format, read);
}

}  // namespace cullhull::internal

namespace cullhull {

Grid common_grid(const std::vector<std::string>& files, const ReadOptions& options) {
  using namespace internal;
  BlockOptions reading;
  reading.read = options;
  reading.read.grid.reset();
  std::vector<Placement> placements;
  std::vector<GridOfState> states;
  for (const std::string& file : files) {
    if (is_pipe(file_of_input(file))) {
      placements.push_back(placement_of_pipe(file_of_input(file), reading));
      if (placements.back().empty()) return {};
      continue;
    }
    system::FileStatus status{};
    if (system::status_of(file_of_input(file).c_str(), status) != 0 || !system::is_regular(status))
      return {};
    const std::unique_ptr<BlockSource> source = open_source(file, reading);
    if (source->placement().empty()) return {};
    if (source->format() == "hullstate")
      states.push_back(source->of_state());
    else
      placements.push_back(source->placement());
  }
  return grid_of_all(placements, states);
}

}  // namespace cullhull
