// Records of simplicial facets: a hot part, read by searches, and a cold part.
#pragma once

#include <cstddef>
#include <cstdint>

#include "parallel/memory/raw_array.hpp"
#include "parallel/prefetch.hpp"

namespace cullhull::internal {

/// What several threads note at a facet's slot.
struct FacetMark {
  std::uint16_t holder;  ///< the number of the lane that holds the slot, or 0
  std::uint8_t seen;     ///< set during a search alone: whether it has seen the facet
};

/// Hot: the plane as d + 1 floats, and the mark where that leaves room for it: two threads then
/// share no line but that of a facet that both read. Cold: d vertices, then d neighbours, neighbour
/// j across the ridge opposite to vertex j. In 4D and 5D both share one cache line; in 6D and 7D
/// the hot part is half a line. D: the dimension, or 0 if it is known at run time only; then planes
/// are stored in doubles as well.
template <unsigned D>
class FacetStore {
 public:
  using Id = std::uint32_t;
  static constexpr Id dead = 0xFFFFFFFF;  ///< vertex 0 of an unused slot

  explicit FacetStore(unsigned dimension) : dimension_(dimension) {}

  static constexpr bool together = D == 4 || D == 5;
  unsigned dim() const {
    if constexpr (D > 0) return D;
    return dimension_;
  }
  std::size_t hot_stride() const {  // in bytes
    if constexpr (together) return 64;
    return (std::size_t{dim()} + 8) / 8 * 32;
  }
  std::size_t cold_stride() const {
    if constexpr (together) return 64;
    return std::size_t{8} * dim();
  }
  std::size_t bytes_per_facet() const {
    return 1 + hot_stride() + (together ? 0 : cold_stride()) + (marked ? 0 : sizeof(FacetMark)) +
           (D == 0 ? wide_stride() * sizeof(double) : 0);
  }

  float* plane(Id f) { return reinterpret_cast<float*>(hot_.data() + f * hot_stride()); }
  const float* plane(Id f) const {
    return reinterpret_cast<const float*>(hot_.data() + f * hot_stride());
  }
  Id* vertices(Id f) { return reinterpret_cast<Id*>(cold() + f * cold_stride()); }
  const Id* vertices(Id f) const { return reinterpret_cast<const Id*>(cold() + f * cold_stride()); }
  Id* neighbours(Id f) { return vertices(f) + dim(); }
  const Id* neighbours(Id f) const { return vertices(f) + dim(); }
  /// For D = 0: the wide plane of facet_planes_any().
  double* wide(Id f) requires(D == 0) { return wide_.data() + f * wide_stride(); }
  const double* wide(Id f) const requires(D == 0) { return wide_.data() + f * wide_stride(); }
  FacetMark& mark(Id f) {
    if constexpr (marked) return reinterpret_cast<FacetMark*>(plane(f) + D + 1)[0];
    return marks_[f];
  }
  /// Set during a search alone: whether it has seen the facet. One thread uses an array of its own,
  /// which is dense, so that it writes to no records that it only reads.
  template <bool shared>
  std::uint8_t& seen(Id f) {
    if constexpr (shared) return mark(f).seen;
    return seen_[f];
  }
  void clear(Id f) {
    vertices(f)[0] = dead;
    mark(f) = {0, 0};
    seen_[f] = 0;
  }
  bool alive(Id f) const { return vertices(f)[0] != dead; }

  template <bool shared>
  void prefetch(Id f) const {
    prefetch_line(plane(f));
    if constexpr (!together) prefetch_line(neighbours(f));
    if constexpr (shared && !marked) prefetch_line(&marks_[f]);
  }

  void prefetch_to_write(Id f) const {
    prefetch_line_to_write(plane(f));
    if constexpr (!together) {
      prefetch_line_to_write(vertices(f));
      prefetch_line_to_write(neighbours(f) + dim() - 1);
    }
  }

  void reserve(std::size_t facets) {
    hot_.reserve(facets * hot_stride());
    if constexpr (!together) cold_.reserve(facets * cold_stride());
    if constexpr (!marked) marks_.reserve(facets);
    seen_.reserve(facets);
    if constexpr (D == 0) wide_.reserve(facets * wide_stride());
  }
  void release_planes() {
    if constexpr (!together) hot_.release();
    wide_.release();
    marks_.release();
    seen_.release();
  }

 private:
  /// Where both parts share a line, the plane takes its first d + 1 floats.
  static constexpr std::size_t cold_offset = 64 - 8 * (together ? D : 0);
  std::byte* cold() {
    if constexpr (together) return hot_.data() + cold_offset;
    return cold_.data();
  }
  const std::byte* cold() const {
    if constexpr (together) return hot_.data() + cold_offset;
    return cold_.data();
  }

  std::size_t wide_stride() const { return std::size_t{dim()} + 1; }

  static constexpr bool marked = D == 4 || D == 6 || D == 8;

  unsigned dimension_;
  RawArray<std::byte> hot_, cold_;
  RawArray<double> wide_;  ///< for D = 0
  RawArray<std::uint8_t> seen_;
  RawArray<FacetMark> marks_;  ///< unless the hot parts have room
};

}  // namespace cullhull::internal
