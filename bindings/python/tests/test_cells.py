"""What is made of triangulations: alpha shapes, graphs, constrained edges, natural neighbours."""

import numpy as np
import pytest

import cullhull


def twice_area(a, b, c):
    return (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]


def random_points(n, d, seed=0):
    return np.random.default_rng(seed).random((n, d))


# Alpha shapes


def test_alpha_shapes_are_cells_of_small_radius():
    points = random_points(300, 2)
    found = cullhull.delaunay(points)
    radii = cullhull.alpha_radii(found)
    a, b, c = (points[found.cells[:, j]] for j in range(3))
    sides = [np.linalg.norm(x - y, axis=1) for x, y in ((a, b), (b, c), (c, a))]
    area = twice_area(a, b, c) / 2
    np.testing.assert_allclose(radii, sides[0] * sides[1] * sides[2] / (4 * area), rtol=1e-9)
    for alpha in (0, 0.05, 0.2, np.inf, radii[7]):
        shape = cullhull.alpha_shape(found, alpha)
        assert shape.cell_numbers.tolist() == np.flatnonzero(radii <= alpha).tolist()
        assert shape.alpha == alpha
    assert cullhull.alpha_shape(found, radii[7]).cell_numbers.tolist().count(7) == 1
    assert cullhull.alpha_shape(found, np.nextafter(radii[7], 0)).cell_numbers.tolist().count(7) == 0


def test_alpha_is_found():
    points = np.concatenate([random_points(200, 2), random_points(200, 2, 1) + [3, 0]])
    every = cullhull.alpha_shape(points, "all-points")
    assert set(every.cells.ravel().tolist()) == set(range(400))
    assert len(every.polygons()) >= 2
    one = cullhull.alpha_shape(points)
    assert len(one.polygons()) == 1 and one.alpha > every.alpha
    less = cullhull.alpha_shape(points, np.nextafter(one.alpha, 0))
    assert len(less.polygons()) > 1 or set(less.cells.ravel().tolist()) != set(range(400))


def test_polygons_are_valid():
    shapely = pytest.importorskip("shapely")
    for points in (random_points(2000, 2), np.floor(random_points(500, 2) * 30)):
        for alpha in (0.72, 1.2, 0.02, 0.03):
            shape = cullhull.alpha_shape(points, alpha)
            corners = points[shape.cells]
            area = twice_area(*np.moveaxis(corners, 1, 0))
            polygons = [
                shapely.Polygon(points[rings[0]], [points[hole] for hole in rings[1:]])
                for rings in shape.polygons()
            ]
            assert all(polygon.is_valid for polygon in polygons)
            total = sum(polygon.area for polygon in polygons)
            assert total == pytest.approx(area.sum() / 2, rel=1e-9)
            assert shapely.MultiPolygon(polygons).is_valid


def test_concave_hulls_are_shapelys():
    shapely = pytest.importorskip("shapely")
    turned = random_points(800, 2)
    turned = np.c_[np.cos(5 * turned[:, 0]), np.sin(5 * turned[:, 0])] * (1 + turned[:, 1:] / 4)
    for points in (random_points(10, 2), random_points(700, 2, 1), turned):
        found = cullhull.delaunay(points)
        for ratio in (0, 0.05, 0.1, 0.3, 0.8, 1):
            hull = cullhull.concave_hull(found, ratio)
            ours = shapely.Polygon(points[hull.ring])
            other = shapely.concave_hull(shapely.MultiPoint(points), ratio)
            assert ours.normalize().equals(other.normalize()), ratio


def test_concave_hulls_leave_out_no_point_and_long_edges_only_where_they_must():
    points = random_points(500, 2)
    found = cullhull.delaunay(points)
    for length in (0.0, 0.04, 0.1, 0.5):
        hull = cullhull.concave_hull(found, edge_length=length)
        assert hull.edge_length == length and hull.alpha == np.inf
        assert set(hull.cells.ravel().tolist()) == set(range(500))
        assert len(set(hull.ring.tolist())) == len(hull.ring) == len(hull.facets)
        ends = points[hull.facets]
        long = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) > length
        apexes = found.cells[hull.facet_cells[long]]
        for edge, cell in zip(hull.facets[long].tolist(), apexes.tolist()):
            (apex,) = set(cell) - set(edge)
            assert apex in hull.ring
    assert cullhull.concave_hull(found, 1).facets.tolist() == found.hull_facets.tolist()
    assert repr(hull).startswith("<ConcaveHull of 500 points: ")


