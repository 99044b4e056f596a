"""Interpolation between scattered points, against SciPy's."""

import copy
import inspect
import pickle
from fractions import Fraction

import numpy as np
import pytest

import cullhull

interpolate = pytest.importorskip("scipy.interpolate")
NAMES = ("LinearNDInterpolator", "NearestNDInterpolator")


def values_of(points, kind):
    real = np.sin(3 * points).sum(axis=1)
    if kind == "complex":
        return real + 1j * points[:, 0]
    return np.stack([real, points[:, 0] ** 2], axis=1) if kind == "rows" else real


@pytest.mark.parametrize("kind", ["real", "complex", "rows"])
@pytest.mark.parametrize("rescale", [False, True])
@pytest.mark.parametrize("dimension", [2, 3, 4])
@pytest.mark.parametrize("name", NAMES)
def test_as_scipys(name, dimension, rescale, kind):
    rng = np.random.default_rng(dimension)
    points = rng.random((200, dimension)) * np.arange(1, dimension + 1)
    values = values_of(points, kind)
    asked = rng.random((4, 50, dimension)) * dimension
    ours = getattr(cullhull, name)(points, values, rescale=rescale)(asked)
    theirs = getattr(interpolate, name)(points, values, rescale=rescale)(asked)
    assert ours.shape == theirs.shape and ours.dtype == theirs.dtype
    assert np.array_equal(np.isnan(ours), np.isnan(theirs))
    assert np.allclose(ours, theirs, rtol=1e-9, equal_nan=True)
    assert np.isnan(ours).any() == (name == "LinearNDInterpolator")


def test_griddata_takes_the_same_arguments():
    mine, other = (list(inspect.signature(m.griddata).parameters) for m in (cullhull, interpolate))
    assert mine[: len(other)] == other


@pytest.mark.parametrize("method", ["linear", "nearest", "cubic"])
@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_griddata(method, dimension):
    rng = np.random.default_rng(dimension)
    points = rng.random((100, dimension))
    columns = tuple(points.T)
    values = values_of(points, "real")
    asked = tuple(np.meshgrid(*[np.linspace(0, 1, 9)] * dimension))
    if dimension == 3 and method == "cubic":
        with pytest.raises(ValueError, match="cubic"):
            cullhull.griddata(points, values, asked, method)
        return
    for given in (points, columns):
        ours = cullhull.griddata(given, values, asked, method, fill_value=-7)
        theirs = interpolate.griddata(given, values, asked, method, fill_value=-7)
        assert ours.shape == theirs.shape and np.allclose(ours, theirs)
    with pytest.raises(ValueError, match="magic"):
        cullhull.griddata(points, values, asked, "magic")
    for tolerance in (0, -1, np.nan):
        with pytest.raises(ValueError, match="simplex_tolerance must be positive"):
            cullhull.griddata(points, values, asked, method, simplex_tolerance=tolerance)


def test_linear_is_linear():
    """A linear function comes back, and corners come back as they are."""
    points = np.random.default_rng(1).random((500, 3))
    values = points @ [1.0, -2.0, 0.5] + 3
    found = cullhull.LinearNDInterpolator(points, values)
    asked = np.random.default_rng(2).random((1000, 3))
    inside = found.tri.find_simplex(asked) >= 0
    assert np.allclose(found(asked)[inside], asked[inside] @ [1.0, -2.0, 0.5] + 3, rtol=1e-13)
    assert np.isnan(found(asked)[~inside]).all() and not inside.all()
    assert np.array_equal(found(points), values)


def test_triangulations_as_input():
    points = np.random.default_rng(1).random((30, 2))
    values = points[:, 0]
    drop_in, native = cullhull.Delaunay(points), cullhull.delaunay(points)
    expected = cullhull.LinearNDInterpolator(points, values)([0.4, 0.5])
    for given in (drop_in, native):
        assert cullhull.LinearNDInterpolator(given, values)([0.4, 0.5]) == expected
        with pytest.raises(ValueError, match="Rescaling"):
            cullhull.LinearNDInterpolator(given, values, rescale=True)
    assert cullhull.LinearNDInterpolator(drop_in, values).tri is drop_in
    with pytest.raises(ValueError):
        cullhull.LinearNDInterpolator(cullhull.delaunay(points * [1, 0]), values)


