"""Voronoi diagrams: the native face, and Voronoi and SphericalVoronoi against SciPy's."""

import copy
import itertools
import pickle

import numpy as np
import pytest

import cullhull

spatial = pytest.importorskip("scipy.spatial")

CUBE = np.indices((2, 2, 2)).reshape(3, -1).T


def places_of(theirs, ours):
    """For each of our vertices its place among theirs; -1 stays."""
    away = np.abs(ours.vertices[:, np.newaxis] - theirs.vertices).max(axis=2)
    places = away.argmin(axis=1)
    assert sorted(places) == list(range(len(theirs.vertices)))
    assert np.allclose(theirs.vertices[places], ours.vertices, rtol=1e-6)
    return np.append(places, -1)


def unordered(diagram, places, count):
    """Ridges by their points; of equal points, which are `count` apart, SciPy names any."""
    return {
        tuple(sorted(i % count for i in pair)): set(places[ends].tolist())
        for pair, ends in zip(diagram.ridge_points.tolist(), diagram.ridge_vertices)
    }


@pytest.mark.parametrize("keywords", [{}, {"furthest_site": True}, {"incremental": True}])
@pytest.mark.parametrize("dimension", [2, 3, 4])
def test_every_attribute(dimension, keywords):
    points = np.random.default_rng(dimension).random((50, dimension))
    points = np.vstack([points, points[:3]])
    ours, theirs = cullhull.Voronoi(points, **keywords), spatial.Voronoi(points, **keywords)
    assert ours.vertices.shape == theirs.vertices.shape
    places, same = places_of(theirs, ours), np.arange(-1, len(theirs.vertices))
    mine, other = unordered(ours, places, 50), unordered(theirs, np.roll(same, -1), 50)
    for pair in set(mine) - set(other):  # unbounded, with few vertices: Qhull leaves these out
        assert -1 in mine[pair] and len(mine[pair]) < dimension
        del mine[pair]
    assert mine == other
    if not ours.furthest_site:  # where SciPy's duplicates have no region, or those they equal
        assert (ours.point_region < 0).sum() == (theirs.point_region < 0).sum()
    assert np.array_equal(ours.point_region[50:], ours.point_region[:3])
    assert len(ours.regions) == len(theirs.regions)
    for i in range(3 if ours.furthest_site else 0, 50):
        mine, other = (v.regions[v.point_region[i]] for v in (ours, theirs))
        assert len(mine) == len(other) and set(places[mine].tolist()) == set(other)
    for name in ("vertices", "point_region", "points", "min_bound", "max_bound"):
        a, b = getattr(ours, name), getattr(theirs, name)
        assert (a.dtype, a.shape) == (b.dtype, b.shape), name
        assert getattr(ours, name) is a and a.flags.writeable
    for name in ("regions", "ridge_vertices"):
        assert {type(x) for part in getattr(ours, name) for x in part} == {int}
    assert ours.ridge_points.dtype == theirs.ridge_points.dtype
    assert ours.ridge_dict == {
        tuple(pair): ends for pair, ends in zip(ours.ridge_points.tolist(), ours.ridge_vertices)
    }
    assert {m for m in dir(theirs) if not m.startswith("_")} <= set(dir(ours))


def test_regions_go_round():
    points = np.random.default_rng(5).random((100, 2))
    found = cullhull.Voronoi(points)
    for site, region in zip(points, (found.regions[r] for r in found.point_region)):
        if -1 in region:
            assert region[0] == -1
            continue
        corners = found.vertices[region] - site
        following = np.roll(corners, -1, axis=0)
        turns = corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0]
        assert (turns > 0).all()


def test_points_on_one_sphere():
    """Where SciPy finds a vertex, and no ridges at all."""
    found = cullhull.Voronoi(CUBE)
    assert found.vertices.tolist() == [[0.5] * 3] and len(found.ridge_points) == 12
    assert found.ridge_vertices == [[-1, 0]] * 12 and len(spatial.Voronoi(CUBE).ridge_points) == 0
    grid = np.indices((5, 5)).reshape(2, -1).T
    found = cullhull.Voronoi(grid)
    assert len(found.vertices) == 16 and len(found.ridge_points) == 40
    assert sorted(map(len, found.regions)).count(4) == 9


@pytest.mark.parametrize("dimension", [1, 2])
def test_faces_are_of_cells_in_space(dimension):
    found = cullhull.voronoi(np.random.default_rng(1).random((5, dimension)))
    for shapes in (True, False):
        cells = found.clip([0] * dimension, [1] * dimension, shapes=shapes)
        with pytest.raises(cullhull.InvalidArgument, match="faces are of cells in 3D"):
            cells.faces(0)
    with pytest.raises(cullhull.InvalidArgument, match="shapes=False"):
        cells.corners(0)


