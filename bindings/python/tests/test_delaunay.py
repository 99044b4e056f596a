"""Triangulations: the native face, and Delaunay against SciPy's, attribute by attribute."""

import copy
import itertools
import pickle
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from reference import determinant
from test_drop_in import assert_same_hull, rows_by_corners

import cullhull

spatial = pytest.importorskip("scipy.spatial")

GRID = np.array([[x, y, z] for x in range(3) for y in range(3) for z in range(3)], dtype=float)


def cells_by_definition(points):
    """Sets of points on empty spheres, maximal ones, in rational numbers."""
    exact = [[Fraction(float(x)) for x in row] for row in points]
    lifted = [[*row, sum(x * x for x in row)] for row in exact]
    d = len(exact[0])
    found = set()
    for corner in itertools.combinations(range(len(exact)), d + 1):
        edges = [[a - b for a, b in zip(exact[i], exact[corner[0]])] for i in corner[1:]]
        turn = determinant(edges)
        if turn == 0:
            continue
        sides = [
            determinant([[a - b for a, b in zip(lifted[i], lifted[corner[0]])]
                         for i in (*corner[1:], q)]) * turn
            for q in range(len(exact))
        ]  # fmt: skip
        if min(sides) >= 0:
            found.add(frozenset(i for i, side in enumerate(sides) if side == 0))
    return found


@pytest.mark.parametrize("dimension", [1, 2, 3])
@pytest.mark.parametrize("side", [None, 3])
def test_cells_are_those_of_the_definition(dimension, side):
    rng = np.random.default_rng(dimension)
    for n in (dimension + 1, dimension + 2, 9):
        points = rng.random((n, dimension)) if side is None else rng.permutation(
            np.indices((side,) * dimension).reshape(dimension, -1).T)[:n]  # fmt: skip
        found = cullhull.delaunay(points, certify=True)
        assert found.certificate and found.certify()
        if found.affine_dimension < dimension:
            continue
        groups = {}
        for group, cell in zip(found.cell_groups.tolist(), found.cells.tolist()):
            groups.setdefault(group, set()).update(cell)
        assert {frozenset(g) for g in groups.values()} == cells_by_definition(points)


def test_arrays_are_views():
    points = cullhull.generate("ball", 1000, 3)
    found = cullhull.delaunay(points)
    assert found.points is points and found.weights is None
    for name in ("cells", "neighbours", "hull_facets", "hull_cells", "duplicates", "hidden", "axes"):
        array = getattr(found, name)
        assert array.dtype == np.int32 and not array.flags.writeable
        with pytest.raises(ValueError):
            array[...] = 0
    assert np.shares_memory(found.cells, found.cells)
    assert found.cells.shape == found.neighbours.shape == (found.cell_count, 4) == (len(found), 4)
    cells = found.cells
    del found
    assert cells.max() == 999 and cells.min() == 0
    found = cullhull.delaunay(points)
    inside = found.neighbours >= 0
    assert (~inside).sum() == len(found.hull_facets) == len(found.hull_cells)
    for cell in range(0, len(cells), 97):
        for corner, other in zip(cells[cell], found.neighbours[cell]):
            if other >= 0:
                assert set(cells[cell]) - {corner} <= set(cells[other])
                assert cell in found.neighbours[other]


def test_same_for_any_layout_and_threads():
    points = cullhull.generate("ball", 2000, 3).astype(np.float32)
    found = cullhull.delaunay(points)
    others = (
        cullhull.delaunay(points.astype(np.float64), threads=1),
        cullhull.delaunay(np.asfortranarray(points), threads=3),
        cullhull.delaunay(points, np.zeros(2000)),
        cullhull.delaunay(np.repeat(points, 2, axis=1)[:, ::2]),
    )
    for other in others:
        assert np.array_equal(found.cells, other.cells)
        assert np.array_equal(found.neighbours, other.neighbours)


