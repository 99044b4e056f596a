// certify() of triangulations, without any code of src/delaunay. The proof, step by step, is in
// docs/exactness.md, "Certificate of a triangulation".
#include "cullhull/triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "certify/certificate.hpp"
#include "certify/triangulation/side_filter.hpp"
#include "exact/insphere/lifted_rows.hpp"
#include "exact/numbers/gmpxx.hpp"
#include "exact/numbers/rationals.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/planes/exact_plane.hpp"
#include "geometry/gather.hpp"
#include "parallel/disjoint_sets.hpp"
#include "parallel/dispatch.hpp"

namespace cullhull::internal::certify {
namespace {

class TriangulationSubject {
 public:
  TriangulationSubject(const PointView& points, std::span<const double> weights,
                       const Triangulation& t, const Run& run)
      : points_(points), weights_(weights), t_(t), run_(run) {}

  void check(Certificate& out) {
    check_header();
    if (t_.point_count == 0) return check_empty();
    k_ = static_cast<unsigned>(t_.affine_dimension);
    check_lists();
    read_rows();
    check_flat();
    check_points();
    out.points_checked = t_.point_count;
    if (k_ == 0) return;
    run_.report("certify", 0.2);
    check_cells();
    check_neighbours();
    run_.report("certify", 0.4);
    check_hull();
    check_covered_once();
    run_.report("certify", 0.6);
    out.ridges_checked = check_ridges();
    if (weighted()) check_extreme();
    check_hidden();
    run_.report("certify", 1);
  }
  std::uint64_t exact_decisions() const { return exact_.load(); }

 private:
  bool weighted() const { return !weights_.empty(); }
  unsigned corners() const { return k_ + 1; }
  const double* row(std::uint32_t id) const { return rows_.data() + std::size_t{id} * stride_; }
  std::uint64_t size() const { return t_.cells.size() / corners(); }

  void check_header() const {
    if (t_.dimension != points_.dimension) fault("the dimension is not that of the points");
    if (t_.point_count != points_.count)
      fault("the triangulation is that of ", t_.point_count, " points, not of ", points_.count);
    if (t_.scalar != points_.scalar) fault("the scalar type is not that of the points");
    if (t_.affine_dimension < -1 ||
        t_.affine_dimension > static_cast<std::int64_t>(points_.dimension) ||
        (t_.point_count == 0) != (t_.affine_dimension == -1))
      fault("affine dimension ", t_.affine_dimension, " is impossible");
  }

  void check_empty() const {
    if (!t_.axes.empty() || !t_.cells.empty() || !t_.neighbours.empty() ||
        !t_.cell_groups.empty() || !t_.hull_facets.empty() || !t_.hull_cells.empty() ||
        !t_.duplicates.empty() || !t_.hidden.empty())
      fault("there are no points, but lists");
  }

  void check_lists() const {
    const std::uint64_t cells = size();
    if (t_.cells.empty() || t_.cells.size() % corners() != 0)
      fault("the list of cells has ", t_.cells.size(), " ids");
    if (t_.neighbours.size() != t_.cells.size())
      fault("there are ", t_.cells.size(), " corners, but ", t_.neighbours.size(), " neighbours");
    if (!t_.cell_groups.empty() && t_.cell_groups.size() != cells)
      fault("there are ", cells, " cells, but ", t_.cell_groups.size(), " group numbers");
    if (t_.hull_facets.size() != t_.hull_cells.size() * k_)
      fault("the hull's facets have ", t_.hull_facets.size(), " ids");
    for (std::size_t i = 0; i < t_.cells.size(); ++i)
      if (t_.cells[i] >= t_.point_count)
        fault("cell ", i / corners(), " has an id beyond the points");
    if (k_ == 0 && (cells != 1 || t_.neighbours[0] != no_index || !t_.hull_cells.empty() ||
                    !t_.cell_groups.empty()))
      fault("equal points make one cell without neighbours");
  }

