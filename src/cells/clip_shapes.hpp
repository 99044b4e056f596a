// Convex polygons and polyhedra that are cut by halfspaces, in doubles. docs/exactness.md, "Voronoi
// diagrams".
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace cullhull::internal {

/// normal . x <= offset; what is cut off is told by `owner`.
template <unsigned D>
struct CutPlane {
  std::array<double, D> normal;
  double offset;
  std::uint32_t owner;
};

/// Counterclockwise; edge i goes from vertex i to the next.
struct ClipPolygon {
  std::vector<std::array<double, 2>> vertices;
  std::vector<std::uint32_t> owners;  ///< of edges

  bool empty() const { return vertices.empty(); }
  void cut(const CutPlane<2>& plane);
  double measure() const;

 private:
  std::vector<std::array<double, 2>> next_;
  std::vector<std::uint32_t> next_owners_;
  std::vector<double> above_;
};

/// Faces counterclockwise from outside. Each vertex is on one side of a plane, for all its faces
/// alike, so that what is left is closed whatever is rounded.
struct ClipPolyhedron {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::uint32_t> starts{0};  ///< faces + 1
  std::vector<std::uint32_t> items;      ///< vertices of faces
  std::vector<std::uint32_t> owners;     ///< of faces

  bool empty() const { return vertices.empty(); }
  void add_face(const std::vector<std::uint32_t>& face, std::uint32_t owner);
  void cut(const CutPlane<3>& plane);
  double measure() const;

 private:
  struct CutEdge {
    std::uint32_t inside, outside, vertex, next;
  };
  std::uint32_t cut_vertex(std::uint32_t inside, std::uint32_t outside);
  void cut_faces();
  void close(std::uint32_t owner);
  void drop_unused();

  std::vector<double> above_;
  std::vector<std::uint32_t> next_starts_, next_items_, next_owners_, number_;
  std::vector<CutEdge> edges_;
};

}  // namespace cullhull::internal