def test_weights():
    square = np.array([[0, 0], [2, 0], [2, 2], [0, 2], [1, 1], [1, 1]])
    found = cullhull.delaunay(square, [0, 0, 0, 0, -1, -3], certify=True)
    assert found.hidden.tolist() == [] and found.duplicates.tolist() == [[5, 4]]
    found = cullhull.delaunay(square, [0, 0, 0, 0, -2, -3])  # exactly on the face
    assert found.hidden.tolist() == [4] and found.vertex_count == 4
    assert "Regular" in repr(found)
    for wrong in ([1.0], np.zeros((6, 1)), [np.nan] * 6, ["a"] * 6):
        with pytest.raises((ValueError, TypeError)):
            cullhull.delaunay(square, wrong)


@pytest.mark.parametrize("n", [0, 1, 2, 3])
@pytest.mark.parametrize("dimension", [1, 2, 3, 4])
def test_few_points_and_flats(n, dimension):
    rng = np.random.default_rng(n)
    found = cullhull.delaunay(rng.random((n, dimension)), certify=True)
    assert found.affine_dimension == min(n - 1, dimension)
    assert len(found) == (n if n < 2 else n - 1 if dimension == 1 else 1)
    equal = cullhull.delaunay(np.ones((n, dimension)), certify=True)
    assert equal.affine_dimension == (0 if n else -1) and len(equal.duplicates) == max(n - 1, 0)
    flat = np.column_stack([rng.random((20, dimension)), np.ones(20)])
    found = cullhull.delaunay(flat, certify=True)
    assert found.affine_dimension == dimension and "(" in repr(found)
    assert np.array_equal(found.cells, cullhull.delaunay(flat[:, :-1]).cells)


@pytest.mark.parametrize("bad", [np.zeros(3), np.zeros((2, 2, 2)), [[np.nan, 0]], [["a", "b"]]])
def test_what_no_points_are(bad):
    for make in (cullhull.delaunay, cullhull.Delaunay):
        with pytest.raises((ValueError, TypeError)):
            make(bad)


def test_errors_and_interruption():
    with pytest.raises(TypeError):
        cullhull.Triangulation()
    with pytest.raises(MemoryError):
        cullhull.delaunay(cullhull.generate("ball", 100_000), memory_budget=1000)
    with pytest.raises(ZeroDivisionError):
        cullhull.delaunay(cullhull.generate("ball", 200_000), progress=lambda *_: 1 / 0)


WAYS = [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))]


@pytest.mark.parametrize("way", WAYS)
def test_copies_and_pickles(way):
    for points, weights in (
        (cullhull.generate("ball", 300, 3), None),
        (cullhull.generate("ball", 300, 2), np.linspace(0, 1, 300)),
        (np.vstack([GRID, GRID]).astype(np.int32), None),
        (np.column_stack([GRID[:, :2], np.ones(27)]), None),
        (np.zeros((0, 3)), None),
    ):
        found = cullhull.delaunay(points, weights, certify=True)
        again = way(found)
        for name in ("points", "cells", "neighbours", "cell_groups", "hull_facets", "hull_cells",
                     "duplicates", "hidden", "axes"):  # fmt: skip
            a, b = getattr(again, name), getattr(found, name)
            assert np.array_equal(a, b) and a.dtype == b.dtype, name
        assert again.certificate and again.certify() and again.statistics == found.statistics
        assert repr(again) == repr(found)
    drop_in = cullhull.Delaunay(GRID, incremental=True, progress=lambda *_: None)
    drop_in.simplices[:] = 0
    again = way(drop_in)
    again.add_points([[5, 5, 5]])
    assert again.npoints == 28 and drop_in.npoints == 27


