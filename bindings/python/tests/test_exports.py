"""Results as meshes, geometries and objects of other packages; equality, files, pages."""

import itertools
import json
import sys
import warnings

import numpy as np
import pytest

import cullhull

RNG = np.random.default_rng(5)
PLANE = RNG.random((60, 2))
SPACE = RNG.random((60, 3))
CUBE = np.array(list(itertools.product([0.0, 1.0], repeat=3)))
#: A square with a square hole, and one that touches nothing.
RINGS = [
    [[0, 0], [1, 0], [1, 1], [0, 1]],
    [[0.3, 0.3], [0.7, 0.3], [0.7, 0.7], [0.3, 0.7]],
    [[2, 0], [3, 0], [2.2, 0.2], [2, 1]],
]


def results():
    """One of each class, by points in the plane and in space."""
    for points in (PLANE, SPACE):
        d = points.shape[1]
        yield f"hull-{d}", cullhull.convex_hull(points)
        yield f"cells-{d}", cullhull.delaunay(points)
        yield f"regular-{d}", cullhull.delaunay(points, np.arange(len(points)) % 3 / 50)
        yield f"alpha-{d}", cullhull.alpha_shape(points, 0.25)
        yield f"clipped-{d}", cullhull.voronoi(points).clip([0.0] * d, [1.0] * d)
        yield f"batch-{d}", cullhull.convex_hulls([points, points[:20]])
        yield f"groups-{d}", cullhull.hulls_by(points, np.arange(len(points)) % 3)
        yield f"drop-in-{d}", cullhull.ConvexHull(points)
        yield f"delaunay-{d}", cullhull.Delaunay(points)
    yield "concave", cullhull.concave_hull(PLANE, 0.3)
    yield "constrained", cullhull.constrained_delaunay(PLANE, [[0, 1]])
    yield "polygons", cullhull.voronoi(PLANE).clip(RINGS)


EXPORTED = dict(results())
ALL = {
    **EXPORTED,
    "diagram-2": cullhull.voronoi(PLANE),
    "diagram-3": cullhull.voronoi(SPACE),
    "voronoi-2": cullhull.Voronoi(PLANE),
    "voronoi-3": cullhull.Voronoi(SPACE),
    "state-2": cullhull.HullState(PLANE),
    "state-3": cullhull.HullState(SPACE),
}
#: As SciPy's classes each of these is equal to itself alone.
OF_SCIPY = ("drop-in", "delaunay", "voronoi")
TETRAHEDRA = ("cells-3", "regular-3", "delaunay-3")
SOLID = [name for name in EXPORTED if name.endswith("-3")]
FLAT = [name for name in EXPORTED if not name.endswith("-3")]
each = pytest.mark.parametrize("name", EXPORTED)
each_flat = pytest.mark.parametrize("name", FLAT)


def area_of(triangles):
    a, b, c = np.swapaxes(np.asarray(triangles, dtype=float), 0, 1)
    cross = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    return cross.sum() / 2


def area_in_plane(name):
    result = EXPORTED[name]
    if name.startswith(("hull", "drop-in")):
        return result.volume
    if name.startswith(("batch", "groups")):
        return getattr(result, "batch", result).volumes.sum()
    if name.startswith(("clipped", "polygons")):
        return result.measures.sum()
    return area_of(result.points[result.simplices if name == "delaunay-2" else result.cells])


# Meshes


@each
def test_mesh_counts_its_own_rows(name):
    vertices, faces = EXPORTED[name].mesh()
    assert vertices.dtype == np.float64 and faces.dtype == np.int64
    assert np.array_equal(np.unique(faces), np.arange(len(vertices)))


def test_mesh_of_hulls_and_triangulations():
    for points in (PLANE, SPACE):
        hull, cells = cullhull.convex_hull(points), cullhull.delaunay(points)
        vertices, faces = hull.mesh()
        assert np.array_equal(vertices[faces], points[hull.simplices])
        vertices, faces = cells.mesh()
        assert np.array_equal(vertices[faces], points[cells.cells])
        shape = cullhull.alpha_shape(points, 0.25)
        vertices, faces = shape.mesh()
        assert np.array_equal(vertices[faces], points[shape.facets])


