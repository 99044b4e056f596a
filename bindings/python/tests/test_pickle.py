"""Copies and pickles: of every class, between processes, of the arrays' size, never out of bounds."""

import copy
import pickle
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

import cullhull
from test_stream import ARRAYS, same

def assert_same(a, b):
    assert same(a, b)
    for name in ("dimension", "affine_dimension", "facet_count", "statistics"):
        assert getattr(a, name) == getattr(b, name), name


def through_pickle(protocol):
    return lambda thing: pickle.loads(pickle.dumps(thing, protocol))


WAYS = {
    **{f"protocol {p}": through_pickle(p) for p in range(pickle.HIGHEST_PROTOCOL + 1)},
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
}
WAYS = [pytest.param(way, id=name) for name, way in WAYS.items()]


def sets():
    yield "ball", cullhull.generate("ball", 300, 3)
    yield "grid", np.array([[x, y, z] for x in range(3) for y in range(3) for z in range(3)])
    yield "single precision", cullhull.generate("sphere", 100, 4).astype(np.float32)
    yield "polygon", cullhull.generate("circle", 100, 2)
    yield "line", cullhull.generate("ball", 30, 1)
    yield "flat", np.column_stack([cullhull.generate("ball", 50, 2), np.ones(50)])
    yield "a point", np.zeros((4, 3))
    yield "nothing", np.zeros((0, 3))


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("points", [pytest.param(p, id=name) for name, p in sets()])
def test_hull(points, way):
    hull = cullhull.convex_hull(points, certify=True)
    again = way(hull)
    assert type(again) is cullhull.Hull and again is not hull
    assert_same(again, hull)
    found, expected = again.certificate, hull.certificate
    for name in ("valid", "reason", "ridges_checked", "points_checked", "exact_decisions"):
        assert getattr(found, name) == getattr(expected, name)
    if hull.affine_dimension >= 0:
        asked = np.random.default_rng(1).normal(size=(50, points.shape[1]))
        assert np.array_equal(again.sides(asked), hull.sides(asked))
    assert again.certify(points)


@pytest.mark.parametrize("way", WAYS)
def test_batch(way):
    rng = np.random.default_rng(1)
    batch = cullhull.convex_hulls([rng.random((n, 3)) for n in (50, 4, 3, 1, 0, 200)])
    again = way(batch)
    assert type(again) is cullhull.HullBatch and len(again) == 6
    for a, b in zip(again, batch):
        assert_same(a, b)
    for name in ("point_counts", "affine_dimensions", "volumes", "areas", "centroids"):
        assert np.array_equal(getattr(again, name), getattr(batch, name))


@pytest.mark.parametrize("way", WAYS)
def test_growing_hulls_go_on_by_themselves(way):
    points = cullhull.generate("ball", 600, 3)
    growing = cullhull.GrowingHull(3)
    assert_same(way(growing).hull, growing.hull)  # of nothing yet
    growing.add(points[:300])
    again = way(growing)
    assert_same(again.hull, growing.hull)
    again.add(points[300:])
    assert growing.hull.point_count == 300 and again.hull.point_count == 600
    both = cullhull.convex_hull(points)
    assert np.array_equal(again.hull.simplices, both.simplices)
    assert again.hull.volume == both.volume


@pytest.mark.parametrize("way", WAYS)
def test_trackers_go_on_by_themselves(way):
    points = cullhull.generate("ball", 20_000, 3)
    tracker = cullhull.HullTracker(cull="gauge", threads=1)
    assert way(tracker).hull is None
    tracker.update(points)
    tracker.update(points * 1.01)
    again = way(tracker)
    assert_same(again.hull, tracker.hull)
    assert again.report == tracker.report
    moved = again.update(points * 1.02)
    assert again.report["index"] == 2 and tracker.report["index"] == 1
    assert np.array_equal(moved.simplices, tracker.update(points * 1.02).simplices)


@pytest.mark.parametrize("incremental", [False, True])
@pytest.mark.parametrize("way", WAYS)
def test_drop_in(way, incremental):
    points = cullhull.generate("ball", 400, 3)
    hull = cullhull.ConvexHull(points[:300], incremental, "QG7 Qc", progress=lambda *_: None)
    asked = hull.simplices
    again = way(hull)
    names = ("points", "vertices", "simplices", "neighbors", "equations", "coplanar", "good")
    for name in (*names, "min_bound", "max_bound"):
        assert np.array_equal(getattr(again, name), getattr(hull, name)), name
    assert (again.volume, again.area, again.ndim) == (hull.volume, hull.area, 3)
    assert repr(again) == repr(hull)
    if incremental:
        again.add_points(points[300:])
        assert hull.simplices is asked and hull.npoints == 300
        whole = cullhull.ConvexHull(points, True, "QG7 Qc")
        assert np.array_equal(again.simplices, whole.simplices)
    else:
        with pytest.raises(RuntimeError):
            again.add_points(points[300:])


