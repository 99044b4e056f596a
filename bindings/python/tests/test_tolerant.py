"""The class for programs that assume tolerances, and the methods under it."""

import copy

import numpy as np
import pytest

import cullhull
from cullhull import TolerantConvexHull


def lattice(dimension=3, side=3):
    axes = [np.arange(side) - (side - 1) / 2] * dimension
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, dimension)


def turned(points, angle=0.7, axis=(1, 2, 3)):
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return points @ (np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross).T


def areas(hull):
    a, b, c = np.moveaxis(hull.points[hull.simplices], 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def test_a_turned_lattice_is_a_cube():
    points = turned(lattice())
    exact = cullhull.ConvexHull(points)
    assert exact.nsimplex > 12 and areas(exact).min() < 1e-12
    hull = TolerantConvexHull(points)
    assert hull.nsimplex == 12 and areas(hull).min() > 1.9
    assert len(np.unique(hull.equations, axis=0)) == 6
    assert hull.dropped == len(exact.vertices) - 8 > 0
    assert 0 < hull.distance <= hull.merge_distance < 1e-12
    assert np.isclose(hull.volume, 8) and hull.distance < 1e-14


def test_what_it_claims():
    points = np.random.default_rng(1).normal(size=(3000, 3))
    exact = cullhull.convex_hull(points)
    for distance in (1e-12, 0.01, 0.1, 1.0):
        hull = TolerantConvexHull(points, merge_distance=distance)
        kept = points[np.sort(hull.vertices)]
        again = cullhull.convex_hull(kept, certify=True)
        assert np.array_equal(np.sort(hull.vertices)[again.simplices], hull.simplices)
        assert hull.distance <= distance
        outside = hull.hull.distance(points)
        assert outside.max() <= hull.distance * (1 + 1e-9)
        assert len(hull.vertices) + hull.dropped == len(exact.vertices)
        assert (exact.sides(kept) == 0).all()
        above = points @ hull.equations[:, :-1].T + hull.equations[:, -1]
        assert above.max() <= hull.distance + 1e-12
        corners = points[hull.simplices]
        off = np.einsum("sij,sj->si", corners, hull.equations[:, :-1]) + hull.equations[:, -1:]
        assert np.abs(off).max() <= distance + 1e-12


def test_distance_zero_is_the_exact_hull():
    points = turned(lattice())
    exact = cullhull.ConvexHull(points)
    hull = TolerantConvexHull(points, merge_distance=0)
    assert np.array_equal(hull.simplices, exact.simplices)
    assert np.array_equal(hull.equations, exact.equations)
    assert hull.dropped == 0 and hull.distance == 0


@pytest.mark.parametrize("dimension", [2, 3, 4])
def test_dimensions_and_magnitudes(dimension):
    points = lattice(dimension, 4)
    points = points @ np.linalg.qr(np.random.default_rng(2).normal(size=(dimension,) * 2))[0]
    for factor in (1.0, 1e300, 1e-300):
        hull = TolerantConvexHull(points * factor)
        assert len(hull.vertices) == 2**dimension
        assert len(np.unique(hull.equations, axis=0)) == 2 * dimension
        assert hull.min_bound.shape == (dimension,)


@pytest.mark.parametrize("n", [10, 1000, 100_000])
def test_nothing_is_dropped_from_points_in_general_position(n):
    points = cullhull.generate("sphere", n, 3)
    hull = TolerantConvexHull(points)
    assert hull.dropped == 0 and len(hull.vertices) == n
    assert np.array_equal(hull.simplices, cullhull.ConvexHull(points).simplices)


def test_points_that_come_later():
    points = turned(lattice(side=5))
    hull = TolerantConvexHull(points[:40], incremental=True)
    hull.add_points(points[40:90])
    hull = copy.copy(hull)
    hull.add_points(points[90:])
    once = TolerantConvexHull(points)
    assert np.array_equal(hull.simplices, once.simplices)
    assert np.array_equal(hull.equations, once.equations)
    assert hull.dropped == once.dropped > 0 and hull.distance == once.distance


def test_coplanar_points_are_those_within_the_distance():
    points = turned(lattice())
    hull = TolerantConvexHull(points, qhull_options="Qc")
    assert len(hull.coplanar) == 27 - 8 - 1  # all but the corners and the centre
    exact = cullhull.ConvexHull(points, qhull_options="Qc")
    assert len(exact.coplanar) < 18


def test_flat_input_and_thin_bodies():
    flat = np.pad(lattice(2), ((0, 0), (0, 1)))
    with pytest.raises(cullhull.QhullError):
        TolerantConvexHull(flat)
    assert TolerantConvexHull(flat, strict=False).volume == 4
    thin = lattice() * [1, 1, 1e-9]
    assert TolerantConvexHull(thin, merge_distance=1e-3).hull.affine_dimension == 3
    assert TolerantConvexHull(thin, merge_distance=100).hull.affine_dimension == 3


def test_refusals():
    for distance in (-1, np.nan, np.inf):
        with pytest.raises(ValueError, match="finite"):
            TolerantConvexHull(lattice(), merge_distance=distance)
        with pytest.raises(ValueError, match="finite"):
            cullhull.convex_hull(lattice()).simplify(distance)
        with pytest.raises(ValueError, match="finite"):
            cullhull.convex_hull(lattice()).shared_planes(distance)


def test_the_native_methods():
    points = cullhull.generate("sphere", 2000, 3)
    hull = cullhull.convex_hull(points)
    small, dropped, distance = hull.simplify(0.05)
    assert len(small.vertices) == 2000 - dropped < 400 and distance <= 0.05
    assert small.point_count == 2000 and hull.simplify(0).hull.volume == hull.volume
    assert small.volume < hull.volume
    shared = hull.shared_planes(0.05)
    assert len(np.unique(shared)) < hull.facet_count / 5
    assert np.array_equal(hull.shared_planes(0), np.arange(hull.facet_count))
    assert hull.rounding_distance() == 64 * 3 * np.sqrt(3) * 2**-53 * np.abs(points).max()