  /// Reads rows: first coordinates on the flat's axes, then the others, then the weight.
  void read_rows() {
    const unsigned d = points_.dimension;
    if (t_.axes.size() != k_ || !std::is_sorted(t_.axes.begin(), t_.axes.end()) ||
        std::adjacent_find(t_.axes.begin(), t_.axes.end()) != t_.axes.end() ||
        (k_ > 0 && t_.axes.back() >= d))
      fault("the axes are not as many as the affine dimension, or not ascending");
    const std::vector<std::uint32_t> columns = flat_columns(t_.axes, d);
    stride_ = d + (weighted() ? 1 : 0);
    rows_.resize(t_.point_count * stride_);
    check_each(t_.point_count, [&](std::uint64_t i) {
      double* r = rows_.data() + i * stride_;
      for (unsigned j = 0; j < d; ++j) {
        r[j] = points_.at(i, columns[j]);
        if (!std::isfinite(r[j])) fault("point ", i, " is not finite");
      }
      if (!weighted()) return;
      r[d] = weights_[i];
      if (!std::isfinite(r[d])) fault("the weight of point ", i, " is not finite");
    });
  }

  /// Checks that all points are in the flat of the first cell, whose corners are independent on the
  /// axes.
  void check_flat() {
    const unsigned d = points_.dimension;
    std::vector<double> corner_rows;
    std::vector<const double*> corner(corners());
    for (const std::uint32_t v : t_.cell(0))
      for (unsigned j = 0; j < d; ++j) corner_rows.push_back(points_.at(v, j));
    for (unsigned i = 0; i < corners(); ++i) corner[i] = corner_rows.data() + std::size_t{i} * d;
    std::vector<unsigned> axes(d);
    if (affine_rank_exact(d, corner.data(), corners(), axes.data()) != k_) fault("cell 0 is flat");
    if (!std::equal(t_.axes.begin(), t_.axes.end(), axes.begin()))
      fault("the axes are not those of the flat's echelon form");
    for (unsigned extra = k_; extra < d; ++extra)
      check_each(t_.point_count, [&](std::uint64_t i) {
        std::vector<double> p((k_ + 2) * (k_ + 1));
        std::vector<const double*> at(k_ + 2);
        for (unsigned c = 0; c < k_ + 2; ++c) {
          const double* from = row(c <= k_ ? t_.cells[c] : static_cast<std::uint32_t>(i));
          std::copy_n(from, k_, p.data() + std::size_t{c} * (k_ + 1));
          p[std::size_t{c} * (k_ + 1) + k_] = from[extra];
          at[c] = p.data() + std::size_t{c} * (k_ + 1);
        }
        if (orientation(k_ + 1, at.data()) != Sign::zero)
          fault("point ", i, " is not in the flat of cell 0");
      });
  }

  /// Checks that every id is exactly one of vertex, duplicate and hidden.
  void check_points() {
    enum : std::uint8_t { unlisted, vertex, duplicate, hidden };
    std::vector<std::uint8_t> role(t_.point_count, unlisted);
    for (const std::uint32_t v : t_.cells) role[v] = vertex;
    std::uint64_t last = 0;
    for (const DuplicatePoint& p : t_.duplicates) {
      if (p.id >= t_.point_count || p.representative >= t_.point_count || p.id < last)
        fault("the duplicates are not ascending ids");
      if (role[p.id] != unlisted) fault("point ", p.id, " is a duplicate and something else");
      role[p.id] = duplicate;
      last = std::uint64_t{p.id} + 1;
    }
    for (const DuplicatePoint& p : t_.duplicates) {
      const double *a = row(p.id), *b = row(p.representative);
      if (role[p.representative] == duplicate || !std::equal(a, a + points_.dimension, b))
        fault("point ", p.representative, " cannot stand in for ", p.id);
      // The highest in the lift, for the furthest site, is the one of the smallest weight.
      const double own = weighted() ? weights_[p.id] : 0;
      const double other = weighted() ? weights_[p.representative] : 0;
      if (own == other ? p.id < p.representative : (own > other) != t_.furthest_site)
        fault("point ", p.id, " should stand in for ", p.representative);
    }
    last = 0;
    for (const std::uint32_t id : t_.hidden) {
      if (id >= t_.point_count || id < last) fault("the hidden points are not ascending ids");
      if (role[id] != unlisted) fault("point ", id, " is hidden and something else");
      role[id] = hidden;
      last = std::uint64_t{id} + 1;
    }
    for (std::uint64_t i = 0; i < t_.point_count; ++i)
      if (role[i] == unlisted) fault("point ", i, " is in no list");
    if (!t_.hidden.empty() && !weighted() && !t_.furthest_site)
      fault("point ", t_.hidden[0], " is hidden without weights");
    if (!t_.hidden.empty()) check_distinct(role, duplicate);
  }

