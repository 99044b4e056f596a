"""The classes for programs that assume tolerances, and the methods under them."""

import copy

import numpy as np
import pytest

import cullhull
from cullhull import TolerantConvexHull, TolerantDelaunay, TolerantVoronoi


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


# Diagrams and triangulations


def mirrored(n, dimension, seed=1):
    """Points in the unit box and their images at its walls, as OpenPNM makes them."""
    points = np.random.default_rng(seed).random((n, dimension))
    images = [points]
    for axis in range(dimension):
        for wall in (0.0, 1.0):
            image = points.copy()
            image[:, axis] = 2 * wall - image[:, axis]
            images.append(image)
    return np.vstack(images)


def pairs_of(diagram, least=0):
    return {
        tuple(sorted(pair))
        for pair, ridge in zip(diagram.ridge_points.tolist(), diagram.ridge_vertices)
        if len(ridge) >= least
    }


@pytest.mark.parametrize("n, dimension", [(50, 2), (500, 2), (20, 3), (150, 3)])
def test_mirrored_points_have_the_diagram_of_scipy(n, dimension):
    spatial = pytest.importorskip("scipy.spatial")
    points = mirrored(n, dimension)
    theirs, exact, ours = (
        kind(points) for kind in (spatial.Voronoi, cullhull.Voronoi, TolerantVoronoi)
    )
    assert len(exact.vertices) > len(theirs.vertices) == len(ours.vertices)
    assert ours.dropped == len(exact.vertices) - len(ours.vertices)
    assert ours.distance < 1e-15 < ours.merge_distance < 1e-13
    # SciPy leaves out unbounded faces of one vertex in space
    assert pairs_of(theirs) == pairs_of(ours, dimension)
    assert (pairs_of(ours) - pairs_of(theirs)) <= pairs_of(exact)
    away = np.abs(theirs.vertices[:, np.newaxis] - ours.vertices).max(axis=2)
    assert away.min(axis=0).max() < 1e-10 and len(set(away.argmin(axis=1))) == len(away)
    place = np.append(away.argmin(axis=0), -1)
    for region, other in zip(ours.point_region[: 2 * n], theirs.point_region[: 2 * n]):
        assert set(place[ours.regions[region]]) == set(theirs.regions[other])


@pytest.mark.parametrize("dimension, cells, ridges", [(2, 25, 60), (3, 64, 240)])
@pytest.mark.parametrize("factor", [1.0, 2.0**900, 1e-290])
def test_a_turned_lattices_diagram_is_the_lattices(dimension, cells, ridges, factor):
    side = round(cells ** (1 / dimension)) + 1
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(dimension,) * 2))[0]
    exact = cullhull.Voronoi(lattice(dimension, side))
    assert (len(exact.vertices), len(exact.ridge_points)) == (
        cells,
        dimension * side ** (dimension - 1) * (side - 1),
    )
    found = TolerantVoronoi(lattice(dimension, side) @ turn * factor)
    assert len(found.vertices) == cells < len(found.diagram.vertices)
    assert pairs_of(found) == pairs_of(exact)
    assert sorted(map(len, found.regions)) == sorted(map(len, exact.regions))
    assert all(len(set(region)) == len(region) for region in found.regions)
    assert found.distance <= found.merge_distance


