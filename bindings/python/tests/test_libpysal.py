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
MODULES = ("cg/tests/test_ashapes.py", "cg/tests/test_voronoi.py", "weights/tests/test_gabriel.py")
#: Literal lists in the order of Qhull's triangles. What they assert is asserted below.
ORDERED = (
    "cg/tests/test_ashapes.py::TestAlphaShapes::test_circles",
    "cg/tests/test_voronoi.py::TestVoronoi::test_voronoi",
)


def test_libpysals_own_tests():
    """Its wheel has tests of alpha shapes, Voronoi cells, Gabriel and Delaunay graphs."""
    arguments = ["-pstand_in", *(f"libpysal/{module}" for module in MODULES)]
    arguments += [word for test in ORDERED for word in ("--deselect", f"libpysal/{test}")]
    passed, failed = passed_and_failed(FOLDER.parent, "libpysal_tests", arguments)
    assert not failed and passed >= 20


def test_bounding_circles_and_regions(monkeypatch):
    from libpysal.cg import alpha_shapes, voronoi

    monkeypatch.setattr("scipy.spatial.Delaunay", cullhull.Delaunay)
    lines = pyogrio.raw.read(FOLDER / "examples" / "networks" / "eberly_net.shp", columns=[])[2]
    corners = shapely.get_coordinates(shapely.from_wkb(lines))
    _, radius, centres = alpha_shapes.alpha_shape_auto(corners, return_circles=True)
    expected = FOLDER / "cg" / "tests" / "data" / "eberly_bounding_circles.gpkg"
    _, _, circles, (radii,) = pyogrio.raw.read(expected, columns=["radius"])
    wanted = shapely.get_coordinates(shapely.from_wkb(circles))
    assert np.isclose(radius, radii[0])
    assert np.allclose(sorted(map(tuple, centres)), sorted(map(tuple, wanted.tolist())))

    def regions():
        with pytest.warns(FutureWarning):
            found, vertices = voronoi.voronoi([(10.2, 5.1), (4.7, 2.2), (5.3, 5.7), (2.7, 5.3)])
        return [{tuple(np.round(vertices[v], 9)) for v in region} for region in found]

    theirs = regions()
    monkeypatch.setattr(voronoi, "Voronoi", cullhull.Voronoi)
    assert regions() == theirs and list(map(len, theirs)) == [3, 4, 4, 3]


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