@pytest.mark.parametrize("way", WAYS)
def test_incremental_copies_grow_apart(way):
    points = cullhull.generate("ball", 300, 3)
    hull = cullhull.ConvexHull(points[:100], incremental=True)
    hull.add_points(points[100:200])
    again = way(hull)
    again.add_points(points[200:])
    hull.add_points(points[200:] * 2)
    assert np.array_equal(again.simplices, cullhull.ConvexHull(points).simplices)
    assert hull.volume > again.volume


@pytest.mark.parametrize("way", WAYS)
def test_tolerant_copies_go_on_from_the_exact_hull(way):
    points = cullhull.generate("sphere", 300, 3)
    whole, hull = (
        cullhull.TolerantConvexHull(points[:200], incremental=True, merge_distance=0.2)
        for _ in range(2)
    )
    again = way(hull)
    assert hull.dropped > 20 and again.dropped == hull.dropped
    for one in (whole, again):
        one.add_points(points[200:])
    assert np.array_equal(again.simplices, whole.simplices)
    assert np.array_equal(again.equations, whole.equations) and again.distance == whole.distance
    single = cullhull.TolerantConvexHull(points, merge_distance=0.2)
    assert np.array_equal(way(single).equations, single.equations)
    assert repr(way(single)) == repr(single)


@pytest.mark.parametrize("way", WAYS)
def test_tolerant_triangulations_and_diagrams(way):
    points = np.round(cullhull.generate("ball", 300, 2), 1)
    cells = cullhull.TolerantDelaunay(points, merge_distance=0.01)
    sheet = cullhull.TolerantVoronoi(points, incremental=True, merge_distance=0.01)
    again, other = way(cells), way(sheet)
    assert np.array_equal(again.simplices, cells.simplices) and repr(again) == repr(cells)
    assert other.regions == sheet.regions and other.dropped == sheet.dropped > 0
    for one in (sheet, other):
        one.add_points([[3, 3], [3.001, 3]])
    assert other.regions == sheet.regions and other.distance == sheet.distance


@pytest.mark.parametrize("way", WAYS)
def test_halfspaces(way):
    normals = cullhull.generate("sphere", 40, 3)
    cut = cullhull.HalfspaceIntersection(np.column_stack([normals, -np.ones(40)]), np.zeros(3))
    again = way(cut)
    for name in ("intersections", "dual_points", "halfspaces", "interior_point", "dual_equations"):
        assert np.array_equal(getattr(again, name), getattr(cut, name)), name
    assert again.dual_facets == cut.dual_facets and again.is_bounded
    assert_same(again.dual, cut.dual)


def test_small_things():
    lists = cullhull.convex_hull(cullhull.generate("ball", 50)).facets
    assert pickle.loads(pickle.dumps(lists)).tolist() == lists.tolist()
    error = cullhull.NotFinite("point 7")
    assert pickle.loads(pickle.dumps(error)).args == error.args


def test_size_is_that_of_the_arrays():
    points = cullhull.generate("sphere", 20_000, 3)
    hull = cullhull.convex_hull(points)
    arrays = sum(getattr(hull, name).nbytes for name in ARRAYS if name != "simplex_facets")
    arrays += hull.facet_neighbours.items.nbytes  # the facets are the simplices
    assert len(pickle.dumps(hull)) < 1.01 * arrays + 4096
    drop_in = cullhull.ConvexHull(points)
    assert len(pickle.dumps(drop_in)) < 1.01 * (arrays + points.nbytes) + 4096
    drop_in.equations, drop_in.simplices, drop_in.neighbors  # what was asked for is not in it twice
    assert len(pickle.dumps(drop_in)) < 1.01 * (arrays + points.nbytes) + 4096
    window = cullhull.ConvexHull(points[:100])
    assert len(pickle.dumps(window)) < 50_000  # not the whole array it is a view of


def _hulls_of(seed):
    points = cullhull.generate("ball", 2000, 3, seed=seed)
    return (
        cullhull.convex_hull(points),
        cullhull.ConvexHull(points),
        cullhull.convex_hulls(points.reshape(40, 50, 3)),
    )


def test_hulls_come_back_from_a_process_pool():
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        results = list(pool.map(_hulls_of, range(4)))
    for seed, (hull, drop_in, batch) in enumerate(results):
        expected, other, all_ = _hulls_of(seed)
        assert np.array_equal(hull.simplices, expected.simplices)
        assert np.array_equal(drop_in.equations, other.equations)
        assert np.array_equal(batch.volumes, all_.volumes)


def _walk(thing):
    """Asks everything that leads through the arrays."""
    thing.contains(np.zeros((3, thing.dimension)))
    thing.support(np.ones(thing.dimension))
    thing.facets.tolist()