def test_nearest_is_exact_and_the_first():
    points = np.array([[1.0, 0], [0, 1], [-1, 0], [0, -1], [1, 0]])
    found = cullhull.NearestNDInterpolator(points, np.arange(5))
    assert found([[0, 0], [9, 0], [-9, 1e-9]]).tolist() == [0, 0, 2]
    assert found(0.1, [0.2, 0.0]).tolist() == [1, 0]
    assert np.isnan(found([[0, 0]], distance_upper_bound=1.0)).all()
    assert found([[0.5, 0.4]], p=np.inf).tolist() == [0]
    line = cullhull.NearestNDInterpolator([[0, 0], [1, 1], [2, 2]], [1, 2, 3])
    assert line([[5, 0], [-1, -1]]).tolist() == [3, 1]
    many = np.random.default_rng(1).random((50, 9))
    assert np.array_equal(cullhull.NearestNDInterpolator(many, np.arange(50))(many), np.arange(50))
    with pytest.raises(TypeError):
        found([0.5, 0.5], query_options="not a dictionary")


def nearest_exactly(points, asked):
    """By fractions, the lowest of several."""
    rows = [[Fraction(x) for x in row] for row in points.tolist()]
    found = []
    for q in asked.tolist():
        q = [Fraction(x) for x in q]
        away = [sum((a - b) ** 2 for a, b in zip(row, q)) for row in rows]
        found.append(away.index(min(away)))
    return found


SETS = {
    "spread": lambda rng, d: (rng.random((90, d)), rng.random((60, d)) * 1.5 - 0.25),
    "grid": lambda rng, d: (rng.integers(0, 4, (90, d)) * 1.0, rng.integers(0, 9, (60, d)) / 2),
    "equal": lambda rng, d: (np.repeat(rng.random((9, d)), 9, axis=0), rng.random((60, d))),
    "far away": lambda rng, d: (
        rng.integers(0, 4, (90, d)) + 2.0**52,
        rng.random((60, d)) + 2.0**52,
    ),
    "a last bit apart": lambda rng, d: (
        1 + rng.integers(0, 2, (90, d)) * 2.0**-52,
        1 + rng.integers(-3, 4, (60, d)) * 2.0**-53,
    ),
    "tiny": lambda rng, d: (rng.random((20, d)) * 1e-310, rng.random((9, d)) * 1e-310),
    "tiny and not": lambda rng, d: (
        np.vstack([rng.random((9, d)) * 1e-200, rng.random((9, d))]),
        rng.random((9, d)) * 1e-200,
    ),
    "huge": lambda rng, d: (rng.random((20, d)) * 1e300, rng.random((9, d)) * 1e300),
}


@pytest.mark.parametrize("dimension", [2, 3, 4])
@pytest.mark.parametrize("name", SETS)
def test_nearest_points_are_exact(name, dimension):
    points, asked = SETS[name](np.random.default_rng(dimension), dimension)
    found = cullhull.NearestNDInterpolator(points, np.arange(len(points)))
    wanted = nearest_exactly(points, asked)
    assert found(asked).astype(int).tolist() == wanted
    assert [int(found(q)[0]) for q in asked[:5]] == wanted[:5]
    triangulation = cullhull.delaunay(points)
    assert triangulation.nearest(asked).tolist() == wanted
    assert triangulation.nearest(asked[0]) == wanted[0]


@pytest.mark.parametrize("dimension", [5, 6, 7, 8])
def test_nearest_points_are_exact_in_more_dimensions(dimension):
    rng = np.random.default_rng(dimension)
    points = rng.integers(0, 3, (300, dimension)) * 1.0
    asked = rng.integers(0, 5, (40, dimension)) / 2
    found = cullhull.NearestNDInterpolator(points, np.arange(300))
    assert found(asked).astype(int).tolist() == nearest_exactly(points, asked)


