// Numbers in records of fixed size, or one array after another: the fields that .npy, .ply and .pcd
// name, of any type and byte order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/columns.hpp"
#include "io/source.hpp"

namespace cullhull::internal {

struct FieldType {
  char kind = 'f';         ///< 'f', 'i' or 'u'
  std::uint64_t size = 4;  ///< bytes
  bool swapped = false;    ///< not in this machine's byte order

  /// As which its numbers may be viewed; nothing for integers of 64 bits.
  std::optional<ScalarType> scalar() const;
  /// The number at `p`. False for an integer of 64 bits that no double equals.
  bool load(const char* p, double& out) const;
};

/// The type of little-endian numbers, or of big-endian ones.
FieldType field_type(ScalarType type, bool big_endian);

/// Where the numbers of a field are stored: the byte of the first and the step between points.
struct NumberField {
  std::string name;
  FieldType type;
  std::uint64_t begin = 0, step = 0;
};

/// The points of `count` records: in place where the fields are of one type and evenly apart, else
/// as doubles. `first`: the index of the first point in its file, for messages. Throws
/// Error{bad_file}, naming field and point, for an integer of 64 bits that no double equals.
PointData points_of_fields(const Source& records, const std::vector<NumberField>& fields,
                           std::uint64_t count, std::uint64_t first, std::string format,
                           const ReadOptions& options);

/// The axes x, y and perhaps z, or what options ask for among them and other fields: numbers of
/// fields of the record.
ChosenFields fields_to_read(const ReadOptions& options, const std::string& file,
                            std::vector<std::uint32_t> axes,
                            const std::vector<std::pair<std::string, std::uint32_t>>& others);

}  // namespace cullhull::internal
