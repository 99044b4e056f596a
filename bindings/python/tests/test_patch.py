"""cullhull.patch and unpatch: what stands in SciPy, trimesh and PyVista, and for how long."""

import sys
import threading

import numpy as np
import pytest
from programs import python

import cullhull

spatial = pytest.importorskip("scipy.spatial", reason="SciPy is not installed")
interpolate = pytest.importorskip("scipy.interpolate", reason="SciPy is not installed")

THEIRS = {
    (module, name): getattr(module, name)
    for module, names in (
        (spatial, "ConvexHull Delaunay HalfspaceIntersection SphericalVoronoi Voronoi"),
        (interpolate, "LinearNDInterpolator NearestNDInterpolator griddata"),
    )
    for name in names.split()
}
POINTS = np.random.default_rng(3).random((200, 3))


def is_ours():
    ours = {
        getattr(module, name).__module__.startswith("cullhull") for module, name in THEIRS
    }
    assert len(ours) == 1
    return ours.pop()


@pytest.fixture(autouse=True)
def theirs_before_and_after():
    assert not is_ours()
    yield
    cullhull.unpatch("scipy", "trimesh", "pyvista")
    for (module, name), there in THEIRS.items():
        assert getattr(module, name) is there


def test_twice_is_once():
    assert repr(cullhull.patch("scipy")) == "<Patched scipy>"
    cullhull.patch("scipy")
    assert is_ours()
    cullhull.unpatch("scipy")
    assert not is_ours()
    cullhull.unpatch("scipy")
    assert not is_ours()


def test_blocks_end_one_by_one():
    with cullhull.patch("scipy") as outer:
        with cullhull.patch("scipy"), outer:
            cullhull.unpatch("scipy")
            assert is_ours()
        assert is_ours()
    assert not is_ours()
    with outer:
        assert is_ours()
    assert not is_ours()
    cullhull.patch("scipy")
    with pytest.raises(ZeroDivisionError), cullhull.patch("scipy"):
        1 / 0
    assert is_ours(), "the call before the block is still in force"


def test_a_call_that_unpatch_has_ended_still_makes_a_block():
    later = cullhull.patch("scipy")
    cullhull.unpatch("scipy")
    with later:
        assert is_ours()
    assert not is_ours()


def test_results_and_errors_are_those_that_programs_expect():
    expected = spatial.ConvexHull(POINTS).volume
    with cullhull.patch("scipy"):
        assert np.isclose(spatial.ConvexHull(POINTS, qhull_options="Qt").volume, expected)
        with pytest.raises(spatial.QhullError, match="QH6154"):
            spatial.ConvexHull([[0, 0], [1, 1], [2, 2], [3, 3]])
        assert len(spatial.Delaunay(POINTS[:, :2]).coplanar) == 0
        assert interpolate.griddata(POINTS, POINTS[:, 0], POINTS[:1])[0] == POINTS[0, 0]
        line = interpolate.griddata(np.arange(5.0), np.arange(5.0) * 2, [0.5], method="cubic")
        assert np.isclose(line, 1), "SciPy's own method calls no function of ours in turn"


def test_who_patched_after_us_is_named_and_nothing_changes():
    cullhull.patch("scipy")
    ours, spatial.Delaunay = spatial.Delaunay, threading.Thread
    said = r"scipy.spatial.Delaunay is no longer ours but threading's"
    for _ in range(2):
        with pytest.raises(cullhull.InvalidArgument, match=said):
            cullhull.unpatch("scipy")
        assert spatial.ConvexHull.__module__.startswith("cullhull")
    spatial.Delaunay = ours


@pytest.mark.parametrize("function", [cullhull.patch, cullhull.unpatch])
def test_names_that_are_none(function):
    for names, said in ((("numpy",), "'scipy', 'trimesh', 'pyvista'"), ((), "name of a package")):
        with pytest.raises(cullhull.InvalidArgument, match=said):
            function(*names)
        with pytest.raises(cullhull.InvalidArgument):
            function("scipy", "numpy")
    assert not is_ours()


@pytest.mark.parametrize("missing", ["scipy", "trimesh", "pyvista"])
def test_a_package_that_is_missing(missing, monkeypatch):
    for name in [name for name in sys.modules if name.partition(".")[0] == missing]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, missing, None)
    others = [name for name in ("scipy", "trimesh") if name != missing]
    with pytest.raises(ImportError, match=rf"patch\('{missing}'\) needs {missing}, which is not"):
        cullhull.patch(others[0], missing)
    assert not is_ours()


