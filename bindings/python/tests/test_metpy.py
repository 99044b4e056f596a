"""MetPy with our classes in place of SciPy's."""

import os

import numpy as np
import pytest
from foreign_suites import passed_and_failed

import cullhull

geometry = pytest.importorskip("metpy.interpolate.geometry")

#: Lists the triangles of a lattice of squares, corner by corner: which diagonal cuts a square is
#: Qhull's order of work. All else that it asserts is asserted below.
DIAGONALS = "tests/interpolate/test_geometry.py::test_find_natural_neighbors"


def test_metpys_own_tests():
    """Those of its interpolation, which is over triangulations and hulls, from MetPy's source
    archive. Many compare with files that the archive leaves out and that are fetched when asked
    for: where these are out of reach they fail with SciPy's classes, too."""
    tests = os.environ.get("CULLHULL_METPY_TESTS", "")
    if not tests:
        pytest.skip("CULLHULL_METPY_TESTS does not name MetPy's tests folder")
    arguments = ["-pstand_in", "tests/interpolate", "--deselect", DIAGONALS]
    passed, failed = passed_and_failed(os.path.dirname(tests), "metpy_tests", arguments)
    assert not failed and passed >= 50


def test_natural_neighbours_of_a_lattice():
    axis = np.arange(0, 20, 4)
    points = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    found = cullhull.TolerantDelaunay(points)
    asked = np.array([[2, 2], [5, 10], [12, 13.4], [12, 8], [20, 20]])
    neighbours, centres = geometry.find_natural_neighbors(found, asked)
    corners = [{0, 1, 5, 6}, {11, 12, 16, 17}, {17, 18, 19, 22, 23, 24}]
    corners += [{7, 8, 9, 12, 13, 14, 17, 18, 19}, set()]
    middles = [{(2, 2)}, {(6, 10)}, {(14, 14), (10, 14)}]
    middles += [{(10, 6), (14, 6), (14, 10), (10, 10)}, set()]
    for i, (points_there, spheres) in enumerate(zip(corners, middles)):
        assert set(found.simplices[neighbours[i]].ravel().tolist()) == points_there
        assert {tuple(c) for c in centres[neighbours[i]].tolist()} == spheres
        assert len(neighbours[i]) == 2 * len(spheres)
