"""Every public attribute of SciPy's classes, of ours in their place: name, type, shape and value.

Nothing is listed by hand but what differs (QHULLS_RIDGES) and the forms in which the order of rows,
which is that of Qhull's work, does not count. A class or an attribute that SciPy gets later is
compared without a change here. Points that are equal are compared by the tests of each class.
"""

import inspect

import numpy as np
import pytest

import cullhull

spatial = pytest.importorskip("scipy.spatial")
interpolate = pytest.importorskip("scipy.interpolate")

RANDOM = np.random.default_rng(3)

#: What is different, and why: Qhull leaves out ridges of a diagram that are unbounded in so many
#: directions that fewer than d - 1 of their vertices are finite. The others are compared.
QHULLS_RIDGES = ("ridge_points", "ridge_vertices", "ridge_dict")


def generic(dimension, count=40):
    return RANDOM.random((count, dimension))


def sets():
    for dimension in (2, 3, 4):
        yield f"{dimension}d", generic(dimension)
        yield f"{dimension}d-f4", generic(dimension).astype(np.float32)
        yield f"{dimension}d-whole", RANDOM.integers(0, 1 << 20, (40, dimension))
        yield f"{dimension}d-fortran", np.asfortranarray(generic(dimension))
    yield "list", generic(2).tolist()


def halfspaces(points):
    points = np.asarray(points, dtype=float)
    points = points / np.abs(points).max() - 0.5
    return np.column_stack([points, -1 - (points**2).sum(axis=1)])


def on_sphere(points):
    points = np.asarray(points, dtype=float)
    points = points / np.abs(points).max() - 0.5
    return points / np.linalg.norm(points, axis=1)[:, np.newaxis]


def spatial_cases():
    for name, points in sets():
        for kind, more in (
            ("ConvexHull", ({}, {"incremental": True})),
            ("Delaunay", ({}, {"incremental": True}, {"furthest_site": True})),
            ("Voronoi", ({}, {"incremental": True}, {"furthest_site": True})),
        ):
            for options in more:
                yield name, spatial, kind, (points,), options
        cuts = halfspaces(points)
        inside = np.full(cuts.shape[1] - 1, 0.01)
        yield name, spatial, "HalfspaceIntersection", (cuts, inside), {}
        yield name, spatial, "SphericalVoronoi", (on_sphere(points),), {}


def interpolation_cases():
    for dimension in (2, 3, 5):
        points = generic(dimension) * np.arange(1, dimension + 1)
        shapes = {"numbers": (), "rows": (2,), "tables": (2, 3), "one": (1,)}
        for name, shape in shapes.items():
            for dtype in ("f8", "f4", "i4", "c16", "c8"):
                values = RANDOM.integers(0, 99, (40, *shape)).astype(dtype)
                for kind in ("LinearNDInterpolator", "NearestNDInterpolator"):
                    for options in ({}, {"rescale": True}):
                        case = f"{dimension}d-{name}-{dtype}"
                        yield case, interpolate, kind, (points, values), options
    points, values = generic(2), generic(2)[:, 0]
    for kind in ("LinearNDInterpolator", "NearestNDInterpolator"):
        yield "lists", interpolate, kind, (points.tolist(), values.tolist()), {}
        yield "tuple", interpolate, kind, (tuple(points.T), values), {}
    yield "filled", interpolate, "LinearNDInterpolator", (points, values), {"fill_value": 3}
    yield "filled", interpolate, "LinearNDInterpolator", (points, values * 1j), {"fill_value": 3}


CASES = [*spatial_cases(), *interpolation_cases()]
CLASSES = sorted({case[2] for case in CASES})


def identity(case):
    name, _, kind, _, options = case
    return "-".join([kind, name, *options])


# Forms in which equal things are equal