def test_pickled_states_are_checked():
    from cullhull import _core

    found = cullhull.delaunay(GRID)
    for name, wrong in (
        ("cells", found.cells.ravel() + 1000),
        ("cells", found.cells.ravel()[1:]),
        ("neighbours", found.neighbours.ravel() + len(found)),
        ("hull_cells", found.hull_cells + len(found)),
        ("hidden", np.array([99], dtype=np.int32)),
        ("duplicates", np.array([99, 1], dtype=np.int32)),
        ("affine_dimension", 7),
        ("axes", np.array([0, 1], dtype=np.int32)),
        ("points", GRID[:5]),
        ("statistics", ()),
    ):
        state = dict(_core.state_of_cells(found._cells))
        assert _core.cells_of_state(state).cell_count == len(found)
        state[name] = wrong
        with pytest.raises(cullhull.InvalidArgument, match=name if name != "points" else "cells"):
            _core.cells_of_state(state)


# In the place of SciPy's


@pytest.mark.parametrize("keywords", [{}, {"furthest_site": True}, {"incremental": True}])
@pytest.mark.parametrize("dimension", [2, 3, 4, 5])
def test_every_attribute(dimension, keywords):
    points = np.random.default_rng(dimension).random((60, dimension)) + 0.25
    ours, theirs = cullhull.Delaunay(points, **keywords), spatial.Delaunay(points, **keywords)
    order = assert_same_hull(ours, theirs)
    assert np.isclose(ours.paraboloid_scale, theirs.paraboloid_scale)
    assert np.isclose(ours.paraboloid_shift, theirs.paraboloid_shift)
    assert rows_by_corners(ours.convex_hull).keys() == rows_by_corners(theirs.convex_hull).keys()
    arrays = ("simplices", "neighbors", "equations", "transform", "vertex_to_simplex", "coplanar")
    for name in (*arrays, "convex_hull", "good", "points", "min_bound", "max_bound"):
        a, b = getattr(ours, name), getattr(theirs, name)
        assert (a.dtype, a.shape) == (b.dtype, b.shape), name
        assert getattr(ours, name) is a and a.flags.writeable
    at = points[ours.simplices]
    inside = at.mean(axis=1)
    shares = np.einsum("sij,sj->si", ours.transform[:, :-1], inside - ours.transform[:, -1])
    assert np.nanmax(np.abs(shares - 1 / (dimension + 1))) < 1e-6
    for i, simplex in enumerate(ours.vertex_to_simplex):
        assert simplex == -1 and keywords or i in ours.simplices[simplex]
    offsets, neighbours = ours.vertex_neighbor_vertices
    their_offsets, their_neighbours = theirs.vertex_neighbor_vertices
    assert np.array_equal(offsets, their_offsets) and offsets.dtype == their_offsets.dtype
    for i in range(len(points)):
        ring = neighbours[offsets[i] : offsets[i + 1]].tolist()
        assert ring == sorted(their_neighbours[offsets[i] : offsets[i + 1]])
    asked = np.random.default_rng(1).random((7, dimension))
    assert np.allclose(ours.lift_points(asked), theirs.lift_points(asked))
    assert np.allclose(ours.plane_distance(asked)[:, order], theirs.plane_distance(asked), atol=1e-9)
    for name in ("ndim", "npoints", "nsimplex", "furthest_site"):
        assert getattr(ours, name) == getattr(theirs, name)


def test_duplicates_are_coplanar():
    points = np.vstack([GRID, GRID])
    ours, theirs = cullhull.Delaunay(points), spatial.Delaunay(points)
    assert ours.coplanar[:, 0].tolist() == list(range(27, 54))
    assert ours.coplanar[:, 2].tolist() == list(range(27))
    assert (ours.simplices[ours.coplanar[:, 1]] == ours.coplanar[:, 2:]).any(axis=1).all()
    assert ours.coplanar.dtype == theirs.coplanar.dtype and len(theirs.coplanar) == 27
    assert np.array_equal(ours.vertex_to_simplex[27:], ours.vertex_to_simplex[:27])
    assert cullhull.Delaunay(points, qhull_options="Qbb").coplanar.shape == (0, 3)