def test_nearest_points_of_any_layout_and_many():
    rng = np.random.default_rng(1)
    points = rng.integers(-20, 20, (500, 3)).astype(np.int8)
    asked = rng.integers(-50, 50, (70_000, 3)) / np.float32(2)
    wanted = cullhull.delaunay(points.astype(float)).nearest(asked.astype(float), threads=1)
    assert np.array_equal(wanted[:200], nearest_exactly(points, asked[:200]))
    for given in (points, np.asfortranarray(points), points.repeat(2, axis=1)[:, ::2]):
        found = cullhull.delaunay(given)
        for threads in (1, 3):
            assert np.array_equal(found.nearest(np.asfortranarray(asked), threads=threads), wanted)
    reports = []
    found.nearest(asked, progress=lambda phase, share: reports.append((phase, share)))
    assert reports[-1] == ("query", 1.0) and {phase for phase, _ in reports} == {"query"}
    with pytest.raises(cullhull.NotFinite, match="3"):
        found.nearest([[0, 0, 0], [0, 0, 1], [0, 1, 0], [0, 0, np.nan]])
    with pytest.raises(cullhull.InvalidArgument, match="dimension 3"):
        found.nearest([[0, 0]])


def test_nearest_points_are_copied_without_their_tree():
    points = np.random.default_rng(1).random((50, 3))
    found = cullhull.NearestNDInterpolator(points, np.arange(50))
    for again in (copy.copy(found), copy.deepcopy(found), pickle.loads(pickle.dumps(found))):
        assert np.array_equal(again(points), np.arange(50))
    assert not any(isinstance(x, cullhull._core.NearestTree) for x in found.__getstate__().values())
    points[7] = np.nan
    with pytest.raises(cullhull.NotFinite, match="point 7"):
        cullhull.NearestNDInterpolator(points, points)


def test_linear_outside_and_where_nothing_is_known():
    """Some rows inside, some outside, some not finite; numbers and complex ones."""
    points = np.random.default_rng(1).random((40, 2))
    asked = np.array([[0.5, 0.5], [9, 9], [np.nan, 0], [0.4, 0.6], [np.inf, 1]])
    for values, fill in ((points, 7.0), (points @ [1, 1j], 7 - 2j)):
        found = cullhull.LinearNDInterpolator(points, values, fill_value=fill)(asked)
        assert np.allclose(found[[0, 3]], asked[[0, 3]] if fill == 7 else asked[[0, 3]] @ [1, 1j])
        assert (found[[1, 2, 4]] == fill).all()
        none = cullhull.LinearNDInterpolator(points, values, fill_value=fill)(asked[[1, 2]])
        assert (none == fill).all()


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
@pytest.mark.parametrize("name", NAMES)
def test_copies_and_pickles(name, way):
    points = np.random.default_rng(1).random((30, 2))
    found = getattr(cullhull, name)(points, points[:, 0], rescale=True)
    assert way(found)(0.5, 0.5) == found(0.5, 0.5)


@pytest.mark.parametrize("name", NAMES)
def test_what_makes_no_sense(name):
    make = getattr(cullhull, name)
    points = np.random.default_rng(1).random((30, 2))
    for bad, values in (
        (points, points[:7, 0]),
        (points, 3.0),
        (points[:, :1], points[:, 0]),
        (np.zeros((0, 2)), []),
        (points * np.nan, points[:, 0]),
        (points[:, np.newaxis], points[:, 0]),
    ):
        with pytest.raises(ValueError):
            make(bad, values)
    found = make(points, points[:, 0])
    for bad in ([0.5], [0.5] * 3, 0.5):
        with pytest.raises(ValueError):
            found(bad)
    assert found(np.zeros((0, 2))).shape == (0,)


@pytest.mark.parametrize("kind", [cullhull.LinearNDInterpolator, cullhull.NaturalNDInterpolator])
def test_only_delaunay_triangulations_interpolate(kind):
    points = np.random.default_rng(1).random((50, 2))
    values = points[:, 0]
    furthest = cullhull.delaunay(points, furthest_site=True)
    weighted = cullhull.delaunay(points, weights=values)
    for wrong in (furthest, weighted, cullhull.Delaunay(points, furthest_site=True)):
        with pytest.raises(cullhull.InvalidArgument, match="needs a Delaunay triangulation"):
            kind(wrong, values)