def test_a_point_one_digit_outside():
    """Of the set of the four tests of SciPy's that are left out: its diagram has vertices that
    are very near to each other, and one that is very far; Qhull merges them."""
    points = np.array([[-1, -1], [-1, 0], [-1, 1], [0, -1], [0, 0], [0, 1],
                       [1, -1 - np.finfo(float).eps], [1, 0], [1, 1]])  # fmt: skip
    found = cullhull.Voronoi(points)
    assert found.triangulation.certify() and len(found.vertices) == 6
    far = found.vertices[np.abs(found.vertices).max(axis=1).argmax()]
    assert far[0] == -0.5 and far[1] < -(2.0**51)
    assert np.isclose(found.diagram.clip([-1, -1], [1, 1]).measures.sum(), 4)


def test_duplicates_and_options():
    points = np.random.default_rng(1).random((8, 3))
    points = np.vstack([points, points[:2]])
    for options in (None, "Qbb", "Qbb Qc", "Qc Qz"):
        ours = cullhull.Voronoi(points, qhull_options=options)
        theirs = spatial.Voronoi(points, qhull_options=options)
        assert len(ours.regions) == len(theirs.regions)
        assert ((ours.point_region < 0) == (theirs.point_region < 0)).all()
        assert [r for r in ours.point_region[8:] if r >= 0] in ([], ours.point_region[:2].tolist())
    for option in ("Qu", "QG3", "hello"):
        with pytest.raises(ValueError, match=option):
            cullhull.Voronoi(points, qhull_options=option)
    with pytest.raises(spatial.QhullError):
        cullhull.Voronoi(CUBE[:4])
    with pytest.raises(ValueError):
        cullhull.Voronoi([[0.0, np.nan]])


def test_adding_is_as_at_once():
    points = cullhull.generate("ball", 60, 2)
    growing = cullhull.Voronoi(points[:20], incremental=True)
    assert len(growing.regions) == 20
    growing.add_points(points[20:])
    whole = cullhull.Voronoi(points, qhull_options="Qc")
    assert growing.regions == whole.regions and growing.ridge_dict == whole.ridge_dict
    assert np.array_equal(growing.vertices, whole.vertices)
    growing.close()
    with pytest.raises(RuntimeError):
        growing.add_points(points)


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_copies_and_pickles(way):
    points = cullhull.generate("ball", 60, 3)
    drop_in = cullhull.Voronoi(points, progress=lambda *_: None)
    again = way(drop_in)
    assert again.regions == drop_in.regions and repr(again) == repr(drop_in)
    native = cullhull.voronoi(points, np.linspace(0, 0.1, 60))
    again = way(native)
    assert np.array_equal(again.vertices, native.vertices) and repr(again) == repr(native)
    assert again.regions.tolist() == native.regions.tolist()
    sphere = cullhull.SphericalVoronoi(points / np.linalg.norm(points, axis=1)[:, np.newaxis])
    assert way(sphere).regions == sphere.regions


@pytest.mark.parametrize("dimension", [2, 3])
def test_attributes_in_any_order_and_the_diagram_afterwards(dimension):
    """What the attributes are made of is let go when all are made, and made again when asked for."""
    points = np.random.default_rng(1).random((300, dimension))
    points = np.vstack([points, points[:2]])
    names = ("vertices", "ridge_points", "ridge_vertices", "regions")
    wanted = {name: getattr(cullhull.Voronoi(points), name) for name in names}
    native = cullhull.voronoi(points)
    assert wanted["ridge_vertices"] == [ridge.tolist() for ridge in native.ridges]
    assert wanted["regions"] == [[], *(region.tolist() for region in native.regions[:300])]
    for order in itertools.permutations(names):
        found = cullhull.Voronoi(points)
        early = found.diagram if order[0] == "regions" else None
        for name in order:
            mine, other = getattr(found, name), wanted[name]
            assert type(mine) is type(other)
            assert mine == other if isinstance(mine, list) else np.array_equal(mine, other)
        assert found.diagram == native and (early is None or early is found.diagram)
        again = pickle.loads(pickle.dumps(found))
        assert again.regions == wanted["regions"] and again.diagram == native
    found.ridge_vertices[0].append(5)
    found.vertices[:] = 0
    assert found.diagram == native
    assert cullhull.Voronoi(points).ridge_vertices == wanted["ridge_vertices"]


