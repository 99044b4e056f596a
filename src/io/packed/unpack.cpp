#include "io/packed/unpack.hpp"

#include <algorithm>
#include <cstring>
#include <optional>

#include "io/blocks/block_source.hpp"
#include "io/text/lines.hpp"
#include "parallel/memory/memory.hpp"

#if CULLHULL_HAVE_ZLIB
#include <zlib.h>
#endif
#if CULLHULL_HAVE_ZSTD
#include <zstd.h>
#endif

namespace cullhull::internal {
namespace {

constexpr std::size_t piece_bytes = std::size_t{1} << 18;

#if !CULLHULL_HAVE_ZLIB || !CULLHULL_HAVE_ZSTD
[[noreturn]] void not_built(const std::string& name, const char* library, const char* program) {
  throw Error(ErrorCode::invalid_argument, name, ": this cullhull was built without ", library,
              "; ", program, " FILE | cullhull hull - reads it");
}
#endif

class MemoryBytes : public ByteStream {
 public:
  explicit MemoryBytes(std::string_view bytes) : bytes_(bytes) {}
  std::size_t read(char* out, std::size_t size) override {
    const std::size_t got = std::min(size, bytes_.size() - at_);
    if (got > 0) std::memcpy(out, bytes_.data() + at_, got);
    at_ += got;
    return got;
  }
  std::uint64_t taken() const override { return at_; }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

#if CULLHULL_HAVE_ZLIB || CULLHULL_HAVE_ZSTD
/// A compressed stream, and the piece of it that is being decoded.
class Packed : public ByteStream {
 public:
  Packed(std::unique_ptr<ByteStream> from, std::string name)
      : from_(std::move(from)), name_(std::move(name)), piece_(piece_bytes) {}
  std::uint64_t taken() const override { return from_->taken(); }

 protected:
  /// The next piece; its size is 0 at the end.
  std::size_t refill() { return from_->read(piece_.as<char>(), piece_bytes); }
  const char* piece() const { return piece_.as<const char>(); }
  [[noreturn]] void cut_short() const {
    fail({name_, nullptr, 0}, "is cut short: it ends within its compressed bytes");
  }
  [[noreturn]] void corrupt(const char* why) const {
    fail({name_, nullptr, 0}, "corrupt compressed bytes: ", why);
  }

 private:
  std::unique_ptr<ByteStream> from_;
  std::string name_;
  Buffer piece_;
};
#endif

#if CULLHULL_HAVE_ZLIB
class Inflated : public Packed {
 public:
  /// `bits`: zlib's word for what precedes the data; 31 for a gzip header, -15 for nothing.
  Inflated(std::unique_ptr<ByteStream> from, const std::string& name, int bits)
      : Packed(std::move(from), name), many_members_(bits > 0) {
    if (::inflateInit2(&z_, bits) != Z_OK) throw std::bad_alloc();
  }
  ~Inflated() override { ::inflateEnd(&z_); }
  Inflated(const Inflated&) = delete;
  Inflated& operator=(const Inflated&) = delete;

  std::size_t read(char* out, std::size_t size) override {
    std::size_t have = 0;
    while (have < size && !ended_) {
      if (z_.avail_in == 0 && !fill()) break;
      if (at_member_ && !next_member()) break;
      const std::size_t room = std::min<std::size_t>(size - have, 1U << 30);
      z_.next_out = reinterpret_cast<Bytef*>(out + have);
      z_.avail_out = static_cast<uInt>(room);
      const int code = ::inflate(&z_, Z_NO_FLUSH);
      have += room - z_.avail_out;
      if (code == Z_STREAM_END) {
        at_member_ = any_member_ = true;
        ended_ = !many_members_;
      } else if (code == Z_MEM_ERROR) {
        throw std::bad_alloc();
      } else if (code != Z_OK && code != Z_BUF_ERROR) {
        corrupt(z_.msg != nullptr ? z_.msg : "not as zlib knows them");
      }
    }
    return have;
  }

 private:
  /// False at the end, which must be the end of a member.
  bool fill() {
    z_.avail_in = static_cast<uInt>(refill());
    z_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(piece()));
    if (z_.avail_in > 0) return true;
    if (!any_member_ || !at_member_) cut_short();
    ended_ = true;
    return false;
  }
  /// Whether compressed data follows: goes to the next of the members that a .gz file may consist
  /// of (RFC 1952), past zeros, with which tapes pad the last block. inflate() refuses other bytes.
  bool next_member() {
    if (!any_member_) {
      at_member_ = false;
      return true;
    }
    while (z_.avail_in > 0 && *z_.next_in == 0) {
      ++z_.next_in;
      --z_.avail_in;
      if (z_.avail_in == 0 && !fill()) return false;
    }
    ::inflateReset(&z_);
    at_member_ = false;
    return true;
  }