def test_threads():
    wrong, start = [], threading.Barrier(8)

    def work():
        start.wait()
        for _ in range(200):
            with cullhull.patch("scipy"):
                if not spatial.ConvexHull.__module__.startswith("cullhull"):
                    wrong.append(1)

    threads = [threading.Thread(target=work) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong and not is_ours()


def test_the_package_alone_loads_neither():
    names = "('scipy', 'trimesh', 'pyvista', 'cullhull._patch')"
    ran = python("-c", f"import sys, cullhull; sys.exit(any(n in sys.modules for n in {names}))")
    assert ran.returncode == 0


def test_trimesh():
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    there = trimesh.convex.ConvexHull, trimesh.bounds.ConvexHull
    mesh = trimesh.creation.icosphere()
    with cullhull.patch("trimesh"):
        hull = mesh.convex_hull
        assert issubclass(trimesh.convex.ConvexHull, cullhull.TolerantConvexHull)
        assert hull.is_watertight and len(hull.vertices) == len(mesh.vertices)
        assert trimesh.bounds.oriented_bounds(mesh)[1].max() > 1.9
    assert there == (trimesh.convex.ConvexHull, trimesh.bounds.ConvexHull)


def test_a_package_that_refuses_keeps_no_other():
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    there = trimesh.convex.ConvexHull
    cullhull.patch("scipy", "trimesh")
    ours, spatial.Delaunay = spatial.Delaunay, threading.Thread
    with pytest.raises(cullhull.InvalidArgument, match="no longer ours"):
        cullhull.unpatch("scipy", "trimesh")
    assert trimesh.convex.ConvexHull is there
    spatial.Delaunay = ours


def test_hulls_of_pyvista():
    pyvista = pytest.importorskip("pyvista", reason="PyVista is not installed")
    if not hasattr(pyvista.PolyData, "convex_hull"):
        pytest.skip("PyVista has no convex_hull before 0.49")
    there = pyvista.DataObjectFilters.convex_hull
    sphere, cube = pyvista.Sphere(), pyvista.Cube()
    blocks = pyvista.MultiBlock([sphere, None, cube])
    far = pyvista.PolyData(POINTS + [5e5, 5e6, 0])
    far.field_data["survey"] = [7]
    theirs = [part.convex_hull() for part in (sphere, cube, blocks)]
    plane = pyvista.Plane()
    flat = [plane.convex_hull(dimensionality=kind).n_cells for kind in (2, 3, "auto")]
    with cullhull.patch("pyvista"):
        for part, known in zip((sphere, cube, blocks), theirs):
            hull = part.convex_hull()
            assert hull.is_manifold and hull.is_all_triangles and hull.points.dtype == np.float32
            assert (hull.n_points, hull.n_cells) == (known.n_points, known.n_cells)
            assert np.isclose(hull.volume, known.volume) and hull.n_arrays == 0
            assert set(map(tuple, hull.points)) == set(map(tuple, known.points))
            outward = np.einsum("ij,ij->i", hull.face_normals, hull.cell_centers().points)
            assert (outward > 0).all()
        assert set(map(tuple, far.convex_hull().points)) <= set(map(tuple, far.points))
        assert far.convex_hull().field_data["survey"] == [7]
        assert flat == [plane.convex_hull(dimensionality=kind).n_cells for kind in (2, 3, "auto")]
    assert pyvista.DataObjectFilters.convex_hull is there


def test_tetrahedra_of_pyvista():
    pyvista = pytest.importorskip("pyvista", reason="PyVista is not installed")
    there = pyvista.DataSetFilters.delaunay_3d
    cloud = pyvista.PolyData(POINTS.astype(np.float32))
    cloud["age"] = np.ones(200)
    cloud["height"] = np.arange(200)
    cloud.set_active_scalars("height")
    shape = cloud.delaunay_3d(alpha=0.2)
    with cullhull.patch("pyvista"):
        grid = cloud.delaunay_3d()
        assert grid.n_points == 200 and set(grid.celltypes) == {pyvista.CellType.TETRA}
        assert (grid.compute_cell_sizes()["Volume"] > 0).all()
        assert np.isclose(grid.volume, cullhull.convex_hull(cloud).volume)
        assert grid.points.dtype == np.float32 and (grid["height"] == np.arange(200)).all()
        assert grid.active_scalars_name == shape.active_scalars_name == "height"
        ball = pyvista.Sphere().delaunay_3d()
        assert ball.active_scalars_name is None and ball.active_normals is not None
        assert cloud.delaunay_3d(alpha=0.2).n_cells == shape.n_cells, "VTK's"
        assert pyvista.Plane().delaunay_3d().n_cells == 0
    assert pyvista.DataSetFilters.delaunay_3d is there
