// certify() of constrained 2D triangulations. Uses src/constrained and src/delaunay only to compute
// a witness, which is verified as any other result; docs/exactness.md, "Constrained
// triangulations", explains why the checks are a proof.
#include "cullhull/constrained.hpp"

#include <algorithm>
#include <deque>
#include <utility>
#include <vector>

#include "certify/certificate.hpp"
#include "certify/triangulation/side_filter.hpp"
#include "cullhull/error.hpp"
#include "exact/insphere/lifted_rows.hpp"
#include "exact/orientation/orientation.hpp"
#include "geometry/gather.hpp"

namespace cullhull::internal::certify {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// A sorted table of edges, each with a number.
class EdgeTable {
 public:
  using Item = std::pair<Edge, std::uint64_t>;
  void add(const Edge& edge, std::uint64_t number) { items_.emplace_back(edge, number); }
  void sort() { std::sort(items_.begin(), items_.end()); }
  /// Null if the edge is absent.
  const Item* find(const Edge& edge) const {
    const auto at = std::lower_bound(items_.begin(), items_.end(), Item(edge, 0));
    return at != items_.end() && at->first == edge ? &*at : nullptr;
  }
  std::vector<Item>& items() { return items_; }
  const std::vector<Item>& items() const { return items_; }

 private:
  std::vector<Item> items_;
};

class ConstrainedSubject {
 public:
  ConstrainedSubject(const PointView& points, std::span<const std::uint32_t> edges,
                     const ConstrainedTriangulation& c)
      : points_(points),
        edges_(edges),
        c_(c),
        t_(c.triangulation),
        rows_(gather_points(points, nullptr, points.count, short_run())) {}

  void check(Certificate& out) {
    check_lists();
    if (t_.affine_dimension < 2) {
      const Certificate flat = cullhull::certify(points_, t_);
      if (!flat.valid) throw Fault{flat.reason};
      for (std::size_t i = 0; i + 1 < t_.cells.size(); i += 2)
        if (t_.affine_dimension == 1)
          edges_of_cells_.add(std::minmax(t_.cells[i], t_.cells[i + 1]), 0);
      edges_of_cells_.sort();
    } else {
      check_cells();
      check_hull();
      check_points();
    }
    check_pieces();
    if (t_.affine_dimension == 2) {
      out.ridges_checked = check_circles();
      check_depths();
    }
    out.points_checked = points_.count;
  }

 private:
  const double* row(std::uint32_t v) const { return rows_.data() + 2 * std::size_t{v}; }
  Sign side(std::uint32_t a, std::uint32_t b, std::uint32_t v) const {
    const double* p[] = {row(a), row(b), row(v)};
    return orientation(2, p);
  }
  bool equal(std::uint32_t a, std::uint32_t b) const {
    return row(a)[0] == row(b)[0] && row(a)[1] == row(b)[1];
  }
  /// Lexicographic order of the coordinates.
  bool before(std::uint32_t a, std::uint32_t b) const {
    return row(a)[0] != row(b)[0] ? row(a)[0] < row(b)[0] : row(a)[1] < row(b)[1];
  }

  void check_lists() const {
    if (points_.dimension != 2 || t_.dimension != 2 || t_.point_count != points_.count)
      fault("the triangulation is not of these points");
    if (edges_.size() % 2 != 0 || c_.pieces.size() != 2 * c_.piece_sources.size())
      fault("lists of edges have other lengths");
    for (const auto& list : {std::span<const std::uint32_t>(t_.cells), edges_,
                             std::span<const std::uint32_t>(c_.pieces)})
      for (const std::uint32_t v : list)
        if (v >= points_.count) fault("there is no point ", v);
    if (t_.affine_dimension == 2 &&
        (t_.cells.size() % 3 != 0 || t_.neighbours.size() != t_.cells.size() ||
         c_.depths.size() != t_.size() || t_.hull_facets.size() != 2 * t_.hull_cells.size()))
      fault("lists of cells have other lengths");
  }

