// LZF, by which binary_compressed .pcd files are packed.
#pragma once

#include <cstddef>

namespace cullhull::internal {

/// The most bytes that one packed byte can stand for: three bytes copy 264.
inline constexpr std::size_t lzf_most_growth = 88;

/// Unpacks `packed_size` bytes to exactly `size` at `out`, within whose bounds it stays whatever
/// the bytes are. False where they are no LZF or make another number of bytes.
bool unpack_lzf(const char* packed, std::size_t packed_size, char* out, std::size_t size);

}  // namespace cullhull::internal
