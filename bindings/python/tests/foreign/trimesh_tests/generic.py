"""Stands in for trimesh's own tests/generic.py, which its source archive leaves out.

Its tests of hulls, bounds and stable poses ask for meshes from files that are not distributed
either; here each name stands for a mesh of the same kind (made_models.py). The hulls are computed
by our class, or by SciPy's where CULLHULL_STAND_IN is "scipy".
"""

# trimesh's tests use these names of this module.
import contextlib
import logging
import os
import platform  # noqa: F401
import timeit  # noqa: F401
import unittest  # noqa: F401

import numpy as np
import trimesh
from made_models import CAD, MODELS
from trimesh.transformations import random_rotation_matrix

if os.environ.get("CULLHULL_STAND_IN") != "scipy":
    import cullhull

    cullhull.patch("trimesh")

log = logging.getLogger("trimesh")
PY3 = True


def get_mesh(name, **options):
    mesh = MODELS[name]()
    mesh.process(merge_tex=options.get("merge_tex", False))
    return mesh


def get_meshes(count=0, split=False, min_volume=0.0, only_watertight=False):
    """Some of the meshes; with `split` a corpus of bodies: the CAD shapes, often turned."""
    if not split:
        return [make() for make in list(MODELS.values())[:count]]
    bodies = []
    for turn in random_transforms(41, translate=10):
        bodies += [make().apply_transform(turn) for make in CAD.values()]
    return [m for m in bodies if m.volume > min_volume and (m.is_watertight or not only_watertight)]


def random(shape):
    return np.random.default_rng(0).random(shape)


@contextlib.contextmanager
def RandomSeed(seed=0):
    yield np.random.default_rng(seed)


class Profiler:
    def __enter__(self):
        return self

    def __exit__(self, *exception):
        pass

    def output_text(self):
        return ""


def random_transforms(count, translate=1000):
    rng = np.random.default_rng(0)
    for _ in range(count):
        matrix = random_rotation_matrix(rng.random(3))
        matrix[:3, 3] = (rng.random(3) - 0.5) * translate
        yield matrix


transforms = list(random_transforms(100))
tol = trimesh.tol
inv, det, qr = np.linalg.inv, np.linalg.det, np.linalg.qr