  /// Checks orientation, order, neighbours; records the cell on the left of each directed edge.
  void check_cells() {
    for (std::uint32_t i = 0; i < t_.size(); ++i) {
      const auto v = t_.cell(i);
      if (v[0] >= v[1] || v[0] >= v[2]) fault("cell ", i, " does not begin at its lowest id");
      if (side(v[0], v[1], v[2]) != Sign::positive) fault("cell ", i, " is not turned left");
      if (i > 0 && !std::lexicographical_compare(t_.cell(i - 1).begin(), t_.cell(i - 1).end(),
                                                 v.begin(), v.end()))
        fault("cell ", i, " is out of order");
      for (unsigned j = 0; j < 3; ++j)
        left_.add({v[(j + 1) % 3], v[(j + 2) % 3]}, 3 * std::uint64_t{i} + j);
    }
    left_.sort();
    for (std::size_t i = 1; i < left_.items().size(); ++i)
      if (left_.items()[i].first == left_.items()[i - 1].first)
        fault("cell ", left_.items()[i].second / 3, " shares a side of an edge");
    for (const auto& [edge, at] : left_.items()) {
      const auto* back = left_.find({edge.second, edge.first});
      const std::uint32_t expected =
          back == nullptr ? no_index : static_cast<std::uint32_t>(back->second / 3);
      if (t_.neighbours[at] != expected) fault("cell ", at / 3, " has another neighbour");
      if (back == nullptr || edge.first < edge.second)
        edges_of_cells_.add(std::minmax(edge.first, edge.second), 0);
    }
    edges_of_cells_.sort();
  }

  /// Checks that the hull is one convex ring: then cells that turn left and share edges pairwise
  /// cover its inside exactly once.
  void check_hull() const {
    std::vector<std::uint32_t> next(points_.count, no_index);
    std::vector<std::pair<Edge, std::uint32_t>> hull;
    for (const auto& [edge, at] : left_.items()) {
      if (t_.neighbours[at] != no_index) continue;
      if (next[edge.first] != no_index) fault("the hull meets point ", edge.first, " twice");
      next[edge.first] = edge.second;
      hull.emplace_back(edge, static_cast<std::uint32_t>(at / 3));
    }
    if (hull.empty()) fault("there is no hull");
    unsigned turns = 0;
    const std::uint32_t start = hull[0].first.first;
    std::uint32_t a = start;
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const std::uint32_t b = next[a];
      const std::uint32_t c = b == no_index ? no_index : next[b];
      if (c == no_index) fault("the hull is not closed");
      if (side(a, b, c) == Sign::negative) fault("the hull turns right at point ", b);
      if (before(a, b) != before(b, c)) ++turns;
      a = b;
      if (a == start && i + 1 < hull.size()) fault("the hull has several rings");
    }
    if (turns != 2) fault("the hull goes around more than once");
    if (hull.size() != t_.hull_cells.size()) fault("the hull has another number of facets");
    for (std::size_t i = 0; i < hull.size(); ++i)  // sorted, as the table is
      if (t_.hull_facets[2 * i] != hull[i].first.first ||
          t_.hull_facets[2 * i + 1] != hull[i].first.second || t_.hull_cells[i] != hull[i].second)
        fault("facet ", i, " of the hull is another one");
  }

  void check_points() const {
    std::vector<bool> accounted_for(points_.count);
    for (const std::uint32_t v : t_.cells) accounted_for[v] = true;
    for (const DuplicatePoint& p : t_.duplicates) {
      if (p.id >= points_.count || p.representative >= p.id || !equal(p.id, p.representative) ||
          accounted_for[p.id])
        fault("point ", p.id, " is not a duplicate");
      accounted_for[p.id] = true;
    }
    for (std::uint32_t v = 0; v < points_.count; ++v)
      if (!accounted_for[v]) fault("point ", v, " is in no cell");
    if (!t_.hidden.empty()) fault("no point is hidden");
  }

