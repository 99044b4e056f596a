"""Stands in for trimesh's own tests/generic.py, which its source archive leaves out.

trimesh's test_convex.py asks for meshes from files that are not distributed either; here each name
stands for a mesh of the same kind. The hulls are computed by our class.
"""

# trimesh's tests use these names of this module.
import logging
import platform  # noqa: F401
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


def _transforms(count):
    rng = np.random.default_rng(0)
    for _ in range(count):
        matrix = trimesh.transformations.random_rotation_matrix(rng.random(3))
        matrix[:3, 3] = (rng.random(3) - 0.5) * 1000
        yield matrix


transforms = list(_transforms(100))