def by_corners(found, simplices):
    """How to sort rows by their corners, and each row's columns likewise."""
    columns = np.argsort(simplices, axis=1, kind="stable")
    rows = np.lexsort(np.take_along_axis(simplices, columns, axis=1).T[::-1])
    return rows, columns


def ranks(order):
    place = np.empty(len(order) + 1, dtype=int)
    place[order], place[-1] = np.arange(len(order)), -1
    return place


def corners_of(found):
    return found._simplices if hasattr(found, "_simplices") else found.simplices


def of_simplices(found, value):
    return value[by_corners(found, corners_of(found))[0]]


def neighbors(found, value):
    rows, columns = by_corners(found, found.simplices)
    return ranks(rows)[np.take_along_axis(value, columns, axis=1)][rows]


def transform(found, value):
    """What it makes of a point, in the order of corners."""
    rows, columns = by_corners(found, found.simplices)
    d = found.ndim
    first = np.einsum("sij,sj->si", value[:, :d], found.points.mean(axis=0) - value[:, d])
    every = np.column_stack([first, 1 - first.sum(axis=1)])
    return np.take_along_axis(every, columns, axis=1)[rows]


def holders(found, value):
    """Whether the simplex of each vertex has that vertex."""
    own = found.simplices[value] == np.arange(len(value))[:, np.newaxis]
    return own.any(axis=1) | (value < 0)


def coplanar(found, value):
    assert (found.simplices[value[:, 1]] == value[:, 2:]).any(axis=1).all()
    ends = np.sort(value[:, [0, 2]], axis=1)
    return ends[np.lexsort(ends.T)]


def adjacency(found, value):
    offsets, items = value
    parts = np.split(items, offsets[1:-1])
    return [offsets, np.concatenate([np.sort(part) for part in parts])]


def cyclic(found, value):
    if found.ndim > 2:
        return np.sort(value)
    return np.roll(value, -int(np.argmin(value)))


def facets(found, value):
    rows = np.sort(value, axis=1)
    return rows[np.lexsort(rows.T[::-1])]


def vertex_order(found):
    """Of a diagram's vertices by the points that are nearest to each."""
    if hasattr(found, "_simplices"):
        return by_corners(found, found._simplices)[0]
    return np.lexsort(np.round(found.vertices, 7).T[::-1])


def vertices(found, value):
    return value[vertex_order(found)] if value.ndim > 1 else cyclic(found, value)


def lists_of_vertices(found, lists):
    place = ranks(vertex_order(found))
    return [sorted(place[part].tolist()) for part in lists]


def regions(found, value):
    return sorted(lists_of_vertices(found, value))


def point_region(found, value):
    """The region itself; one that Qhull leaves out counts as none, like that of a duplicate."""
    every = lists_of_vertices(found, found.regions)
    return [every[i] if i >= 0 else [] for i in value]


def qhull_has(found, ends):
    return found.ndim == 2 or sum(end >= 0 for end in ends) >= found.ndim - 1


def ridges_by_points(found):
    order = np.lexsort(np.sort(found.ridge_points, axis=1).T[::-1])
    return [i for i in order if qhull_has(found, found.ridge_vertices[i])]


def ridge_points(found, value):
    return np.sort(value, axis=1)[ridges_by_points(found)]


def ridge_vertices(found, value):
    every = lists_of_vertices(found, value)
    return [every[i] for i in ridges_by_points(found)]


def ridge_dict(found, value):
    pairs = {tuple(sorted(pair)): ends for pair, ends in value.items() if qhull_has(found, ends)}
    keys = sorted(pairs)
    return [keys, lists_of_vertices(found, [pairs[key] for key in keys])]


def dual_order(found):
    return sorted(range(len(found.dual_facets)), key=lambda i: sorted(found.dual_facets[i]))


def of_dual_facets(found, value):
    return value[dual_order(found)]


def tri(found, value):
    return value and np.sort(np.sort(value.simplices, axis=1), axis=0)


def tree(found, value):
    return value.data


