// LAZ: the points of a LAS file, compressed in chunks, each of which is decoded on its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/packed/archive.hpp"
#include "io/records.hpp"
#include "io/source.hpp"
#include "io/text/lines.hpp"

namespace cullhull::internal {

/// The header of a LAS or LAZ file.
struct LasHeader {
  unsigned minor = 0, format = 0;
  bool compressed = false;                  ///< LAZ
  std::uint64_t header_size = 0, vlrs = 0;  ///< variable-length records, behind the header
  std::uint64_t offset = 0, record = 0, count = 0;
  Placement placement;
};

/// A part of a record with a way to be compressed, by its number in the file.
struct LazItem {
  enum Type : std::uint16_t {
    bytes = 0,
    point10 = 6,
    gps_time = 7,
    rgb = 8,
    wave_packet = 9,
    point14 = 10,
    rgb14 = 11,
    rgb_nir14 = 12,
    wave_packet14 = 13,
    bytes14 = 14
  };
  Type type = bytes;
  unsigned size = 0, version = 0;
};

struct LazChunk {
  const char *begin = nullptr, *end = nullptr;
  std::uint64_t count = 0;  ///< of points, at least 1
};

/// Where records of `record` bytes are decoded to: the first `stride` bytes of each.
struct LazRows {
  char* out = nullptr;
  std::size_t record = 0, stride = 0;
  /// Which bytes of a record are needed; others may be wrong.
  std::vector<bool> needed;

  bool needs(std::size_t begin, std::size_t size) const {
    for (std::size_t i = begin; i < begin + size; ++i)
      if (needed[i]) return true;
    return false;
  }
};

/// Both throw LazDamage and Error{cancelled}. `chunk` holds at least a record. Options used: stop.
void decode_points(const LazChunk& chunk, const std::vector<LazItem>& items, const LazRows& rows,
                   const ReadOptions& options);
void decode_layers(const LazChunk& chunk, const std::vector<LazItem>& items, const LazRows& rows,
                   const ReadOptions& options);

struct LazLayout {
  std::vector<LazItem> items;
  bool layered = false;
  std::uint64_t vlr = 0, vlr_bytes = 0;  ///< the record "laszip encoded" in the file
  std::vector<RecordChunk> chunks;       ///< each of at least one point
};

/// From the record "laszip encoded" and the chunk table. Throws Error{bad_file}. `size`: of the
/// file that `read` reads.
LazLayout laz_layout(const std::string& file, const LasHeader& header, std::uint64_t size,
                     const ReadAt& read);

/// Decodes the chunks [from, to), whose bytes begin at `bytes.data`, one after another to rows.out.
/// Throws Error{bad_file}, naming byte and chunk. Options used: threads, stop.
void decode_chunks(const LazLayout& laz, std::size_t from, std::size_t to, const Source& bytes,
                   const LazRows& rows, const ReadOptions& options);

}  // namespace cullhull::internal
