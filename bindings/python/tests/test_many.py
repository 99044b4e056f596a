"""Batches and growing hulls."""

import numpy as np
import pytest

import cullhull
from test_stream import same


def test_batch_is_each_set_alone():
    rng = np.random.default_rng(1)
    sets = [rng.random((n, 3)) for n in (50, 4, 3, 1, 0, 200)]
    batch = cullhull.convex_hulls(sets)
    alone = [cullhull.convex_hull(points) for points in sets]
    assert len(batch) == 6 and all(same(a, b) for a, b in zip(batch, alone))
    assert batch.point_counts.tolist() == [50, 4, 3, 1, 0, 200]
    assert batch.affine_dimensions.tolist() == [3, 3, 2, 0, -1, 3]
    assert np.array_equal(batch.volumes, [hull.volume for hull in alone])
    assert np.array_equal(batch.areas, [hull.area for hull in alone])
    assert np.array_equal(batch.facet_counts, [hull.facet_count for hull in alone])
    assert [v.tolist() for v in batch.vertices] == [h.vertices.tolist() for h in alone]
    assert np.array_equal(batch.vertex_points, np.vstack([h.vertex_points for h in alone]))
    assert np.array_equal(batch.facet_planes, np.vstack([h.facet_planes for h in alone]))
    assert [s.tolist() for s in batch.simplices] == [h.simplices.ravel().tolist() for h in alone]
    assert np.allclose(batch.centroids[0], alone[0].centroid)
    assert same(batch[-1], alone[-1]) and len(batch[1:3]) == 2
    assert batch[0].contains(sets[0]).all()
    with pytest.raises(IndexError):
        batch[6]


def test_forms_of_a_batch():
    points = np.random.default_rng(2).random((40, 30, 2))
    cube = cullhull.convex_hulls(points)
    flat = cullhull.convex_hulls(points.reshape(-1, 2), np.arange(0, 1201, 30))
    parts = cullhull.convex_hulls(list(points))
    mixed = cullhull.convex_hulls([points[0].astype(np.float32), points[1]])
    assert all(same(a, b) and same(a, c) for a, b, c in zip(cube, flat, parts))
    assert mixed[0].volume == cullhull.convex_hull(points[0].astype(np.float32)).volume
    assert len(cullhull.convex_hulls(points[0], [0])) == 0


def test_bad_batches():
    points = np.random.default_rng(2).random((10, 2))
    for offsets in ([0, 11], [5, 3], [-1, 4], [], [[0, 4]], [0.0, 4.0], "ab"):
        with pytest.raises(ValueError):
            cullhull.convex_hulls(points, offsets)
    with pytest.raises(ValueError, match="points\\[1\\]"):
        cullhull.convex_hulls([points, np.eye(3)])
    with pytest.raises(ValueError):
        cullhull.convex_hulls([])
    points[7, 0] = np.nan
    with pytest.raises(cullhull.NotFinite, match="set 1.*point 2"):
        cullhull.convex_hulls(points, [0, 5, 10])


@pytest.mark.parametrize("dimension", [2, 3, 4])
def test_growing(dimension):
    points = cullhull.generate("ball", 3000, dimension)
    growing = cullhull.GrowingHull(dimension)
    assert growing.hull.affine_dimension == -1
    at = 0
    for size in (1, 2, 3, 10, 500, 0, 2484):
        before = growing.hull
        growing.add(points[at : at + size])
        at += size
        assert same(growing.hull, cullhull.convex_hull(points[:at]))
        assert before.point_count == at - size
    assert growing.add(points[:5] * 0.1) == 0 and growing.hull.point_count == at + 5
    with pytest.raises(ValueError, match="dimension"):
        growing.add(np.zeros((3, dimension + 1)))
    with pytest.raises(cullhull.NotFinite):
        growing.add(np.full((1, dimension), np.nan))
    assert growing.hull.point_count == at + 5
