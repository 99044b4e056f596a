"""The native face against a slow reference, and questions against NumPy."""

import itertools
import json
import pathlib
import pickle

import numpy as np
import pytest
import reference

import cullhull


@pytest.mark.parametrize("dimension, count", [(2, 14), (3, 10), (4, 8)])
@pytest.mark.parametrize("grid", [None, 3])
def test_facets_and_vertices_are_those_of_the_reference(dimension, count, grid):
    rng = np.random.default_rng(dimension * 10 + (grid or 0))
    for _ in range(4):
        points = rng.integers(0, grid, (count, dimension)) if grid else rng.random((count, dimension))
        hull = cullhull.convex_hull(points, certify=True)
        if hull.affine_dimension < dimension:
            continue
        assert sorted(hull.vertices.tolist()) == reference.vertices(points)
        corners = set(hull.vertices.tolist())
        assert {frozenset(f) for f in hull.facets.tolist()} == {
            frozenset(corners & f) for f in reference.facets(points)
        }


def test_shapes_types_and_relations():
    points = cullhull.generate("ball", 3000, 3, seed=5)
    hull = cullhull.convex_hull(points)
    v, s, f = len(hull.vertices), hull.simplex_count, hull.facet_count
    assert v - s * 3 // 2 + s == 2
    assert hull.vertices.dtype == np.int64 and np.all(np.diff(hull.vertices) > 0)
    assert np.array_equal(hull.vertex_points, points[hull.vertices])
    assert hull.simplices.shape == hull.simplex_neighbours.shape == (s, 3)
    assert hull.simplex_facets.shape == (s,) and hull.facet_planes.shape == (f, 4)
    assert len(hull.facets) == len(hull.facet_neighbours) == f
    assert np.array_equal(hull.facets.lengths(), hull.facet_neighbours.lengths())
    assert np.allclose(np.linalg.norm(hull.facet_planes[:, :3], axis=1), 1)
    for simplex, neighbours in zip(hull.simplices, hull.simplex_neighbours):
        for j in range(3):
            assert set(np.delete(simplex, j)) <= set(hull.simplices[neighbours[j]])
    a, b, c = (points[hull.simplices[:, j]] for j in range(3))
    assert np.isclose(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6, hull.volume)
    assert np.isclose(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2, hull.area)
    assert hull.contains(hull.centroid) and hull.statistics["survivors"] <= 3000


def test_results_outlive_hull_and_points():
    points = cullhull.generate("ball", 1000, 3)
    hull = cullhull.convex_hull(points)
    simplices, planes = hull.simplices, hull.facet_planes
    expected = simplices.copy(), planes.copy()
    points[:] = 0
    assert hull.contains([0.0, 0.0, 0.0]) and not hull.contains([2.0, 0.0, 0.0])
    del hull
    assert np.array_equal(simplices, expected[0]) and np.array_equal(planes, expected[1])
    with pytest.raises(ValueError):
        simplices[0, 0] = 1


@pytest.mark.parametrize("dimension", [2, 3, 4])
def test_questions(dimension):
    points = cullhull.generate("ball", 400, dimension)
    hull = cullhull.convex_hull(points)
    rng = np.random.default_rng(7)
    asked = rng.normal(size=(500, dimension))
    values = asked @ hull.facet_planes[:, :-1].T + hull.facet_planes[:, -1]
    inside = (values <= 0).all(axis=1)
    assert 0 < inside.sum() < 500
    assert np.array_equal(hull.contains(asked), inside)
    assert np.array_equal(hull.sides(asked), np.where(inside, -1, 1))
    assert (hull.sides(points[hull.vertices]) == 0).all()
    distance = hull.distance(asked)
    assert np.allclose(distance[inside], values[inside].max(axis=1))
    assert (distance[~inside] >= values[~inside].max(axis=1) - 1e-12).all()
    nearest = hull.nearest_facets(asked)
    assert np.array_equal(nearest.distances, distance)
    assert np.allclose(values[inside, nearest.facets[inside]], distance[inside])
    support = hull.support(asked)
    assert np.array_equal(support, np.argmax(asked @ points.T, axis=1))
    for point, value in zip(asked[:50], values):
        assert np.array_equal(hull.visible_from(point), np.flatnonzero(value > 0))
    hits = hull.rays(np.zeros(dimension), asked)
    assert hits.hit.all() and (hits.enter < 0).all() and (hits.exit > 0).all()
    ends = asked * hits.exit[:, np.newaxis]
    assert np.allclose(hull.distance(ends), 0, atol=1e-9)
    assert isinstance(hull.contains(asked[0]), bool) and isinstance(hull.support(asked[0]), int)
    assert isinstance(hull.distance(asked[0]), float) and isinstance(hull.sides(asked[0]), int)
    missed = hull.rays([5.0] * dimension, [1.0] + [0.0] * (dimension - 1))
    assert not missed.hit[0] and missed.exit_facets[0] == -1