@pytest.mark.parametrize("options", ["Qbb Qc Qz Q12", "Qbb Qc", "Qc", "Qt Qbb Qz Qx", "d Qi"])
@pytest.mark.filterwarnings("error")
def test_options_that_work(options):
    points = np.random.default_rng(2).random((30, 3))
    ours = cullhull.Delaunay(points, qhull_options=options)
    theirs = spatial.Delaunay(points, qhull_options=options)
    assert rows_by_corners(ours.simplices).keys() == rows_by_corners(theirs.simplices).keys()
    assert np.isclose(ours.paraboloid_scale, theirs.paraboloid_scale)
    assert np.isclose(ours.paraboloid_shift, theirs.paraboloid_shift)


def test_options_that_do_not():
    points = np.random.default_rng(2).random((30, 3))
    for option in ("Qu", "QG3", "Qg", "Qb0:0B0:0", "TV1", "hello"):
        with pytest.raises(ValueError, match=option):
            cullhull.Delaunay(points, qhull_options=option)
    with pytest.raises(ValueError, match="Qz"):
        cullhull.Delaunay(points, incremental=True, qhull_options="Qz")
    for option in ("QJ", "QbB", "A0.9", "Fv"):
        with pytest.warns(cullhull.OptionWarning, match=option):
            ours = cullhull.Delaunay(points, qhull_options=option)
        assert np.array_equal(ours.simplices, cullhull.Delaunay(points).simplices)


def test_joggled():
    """Where SciPy moves each point a little, ours shows the triangulation of those given."""
    points = np.random.default_rng(1).random((10, 2))
    with pytest.warns(cullhull.OptionWarning):
        ours = cullhull.Delaunay(np.vstack([points, points]), qhull_options="QJ Qbb Pp")
    assert np.unique(ours.simplices).tolist() == list(range(10))
    flat = np.column_stack([points, np.ones(10)])
    with pytest.warns(cullhull.OptionWarning):
        ours = cullhull.Delaunay(flat, qhull_options="QJ")
    assert np.array_equal(ours.simplices, cullhull.Delaunay(points).simplices)
    assert np.isfinite(ours.equations).all()


def test_flat_input_is_an_error_as_scipys():
    flat = np.column_stack([np.random.default_rng(1).random((9, 2)), np.ones(9)])
    for points in (flat, flat[:2], np.ones((5, 2))):
        with pytest.raises(spatial.QhullError) as ours:
            cullhull.Delaunay(points)
        with pytest.raises(spatial.QhullError) as theirs:
            spatial.Delaunay(points)
        assert isinstance(ours.value, cullhull.QhullError)
        assert str(ours.value)[:40] == str(theirs.value)[:40]
    growing = cullhull.Delaunay(GRID, incremental=True)
    with pytest.raises(ValueError):
        growing.add_points([[np.nan, 0, 0]])
    with pytest.raises(ValueError):
        growing.add_points([[0, 0]])
    assert growing.npoints == 27
    growing.close()
    with pytest.raises(RuntimeError):
        growing.add_points([[1, 2, 3]])
    for nothing in (np.zeros((0, 2)), np.zeros((4, 1))):
        with pytest.raises(ValueError):
            cullhull.Delaunay(nothing)


def test_adding_is_as_at_once():
    points = cullhull.generate("ball", 200, 3)
    growing = cullhull.Delaunay(points[:50], incremental=True)
    first = growing.simplices
    with growing:
        growing.add_points(points[50:120])
        growing.add_points(points[120:], restart=True)
    whole = cullhull.Delaunay(points)
    for name in ("simplices", "neighbors", "vertex_to_simplex", "transform", "convex_hull"):
        assert np.array_equal(getattr(growing, name), getattr(whole, name)), name
    assert growing.simplices is not first
    before = points.copy()
    points[:] = 0
    assert np.array_equal(growing.points, before)