  void check_distinct(const std::vector<std::uint8_t>& role, std::uint8_t duplicate) const {
    std::vector<std::uint32_t> ids;
    for (std::uint32_t i = 0; i < t_.point_count; ++i)
      if (role[i] != duplicate) ids.push_back(i);
    const unsigned d = points_.dimension;
    std::sort(ids.begin(), ids.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::lexicographical_compare(row(a), row(a) + d, row(b), row(b) + d);
    });
    for (std::size_t i = 1; i < ids.size(); ++i)
      if (std::equal(row(ids[i - 1]), row(ids[i - 1]) + d, row(ids[i])))
        fault("points ", ids[i - 1], " and ", ids[i], " are equal, but no duplicates");
  }

  void check_cells() {
    check_each(size(), [&](std::uint64_t c) {
      const auto v = t_.cell(c);
      for (unsigned i = 1; i + 2 < corners(); ++i)
        if (v[i - 1] >= v[i]) fault("cell ", c, " is not ascending");
      for (unsigned i = corners() > 1 ? corners() - 2 : 0; i > 0 && i < corners(); ++i)
        if (v[corners() - 3] >= v[i]) fault("cell ", c, " is not ascending");
      if (c > 0 && !std::lexicographical_compare(t_.cell(c - 1).begin(), t_.cell(c - 1).end(),
                                                 v.begin(), v.end()))
        fault("cells ", c - 1, " and ", c, " are not in order");
      std::vector<const double*> at;
      for (const std::uint32_t id : v) at.push_back(row(id));
      if (oriented(at.data()) != Sign::positive) fault("cell ", c, " is not oriented positively");
    });
  }

  void check_neighbours() {
    check_each(size(), [&](std::uint64_t c) {
      for (unsigned j = 0; j < corners(); ++j) {
        const std::uint32_t o = t_.neighbours_of(c)[j];
        if (o == no_index) continue;
        if (o >= size() || o == c) fault("cell ", c, " has an impossible neighbour ", o);
        const auto back = t_.neighbours_of(o);
        if (std::count(back.begin(), back.end(), c) != 1)
          fault("cells ", c, " and ", o, " are not mutual neighbours");
        const auto slot = std::find(back.begin(), back.end(), c) - back.begin();
        if (facet_of(c, j) != facet_of(o, static_cast<unsigned>(slot)))
          fault("cells ", c, " and ", o, " share no facet");
      }
    });
  }

  /// The ids of the facet opposite to corner j of cell c, ascending.
  std::vector<std::uint32_t> facet_of(std::uint64_t c, unsigned j) const {
    std::vector<std::uint32_t> ids;
    for (unsigned i = 0; i < corners(); ++i)
      if (i != j) ids.push_back(t_.cell(c)[i]);
    std::sort(ids.begin(), ids.end());
    return ids;
  }