FORMS = {
    "SphericalVoronoi": {"regions": lambda found, value: lists_of_vertices(found, value)},
    "ConvexHull": {"equations": of_simplices, "good": lambda found, value: value},
    "": {
        "simplices": lambda found, value: facets(found, value),
        "neighbors": neighbors,
        "equations": of_simplices,
        "transform": transform,
        "vertex_to_simplex": holders,
        "coplanar": coplanar,
        "vertex_neighbor_vertices": adjacency,
        "convex_hull": facets,
        "vertices": vertices,
        "regions": regions,
        "point_region": point_region,
        "ridge_points": ridge_points,
        "ridge_vertices": ridge_vertices,
        "ridge_dict": ridge_dict,
        "dual_facets": lambda found, value: sorted(map(sorted, value)),
        "dual_equations": of_dual_facets,
        "intersections": of_dual_facets,
        "tri": tri,
        "tree": tree,
    },
}


def form(kind, name, found, value):
    make = FORMS.get(kind, {}).get(name) or FORMS[""].get(name)
    return make(found, value) if make else value


def flat(value):
    """Numbers of nested lists, one after another."""
    if isinstance(value, (list, tuple)):
        sizes = [len(part) for part in value if hasattr(part, "__len__")]
        return sizes + [x for part in value for x in flat(part)]
    return np.ravel(value).tolist()


def described(name, value):
    if not isinstance(value, np.ndarray):
        return type(value).__name__
    return value.dtype.str, value.shape[1 if name in QHULLS_RIDGES else 0 :]


def difference(kind, name, ours, theirs):
    mine, other = getattr(ours, name), getattr(theirs, name)
    if name == "dual_vertices":  # NumPy's default integer, which has 32 bits in NumPy 1 on Windows
        other = other.astype(np.int64)
    if described(name, mine) != described(name, other):
        return f"{described(name, mine)}, not {described(name, other)}"
    mine, other = form(kind, name, ours, mine), form(kind, name, theirs, other)
    if mine is None or other is None:
        return None if mine is other else f"{mine}, not {other}"
    a, b = np.array(flat(mine)), np.array(flat(other))
    same = a.shape == b.shape and np.allclose(a, b, rtol=1e-6, atol=1e-8, equal_nan=True)
    return None if same else f"{mine}, not {other}"


def public(found):
    return [name for name in dir(found) if not name.startswith("_")]


@pytest.mark.parametrize("case", CASES, ids=identity)
def test_attributes_are_scipys(case):
    _, module, kind, arguments, options = case
    theirs = getattr(module, kind)(*arguments, **options)
    ours = getattr(cullhull, kind)(*arguments, **options)
    missing = set(public(theirs)) - set(dir(ours))
    assert not missing
    for name in public(theirs):
        if callable(getattr(theirs, name)):
            continue
        fault = difference(kind, name, ours, theirs)
        assert fault is None, f"{kind}.{name}: {fault}"


@pytest.mark.parametrize("kind", CLASSES)
def test_methods_take_what_scipys_take(kind):
    case = next(case for case in CASES if case[2] == kind)
    theirs = getattr(case[1], kind)
    for name in ["__init__", *public(theirs)]:
        if not callable(getattr(theirs, name, None)):
            continue
        try:
            wanted = list(inspect.signature(getattr(theirs, name)).parameters)
        except ValueError:  # of a compiled class, without a signature
            continue
        given = list(inspect.signature(getattr(getattr(cullhull, kind), name)).parameters)
        assert given[: len(wanted)] == wanted, name


def test_every_class_of_ours_that_scipy_has_is_compared():
    ours = {
        name
        for name in cullhull.__all__
        if inspect.isclass(getattr(cullhull, name))
        and not issubclass(getattr(cullhull, name), BaseException)
        and any(hasattr(module, name) for module in (spatial, interpolate))
    }
    assert ours == set(CLASSES)
