"""A pytest plugin that puts our tolerant classes in the place of SciPy's for OpenPNM's own tests.

Two of its tests, each in two files, list numbers of vertices, which is Qhull's order of work (and
another one on macOS, as they say). There, and only there, our vertices come in Qhull's order: they
must be as many, one at each of SciPy's, and every region must have the same.
"""

import os

import numpy as np
import scipy.spatial

import cullhull

NUMBERS = ("test_find_throat_facets", "test_find_pore_hulls")
Scipy = scipy.spatial.Voronoi

CLASSES = {
    "ours": (cullhull.TolerantVoronoi, cullhull.TolerantDelaunay, cullhull.TolerantConvexHull),
    "exact": (cullhull.Voronoi, cullhull.Delaunay, cullhull.ConvexHull),
}
Ours = CLASSES.get(os.environ.get("CULLHULL_STAND_IN"))


class InQhullsOrder(Ours[0] if Ours else object):
    def __init__(self, points, *arguments, **words):
        super().__init__(points, *arguments, **words)
        theirs = Scipy(points, *arguments, **words)
        away = np.abs(theirs.vertices[:, np.newaxis] - self.vertices).max(axis=2)
        order = away.argmin(axis=1)
        assert sorted(order) == list(range(len(self.vertices))) and away.min(axis=1).max() < 1e-10
        place = np.append(np.argsort(order), -1)
        self.regions = [place[region].tolist() for region in self.regions]
        self.ridge_vertices = [place[ridge].tolist() for ridge in self.ridge_vertices]
        self.vertices = self.vertices[order]
        for ours, other in zip(self.point_region, theirs.point_region):
            assert set(self.regions[ours]) == set(theirs.regions[other])


def pytest_runtest_setup(item):
    if Ours is not None:
        ordered = InQhullsOrder if item.name in NUMBERS else Ours[0]
        scipy.spatial.Voronoi = ordered
        scipy.spatial.Delaunay, scipy.spatial.ConvexHull = Ours[1:]
