// Positions of geometries as GeoJSON and WKT have them, collected as points.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "io/source.hpp"
#include "io/text/lines.hpp"

namespace cullhull::internal {

/// Positions in the order of the file. All have two or all have three coordinates.
class Positions {
 public:
  /// `plane`: where some positions have two coordinates and others three, two are kept of all.
  explicit Positions(bool plane) : plane_(plane) {}

  std::uint64_t size() const { return dimension_ == 0 ? 0 : used_ / dimension_; }
  std::uint32_t dimension() const { return dimension_; }
  /// Where no position says so: of EMPTY Z.
  void assume_dimension(std::uint32_t dimension) { assumed_ = dimension; }

  /// `count` is 2 or 3. False where the others have another number, and `plane` was not asked for.
  bool add(const double* coordinates, std::uint32_t count) {
    if (dimension_ == 0) dimension_ = count;
    if (count != dimension_ && !plane_) return false;
    if (count < dimension_) drop_third();
    append(coordinates, 1);
    return true;
  }

  /// The last positions, from `first` on, are a ring: its last is the first again, and is removed.
  void close_ring(std::uint64_t first) {
    const std::uint64_t last = size() - 1;
    if (size() < first + 2) return;
    for (std::uint32_t j = 0; j < dimension_; ++j)
      if (row(first)[j] != row(last)[j]) return;
    used_ = last * dimension_;
  }

  /// Removes all from `first` on and returns them.
  std::vector<double> take_from(std::uint64_t first) {
    std::vector<double> taken(row(first), row(size()));
    used_ = first * dimension_;
    return taken;
  }
  /// Adds `count` positions of this dimension.
  void append(const double* rows, std::uint64_t count) {
    const std::size_t more = count * dimension_;
    if (used_ + more > room_) grow(more);
    std::copy_n(rows, more, numbers() + used_);
    used_ += more;
  }

  /// Hands over all positions.
  PointData points(const char* format) && {
    PointData data;
    data.format = format;
    if (numbers_.data() == nullptr) numbers_ = Buffer(0);
    data.storage = std::move(numbers_);
    data.view = PointView::row_major(data.storage.as<const double>(), size(),
                                     dimension_ == 0 ? assumed_ : dimension_);
    return data;
  }

 private:
  double* numbers() const { return numbers_.as<double>(); }
  const double* row(std::uint64_t i) const { return numbers() + i * dimension_; }
  void grow(std::size_t more) {
    room_ = std::max({std::size_t{1024}, room_ + room_ / 2, used_ + more});
    Buffer larger(room_ * sizeof(double));
    std::copy_n(numbers(), used_, larger.as<double>());
    numbers_ = std::move(larger);
  }
  void drop_third() {
    std::size_t out = 0;
    for (std::size_t i = 0; i < used_; i += 3)
      for (std::size_t j = 0; j < 2; ++j) numbers()[out++] = numbers()[i + j];
    used_ = out;
    dimension_ = 2;
  }

  Buffer numbers_;  ///< rows: `used_` numbers, and room for more
  std::size_t used_ = 0, room_ = 0;
  std::uint32_t dimension_ = 0, assumed_ = 2;
  bool plane_;
};

/// The vertices of all geometries of a GeoJSON document (RFC 7946); a ring's last position, which
/// is its first again, is no vertex of its own.
PointData read_geojson(const Source& source, const ReadOptions& options);
/// The same of a text of geometries in WKT, one after the other.
PointData read_wkt(const Source& source, const ReadOptions& options);
/// Whether a text begins as WKT does: POINT (1 2), SRID=4326;POINT ...
bool looks_like_wkt(const char* begin, const char* end);
/// The line of a point that read_wkt gives.
std::uint64_t line_of_wkt_point(const Source& source, std::uint64_t point);

}  // namespace cullhull::internal