  /// Checks that each constraint is a chain of pieces, and that each piece is an edge and names its
  /// lowest constraint.
  void check_pieces() {
    EdgeTable at;  // pieces, by each end
    for (std::uint32_t i = 0; i < c_.piece_sources.size(); ++i) {
      const Edge e(c_.pieces[2 * std::size_t{i}], c_.pieces[2 * std::size_t{i} + 1]);
      const auto* edge = edges_of_cells_.find(e);
      if (e.first >= e.second || edge == nullptr) fault("piece ", i, " is not an edge");
      if (i > 0 && !(Edge(c_.pieces[2 * i - 2], c_.pieces[2 * i - 1]) < e))
        fault("piece ", i, " is out of order");
      edges_of_cells_.items()[static_cast<std::size_t>(edge - edges_of_cells_.items().data())]
          .second = 1;
      at.add(e, i);
      at.add({e.second, e.first}, i);
    }
    at.sort();
    std::vector<std::uint32_t> representative(points_.count),
        sources(c_.piece_sources.size(), no_index);
    for (std::uint32_t v = 0; v < points_.count; ++v) representative[v] = v;
    for (const DuplicatePoint& p : t_.duplicates) representative[p.id] = p.representative;
    for (std::uint32_t i = 0; 2 * std::size_t{i} < edges_.size(); ++i) {
      std::uint32_t v = representative[edges_[2 * std::size_t{i}]];
      const std::uint32_t end = representative[edges_[2 * std::size_t{i} + 1]];
      while (v != end) {
        std::uint32_t next = no_index;
        for (auto item =
                 std::lower_bound(at.items().begin(), at.items().end(), EdgeTable::Item({v, 0}, 0));
             item != at.items().end() && item->first.first == v; ++item) {
          const std::uint32_t other = item->first.second;
          if (other != end &&
              (side(v, end, other) != Sign::zero || before(v, end) != before(v, other) ||
               before(v, other) != before(other, end)))
            continue;
          next = other;
          sources[item->second] = std::min(sources[item->second], i);
        }
        if (next == no_index) fault("constraint ", i, " has no piece at point ", v);
        v = next;
      }
    }
    for (std::size_t i = 0; i < sources.size(); ++i)
      if (sources[i] != c_.piece_sources[i]) fault("piece ", i, " is another constraint's");
  }
  bool is_piece(std::uint32_t a, std::uint32_t b) const {
    return edges_of_cells_.find(std::minmax(a, b))->second != 0;
  }

  /// Checks the circles of every edge between cells that is not a piece.
  std::uint64_t check_circles() const {
    std::uint64_t count = 0;
    for (const auto& [edge, place] : left_.items()) {
      const auto* back = left_.find({edge.second, edge.first});
      if (back == nullptr || edge.first > edge.second || is_piece(edge.first, edge.second))
        continue;
      ++count;
      const std::uint32_t p = t_.cells[place], q = t_.cells[back->second];
      const double* corners[] = {row(edge.first), row(edge.second), row(p)};
      Sign sign = Sign::zero;
      if (!side_filtered<2>(2, false, corners, row(q), sign))
        sign = determinant_sign(LiftedRows(2, 2, false, corners, row(q)));
      if (sign == Sign::negative)
        fault("the circle of cell ", place / 3, " has the point ", q, " inside");
      if (sign == Sign::zero && std::min(p, q) < edge.first)
        fault("the edge ", edge.first, " ", edge.second,
              " is not that of the lowest id on its circle");
    }
    return count;
  }

  void check_depths() const {
    std::vector<std::uint32_t> depth(t_.size(), no_index);
    std::deque<std::pair<std::uint32_t, std::uint32_t>> todo;
    const auto reach = [&](std::uint32_t cell, bool piece, std::uint32_t from) {
      if (piece)
        todo.emplace_back(cell, from + 1);
      else
        todo.emplace_front(cell, from);
    };
    for (std::size_t i = 0; i < t_.hull_cells.size(); ++i)
      reach(t_.hull_cells[i], is_piece(t_.hull_facets[2 * i], t_.hull_facets[2 * i + 1]), 0);
    while (!todo.empty()) {
      const auto [cell, found] = todo.front();
      todo.pop_front();
      if (depth[cell] <= found) continue;
      depth[cell] = found;
      for (unsigned j = 0; j < 3; ++j)
        if (const std::uint32_t o = t_.neighbours_of(cell)[j]; o != no_index)
          reach(o, is_piece(t_.cell(cell)[(j + 1) % 3], t_.cell(cell)[(j + 2) % 3]), found);
    }
    for (std::size_t i = 0; i < depth.size(); ++i)
      if (depth[i] != c_.depths[i]) fault("cell ", i, " has another depth");
  }

  const PointView& points_;
  std::span<const std::uint32_t> edges_;
  const ConstrainedTriangulation& c_;
  const Triangulation& t_;
  Array<double> rows_;
  EdgeTable left_;            ///< 3 * cell + slot of the cell on the left
  EdgeTable edges_of_cells_;  ///< lower id first; the number is 1 for pieces
};

/// Checks that `result` consists of the cells of odd depth of a certified whole triangulation.
class InsideSubject {
 public:
  InsideSubject(const ConstrainedTriangulation& whole, const ConstrainedTriangulation& result)
      : whole_(whole), result_(result), w_(whole.triangulation), t_(result.triangulation) {}

