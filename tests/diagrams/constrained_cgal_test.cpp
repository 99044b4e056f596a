// Constrained triangulations against CGAL's, on points of which no four are on a circle.
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <gtest/gtest.h>

#include <set>

#include "cullhull/constrained.hpp"
#include "cullhull/proximity_graphs.hpp"
#include "diagrams/slow_cells.hpp"

namespace cullhull {
namespace constrained_cgal_test {

using namespace testing_support;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using Faces = CGAL::Constrained_triangulation_face_base_2<Kernel>;
using Structure = CGAL::Triangulation_data_structure_2<Vertices, Faces>;
using Theirs = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                                          CGAL::No_constraint_intersection_tag>;

std::set<std::set<std::uint32_t>> their_cells(const LiftedSet& s,
                                              const std::vector<std::uint32_t>& edges) {
  Theirs t;
  std::vector<Theirs::Vertex_handle> at;
  for (std::uint32_t i = 0; i < s.count(); ++i) {
    at.push_back(t.insert(Kernel::Point_2(s.rows[2 * i], s.rows[2 * i + 1])));
    at.back()->info() = i;
  }
  for (std::size_t i = 0; i < edges.size(); i += 2)
    t.insert_constraint(at[edges[i]], at[edges[i + 1]]);
  std::set<std::set<std::uint32_t>> cells;
  for (auto f = t.finite_faces_begin(); f != t.finite_faces_end(); ++f)
    cells.insert({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
  return cells;
}

/// Edges of random trees never cross: those of the spanning tree of every other point.
std::vector<std::uint32_t> edges_of_some(const LiftedSet& s, unsigned step) {
  std::vector<double> rows;
  for (std::size_t i = 0; i < s.count(); i += step)
    rows.insert(rows.end(), {s.rows[2 * i], s.rows[2 * i + 1]});
  const PointView some = PointView::row_major(rows.data(), rows.size() / 2, 2);
  std::vector<std::uint32_t> edges;
  for (const std::uint32_t v : minimum_spanning_tree(some, delaunay(some)))
    edges.push_back(v * step);
  return edges;
}

TEST(ConstrainedCgal, SameCells) {
  for (const unsigned n : {20U, 300U, 20000U})
    for (const unsigned step : {2U, 5U, 9U}) {
      const LiftedSet s = random_points(2, n, n + step);
      const std::vector<std::uint32_t> edges = edges_of_some(s, step);
      const ConstrainedTriangulation ours = constrained_delaunay(view_of(s), edges);
      EXPECT_TRUE(certify(view_of(s), edges, ours).valid);
      std::set<std::set<std::uint32_t>> cells;
      for (std::uint64_t c = 0; c < ours.triangulation.size(); ++c)
        cells.insert({ours.triangulation.cell(c).begin(), ours.triangulation.cell(c).end()});
      EXPECT_TRUE(cells == their_cells(s, edges)) << n << " " << step;
    }
}

}  // namespace constrained_cgal_test
}  // namespace cullhull
