// Decompression: .gz and .zst of any format, and members of .npz.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "io/blocks/byte_stream.hpp"
#include "io/packed/archive.hpp"
#include "io/source.hpp"
#include "parallel/memory/raw_array.hpp"

namespace cullhull::internal {

enum class Packing { none, gzip, zstd };

/// Determined by the first bytes. `name` and `options` identify raw numbers, which may begin with
/// any bytes; Error{bad_file} where the name ends in .gz or .zst but the bytes do not match.
Packing packing_of(std::string_view head, const std::string& name, const ReadOptions& options);

/// Whether the name says that a file is compressed.
bool named_as_packed(const std::string& name);

/// The name without .gz or .zst, which gives the format of the contents.
std::string unpacked_name(const std::string& name);

/// The contents of a compressed stream, all members or frames of it. Reading throws
/// Error{bad_file}, naming `name`, where it is truncated or corrupt; Error{invalid_argument} for a
/// compression that this build lacks.
std::unique_ptr<ByteStream> unpack(Packing packing, std::unique_ptr<ByteStream> from,
                                   const std::string& name);

/// A raw DEFLATE stream of `size` bytes with this CRC-32: a member of a ZIP archive.
std::unique_ptr<ByteStream> inflate_member(std::unique_ptr<ByteStream> from, std::uint64_t size,
                                           std::uint32_t crc, const std::string& name);

/// Bytes in memory, which must outlive the stream.
std::unique_ptr<ByteStream> stream_of(std::string_view bytes);

/// As ByteStream::read, in pieces, before each of which options.stop is checked.
std::size_t read_pieces(ByteStream& from, char* out, std::size_t size, const ReadOptions& options);

/// The whole stream, within this thread's ReadLimit, else within options.memory_budget. Throws
/// Error{out_of_budget}, Error{cancelled}.
RawArray<char> read_all(ByteStream& from, const std::string& name, const ReadOptions& options,
                        std::size_t& size);

// Files within files: the array in an archive, the contents of a compressed file.

/// Whether the file is an archive to look into. `file`: the name without a member's.
bool is_archive(const std::string& file, std::string_view head, const ReadOptions& options);

/// Replaces `source`, the bytes of the file `input.file`, by the contents, and sets `options` to
/// read those. Decompressed bytes are stored in `memory`; else `source` is a part of what it was.
/// Throws Error{bad_file}, Error{out_of_budget}, Error{invalid_argument}.
void unwrap(const InputName& input, Source& source, ReadOptions& options, RawArray<char>& memory);

}  // namespace cullhull::internal