  /// Checks that the facets without a neighbour are those listed, and that exactly two of them meet
  /// in each ridge, weakly convex.
  void check_hull() {
    std::uint64_t open = 0;
    for (const std::uint32_t n : t_.neighbours) open += n == no_index ? 1 : 0;
    if (open != t_.hull_cells.size())
      fault(open, " facets have no neighbour, but the hull has ", t_.hull_cells.size());
    struct Ridge {
      std::vector<std::uint32_t> ids;
      std::uint64_t facet;
      std::uint32_t apex;
    };
    std::vector<Ridge> ridges;
    for (std::uint64_t f = 0; f < open; ++f) {
      const auto facet = t_.hull_facet(f);
      if (f > 0 &&
          !std::lexicographical_compare(t_.hull_facet(f - 1).begin(), t_.hull_facet(f - 1).end(),
                                        facet.begin(), facet.end()))
        fault("hull facets ", f - 1, " and ", f, " are not in order");
      check_hull_facet(f);
      for (unsigned i = 0; i < k_; ++i) {
        Ridge r{{}, f, facet[i]};
        for (unsigned j = 0; j < k_; ++j)
          if (j != i) r.ids.push_back(facet[j]);
        std::sort(r.ids.begin(), r.ids.end());
        ridges.push_back(std::move(r));
      }
    }
    std::sort(ridges.begin(), ridges.end(),
              [](const Ridge& a, const Ridge& b) { return a.ids < b.ids; });
    if (ridges.size() % 2 != 0) fault("the hull is not closed");
    for (std::size_t i = 0; i < ridges.size(); i += 2) {
      if (ridges[i].ids != ridges[i + 1].ids ||
          (i + 2 < ridges.size() && ridges[i + 2].ids == ridges[i].ids))
        fault("the hull is not closed at facet ", ridges[i].facet);
      for (unsigned side = 0; side < 2; ++side)
        if (beneath(ridges[i + side].facet, row(ridges[i + 1 - side].apex)) == Sign::negative)
          fault("the hull is not convex at facet ", ridges[i + side].facet);
    }
  }

  void check_hull_facet(std::uint64_t f) const {
    const std::uint32_t c = t_.hull_cells[f];
    if (c >= size()) fault("hull facet ", f, " belongs to no cell");
    const auto facet = t_.hull_facet(f);
    for (unsigned i = 1; i < k_; ++i)
      if (facet[i - 1] >= facet[i] && !(i + 1 == k_ && i > 0))
        fault("hull facet ", f, " is not ascending");
    if (k_ >= 3 && facet[k_ - 3] >= facet[k_ - 1]) fault("hull facet ", f, " is not ascending");
    std::vector<std::uint32_t> ids(facet.begin(), facet.end());
    std::sort(ids.begin(), ids.end());
    for (unsigned j = 0; j < corners(); ++j) {
      if (t_.neighbours_of(c)[j] != no_index || facet_of(c, j) != ids) continue;
      if (k_ > 1 && beneath(f, row(t_.cell(c)[j])) != Sign::positive)
        fault("hull facet ", f, " is not oriented outward");
      return;
    }
    fault("hull facet ", f, " is no open facet of cell ", c);
  }

  /// Positive: p is strictly on the inner side of a hull facet. k = 1: a facet is one id; its
  /// cell's other corner is inside.
  Sign beneath(std::uint64_t f, const double* p) const {
    std::vector<const double*> at;
    for (const std::uint32_t id : t_.hull_facet(f)) at.push_back(row(id));
    at.push_back(p);
    if (k_ == 1) {
      const auto cell = t_.cell(t_.hull_cells[f]);
      const Sign sign = oriented(at.data());  // left end: inside is above
      return t_.hull_facet(f)[0] == cell[0] ? sign : -sign;
    }
    const Sign sign = oriented(at.data());
    return k_ % 2 == 0 ? sign : -sign;
  }