def test_far_from_the_origin():
    """The spheres' centres are those of the points shifted back, to the last digits."""
    points = np.random.default_rng(3).integers(0, 1000, (200, 2)) / 1024
    near, far = (cullhull.delaunay(points + shift) for shift in (0, 2.0**20))
    assert np.array_equal(near.cells, far.cells)
    # Of the plane of |x|^2 = 2 c x - (|c|^2 - r^2) over a cell whose sphere has centre c.
    centres = [-0.5 * found.equations[:, :2] / found.equations[:, 2:3] for found in (near, far)]
    assert np.allclose(centres[0] + 2.0**20, centres[1], rtol=1e-12)


@pytest.mark.parametrize("dimension", [2, 3, 4, 5, 6])
def test_planes_and_maps_against_rationals(dimension):
    """Of cells of every shape, with weights and in a flat, as LAPACK has them."""
    rng = np.random.default_rng(dimension)
    points = rng.normal(size=(40 if dimension < 5 else 15, dimension))
    weights = rng.random(len(points))
    for found in (cullhull.delaunay(points), cullhull.delaunay(points, weights=weights)):
        lifted = (points**2).sum(axis=1) - (0 if found.weights is None else weights)
        rows = np.column_stack([points, lifted])
        heights = np.einsum("cij,cj->ci", rows[found.cells], found.equations[:, :-1])
        size = np.abs(rows).max() * np.linalg.cond(points[found.cells[:, 1:]] - points[found.cells[:, :1]])
        assert (np.abs(heights + found.equations[:, -1:]).max(axis=1) < 1e-14 * size).all()
        assert np.allclose(np.linalg.norm(found.equations[:, :-1], axis=1), 1, rtol=1e-15)
        assert (found.equations[:, -2] < 0).all()
    ours = cullhull.Delaunay(points)
    corners = points[ours.simplices]
    expected = np.linalg.inv(np.swapaxes(corners[:, :-1] - corners[:, -1:], 1, 2))
    sizes = np.abs(expected).max(axis=(1, 2), keepdims=True)
    assert (np.abs(ours.transform[:, :-1] - expected) < 1e-10 * sizes).all()
    assert np.array_equal(ours.transform[:, -1], corners[:, -1])


def test_planes_of_points_in_a_flat():
    """The centre of a sphere lies in the flat, as far from all corners of the cell."""
    flat = np.random.default_rng(8).integers(0, 50, (30, 2))
    points = flat @ np.array([[2, 1, 0, 3], [1, -1, 4, 0]]) + [5, 0, 1, 2]
    found = cullhull.delaunay(points)
    assert found.affine_dimension == 2
    centres = -0.5 * found.equations[:, :4] / found.equations[:, 4:5]
    away = np.linalg.norm(points[found.cells] - centres[:, None], axis=2)
    assert np.allclose(away, away[:, :1], rtol=1e-9)
    basis = np.linalg.svd((points - points[0]).T)[0][:, 2:]
    assert np.allclose((centres - points[0]) @ basis, 0, atol=1e-9 * np.abs(centres).max())


# Questions


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_questions_are_exact(dimension):
    """Against rational numbers, on lattices: every face has questions on it."""
    rng = np.random.default_rng(dimension)
    points = rng.permutation(np.indices((4,) * dimension).reshape(dimension, -1).T)[:16]
    found = cullhull.delaunay(points)
    asked = np.vstack([rng.integers(-1, 9, (30, dimension)) / 2, points])
    cells = found.find_simplex(asked)
    assert cells.dtype == np.int32 and cells.shape == (len(asked),)
    shares = found.barycentric(asked, cells)
    nearest = found.nearest(asked)
    for i, x in enumerate(asked):
        x = [Fraction(float(c)) for c in x]
        holding = []
        for number, cell in enumerate(found.cells.tolist()):
            corners = [[Fraction(int(c)) for c in points[v]] for v in cell]
            whole = determinant([[a - b for a, b in zip(p, corners[0])] for p in corners[1:]])
            exact = []
            for j in range(len(cell)):
                other = corners[:j] + [x] + corners[j + 1 :]
                exact.append(
                    determinant([[a - b for a, b in zip(p, other[0])] for p in other[1:]]) / whole
                )
            if min(exact) >= 0:
                holding.append(number)
                if number == cells[i]:
                    assert shares[i].tolist() == pytest.approx([float(s) for s in exact], abs=1e-14)
                    assert [s == 0 for s in shares[i]] == [s == 0 for s in exact]
        assert cells[i] == (holding[0] if holding else -1)
        away = [sum((a - int(b)) ** 2 for a, b in zip(x, p)) for p in points]
        assert nearest[i] == away.index(min(away))
    assert np.isnan(shares[cells < 0]).all()
    assert np.array_equal(found.barycentric(asked), shares, equal_nan=True)
    assert found.find_simplex(asked[0]) == cells[0] and found.nearest(asked[0]) == nearest[0]
    assert np.array_equal(found.find_simplex(asked, threads=1), cells)
    again = pickle.loads(pickle.dumps(found))
    assert np.array_equal(again.find_simplex(asked), cells)