def test_natural_neighbours_just_outside_have_the_border_s_value():
    """As SciPy's linear interpolation: what rounding alone puts outside. Farther, the fill value."""
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    height = cullhull.NaturalNDInterpolator(square, [1.0, 2.0, 3.0, 4.0], fill_value=-7)
    just_outside = [[-1e-15, 0.5], [0.5, 1 + 2e-16 * 2], [1 + 3e-16, 0.25]]
    assert np.allclose(height(just_outside), [2.5, 3.5, 2.25], rtol=0, atol=1e-14)
    assert height([[-1e-12, 0.5], [0.5, 1.1]]).tolist() == [-7, -7]


def test_griddata_in_its_place(monkeypatch):
    scipy_interpolate = pytest.importorskip("scipy.interpolate")
    line, square = np.array([0.0, 1.0, 2.0]), np.random.default_rng(2).random((20, 2))
    expected = scipy_interpolate.griddata(line, line, [0.5], "linear")
    smooth = scipy_interpolate.griddata(square, square[:, 0], [[0.5, 0.5]], "cubic")
    monkeypatch.setattr(scipy_interpolate, "griddata", cullhull.griddata)
    assert cullhull.griddata(line, line, [0.5], "linear") == expected
    assert cullhull.griddata(square, square[:, 0], [[0.5, 0.5]], "cubic") == smooth


@pytest.mark.parametrize("made", [lambda p: p, cullhull.Delaunay, cullhull.delaunay])
def test_natural_neighbours_in_four_dimensions_are_refused_when_made(made):
    points = np.random.default_rng(1).random((30, 4))
    with pytest.raises(cullhull.InvalidArgument, match="up to 3 dimensions, not in 4"):
        cullhull.NaturalNDInterpolator(made(points), points[:, 0])


def test_trees_are_made_when_they_are_asked_for():
    points = np.random.default_rng(1).random((30, 3))
    found = cullhull.NearestNDInterpolator(points, points, tree_options={"leafsize": 5})
    assert "tree" not in vars(found) and found(points[:1]).tolist() == points[:1].tolist()
    assert "tree" not in vars(found)
    assert found.tree is found.tree and found.tree.leafsize == 5
    assert "tree" not in vars(pickle.loads(pickle.dumps(found)))


def test_values_can_be_replaced_as_in_scipys():
    """A row of numbers for each point, whatever the shape of a value."""
    points = np.random.default_rng(1).random((30, 2))
    for kind in (cullhull.LinearNDInterpolator, interpolate.LinearNDInterpolator):
        found = kind(points, points[:, 0])
        found.values = points[:, 1:].copy()
        assert np.allclose(found(0.5, 0.25), 0.25)
        found.values[:] = 7
        assert np.allclose(found([[0.5, 0.25]]), [7.0])


@pytest.mark.parametrize("name", (*NAMES, "NaturalNDInterpolator"))
@pytest.mark.parametrize("shape", [(0,), (2, 0), (3, 1, 2)])
def test_values_of_any_shape(name, shape):
    points = np.random.default_rng(1).random((30, 2))
    make = getattr(cullhull, name)
    if name == "NaturalNDInterpolator" and 0 in shape:
        with pytest.raises(cullhull.InvalidArgument, match="at least one component"):
            make(points, np.ones((30, *shape)))
        return
    found = make(points, np.ones((30, *shape)))
    assert found([[0.5, 0.25]] * 4).shape == (4, *shape) and found.values_shape == shape
    assert found(np.zeros((0, 2))).shape == (0, *shape)


