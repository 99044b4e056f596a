// Datasets of HDF5 files, NetCDF-4 among them, as points: FILE.h5:/GROUP/NAME.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "io/source.hpp"

namespace cullhull::internal {

/// Whether a file is one, by its name (.h5 .hdf5 .he5 .nc .nc4) or its first bytes. Throws
/// Error{bad_file} for NetCDF's older formats, Error{invalid_argument} for standard input.
bool holds_hdf5(const std::string& file, std::string_view head);

/// An open dataset, or several of one axis and one length, a column each. Libhdf5 may be compiled
/// without locks, so it is called under one of our own: from any thread, one at a time.
class Hdf5Points {
 public:
  /// `datasets`: paths in the file, between commas; empty: the only one (n, d), else the only one
  /// (n). Throws Error{io}, Error{bad_file}; Error{invalid_argument}, which lists what there is,
  /// where they do not name one; and where this was built without libhdf5.
  Hdf5Points(const std::string& file, const std::string& datasets);
  ~Hdf5Points();

  const std::string& name() const;  ///< of file and datasets, for messages
  std::uint64_t count() const;
  std::uint32_t dimension() const;
  /// The type that read() makes. 64-bit integers become doubles, columns of different types too.
  ScalarType scalar() const;
  /// Bytes of a point in memory.
  std::uint64_t record_bytes() const;
  /// The number of points stored together in the file: a good block size is a multiple of it.
  std::uint64_t chunk_points() const;

  /// `count` points from `first` on, in `out`, which has room for them. Throws Error{bad_file}.
  PointData read(std::uint64_t first, std::uint64_t count, char* out) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// All points, within options.memory_budget: Error{out_of_budget}.
PointData read_hdf5(const std::string& file, const std::string& datasets,
                    const ReadOptions& options);

}  // namespace cullhull::internal
