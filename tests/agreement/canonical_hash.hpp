// One number for all of a result that must not depend on the way it was reached.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "cullhull/hull.hpp"

namespace cullhull::testing_support {

/// FNV-1a over words, byte by byte.
class Fnv {
 public:
  void word(std::uint64_t v) {
    for (int i = 0; i < 8; ++i) {
      state_ = (state_ ^ (v & 255)) * 0x100000001b3ULL;
      v >>= 8;
    }
  }
  void add(double v) { word(std::bit_cast<std::uint64_t>(v)); }
  template <class List>
  requires requires(const List& list) { list.size(); }
  void add(const List& list) {
    word(list.size());
    for (const auto& v : list) {
      if constexpr (std::is_same_v<typename List::value_type, double>)
        add(v);
      else
        word(v);
    }
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ULL;
};

/// Everything but the statistics and the scalar type, which echo how and from what it was computed.
inline std::uint64_t canonical_hash(const Hull& h) {
  Fnv f;
  f.word(h.dimension);
  f.word(h.point_count);
  f.word(static_cast<std::uint64_t>(h.affine_dimension + 1));
  f.add(h.vertices);
  f.add(h.facets.offsets);
  f.add(h.facets.items);
  f.add(h.facet_neighbours.offsets);
  f.add(h.facet_neighbours.items);
  f.add(h.facet_planes);
  f.add(h.simplices);
  f.add(h.simplex_neighbours);
  f.add(h.simplex_facets);
  f.add(h.volume);
  f.add(h.area);
  f.add(h.centroid);
  return f.value();
}

}  // namespace cullhull::testing_support
