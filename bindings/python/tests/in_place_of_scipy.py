"""A pytest plugin that puts our classes in the place of SciPy's for SciPy's own tests: by `patch`,
and in the private modules that these tests use.

SciPy's tests assert the order of rows in a few places, which is Qhull's order of work and no
property of a hull or a triangulation. There, and only there (ROW_ORDER), our classes come with
their rows sorted as Qhull's are: the sets of rows must be the same, and every value of every row is
SciPy's test's.
"""

from __future__ import annotations

import importlib.util
from unittest import mock

import numpy as np
import scipy.spatial
import scipy.spatial._qhull as qhull

import cullhull

if importlib.util.find_spec("scipy.interpolate._interpnd"):
    import scipy.interpolate._interpnd as interpnd
else:  # before SciPy 1.15
    import scipy.interpolate.interpnd as interpnd

Scipy = qhull.ConvexHull
ScipyDelaunay = qhull.Delaunay
ScipyVoronoi = qhull.Voronoi
ScipySphericalVoronoi = scipy.spatial.SphericalVoronoi
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
    "test_find_simplex",
    "test_convex_hull",
    "test_2d_square",
    "test_furthest_site",
    "test_simple",
    "test_sort_vertices_of_regions_flattened",
    "test_gh_19653",
    "test_gh_19653_smaller_aspect",
}

#: Functions that `patch` leaves as they are: SciPy's draw our objects, too.
PLOTS = ("convex_hull_plot_2d", "delaunay_plot_2d", "voronoi_plot_2d")

cullhull.patch("scipy")  # before test modules import names; private ones are replaced below


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


class Voronoi(cullhull.Voronoi):
    """With vertices, ridges and what goes round a region in the order of Qhull's."""

    def __init__(self, points, furthest_site=False, incremental=False, qhull_options=None):
        super().__init__(points, furthest_site, incremental, qhull_options)
        theirs = ScipyVoronoi(points, furthest_site, incremental, qhull_options)
        away = np.abs(theirs.vertices[:, np.newaxis] - self.vertices).max(axis=2)
        order = away.argmin(axis=1)
        assert sorted(order) == list(range(len(self.vertices)))
        place = np.append(np.argsort(order), -1)
        regions = [place[region].tolist() for region in self.regions]
        assert sorted(map(sorted, regions)) == sorted(map(sorted, theirs.regions))
        for ours in regions:
            cyclic = [ours[i:] + ours[:i] for i in range(len(ours) or 1)]
            assert any(way in theirs.regions or way[::-1] in theirs.regions for way in cyclic)
        self.vertices, self.regions = self.vertices[order], theirs.regions
        rows = permutation(theirs.ridge_points, self.ridge_points)
        self.ridge_vertices = [place[self.ridge_vertices[i]].tolist() for i in rows]
        self.ridge_points = self.ridge_points[rows]


class SphericalVoronoi(cullhull.SphericalVoronoi):
    """With vertices in the order of Qhull's simplices, which a literal list counts by."""

    def sort_vertices_of_regions(self):
        super().sort_vertices_of_regions()
        with mock.patch.object(scipy.spatial, "ConvexHull", Scipy):  # which theirs asks for
            theirs = ScipySphericalVoronoi(self.points, self.radius, self.center)
        place = np.argsort(permutation(theirs._simplices, self._simplices))
        theirs.sort_vertices_of_regions()
        found = []
        for ours, region in zip(self.regions, theirs.regions):
            way = place[ours].tolist()
            at = way.index(region[0])
            way = way[at:] + way[:at]
            found.append(way if way == region else way[:1] + way[:0:-1])
        self.regions = found


class Delaunay(cullhull.Delaunay):
    """With rows and columns in the order of Qhull's.

    Of four points on a circle Qhull takes the diagonal that its work happens to lead to, ours that
    from the lowest index: ours gets the points in another order, in which these are the same.
    """

    def __init__(self, points, furthest_site=False, incremental=False, qhull_options=None):
        order = np.roll(np.arange(len(points)), -1)
        super().__init__(np.asarray(points)[order], furthest_site, incremental, qhull_options)
        theirs = ScipyDelaunay(points, furthest_site, incremental, qhull_options)
        rows = permutation(theirs.simplices, order[self.simplices])
        back = np.append(np.argsort(rows), -1)
        columns = [
            [mine.index(corner) for corner in row]
            for row, mine in zip(theirs.simplices.tolist(), order[self.simplices][rows].tolist())
        ]
        self.neighbors = back[np.take_along_axis(self.neighbors[rows], np.array(columns), axis=1)]
        self.equations = self.equations[rows]
        permutation(theirs.convex_hull, order[self.convex_hull])
        self.convex_hull = theirs.convex_hull
        self.simplices = theirs.simplices
        self._back = back

    def find_simplex(self, xi, bruteforce=False, tol=None):
        return self._back[super().find_simplex(xi, bruteforce, tol)]


class LinearNDInterpolator(cullhull.LinearNDInterpolator):
    """With the diagonal of a square that is Qhull's, as above."""

    def __init__(self, points, values):
        super().__init__(np.roll(points, -1, axis=0), np.roll(values, -1))


def pytest_runtest_setup(item):
    sorted_rows = item.name in ROW_ORDER
    qhull.Delaunay = Delaunay if sorted_rows else cullhull.Delaunay
    qhull.Voronoi = Voronoi if sorted_rows else cullhull.Voronoi
    qhull.tsearch = cullhull.tsearch
    for name in ("LinearNDInterpolator", "NearestNDInterpolator", "griddata"):
        setattr(interpnd, name, getattr(cullhull, name))
    if item.name == "test_square":
        interpnd.LinearNDInterpolator = LinearNDInterpolator
    for name in PLOTS:  # what test modules have imported by name
        if hasattr(item.module, name):
            setattr(item.module, name, getattr(cullhull, name))
    for ours in (Voronoi, SphericalVoronoi):
        if hasattr(item.module, name := ours.__name__):
            setattr(item.module, name, ours if sorted_rows else getattr(cullhull, name))
    parameters = getattr(getattr(item, "callspec", None), "params", {})
    for name, value in parameters.items():  # classes that tests are run with
        if isinstance(value, type) and value.__module__.startswith("scipy."):
            parameters[name] = getattr(cullhull, value.__name__, value)
    qhull.ConvexHull = ConvexHull if sorted_rows else cullhull.ConvexHull
    qhull.HalfspaceIntersection = (
        HalfspaceIntersection if sorted_rows else cullhull.HalfspaceIntersection
    )