  Sign oriented(const double* const* p) const {
    Rung rung = Rung::filter;
    const Sign sign = orientation(k_, p, &rung);
    if (rung == Rung::exact) ++exact_;
    return sign;
  }

  /// Checks that a point strictly inside cell 0 is in no other cell and beneath every facet of the
  /// hull. Then each ray from that point meets the hull once, and the cells cover its inside once.
  void check_covered_once() {
    std::vector<const double*> cell;
    for (const std::uint32_t v : t_.cell(0)) cell.push_back(row(v));
    std::vector<double> centre(k_);
    for (unsigned j = 0; j < k_; ++j)
      for (const double* v : cell) centre[j] += v[j] / corners();
    bool inside = true;
    for (unsigned j = 0; j < k_; ++j) inside = inside && std::isfinite(centre[j]);
    for (unsigned j = 0; inside && j < corners(); ++j) {
      std::vector<const double*> at = cell;
      at[j] = centre.data();
      inside = oriented(at.data()) == Sign::positive;
    }
    // The orientation of c with corner j replaced by the centre: rounded if that is inside, else
    // exact.
    const auto replaced = [&](const std::uint32_t* v, unsigned j) {
      std::vector<const double*> at;
      for (unsigned i = 0; i < corners(); ++i)
        if (inside || i != j) at.push_back(i == j ? centre.data() : row(v[i]));
      if (inside) return oriented(at.data());
      ++exact_;
      const Sign sign = orientation_from_centroid_exact(k_, at.data(), cell.data());
      return j % 2 == 0 ? sign : -sign;
    };
    check_each(size() - 1, [&](std::uint64_t i) {
      const std::uint64_t c = i + 1;
      const std::uint32_t* v = t_.cells.data() + c * corners();
      for (unsigned a = 0; inside && a < k_; ++a) {
        bool below = true, above = true;
        for (unsigned j = 0; j < corners(); ++j) {
          below = below && row(v[j])[a] < centre[a];
          above = above && row(v[j])[a] > centre[a];
        }
        if (below || above) return;
      }
      for (unsigned j = 0; j < corners(); ++j)
        if (replaced(v, j) == Sign::negative) return;
      fault("cells 0 and ", c, " overlap");
    });
    check_each(t_.hull_cells.size(), [&](std::uint64_t f) {
      if (k_ == 1) return;  // two ends
      std::vector<std::uint32_t> v(t_.hull_facet(f).begin(), t_.hull_facet(f).end());
      v.push_back(v[0]);
      const Sign sign = replaced(v.data(), k_);
      // With the centre last, as in beneath().
      if ((k_ % 2 == 0 ? sign : -sign) != Sign::positive)
        fault("hull facet ", f, " is not seen from within");
    });
    if (k_ == 1 && t_.hull_cells.size() != 2) fault("the hull of a line has two ends");
  }

  /// The side of the lifted cell's hyperplane that a lifted point is on; negative is below.
  Sign side(const double* const* c, const double* p) const {
    const unsigned d = points_.dimension;
    Sign sign = Sign::zero;
    const bool decided = with_dimension<1, 6, 0>(k_, [&](auto k) {
      if constexpr (k() == 0)
        return false;
      else
        return side_filtered<k()>(d, weighted(), c, p, sign);
    });
    if (!decided) {
      ++exact_;
      sign = determinant_sign(LiftedRows(k_, d, weighted(), c, p));
    }
    return t_.furthest_site ? -sign : sign;
  }

  /// Whether lifts lowered by infinitesimals e_0 >> e_1 >> ..., by id, put q below the hyperplane
  /// of c.
  bool below_when_lowered(std::uint64_t c, std::uint32_t q) const {
    std::vector<std::uint32_t> ids(t_.cell(c).begin(), t_.cell(c).end());
    ids.push_back(q);
    std::sort(ids.begin(), ids.end());
    for (const std::uint32_t id : ids) {
      if (id == q) return true;
      std::vector<const double*> at;
      for (const std::uint32_t v : t_.cell(c)) at.push_back(row(v == id ? q : v));
      const Sign sign = oriented(at.data());
      if (sign != Sign::zero) return sign == Sign::negative;
    }
    return true;
  }

