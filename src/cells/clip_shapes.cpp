#include "cells/clip_shapes.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace cullhull::internal {
namespace {

constexpr std::uint32_t unset = 0xffffffff;

/// The point between a and b whose height is zero; `up` above, `down` at most zero. Taken from the
/// lower height, so that it is near where that is nearly zero.
template <std::size_t D>
std::array<double, D> between(const std::array<double, D>& a, double down,
                              const std::array<double, D>& b, double up) {
  const double share = down / (down - up);
  std::array<double, D> r;
  for (std::size_t j = 0; j < D; ++j) r[j] = a[j] + (b[j] - a[j]) * share;
  return r;
}

template <unsigned D>
bool heights(const std::vector<std::array<double, D>>& vertices, const CutPlane<D>& plane,
             std::vector<double>& above) {
  above.resize(vertices.size());
  bool any = false;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    double sum = -plane.offset;
    for (unsigned j = 0; j < D; ++j) sum += plane.normal[j] * vertices[i][j];
    above[i] = sum;
    any = any || sum > 0;
  }
  return any;
}

using Space = std::array<double, 3>;
Space minus(const Space& a, const Space& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double determinant(const Space& a, const Space& b, const Space& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

}  // namespace

void ClipPolygon::cut(const CutPlane<2>& plane) {
  if (!heights<2>(vertices, plane, above_)) return;
  next_.clear();
  next_owners_.clear();
  const std::size_t n = vertices.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = i + 1 < n ? i + 1 : 0;
    const bool stays = !(above_[i] > 0), next_stays = !(above_[j] > 0);
    if (stays) {
      next_.push_back(vertices[i]);
      next_owners_.push_back(owners[i]);
      if (!next_stays) {
        next_.push_back(between<2>(vertices[i], above_[i], vertices[j], above_[j]));
        next_owners_.push_back(plane.owner);
      }
    } else if (next_stays) {
      next_.push_back(between<2>(vertices[j], above_[j], vertices[i], above_[i]));
      next_owners_.push_back(owners[i]);
    }
  }
  if (next_.size() < 3) {
    next_.clear();
    next_owners_.clear();
  }
  std::swap(vertices, next_);
  std::swap(owners, next_owners_);
}

double ClipPolygon::measure() const {
  double sum = 0;
  for (std::size_t i = 2; i < vertices.size(); ++i) {
    const auto &o = vertices[0], &a = vertices[i - 1], &b = vertices[i];
    sum += (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
  }
  return std::max(0.0, sum / 2);
}

void ClipPolyhedron::add_face(const std::vector<std::uint32_t>& face, std::uint32_t owner) {
  items.insert(items.end(), face.begin(), face.end());
  starts.push_back(static_cast<std::uint32_t>(items.size()));
  owners.push_back(owner);
}

std::uint32_t ClipPolyhedron::cut_vertex(std::uint32_t inside, std::uint32_t outside) {
  for (std::uint32_t e = 0; e < edges_.size(); ++e)
    if (edges_[e].inside == inside && edges_[e].outside == outside) return e;
  const auto at = static_cast<std::uint32_t>(vertices.size());
  edges_.push_back({inside, outside, at, unset});
  vertices.push_back(
      between<3>(vertices[inside], above_[inside], vertices[outside], above_[outside]));
  return static_cast<std::uint32_t>(edges_.size() - 1);
}

void ClipPolyhedron::cut(const CutPlane<3>& plane) {
  if (!heights<3>(vertices, plane, above_)) return;
  if (std::all_of(above_.begin(), above_.end(), [](double v) { return v > 0; })) {
    vertices.clear();
    starts.assign(1, 0);
    items.clear();
    owners.clear();
    return;
  }
  cut_faces();
  close(plane.owner);
  drop_unused();
}

/// Where a face leaves the halfspace and comes back, the new face goes the other way.
void ClipPolyhedron::cut_faces() {
  edges_.clear();
  next_starts_.assign(1, 0);
  next_items_.clear();
  next_owners_.clear();
  for (std::size_t f = 0; f < owners.size(); ++f) {
    const std::uint32_t begin = starts[f], end = starts[f + 1];
    std::uint32_t left = unset, first_return = unset;
    for (std::uint32_t i = begin; i < end; ++i) {
      const std::uint32_t a = items[i], b = items[i + 1 < end ? i + 1 : begin];
      const bool stays = !(above_[a] > 0), next_stays = !(above_[b] > 0);
      if (stays) next_items_.push_back(a);
      if (stays == next_stays) continue;
      const std::uint32_t e = stays ? cut_vertex(a, b) : cut_vertex(b, a);
      next_items_.push_back(edges_[e].vertex);
      if (stays)
        left = e;
      else if (left != unset)
        edges_[e].next = left;
      else
        first_return = e;  // it left before the list began
    }
    if (first_return != unset) edges_[first_return].next = left;
    if (next_items_.size() == next_starts_.back()) continue;
    next_starts_.push_back(static_cast<std::uint32_t>(next_items_.size()));
    next_owners_.push_back(owners[f]);
  }
  std::swap(starts, next_starts_);
  std::swap(items, next_items_);
  std::swap(owners, next_owners_);
}

void ClipPolyhedron::close(std::uint32_t owner) {
  for (CutEdge& first : edges_) {
    if (first.next == unset) continue;
    for (CutEdge* e = &first; e->next != unset;) {
      items.push_back(e->vertex);
      e = &edges_[std::exchange(e->next, unset)];
    }
    starts.push_back(static_cast<std::uint32_t>(items.size()));
    owners.push_back(owner);
  }
}

void ClipPolyhedron::drop_unused() {
  number_.assign(vertices.size(), unset);
  for (const std::uint32_t v : items) number_[v] = 0;
  std::uint32_t kept = 0;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (number_[v] == unset) continue;
    vertices[kept] = vertices[v];
    number_[v] = kept++;
  }
  vertices.resize(kept);
  for (std::uint32_t& v : items) v = number_[v];
}

double ClipPolyhedron::measure() const {
  double sum = 0;
  for (std::size_t f = 0; f < owners.size(); ++f) {
    const std::uint32_t* v = items.data() + starts[f];
    const Space from = minus(vertices[v[0]], vertices[0]);
    for (std::uint32_t i = 2; i < starts[f + 1] - starts[f]; ++i)
      sum += determinant(from, minus(vertices[v[i - 1]], vertices[0]),
                         minus(vertices[v[i]], vertices[0]));
  }
  return std::max(0.0, sum / 6);
}

}  // namespace cullhull::internal
