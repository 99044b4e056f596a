// Compressed bytes: .gz and .zst, whichever format is in them, and members of .npz.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "io/blocks/byte_stream.hpp"
#include "io/source.hpp"

namespace cullhull::internal {

enum class Packing { none, gzip, zstd };

/// By its first bytes. `name` and `options` tell raw numbers, which may begin with anything; where
/// the name ends in .gz or .zst but the bytes are none: Error{bad_file}.
Packing packing_of(std::string_view head, const std::string& name, const ReadOptions& options);

/// Whether the name says that a file is compressed.
bool named_as_packed(const std::string& name);

/// The name without .gz or .zst, which tells the format of what is in it.
std::string unpacked_name(const std::string& name);

/// What a compressed stream holds, all members or frames of it. Reading it throws Error{bad_file},
/// naming `name`, where it is cut short or corrupt; Error{invalid_argument} for a packing this was
/// built without.
std::unique_ptr<ByteStream> unpack(Packing packing, std::unique_ptr<ByteStream> from,
                                   const std::string& name);

/// One stream as DEFLATE alone has it, of `size` bytes with this CRC-32: a member of a ZIP archive.
std::unique_ptr<ByteStream> inflate_member(std::unique_ptr<ByteStream> from, std::uint64_t size,
                                           std::uint32_t crc, const std::string& name);

/// Bytes in memory, which must stay.
std::unique_ptr<ByteStream> stream_of(std::string_view bytes);

/// All that a stream gives, within `budget` bytes (0: half of the memory). Error{out_of_budget}.
Buffer read_all(ByteStream& from, const std::string& name, std::uint64_t budget, std::size_t& size);

}  // namespace cullhull::internal