def test_lists_of_lists():
    lists = cullhull.Lists(np.array([0, 2, 2, 5]), np.array([7, -1, 1, 2, 300], dtype=np.int32))
    for narrow in (np.int32, np.int64):
        same = cullhull.Lists(lists.offsets, lists.items.astype(narrow))
        assert same.tolist() == [[7, -1], [], [1, 2, 300]]
        assert all(type(x) is int for row in same.tolist() for x in row)
    huge = cullhull.Lists(np.array([0, 1]), np.array([2**31 - 1], dtype=np.int32))
    assert huge.tolist() == [[2**31 - 1]]
    assert cullhull.Lists(np.array([0]), huge.items[:0]).tolist() == []
    with pytest.raises(ValueError, match="ascend"):
        cullhull.Lists(np.array([0, 9]), lists.items).tolist()


def test_native_arrays():
    points = cullhull.generate("ball", 300, 3)
    found = cullhull.voronoi(points)
    triangulation = cullhull.delaunay(points)
    assert np.array_equal(cullhull.voronoi(triangulation).vertices, found.vertices)
    for name in ("vertices", "ridge_points", "ray_vertices", "ray_directions"):
        assert not getattr(found, name).flags.writeable
    assert found.ray_directions.shape == triangulation.hull_facets.shape == (
        len(found.ray_vertices),
        3,
    )
    corners = points[triangulation.hull_facets]
    edges = corners[:, 1:] - corners[:, :1]
    assert np.abs(np.einsum("fij,fj->fi", edges, found.ray_directions)).max() < 1e-12
    assert (((corners[:, 0] - points.mean(axis=0)) * found.ray_directions).sum(axis=1) > 0).all()
    away = np.linalg.norm(found.vertices[triangulation.cell_groups][:, np.newaxis]
                          - points[triangulation.cells], axis=2)  # fmt: skip
    assert np.ptp(away, axis=1).max() < 1e-6 * away.max()
    with pytest.raises(TypeError):
        cullhull.VoronoiDiagram()
    with pytest.raises(ValueError):
        cullhull.voronoi(triangulation, np.ones(300))


@pytest.mark.parametrize("n", [0, 1, 2, 3])
@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_few_points(n, dimension):
    points = np.random.default_rng(n).random((n, dimension))
    found = cullhull.voronoi(points)
    assert len(found.regions) == n and len(found.ridges) == len(found.ridge_points)
    if n:
        cells = found.clip(-np.ones(dimension), 2 * np.ones(dimension))
        assert np.isclose(cells.measures.sum(), 3.0**dimension)


def test_power_diagram():
    square = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 1]]
    found = cullhull.voronoi(square, [0, 0, 0, 0, 1])
    assert found.clip([0, 0], [2, 2]).measures.tolist() == [0.125] * 4 + [3.5]
    assert cullhull.voronoi(square, [0, 0, 0, 0, -2]).regions.tolist()[4] == []
    assert "Power" in repr(found)


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_clipped_cells(dimension):
    rng = np.random.default_rng(dimension)
    points = rng.random((200, dimension))
    found = cullhull.voronoi(points)
    cells = found.clip(np.zeros(dimension), np.ones(dimension))
    assert np.isclose(cells.measures.sum(), 1, rtol=1e-12) and len(cells) == 200
    nearest = found.triangulation.nearest(rng.random((20_000, dimension)))
    assert np.abs(np.bincount(nearest, minlength=200) / 20_000 - cells.measures).max() < 0.01
    for i in range(0, 200, 20):
        corners = cells.corners(i)
        middle = corners.mean(axis=0)
        assert found.triangulation.nearest(middle) == i
        if dimension == 3:
            assert np.isclose(cullhull.convex_hull(corners).volume, cells.measures[i])
            assert len(cells.faces(i)) == len(cells.neighbours[i])
        elif dimension == 2:
            assert np.isclose(cullhull.convex_hull(corners).volume, cells.measures[i])
            assert len(corners) == len(cells.neighbours[i])
    only = found.clip(np.zeros(dimension), np.ones(dimension), shapes=False)
    assert np.array_equal(only.measures, cells.measures)
    with pytest.raises(ValueError):
        only.corners(0)
    with pytest.raises(IndexError):
        cells.corners(200)
    if dimension > 1:
        simplex = np.vstack([np.zeros(dimension), np.eye(dimension)])
        part = found.clip(simplex).measures.sum()
        assert np.isclose(part, 1 / (2 if dimension == 2 else 6), rtol=1e-12)
    for low, high in (([0] * dimension, [-1] * dimension), ([0] * (dimension + 1), [1])):
        with pytest.raises(ValueError):
            found.clip(low, high)


