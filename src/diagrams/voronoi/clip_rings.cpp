#include "diagrams/voronoi/clip_rings.hpp"

#include <algorithm>
#include <utility>

#include "cullhull/voronoi.hpp"
#include "parallel/disjoint_sets.hpp"

namespace cullhull::internal {
namespace {

using Point = std::array<double, 2>;

struct PieceEdge {
  std::uint32_t from, to, plane;  ///< numbers of corners and plane
  Point start;                    ///< `from`, rounded
};

template <class Real, class At>
Real twice_area(const std::vector<PieceEdge>& edges, const std::vector<std::uint32_t>& ring,
                const At& at) {
  Real sum(0.0);
  for (const std::uint32_t e : ring) {
    const auto &a = at(edges[e].from), &b = at(edges[e].to);
    sum = sum + (a[0] * b[1] - a[1] * b[0]);
  }
  return sum;
}

/// The boundary of connected pieces (through edges).
class PieceBoundary {
 public:
  PieceBoundary(CellCorners<2>& corners, std::vector<PieceEdge> edges)
      : corners_(corners), edges_(std::move(edges)) {
    std::sort(edges_.begin(), edges_.end(),
              [](const PieceEdge& a, const PieceEdge& b) { return a.start < b.start; });
  }

  /// The boundary as a polygon, whose outline is empty if no ring remains.
  CellPolygon polygon() {
    std::vector<bool> walked(edges_.size());
    CellPolygon out(1);
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      if (walked[e]) continue;
      std::vector<std::uint32_t> ring;
      for (std::uint32_t at = e; !walked[at]; at = next(at)) {
        walked[at] = true;
        ring.push_back(at);
      }
      add_ring(
          points_of(ring), [&] { return is_outer(ring); }, out);
    }
    return out;
  }

 private:
  /// The next edge on the ring: of several that begin where e ends, the first one counterclockwise
  /// from the reversed e. So a boundary that touches itself in a point becomes several rings.
  std::uint32_t next(std::uint32_t e) {
    Point end;
    corners_.round(edges_[e].to, end.data());
    const auto [first, last] =
        std::equal_range(edges_.begin(), edges_.end(), PieceEdge{0, 0, 0, end},
                         [](const PieceEdge& a, const PieceEdge& b) { return a.start < b.start; });
    auto best = first;
    if (last - first > 1) {
      best = last;
      for (auto i = first; i != last; ++i)
        if (corners_.equal(i->from, edges_[e].to) &&
            (best == last || turns_before(edges_[e].plane, i->plane, best->plane)))
          best = i;
    }
    return static_cast<std::uint32_t>(best - edges_.begin());
  }

  /// Whether a's edge comes before b's when turning counterclockwise from the reversed edge of
  /// `in`. Edges are represented by their planes' normals, which are rotated by a right angle.
  bool turns_before(std::uint32_t in, std::uint32_t a, std::uint32_t b) {
    const auto cross = [](const auto& u, const auto& v) {
      return sgn(mpq_class(u[0] * v[1] - u[1] * v[0]));
    };
    auto back = corners_.exact_halfspace(in).normal;
    for (mpq_class& x : back) x = -x;
    const auto &u = corners_.exact_halfspace(a).normal, &v = corners_.exact_halfspace(b).normal;
    const auto half = [&](const auto& w) {
      const int turn = cross(back, w);
      if (turn != 0) return turn > 0 ? 0 : 2;
      return sgn(mpq_class(back[0] * w[0] + back[1] * w[1])) < 0 ? 1 : 3;
    };
    return half(u) != half(v) ? half(u) < half(v) : cross(u, v) > 0;
  }

  /// A corner between two edges of the same plane comes from the region's triangles; the cell has
  /// no corner there. It is kept if it is a corner of the region, because the cell beyond may turn
  /// there.
  CellRing points_of(const std::vector<std::uint32_t>& ring) const {
    CellRing out;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const PieceEdge &before = edges_[ring[i > 0 ? i - 1 : ring.size() - 1]], &e = edges_[ring[i]];
      if (before.plane == e.plane && !corners_.is_given(e.from)) continue;
      out.points.push_back(e.start);
      out.across.push_back(corners_.site_across(e.plane));
    }
    return out;
  }

  bool is_outer(const std::vector<std::uint32_t>& ring) {
    const Sign sign = certain_sign(twice_area<BoundedDoubleDouble>(
        edges_, ring, [&](auto c) -> auto& { return corners_.at(c); }));
    if (sign != Sign::zero) return sign == Sign::positive;
    return sgn(twice_area<mpq_class>(
               edges_, ring, [&](auto c) -> auto& { return corners_.exact(c); })) > 0;
  }

