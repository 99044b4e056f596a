// Convex intervals, polygons and polyhedra that are cut by planes. They store numbers of corners
// and faces, no coordinates.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "diagrams/voronoi/clip_corners.hpp"
#include "parallel/index.hpp"

namespace cullhull::internal {

/// What shapes of all dimensions have.
template <unsigned D>
class ClipVertices {
 public:
  bool empty() const { return vertices.empty(); }

  std::vector<std::uint32_t> vertices;  ///< numbers of corners
  std::vector<std::uint32_t> planes;    ///< the plane of each face: end, edge or polygon

 protected:
  /// Adds the corners and planes of a piece; a plane's label is the piece across it.
  void start_from(const RegionPiece<D>& piece, CellCorners<D>& corners) {
    vertices.clear();
    planes.clear();
    for (const auto& x : piece.corners) vertices.push_back(corners.add_given(x.data()));
    for (std::size_t i = 0; i < piece.planes.size(); ++i)
      planes.push_back(corners.add_boundary(piece.planes[i], piece.across[i]));
  }
  /// Computes the side of each vertex; true if a vertex is outside.
  bool find_sides(CellCorners<D>& corners, std::uint32_t plane) {
    sides_.resize(vertices.size());
    bool any = false;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      sides_[i] = corners.side(plane, vertices[i]);
      any = any || sides_[i] == Sign::positive;
    }
    return any;
  }

  std::vector<Sign> sides_;
};

/// A shape starts as a convex piece of a region. Planes of `corners` cut it: the part on the outer
/// side of a plane is removed. A shape without interior is empty.
template <unsigned D>
class ClipShape;

/// An interval.
template <>
class ClipShape<1> : public ClipVertices<1> {
 public:
  void start(const RegionPiece<1>& piece, CellCorners<1>& corners) { start_from(piece, corners); }
  void cut(CellCorners<1>& corners, std::uint32_t plane) {
    if (!find_sides(corners, plane)) return;
    if (sides_[0] != Sign::negative && sides_[1] != Sign::negative) {
      vertices.clear();
      planes.clear();
      return;
    }
    const unsigned end = sides_[1] == Sign::positive ? 1 : 0;
    vertices[end] = corners.add_meeting({plane});
    planes[end] = plane;
  }
};

/// A polygon, counterclockwise; edge i is between vertex i and the next.
template <>
class ClipShape<2> : public ClipVertices<2> {
 public:
  void start(const RegionPiece<2>& piece, CellCorners<2>& corners) { start_from(piece, corners); }
  /// If the plane contains an edge between two pieces of the region, it becomes that edge's plane.
  void cut(CellCorners<2>& corners, std::uint32_t plane) {
    if (find_sides(corners, plane)) return cut_off(corners, plane);
    const std::size_t n = vertices.size();
    for (std::size_t i = 0; i < n; ++i)
      if (sides_[i] == Sign::zero && sides_[i + 1 < n ? i + 1 : 0] == Sign::zero &&
          corners.piece_across(planes[i]) != no_index)
        planes[i] = plane;
  }

 private:
  void cut_off(CellCorners<2>& corners, std::uint32_t plane) {
    next_.clear();
    next_planes_.clear();
    const std::size_t n = vertices.size();
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t j = i + 1 < n ? i + 1 : 0;
      const bool stays = sides_[i] != Sign::positive, next_stays = sides_[j] != Sign::positive;
      if (stays) {
        next_.push_back(vertices[i]);
        next_planes_.push_back(planes[i]);
        if (next_stays) continue;
        if (sides_[i] == Sign::zero) {
          next_planes_.back() = plane;  // the boundary leaves at the vertex
        } else {
          next_.push_back(corners.add_meeting({planes[i], plane}));
          next_planes_.push_back(plane);
        }
      } else if (next_stays && sides_[j] != Sign::zero) {
        next_.push_back(corners.add_meeting({planes[i], plane}));
        next_planes_.push_back(planes[i]);
      }
    }
    if (next_.size() < 3) {
      next_.clear();
      next_planes_.clear();
    }
    std::swap(vertices, next_);
    std::swap(planes, next_planes_);
  }

  std::vector<std::uint32_t> next_, next_planes_;
};

