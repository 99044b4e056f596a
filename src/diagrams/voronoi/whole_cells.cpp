#include "diagrams/voronoi/whole_cells.hpp"

#include <algorithm>
#include <utility>

#include "cullhull/error.hpp"
#include "exact/planes/halfspace.hpp"

namespace cullhull::internal {

namespace {

/// Checks sizes and indices, so that a wrong diagram cannot cause out-of-range reads.
void require_diagram_of(const Triangulation& t, std::uint64_t vertices, const Voronoi& diagram) {
  const auto below = [](const Array<std::uint32_t>& list, std::uint64_t end) {
    return std::all_of(list.begin(), list.end(),
                       [&](std::uint32_t v) { return v < end || v == at_infinity; });
  };
  const auto& offsets = diagram.ridges.offsets;
  if (diagram.dimension != t.dimension || diagram.point_count != t.point_count ||
      diagram.affine_dimension != t.affine_dimension || diagram.furthest_site != t.furthest_site ||
      diagram.vertex_count() != vertices || offsets.size() != diagram.ridge_count() + 1 ||
      offsets.front() != 0 || offsets.back() != diagram.ridges.items.size() ||
      !std::is_sorted(offsets.begin(), offsets.end()) || !below(diagram.ridges.items, vertices) ||
      std::any_of(diagram.ridge_points.begin(), diagram.ridge_points.end(),
                  [&](std::uint32_t p) { return p >= t.point_count; }))
    throw Error(ErrorCode::invalid_argument, "the diagram is not that of the triangulation");
}

}  // namespace

DiagramCells::DiagramCells(const DualPoints& points, const Triangulation& t, const Voronoi* known,
                           const Run& run)
    : points_(points), t_(t), diagram_(known != nullptr ? *known : own_), first_(first_cells(t)) {
  is_site_.assign(t.point_count, false);
  for (const std::uint32_t v : t.cells) is_site_[v] = true;
  if (known != nullptr) {
    const std::uint64_t groups = first_.empty() ? t.size() : first_.size();
    require_diagram_of(t, t.corners() < 2 ? 0 : groups, *known);
  }
  if (known == nullptr && t.corners() > 1) {
    own_.dimension = t.dimension;
    write_vertices(points, t, own_, run);
    write_ridges(points, t, own_, run);
  }
  ridges_ = Adjacency<Item>(t.point_count, [&](const auto& add) {
    if (t.corners() < 2) return;
    // The pairs are sorted, so the sites across ascend: first the lower ones, then the higher ones.
    for (const unsigned end : {1U, 0U})
      for (std::uint32_t r = 0; r < diagram_.ridge_count(); ++r) {
        const std::uint32_t* pair = diagram_.ridge_points.data() + 2 * std::uint64_t{r};
        add(pair[end], Item{pair[1 - end], r});
      }
  });
}

namespace {

/// Whether the ridges around a site have the orientation that its cell needs; in furthest-site
/// diagrams they have the opposite one.
bool in_full(const Triangulation& t, unsigned d) {
  return t.corners() == d + 1 && !t.furthest_site;
}

bool reaches_infinity(std::span<const std::uint32_t> ridge) {
  return std::find(ridge.begin(), ridge.end(), at_infinity) != ridge.end();
}

}  // namespace

/// The lower end comes first; it is towards the site of smaller coordinate.
template <>
bool WholeCell<1>::start(const DiagramCells& cells, std::uint32_t site) {
  const auto around = cells.of(site);
  if (!in_full(cells.triangulation(), 1) || around.size() != 2) return false;
  const bool in_order =
      cells.points().row(around[0].other)[0] < cells.points().row(around[1].other)[0];
  vertices.clear();
  across.clear();
  for (const unsigned i : {in_order ? 0U : 1U, in_order ? 1U : 0U}) {
    vertices.push_back(cells.ridge(around[i].ridge)[0]);
    across.push_back(around[i].other);
  }
  return true;
}

/// A ridge lists its left vertex first, seen from the lower site towards the other.
/// Counterclockwise around the lower site, the right vertex comes before the left one.
template <>
bool WholeCell<2>::start(const DiagramCells& cells, std::uint32_t site) {
  const auto around = cells.of(site);
  if (!in_full(cells.triangulation(), 2) || around.size() < 3) return false;
  const auto ends = [&](const DiagramCells::Item& item) {
    const auto ridge = cells.ridge(item.ridge);
    return site < item.other ? std::pair(ridge[1], ridge[0]) : std::pair(ridge[0], ridge[1]);
  };
  for (const auto& item : around)
    if (reaches_infinity(cells.ridge(item.ridge))) return false;
  vertices.clear();
  across.clear();
  for (std::uint32_t at = ends(around[0]).first; vertices.size() < around.size();) {
    const auto item = std::find_if(around.begin(), around.end(),
                                   [&](const auto& i) { return ends(i).first == at; });
    if (item == around.end()) return false;
    vertices.push_back(at);
    across.push_back(item->other);
    at = ends(*item).second;
  }
  return true;
}

/// A ridge's vertices are counterclockwise about the direction from the lower site (right-hand
/// rule), so for the lower site counterclockwise from outside.
template <>
bool WholeCell<3>::start(const DiagramCells& cells, std::uint32_t site) {
  const auto around = cells.of(site);
  if (!in_full(cells.triangulation(), 3) || around.size() < 4) return false;
  vertices.clear();
  across.clear();
  items.clear();
  starts.assign(1, 0);
  for (const auto& item : around) {
    const auto ridge = cells.ridge(item.ridge);
    if (reaches_infinity(ridge)) return false;
    items.insert(items.end(), ridge.begin(), ridge.end());
    if (site > item.other)
      std::reverse(items.begin() + static_cast<std::ptrdiff_t>(starts.back()), items.end());
    starts.push_back(static_cast<std::uint32_t>(items.size()));
    across.push_back(item.other);
  }
  vertices = items;
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (std::uint32_t& v : items)
    v = static_cast<std::uint32_t>(std::lower_bound(vertices.begin(), vertices.end(), v) -
                                   vertices.begin());
  return true;
}

/// If the vertex's dual cell contains the site, the vertex is the intersection of the site's
/// bisectors with the other corners. Otherwise it is computed relative to the cell's first corner,
/// and the difference of that corner and the site is added.
template <unsigned D>
template <class Real>
void WholeCell<D>::place(const DiagramCells& cells, std::uint32_t site,
                         std::vector<std::array<Real, D>>& at) const {
  const DualPoints& points = cells.points();
  at.resize(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto cell = cells.dual_cell(vertices[i]);
    const bool has_site = std::find(cell.begin(), cell.end(), site) != cell.end();
    const std::uint32_t from = has_site ? site : cell[0];
    Halfspace<D, Real> planes[D];
    std::array<const Halfspace<D, Real>*, D> meet{};
    unsigned n = 0;
    for (const std::uint32_t other : cell)
      if (other != from) {
        planes[n] = bisector<D, Real>(points.row(from), points.row(other), points.weighted());
        meet[n] = &planes[n];
        ++n;
      }
    at[i] = meeting<Real>(meet);
    for (unsigned j = 0; j < D && from != site; ++j)
      at[i][j] = at[i][j] + exact_difference<Real>(points.row(from)[j], points.row(site)[j]);
  }
}

template class WholeCell<1>;
template class WholeCell<2>;
template class WholeCell<3>;
#define CULLHULL_PLACES(d)                                                                   \
  template void WholeCell<d>::place(const DiagramCells&, std::uint32_t,                      \
                                    std::vector<std::array<BoundedDouble, d>>&) const;       \
  template void WholeCell<d>::place(const DiagramCells&, std::uint32_t,                      \
                                    std::vector<std::array<BoundedDoubleDouble, d>>&) const; \
  template void WholeCell<d>::place(const DiagramCells&, std::uint32_t,                      \
                                    std::vector<std::array<mpq_class, d>>&) const;
CULLHULL_PLACES(1)
CULLHULL_PLACES(2)
CULLHULL_PLACES(3)
#undef CULLHULL_PLACES

}  // namespace cullhull::internal
