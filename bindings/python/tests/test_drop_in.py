"""ConvexHull and HalfspaceIntersection against SciPy's, attribute by attribute."""

import pickle
import re
import sys

import numpy as np
import pytest

import cullhull

spatial = pytest.importorskip("scipy.spatial")

GRID = np.array([[x, y, z] for x in range(3) for y in range(3) for z in range(3)], dtype=float)


def rows_by_corners(simplices):
    return {frozenset(row): i for i, row in enumerate(simplices.tolist())}


def assert_same_hull(ours, theirs):
    """The same simplices in any order, which is returned, and all that belongs to each."""
    mine, other = rows_by_corners(ours.simplices), rows_by_corners(theirs.simplices)
    assert set(mine) == set(other)
    order = np.array([mine[key] for key in other])
    assert np.allclose(ours.equations[order], theirs.equations, atol=1e-9)
    back = np.append(np.argsort(order), -1)  # -1 stays: no neighbour
    for place, row in enumerate(order):
        our_ridge = dict(zip(ours.simplices[row].tolist(), back[ours.neighbors[row]].tolist()))
        their_ridge = dict(zip(theirs.simplices[place].tolist(), theirs.neighbors[place].tolist()))
        assert our_ridge == their_ridge
    return order


@pytest.mark.parametrize("dimension", [2, 3, 4, 5])
@pytest.mark.parametrize("shape", ["ball", "sphere"])
def test_every_attribute(dimension, shape):
    points = cullhull.generate(shape, 300 if dimension < 5 else 60, dimension)
    ours, theirs = cullhull.ConvexHull(points), spatial.ConvexHull(points)
    assert_same_hull(ours, theirs)
    assert np.array_equal(np.sort(ours.vertices), np.sort(theirs.vertices))
    if dimension == 2:
        start = theirs.vertices.tolist().index(ours.vertices[0])
        assert np.array_equal(ours.vertices, np.roll(theirs.vertices, -start))
    else:
        assert np.array_equal(ours.vertices, theirs.vertices)
    assert np.isclose(ours.area, theirs.area) and np.isclose(ours.volume, theirs.volume)
    assert np.array_equal(ours.min_bound, theirs.min_bound)
    assert np.array_equal(ours.max_bound, theirs.max_bound)
    assert ours.points is points and ours.good is theirs.good is None
    for name in ("ndim", "npoints", "nsimplex"):
        assert getattr(ours, name) == getattr(theirs, name)
    for name in ("vertices", "simplices", "neighbors", "equations", "coplanar", "points"):
        a, b = getattr(ours, name), getattr(theirs, name)
        assert (a.dtype, a.shape) == (b.dtype, b.shape), name
        assert getattr(ours, name) is a
    assert (points @ ours.equations[:, :-1].T + ours.equations[:, -1]).max() < 1e-12


def test_orientation_is_outward():
    points = cullhull.generate("ball", 500, 3)
    hull = cullhull.ConvexHull(points)
    a, b, c = (points[hull.simplices[:, j]] for j in range(3))
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) > 0).all()


@pytest.mark.parametrize("dtype", [np.float32, np.int16, int])
def test_points_are_doubles_as_scipys(dtype):
    points = (cullhull.generate("ball", 100, 3) * 100).astype(dtype)
    ours, theirs = cullhull.ConvexHull(points), spatial.ConvexHull(points)
    assert ours.points.dtype == np.float64 and np.array_equal(ours.points, theirs.points)
    assert np.array_equal(ours.vertices, theirs.vertices)


def test_incremental():
    points = cullhull.generate("ball", 600, 3)
    ours = cullhull.ConvexHull(points[:100], incremental=True)
    theirs = spatial.ConvexHull(points[:100], incremental=True)
    for restart, part in ((False, points[100:400]), (True, points[400:500]), (False, points[500:])):
        ours.add_points(part, restart=restart)
        theirs.add_points(part, restart=restart)
        assert_same_hull(ours, theirs)
        assert np.array_equal(ours.points, theirs.points)
        assert np.array_equal(ours.vertices, theirs.vertices)
        assert np.array_equal(ours.max_bound, theirs.max_bound)
    for hull, error in ((ours, RuntimeError), (theirs, RuntimeError)):
        with pytest.raises(ValueError):
            hull.add_points(np.zeros((3, 2)))
        hull.close()
        with pytest.raises(error):
            hull.add_points(points[:3])
    for kind in (cullhull.ConvexHull, spatial.ConvexHull):
        with pytest.raises(RuntimeError):
            kind(points).add_points(points[:3])
    assert ours.npoints == 600 and ours.hull.contains([0, 0, 0])


