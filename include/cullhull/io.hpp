// Reading points and writing hulls. docs/formats.md describes every format.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "cullhull/certify.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull {

struct ReadOptions {
  /// Force a format ("npy", "ply", "obj", "off", "stl", "xyz", "txt", "csv", "raw"); empty: by
  /// extension, then by content.
  std::string format;
  /// Needed for raw input only.
  std::uint32_t raw_dimension = 0;
  std::optional<ScalarType> raw_scalar;
};

/// Points of a file: mapped (binary) or parsed (text, meshes). Movable; `points()` views its memory.
class PointFile {
 public:
  PointFile();
  PointFile(PointFile&&) noexcept;
  PointFile& operator=(PointFile&&) noexcept;
  ~PointFile();

  const PointView& points() const noexcept;
  const std::string& format() const noexcept;  ///< "npy", "ply (binary little-endian)", ...
  bool mapped() const noexcept;                ///< true when read in place
  double read_seconds() const noexcept;

  struct Impl;
  explicit PointFile(std::unique_ptr<Impl> impl);

 private:
  std::unique_ptr<Impl> impl_;
};

/// Opens `path` ("-": standard input). Throws Error{io} or Error{bad_file} with file and line or
/// byte offset.
PointFile open_points(const std::string& path, const ReadOptions& options = {});

struct JsonExtras {
  double read_seconds = 0;
  std::vector<double> compute_seconds_all;
  std::uint64_t peak_bytes = 0;
  /// Set when a certificate was asked for.
  std::optional<bool> certified;
};

/// Writes `hull` in the format of the extension of `path` (.ply .obj .off .stl .json .txt) or
/// `format`. The file appears whole or not at all (written beside, then renamed).
/// Throws Error{invalid_argument} if the format cannot hold the hull's dimension.
void write_hull(const std::string& path, const PointView& points, const Hull& hull,
                const std::string& format = "");

/// All of the hull as JSON; the keys are listed in docs/formats.md.
std::string hull_to_json(const PointView& points, const Hull& hull, const JsonExtras& extras,
                         bool with_lists);
/// Reads what write_hull(".json") wrote. Throws Error{bad_file}.
Hull hull_from_json(const std::string& path);

/// Text as Qhull's `qconvex` prints it; `what` is one of Fx i o n p FV FS.
std::string hull_to_qhull_text(const PointView& points, const Hull& hull, std::string_view what);

/// (n) int64, or (n, d) arrays in NumPy's format.
void write_npy_ids(const std::string& path, const std::vector<std::uint64_t>& ids);
void write_npy_points(const std::string& path, const double* coordinates, std::uint64_t count,
                      std::uint32_t dimension, ScalarType type);

}  // namespace cullhull