  z_stream z_{};
  bool many_members_;
  bool at_member_ = true, any_member_ = false, ended_ = false;
};

/// Checks the length and check sum of a member against the archive's.
class CheckedMember : public ByteStream {
 public:
  CheckedMember(std::unique_ptr<ByteStream> from, std::uint64_t size, std::uint32_t crc,
                std::string name)
      : from_(std::move(from)), left_(size), crc_(crc), name_(std::move(name)) {}
  std::size_t read(char* out, std::size_t size) override {
    const std::size_t wanted = std::min<std::uint64_t>(size, left_);
    const std::size_t got = from_->read(out, wanted);
    if (got < wanted) fail({name_, nullptr, 0}, "is shorter than its archive says");
    for (std::size_t at = 0; at < got;) {
      const std::size_t part = std::min<std::size_t>(got - at, 1U << 30);
      seen_ = ::crc32(seen_, reinterpret_cast<const Bytef*>(out + at), static_cast<uInt>(part));
      at += part;
    }
    left_ -= got;
    if (left_ == 0 && got > 0 && seen_ != crc_)
      fail({name_, nullptr, 0}, "corrupt: its check sum is another");
    return got;
  }
  std::uint64_t taken() const override { return from_->taken(); }

 private:
  std::unique_ptr<ByteStream> from_;
  std::uint64_t left_;
  uLong crc_, seen_ = 0;
  std::string name_;
};
#endif

#if CULLHULL_HAVE_ZSTD
class Zstd : public Packed {
 public:
  Zstd(std::unique_ptr<ByteStream> from, const std::string& name)
      : Packed(std::move(from), name), context_(::ZSTD_createDCtx()) {
    if (context_ == nullptr) throw std::bad_alloc();
  }
  ~Zstd() override { ::ZSTD_freeDCtx(context_); }
  Zstd(const Zstd&) = delete;
  Zstd& operator=(const Zstd&) = delete;

  std::size_t read(char* out, std::size_t size) override {
    std::size_t have = 0;
    while (have < size) {
      if (in_.pos == in_.size && !full_) {
        in_ = {piece(), refill(), 0};
        if (in_.size == 0) {
          if (within_frame_) cut_short();
          break;
        }
      }
      ZSTD_outBuffer to{out, size, have};
      const std::size_t before = in_.pos;
      const std::size_t hint = ::ZSTD_decompressStream(context_, &to, &in_);
      if (::ZSTD_isError(hint) != 0) corrupt(::ZSTD_getErrorName(hint));
      // Between frames zstd asks for input although nothing is missing.
      if (to.pos > have || in_.pos > before) within_frame_ = hint != 0;
      full_ = to.pos == size && to.pos > have;  // there may be more output without further input
      have = to.pos;
    }
    return have;
  }

