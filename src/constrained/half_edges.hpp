// A triangulation of the plane as half-edges, whose edges can be flipped.
#pragma once

#include <cstdint>

#include "cullhull/array.hpp"
#include "cullhull/triangulation.hpp"

namespace cullhull::internal::inline constrained {

/// Edge e consists of the half-edges 2 e and 2 e + 1. A half-edge has a triangle on its left, or no
/// face at the hull. The caller chooses the numbers of vertices.
class HalfEdges {
 public:
  static constexpr std::uint32_t none = 0xffffffff;

  /// `place`: the vertex number of each of t's ids. t is two-dimensional.
  HalfEdges(const Triangulation& t, const Array<std::uint32_t>& place, std::uint32_t vertices);

  std::uint32_t size() const { return static_cast<std::uint32_t>(origin_.size()); }
  static std::uint32_t twin(std::uint32_t h) { return h ^ 1U; }
  std::uint32_t origin(std::uint32_t h) const { return origin_[h]; }
  std::uint32_t target(std::uint32_t h) const { return origin_[h ^ 1U]; }
  bool has_face(std::uint32_t h) const { return next_[h] != none; }
  std::uint32_t next(std::uint32_t h) const { return next_[h]; }
  std::uint32_t previous(std::uint32_t h) const { return next_[next_[h]]; }
  /// The corner of h's triangle that is not on h.
  std::uint32_t apex(std::uint32_t h) const { return origin_[previous(h)]; }
  bool inner(std::uint32_t edge) const { return has_face(2 * edge) && has_face(2 * edge + 1); }
  /// A half-edge from the vertex with a triangle on its left; `none` if there is no triangle.
  std::uint32_t out(std::uint32_t vertex) const { return out_[vertex]; }

  /// Flips an inner edge of a strictly convex quadrilateral: afterwards the edge joins the two
  /// apexes, half-edge 2 e leading from the apex of 2 e + 1 to the apex of 2 e.
  void flip(std::uint32_t edge);

 private:
  Array<std::uint32_t> origin_, next_, out_;
};

}  // namespace cullhull::internal::inline constrained
