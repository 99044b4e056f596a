#include "diagrams/voronoi/clip_shapes.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "parallel/index.hpp"

namespace cullhull::internal {
namespace {

/// Adds the corners and planes of a piece and lists their numbers; a plane's label is the piece
/// across it.
template <unsigned D>
void start_from(const RegionPiece<D>& piece, CellCorners<D>& corners,
                std::vector<std::uint32_t>& vertices, std::vector<std::uint32_t>& planes) {
  vertices.clear();
  planes.clear();
  for (const auto& x : piece.corners) vertices.push_back(corners.add_given(x.data()));
  for (std::size_t i = 0; i < piece.planes.size(); ++i)
    planes.push_back(corners.add_boundary(piece.planes[i], piece.across[i]));
}

/// Computes the side of each vertex; true if a vertex is outside.
template <unsigned D>
bool find_sides(CellCorners<D>& corners, std::uint32_t plane,
                const std::vector<std::uint32_t>& vertices, std::vector<Sign>& sides) {
  sides.resize(vertices.size());
  bool any = false;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    sides[i] = corners.side(plane, vertices[i]);
    any = any || sides[i] == Sign::positive;
  }
  return any;
}

/// Ends a face: the items since the last start, without consecutive repetitions, which arise if
/// planes through a vertex cut there several times. A face with fewer than three items is removed.
void end_face(std::vector<std::uint32_t>& starts, std::vector<std::uint32_t>& items,
              std::vector<std::uint32_t>& planes, std::uint32_t plane) {
  const auto begin = items.begin() + static_cast<std::ptrdiff_t>(starts.back());
  items.erase(std::unique(begin, items.end()), items.end());
  while (items.size() > starts.back() + 1 && items.back() == items[starts.back()]) items.pop_back();
  if (items.size() < starts.back() + 3) {
    items.resize(starts.back());
    return;
  }
  starts.push_back(static_cast<std::uint32_t>(items.size()));
  planes.push_back(plane);
}

}  // namespace

void ClipShape<1>::start(const RegionPiece<1>& piece, CellCorners<1>& corners) {
  start_from(piece, corners, vertices, planes);
}

void ClipShape<1>::cut(CellCorners<1>& corners, std::uint32_t plane) {
  const Sign low = corners.side(plane, vertices[0]), high = corners.side(plane, vertices[1]);
  if (low != Sign::positive && high != Sign::positive) return;
  if (low != Sign::negative && high != Sign::negative) {
    vertices.clear();
    planes.clear();
    return;
  }
  const unsigned end = high == Sign::positive ? 1 : 0;
  vertices[end] = corners.add_meeting({plane});
  planes[end] = plane;
}

void ClipShape<2>::start(const RegionPiece<2>& piece, CellCorners<2>& corners) {
  start_from(piece, corners, vertices, planes);
}

void ClipShape<2>::cut(CellCorners<2>& corners, std::uint32_t plane) {
  if (find_sides(corners, plane, vertices, sides_)) return cut_off(corners, plane);
  const std::size_t n = vertices.size();
  for (std::size_t i = 0; i < n; ++i)
    if (sides_[i] == Sign::zero && sides_[i + 1 < n ? i + 1 : 0] == Sign::zero &&
        !corners.is_bisector(planes[i]) && corners.label(planes[i]) != no_index)
      planes[i] = plane;
}

void ClipShape<2>::cut_off(CellCorners<2>& corners, std::uint32_t plane) {
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

void ClipShape<3>::start(const RegionPiece<3>& piece, CellCorners<3>& corners) {
  start_from(piece, corners, vertices, planes);
  starts.assign(1, 0);
  items.clear();
  for (const auto& face : piece.faces) {
    items.insert(items.end(), face.begin(), face.end());
    starts.push_back(static_cast<std::uint32_t>(items.size()));
  }
}

void ClipShape<3>::clear() {
  vertices.clear();
  starts.assign(1, 0);
  items.clear();
  planes.clear();
}

void ClipShape<3>::cut(CellCorners<3>& corners, std::uint32_t plane) {
  if (!find_sides(corners, plane, vertices, sides_)) return;
  if (std::all_of(sides_.begin(), sides_.end(), [](Sign s) { return s != Sign::negative; }))
    return clear();
  cut_faces();
  add_cut_vertices(corners, plane);
  close(plane);
  drop_unused();
}

std::uint32_t ClipShape<3>::cut_vertex(std::uint32_t inside, std::uint32_t outside,
                                       std::uint32_t face_plane) {
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
void ClipShape<3>::cut_faces() {
  edges_.clear();
  next_starts_.assign(1, 0);
  next_items_.clear();
  next_planes_.clear();
  for (std::size_t f = 0; f < planes.size(); ++f) {
    const std::uint32_t begin = starts[f], end = starts[f + 1];
    std::uint32_t left = no_index, first_return = no_index;
    for (std::uint32_t i = begin; i < end; ++i) {
      const std::uint32_t a = items[i], b = items[i + 1 < end ? i + 1 : begin];
      const bool stays = sides_[a] != Sign::positive, next_stays = sides_[b] != Sign::positive;
      if (stays) next_items_.push_back(a);
      if (stays == next_stays) continue;
      const std::uint32_t e = stays ? cut_vertex(a, b, planes[f]) : cut_vertex(b, a, planes[f]);
      next_items_.push_back(edges_[e].place);
      if (stays)
        left = e;
      else if (left != no_index)
        edges_[e].next = left;
      else
        first_return = e;  // it left before the list began
    }
    if (first_return != no_index) edges_[first_return].next = left;
    end_face(next_starts_, next_items_, next_planes_, planes[f]);
  }
  std::swap(starts, next_starts_);
  std::swap(items, next_items_);
  std::swap(planes, next_planes_);
}

void ClipShape<3>::add_cut_vertices(CellCorners<3>& corners, std::uint32_t plane) {
  for (const CutEdge& e : edges_)
    if (e.place != e.inside)
      vertices[e.place] = corners.add_meeting({e.faces[0], e.faces[1], plane});
}

void ClipShape<3>::close(std::uint32_t plane) {
  for (CutEdge& first : edges_) {
    if (first.next == no_index) continue;
    for (CutEdge* e = &first; e->next != no_index;) {
      items.push_back(e->place);
      e = &edges_[std::exchange(e->next, no_index)];
    }
    end_face(starts, items, planes, plane);
  }
}

void ClipShape<3>::drop_unused() {
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

}  // namespace cullhull::internal