 private:
  ZSTD_DCtx* context_;
  ZSTD_inBuffer in_{nullptr, 0, 0};
  bool within_frame_ = false, full_ = false;
};
#endif

bool ends_in(const std::string& name, std::string_view ending) {
  if (name.size() < ending.size()) return false;
  return extension_of(name) == ending.substr(1);
}

}  // namespace

bool named_as_packed(const std::string& name) {
  return ends_in(name, ".gz") || ends_in(name, ".zst");
}

std::string unpacked_name(const std::string& name) {
  return named_as_packed(name) ? name.substr(0, name.rfind('.')) : name;
}

Packing packing_of(std::string_view head, const std::string& name, const ReadOptions& options) {
  const bool raw = options.format == "raw" || extension_of(name) == "raw" ||
                   options.raw_dimension != 0 || options.raw_scalar;
  const bool named = named_as_packed(name);
  if (raw && !named) return Packing::none;
  if (head.starts_with("\x1F\x8B")) return Packing::gzip;
  if (head.starts_with("\x28\xB5\x2F\xFD")) return Packing::zstd;
  // A skippable frame may come first: 0x184D2A50 to 0x184D2A5F.
  if (head.size() >= 4 && head.substr(1, 3) == "\x2A\x4D\x18" &&
      (static_cast<unsigned char>(head[0]) & 0xF0) == 0x50)
    return Packing::zstd;
  if (named) fail({name, nullptr, 0}, "does not begin as a .", extension_of(name), " file does");
  return Packing::none;
}

std::unique_ptr<ByteStream> unpack(Packing packing, std::unique_ptr<ByteStream> from,
                                   const std::string& name) {
  if (packing == Packing::none) return from;
  if (packing == Packing::gzip) {
#if CULLHULL_HAVE_ZLIB
    return std::make_unique<Inflated>(std::move(from), name, 31);
#else
    not_built(name, "zlib", "zcat");
#endif
  }
#if CULLHULL_HAVE_ZSTD
  return std::make_unique<Zstd>(std::move(from), name);
#else
  not_built(name, "libzstd", "zstdcat");
#endif
}

std::unique_ptr<ByteStream> inflate_member(std::unique_ptr<ByteStream> from, std::uint64_t size,
                                           std::uint32_t crc, const std::string& name) {
#if CULLHULL_HAVE_ZLIB
  return std::make_unique<CheckedMember>(std::make_unique<Inflated>(std::move(from), name, -15),
                                         size, crc, name);
#else
  (void)size, (void)crc, (void)from;
  throw Error(ErrorCode::invalid_argument, name,
              ": this cullhull was built without zlib; numpy.savez writes what it reads");
#endif
}

std::unique_ptr<ByteStream> stream_of(std::string_view bytes) {
  return std::make_unique<MemoryBytes>(bytes);
}

std::size_t read_pieces(ByteStream& from, char* out, std::size_t size, const ReadOptions& options) {
  constexpr std::size_t piece = std::size_t{1} << 20;  // bytes: milliseconds
  std::size_t got = 0;
  while (got < size) {
    check_stop(options);
    const std::size_t wanted = std::min(piece, size - got), n = from.read(out + got, wanted);
    got += n;
    if (n < wanted) break;
  }
  return got;
}

// Where the array grows, page tables are moved instead of bytes copied (RawArray).
RawArray<char> read_all(ByteStream& from, const std::string& name, const ReadOptions& options,
                        std::size_t& size) {
  ReadLimit* const outer = ReadLimit::current();
  std::optional<ReadLimit> own;
  if (outer == nullptr) own.emplace(name, options);
  ReadLimit& limit = outer != nullptr ? *outer : *own;
  const std::uint64_t most = limit.left();
  std::size_t capacity = std::size_t{1} << 20;
  RawArray<char> bytes;
  size = 0;
  do {
    bytes.reserve(capacity);
    size += read_pieces(from, bytes.data() + size, capacity - size, options);
    if (size > most) {
      limit.set_in_blocks(comes_in_blocks({unpacked_name(name), bytes.data(), size}, options));
      limit.refuse(size);
    }
  } while (size == capacity && (capacity *= 2) > 0);
  limit.take(size);
  return bytes;
}

namespace {

void unwrap_member(const std::string& member, const ReadOptions& options, Source& source,
                   RawArray<char>& memory) {
  const std::string_view bytes(source.data, source.size);
  const ReadAt read = [bytes](char* out, std::size_t size, std::uint64_t offset) {
    if (size > 0) std::memcpy(out, bytes.data() + offset, size);
  };
  const ArchiveMember found = find_member(read, source.size, member, source.name);
  if (!member.empty()) source.name.append(1, ':').append(display_name(member));
  source.data += found.offset;
  source.size = found.packed_size;
  if (!found.deflated) return;
  const auto stream =
      inflate_member(stream_of({source.data, source.size}), found.size, found.crc, source.name);
  memory = read_all(*stream, source.name, options, source.size);
  source.data = memory.data();
}

}  // namespace

bool is_archive(const std::string& file, std::string_view head, const ReadOptions& options) {
  if (extension_of(file) == "npz") return true;
  const bool raw = options.raw_dimension != 0 || options.raw_scalar;
  return options.format.empty() && !raw && begins_archive(head);
}

void unwrap(const InputName& input, Source& source, ReadOptions& options, RawArray<char>& memory) {
  const std::string_view head(source.data, std::min<std::size_t>(source.size, 16));
  if (is_archive(input.file, head, options)) {
    options.format = "npy";
    return unwrap_member(input.member, options, source, memory);
  }
  const Packing packing = packing_of(head, source.name, options);
  if (packing == Packing::none) return;
  const auto stream = unpack(packing, stream_of({source.data, source.size}), source.name);
  memory = read_all(*stream, source.name, options, source.size);
  source.data = memory.data();
}

}  // namespace cullhull::internal
