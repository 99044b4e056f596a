#include "io/packed/unwrap.hpp"

#include <algorithm>
#include <cstring>

#include "io/packed/unpack.hpp"

namespace cullhull::internal::inline io {
namespace {

void unwrap_member(const std::string& member, std::uint64_t budget, Source& source,
                   Buffer& memory) {
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
  memory = read_all(*stream, source.name, budget, source.size);
  source.data = memory.as<const char>();
}

}  // namespace

bool is_archive(const std::string& file, std::string_view head, const ReadOptions& options) {
  if (extension_of(file) == "npz") return true;
  const bool raw = options.raw_dimension != 0 || options.raw_scalar;
  return options.format.empty() && !raw && begins_archive(head);
}

void unwrap(const InputName& input, Source& source, ReadOptions& options, Buffer& memory) {
  const std::string_view head(source.data, std::min<std::size_t>(source.size, 16));
  if (is_archive(input.file, head, options)) {
    options.format = "npy";
    return unwrap_member(input.member, options.memory_budget, source, memory);
  }
  const Packing packing = packing_of(head, source.name, options);
  if (packing == Packing::none) return;
  const auto stream = unpack(packing, stream_of({source.data, source.size}), source.name);
  memory = read_all(*stream, source.name, options.memory_budget, source.size);
  source.data = memory.as<const char>();
}

}  // namespace cullhull::internal::inline io