def test_incremental_use_keeps_a_copy_and_survives_errors():
    points = cullhull.generate("ball", 100, 3)
    hull = cullhull.ConvexHull(points, incremental=True)
    before = hull.simplices
    with pytest.raises(cullhull.NotFinite):
        hull.add_points([[np.nan, 0, 0]])
    assert hull.npoints == 100 and hull.simplices is before
    points[:] = 0
    hull.add_points([[3.0, 0, 0]])
    assert hull.volume > 1 and hull.points[100, 0] == 3 and len(hull.points) == 101


def test_flat_input():
    flat = np.column_stack([cullhull.generate("ball", 50, 2), np.ones(50)])
    hull = cullhull.ConvexHull(flat)
    plane = cullhull.ConvexHull(flat[:, :2])
    assert np.array_equal(hull.simplices, plane.simplices)
    assert np.array_equal(hull.neighbors, plane.neighbors)
    assert np.isclose(hull.volume, plane.volume) and np.isclose(hull.area, plane.area)
    assert hull.equations.shape == (hull.nsimplex, 4)
    with pytest.raises(spatial.QhullError) as theirs:
        spatial.ConvexHull(flat)
    for points in (flat, flat[:3], np.eye(4)[:2]):
        with pytest.raises(spatial.QhullError) as ours:
            cullhull.ConvexHull(points, strict=True)
        assert isinstance(ours.value, cullhull.QhullError)
        assert isinstance(ours.value, type(theirs.value))
        assert isinstance(ours.value, (cullhull.Error, RuntimeError))
    assert pickle.loads(pickle.dumps(ours.value)).args == ours.value.args
    assert cullhull.ConvexHull(GRID, strict=True).volume == 8
    growing = cullhull.ConvexHull(GRID, incremental=True, strict=True)
    growing.add_points([[9, 9, 9]])
    assert growing.npoints == 28


@pytest.mark.parametrize("options", ["Qc", "Qi", "Qc Qi"])
def test_coplanar(options):
    rng = np.random.default_rng(4)
    points = np.vstack([GRID, rng.random((20, 3)) * 1.5 + 0.25])
    ours = cullhull.ConvexHull(points, qhull_options=options)
    theirs = spatial.ConvexHull(points, qhull_options="Qt " + options)
    assert np.array_equal(ours.vertices, theirs.vertices)
    assert ours.coplanar.dtype == theirs.coplanar.dtype
    assert len(set(ours.coplanar[:, 0])) == len(ours.coplanar)
    assert set(ours.coplanar[:, 0]) == set(theirs.coplanar[:, 0])
    for point, simplex, vertex in ours.coplanar:
        assert vertex in ours.simplices[simplex]
        away = ours.equations @ np.append(points[point], 1)
        assert np.isclose(away[simplex], away.max())
        corners = np.unique(ours.simplices[np.isclose(away, away[simplex])])
        nearest = np.linalg.norm(points[corners] - points[point], axis=1).min()
        on_facet = np.unique(
            ours.simplices[(ours.equations == ours.equations[simplex]).all(axis=1)]
        )
        assert np.isclose(
            np.linalg.norm(points[vertex] - points[point]),
            np.linalg.norm(points[on_facet] - points[point], axis=1).min(),
        )
        assert nearest <= np.linalg.norm(points[vertex] - points[point]) + 1e-12


def test_duplicates_are_coplanar_points():
    points = np.vstack([GRID, GRID])
    ours = cullhull.ConvexHull(points, qhull_options="Qc")
    assert set(ours.coplanar[:, 0]) == set(range(54)) - {13, 40} - set(ours.vertices)


@pytest.mark.parametrize("sign", ["", "-"])
@pytest.mark.parametrize("dimension", [2, 3, 4])
def test_good(dimension, sign):
    points = cullhull.generate("ball", 60, dimension)
    for point in range(12):
        option = f"QG{sign}{point}"
        ours = cullhull.ConvexHull(points, qhull_options=option)
        theirs = spatial.ConvexHull(points, qhull_options=option)
        assert_same_hull(ours, theirs)
        their_good = dict(zip(map(frozenset, theirs.simplices.tolist()), theirs.good.tolist()))
        our_good = dict(zip(map(frozenset, ours.simplices.tolist()), ours.good.tolist()))
        assert our_good == their_good and ours.good.dtype == theirs.good.dtype
        assert ours.npoints == 60 and np.array_equal(ours.max_bound, theirs.max_bound)
    with pytest.raises(ValueError, match="QG60"):
        cullhull.ConvexHull(points, qhull_options="QG60")


def without_run_id(error):
    """Qhull's text names each of its runs by a number of chance."""
    return re.sub(r"run-id \d+", "run-id", str(error))


