// Convex intervals, polygons and polyhedra that are cut by planes. They store numbers of corners
// and faces, no coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "diagrams/voronoi/clip_corners.hpp"

namespace cullhull::internal {

/// A shape starts as a convex piece of a region. Planes of `corners` cut it: the part on the outer
/// side of a plane is removed. A shape without interior is empty.
template <unsigned D>
class ClipShape;

/// An interval.
template <>
class ClipShape<1> {
 public:
  void start(const RegionPiece<1>& piece, CellCorners<1>& corners);
  void cut(CellCorners<1>& corners, std::uint32_t plane);
  bool empty() const { return vertices.empty(); }
  std::span<const std::uint32_t> face_planes() const { return planes; }

  std::vector<std::uint32_t> vertices;  ///< numbers of corners
  std::vector<std::uint32_t> planes;    ///< the plane at each end
};

/// A polygon, counterclockwise; edge i is between vertex i and the next.
template <>
class ClipShape<2> {
 public:
  void start(const RegionPiece<2>& piece, CellCorners<2>& corners);
  /// If the plane contains an edge between two pieces of the region, it becomes that edge's plane.
  void cut(CellCorners<2>& corners, std::uint32_t plane);
  bool empty() const { return vertices.empty(); }
  std::span<const std::uint32_t> face_planes() const { return planes; }

  std::vector<std::uint32_t> vertices;
  std::vector<std::uint32_t> planes;  ///< the plane of each edge

 private:
  void cut_off(CellCorners<2>& corners, std::uint32_t plane);

  std::vector<std::uint32_t> next_, next_planes_;
  std::vector<Sign> sides_;
};

/// A polyhedron; faces counterclockwise from outside.
template <>
class ClipShape<3> {
 public:
  void start(const RegionPiece<3>& piece, CellCorners<3>& corners);
  void cut(CellCorners<3>& corners, std::uint32_t plane);
  bool empty() const { return vertices.empty(); }
  std::span<const std::uint32_t> face_planes() const { return planes; }

  std::vector<std::uint32_t> vertices;  ///< numbers of corners
  std::vector<std::uint32_t> starts;    ///< begin of each face in `items`; faces + 1
  std::vector<std::uint32_t> items;     ///< indices into `vertices`
  std::vector<std::uint32_t> planes;    ///< the plane of each face

 private:
  /// An edge from a kept vertex to a removed one. Each of its two faces contains it once.
  struct CutEdge {
    std::uint32_t inside, outside, place, next;
    std::array<std::uint32_t, 2> faces;  ///< the planes of its two faces
  };
  std::uint32_t cut_vertex(std::uint32_t inside, std::uint32_t outside, std::uint32_t face_plane);
  void cut_faces();
  void add_cut_vertices(CellCorners<3>& corners, std::uint32_t plane);
  void close(std::uint32_t plane);
  void drop_unused();
  void clear();

  std::vector<Sign> sides_;
  std::vector<std::uint32_t> next_starts_, next_items_, next_planes_, number_;
  std::vector<CutEdge> edges_;
};

}  // namespace cullhull::internal