def test_natural_neighbours_on_the_border_have_the_border_s_value():
    """The middles of hull edges, of which rounding puts half outside: linear between the ends."""
    rng = np.random.default_rng(2)
    for offset in (0.0, 1000.0):
        points = rng.random((200, 2)) + offset
        values = rng.random(200)
        natural = cullhull.NaturalNDInterpolator(points, values)
        ends = natural.tri.convex_hull
        for share in (0.5, 0.3):
            middles = points[ends[:, 0]] + share * (points[ends[:, 1]] - points[ends[:, 0]])
            exact = values[ends[:, 0]] + share * (values[ends[:, 1]] - values[ends[:, 0]])
            outside = natural.tri.triangulation.find_simplex(middles) < 0
            assert 0 < outside.sum() < len(middles)
            assert np.allclose(natural(middles), exact, rtol=0, atol=1e-9)
            complex_values = cullhull.NaturalNDInterpolator(points, values * (1 + 2j))
            assert np.allclose(complex_values(middles), exact * (1 + 2j), rtol=0, atol=1e-9)
            for middle, pair in zip(middles[outside], ends[outside]):
                ids, weights = natural.neighbours(middle)
                assert set(pair) <= set(ids) and abs(weights.sum() - 1) < 1e-12
        assert np.isnan(natural(points.mean(axis=0) + 2))


def test_natural_neighbours_on_faces_of_a_turned_cube():
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    corners = np.array([[x, y, z] for x in (0, 1, 2) for y in (0, 1, 2) for z in (0, 1, 2)])
    values = corners @ [1.0, 2.0, 3.0]  # linear, so every weighting of a face gives it
    natural = cullhull.NaturalNDInterpolator(corners @ turn, values)
    asked = np.random.default_rng(6).random((300, 3)) * 2
    asked[np.arange(300), np.arange(300) % 3] = 2.0 * (np.arange(300) // 3 % 2)
    assert (natural.tri.triangulation.find_simplex(asked @ turn) < 0).any()
    assert np.allclose(natural(asked @ turn), asked @ [1, 2, 3], rtol=0, atol=1e-9)


@pytest.mark.parametrize("tolerance", [0, -1, np.nan])
def test_simplex_tolerance_is_positive(tolerance):
    points = [[0, 0], [1, 0], [0, 1]]
    for kind in (cullhull.LinearNDInterpolator, cullhull.NaturalNDInterpolator):
        with pytest.raises(cullhull.InvalidArgument, match="simplex_tolerance must be positive"):
            kind(points, [1, 2, 3])(0.2, 0.2, simplex_tolerance=tolerance)


def test_simplex_tolerance_as_scipy_s():
    """The border of a very oblique triangle, from SciPy's own tests: never NaN here, as what is
    inside is found exactly and 1e-14 outside within the tolerance."""
    corners = np.array([[0, 0], [0, 0.008016], [3, -2.0]])
    for kind in (cullhull.LinearNDInterpolator, cullhull.NaturalNDInterpolator):
        ones = kind(corners, np.ones(3))
        at = corners[0] + 0.6 * (corners[2] - corners[0])
        assert np.isclose(ones(*at, simplex_tolerance=10), 1)
        assert np.isnan(ones(at - [1e-9, 0]))
        assert np.isclose(ones(at - [1e-9, 0], simplex_tolerance=1e9), 1)
        assert np.isclose(
            cullhull.griddata(
                corners,
                np.ones(3),
                [at - [1e-9, 0]],
                "linear" if kind is cullhull.LinearNDInterpolator else "natural",
                simplex_tolerance=1e9,
            ),
            1,
        )


@pytest.mark.parametrize("kind", [cullhull.LinearNDInterpolator, cullhull.NaturalNDInterpolator])
def test_of_a_tolerant_triangulation(kind):
    """Its simplices are numbered without those that it dropped."""
    rows = [[0, 0], [1, 1e-17], [2, 0], [1, 1], [0, 1], [2, 1], [0.3, 0.4], [1.5, 0.7]]
    points, asked = np.array(rows), np.random.default_rng(1).random((200, 2)) * [2, 1]
    tolerant = cullhull.TolerantDelaunay(points)
    assert tolerant.dropped == 1
    asked = np.vstack([asked, [[0.5, 0], [1.5, 0], [2 + 1e-15, 0.5], [1, 1]]])
    assert np.allclose(kind(tolerant, points @ [1, 2])(asked), asked @ [1, 2], rtol=0, atol=1e-12)
