"""Data that other packages carry: tables with ties and duplicates, and meshes of others."""

import os
from pathlib import Path

import numpy as np
import pytest

import cullhull

spatial = pytest.importorskip("scipy.spatial")


def tables():
    """Measurements on decimal grids, as scikit-learn has them: many points share coordinates."""
    datasets = pytest.importorskip("sklearn.datasets")
    for name, columns in (
        ("iris", (2, 3, 4)),
        ("wine", (2, 3, 4, 5)),
        ("breast_cancer", (2, 3, 4)),
        ("diabetes", (2, 3, 4)),
        ("linnerud", (3,)),
        ("digits", (2, 3, 5)),
    ):
        data = getattr(datasets, f"load_{name}")().data.astype(float)
        if name == "digits":
            data = data[:, np.argsort(data.var(axis=0))[::-1]]  # whole numbers from 0 to 16
        for d in columns:
            yield f"{name} in {d}D", np.ascontiguousarray(data[:, :d])


def test_tables_of_measurements():
    count = 0
    for name, points in tables():
        hull = cullhull.convex_hull(points, certify=True)
        theirs = spatial.ConvexHull(points)
        assert np.isclose(hull.volume, theirs.volume) and np.isclose(hull.area, theirs.area), name
        again = cullhull.convex_hull(points[::-1], threads=1, cull="none")
        corners = {tuple(p) for p in hull.vertex_points.tolist()}
        assert corners == {tuple(p) for p in again.vertex_points.tolist()}, name
        if points.shape[1] < 4:
            found = cullhull.delaunay(points, certify=True)
            assert found.vertex_count == len(np.unique(points, axis=0)), name
        count += 1
    assert count == 17


def meshes():
    folder = os.environ.get("CULLHULL_PYVISTA_EXAMPLES", "")
    if not folder:
        pytest.skip("CULLHULL_PYVISTA_EXAMPLES does not name PyVista's examples")
    return sorted(Path(folder).glob("*.ply"))


def test_meshes_of_others():
    """PyVista's PLY files, which other programs wrote: the hull of the mesh is that of its corners,
    and a solid that trimesh finds watertight."""
    trimesh = pytest.importorskip("trimesh")
    paths = meshes()
    assert len(paths) >= 4
    for path in paths:
        points = np.asarray(cullhull.read(path))
        theirs = trimesh.load(path, process=False)
        single = points.astype(np.float32)  # the decimals of a text are no floats for us
        assert np.array_equal(single.astype(np.float64), theirs.vertices), path.name
        hull = cullhull.convex_hull(points, certify=True)
        solid = hull.to_trimesh()
        assert solid.is_watertight and np.isclose(solid.volume, hull.volume), path.name
        assert np.isclose(theirs.convex_hull.volume, hull.volume), path.name
        assert cullhull.delaunay(points).certify(), path.name
        assert (hull.sides(points) <= 0).all(), path.name
