"""Stands in for trimesh's own tests/generic.py, which its source archive leaves out.

trimesh's tests of hulls, bounds and stable poses ask for meshes from files that are not distributed
either; here each name stands for a mesh of the same kind. The hulls are computed by our class.
"""

# trimesh's tests use these names of this module.
import contextlib
import logging
import platform  # noqa: F401
import timeit  # noqa: F401
import unittest  # noqa: F401

import numpy as np
import trimesh
import trimesh.bounds
import trimesh.convex

import cullhull

trimesh.convex.ConvexHull = cullhull.ConvexHull
trimesh.convex.QhullError = cullhull.QhullError
trimesh.bounds.ConvexHull = cullhull.ConvexHull

log = logging.getLogger("trimesh")


def _open_mesh():
    mesh = trimesh.creation.icosphere()
    mesh.update_faces(np.arange(len(mesh.faces)) > 4)
    return mesh


_MESHES = {
    "large_block.STL": lambda: trimesh.creation.box(extents=[10, 7, 3]).subdivide(),
    "featuretype.STL": lambda: trimesh.creation.annulus(r_min=1, r_max=2, height=0.5),
    "quadknot.obj": lambda: trimesh.creation.torus(major_radius=3, minor_radius=1),
    "unit_cube.STL": lambda: trimesh.creation.box(),
    "1002_tray_bottom.STL": lambda: trimesh.creation.annulus(
        r_min=4, r_max=5, height=0.01, transform=trimesh.transformations.rotation_matrix(1, [1, 2, 3])
    ),
    "not_convex.obj": _open_mesh,
}


class _Source:
    def __init__(self, name):
        self.file_name = name


def get_mesh(name, **options):
    mesh = _MESHES[name]()
    mesh.process(merge_tex=options.get("merge_tex", False))
    return mesh


def get_meshes(count):
    return [_MESHES[name]() for name in list(_MESHES)[:count]]


def random(shape):
    return np.random.default_rng(0).random(shape)


@contextlib.contextmanager
def RandomSeed(seed=0):
    yield np.random.default_rng(seed)


def random_transforms(count, translate=1000):
    rng = np.random.default_rng(0)
    for _ in range(count):
        matrix = trimesh.transformations.random_rotation_matrix(rng.random(3))
        matrix[:3, 3] = (rng.random(3) - 0.5) * translate
        yield matrix


transforms = list(random_transforms(100))
tol = trimesh.tol
inv, det, qr = np.linalg.inv, np.linalg.det, np.linalg.qr