@pytest.mark.parametrize("name", ["clipped-2", "polygons"])
def test_mesh_of_clipped_cells_goes_around_each(name):
    cells = EXPORTED[name]
    vertices, edges = cells.mesh()
    a, b = vertices[edges[:, 0]], vertices[edges[:, 1]]
    assert np.isclose((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() / 2, cells.measures.sum())


def test_mesh_of_clipped_cells_of_space():
    vertices, faces = EXPORTED["clipped-3"].mesh()
    a, b, c = np.swapaxes(vertices[faces], 0, 1)
    assert np.isclose((a * np.cross(b, c)).sum() / 6, 1)
    vertices, ends = cullhull.voronoi([[0.0], [1.0]]).clip([-1], [3]).mesh()
    assert vertices.tolist() == [[-1], [0.5], [0.5], [3]] and ends.tolist() == [[0], [1], [2], [3]]


def test_mesh_needs_shapes():
    cells = cullhull.voronoi(PLANE).clip([0, 0], [1, 1], shapes=False)
    for way in (cells.mesh, cells.to_trimesh, cells.plot):
        with pytest.raises(cullhull.InvalidArgument, match="shapes=False"):
            way()


def test_mesh_of_a_batch_of_unlike_hulls():
    with pytest.raises(cullhull.InvalidArgument, match="affine"):
        cullhull.convex_hulls([PLANE, PLANE[:1]]).mesh()
    assert cullhull.convex_hulls(np.empty((0, 4, 3))).mesh().faces.shape[0] == 0


# As SciPy has it


@pytest.mark.parametrize("points", [PLANE, SPACE, CUBE, RNG.random((30, 4))], ids=str)
def test_points_and_equations_of_a_hull(points):
    hull = cullhull.convex_hull(points)
    theirs = cullhull.ConvexHull(points)
    rows = hull.vertex_index[hull.simplices]
    assert np.array_equal(hull.points[rows], points[hull.simplices])
    assert hull.points.shape == (len(hull.vertices), points.shape[1])
    assert np.array_equal(hull.equations, theirs.equations)


@pytest.mark.parametrize("points", [PLANE, SPACE, RNG.random((30, 4))], ids=str)
@pytest.mark.parametrize("furthest", [False, True])
def test_equations_of_a_triangulation(points, furthest):
    found = cullhull.delaunay(points, furthest_site=furthest)
    theirs = cullhull.Delaunay(points, furthest, qhull_options="Qc")
    assert np.array_equal(found.equations, theirs.equations)
    weights = np.arange(len(points)) % 5 / 50
    regular = cullhull.delaunay(points, weights, furthest_site=furthest)
    lifted = np.column_stack([points, (points**2).sum(axis=1) - weights])
    normals, offsets = regular.equations[:, :-1], regular.equations[:, -1]
    heights = normals @ lifted.T + offsets[:, np.newaxis]
    assert np.allclose(np.take_along_axis(heights, regular.cells, axis=1), 0, atol=1e-9)
    assert (heights < 1e-9).all() and np.allclose((normals**2).sum(axis=1), 1)
    if not furthest:
        assert len(regular.hidden) == 0 or (heights[:, regular.hidden] < 0).all()


def test_equations_of_flat_and_empty_triangulations():
    flat = cullhull.delaunay([[0.0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
    rows = flat.equations
    assert rows.shape == (2, 5) and np.allclose(rows[0], rows[1])
    assert cullhull.delaunay(np.empty((0, 2))).equations.shape == (0, 4)


def test_polyhedron_of_halfspaces(tmp_path):
    cube = np.column_stack([np.vstack([np.eye(3), -np.eye(3)]), [-2.0, -2, -2, 0, 0, 0]])
    cut = cullhull.HalfspaceIntersection(cube, incremental=True)
    assert cut.polyhedron.volume == 8 and cut.polyhedron.facet_count == 6
    cut.polyhedron.save(tmp_path / "cube.ply")
    cut.add_halfspaces([1.0, 1, 1, -4])
    assert np.isclose(cut.polyhedron.volume, 8 - 8 / 6)
    open_one = cullhull.HalfspaceIntersection(cube[:5], [1.0, 1, 1])
    with pytest.raises(cullhull.InvalidArgument, match="unbounded"):
        open_one.polyhedron


def test_tolerant_triangulations_show_what_is_left(tmp_path):
    points = [[0, 0], [1, 1e-17], [2, 0], [1, 1]]
    found = cullhull.TolerantDelaunay(points)
    assert found.mesh().faces.tolist() == [[0, 1, 3], [1, 2, 3]]
    assert len(found.__geo_interface__["features"]) == 2
    with pytest.raises(cullhull.InvalidArgument, match="1 flat simplex was dropped"):
        found.save(tmp_path / "a.ply")
    whole = cullhull.TolerantDelaunay(PLANE)
    whole.save(tmp_path / "a.json")
    cullhull.delaunay(PLANE).save(tmp_path / "b.json")
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()


def test_points_of_other_results():
    for name in ("cells-2", "alpha-2", "concave", "clipped-2", "constrained"):
        assert EXPORTED[name].points is not None
        assert np.array_equal(EXPORTED[name].points, PLANE)
    assert np.array_equal(cullhull.voronoi(SPACE).points, SPACE)


# Equality


def test_equality():
    again = {**dict(results()), "diagram-2": cullhull.voronoi(PLANE), "diagram-3": cullhull.voronoi(SPACE)}
    for name, result in again.items():
        if name.startswith(OF_SCIPY):
            assert result == result != ALL[name]
            continue
        assert result == ALL[name] and not result != ALL[name], name
        if not name.startswith("groups"):
            assert hash(result) == hash(ALL[name])
        for other, unlike in ALL.items():
            if other != name:
                assert result != unlike, (name, other)


def test_equality_sees_every_number():
    moved = PLANE.copy()
    moved[3] += 1e-12
    assert cullhull.delaunay(moved) != cullhull.delaunay(PLANE)
    assert cullhull.delaunay(PLANE, np.zeros(60)) != cullhull.delaunay(PLANE)
    assert cullhull.alpha_shape(PLANE, 0.25) != cullhull.alpha_shape(PLANE, 0.3)
    assert cullhull.convex_hull(PLANE) == cullhull.convex_hull(PLANE, threads=1, cull="none")
    assert cullhull.convex_hull(PLANE) != cullhull.convex_hull(np.vstack([PLANE, PLANE[:1]]))
    hull = cullhull.convex_hull(PLANE)
    assert hull.facets == cullhull.convex_hull(PLANE).facets != hull.facet_neighbours
    assert hull.nearest_facets(PLANE) == hull.nearest_facets(PLANE) != hull.nearest_facets(moved)
    assert hull.mesh() == hull.mesh() != cullhull.convex_hull(moved[:30]).mesh()
    assert hull.simplify(0.1) == hull.simplify(0.1)
    first, second = hull.certify(PLANE), hull.certify(PLANE)
    assert first == second and hash(first) == hash(second) and first != hull.certify(moved) != 3


# Other packages


def test_without_the_packages(monkeypatch):
    for way, package, extra in (
        ("to_trimesh", "trimesh", "mesh"),
        ("to_pyvista", "pyvista", "mesh"),
        ("to_open3d", "open3d", "open3d"),
        ("to_shapely", "shapely", "geo"),
        ("plot", "matplotlib", "plot"),
    ):
        monkeypatch.setitem(sys.modules, package, None)
        monkeypatch.setitem(sys.modules, f"{package}.pyplot", None)
        with pytest.raises(ImportError, match=rf"{package}.*pip install 'cullhull\[{extra}\]'"):
            getattr(EXPORTED["hull-2"], way)()


@each
def test_trimesh(name):
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    result = EXPORTED[name]
    if name in TETRAHEDRA:
        with pytest.raises(cullhull.InvalidArgument, match="tetrahedra"):
            result.to_trimesh()
        return
    mesh = result.to_trimesh()
    assert isinstance(mesh, trimesh.Trimesh) and len(mesh.vertex_attributes["point"]) == len(mesh.vertices)
    if name in FLAT:
        assert np.isclose(mesh.area, area_in_plane(name))
        assert np.isclose(area_of(mesh.triangles[:, :, :2]), area_in_plane(name))
    elif name.startswith(("hull", "drop-in")):
        assert mesh.is_watertight and np.isclose(mesh.volume, result.volume)
        assert np.array_equal(SPACE[mesh.vertex_attributes["point"]], mesh.vertices)
    elif name == "clipped-3":
        assert mesh.is_watertight and np.isclose(mesh.volume, 1)
        assert len(mesh.split()) == len(SPACE)
    elif name == "groups-3":
        assert np.array_equal(SPACE[mesh.vertex_attributes["point"]], mesh.vertices)


def test_trimesh_of_flat_points():
    pytest.importorskip("trimesh", reason="trimesh is not installed")
    square = np.column_stack([PLANE, PLANE @ [1, 2]])
    square = np.round(square * 64) / 64
    square[:, 2] = square[:, 0] + 2 * square[:, 1]
    for result in (cullhull.convex_hull(square), cullhull.delaunay(square), cullhull.alpha_shape(square)):
        assert np.isclose(result.to_trimesh().area, cullhull.convex_hull(square).volume) or isinstance(
            result, cullhull.AlphaShape
        )
    for result in (cullhull.convex_hull(PLANE[:2]), cullhull.delaunay(PLANE[:2])):
        with pytest.raises(cullhull.InvalidArgument, match="on a line has no surface"):
            result.to_trimesh()
    with pytest.raises(cullhull.InvalidArgument, match="4D"):
        cullhull.convex_hull(np.eye(4)).to_trimesh()


@each
def test_pyvista(name):
    pyvista = pytest.importorskip("pyvista", reason="pyvista is not installed")
    result = EXPORTED[name]
    found = result.to_pyvista()
    if name in TETRAHEDRA:
        assert isinstance(found, pyvista.UnstructuredGrid)
        assert found.n_cells == len(result.mesh().faces)
        assert np.isclose(found.volume, cullhull.convex_hull(SPACE).volume)
    elif name == "clipped-3":
        sizes = found.compute_cell_sizes(length=False, area=False)["Volume"]
        assert np.allclose(sizes, found.cell_data["measure"]) and np.isclose(found.volume, 1)
    elif name in FLAT:
        assert isinstance(found, pyvista.PolyData) and np.isclose(found.area, area_in_plane(name))
    elif name.startswith(("hull", "drop-in")):
        assert np.isclose(found.volume, result.volume)
    if name == "hull-3":
        assert cullhull.convex_hull(CUBE).to_pyvista().n_cells == 6


@each
def test_open3d(name):
    open3d = pytest.importorskip("open3d", reason="open3d is not installed")
    found = EXPORTED[name].to_open3d()
    if name in TETRAHEDRA:
        assert isinstance(found, open3d.geometry.TetraMesh)
        assert len(found.tetras) == len(EXPORTED[name].mesh().faces)
    elif name in FLAT:
        assert np.isclose(found.get_surface_area(), area_in_plane(name))
    else:
        assert isinstance(found, open3d.geometry.TriangleMesh) and found.has_triangles()


@each_flat
def test_shapely(name):
    shapely = pytest.importorskip("shapely", reason="shapely is not installed")
    result = EXPORTED[name]
    found = result.to_shapely()
    assert found.is_valid and np.isclose(found.area, area_in_plane(name))
    kinds = {"hull": "Polygon", "drop": "Polygon", "conc": "Polygon", "alph": "MultiPolygon"}
    assert found.geom_type == kinds.get(name[:4], "GeometryCollection")
    geometry = result.__geo_interface__
    json.dumps(geometry)
    if geometry["type"] == "FeatureCollection":
        shapes = [shapely.geometry.shape(f["geometry"]) for f in geometry["features"]]
        assert all(a.equals(b) for a, b in zip(shapes, found.geoms)) and len(shapes) == len(found.geoms)
    else:
        assert shapely.geometry.shape(result).equals(found)


def test_shapely_of_fewer_dimensions():
    shapely = pytest.importorskip("shapely", reason="shapely is not installed")
    for points in (PLANE[:0], PLANE[:1], PLANE[:2], PLANE[[4, 4, 4]]):
        ours = cullhull.convex_hull(points).to_shapely()
        assert ours.equals(shapely.MultiPoint(points).convex_hull) or (len(points) == 0 and ours.is_empty)
    assert cullhull.convex_hull(PLANE).to_shapely().equals(shapely.MultiPoint(PLANE).convex_hull)
    assert cullhull.concave_hull(PLANE[:2], 0.5).to_shapely().geom_type == "LineString"
    assert cullhull.concave_hull(PLANE[:0], 0.5).to_shapely().is_empty


def test_cells_that_are_not_in_the_region_are_empty():
    pytest.importorskip("shapely", reason="shapely is not installed")
    cells = cullhull.voronoi([[0, 0], [1, 0], [9, 9]]).clip([0, 0], [1, 1])
    assert [cell.is_empty for cell in cells.to_shapely().geoms] == [False, False, True]


@pytest.mark.parametrize("name", SOLID)
def test_no_geometry_in_space(name):
    with pytest.raises(cullhull.InvalidArgument, match="2D"):
        pytest.importorskip("shapely", reason="shapely is not installed") and EXPORTED[name].to_shapely()
    assert not hasattr(EXPORTED[name], "__geo_interface__")


def test_geopandas():
    geopandas = pytest.importorskip("geopandas", reason="geopandas is not installed")
    cells = EXPORTED["clipped-2"]
    frame = geopandas.GeoDataFrame.from_features(cells)
    assert np.allclose(frame.area, cells.measures) and frame["point"].tolist() == list(range(60))
    groups = geopandas.GeoDataFrame.from_features(EXPORTED["groups-2"])
    assert groups["key"].tolist() == [0, 1, 2] and np.allclose(groups.area, groups["area"])


def test_a_shape_is_a_region_for_others():
    outline = cullhull.concave_hull(PLANE, 0.3)
    cells = cullhull.voronoi(PLANE).clip(outline)
    assert np.isclose(cells.measures.sum(), area_in_plane("concave"))


# Pictures, files and pages


@pytest.mark.parametrize("name", ALL)
def test_drawn_and_shown(name):
    matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import xml.dom.minidom

    result = ALL[name]
    axes = result.plot(linewidth=2)
    assert axes.collections and result.plot(axes) is axes
    axes.figure.canvas.draw()
    low, high = axes.get_xlim()
    assert low <= PLANE[:, 0].min() + 0.1 and PLANE[:, 0].max() - 0.1 <= high
    plt.close("all")
    page = xml.dom.minidom.parseString(result._repr_html_())
    shapes = [len(page.getElementsByTagName(tag)) for tag in ("polygon", "path", "polyline")]
    assert sum(shapes) > 0 and page.getElementsByTagName("td")


def test_pictures_have_holes_and_no_more():
    ring = [[np.cos(t) * r, np.sin(t) * r] for r in (1, 2) for t in np.linspace(0, 6.2, 40)]
    shape = cullhull.alpha_shape(ring, 0.6)
    assert len(shape.polygons()[0]) == 2
    assert "fill-rule='evenodd'" in shape._repr_html_()
    large = cullhull.delaunay(RNG.random((3000, 2)))
    assert "<svg" not in large._repr_html_() and "cells" in large._repr_html_()
    assert "<svg" not in cullhull.delaunay(RNG.random((30, 4)))._repr_html_()


WRITTEN = {
    "cells-2": "ply obj off stl glb vtp vtk geojson wkt json",
    "regular-2": "ply geojson json",
    "constrained": "ply obj off stl glb vtp vtk geojson wkt json",
    "cells-3": "vtk json",
    "alpha-2": "ply obj off stl glb vtp vtk geojson wkt json",
    "alpha-3": "ply obj off stl glb vtp vtk json",
    "concave": "ply geojson wkt json",
    "clipped-2": "ply obj off vtp geojson wkt",
    "clipped-3": "ply obj off vtp",
    "diagram-2": "json",
    "diagram-3": "json",
    "drop-in-3": "ply obj off stl glb vtp json txt",
    "delaunay-2": "ply obj off stl glb vtp vtk geojson wkt json",
    "voronoi-3": "json",
    "batch-2": "geojson csv json",
    "batch-3": "csv json",
    "groups-2": "geojson csv json",
    "groups-3": "csv json",
}


@pytest.mark.parametrize("name", WRITTEN)
def test_saved(name, tmp_path):
    for ending in WRITTEN[name].split():
        path = tmp_path / f"file.{ending}"
        ALL[name].save(path)
        data = path.read_bytes()
        assert data
        ALL[name].save(tmp_path / "other", format=ending)
        assert (tmp_path / "other").read_bytes() == data
    with pytest.raises(ValueError):
        ALL[name].save(tmp_path / "file.docx")
    with pytest.raises(OSError):
        ALL[name].save(tmp_path / "no" / f"file.{ending}")
    if "json" in WRITTEN[name].split():
        json.loads((tmp_path / "file.json").read_text())


def test_saved_geometries_are_those_of_the_interface(tmp_path):
    for name in ("cells-2", "clipped-2", "constrained"):
        ALL[name].save(tmp_path / "a.geojson")
        saved = json.loads((tmp_path / "a.geojson").read_text())
        ours = ALL[name].__geo_interface__
        assert [f["geometry"] for f in saved["features"]] == [f["geometry"] for f in ours["features"]]
    EXPORTED["concave"].save(tmp_path / "a.geojson")
    saved = json.loads((tmp_path / "a.geojson").read_text())
    assert saved["features"][0]["geometry"] == EXPORTED["concave"].__geo_interface__
    EXPORTED["hull-2"].save(tmp_path / "a.geojson")
    saved = json.loads((tmp_path / "a.geojson").read_text())
    assert saved["geometry"] == EXPORTED["hull-2"].__geo_interface__


def test_saved_heights(tmp_path):
    EXPORTED["cells-2"].save(tmp_path / "a.json", heights=np.arange(60))
    assert json.loads((tmp_path / "a.json").read_text())["heights"] == list(range(60))
    for wrong in (np.arange(59), np.zeros((60, 1)), np.full(60, np.nan)):
        with pytest.raises(ValueError):
            EXPORTED["cells-2"].save(tmp_path / "a.json", heights=wrong)


def test_a_changed_shape_is_not_written(tmp_path):
    shape = cullhull.alpha_shape(PLANE, 0.25)
    shape.cell_numbers = np.array([10**6], dtype=np.int32)
    with pytest.raises(cullhull.InvalidArgument, match="not those of its triangulation"):
        shape.save(tmp_path / "a.json")


def viewed(result, **options):
    try:
        return result.view(show=False, **options)
    except cullhull.BackendUnavailable as error:
        pytest.skip(str(error))  # built without three.js


@pytest.mark.parametrize("name", ALL)
def test_viewed(name, tmp_path):
    page = viewed(ALL[name], path=tmp_path / "page.html")
    assert page == str(tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text()
    assert "<html" in text and "default-src 'none'" in text
    frame = page._repr_html_()
    assert frame.startswith("<iframe srcdoc='") and "<html" not in frame and "&lt;html" in frame


def test_a_viewed_scene_is_that_of_the_result(tmp_path):
    import base64
    import re

    page = viewed(EXPORTED["cells-3"], path=tmp_path / "page.html")
    text = open(page).read()
    scene = json.loads(re.search('id="scene"[^>]*>(.*?)</script>', text, re.S)[1])
    data = base64.b64decode(re.search('id="bytes"[^>]*>(.*?)</script>', text, re.S)[1])
    (frame,) = scene["frames"]

    def array(name):
        offset, length, kind = frame[name]
        return np.frombuffer(data, {"u32": "<u4", "f64": "<f8"}[kind], length, offset)

    assert np.array_equal(array("coordinates").reshape(-1, 3), SPACE)
    assert np.array_equal(array("cells").reshape(-1, 4), EXPORTED["cells-3"].cells)
    assert scene["dimension"] == 3 and ["points", "60 in 3D"] in frame["report"]["rows"]


def test_view_refuses():
    with pytest.raises(cullhull.InvalidArgument, match="12 MB"):
        viewed(cullhull.delaunay(RNG.random((200_000, 2))))
    with pytest.raises(cullhull.InvalidArgument, match="4D"):
        viewed(cullhull.delaunay(RNG.random((20, 4))))


def test_a_notebook_opens_no_browser(monkeypatch, tmp_path):
    import types
    import webbrowser

    opened = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    viewed(EXPORTED["hull-2"])
    shell = types.SimpleNamespace(kernel=object())
    fake = types.SimpleNamespace(get_ipython=lambda: shell)
    monkeypatch.setitem(sys.modules, "IPython", fake)
    EXPORTED["hull-2"].view(path=tmp_path / "a.html")
    assert not opened
    shell.kernel = None
    EXPORTED["hull-2"].view(path=tmp_path / "a.html")
    assert opened == [(tmp_path / "a.html").as_uri()]


def test_nothing_warns():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        huge = cullhull.convex_hull(PLANE * 1e300), cullhull.delaunay(PLANE * 1e300)
        for result in (*huge, cullhull.convex_hull(SPACE * 1e300)):
            assert "<table>" in result._repr_html_()


def test_flat_shapes_are_lines_and_points(tmp_path):
    """As ST_ConcaveHull, JTS and GEOS give them."""
    line = [[2, 1], [0, 0], [4, 2], [0, 0], [10, 5], [12, 6.0]]
    whole = {"type": "LineString", "coordinates": [[0.0, 0.0], [12.0, 6.0]]}
    apart = {
        "type": "MultiLineString",
        "coordinates": [[[0.0, 0.0], [4.0, 2.0]], [[10.0, 5.0], [12.0, 6.0]]],
    }
    point = {"type": "Point", "coordinates": [7.0, 8.0]}
    upright = [[1, 5], [1, 3], [1, 4.0]]
    for found, expected in (
        (cullhull.concave_hull(line, 0.5), whole),
        (cullhull.concave_hull(line, edge_length=0.1), whole),
        (cullhull.alpha_shape(line, np.inf), whole),
        (cullhull.alpha_shape(line, 2), apart),
        (cullhull.concave_hull([[7, 8.0]], 0.3), point),
        (cullhull.concave_hull([[7, 8.0]] * 3, 0.3), point),
        (cullhull.alpha_shape([[7, 8.0]], 0), point),
        (
            cullhull.concave_hull(upright, 1),
            {"type": "LineString", "coordinates": [[1.0, 3.0], [1.0, 5.0]]},
        ),
    ):
        assert found.__geo_interface__ == expected
        shapely = pytest.importorskip("shapely")
        shape = found.to_shapely()
        assert shape.is_valid and shape.equals(shapely.geometry.shape(expected))
        for name in ("shape.geojson", "shape.wkt"):
            found.save(tmp_path / name)
        text = (tmp_path / "shape.geojson").read_text()
        written = [f["geometry"] for f in json.loads(text)["features"]]
        if expected["type"] != "MultiLineString":
            assert written == [expected]
        else:
            assert [g["coordinates"] for g in written] == expected["coordinates"]
        again = shapely.from_wkt((tmp_path / "shape.wkt").read_text())
        assert shapely.union_all(list(again.geoms)).equals(shape)
    assert cullhull.concave_hull(np.zeros((0, 2)), 1).__geo_interface__["coordinates"] == []