  std::uint64_t check_ridges() {
    std::atomic<std::uint64_t> count{0};
    DisjointSets sets(size());
    sets.clear(0, size());
    check_each(size(), [&](std::uint64_t c) {
      std::vector<const double*> at;
      for (const std::uint32_t v : t_.cell(c)) at.push_back(row(v));
      for (unsigned j = 0; j < corners(); ++j) {
        const std::uint32_t o = t_.neighbours_of(c)[j];
        if (o == no_index || o < c) continue;
        const auto back = t_.neighbours_of(o);
        const std::uint32_t q = t_.cell(
            o)[static_cast<std::size_t>(std::find(back.begin(), back.end(), c) - back.begin())];
        ++count;
        const Sign s = side(at.data(), row(q));
        if (s == Sign::zero) sets.join(static_cast<std::uint32_t>(c), o);
        if (s == Sign::negative) fault("cells ", c, " and ", o, " are not locally Delaunay");
        if (s == Sign::zero && below_when_lowered(c, q))
          fault("cells ", c, " and ", o, " of one sphere are not pulled from the lowest id");
      }
    });
    std::uint32_t next = 0;
    std::vector<std::uint32_t> number(size());
    for (std::uint32_t c = 0; c < size(); ++c) {
      const std::uint32_t root = sets.root(c);
      number[c] = root == c ? next++ : number[root];
    }
    if ((next == size()) != t_.cell_groups.empty())
      fault("there are ", next, " spheres of ", size(), " cells");
    for (std::uint32_t c = 0; c < size() && next < size(); ++c)
      if (number[c] != t_.cell_groups[c])
        fault("the group of cell ", c, " is not ", t_.cell_groups[c]);
    return count;
  }

  /// With weights: checks that every vertex is a corner of its merged cells, so that its lifted
  /// point is an extreme point of the lower hull. It is a corner of one of its groups if and only
  /// if it is a corner of all.
  void check_extreme() const {
    if (t_.cell_groups.empty()) return;
    std::vector<std::uint32_t> size(t_.size());
    for (const std::uint32_t g : t_.cell_groups) ++size[g];
    // A vertex of a group with one cell is a corner of it.
    std::vector<bool> proved(t_.point_count);
    for (std::uint64_t c = 0; c < t_.size(); ++c)
      if (size[t_.cell_groups[c]] == 1)
        for (const std::uint32_t v : t_.cell(c)) proved[v] = true;
    std::map<std::uint32_t, std::vector<std::uint32_t>> cells;  // of each vertex's first group
    for (std::uint32_t c = 0; c < t_.size(); ++c)
      for (const std::uint32_t v : t_.cell(c)) {
        if (proved[v]) continue;
        auto& list = cells[v];
        if (list.empty() || t_.cell_groups[list[0]] == t_.cell_groups[c]) list.push_back(c);
      }
    for (const auto& [v, list] : cells) {
      run_.check();
      if (!is_corner(v, list))
        fault("point ", v, " is a vertex, but no extreme point of the lower hull");
    }
  }

