"""Points in the objects of other packages, which the package does not import."""

import numpy as np
import pytest

import cullhull
from programs import python

RNG = np.random.default_rng(7)
PLANE = RNG.random((50, 2))
SPACE = RNG.random((50, 3))


def held_by_shapely(points):
    shapely = pytest.importorskip("shapely", reason="shapely is not installed")
    each = shapely.points(points)
    yield shapely.MultiPoint(points)
    yield list(each)
    yield tuple(each)
    yield each
    yield [shapely.MultiPoint(points[:20]), *each[20:]]
    geopandas = pytest.importorskip("geopandas", reason="geopandas is not installed")
    series = geopandas.GeoSeries(each)
    yield series
    yield series.values
    yield geopandas.GeoDataFrame({"name": np.arange(len(points))}, geometry=series)
    yield geopandas.GeoDataFrame({"place": series}).set_geometry("place")


def held_by_trimesh(points):
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    yield trimesh.PointCloud(points)
    hull = cullhull.convex_hull(points)
    yield trimesh.Trimesh(points, hull.simplices, process=False)


def held_by_pyvista(points):
    pyvista = pytest.importorskip("pyvista", reason="pyvista is not installed")
    yield pyvista.PolyData(points)
    yield pyvista.PolyData(points).points
    yield pyvista.UnstructuredGrid({10: np.arange(48).reshape(-1, 4)}, points)


def held_by_open3d(points):
    open3d = pytest.importorskip("open3d", reason="open3d is not installed")
    rows = open3d.utility.Vector3dVector(points)
    yield open3d.geometry.PointCloud(rows)
    mesh = open3d.geometry.TriangleMesh()
    mesh.vertices = rows
    yield mesh


HOLDERS = [held_by_shapely, held_by_trimesh, held_by_pyvista, held_by_open3d]


@pytest.mark.parametrize("holder", HOLDERS)
def test_all_functions_take_them(holder):
    for points in (PLANE, SPACE):
        if points is PLANE and holder is not held_by_shapely:
            continue
        d = points.shape[1]
        keys = np.arange(len(points)) % 2
        hull = cullhull.convex_hull(points)
        for held in holder(points):
            assert cullhull.convex_hull(held) == hull
            assert cullhull.delaunay(held) == cullhull.delaunay(points)
            assert cullhull.voronoi(held) == cullhull.voronoi(points)
            assert cullhull.alpha_shape(held) == cullhull.alpha_shape(points)
            assert np.array_equal(cullhull.ConvexHull(held).points, points)
            assert np.array_equal(cullhull.Delaunay(held).simplices, cullhull.Delaunay(points).simplices)
            assert np.array_equal(cullhull.cull(held), cullhull.cull(points))
            assert cullhull.hulls_by(held, keys) == cullhull.hulls_by(points, keys)
            assert cullhull.convex_hulls([held, points]) == cullhull.convex_hulls([points, points])
            assert cullhull.HullState(held) == cullhull.HullState(points)
            assert hull.certify(held)
            growing = cullhull.GrowingHull(d)
            growing.add(held)
            assert growing.hull == hull
            assert hull.contains(held).all() and (hull.sides(held) <= 0).all()
            assert np.array_equal(cullhull.delaunay(points).nearest(held), np.arange(len(points)))
            assert cullhull.HullTracker().update(held) == hull
            assert np.array_equal(
                cullhull.minimum_spanning_tree(held), cullhull.minimum_spanning_tree(points)
            )
            if isinstance(held, tuple):
                continue  # SciPy's interpolators take a tuple for one array an axis
            values = np.arange(len(points))
            assert np.array_equal(cullhull.NearestNDInterpolator(held, values)(held), values)


def test_one_point_of_shapely_is_one_question():
    shapely = pytest.importorskip("shapely", reason="shapely is not installed")
    hull = cullhull.convex_hull(PLANE)
    assert hull.contains(shapely.Point(0.5, 0.5)) is True
    assert cullhull.delaunay(PLANE).nearest(shapely.Point(PLANE[3])) == 3
    with pytest.raises(cullhull.InvalidArgument, match="2D array"):
        cullhull.convex_hull(shapely.Point(0.5, 0.5))


def test_geometries_that_are_no_points():
    shapely = pytest.importorskip("shapely", reason="shapely is not installed")
    point, line = shapely.Point(0, 0), shapely.LineString([(0, 0), (1, 1)])
    for wrong, said in (
        (line, "not a LineString"),
        ([point, line], "not a LineString"),
        (shapely.box(0, 0, 1, 1), "not a Polygon"),
        ([point, shapely.Point(0, 0, 1)], "others none"),
        ([point, 3.0], "mixes"),
    ):
        with pytest.raises(cullhull.InvalidArgument, match=said):
            cullhull.convex_hull(wrong)
    for wrong, said in (
        ([point, None], "geometry 1 is missing"),
        ([shapely.Point(), point], "geometry 0 is an empty point"),
        (shapely.points([[0, 0], [np.nan, 1]]), "coordinate 0 is"),
    ):
        with pytest.raises(cullhull.NotFinite, match=said):
            cullhull.convex_hull(wrong)
    assert len(cullhull.convex_hull(shapely.MultiPoint()).vertices) == 0


def test_scenes_say_what_to_do():
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    with pytest.raises(cullhull.InvalidArgument, match=r"scene.to_mesh\(\)"):
        cullhull.convex_hull(trimesh.Scene())
    pyvista = pytest.importorskip("pyvista", reason="pyvista is not installed")
    with pytest.raises(cullhull.InvalidArgument, match=r"blocks.combine\(\)"):
        cullhull.convex_hull(pyvista.MultiBlock())


def test_nothing_is_imported():
    done = python(
        "-c",
        "import sys, cullhull\n"
        "cullhull.convex_hull([[0, 0], [1, 0], [0, 1]]).contains([[0.1, 0.1]])\n"
        "for name in ('shapely', 'geopandas', 'trimesh', 'pyvista', 'open3d', 'pandas'):\n"
        "    assert name not in sys.modules, name\n",
    )
    assert done.returncode == 0, done.stderr
