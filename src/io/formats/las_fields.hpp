// The fields of a LAS record behind its coordinates, by the names that laspy gives them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "cullhull/point_view.hpp"
#include "io/source.hpp"

namespace cullhull::internal {

struct LasField {
  enum class Kind { bits, i8, u8, i16, u16, f64 };
  std::string name;
  unsigned offset = 0;  ///< bytes from the beginning of the record
  Kind kind = Kind::u8;
  unsigned shift = 0, width = 8;  ///< of Kind::bits within a byte

  double of(const char* record) const;
  unsigned bytes() const;
};

/// Those of a point format from 0 to 10, after x, y and z.
const std::vector<LasField>& las_fields(unsigned format);

/// Which bytes of a record of `record` bytes hold the axes, columns and keys that are asked for.
std::vector<bool> las_bytes(unsigned format, std::size_t record, const std::string& file,
                            const ReadOptions& options);

/// choose_columns for `data.view.count` records of `record` bytes whose x, y and z `data` views:
/// columns and keys may be fields, too. If one of them is not an integer (gps_time), all become
/// doubles in world coordinates at once, without a placement.
void choose_las_columns(PointData& data, const char* records, std::size_t record, unsigned format,
                        const std::string& file, const ReadOptions& options);

// The coordinate reference system of a LAS file, and the unit of its coordinates.

/// "metre", "foot", "US survey foot", "degree", or the name that the WKT has for the unit of x and
/// y; empty where the records behind the header, `count` from byte `begin` on, do not tell.
std::string las_unit(const Source& head, std::size_t begin, std::size_t count);

/// As file_crs; of the same records, or of the contents of one that has the WKT. `head`: the file
/// from its first byte to its points.
std::string las_crs(const Source& head);

}  // namespace cullhull::internal