def test_concave_hulls_of_few_points_and_refusals():
    for few in (np.zeros((0, 2)), [[1, 2]], [[0, 0], [1, 1]], np.ones((3, 3))):
        assert len(cullhull.concave_hull(few, 0.5).ring) == 0
    assert cullhull.concave_hull([[0, 0], [1, 0], [0, 1]], 0).ring.tolist() == [0, 1, 2]
    points = random_points(20, 2)
    for bad in ((), (0.5, 0.5), (-1,), (1.5,), (np.nan,), (None, -1), (None, np.nan)):
        with pytest.raises(cullhull.InvalidArgument):
            cullhull.concave_hull(points, *bad[:1], edge_length=bad[1] if len(bad) > 1 else None)
    with pytest.raises(cullhull.InvalidArgument):
        cullhull.concave_hull(random_points(20, 3), 0.5)


def test_surfaces_in_space_are_closed():
    shape = cullhull.alpha_shape(random_points(400, 3))
    edges = np.concatenate([shape.facets[:, [i, (i + 1) % 3]] for i in range(3)])
    forward = {tuple(edge) for edge in edges.tolist()}
    assert {(b, a) for a, b in forward} == forward
    assert repr(shape).startswith("<AlphaShape of 400 points in 3D: ")


def test_alpha_refusals():
    points = random_points(20, 2)
    for alpha in (-1, np.nan, "auto"):
        with pytest.raises(cullhull.InvalidArgument):
            cullhull.alpha_shape(points, alpha)
    with pytest.raises(cullhull.InvalidArgument):
        cullhull.alpha_shape(cullhull.delaunay(points, np.ones(20)))
    with pytest.raises(cullhull.InvalidArgument):
        cullhull.alpha_shape(cullhull.delaunay(points, furthest_site=True), 1)
    with pytest.raises(cullhull.InvalidArgument):
        cullhull.alpha_shape(random_points(20, 3)).polygons()


def test_few_points_have_shapes():
    for points in (np.zeros((0, 2)), [[1, 2]], [[0, 0], [1, 1]], np.ones((3, 3))):
        shape = cullhull.alpha_shape(points, "all-points")
        assert shape.polygons() == [] and len(shape.facets) == len(shape.facet_cells)


# Graphs


def test_graphs_contain_each_other():
    csgraph = pytest.importorskip("scipy.sparse.csgraph")
    for d in (2, 3):
        points = random_points(250, d)
        length = np.linalg.norm(points[:, None] - points[None], axis=2)
        found = cullhull.delaunay(points)
        tree = cullhull.minimum_spanning_tree(found)
        assert tree.shape == (249, 2) and tree.dtype == np.int32
        theirs = csgraph.minimum_spanning_tree(length)
        assert length[tree[:, 0], tree[:, 1]].sum() == pytest.approx(theirs.sum())
        sets = [
            {tuple(edge) for edge in edges.tolist()}
            for edges in (
                tree,
                cullhull.relative_neighbourhood_graph(points),
                cullhull.gabriel_graph(points, threads=1),
            )
        ]
        assert sets[0] < sets[1] < sets[2]
        for a, b in sets[2]:
            middle = np.linalg.norm(points - (points[a] + points[b]) / 2, axis=1)
            middle[[a, b]] = np.inf
            assert middle.min() > length[a, b] / 2
        for a, b in sets[1]:
            assert np.delete(np.maximum(length[a], length[b]), [a, b]).min() >= length[a, b]


def test_trees_span_duplicates():
    tree = cullhull.minimum_spanning_tree([[0, 0], [1, 0], [0, 0], [0, 0]])
    assert tree.tolist() == [[0, 1], [0, 2], [0, 3]]
    assert cullhull.gabriel_graph([[0, 0], [1, 0], [0, 0]]).tolist() == [[0, 1]]
    assert cullhull.minimum_spanning_tree(np.zeros((0, 2))).shape == (0, 2)
    with pytest.raises(cullhull.InvalidArgument):
        cullhull.gabriel_graph(cullhull.delaunay(random_points(9, 2), furthest_site=True))


# Constrained edges


def test_constrained_as_triangle_has_it():
    triangle = pytest.importorskip("triangle")
    angle = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    radius = np.where(np.arange(60) % 2, 1.0, 0.4)
    ring = np.stack([np.cos(angle) * radius, np.sin(angle) * radius], axis=1)
    points = np.concatenate([ring, random_points(300, 2) * 2 - 1])
    edges = np.stack([np.arange(60), np.roll(np.arange(60), -1)], axis=1)
    ours = cullhull.constrained_delaunay(points, edges, certify=True)
    theirs = triangle.triangulate({"vertices": points, "segments": edges}, "pc")
    assert {tuple(sorted(cell)) for cell in ours.cells.tolist()} == {
        tuple(sorted(cell)) for cell in theirs["triangles"].tolist()
    }
    assert ours.certificate
    inside = cullhull.constrained_delaunay(points, edges, inside_only=True, certify=True)
    holes = triangle.triangulate({"vertices": points, "segments": edges}, "p")
    assert {tuple(sorted(cell)) for cell in inside.cells.tolist()} == {
        tuple(sorted(cell)) for cell in holes["triangles"].tolist()
    }