def test_a_turned_lattices_boundary_has_no_flat_simplices():
    for dimension, side in ((2, 6), (3, 4), (4, 3)):
        turn = np.linalg.qr(np.random.default_rng(6).normal(size=(dimension,) * 2))[0]
        points = lattice(dimension, side) @ turn
        exact, found = cullhull.Delaunay(points), TolerantDelaunay(points)
        assert found.nsimplex + found.dropped == exact.nsimplex and found.dropped > 0
        assert 0 < found.distance <= found.merge_distance < 1e-12
        corners = points[found.simplices]
        sizes = np.linalg.det(corners[:, 1:] - corners[:, :1])
        cell, slot = np.nonzero(found.neighbors < 0)
        sides = np.array([np.delete(c, s, axis=0) for c, s in zip(corners[cell], slot)])
        edges = sides[:, 1:] - sides[:, :1]
        proper = np.linalg.det(edges @ np.swapaxes(edges, 1, 2)) > 0.5
        assert (sizes[cell[proper]] > 0.5).all() and proper.mean() > 0.9
        factorial = np.prod(np.arange(1, dimension + 1))
        assert np.isclose(sizes.sum() / factorial, (side - 1) ** dimension)
        # neighbours are mutual and share a facet; facets of the boundary are outward
        cell, slot = np.nonzero(found.neighbors >= 0)
        beside = found.neighbors[cell, slot]
        assert ((found.neighbors[beside] == cell[:, np.newaxis]).sum(axis=1) == 1).all()
        assert len(found.convex_hull) == (found.neighbors < 0).sum()
        facets = points[found.convex_hull]
        outward = np.linalg.det(facets - points.mean(axis=0)) * (-1) ** (dimension + 1)
        assert (outward > 0).all() or (outward < 0).all()
        assert set(np.unique(found.simplices)) == set(range(len(points)))
        inside = found.find_simplex(points + 0.1 * (points.mean(axis=0) - points))
        assert (inside >= 0).all() and (found.find_simplex(points) >= 0).all()
        assert (found.find_simplex(points * 2 + 1e3) == -1).all()


def test_points_of_dropped_simplices_alone_are_coplanar():
    points = np.array([[0, 0], [4, 0], [4, -1e-12], [2, 3]])
    assert cullhull.Delaunay(points).simplices.tolist() == [[0, 1, 3], [0, 2, 1]]
    found = TolerantDelaunay(points, merge_distance=1e-9)
    assert found.simplices.tolist() == [[0, 1, 3]] and found.dropped == 1
    assert found.coplanar.tolist() == [[2, 0, 1]] and found.vertex_to_simplex.tolist()[2] == -1
    assert found.find_simplex([3, -5e-13]) == 0 and np.isclose(found.distance, 1e-12)
    assert TolerantDelaunay(points, qhull_options="Q12", merge_distance=1e-9).coplanar.size == 0
    diagram = TolerantVoronoi(points, merge_distance=1e-9)
    assert len(diagram.vertices) == 1 and diagram.regions[diagram.point_region[2]] == [-1]


def test_the_boundary_is_the_native_one_where_nothing_is_dropped():
    for dimension in (2, 3, 4, 5):
        points = cullhull.generate("ball", 60, dimension)
        found, exact = TolerantDelaunay(points), cullhull.Delaunay(points)
        assert found.dropped == 0 and found.distance == 0
        for name in ("simplices", "neighbors", "convex_hull", "equations", "coplanar"):
            assert np.array_equal(getattr(found, name), getattr(exact, name)), (dimension, name)
        diagram, exact = TolerantVoronoi(points), cullhull.Voronoi(points)
        for name in ("vertices", "ridge_points", "ridge_vertices", "regions", "point_region"):
            assert np.array_equal(
                np.array(getattr(diagram, name), dtype=object),
                np.array(getattr(exact, name), dtype=object),
            ), (dimension, name)


def test_lifted_distance_zero_is_exact():
    points = turned(lattice())
    exact = cullhull.Voronoi(points)
    found = TolerantVoronoi(points, merge_distance=0)
    assert found.dropped == 0 and found.distance == 0
    assert found.regions == exact.regions and found.ridge_vertices == exact.ridge_vertices
    assert np.array_equal(found.ridge_points, exact.ridge_points)
    assert TolerantDelaunay(points, merge_distance=0).nsimplex == cullhull.Delaunay(points).nsimplex


def test_pairs_of_near_points_stay_apart():
    rng = np.random.default_rng(3)
    points = rng.random((40, 2))
    points = np.vstack([points, points[:5] + 1e-15])
    found = TolerantVoronoi(points)
    assert len(found.point_region) == 45 and all(len(found.regions[r]) for r in found.point_region)
    one_each = {tuple(sorted((a % 40, b % 40))) for a, b in pairs_of(found)}
    assert pairs_of(cullhull.Voronoi(points[:40])) <= one_each