def test_questions_that_are_none():
    found = cullhull.delaunay(GRID)
    for bad in ([1, 2], [[1, 2]], np.zeros((2, 2, 3)), [np.nan, 0, 0]):
        for ask in (found.find_simplex, found.nearest, found.barycentric):
            with pytest.raises(ValueError):
                ask(bad)
    for cells in ([0, 1], [len(found)], [-2]):
        with pytest.raises(ValueError):
            found.barycentric([[1, 1, 1]], cells)
    nothing = cullhull.delaunay(np.zeros((0, 2)))
    assert nothing.find_simplex([1, 2]) == -1 and nothing.nearest([1, 2]) == -1
    assert found.find_simplex(np.zeros((0, 3))).shape == (0,)


@pytest.mark.parametrize("dimension", [2, 3, 4])
def test_find_simplex_in_the_place_of_scipys(dimension):
    rng = np.random.default_rng(dimension)
    points = rng.random((200, dimension))
    ours, theirs = cullhull.Delaunay(points), spatial.Delaunay(points)
    asked = rng.random((3, 100, dimension)) * 1.2 - 0.1
    asked[1, 5] = np.nan, *[0] * (dimension - 1)
    mine, other = ours.find_simplex(asked), theirs.find_simplex(asked)
    assert mine.dtype == other.dtype and mine.shape == other.shape
    assert np.array_equal(mine < 0, other < 0) and (mine < 0).any() and mine[1, 5] == -1
    same = np.sort(ours.simplices[mine], axis=-1) == np.sort(theirs.simplices[other], axis=-1)
    assert same[mine >= 0].all()
    assert np.array_equal(cullhull.tsearch(ours, asked), mine)
    assert ours.find_simplex(points[0]).shape == ()
    assert ours.find_simplex(np.zeros((0, dimension))).shape == (0,)
    for bad in (np.zeros(dimension + 1), np.zeros((4, 1))):
        with pytest.raises(ValueError, match="dimensionality"):
            ours.find_simplex(bad)
    with pytest.raises(IndexError):  # SciPy's, too
        ours.find_simplex(3.0)


def test_outside_by_rounding():
    """In the middle of edges of a turned square: half of them are outside, by their last digit."""
    rng = np.random.default_rng(0)
    points = np.vstack([np.array([[0, 0], [1, 0], [1, 1], [0, 1]]), rng.random((50, 2))])
    points = points @ np.array([[np.cos(1), np.sin(1)], [-np.sin(1), np.cos(1)]])
    ours, theirs = cullhull.Delaunay(points), spatial.Delaunay(points)
    ends = points[ours.convex_hull]
    t = rng.random((500, 1, 1))
    asked = (ends[:, 0] + t * (ends[:, 1] - ends[:, 0])).reshape(-1, 2)
    assert (theirs.find_simplex(asked) >= 0).mean() > 0.9
    found = ours.find_simplex(asked)
    native = ours.triangulation
    best = [
        max(native.barycentric(x, int(cell)).min() for cell in native.hull_cells) for x in asked[::7]
    ]
    near = np.array(best) >= -100 * np.finfo(float).eps
    assert np.array_equal(found[::7] >= 0, near) and (found >= 0).mean() > 0.9
    exact = ours.find_simplex(asked, tol=0)
    assert 0.1 < (exact < 0).mean() < 0.9 and np.array_equal(found[exact >= 0], exact[exact >= 0])
    assert np.nanmin(native.barycentric(asked, found)) >= -100 * np.finfo(float).eps
    far = ends.mean(axis=1) + 1e-3 * np.sign(ends.mean(axis=1) - points.mean(axis=0))
    near = [max(native.barycentric(x, int(c)).min() for c in native.hull_cells) for x in far]
    assert (ours.find_simplex(far) == -1).all() and max(near) > -0.5
    assert np.array_equal(ours.find_simplex(far, tol=0.5) >= 0, np.array(near) >= -0.5)


