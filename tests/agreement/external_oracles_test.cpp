// Against other programs: lrs for facet counts and vertices, rbox for point families.
#include "all_paths.hpp"
#include "point_sets.hpp"

namespace cullhull::testing_support::external_oracles_test {

#if defined(CULLHULL_LRS)

TEST(Lrs, FacetCountsOfDegenerateSets) {
  std::vector<PointSet> sets;
  for (unsigned d = 2; d <= 5; ++d) {
    sets.push_back(random_grid(80, d, 3, 0, d));
    sets.push_back(random_grid(60, d, 8, 0x1p40, d + 10));
    sets.push_back(cyclic(12, d));
    sets.push_back(cross_polytope_with_middles(d));
    sets.push_back(cospherical(d, d < 4 ? 9 : 5));
  }
  sets.push_back(cylinder(60, 9));
  sets.push_back(cone(60, 9));
  for (const PointSet& s : sets) {
    const Hull h = expect_everywhere(s, lrs_extreme_points(CULLHULL_LRS, s));
    EXPECT_EQ(h.facet_count(), lrs_facet_count(CULLHULL_LRS, s)) << s.name;
  }
}

#endif

#if defined(CULLHULL_RBOX)

class Rbox : public ::testing::TestWithParam<const char*> {};

TEST_P(Rbox, VerticesAreExact) { expect_exact(rbox(CULLHULL_RBOX, GetParam())); }

// The families of Qhull's manual (rbox.htm and the examples of qh-eg.htm), at sizes exact linear
// programs can check.
INSTANTIATE_TEST_SUITE_P(Cubes, Rbox,
                         ::testing::Values("c", "c D2", "c D4", "c D5", "c G2", "10 c G1 t1",
                                           "c P0 P0 P0", "c O3", "c P0.1,0.2,0.3 D3", "c B3", "c d",
                                           "c d D4", "c d G3 D3", "50 c D4 t2", "c D3 W0.1 30 t3",
                                           "c G1e9 10 t4", "c D2 P0.5,0.5 P0.5,0.5 P0,0.5"));
INSTANTIATE_TEST_SUITE_P(Diamonds, Rbox,
                         ::testing::Values("d", "d D2", "d D4", "d D5", "d G3 O1", "40 d t5",
                                           "d D3 P0.25,0.25,0 P0,0,0"));
INSTANTIATE_TEST_SUITE_P(Spheres, Rbox,
                         ::testing::Values("100 s t1", "100 s D2 t2", "60 s D4 t3", "40 s D5 t4",
                                           "100 s W0.1 t5", "100 s Z0.5 t6", "100 s Z0.5 G0.6 t7",
                                           "80 s W1e-3 t8", "80 s O2 t9", "60 s B0.25 D3 t10"));
INSTANTIATE_TEST_SUITE_P(Simplices, Rbox,
                         ::testing::Values("60 x t1", "60 y t2", "40 x D4 t3", "40 y D4 W0.1 t4",
                                           "30 y D2 t5", "60 x W1e-13 t6", "60 y W1e-13 t7",
                                           "60 x r t8", "40 y r D3 W0.2 t9"));
INSTANTIATE_TEST_SUITE_P(Polygons, Rbox,
                         ::testing::Values("30 r D2", "30 r s D3 t1", "60 r s Z1 G0.1 t2",
                                           "60 r s Z1 t3", "40 r W0.1 D2 t4", "30 r s D3 Z0.3 t5",
                                           "30 r s Z1 G1e-6 t6"));
INSTANTIATE_TEST_SUITE_P(Spirals, Rbox,
                         ::testing::Values("50 l", "100 l", "50 l G0.9 O0.1", "40 l B2"));
INSTANTIATE_TEST_SUITE_P(Lenses, Rbox,
                         ::testing::Values("100 L100000 s G1e-6 t1", "100 L5 t2", "100 L3 s t3",
                                           "60 L2 D4 s t4", "60 L3 D2 r t5",
                                           "100 L100000 s G0.1 t6", "100 L3 s W0.1 t7"));
INSTANTIATE_TEST_SUITE_P(Lattices, Rbox,
                         ::testing::Values("27 M1,0,1", "64 M1,0", "64 M3,4", "27 M3,4 z",
                                           "64 M3,4,5", "64 M1,0 D2", "81 M1,0 D4", "64 M2,3 D4",
                                           "100 M3,4 D2", "64 M3,4,5 O0.1", "64 M1,0,0.3"));
INSTANTIATE_TEST_SUITE_P(Random, Rbox,
                         ::testing::Values("10 t1", "100 t2", "100 D2 t3", "60 D4 t4", "40 D5 t5",
                                           "100 W0.1 t6", "100 W1e-12 D2 t7", "60 W0 t8",
                                           "100 z t9", "100 D2 z B5 t10", "60 D4 z B2 t11",
                                           "100 z B2 t12", "100 D3 B1e-9 t13", "100 D3 O1e9 t14"));
INSTANTIATE_TEST_SUITE_P(NearlyAdjacent, Rbox,
                         ::testing::Values("10 C3,1e-14,4 t1", "20 C5,1e-15,3 D2 t2",
                                           "15 D4 C2,1e-13 t3", "20 s C3,2e-16,5 t4",
                                           "30 l C1,1e-13 t5", "20 D3 C1,0,10 t6"));
INSTANTIATE_TEST_SUITE_P(Points, Rbox,
                         ::testing::Values("P0 P0 P0", "P1,1 P2,2 P3,3 D2", "P1 P1,1 P1,1,1 P0 D3",
                                           "5 P0,0,0 P1e-17,0,0 P0,1e-17,0 t1",
                                           "c P0.5,0.5,0.5 P0.5,0.5,0.6"));

#endif

}  // namespace cullhull::testing_support::external_oracles_test