  CellCorners<2>& corners_;
  std::vector<PieceEdge> edges_;
};

/// A cell is cut into one piece per triangle of the region. Calls body(i, j) with indices into
/// `pieces` (ascending by triangle) of two pieces whose triangles share an edge that the cell
/// crosses; each such pair occurs from both sides.
template <class Body>
void each_seam(const CellCorners<2>& corners, const std::vector<CellPiece>& pieces,
               const Body& body) {
  for (std::uint32_t i = 0; i < pieces.size(); ++i)
    for (const std::uint32_t plane : pieces[i].planes) {
      if (corners.piece_across(plane) == no_index) continue;
      const auto other = std::lower_bound(
          pieces.begin(), pieces.end(), corners.piece_across(plane),
          [](const CellPiece& p, std::uint32_t number) { return p.piece < number; });
      body(i, static_cast<std::uint32_t>(other - pieces.begin()));
    }
}

}  // namespace

bool tidy(CellRing& ring) {
  const std::size_t n = ring.points.size();
  CellRing kept;
  for (std::size_t i = 0; i < n; ++i) {
    if (ring.points[i] == ring.points[i + 1 < n ? i + 1 : 0]) continue;
    kept.points.push_back(ring.points[i]);
    kept.across.push_back(ring.across[i]);
  }
  if (kept.points.size() < 3) return false;
  const auto least = std::min_element(kept.points.begin(), kept.points.end()) - kept.points.begin();
  std::rotate(kept.points.begin(), kept.points.begin() + least, kept.points.end());
  std::rotate(kept.across.begin(), kept.across.begin() + least, kept.across.end());
  ring = std::move(kept);
  return true;
}

void sort_rings(std::vector<CellPolygon>& polygons) {
  const auto before = [](const CellRing& a, const CellRing& b) {
    return a.points[0] < b.points[0];
  };
  for (CellPolygon& polygon : polygons) std::sort(polygon.begin() + 1, polygon.end(), before);
  std::sort(polygons.begin(), polygons.end(),
            [&](const CellPolygon& a, const CellPolygon& b) { return before(a[0], b[0]); });
}

void begin_lists(ClippedCells& out) {
  out.vertex_offsets.assign(1, 0);
  for (Array<std::uint64_t>* list : {&out.polygon_offsets, &out.polygon_rings, &out.ring_starts})
    if (out.dimension == 2) list->assign(1, 0);
  if (out.dimension == 3) out.face_offsets.assign(1, 0);
}

void add_polygons(const std::vector<CellPolygon>& polygons, ClippedCells& out) {
  for (const CellPolygon& polygon : polygons) {
    for (const CellRing& ring : polygon) {
      for (const auto& x : ring.points) out.vertices.insert(out.vertices.end(), x.begin(), x.end());
      out.neighbours.insert(out.neighbours.end(), ring.across.begin(), ring.across.end());
      out.ring_starts.push_back(out.neighbours.size());
    }
    out.polygon_rings.push_back(out.ring_starts.size() - 1);
  }
  out.polygon_offsets.push_back(out.polygon_rings.size() - 1);
  out.vertex_offsets.push_back(out.neighbours.size());
}

std::vector<CellPolygon> join_pieces(CellCorners<2>& corners,
                                     const std::vector<CellPiece>& pieces) {
  DisjointSets sets(pieces.size());
  sets.clear(0, pieces.size());
  each_seam(corners, pieces, [&](std::uint32_t i, std::uint32_t j) { sets.join(i, j); });
  std::vector<std::vector<PieceEdge>> boundaries(pieces.size());
  for (std::uint32_t i = 0; i < pieces.size(); ++i) {
    const auto& [piece, vertices, planes] = pieces[i];
    for (std::size_t e = 0; e < planes.size(); ++e) {
      if (corners.piece_across(planes[e]) != no_index) continue;
      PieceEdge edge{vertices[e], vertices[e + 1 < vertices.size() ? e + 1 : 0], planes[e], {}};
      corners.round(edge.from, edge.start.data());
      boundaries[sets.root(i)].push_back(edge);
    }
  }
  std::vector<CellPolygon> polygons;
  for (std::vector<PieceEdge>& boundary : boundaries) {
    if (boundary.empty()) continue;
    CellPolygon polygon = PieceBoundary(corners, std::move(boundary)).polygon();
    if (!polygon[0].points.empty()) polygons.push_back(std::move(polygon));
  }
  sort_rings(polygons);
  return polygons;
}

}  // namespace cullhull::internal
