#include "io/packed/lzf.hpp"

#include <cstring>

namespace cullhull::internal {

bool unpack_lzf(const char* packed, std::size_t packed_size, char* out, std::size_t size) {
  std::size_t at = 0, made = 0;
  const auto byte = [&] {
    return static_cast<std::size_t>(static_cast<unsigned char>(packed[at++]));
  };
  while (at < packed_size) {
    const std::size_t control = byte();
    if (control < 32) {  // control + 1 literal bytes follow
      const std::size_t length = control + 1;
      if (length > packed_size - at || length > size - made) return false;
      std::memcpy(out + made, packed + at, length);
      at += length;
      made += length;
      continue;
    }
    // A copy of what was made before: its length, then how far back.
    std::size_t length = control >> 5;
    if (packed_size - at < (length == 7 ? 2U : 1U)) return false;
    if (length == 7) length += byte();
    length += 2;
    const std::size_t back = ((control & 31) << 8 | byte()) + 1;
    if (back > made || length > size - made) return false;
    for (; length > 0; --length, ++made) out[made] = out[made - back];  // it may overlap itself
  }
  return made == size;
}

}  // namespace cullhull::internal