def shapes_of(shapely, cells):
    return [
        shapely.MultiPolygon([(rings[0], rings[1:]) for rings in cells.polygons(i)])
        for i in range(len(cells))
    ]


def star(rng, corners):
    """A polygon with dents around (0.5, 0.5)."""
    angle = np.linspace(0, 2 * np.pi, corners, endpoint=False)
    radius = rng.uniform(0.2, 0.7, corners)
    return 0.5 + np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


@pytest.mark.parametrize("seed", range(100))
def test_clipped_cells_are_a_coverage(seed):
    """Neighbours share their corners, and nothing is left out: as shapely sees it."""
    shapely = pytest.importorskip("shapely", "2.1")
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 300))
    points = rng.random((count, 2)) if seed % 2 else rng.integers(0, 16, (count, 2)) / 16
    region = (
        shapely.box(0, 0, 1, 1),
        shapely.Polygon(star(rng, 12)),
        shapely.Polygon(star(rng, 9), [shapely.box(0.49, 0.49, 0.51, 0.52).exterior.coords]),
        shapely.MultiPolygon([shapely.box(0, 0, 0.5, 0.25), shapely.Polygon(star(rng, 7) + [1, 1])]),
    )[seed % 4]
    assert region.is_valid
    cells = cullhull.voronoi(points).clip(region)
    shapes = shapes_of(shapely, cells)
    assert shapely.is_valid(shapes).all()
    assert shapely.coverage_is_valid(shapes)
    union = shapely.coverage_union_all(shapes)
    assert union.symmetric_difference(region).area < 1e-13
    assert np.allclose(shapely.area(shapes), cells.measures, rtol=1e-9, atol=1e-15)
    if seed % 2 == 0 or count == 1:
        return  # of rounded lattices shapely's own diagrams are no coverage
    diagram = shapely.voronoi_polygons(shapely.MultiPoint(points), extend_to=region)
    theirs = np.sort(shapely.area(shapely.intersection(diagram.geoms, region)))
    assert np.allclose(theirs, np.sort(cells.measures), rtol=0, atol=1e-12)


