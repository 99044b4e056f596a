// cell_polygons(): rings around cells of a 2D triangulation.
#include <algorithm>
#include <utility>
#include <vector>

#include "cullhull/alpha_shape.hpp"
#include "cullhull/error.hpp"
#include "diagrams/dual.hpp"
#include "exact/orientation/orientation.hpp"
#include "parallel/disjoint_sets.hpp"
#include "parallel/index.hpp"

namespace cullhull::internal {
namespace {

using Ring = std::vector<std::uint32_t>;

/// The rings of one connected piece.
struct Polygon {
  Ring outer;
  std::vector<Ring> holes;
};

class PolygonWriter {
 public:
  PolygonWriter(const DualPoints& p, const Triangulation& t, std::span<const std::uint32_t> cells)
      : p_(p), t_(t), kept_(t.size()), walked_(3 * t.size()), place_(t.point_count, 0) {
    for (const std::uint32_t c : cells) kept_[c] = true;
  }

  void write(std::span<const std::uint32_t> cells, CellPolygons& out) {
    find_pieces(cells);
    for (const std::uint32_t c : cells)
      for (unsigned j = 0; j < 3; ++j)
        if (!walked_[3 * std::size_t{c} + j] && on_boundary(c, j)) walk(c, j);
    for (Polygon& polygon : polygons_) std::sort(polygon.holes.begin(), polygon.holes.end());
    std::sort(polygons_.begin(), polygons_.end(),
              [](const Polygon& a, const Polygon& b) { return a.outer < b.outer; });
    for (const Polygon& polygon : polygons_) {
      add(polygon.outer, out);
      for (const Ring& hole : polygon.holes) add(hole, out);
      out.polygon_offsets.push_back(out.ring_count());
    }
  }

 private:
  bool on_boundary(std::uint32_t c, unsigned j) const {
    const std::uint32_t o = t_.neighbours_of(c)[j];
    return o == no_index || !kept_[o];
  }

  /// Finds the connected pieces, numbered in the order of their lowest cells.
  void find_pieces(std::span<const std::uint32_t> cells) {
    DisjointSets sets(t_.size());
    sets.clear(0, t_.size());
    for (const std::uint32_t c : cells)
      for (const std::uint32_t o : t_.neighbours_of(c))
        if (o != no_index && kept_[o]) sets.join(o, c);
    piece_.assign(t_.size(), 0);
    for (const std::uint32_t c : cells) {
      const std::uint32_t root = sets.root(c);  // the lowest, so it comes first
      if (root == c) {
        piece_[c] = static_cast<std::uint32_t>(polygons_.size());
        polygons_.emplace_back();
      }
      piece_[c] = piece_[root];
    }
  }

  /// Follows the boundary from the edge opposite to corner j: at the end of each edge, turns
  /// through the cells around it to the next boundary edge. When the path returns to one of its
  /// points, the part since then is a ring.
  void walk(std::uint32_t c, unsigned j) {
    const std::uint32_t piece = piece_[c];
    Ring path;
    while (!walked_[3 * std::size_t{c} + j]) {
      walked_[3 * std::size_t{c} + j] = true;
      const std::uint32_t from = t_.cell(c)[(j + 1) % 3], to = t_.cell(c)[(j + 2) % 3];
      place_[from] = static_cast<std::uint32_t>(path.size()) + 1;
      path.push_back(from);
      if (place_[to] > 0) close(path, place_[to] - 1, piece);
      turn(c, j, to);
    }
    if (!path.empty()) bad_neighbours();
  }

  /// Moves from the edge that ends at v to the one that begins there.
  void turn(std::uint32_t& c, unsigned& j, std::uint32_t v) const {
    j = (j + 1) % 3;  // opposite to the start of the edge
    for (std::uint64_t steps = 0; !on_boundary(c, j);) {
      if (++steps > t_.size()) bad_neighbours();
      c = t_.neighbours_of(c)[j];
      const unsigned at = place_in(t_.cell(c), v);
      if (at == 3) bad_neighbours();
      j = (at + 2) % 3;
    }
  }

  /// Removes the path's part from index `first` on and adds it as a ring of the piece.
  void close(Ring& path, std::size_t first, std::uint32_t piece) {
    Ring ring(path.begin() + static_cast<std::ptrdiff_t>(first), path.end());
    path.resize(first);
    for (const std::uint32_t v : ring) place_[v] = 0;
    std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
    if (counterclockwise(ring))
      polygons_[piece].outer = std::move(ring);
    else
      polygons_[piece].holes.push_back(std::move(ring));
  }

  /// A ring has the orientation of its corner at the lexicographically least point.
  bool counterclockwise(const Ring& ring) const {
    const auto at = [&](std::uint32_t v, unsigned j) { return p_.row(v)[t_.axes[j]]; };
    const auto least = std::min_element(ring.begin(), ring.end(), [&](auto a, auto b) {
      return at(a, 0) != at(b, 0) ? at(a, 0) < at(b, 0) : at(a, 1) < at(b, 1);
    });
    const auto i = static_cast<std::size_t>(least - ring.begin());
    double rows[3][2];
    const double* corners[3];
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t v = ring[(i + ring.size() + n - 1) % ring.size()];
      rows[n][0] = at(v, 0);
      rows[n][1] = at(v, 1);
      corners[n] = rows[n];
    }
    return orientation(2, corners) == Sign::positive;
  }

  static void add(const Ring& ring, CellPolygons& out) {
    out.rings.items.insert(out.rings.items.end(), ring.begin(), ring.end());
    out.rings.offsets.push_back(out.rings.items.size());
  }

  const DualPoints& p_;
  const Triangulation& t_;
  std::vector<bool> kept_, walked_;
  std::vector<std::uint32_t> place_;  ///< position of each point on the path, from 1; 0: not on it
  std::vector<std::uint32_t> piece_;
  std::vector<Polygon> polygons_;
};

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

CellPolygons cell_polygons(const PointView& points, const Triangulation& triangulation,
                           std::span<const std::uint32_t> cells, const RunOptions& options) {
  using namespace internal;
  const Call call(options);
  const Run& run = call.run;
  const Triangulation& t = triangulation;
  if (t.affine_dimension > 2)
    throw Error(ErrorCode::invalid_argument,
                "polygons are of cells in the plane, not in dimension ", t.affine_dimension);
  const DualPoints p(points, t, {}, run);
  CellPolygons out;
  out.polygon_offsets.assign(1, 0);
  for (const std::uint32_t c : cells)
    if (c >= t.size()) throw Error(ErrorCode::invalid_argument, "there is no cell ", c);
  if (t.affine_dimension == 2) PolygonWriter(p, t, cells).write(cells, out);
  return out;
}

}  // namespace cullhull