def test_cull_hands_over_every_extreme_point():
    points = cullhull.generate("ball", 200_000, 3)
    hull = cullhull.convex_hull(points)
    for method in ("auto", "gauge", "pseudo-hull", "none"):
        kept = cullhull.cull(points, method=method)
        assert kept.dtype == np.int64 and np.all(np.diff(kept) > 0)
        assert np.isin(hull.vertices, kept).all()
    assert len(kept) == 200_000 and len(cullhull.cull(points)) < 40_000


@pytest.mark.parametrize("k", [-1, 0, 1, 2])
def test_flat_sets(k):
    rng = np.random.default_rng(3)
    if k < 0:
        points = np.empty((0, 3))
    else:
        points = rng.integers(-9, 9, (30, k)) @ rng.integers(-9, 9, (k, 3)) + 1
    hull = cullhull.convex_hull(points)
    assert hull.affine_dimension == k and hull.simplices.shape[1:] == (max(k, 0),)
    assert cullhull.certify(points, hull)
    if k >= 0:
        assert hull.contains(points).all() and not hull.contains([0.5, 0.25, 100.0])
        assert len(hull.vertices) >= k + 1
    else:
        assert len(hull.vertices) == 0
        with pytest.raises(ValueError, match="empty"):
            hull.contains([0.0, 0.0, 0.0])


def test_options_do_not_change_the_result():
    points = cullhull.generate("ball", 50_000, 3)
    expected = cullhull.convex_hull(points)
    for options in (
        {"threads": 1},
        {"cull": "none"},
        {"cull": "pseudo-hull"},
        {"backend": "cpu", "memory_budget": 2**30},
    ):
        hull = cullhull.convex_hull(points, **options)
        assert np.array_equal(hull.simplices, expected.simplices)
        assert hull.volume == expected.volume
    unfiltered = cullhull.convex_hull(points, cull="none").statistics
    assert unfiltered["cull_method"] == "none"
    assert unfiltered["cull_reason"] == "no filter, as asked; then space engine"


def test_certify_finds_another_set():
    points = cullhull.generate("ball", 1000, 3)
    hull = cullhull.convex_hull(points, certify=True)
    assert hull.certificate and hull.certificate.points_checked == 1000
    points[7] = 3
    certificate = cullhull.certify(points, hull)
    assert not certificate and certificate.reason
    assert not hull.certify(points)