def test_tolerant_threads_and_points_that_come_later():
    points = mirrored(200, 3)
    once = TolerantVoronoi(points, qhull_options="Qc", threads=1)
    many = TolerantVoronoi(points, qhull_options="Qc", threads=4)
    later = TolerantVoronoi(points[:500], incremental=True)
    later.regions
    later.add_points(points[500:])
    for other in (many, later):
        assert np.array_equal(once.vertices, other.vertices)
        assert once.regions == other.regions and once.ridge_vertices == other.ridge_vertices
        assert once.distance == other.distance and once.dropped == other.dropped


def test_tolerant_furthest_site():
    points = turned(lattice())[:, :2] * 3
    found, exact = (k(points, furthest_site=True) for k in (TolerantVoronoi, cullhull.Voronoi))
    assert len(found.vertices) <= len(exact.vertices)
    ring = np.array([[np.cos(t), np.sin(t)] for t in np.arange(16) * np.pi / 8 + 0.1])
    assert len(TolerantVoronoi(ring, furthest_site=True).vertices) == 1


def test_tolerant_refusals():
    points = cullhull.generate("ball", 30, 3)
    for kind in (TolerantDelaunay, TolerantVoronoi):
        for distance in (-1, np.nan, np.inf):
            with pytest.raises(ValueError, match="finite"):
                kind(points, merge_distance=distance)
        with pytest.raises(cullhull.QhullError):
            kind(points * [1, 1, 0])
        with pytest.raises(cullhull.InvalidArgument, match="no simplex is thicker"):
            kind(points, merge_distance=100).dropped
        assert "within" in repr(kind(points)) and kind.__name__ in repr(kind(points))


FLAT = {
    "one": np.zeros((1, 2)),
    "two": np.array([[0, 0], [1, 1.0]]),
    "three in space": np.eye(3),
    "on a line": np.array([[0, 0], [1, 1], [2, 2], [3, 3.0]]),
    "on a line but for rounding": np.c_[np.linspace(0, 1, 7), np.linspace(0, 0.3, 7)],
    "thinner than rounding": np.array([[0, 0], [1, 0], [2, 0], [3, 1e-20]]),
    "thin": np.array([[0, 0], [1, 0], [2, 0], [3, 1e-14]]),
    "all equal": np.ones((6, 2)),
    "in a plane": np.array([[x, y, 0.25 * x] for x in (0, 1, 2) for y in (0, 1, 3.0)]),
    "in a plane but for rounding": np.array(
        [[x, y, 0.3 * x + 0.7 * y] for x in (0, 0.1, 0.2) for y in (0, 0.1, 0.3)]
    ),
    "on a line in space": np.array([[t, t, t] for t in range(5)], dtype=float),
}


@pytest.mark.parametrize("points", [pytest.param(p, id=name) for name, p in FLAT.items()])
@pytest.mark.parametrize("name", ["Delaunay", "Voronoi"])
def test_tolerant_refuses_what_scipy_refuses(points, name):
    spatial = pytest.importorskip("scipy.spatial")
    ours = {"Delaunay": TolerantDelaunay, "Voronoi": TolerantVoronoi}[name]
    with pytest.raises(spatial.QhullError) as theirs:
        getattr(spatial, name)(points)
    with pytest.raises(cullhull.QhullError) as mine:
        ours(points)
    assert isinstance(mine.value, spatial.QhullError)
    assert str(mine.value)[:6] == str(theirs.value)[:6]  # QH6154, say


def test_tolerant_keeps_its_points_where_added_ones_are_refused():
    found = TolerantDelaunay([[0, 0], [1, 0], [0, 1.0]], incremental=True)
    with pytest.raises(cullhull.QhullError):
        found.add_points([[1e30, 1e30]])  # beside which the others are one point
    assert found.npoints == 3 and len(found.simplices) == 1
    found.add_points([[1, 1.0]])
    assert found.npoints == 4 and len(found.simplices) == 2