def test_nearly_flat_simplices_leave_the_others_alone():
    """One simplex that is nearly flat leaves the others' planes and transforms as they are."""
    points = np.array([[0, 0], [1, 0], [0, 1], [1, 1], [0.5, 5e-324]])
    ours = cullhull.Delaunay(points)
    good = (ours.simplices != 4).all(axis=1)
    assert np.isfinite(ours.transform[good]).all() and np.isfinite(ours.equations[good]).all()
    assert np.isnan(ours.transform[~good]).any()


def test_scipys_degenerate_points():
    """What SciPy's test of the same set asserts but for the number of nearly flat triangles, which
    is Qhull's: those of ours are as flat as their exact areas."""
    tests = pytest.importorskip("scipy.spatial.tests.test_qhull")
    data = np.load(Path(tests.__file__).parent / "data" / "degenerate_pointset.npz")
    ours = cullhull.Delaunay(data["c"])
    tests.TestUtilities()._check_barycentric_transforms(ours)
    assert ours.triangulation.certify()
    for cell in np.flatnonzero(np.isnan(ours.transform[:, 0, 0])):
        a, b, c = ([Fraction(float(x)) for x in ours.points[v]] for v in ours.simplices[cell])
        area = determinant([[x - y for x, y in zip(b, a)], [x - y for x, y in zip(c, a)]])
        assert 0 < area < Fraction(1, 10**17)


@pytest.mark.parametrize("cells", [1.9, [0.0], np.array([True])])
def test_cells_are_integers(cells):
    found = cullhull.delaunay([[0, 0], [1, 0], [0, 1], [1, 1]])
    with pytest.raises(cullhull.InvalidArgument, match="cells should be integers"):
        found.barycentric([0.25, 0.25], cells)


@pytest.mark.parametrize("cell", [2**32, 2**32 + 1, 2**63, 2**64 - 1, -2, -(2**32), -(2**63), 2])
def test_cells_out_of_range_are_refused(cell):
    found = cullhull.delaunay([[0, 0], [1, 0], [0, 1], [1, 1]])
    asked = [[0.25, 0.25], [0.5, 0.25]]
    for kind in (np.uint64,) if cell >= 2**63 else (np.int64,):
        with pytest.raises(cullhull.InvalidArgument, match=f"there is no cell {cell} of 2"):
            found.barycentric(asked, np.array([0, cell], dtype=kind))
    with pytest.raises(cullhull.InvalidArgument, match=f"there is no cell {cell} of 2"):
        found.barycentric(asked[0], cell)
    assert np.isnan(found.barycentric(asked, [0, -1])[1]).all()


def test_the_budget_of_a_diagram_holds_for_its_triangulation_too():
    points = cullhull.generate("disk", 20_000, 2)
    budget = 5_500_000
    found = cullhull.delaunay(points, memory_budget=budget)
    assert cullhull.voronoi(found, memory_budget=budget).vertices.shape[1] == 2
    with pytest.raises(cullhull.OutOfBudget):
        cullhull.voronoi(points, memory_budget=budget)
    assert len(cullhull.voronoi(points, memory_budget=2 * budget).vertices) == found.cell_count