def test_states_that_are_none_are_refused():
    """Whatever number is changed, an error or a hull comes out, and no question leads astray."""
    core = cullhull._core
    rng = np.random.default_rng(3)
    for points in (cullhull.generate("ball", 60, 3), np.indices((3, 3, 3)).reshape(3, -1).T):
        state = core.state_of_solid(cullhull.convex_hull(points)._solid)
        refused = 0
        for name, value in state.items():
            for wrong in (None, -1, 10**30, "x", (1, 2), np.zeros(3), np.zeros((2, 2))):
                if isinstance(value, (float, str)) or (name == "facet_vertices" and wrong is None):
                    continue
                if name == "centroid" and np.shape(wrong) == (3,):
                    continue
                with pytest.raises((ValueError, TypeError, RuntimeError)):
                    _walk(cullhull.Hull._of(core.solid_of_state({**state, name: wrong})))
            with pytest.raises(ValueError, match=name):
                core.solid_of_state({k: v for k, v in state.items() if k != name})
            if not isinstance(value, np.ndarray) or value.dtype == np.float64:
                continue
            for _ in range(40):
                wrong = value.copy()
                wrong[rng.integers(len(wrong))] = rng.choice([-1, 2**31 - 1, 10**9, 0, 26])
                try:
                    _walk(cullhull.Hull._of(core.solid_of_state({**state, name: wrong})))
                except (ValueError, RuntimeError):
                    refused += 1
        assert refused > 100
    with pytest.raises(ValueError, match="another version"):
        core.solid_of_state({**state, "version": 2})


@pytest.mark.skipif(not hasattr(sys, "getrefcount"), reason="counts references")
def test_states_keep_nothing_alive():
    hull = cullhull.convex_hull(cullhull.generate("ball", 100))
    before = sys.getrefcount(hull._solid)
    pickle.dumps(hull)
    after = sys.getrefcount(hull._solid)
    assert after == before


@pytest.mark.parametrize("send", [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_natural_interpolators_and_constrained_triangulations(send):
    points = np.random.default_rng(1).random((30, 2))
    natural = cullhull.NaturalNDInterpolator(points, points[:, 0] + 1j, fill_value=-1)
    asked = [[0.5, 0.5], [0.3, 0.6], [9.0, 9.0]]
    assert np.array_equal(send(natural)(asked), natural(asked))
    assert repr(send(natural)) == "<NaturalNDInterpolator of 30 points in 2D>"
    square, edge = [[0, 0], [1, 0], [1, 1], [0, 1]], [[3, 1]]
    forced = cullhull.constrained_delaunay(square, edge, certify=True)
    back = send(forced)
    for name in ("points", "cells", "neighbours", "pieces", "piece_sources", "depths"):
        assert np.array_equal(getattr(back, name), getattr(forced, name)), name
    assert back.certificate and repr(back) == repr(forced)


def _use(found):
    """Whatever walks over a triangulation."""
    asked = np.random.default_rng(1).random((40, found.dimension)) * 2
    for ask in (
        lambda: found.find_simplex(asked),
        lambda: found.nearest(asked),
        lambda: found.barycentric(asked),
        lambda: cullhull.voronoi(found),
        lambda: cullhull.voronoi(found).clip([-1] * found.dimension, [3] * found.dimension),
        lambda: cullhull.alpha_shape(found, 0.5),
        lambda: cullhull.concave_hull(found, edge_length=0.3),
        lambda: cullhull.minimum_spanning_tree(found),
        lambda: cullhull.relative_neighbourhood_graph(found),
        lambda: cullhull.NaturalNDInterpolator(found, np.arange(found.point_count))(asked),
        lambda: repr(found) + repr(found.certify()),
    ):
        try:
            ask()
        except (cullhull.Error, ValueError, IndexError):
            pass


@pytest.mark.parametrize("d", [2, 3])
def test_states_of_triangulations_that_are_wrong_end(d):
    """One number of a pickled triangulation, or of its points, is another: refused, or it answers;
    but no question goes on for ever."""
    core, rng = cullhull._core, np.random.default_rng(d)
    found = cullhull.delaunay(rng.integers(0, 9, (60, d)).astype(float))
    state = core.state_of_cells(found._cells)
    lists = [name for name, value in state.items() if isinstance(value, np.ndarray) and value.size]
    refused = 0
    for _ in range(400):
        name = lists[rng.integers(len(lists))]
        wrong = state[name].copy()
        flat = wrong.reshape(-1)
        at = rng.integers(flat.size)
        if rng.random() < 0.5:
            flat[at] = flat[rng.integers(flat.size)]
        else:
            flat[at] = rng.choice([-1, 0, 1, 2, 7])
        try:
            damaged = core.cells_of_state({**state, name: wrong})
        except cullhull.InvalidArgument:
            refused += 1
            continue
        _use(cullhull.Triangulation._of(damaged))
    assert refused > 100
    wrong = state["neighbours"].copy()
    wrong[wrong == 3] = 4
    with pytest.raises(cullhull.InvalidArgument, match="neighbours"):
        core.cells_of_state({**state, "neighbours": wrong})
