// Against CGAL's triangulations in the plane and in space: same merged cells, hull by hull.
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Regular_triangulation_2.h>
#include <CGAL/Regular_triangulation_3.h>
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <vector>

#include "cullhull/triangulation.hpp"
#include "delaunay/lifted_sets.hpp"

namespace cullhull {
namespace delaunay_cgal_test {

using namespace testing_support;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Row = std::vector<double>;
using Cells = std::set<std::set<Row>>;

/// Merges cells over facets on whose both sides one sphere is, as CGAL's own test tells.
class Merged {
 public:
  explicit Merged(std::size_t cells) : root_(cells) {
    for (std::size_t i = 0; i < cells; ++i) root_[i] = i;
  }
  std::size_t root(std::size_t i) {
    while (root_[i] != i) i = root_[i] = root_[root_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { root_[root(a)] = root(b); }

 private:
  std::vector<std::size_t> root_;
};

template <class Add>
Cells collect(std::size_t count, Merged& merged, const Add& add) {
  std::map<std::size_t, std::set<Row>> groups;
  for (std::size_t i = 0; i < count; ++i) add(i, groups[merged.root(i)]);
  Cells cells;
  for (const auto& [root, rows] : groups) cells.insert(rows);
  return cells;
}

Row row_of(const Kernel::Point_2& p) { return {p.x(), p.y()}; }
Row row_of(const Kernel::Point_3& p) { return {p.x(), p.y(), p.z()}; }
Row row_of(const Kernel::Weighted_point_2& p) { return row_of(p.point()); }
Row row_of(const Kernel::Weighted_point_3& p) { return row_of(p.point()); }

/// A finite triangulation of CGAL's in the plane (dimension 2) or in space; `tie(cell, q)`: q is on
/// the cell's sphere.
template <class T, class Handle, class Tie>
Cells merged_cells(const std::vector<Handle>& handles, const T& t, unsigned corners,
                   const Tie& tie) {
  std::map<Handle, std::size_t> number;
  for (const Handle& c : handles) number[c] = number.size();
  Merged merged(handles.size());
  for (const Handle& c : handles)
    for (unsigned j = 0; j < corners; ++j) {
      const Handle o = c->neighbor(static_cast<int>(j));
      if (t.is_infinite(o) || !tie(c, o->vertex(o->index(c))->point())) continue;
      merged.join(number[c], number[o]);
    }
  return collect(handles.size(), merged, [&](std::size_t i, std::set<Row>& rows) {
    for (unsigned j = 0; j < corners; ++j)
      rows.insert(row_of(handles[i]->vertex(static_cast<int>(j))->point()));
  });
}

Cells cgal_plane(const LiftedSet& s) {
  if (s.weights.empty()) {
    std::vector<Kernel::Point_2> points;
    for (std::uint64_t i = 0; i < s.count(); ++i)
      points.emplace_back(s.rows[2 * i], s.rows[2 * i + 1]);
    const CGAL::Delaunay_triangulation_2<Kernel> t(points.begin(), points.end());
    std::vector<CGAL::Delaunay_triangulation_2<Kernel>::Face_handle> faces;
    for (const auto f : t.finite_face_handles()) faces.push_back(f);
    return merged_cells(faces, t, 3, [](auto c, const Kernel::Point_2& q) {
      return CGAL::side_of_oriented_circle(c->vertex(0)->point(), c->vertex(1)->point(),
                                           c->vertex(2)->point(), q) == CGAL::ZERO;
    });
  }
  std::vector<Kernel::Weighted_point_2> points;
  for (std::uint64_t i = 0; i < s.count(); ++i)
    points.emplace_back(Kernel::Point_2(s.rows[2 * i], s.rows[2 * i + 1]), s.weights[i]);
  const CGAL::Regular_triangulation_2<Kernel> t(points.begin(), points.end());
  std::vector<CGAL::Regular_triangulation_2<Kernel>::Face_handle> faces;
  for (const auto f : t.finite_face_handles()) faces.push_back(f);
  return merged_cells(faces, t, 3, [](auto c, const Kernel::Weighted_point_2& q) {
    return Kernel().power_side_of_oriented_power_circle_2_object()(
               c->vertex(0)->point(), c->vertex(1)->point(), c->vertex(2)->point(), q) ==
           CGAL::ON_ORIENTED_BOUNDARY;
  });
}

Cells cgal_space(const LiftedSet& s) {
  if (s.weights.empty()) {
    std::vector<Kernel::Point_3> points;
    for (std::uint64_t i = 0; i < s.count(); ++i)
      points.emplace_back(s.rows[3 * i], s.rows[3 * i + 1], s.rows[3 * i + 2]);
    const CGAL::Delaunay_triangulation_3<Kernel> t(points.begin(), points.end());
    std::vector<CGAL::Delaunay_triangulation_3<Kernel>::Cell_handle> cells;
    for (const auto c : t.finite_cell_handles()) cells.push_back(c);
    return merged_cells(cells, t, 4, [](auto c, const Kernel::Point_3& q) {
      return CGAL::side_of_oriented_sphere(c->vertex(0)->point(), c->vertex(1)->point(),
                                           c->vertex(2)->point(), c->vertex(3)->point(),
                                           q) == CGAL::ZERO;
    });
  }
  std::vector<Kernel::Weighted_point_3> points;
  for (std::uint64_t i = 0; i < s.count(); ++i)
    points.emplace_back(Kernel::Point_3(s.rows[3 * i], s.rows[3 * i + 1], s.rows[3 * i + 2]),
                        s.weights[i]);
  const CGAL::Regular_triangulation_3<Kernel> t(points.begin(), points.end());
  std::vector<CGAL::Regular_triangulation_3<Kernel>::Cell_handle> cells;
  for (const auto c : t.finite_cell_handles()) cells.push_back(c);
  return merged_cells(cells, t, 4, [](auto c, const Kernel::Weighted_point_3& q) {
    return Kernel().power_side_of_oriented_power_sphere_3_object()(
               c->vertex(0)->point(), c->vertex(1)->point(), c->vertex(2)->point(),
               c->vertex(3)->point(), q) == CGAL::ON_ORIENTED_BOUNDARY;
  });
}

Cells our_cells(const LiftedSet& s) {
  const PointView points = PointView::row_major(s.rows.data(), s.count(), s.dimension);
  const Triangulation t =
      s.weights.empty() ? delaunay(points) : regular_triangulation(points, s.weights);
  EXPECT_EQ(t.affine_dimension, static_cast<int>(s.dimension)) << s.name;
  std::map<std::uint32_t, std::set<Row>> groups;
  for (std::uint64_t c = 0; c < t.size(); ++c)
    for (const std::uint32_t v : t.cell(c))
      groups[t.group(c)].insert(
          Row(s.rows.begin() + v * s.dimension, s.rows.begin() + (v + 1) * s.dimension));
  Cells cells;
  for (const auto& [number, rows] : groups) cells.insert(rows);
  return cells;
}

/// Sets without points that lie exactly on a face of the lower hull: those CGAL keeps or hides as
/// they come.
bool comparable(const LiftedSet& s) {
  return s.name.find("flat") != 0 && (s.weights.empty() || s.name.find("grid") != 0);
}

TEST(DelaunayCgal, PlaneHasTheSameCells) {
  for (const LiftedSet& s : large_lifted_sets(2, 4000))
    if (comparable(s)) {
      EXPECT_TRUE(our_cells(s) == cgal_plane(s)) << s.name;
    }
}

TEST(DelaunayCgal, SpaceHasTheSameCells) {
  for (const LiftedSet& s : large_lifted_sets(3, 2000))
    if (comparable(s)) {
      EXPECT_TRUE(our_cells(s) == cgal_space(s)) << s.name;
    }
}

}  // namespace delaunay_cgal_test
}  // namespace cullhull
