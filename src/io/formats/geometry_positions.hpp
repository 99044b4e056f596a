// Positions of geometries as GeoJSON and WKT have them, collected as points.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "io/source.hpp"
#include "io/text/lines.hpp"

namespace cullhull::internal::inline io {

/// Positions in the order of the file. All have two or all have three coordinates.
class Positions {
 public:
  /// `plane`: where some positions have two coordinates and others three, two are kept of all.
  explicit Positions(bool plane) : plane_(plane) {}

  std::uint64_t size() const { return dimension_ == 0 ? 0 : numbers_.size() / dimension_; }
  std::uint32_t dimension() const { return dimension_; }
  /// Where no position says so: of EMPTY Z.
  void assume_dimension(std::uint32_t dimension) { assumed_ = dimension; }

  /// `count` is 2 or 3. False where the others have another number, and `plane` was not asked for.
  bool add(const double* coordinates, std::uint32_t count) {
    if (dimension_ == 0) dimension_ = count;
    if (count != dimension_ && !plane_) return false;
    if (count < dimension_) drop_third();
    numbers_.insert(numbers_.end(), coordinates, coordinates + dimension_);
    return true;
  }

  /// The last positions, from `first` on, are a ring: its last is the first again, and is removed.
  void close_ring(std::uint64_t first) {
    const std::uint64_t last = size() - 1;
    if (size() < first + 2) return;
    for (std::uint32_t j = 0; j < dimension_; ++j)
      if (numbers_[first * dimension_ + j] != numbers_[last * dimension_ + j]) return;
    numbers_.resize(last * dimension_);
  }

  /// Removes all from `first` on and returns them.
  std::vector<double> take_from(std::uint64_t first) {
    const auto begin = numbers_.begin() + static_cast<std::ptrdiff_t>(first * dimension_);
    std::vector<double> taken(begin, numbers_.end());
    numbers_.erase(begin, numbers_.end());
    return taken;
  }
  /// Adds `count` positions of this dimension.
  void append(const double* rows, std::uint64_t count) {
    numbers_.insert(numbers_.end(), rows, rows + count * dimension_);
  }

  PointData points(const char* format) const {
    const std::uint32_t d = dimension_ == 0 ? assumed_ : dimension_;
    PointData data = parsed_points(size(), d, format);
    if (!numbers_.empty())
      std::memcpy(data.storage.data(), numbers_.data(), numbers_.size() * sizeof(double));
    return data;
  }

 private:
  void drop_third() {
    std::size_t out = 0;
    for (std::size_t i = 0; i < numbers_.size(); i += 3) {
      numbers_[out++] = numbers_[i];
      numbers_[out++] = numbers_[i + 1];
    }
    numbers_.resize(out);
    dimension_ = 2;
  }

  std::vector<double> numbers_;
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

}  // namespace cullhull::internal::inline io