def test_constrained_cuts_and_insides():
    square = [[0, 0], [4, 0], [4, 4], [0, 4], [2, 2], [9, 9]]
    ring = [[0, 1], [1, 2], [2, 3], [3, 0]]
    found = cullhull.constrained_delaunay(square, [[0, 2], *ring])
    assert found.pieces.tolist() == [[0, 1], [0, 3], [0, 4], [1, 2], [2, 3], [2, 4]]
    assert found.piece_sources.tolist() == [1, 4, 0, 2, 3, 0]
    assert sorted(found.depths.tolist()) == [0, 0, 1, 1, 1, 1]
    inside = cullhull.constrained_delaunay(square, ring, inside_only=True)
    assert inside.cells.tolist() == [[0, 1, 4], [0, 4, 3], [1, 2, 4], [2, 3, 4]]
    assert inside.hidden.tolist() == [5] and len(inside.hull_facets) == 4
    assert inside.neighbours.min() == -1 and inside.duplicates.shape == (0, 2)
    assert len(inside.hull_cells) == 4 and inside.points is not None


def test_constrained_refusals():
    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    for edges, error in (
        ([[0, 2], [1, 3]], "edges 0 (0, 2) and 1 (1, 3) cross"),
        ([[0, 4]], "there is no point 4 among 4"),
        ([[0, -1]], "there is no point -1 among 4"),
        ([0, 1], "`edges` should be pairs of points, not of shape (2,)"),
    ):
        with pytest.raises(cullhull.InvalidArgument) as caught:
            cullhull.constrained_delaunay(square, edges)
        assert str(caught.value) == error
    with pytest.raises(TypeError):
        cullhull.constrained_delaunay(square, [[0.5, 1]])
    with pytest.raises(cullhull.InvalidArgument):
        cullhull.constrained_delaunay(random_points(9, 3), [])
    assert len(cullhull.constrained_delaunay(square, []).cells) == 2


# Natural neighbours


def test_natural_neighbours_keep_what_is_linear():
    for d in (2, 3):
        points = random_points(300, d)
        slope = np.arange(2.0, 2 + d)
        ask = 0.2 + 0.6 * random_points(500, d, 1)
        of = cullhull.NaturalNDInterpolator(points, points @ slope)
        np.testing.assert_allclose(of(ask), ask @ slope, rtol=1e-13)
        np.testing.assert_array_equal(of(points), points @ slope)
        ids, weights = of.neighbours(ask[0])
        assert weights.min() > 0 and abs(weights.sum() - 1) <= len(ids) * 2.0**-51
        assert of(ask[0]) == pytest.approx(weights @ (points @ slope)[ids])
        assert np.isnan(of([[9.0] * d])).all() and len(of.neighbours([9.0] * d)[0]) == 0


def test_natural_neighbours_of_any_values():
    points = random_points(60, 2)
    ask = 0.3 + 0.4 * random_points(12, 2, 1).reshape(3, 4, 2)
    values = random_points(60, 6, 2).reshape(60, 2, 3)
    both = cullhull.NaturalNDInterpolator(points, values + 1j * values[::-1], threads=2)
    found = both(ask)
    assert found.shape == (3, 4, 2, 3) and found.dtype == np.complex128
    one = cullhull.NaturalNDInterpolator(points, values[:, 1, 2])(ask)
    np.testing.assert_allclose(found[..., 1, 2].real, one, rtol=1e-15)
    np.testing.assert_array_equal(
        cullhull.griddata(points, values[:, 1, 2], ask, method="natural"), one
    )
    stretched = cullhull.NaturalNDInterpolator(points * [1, 100], values[:, 1, 2], rescale=True)
    assert stretched(ask * [1, 100]).shape == (3, 4)
    with pytest.raises(cullhull.InvalidArgument):
        cullhull.NaturalNDInterpolator(random_points(30, 4), np.zeros(30))([[0.5] * 4])
    with pytest.raises(cullhull.InvalidArgument):
        both.neighbours(ask)


# SciPy's class in the place of a triangulation