def test_clip_takes_polygons_in_any_form():
    shapely = pytest.importorskip("shapely", "2.1")
    found = cullhull.voronoi([[1, 1], [3, 1]])
    outline, hole = [[0, 0], [4, 0], [4, 2], [0, 2]], [[0.5, 0.5], [1, 1], [0.5, 1]]
    polygon = shapely.Polygon(outline, [hole])
    assert found.clip(outline).measures.tolist() == [4, 4]
    forms = [
        [outline, hole],
        [np.array(outline), np.array(hole)],
        polygon,
        polygon.__geo_interface__,
        {"type": "Feature", "geometry": polygon.__geo_interface__},
        {"type": "FeatureCollection", "features": [{"type": "Feature", "geometry": polygon}]},
    ]
    forms[-1]["features"][0]["geometry"] = polygon.__geo_interface__
    for form in forms:
        cells = found.clip(form)
        assert cells.measures.tolist() == [3.875, 4]
        assert [len(ring) for ring in cells.polygons(0)[0]] == [4, 3]
        for again in (pickle.loads(pickle.dumps(cells)), copy.deepcopy(cells), copy.copy(cells)):
            assert again.measures.tolist() == cells.measures.tolist()
            assert np.array_equal(again.corners(0), cells.corners(0))
    dented = [[0, 0], [4, 0], [4, 2], [2, 0.5], [0, 2]]
    assert found.clip(dented).measures.tolist() == [2.5, 2.5]
    for bad in (
        [[0, 0], [1, 1], [0, 1], [1, 0]],
        [[[0, 0], [1, 1]]],
        [[0, 0], [1, np.nan], [0, 1]],
        shapely.Point(0, 0),
        {"type": "FeatureCollection", "features": []},
        [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
    ):
        with pytest.raises(ValueError):
            found.clip(bad)
    with pytest.raises(TypeError):
        cullhull.ClippedCells()
    with pytest.raises(ValueError, match="polygons are of cells in 2D"):
        cullhull.voronoi(CUBE).clip([0, 0, 0], [1, 1, 1]).polygons(0)
    with pytest.raises(ValueError, match="faces are of cells in 3D"):
        found.clip([0, 0], [1, 1]).faces(0)


def test_plots():
    pytest.importorskip("matplotlib").use("Agg")
    points = np.random.default_rng(0).random((20, 2))
    for module in (cullhull, spatial):  # each draws the other's
        assert module.delaunay_plot_2d(cullhull.Delaunay(points)).axes
        assert module.voronoi_plot_2d(cullhull.Voronoi(points)).axes
    assert cullhull.delaunay_plot_2d(spatial.Delaunay(points)).axes
    assert cullhull.delaunay_plot_2d(cullhull.delaunay(points)).axes
    with pytest.raises(cullhull.InvalidArgument, match="in a plane or a line"):
        cullhull.delaunay_plot_2d(cullhull.delaunay([[0, 0], [1, 1]]))
    figure = cullhull.voronoi_plot_2d(spatial.Voronoi(points), show_vertices=False, line_colors="r")
    solid, dashed = figure.axes[0].collections
    their_solid, their_dashed = spatial.voronoi_plot_2d(spatial.Voronoi(points)).axes[0].collections
    for mine, other in ((solid, their_solid), (dashed, their_dashed)):
        assert np.allclose(mine.get_segments(), other.get_segments())
    cullhull.voronoi_plot_2d(cullhull.Voronoi(points, furthest_site=True), ax=figure.axes[0])
    for draw, kind in (
        (cullhull.delaunay_plot_2d, cullhull.Delaunay),
        (cullhull.voronoi_plot_2d, cullhull.Voronoi),
    ):
        with pytest.raises(ValueError, match="not 2-D"):
            draw(kind(CUBE))


# On a sphere


def on_sphere(n, dimension, seed=0):
    points = np.random.default_rng(seed).normal(size=(n, dimension))
    return points / np.linalg.norm(points, axis=1)[:, np.newaxis]


@pytest.mark.parametrize("dimension", [2, 3, 4])
def test_spherical(dimension):
    points = on_sphere(300, dimension) * 2 + 1
    ours = cullhull.SphericalVoronoi(points, 2, np.ones(dimension))
    theirs = spatial.SphericalVoronoi(points, 2, np.ones(dimension))
    mine = {frozenset(row): i for i, row in enumerate(ours._simplices.tolist())}
    order = np.array([mine[frozenset(row)] for row in theirs._simplices.tolist()])
    assert np.allclose(ours.vertices[order], theirs.vertices)
    back = np.argsort(order)
    assert [sorted(back[r]) for r in ours.regions] == [sorted(r) for r in theirs.regions]
    assert {type(v) for region in ours.regions for v in region} == {int}
    if dimension == 3:
        assert np.allclose(ours.calculate_areas(), theirs.calculate_areas())
        for mine, other in zip(ours.regions, theirs.regions):
            mine = back[mine].tolist()
            at = mine.index(other[0])
            mine = mine[at:] + mine[:at]
            assert mine == other or mine[:1] + mine[:0:-1] == other


def test_spherical_lengths_are_those_of_the_points():
    """SciPy's are those of the arcs between neighbours, in the order of its simplices."""
    angles = np.array([0.0, 1.0, 1.5, 3.0])
    points = np.column_stack([np.cos(angles), np.sin(angles)])
    gaps = np.diff(np.append(angles, angles[0] + 2 * np.pi))
    expected = (gaps + np.roll(gaps, 1)) / 2
    assert np.allclose(cullhull.SphericalVoronoi(points).calculate_areas(), expected)
    half = points[:3]  # one gap longer than half of the circle
    gaps = np.diff(np.append(angles[:3], 2 * np.pi))
    expected = (gaps + np.roll(gaps, 1)) / 2
    assert np.allclose(cullhull.SphericalVoronoi(half).calculate_areas(), expected)


def test_spherical_errors():
    points = on_sphere(50, 3)
    for bad, keywords in (
        (np.vstack([points, points[7:8] + 1e-9]), {}),
        (points, {"radius": 1.1}),
        (points, {"radius": None}),
        (points, {"center": [0.1, 0, 0]}),
        (points, {"center": [0.0, 0.0]}),
        (points * [1, 1, 0], {}),
        (np.zeros((0, 3)), {}),
        (np.full((5, 3), np.nan), {}),
    ):
        with pytest.raises(ValueError):
            cullhull.SphericalVoronoi(bad, **keywords)
    grid = np.indices((9, 9)).reshape(2, -1).T / 9
    angles = grid * [2 * np.pi, 3] + [0, 0.05]
    rings = np.column_stack([np.cos(angles[:, 0]) * np.sin(angles[:, 1]),
                             np.sin(angles[:, 0]) * np.sin(angles[:, 1]),
                             np.cos(angles[:, 1])])  # fmt: skip
    assert len(cullhull.SphericalVoronoi(rings).regions) == 81
    with pytest.raises(ValueError, match="Duplicate"):
        cullhull.SphericalVoronoi(np.vstack([rings, rings[40:41]]))
    with pytest.raises(TypeError):
        cullhull.SphericalVoronoi(on_sphere(9, 4)).sort_vertices_of_regions()