  void check() {
    if (t_.dimension != w_.dimension || t_.point_count != w_.point_count ||
        t_.affine_dimension != w_.affine_dimension || t_.axes != w_.axes ||
        t_.duplicates != w_.duplicates)
      fault("the triangulation is not of these points");
    if (result_.pieces != whole_.pieces || result_.piece_sources != whole_.piece_sources)
      fault("the pieces are other ones");
    if (!t_.cell_groups.empty()) fault("constrained triangulations have no groups");
    if (w_.affine_dimension < 2) {
      if (t_.cells != w_.cells || t_.neighbours != w_.neighbours ||
          t_.hull_facets != w_.hull_facets || t_.hull_cells != w_.hull_cells ||
          !t_.hidden.empty() || !result_.depths.empty())
        fault("points on a line have other cells");
      return;
    }
    check_cells();
    check_hull();
    check_hidden();
  }

 private:
  bool inside(std::uint32_t cell) const { return whole_.depths[cell] % 2 == 1; }

  void check_cells() {
    number_.assign(w_.size(), no_index);
    std::uint32_t count = 0;
    for (std::uint32_t c = 0; c < w_.size(); ++c)
      if (inside(c)) number_[c] = count++;
    if (t_.cells.size() != 3 * std::size_t{count} || t_.neighbours.size() != t_.cells.size() ||
        result_.depths.size() != count)
      fault("there are other cells than the ", count, " inside");
    for (std::uint32_t c = 0; c < w_.size(); ++c) {
      const std::uint32_t at = number_[c];
      if (at == no_index) continue;
      const auto own = t_.cell(at), expected = w_.cell(c);
      if (!std::equal(own.begin(), own.end(), expected.begin()))
        fault("cell ", at, " is another one");
      if (result_.depths[at] != whole_.depths[c]) fault("cell ", at, " has another depth");
      for (unsigned j = 0; j < 3; ++j) {
        const std::uint32_t o = w_.neighbours_of(c)[j];
        if (t_.neighbours_of(at)[j] != (o == no_index ? no_index : number_[o]))
          fault("cell ", at, " has another neighbour");
      }
    }
  }
  void check_hull() const {
    std::vector<std::pair<Edge, std::uint32_t>> hull;
    for (std::uint32_t c = 0; c < t_.size(); ++c)
      for (unsigned j = 0; j < 3; ++j)
        if (t_.neighbours_of(c)[j] == no_index)
          hull.push_back({{t_.cell(c)[(j + 1) % 3], t_.cell(c)[(j + 2) % 3]}, c});
    std::sort(hull.begin(), hull.end());
    if (t_.hull_cells.size() != hull.size() || t_.hull_facets.size() != 2 * hull.size())
      fault("the hull has another number of facets");
    for (std::size_t i = 0; i < hull.size(); ++i)
      if (Edge(t_.hull_facets[2 * i], t_.hull_facets[2 * i + 1]) != hull[i].first ||
          t_.hull_cells[i] != hull[i].second)
        fault("facet ", i, " of the hull is another one");
  }
  void check_hidden() const {
    std::vector<bool> accounted_for(t_.point_count);
    for (const std::uint32_t v : t_.cells) accounted_for[v] = true;
    for (const DuplicatePoint& p : t_.duplicates) accounted_for[p.id] = true;
    std::vector<std::uint32_t> hidden;
    for (std::uint32_t v = 0; v < t_.point_count; ++v)
      if (!accounted_for[v]) hidden.push_back(v);
    if (hidden != t_.hidden) fault("other points are hidden");
  }

  const ConstrainedTriangulation &whole_, &result_;
  const Triangulation &w_, &t_;
  std::vector<std::uint32_t> number_;  ///< for each cell of the whole, its number in the result
};

/// Computes the whole triangulation for `result`; a fault if that is impossible.
ConstrainedTriangulation witness_of(const PointView& points, std::span<const std::uint32_t> edges,
                                    ConstrainedOptions options) {
  options.inside_only = false;
  try {
    return constrained_delaunay(points, edges, options);
  } catch (const Error& e) {
    if (e.code() == ErrorCode::cancelled || e.code() == ErrorCode::out_of_budget) throw;
    throw Fault{e.what()};
  }
}

}  // namespace
}  // namespace cullhull::internal::certify

namespace cullhull {

Certificate certify(const PointView& points, std::span<const std::uint32_t> edges,
                    const ConstrainedTriangulation& result, const ConstrainedOptions& options) {
  using namespace internal::certify;
  Certificate out;
  try {
    if (options.inside_only) {
      const ConstrainedTriangulation whole = witness_of(points, edges, options);
      ConstrainedSubject(points, edges, whole).check(out);
      InsideSubject(whole, result).check();
    } else {
      ConstrainedSubject(points, edges, result).check(out);
    }
    out.valid = true;
  } catch (const Fault& f) {
    out.reason = f.reason;
  }
  return out;
}

}  // namespace cullhull
