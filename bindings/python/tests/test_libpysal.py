"""libpysal with our classes in place of SciPy's, and its example data through our readers."""

from pathlib import Path

import numpy as np
import pytest
from foreign_suites import passed_and_failed

import cullhull

libpysal = pytest.importorskip("libpysal")
pyogrio = pytest.importorskip("pyogrio")
shapely = pytest.importorskip("shapely")

FOLDER = Path(libpysal.__file__).parent
SHAPES = sorted(FOLDER.glob("examples/*/*.shp"))

#: Test modules over triangulations and diagrams.
MODULES = ("cg.tests.test_ashapes", "cg.tests.test_voronoi", "weights.tests.test_gabriel",
           "graph.tests.test_triangulation")  # fmt: skip


def test_libpysals_own_tests():
    """Of alpha shapes, Voronoi cells, Gabriel and Delaunay graphs; its wheel has them."""
    arguments = ["-pstand_in", "--pyargs", *(f"libpysal.{module}" for module in MODULES)]
    passed, failed = passed_and_failed(FOLDER.parent, "libpysal_tests", arguments)
    assert not failed and passed >= 50


def test_there_are_example_files():
    assert len(SHAPES) >= 20


@pytest.mark.parametrize("path", SHAPES, ids=lambda path: path.stem)
def test_example_files(path):
    """Maps of counties, streets and houses: the hull is GEOS's, and everything is certified."""
    points = cullhull.read(path)
    geometries = shapely.from_wkb(pyogrio.raw.read(path, columns=[])[2])
    everything = shapely.get_coordinates(geometries)
    assert {tuple(p) for p in points.tolist()} == {tuple(p) for p in everything.tolist()}
    hull = cullhull.convex_hull(points, certify=True)
    theirs = shapely.get_coordinates(shapely.MultiPoint(everything).convex_hull)
    assert {tuple(p) for p in hull.vertex_points.tolist()} == {tuple(p) for p in theirs.tolist()}
    found = cullhull.delaunay(points, certify=True)
    assert np.isclose(found.to_shapely().area, hull.volume)
    box = points.min(axis=0) - 1, points.max(axis=0) + 1
    assert np.isclose(cullhull.voronoi(found).clip(*box).measures.sum(), np.prod(box[1] - box[0]))