@pytest.mark.parametrize("dimension", [2, 3, 5])
def test_strict_says_what_scipy_says(dimension):
    rng = np.random.default_rng(dimension)
    for k in range(dimension):
        for count in (1, dimension, dimension + 1, 40):
            flat = np.hstack([rng.random((count, k)), np.ones((count, dimension - k))])
            with pytest.raises(spatial.QhullError) as theirs:
                spatial.ConvexHull(flat)
            for points in (flat, flat.tolist(), np.asfortranarray(flat)):
                with pytest.raises(cullhull.QhullError) as ours:
                    cullhull.ConvexHull(points, strict=True)
                assert without_run_id(ours.value) == without_run_id(theirs.value)


def test_strict_without_scipy(monkeypatch):
    cullhull.QhullError  # made while SciPy is there
    monkeypatch.setitem(sys.modules, "scipy.spatial", None)
    with pytest.raises(RuntimeError, match="^QH6154 Qhull precision error: Initial simplex is flat"):
        cullhull.ConvexHull(np.ones((9, 3)), strict=True)
    with pytest.raises(RuntimeError, match=r"^QH6214 qhull input error: not enough points\(2\)"):
        cullhull.ConvexHull(np.ones((2, 3)), strict=True)


def test_reprs():
    assert repr(cullhull.ConvexHull(GRID)) == (
        "<ConvexHull of 27 points in 3D: 8 vertices, 12 simplices>"
    )
    square = np.array([[1.0, 0, -1], [0, 1, -1], [-1, 0, -1], [0, -1, -1]])
    assert repr(cullhull.HalfspaceIntersection(square)) == (
        "<HalfspaceIntersection of 4 halfspaces in 2D: 4 vertices, bounded>"
    )
    assert "unbounded" in repr(cullhull.HalfspaceIntersection(square[:3], [0.0, 0.0]))


def test_arrays_are_the_callers():
    """As SciPy's: to be changed, and never again what they were."""
    hull = cullhull.ConvexHull(GRID)
    for name in ("vertices", "simplices", "neighbors", "equations"):
        array = getattr(hull, name)
        array[:] = 0
        assert getattr(hull, name) is array and not getattr(hull, name).any()
    assert hull.hull.simplices.any() and hull.hull.facet_planes.any()
    hull.simplices = None  # and to be replaced
    assert hull.simplices is None


@pytest.mark.parametrize("dimension", [2, 3, 4])
def test_halfspaces_without_a_point_inside(dimension):
    normals = cullhull.generate("sphere", 40, dimension)
    halfspaces = np.column_stack([normals, -1 - np.abs(normals[:, 0])])
    found = cullhull.HalfspaceIntersection(halfspaces)
    assert (halfspaces[:, :-1] @ found.interior_point + halfspaces[:, -1]).max() < 0
    theirs = spatial.HalfspaceIntersection(halfspaces, np.full(dimension, 0.1))
    assert found.is_bounded and np.isclose(
        cullhull.ConvexHull(found.intersections).volume, spatial.ConvexHull(theirs.intersections).volume
    )


def test_halfspaces_errors():
    with pytest.raises(ValueError, match="QG"):
        cullhull.HalfspaceIntersection([[1, 0, -1]], [0, 0], qhull_options="QG0")
    square = np.array([[1.0, 0, -1], [0, 1, -1], [-1, 0, -1], [0, -1, -1]])
    with pytest.raises(spatial.QhullError, match="feasible"):
        cullhull.HalfspaceIntersection(square, [1.0, 0.0])
    with pytest.raises(RuntimeError):
        cullhull.HalfspaceIntersection(square, [0.0, 0.0]).add_halfspaces(square)
    for bad in (np.zeros((0, 3)), np.zeros(3), square[:, :2], np.full((3, 3), np.nan)):
        with pytest.raises(ValueError):
            cullhull.HalfspaceIntersection(bad, [0.0, 0.0])
    with pytest.raises(ValueError):
        cullhull.HalfspaceIntersection(square, [np.nan, 0.0])
    with pytest.raises(ValueError, match="no interior point"):
        cullhull.HalfspaceIntersection(np.vstack([square, [1.0, 0, 3]]))
    unbounded = cullhull.HalfspaceIntersection(square[:2], [0.0, 0.0])
    assert not unbounded.is_bounded


@pytest.mark.parametrize("name", ["ConvexHull", "Delaunay", "Voronoi"])
def test_flat_input_where_ours_stands_in_scipys_place(name, monkeypatch):
    spatial = pytest.importorskip("scipy.spatial")
    monkeypatch.setattr(spatial, name, getattr(cullhull, name))
    flat = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]]
    strict = {"strict": True} if name == "ConvexHull" else {}
    with pytest.raises(spatial.QhullError, match="QH6154"):
        getattr(cullhull, name)(flat, **strict)
