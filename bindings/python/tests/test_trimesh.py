"""trimesh with our class in place of SciPy's."""

import os
import pathlib
import sys

import numpy as np
import pytest
from foreign_suites import STAND_INS, passed_and_failed
from programs import python

import cullhull

trimesh = pytest.importorskip("trimesh")
sys.path.append(str(STAND_INS / "trimesh_tests"))

from made_models import CAD  # noqa: E402


@pytest.fixture
def in_place():
    with cullhull.patch("trimesh"):
        yield


def test_trimeshs_own_tests():
    """Those of hulls and of what is made of them, whole files from trimesh's source archive, over
    stand-ins for what the archive leaves out: the module generic.py and all meshes."""
    tests = os.environ.get("CULLHULL_TRIMESH_TESTS", "")
    if not tests:
        pytest.skip("CULLHULL_TRIMESH_TESTS does not name trimesh's tests folder")
    files = [f"test_{name}.py" for name in ("convex", "bounds", "nsphere", "poses")]
    asserts_a_time = f"{files[1]}::BoundsTest::test_obb_mesh_large"
    passed, failed = passed_and_failed(
        tests, "trimesh_tests", [*files, "--deselect", asserts_a_time]
    )
    assert not failed and passed >= 15


def turns(translate):
    rng = np.random.default_rng(0)
    for _ in range(50):
        matrix = trimesh.transformations.random_rotation_matrix(rng.random(3))
        matrix[:3, 3] = (rng.random(3) - 0.5) * translate
        yield matrix


@pytest.mark.parametrize("translate", [0, 1000])
@pytest.mark.parametrize("name", sorted(CAD))
def test_cad_shapes_in_fifty_turns(in_place, name, translate):
    points = CAD[name]().vertices
    volumes = []
    for turn in turns(translate):
        mesh = trimesh.convex.convex_hull(trimesh.transformations.transform_points(points, turn))
        assert mesh.is_watertight and mesh.is_winding_consistent and mesh.is_convex
        volumes.append(mesh.volume)
    assert np.allclose(volumes, volumes[0], rtol=1e-9)


def test_the_exact_hull_is_not_what_trimesh_expects(monkeypatch):
    """Why the class that assumes tolerances exists: trimesh drops simplices of no area."""
    monkeypatch.setattr(trimesh.convex, "ConvexHull", cullhull.ConvexHull)
    points = CAD["featuretype"]().vertices
    meshes = [
        trimesh.convex.convex_hull(trimesh.transformations.transform_points(points, turn))
        for turn in turns(0)
    ]
    assert any(not mesh.is_watertight for mesh in meshes)


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


def test_every_mesh_is_read():
    """All that the program writes by default; the script reads with other packages, too."""
    script = pathlib.Path(__file__).parents[3] / "tests" / "files" / "mesh_readers.py"
    if not script.exists():
        pytest.skip("this is not the source tree")
    from cullhull.__main__ import program

    ran = python(script, program(), "trimesh")
    assert ran.returncode == 0, ran.stdout + ran.stderr