  /// The merged cells of a group are a convex polytope in the flat. A vertex is a corner of it if
  /// and only if the normals of the polytope's facets at the vertex have full rank. `cells`: those
  /// of a group around v. In rational arithmetic.
  bool is_corner(std::uint32_t v, const std::vector<std::uint32_t>& cells) const {
    RationalRows normals;
    std::vector<const double*> facet;
    ExactPlane plane;
    for (const std::uint32_t c : cells)
      for (unsigned j = 0; j <= k_; ++j) {
        const std::uint32_t o = t_.neighbours_of(c)[j];
        if (t_.cell(c)[j] == v || (o != no_index && t_.group(o) == t_.group(c))) continue;
        std::vector<mpq_class>& normal = normals.emplace_back(k_, mpq_class(1));
        if (k_ == 1) continue;
        facet.clear();
        for (unsigned i = 0; i <= k_; ++i)
          if (i != j) facet.push_back(row(t_.cell(c)[i]));
        plane.set(k_, facet.data());
        for (unsigned a = 0; a < k_; ++a) {
          const ExactPlane::ScaledInteger n = plane.cofactor(a);
          normal[a] = mpz_class(n.value);
          if (n.exponent >= 0)
            normal[a] <<= static_cast<mp_bitcnt_t>(n.exponent);
          else
            normal[a] >>= static_cast<mp_bitcnt_t>(-n.exponent);
        }
      }
    return eliminate(normals, k_);
  }

  /// Checks that lifted hidden points are on or above the lower hull.
  void check_hidden() {
    std::uint64_t c = 0;
    std::vector<const double*> at(corners());
    for (const std::uint32_t id : t_.hidden) {
      c = locate(id, c);
      for (unsigned i = 0; i < corners(); ++i) at[i] = row(t_.cell(c)[i]);
      if (side(at.data(), row(id)) == Sign::negative)
        fault("point ", id, " is hidden, but below cell ", c);
    }
  }

  /// 0: p is in the cell; else 1 + the index of a corner whose opposite facet separates p from the
  /// cell.
  unsigned beyond(std::uint64_t c, const double* p) const {
    std::vector<const double*> at(corners());
    for (unsigned j = 0; j < corners(); ++j) {
      for (unsigned i = 0; i < corners(); ++i) at[i] = i == j ? p : row(t_.cell(c)[i]);
      if (oriented(at.data()) == Sign::negative) return j + 1;
    }
    return 0;
  }

  std::uint64_t locate(std::uint32_t id, std::uint64_t c) const {
    const double* p = row(id);
    for (std::uint64_t step = 0; step <= 4 * size(); ++step) {
      if (step % 1024 == 0) run_.check();
      const unsigned j = beyond(c, p);
      if (j == 0) return c;
      c = t_.neighbours_of(c)[j - 1];
      if (c == no_index) fault("hidden point ", id, " is outside the hull");
    }
    fault("no cell has hidden point ", id);
  }

  /// Calls body(i) on all threads; of several faults, throws the one of the first chunk.
  template <class Body>
  void check_each(std::uint64_t count, const Body& body) const {
    check_chunks(run_, count, 4096, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) body(i);
    });
  }

  const PointView& points_;
  std::span<const double> weights_;
  const Triangulation& t_;
  const Run& run_;
  unsigned k_ = 0, stride_ = 0;
  Array<double> rows_;
  mutable std::atomic<std::uint64_t> exact_{0};
};

Certificate certify_triangulation(const PointView& points, std::span<const double> weights,
                                  const Triangulation& t, const TriangulationOptions& o) {
  require_points(points);
  const Call call(o);
  const Run& run = call.run;
  Certificate out;
  TriangulationSubject subject(points, weights, t, run);
  try {
    subject.check(out);
    out.valid = true;
  } catch (const Fault& f) {
    out.reason = f.reason;
  }
  out.exact_decisions = subject.exact_decisions();
  return out;
}

}  // namespace
}  // namespace cullhull::internal::certify

namespace cullhull {

Certificate certify(const PointView& points, const Triangulation& triangulation,
                    const TriangulationOptions& options) {
  return internal::certify::certify_triangulation(points, {}, triangulation, options);
}

Certificate certify(const PointView& points, std::span<const double> weights,
                    const Triangulation& triangulation, const TriangulationOptions& options) {
  internal::require_weights(weights, points.count);
  return internal::certify::certify_triangulation(points, weights, triangulation, options);
}

}  // namespace cullhull