OF_TRIANGULATIONS = {
    "alpha_radii": cullhull.alpha_radii,
    "alpha_shape": lambda t: cullhull.alpha_shape(t, 0.2).cells,
    "concave_hull": lambda t: cullhull.concave_hull(t, 0.3).ring,
    "gabriel_graph": cullhull.gabriel_graph,
    "minimum_spanning_tree": cullhull.minimum_spanning_tree,
    "relative_neighbourhood_graph": cullhull.relative_neighbourhood_graph,
    "voronoi": lambda t: cullhull.voronoi(t).vertices,
    "LinearNDInterpolator": lambda t: cullhull.LinearNDInterpolator(t, t.points[:, 0])(0.5, 0.5),
    "NaturalNDInterpolator": lambda t: cullhull.NaturalNDInterpolator(t, t.points[:, 0])(0.5, 0.5),
}


@pytest.mark.parametrize("name", OF_TRIANGULATIONS)
def test_the_class_in_scipys_place_is_taken_as_a_triangulation(name):
    points = random_points(100, 2)
    ours, use = cullhull.Delaunay(points), OF_TRIANGULATIONS[name]
    assert np.array_equal(use(ours), use(cullhull.delaunay(points)))
    ours = cullhull.Delaunay(points[:50], incremental=True)
    ours.add_points(points[50:])
    assert np.array_equal(use(ours), use(cullhull.delaunay(points)))


def test_every_function_of_triangulations_is_tried_with_that_class():
    known = {
        name
        for name in cullhull.__all__
        if callable(thing := getattr(cullhull, name))
        and "`Delaunay`" in (thing.__doc__ or "").partition("values :")[0].partition("Returns")[0]
        and "points : (n, d) array" in thing.__doc__
    }
    assert known == set(OF_TRIANGULATIONS)


def test_triangulations_of_the_furthest_site_are_refused_by_either_name():
    points = random_points(30, 2)
    for made in (cullhull.delaunay, cullhull.Delaunay):
        found = made(points, furthest_site=True)
        for use in (cullhull.alpha_shape, cullhull.gabriel_graph):
            with pytest.raises(cullhull.InvalidArgument):
                use(found)
        with pytest.raises(cullhull.InvalidArgument, match="its kind already"):
            cullhull.voronoi(found, furthest_site=True)
        assert len(cullhull.voronoi(found).vertices)


def test_area_and_perimeter_of_shapes():
    ring = [(x, y) for x in range(7) for y in range(7) if (x, y) != (3, 3)]
    shape = cullhull.alpha_shape(ring, 0.71)
    assert shape.area == 34.0 and np.isclose(shape.perimeter, 24 + 4 * 2**0.5, rtol=1e-15)
    hull = cullhull.concave_hull(ring, 1.0)
    assert (hull.area, hull.perimeter) == (36.0, 24.0)
    assert "perimeter" in shape._repr_html_() and "perimeter" in hull._repr_html_()
    cube = np.array([(x, y, z) for x in range(3) for y in range(3) for z in range(3)])
    solid = cullhull.alpha_shape(cube)
    assert (solid.volume, solid.area) == (8.0, 24.0)
    assert "volume" in solid._repr_html_()
    flat = cullhull.alpha_shape(np.column_stack([ring, np.ones(len(ring))]), 0.71)
    assert (flat.area, flat.perimeter, flat.volume) == (shape.area, shape.perimeter, 0.0)
    for few in (np.empty((0, 2)), [[1, 2]], [[0, 0], [1, 1], [3, 3]]):
        shape = cullhull.alpha_shape(few)
        assert (shape.area, shape.perimeter) == (0.0, 0.0)
    for attribute, points in (("volume", ring), ("perimeter", cube), ("area", np.eye(5))):
        with pytest.raises(cullhull.InvalidArgument, match="shapes in"):
            getattr(cullhull.alpha_shape(points), attribute)
    shapely = pytest.importorskip("shapely")
    rng = np.random.default_rng(8)
    for scale in (1e-3, 1.0, 1e5):
        points = rng.normal(size=(500, 2)) * scale
        for shape in (cullhull.alpha_shape(points, 0.3 * scale), cullhull.concave_hull(points, 0.1)):
            drawn = shapely.geometry.shape(shape.__geo_interface__)
            assert np.isclose(shape.area, drawn.area, rtol=1e-12)
            assert np.isclose(shape.perimeter, drawn.length, rtol=1e-12)


def test_shapes_are_refused_beyond_the_memory_budget():
    points = cullhull.generate("ball", 20000, 3)
    calls = (
        lambda **o: cullhull.alpha_shape(points, **o),
        lambda **o: cullhull.concave_hull(points[:, :2], 0.1, **o),
        lambda **o: cullhull.alpha_radii(points, **o),
    )
    for call in calls:
        with pytest.raises(cullhull.OutOfBudget):
            call(memory_budget=1000)
        call(memory_budget=1 << 30)
