"""Stands in for coxeter's own tests/conftest.py, which its source archive leaves out.

What coxeter's tests import and request from that file, by name, written anew. The hulls are
computed by our class, or by SciPy's where CULLHULL_STAND_IN is "scipy".
"""

import os
from pathlib import Path

import numpy as np
import pytest
import scipy.spatial

if os.environ.get("CULLHULL_STAND_IN") != "scipy":
    import cullhull

    scipy.spatial.ConvexHull = cullhull.TolerantConvexHull
    scipy.spatial.HalfspaceIntersection = cullhull.HalfspaceIntersection

# These take the classes above when they are imported.
import coxeter
import rowan
from coxeter import families, shapes
from hypothesis import HealthCheck, settings, strategies
from scipy.spatial import ConvexHull

settings.register_profile(
    "suite", deadline=None, derandomize=True, suppress_health_check=list(HealthCheck)
)
settings.load_profile("suite")

DATA = Path(coxeter.__file__).parent / "families" / "data"


def is_not_ci():
    return True


# The unit cube

CUBE = np.array(
    [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0], [0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]]
)


def get_oriented_cube_faces():
    return np.array(
        [[0, 1, 2, 3], [4, 7, 6, 5], [0, 3, 7, 4], [1, 5, 6, 2], [3, 2, 6, 7], [0, 4, 5, 1]]
    )


def get_oriented_cube_normals():
    return np.array([[0, 0, -1], [0, 0, 1], [0, -1, 0], [0, 1, 0], [1, 0, 0], [-1, 0, 0]])


def make_sphero_cube(radius=0):
    return shapes.ConvexSpheropolyhedron(CUBE, radius)


@pytest.fixture
def cube_points():
    return CUBE.copy()


@pytest.fixture
def convex_cube():
    return shapes.ConvexPolyhedron(CUBE)


@pytest.fixture
def oriented_cube():
    return shapes.Polyhedron(CUBE, get_oriented_cube_faces().tolist())


@pytest.fixture
def unoriented_cube():
    faces = [np.random.permutation(face) for face in get_oriented_cube_faces()]
    cube = shapes.Polyhedron(CUBE, faces, faces_are_convex=True)
    cube.sort_faces()
    return cube


@pytest.fixture
def cube(request):
    return request.getfixturevalue(request.param)


@pytest.fixture
def tetrahedron():
    shape = families.PlatonicFamily.get_shape("Tetrahedron")
    shape.volume = 1
    return shape


# Random shapes and turns


def _on_ellipsoid(*axes, n):
    points = np.random.normal(size=(n, len(axes))) * axes
    return points / np.linalg.norm(points / axes, axis=1)[:, np.newaxis]


_axis = strategies.floats(0.1, 5)
_few = strategies.integers(5, 15)
EllipsoidSurfaceStrategy = strategies.builds(_on_ellipsoid, _axis, _axis, _axis, n=_few)
EllipseSurfaceStrategy = strategies.builds(_on_ellipsoid, _axis, _axis, n=_few)


def _turn(x, y, z, angle):
    length = np.linalg.norm([x, y, z])
    if length == 0:
        return np.array([1, 0, 0, 0])
    with np.errstate(all="ignore"):
        return rowan.from_axis_angle(np.array([x, y, z]) / length, angle)


def _turns(xy):
    return strategies.builds(
        _turn, xy, xy, strategies.floats(-1, 1), strategies.floats(0, 2 * np.pi)
    ).filter(lambda turn: bool(np.isfinite(turn).all()))


Random3DRotationStrategy = _turns(strategies.floats(-1, 1))
Random2DRotationStrategy = _turns(strategies.just(0.0))


# Families of shapes


def _names(family):
    return list(family.data)


def _family_mark(*some):
    named = [(name, family) for family in some for name in _names(family)]
    return pytest.mark.parametrize(
        "poly", [family.get_shape(name) for name, family in named], ids=[n for n, _ in named]
    )


named_platonic_mark = _family_mark(families.PlatonicFamily)
named_archimedean_mark = _family_mark(families.ArchimedeanFamily)
named_catalan_mark = _family_mark(families.CatalanFamily)
named_solids_mark = _family_mark(
    families.PlatonicFamily,
    families.ArchimedeanFamily,
    families.CatalanFamily,
    families.JohnsonFamily,
)


def combine_marks(*marks):
    values = [value for mark in marks for value in mark.args[1]]
    ids = [name for mark in marks for name in mark.kwargs["ids"]]
    return pytest.mark.parametrize("poly", values, ids=ids)


_damasceno = families.DOI_SHAPE_REPOSITORIES["10.1126/science.1220869"][0].data
named_damasceno_shapes_mark = pytest.mark.parametrize(
    "shape", list(_damasceno.values()), ids=[f"{k}: {v['name']}" for k, v in _damasceno.items()]
)
data_filenames_mark = pytest.mark.parametrize(
    "family", sorted(path.stem for path in DATA.glob("*.json") if "science" not in path.stem)
)


def regular_polygons(n=10):
    return (families.RegularNGonFamily.get_shape(corners) for corners in range(3, n + 1))


# What several tests assert


def sphere_isclose(one, other, *args, **kwargs):
    return np.isclose(one.radius, other.radius, *args, **kwargs) and np.allclose(
        one.center, other.center, *args, **kwargs
    )


def assert_distance_to_surface_2d(shape, angles, computed_distance):
    hull = ConvexHull(
        np.column_stack([np.cos(angles), np.sin(angles)]) * np.asarray(computed_distance)[:, None]
    )
    assert np.isclose(hull.volume, shape.area)
    assert np.isclose(hull.area, shape.perimeter)


def _test_get_set_minimal_bounding_sphere_radius(shape, centered=False):
    kind = "circle" if isinstance(shape, shapes.Shape2D) else "sphere"
    name = f"minimal_{'centered_' if centered else ''}bounding_{kind}"
    radius = getattr(shape, f"{name}_radius")
    assert np.isclose(getattr(shape, name).radius, radius)
    setattr(shape, f"{name}_radius", 2 * radius)
    assert np.isclose(getattr(shape, name).radius, 2 * radius)