/// A polyhedron; faces counterclockwise from outside.
template <>
class ClipShape<3> : public ClipVertices<3> {
 public:
  void start(const RegionPiece<3>& piece, CellCorners<3>& corners) {
    start_from(piece, corners);
    starts.assign(1, 0);
    items.clear();
    for (const auto& face : piece.faces) {
      items.insert(items.end(), face.begin(), face.end());
      starts.push_back(static_cast<std::uint32_t>(items.size()));
    }
  }
  void cut(CellCorners<3>& corners, std::uint32_t plane) {
    if (!find_sides(corners, plane)) return;
    if (std::all_of(sides_.begin(), sides_.end(), [](Sign s) { return s != Sign::negative; })) {
      vertices.clear();
      starts.assign(1, 0);
      items.clear();
      planes.clear();
      return;
    }
    cut_faces();
    for (const CutEdge& e : edges_)
      if (e.place != e.inside)
        vertices[e.place] = corners.add_meeting({e.faces[0], e.faces[1], plane});
    close(plane);
    drop_unused();
  }

  std::vector<std::uint32_t> starts;  ///< begin of each face in `items`; faces + 1
  std::vector<std::uint32_t> items;   ///< indices into `vertices`

 private:
  /// An edge from a kept vertex to a removed one. Each of its two faces contains it once.
  struct CutEdge {
    std::uint32_t inside, outside, place, next;
    std::array<std::uint32_t, 2> faces;  ///< the planes of its two faces
  };

  std::uint32_t cut_vertex(std::uint32_t inside, std::uint32_t outside, std::uint32_t face_plane) {
    for (std::uint32_t e = 0; e < edges_.size(); ++e)
      if (edges_[e].inside == inside && edges_[e].outside == outside) {
        edges_[e].faces[1] = face_plane;
        return e;
      }
    const bool at_vertex = sides_[inside] == Sign::zero;
    const auto place = at_vertex ? inside : static_cast<std::uint32_t>(vertices.size());
    if (!at_vertex) vertices.push_back(no_index);  // created once both faces are known
    edges_.push_back({inside, outside, place, no_index, {face_plane, no_index}});
    return static_cast<std::uint32_t>(edges_.size() - 1);
  }

  /// The new face runs opposite to the old ones: where a face returns into the halfspace, and where
  /// it leaves it.
  void cut_faces() {
    edges_.clear();
    std::swap(starts, old_starts_);
    std::swap(items, old_items_);
    std::swap(planes, old_planes_);
    starts.assign(1, 0);
    items.clear();
    planes.clear();
    for (std::size_t f = 0; f < old_planes_.size(); ++f) {
      const std::uint32_t begin = old_starts_[f], end = old_starts_[f + 1], plane = old_planes_[f];
      std::uint32_t left = no_index, first_return = no_index;
      for (std::uint32_t i = begin; i < end; ++i) {
        const std::uint32_t a = old_items_[i], b = old_items_[i + 1 < end ? i + 1 : begin];
        const bool stays = sides_[a] != Sign::positive, next_stays = sides_[b] != Sign::positive;
        if (stays) items.push_back(a);
        if (stays == next_stays) continue;
        const std::uint32_t e = stays ? cut_vertex(a, b, plane) : cut_vertex(b, a, plane);
        items.push_back(edges_[e].place);
        if (stays)
          left = e;
        else if (left != no_index)
          edges_[e].next = left;
        else
          first_return = e;  // it left before the list began
      }
      if (first_return != no_index) edges_[first_return].next = left;
      end_face(plane);
    }
  }

  void close(std::uint32_t plane) {
    for (CutEdge& first : edges_) {
      if (first.next == no_index) continue;
      for (CutEdge* e = &first; e->next != no_index;) {
        items.push_back(e->place);
        e = &edges_[std::exchange(e->next, no_index)];
      }
      end_face(plane);
    }
  }

  /// Ends a face: the items since the last start, without consecutive repetitions, which arise if
  /// planes through a vertex cut there several times. A face with fewer than three items is
  /// removed.
  void end_face(std::uint32_t plane) {
    const std::uint32_t start = starts.back();
    items.erase(std::unique(items.begin() + start, items.end()), items.end());
    while (items.size() > start + 1 && items.back() == items[start]) items.pop_back();
    if (items.size() < start + 3) {
      items.resize(start);
      return;
    }
    starts.push_back(static_cast<std::uint32_t>(items.size()));
    planes.push_back(plane);
  }

  void drop_unused() {
    number_.assign(vertices.size(), no_index);
    for (const std::uint32_t v : items) number_[v] = 0;
    std::uint32_t kept = 0;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      if (number_[v] == no_index) continue;
      vertices[kept] = vertices[v];
      number_[v] = kept++;
    }
    vertices.resize(kept);
    for (std::uint32_t& v : items) v = number_[v];
  }

  std::vector<std::uint32_t> old_starts_, old_items_, old_planes_, number_;
  std::vector<CutEdge> edges_;
};

}  // namespace cullhull::internal