def test_bad_options():
    points = np.eye(3)
    for wrong in ({"backend": "gpu"}, {"cull": "all"}, {"threads": -1}, {"memory_budget": -5}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            cullhull.convex_hull(points, **wrong)
    for wrong in ({"backend": 3}, {"threads": 1.5}, {"progress": 7}):
        with pytest.raises(TypeError):
            cullhull.convex_hull(points, **wrong)
    with pytest.raises(TypeError):
        cullhull.Hull()
    with pytest.raises(TypeError):
        cullhull.certify(points, "hull")
    with pytest.raises(MemoryError):
        cullhull.convex_hull(cullhull.generate("sphere", 100_000, 3), memory_budget=1000)
    with pytest.raises(cullhull.OutOfBudget):
        cullhull.convex_hull(cullhull.generate("sphere", 100_000, 3), memory_budget=1000)


def test_generate():
    assert "ball" in cullhull.shapes()
    a = cullhull.generate("ball", 100, 4, seed=3)
    assert a.shape == (100, 4) and a.dtype == np.float64
    assert np.array_equal(a, cullhull.generate("ball", 100, 4, seed=3))
    assert not np.array_equal(a, cullhull.generate("ball", 100, 4, seed=4))
    with pytest.raises(ValueError, match="cucumber"):
        cullhull.generate("cucumber", 10, 3)


@pytest.mark.parametrize(
    "call, name",
    [
        (lambda: cullhull.generate("ball", -1), "count"),
        (lambda: cullhull.generate("ball", 2**63), "count"),
        (lambda: cullhull.generate("ball", 10, -3), "dimension"),
        (lambda: cullhull.generate("ball", 10, 0), "dimension"),
        (lambda: cullhull.generate("ball", 10, 2**32), "dimension"),
        (lambda: cullhull.generate("ball", 10, seed=-1), "seed"),
        (lambda: cullhull.generate("ball", 10, seed=2**64), "seed"),
        (lambda: cullhull.GrowingHull(-1), "dimension"),
        (lambda: cullhull.GrowingHull(0), "dimension"),
        (lambda: cullhull.GrowingHull(2**40), "dimension"),
        (lambda: cullhull.convex_hull(np.eye(3), threads=-1), "threads"),
        (lambda: cullhull.convex_hull(np.eye(3), memory_budget=-1), "memory_budget"),
        (lambda: cullhull.convex_hulls(np.eye(3), [-1, 3]), "offsets"),
        (lambda: cullhull.ConvexHull(np.eye(3), threads=-1), "threads"),
        (lambda: cullhull.HullTracker(threads=-1), "threads"),
    ],
)
def test_sizes_that_are_none(call, name):
    with pytest.raises(cullhull.InvalidArgument, match=name) as caught:
        call()
    assert "\n" not in str(caught.value) and "incompatible function" not in str(caught.value)


def test_sizes_of_another_type():
    for call in (
        lambda: cullhull.generate("ball", 1.5),
        lambda: cullhull.generate("ball", "many"),
        lambda: cullhull.generate(3, 10),
        lambda: cullhull.GrowingHull(2.0),
        lambda: cullhull.GrowingHull("two"),
    ):
        with pytest.raises(TypeError) as caught:
            call()
        assert "\n" not in str(caught.value) and "incompatible function" not in str(caught.value)
    with pytest.raises(MemoryError):
        cullhull.generate("ball", 2**60)


def test_certify_takes_the_class_in_scipys_place():
    points = cullhull.generate("ball", 50)
    assert cullhull.certify(points, cullhull.ConvexHull(points))
    with pytest.raises(TypeError, match=r"cullhull\.ConvexHull, not builtins\.int"):
        cullhull.certify(points, 3)


@pytest.mark.parametrize("path", ["scan.ply", pathlib.Path("scan.ply")])
def test_a_path_is_no_set_of_points(path):
    with pytest.raises(cullhull.InvalidArgument, match=r"is a path; .*cullhull\.read"):
        cullhull.convex_hull(path)


@pytest.mark.parametrize("dimension", [1, 2, 3, 4])
def test_points_are_the_vertices_whatever_the_hull_comes_from(dimension, tmp_path):
    points = cullhull.generate("ball", 200, dimension)
    half = 100
    stream = cullhull.HullStream()
    stream.push(points[half:], first_id=half)
    stream.push(points[:half], first_id=0)
    growing = cullhull.GrowingHull(dimension)
    growing.add(points)
    hull = cullhull.convex_hull(points)
    hull.save(tmp_path / "h.json", points)
    hull.save(tmp_path / "own.json")
    later = cullhull.HullState(points, first_id=10**14)
    for other, first in [
        (hull, 0),
        (pickle.loads(pickle.dumps(hull)), 0),
        (stream.hull(), 0),
        (growing.hull, 0),
        (cullhull.HullState(points).hull(), 0),
        (cullhull.convex_hulls([points])[0], 0),
        (cullhull.hulls_by(points, np.zeros(200))[0], 0),
        (cullhull.load_hull(tmp_path / "h.json"), 0),
        (later.hull(), 10**14),
    ]:
        assert not np.isnan(other.points).any()
        assert other.points.shape == (len(other.vertices), dimension)
        assert np.array_equal(other.points, other.vertex_points)
        rows = other.vertex_index[other.simplices]
        assert np.array_equal(other.points[rows], points[other.simplices - first])
        assert np.array_equal(other.vertex_index[other.vertices], np.arange(len(other.vertices)))
    if dimension > 1:
        assert np.array_equal(cullhull.ConvexHull(points).hull.points, hull.points)
    own = cullhull.load_hull(str(tmp_path / "own.json"))
    assert np.array_equal(own.points[own.vertex_index[own.simplices]], points[hull.simplices])


def test_vertex_index_refuses_other_points():
    hull = cullhull.convex_hull([[0, 0], [1, 1], [4, 0], [0, 4]])
    index = hull.vertex_index
    assert index[2] == 1 and isinstance(index[np.int64(2)], int)
    assert index[[[3, 0], [2, 2]]].tolist() == [[2, 0], [1, 1]]
    assert index[[]].shape == (0,) and len(index) == 3
    for wrong in (1, 4, -1, [0, 1], np.array([10**15])):
        with pytest.raises(IndexError, match="is not a vertex of the hull"):
            index[wrong]
    with pytest.raises(TypeError, match="integers"):
        index[1.0]
    with pytest.raises(IndexError):
        cullhull.convex_hull(np.empty((0, 3))).vertex_index[0]


@pytest.mark.parametrize("count", [0, 1, 2, 5, 300])
@pytest.mark.parametrize("dimension", [1, 2, 3, 4])
def test_a_saved_hull_is_loaded(count, dimension, tmp_path):
    points = cullhull.generate("ball", count, dimension)
    hull = cullhull.convex_hull(points)
    hull.save(tmp_path / "hull.json", points)
    again = cullhull.load_hull(tmp_path / "hull.json")
    assert again == hull and again.certify(points)
    assert again.volume == hull.volume and again.facets == hull.facets
    assert np.array_equal(again.facet_planes, hull.facet_planes)
    if count > dimension:
        assert np.array_equal(again.contains(points), hull.contains(points))


def test_what_is_no_saved_hull(tmp_path):
    with pytest.raises(cullhull.FileError, match="none.json"):
        cullhull.load_hull(tmp_path / "none.json")
    for text in ("", "{}", "[1, 2]", "not JSON"):
        (tmp_path / "a.json").write_text(text)
        with pytest.raises(cullhull.BadFile, match="a.json"):
            cullhull.load_hull(tmp_path / "a.json")
    points = cullhull.generate("ball", 20)
    cullhull.convex_hull(points).save(tmp_path / "a.json", points)
    document = json.loads((tmp_path / "a.json").read_text())
    del document["vertex_coordinates"]
    (tmp_path / "a.json").write_text(json.dumps(document))
    with pytest.raises(cullhull.BadFile, match="vertex_coordinates"):
        cullhull.load_hull(tmp_path / "a.json")


def test_faces_of_meshes(tmp_path):
    cube = np.array(list(itertools.product([0.0, 1.0], repeat=3)))
    hull = cullhull.convex_hull(cube)

    def faces(save, name, **options):
        save(tmp_path / name, **options)
        return int((tmp_path / name).read_text().split()[2])

    kinds = (hull.save, lambda p, **o: hull.save(p, cube, **o), cullhull.ConvexHull(cube).save)
    for save in kinds:
        assert faces(save, "a.off") == faces(save, "a.off", polygons=False) == 12
        assert faces(save, "a.off", polygons=True) == 6
        assert faces(save, "a.txt", format="off", polygons=True) == 6
        for name in ("a.stl", "a.json", "a.glb", "a.txt"):
            with pytest.raises(cullhull.InvalidArgument, match="polygons is of .ply"):
                save(tmp_path / name, polygons=True)
    cells = cullhull.voronoi([[0, 0], [2, 0], [1, 2]]).clip([0, 0], [2, 2])
    assert faces(cells.save, "c.off", polygons=True) == 3
    assert faces(cells.save, "c.off") == sum(len(cells.corners(i)) - 2 for i in range(3))
    with pytest.raises(cullhull.InvalidArgument, match="polygons is of .ply"):
        cells.save(tmp_path / "c.geojson", polygons=True)
