"""trimesh with our class in place of SciPy's."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import cullhull

trimesh = pytest.importorskip("trimesh")
HERE = Path(__file__).parent


@pytest.fixture
def in_place(monkeypatch):
    import trimesh.bounds
    import trimesh.convex

    for module in (trimesh.convex, trimesh.bounds):
        monkeypatch.setattr(module, "ConvexHull", cullhull.ConvexHull)
    monkeypatch.setattr(trimesh.convex, "QhullError", cullhull.QhullError)


@pytest.mark.parametrize("name", ["test_convex.py", "test_nsphere.py", "test_poses.py"])
def test_trimeshs_own_tests(name):
    """Those of hulls and of what is made of them, whole files from trimesh's source archive, over
    the stand-in trimesh_generic/generic.py: the archive has neither that module nor any mesh."""
    tests = os.environ.get("CULLHULL_TRIMESH_TESTS", "")
    if not tests:
        pytest.skip("CULLHULL_TRIMESH_TESTS does not name trimesh's tests folder")
    path = [str(HERE / "trimesh_generic"), *filter(None, [os.environ.get("PYTHONPATH")])]
    run = subprocess.run(
        [
            *(sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"),
            *("--import-mode=importlib", "--rootdir", tests, str(Path(tests) / name)),
        ],
        capture_output=True,
        text=True,
        cwd=tests,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(path)},
    )
    print(run.stdout[-20_000:], run.stderr[-2000:])
    assert run.returncode == 0 and re.search(r"[1-9] passed", run.stdout)


@pytest.mark.parametrize("shape", ["ball", "sphere", "cube"])
def test_hull_of_points_and_of_meshes(in_place, shape):
    points = cullhull.generate(shape, 2000, 3)
    mesh = trimesh.convex.convex_hull(points)
    native = cullhull.convex_hull(points)
    assert mesh.is_watertight and mesh.is_winding_consistent and mesh.is_convex
    assert len(mesh.vertices) == len(native.vertices)
    assert np.isclose(mesh.volume, native.volume) and np.isclose(mesh.area, native.area)
    assert np.allclose(mesh.center_mass, native.centroid)
    again = mesh.convex_hull
    assert np.isclose(again.volume, mesh.volume)
    assert set(map(tuple, trimesh.convex.hull_points(points))) == set(
        map(tuple, points[native.vertices])
    )


def test_bounds_that_need_hulls(in_place):
    box = trimesh.creation.box(extents=[1, 2, 3])
    box.apply_transform(trimesh.transformations.rotation_matrix(0.7, [1, 2, 3]))
    to_origin, extents = trimesh.bounds.oriented_bounds(box)
    assert np.allclose(np.sort(extents), [1, 2, 3])
    _, rectangle = trimesh.bounds.oriented_bounds_2D(cullhull.generate("ball", 500, 2))
    assert (rectangle < 2.01).all()
    centre, radius = trimesh.nsphere.minimum_nsphere(box)
    assert np.isclose(radius, np.sqrt(14) / 2)
