// A 2D triangulation as half-edges, whose edges can be flipped.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/triangulation.hpp"
#include "parallel/index.hpp"

namespace cullhull::internal {

/// Edge e consists of the half-edges 2 e and 2 e + 1. A half-edge has a triangle on its left, or,
/// on the hull, no face. The caller chooses the vertex numbers.
class HalfEdges {
 public:
  /// `place`: the vertex number of each of t's ids. t is two-dimensional.
  HalfEdges(const Triangulation& t, const std::vector<std::uint32_t>& place,
            std::uint32_t vertices);

  std::uint32_t size() const { return static_cast<std::uint32_t>(origin_.size()); }
  static std::uint32_t twin(std::uint32_t h) { return h ^ 1U; }
  std::uint32_t origin(std::uint32_t h) const { return origin_[h]; }
  std::uint32_t target(std::uint32_t h) const { return origin_[h ^ 1U]; }
  bool has_face(std::uint32_t h) const { return next_[h] != no_index; }
  std::uint32_t next(std::uint32_t h) const { return next_[h]; }
  std::uint32_t previous(std::uint32_t h) const { return next_[next_[h]]; }
  /// The corner of h's triangle that is not on h.
  std::uint32_t apex(std::uint32_t h) const { return origin_[previous(h)]; }
  bool inner(std::uint32_t edge) const { return has_face(2 * edge) && has_face(2 * edge + 1); }
  /// A half-edge from the vertex with a triangle on its left; no_index if there is no triangle.
  std::uint32_t out(std::uint32_t vertex) const { return out_[vertex]; }

  /// Flips an inner edge of a strictly convex quadrilateral: afterwards the edge joins the two
  /// apexes, half-edge 2 e leading from the apex of 2 e + 1 to the apex of 2 e.
  void flip(std::uint32_t edge);

 private:
  Array<std::uint32_t> origin_, next_, out_;
};

inline HalfEdges::HalfEdges(const Triangulation& t, const std::vector<std::uint32_t>& place,
                            std::uint32_t vertices)
    : out_(vertices) {
  std::fill(out_.begin(), out_.end(), no_index);
  const auto count = static_cast<std::uint32_t>(t.size());
  Array<std::uint32_t> half(3 * std::size_t{count});  // opposite to each corner
  for (std::uint32_t c = 0; c < count; ++c)
    for (unsigned j = 0; j < 3; ++j) {
      const std::uint32_t o = t.neighbours_of(c)[j];
      if (o != no_index && o < c) {
        half[3 * std::size_t{c} + j] =
            twin(half[3 * std::size_t{o} + place_in(t.neighbours_of(o), c)]);
        continue;
      }
      half[3 * std::size_t{c} + j] = size();
      origin_.push_back(place[t.cell(c)[(j + 1) % 3]]);
      origin_.push_back(place[t.cell(c)[(j + 2) % 3]]);
    }
  next_.assign(origin_.size(), no_index);
  for (std::uint32_t c = 0; c < count; ++c)
    for (unsigned j = 0; j < 3; ++j) {
      const std::uint32_t h = half[3 * std::size_t{c} + j];
      next_[h] = half[3 * std::size_t{c} + (j + 1) % 3];
      out_[origin_[h]] = h;
    }
}

inline void HalfEdges::flip(std::uint32_t edge) {
  const std::uint32_t h = 2 * edge, g = h + 1;
  const std::uint32_t h1 = next_[h], h2 = next_[h1], g1 = next_[g], g2 = next_[g1];
  const std::uint32_t u = origin_[h], v = origin_[g];
  if (out_[u] == h) out_[u] = g1;
  if (out_[v] == g) out_[v] = h1;
  origin_[h] = origin_[g2];
  origin_[g] = origin_[h2];
  next_[h] = h2;
  next_[h2] = g1;
  next_[g1] = h;
  next_[g] = g2;
  next_[g2] = h1;
  next_[h1] = g;
}

}  // namespace cullhull::internal
