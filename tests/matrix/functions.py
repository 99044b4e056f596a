"""Python's half of the table: every public name, called with points of every kind by every door.

A `Call` is an expression. In it `p` are the points as a door gives them, `a` the same as an array
of doubles, `b` 24 points in general position, `d` the dimension, `v` a number for each of `p`, `vb`
one for each of `b`, `w` weights, `low` and `high` a box.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Callable, Optional

from doors import always, of_dimensions
from sets import PointSet

Reason = Callable[[PointSet], Optional[str]]


@dataclass(frozen=True)
class Call:
    name: str
    text: str
    reason: Reason = always
    #: The error that a set raises, if it does: a class of Python's, SciPy's or the package's.
    raises: Callable[[PointSet], Optional[str]] = lambda s: None if s.finite else "NotFinite"
    derive: Optional[str] = None  #: the points are made of the set's: 'halfspaces', 'sphere'
    arrays: str = "few"  #: 'all': a short run tries every door
    #: Doors without meaning, and why.
    without: dict[str, str] = field(default_factory=dict)


#: SciPy's classes of interpolation take a tuple for one array an axis.
AXES = {"tuples": "SciPy takes a tuple for one array an axis"}

PLANE, SPACE = of_dimensions(2), of_dimensions(3)
UP_TO_SPACE = of_dimensions(1, 2, 3)
NOT_LINE = of_dimensions(2, 3, 4)


def enough(least: int) -> Reason:
    return lambda s: None if s.count >= least else f"fewer than {least} points"


def in_range(s: PointSet) -> Optional[str]:
    return "squares leave the doubles" if s.kind in ("huge", "tiny", "wide") else None


def on_sphere(s: PointSet) -> Optional[str]:
    return None if s.name in ("lattice-3d", "nan-3d") else "points are to lie on a sphere"


def every(*reasons: Reason) -> Reason:
    return lambda s: next((r for r in (check(s) for check in reasons) if r), None)


def not_finite(s: PointSet) -> Optional[str]:
    return None if s.finite else "NotFinite"


def as_scipy(s: PointSet) -> Optional[str]:
    """What SciPy's classes raise where there is no triangulation of the whole space."""
    if not s.finite or s.count == 0 or s.dimension < 2:
        return "ValueError"
    return "QhullError" if s.affine_dimension < s.dimension else None


def asked_as_scipy(s: PointSet) -> Optional[str]:
    """Questions that are not finite: SciPy answers NaN or -1."""
    return "ValueError" if s.dimension < 2 else None


def nearest_as_scipy(s: PointSet) -> Optional[str]:
    if s.dimension < 2 or s.count == 0:
        return "ValueError"
    return not_finite(s)


def nearest_asked(s: PointSet) -> Optional[str]:
    return "ValueError" if s.dimension < 2 or not s.finite else None


def hull_as_scipy(s: PointSet) -> Optional[str]:
    return "ValueError" if not s.finite or s.count == 0 or s.dimension < 2 else None


def added(s: PointSet) -> Optional[str]:
    """No points may be added to others."""
    return "ValueError" if not s.finite or s.dimension < 2 else None


def natural(s: PointSet) -> Optional[str]:
    return "ValueError" if s.dimension > 3 else as_scipy(s)


def natural_asked(s: PointSet) -> Optional[str]:
    return "InvalidArgument" if s.dimension > 3 else asked_as_scipy(s)


def rays(s: PointSet) -> Optional[str]:
    return "InvalidArgument" if s.kind in ("huge", "wide") else not_finite(s)


def adding(kind: str) -> Call:
    """`add_points` of a class in SciPy's place."""
    text = f"(made := cullhull.{kind}(b, incremental=True)).add_points(p) or made"
    return Call(f"{kind}.add_points", text, raises=added)


def interpolator(
    name: str, text: str, raises: Reason, reason: Reason = always, arrays: str = "few"
) -> Call:
    """A call of the class or function with which the name begins."""
    called = re.split("[ .]", name)[0]
    return Call(name, f"cullhull.{called}{text}", reason, raises, arrays=arrays, without=AXES)


def spherical(method: str = "", text: str = "cullhull.SphericalVoronoi(p)", **more: str) -> Call:
    return Call(f"SphericalVoronoi{method}", text, on_sphere, derive="sphere", **more)


CALLS = (
    Call("convex_hull", "cullhull.convex_hull(p)", arrays="all"),
    Call("convex_hull certified", "cullhull.convex_hull(p, certify=True)"),
    Call("cull", "cullhull.cull(p)", arrays="all"),
    Call("certify", "cullhull.certify(p, cullhull.convex_hull(p))"),
    Call("Hull.certify", "cullhull.convex_hull(p).certify(p)"),
    Call("delaunay", "cullhull.delaunay(p)", arrays="all"),
    Call("delaunay weighted", "cullhull.delaunay(p, w)"),
    Call("delaunay furthest", "cullhull.delaunay(p, furthest_site=True)"),
    Call("delaunay certified", "cullhull.delaunay(p, certify=True)"),
    Call("Triangulation.certify", "cullhull.delaunay(p).certify()"),
    Call("voronoi", "cullhull.voronoi(p)", arrays="all"),
    Call("VoronoiDiagram.clip", "cullhull.voronoi(p).clip(low, high)", UP_TO_SPACE),
    Call("alpha_shape", "cullhull.alpha_shape(p)"),
    Call("alpha_shape of a number", "cullhull.alpha_shape(p, 20.0)"),
    Call("AlphaShape.polygons", "cullhull.alpha_shape(p).polygons()", PLANE),
    Call("alpha_radii", "cullhull.alpha_radii(p)"),
    Call("concave_hull", "cullhull.concave_hull(p, 0.3)", PLANE),
    Call(
        "constrained_delaunay",
        "cullhull.constrained_delaunay(p, [[0, 1], [2, 3]])",
        every(PLANE, enough(4)),
    ),
    Call("convex_hulls of a list", "cullhull.convex_hulls([p, p])"),
    Call("convex_hulls", "cullhull.convex_hulls(p, [0, len(a) // 2, len(a)])", arrays="all"),
    Call("hulls_by", "cullhull.hulls_by(p, np.arange(len(a)) % 3)", arrays="all"),
    Call("GroupHulls.members", "cullhull.hulls_by(p, np.arange(len(a)) % 3).members(1)", enough(2)),
    Call("minimum_spanning_tree", "cullhull.minimum_spanning_tree(p)"),
    Call("gabriel_graph", "cullhull.gabriel_graph(p)"),
    Call("relative_neighbourhood_graph", "cullhull.relative_neighbourhood_graph(p)"),
    Call("HullState", "cullhull.HullState(p, 5)", arrays="all"),
    Call("HullState.hull", "cullhull.HullState(p).hull()"),
    Call("HullState.merge", "cullhull.HullState(p).merge(cullhull.HullState(b, len(a)))"),
    Call("HullState.shifted", "cullhull.HullState(p).shifted(7)"),
    Call("HullState.to_arrays", "cullhull.HullState(p).to_arrays()"),
    Call(
        "HullStream.push",
        "(stream := cullhull.HullStream()).push(p) or stream.hull()",
        arrays="all",
    ),
    Call("HullStream.extend", "(stream := cullhull.HullStream()).extend([p]) or stream.state()"),
    Call(
        "HullTracker.update",
        "(t := cullhull.HullTracker()) and [t.update(b), t.update(p)]",
        arrays="all",
    ),
    Call(
        "HullTracker.reset",
        "(t := cullhull.HullTracker()) and [t.update(b), t.reset(), t.update(p)]",
    ),
    Call("GrowingHull.add", "[(g := cullhull.GrowingHull(d)).add(p), g.hull]", arrays="all"),
    Call("ConvexHull", "cullhull.ConvexHull(p)", arrays="all", raises=hull_as_scipy),
    adding("ConvexHull"),
    Call(
        "ConvexHull.close",
        "[(h := cullhull.ConvexHull(p, incremental=True)).close(), h.vertices]",
        raises=hull_as_scipy,
    ),
    Call("TolerantConvexHull", "cullhull.TolerantConvexHull(p)", raises=as_scipy),
    adding("TolerantConvexHull"),
    Call("Delaunay", "cullhull.Delaunay(p)", arrays="all", raises=as_scipy),
    adding("Delaunay"),
    Call("Delaunay.find_simplex", "cullhull.Delaunay(b).find_simplex(p)", raises=asked_as_scipy),
    Call("Delaunay.lift_points", "cullhull.Delaunay(b).lift_points(p)", raises=asked_as_scipy),
    Call(
        "Delaunay.plane_distance", "cullhull.Delaunay(b).plane_distance(p)", raises=asked_as_scipy
    ),
    Call("tsearch", "cullhull.tsearch(cullhull.Delaunay(b), p)", raises=asked_as_scipy),
    Call("Voronoi", "cullhull.Voronoi(p)", arrays="all", raises=as_scipy),
    adding("Voronoi"),
    Call("TolerantDelaunay", "cullhull.TolerantDelaunay(p)", arrays="all", raises=as_scipy),
    adding("TolerantDelaunay"),
    Call(
        "TolerantDelaunay.find_simplex",
        "cullhull.TolerantDelaunay(b).find_simplex(p)",
        raises=asked_as_scipy,
    ),
    Call("TolerantVoronoi", "cullhull.TolerantVoronoi(p)", arrays="all", raises=as_scipy),
    adding("TolerantVoronoi"),
    Call(
        "HalfspaceIntersection",
        "cullhull.HalfspaceIntersection(p, np.zeros(d))",
        in_range,
        derive="halfspaces",
        arrays="all",
        raises=hull_as_scipy,
    ),
    Call(
        "HalfspaceIntersection.add_halfspaces",
        "(h := cullhull.HalfspaceIntersection(hb, np.zeros(d), incremental=True))"
        ".add_halfspaces(p) or h",
        in_range,
        derive="halfspaces",
        raises=added,
    ),
    spherical(arrays="all"),
    spherical(".calculate_areas", "cullhull.SphericalVoronoi(p).calculate_areas()"),
    spherical(
        ".sort_vertices_of_regions",
        "(v := cullhull.SphericalVoronoi(p)).sort_vertices_of_regions() or v",
    ),
    interpolator("LinearNDInterpolator", "(p, v)(b)", as_scipy, arrays="all"),
    interpolator("LinearNDInterpolator itself", "(p, v)", as_scipy),
    interpolator("NaturalNDInterpolator itself", "(p, v)", natural),
    interpolator("NearestNDInterpolator itself", "(p, v)", nearest_as_scipy),
    interpolator("LinearNDInterpolator asked", "(b, vb)(p)", asked_as_scipy),
    interpolator("NaturalNDInterpolator", "(p, v)(b)", natural, arrays="all"),
    interpolator("NaturalNDInterpolator asked", "(b, vb)(p)", natural_asked),
    interpolator(
        "NaturalNDInterpolator.neighbours", "(p, v).neighbours(b.mean(axis=0))", natural
    ),
    interpolator("NearestNDInterpolator", "(p, v)(b)", nearest_as_scipy, arrays="all"),
    interpolator("NearestNDInterpolator asked", "(b, vb)(p)", nearest_asked),
    interpolator("griddata", "(p, v, b)", as_scipy, NOT_LINE, arrays="all"),
    interpolator("griddata asked", "(b, vb, p)", asked_as_scipy, NOT_LINE),
    Call("Hull.contains", "cullhull.convex_hull(b).contains(p)", arrays="all"),
    Call("Hull.sides", "cullhull.convex_hull(b).sides(p)"),
    Call("Hull.distance", "cullhull.convex_hull(b).distance(p)"),
    Call("Hull.nearest_facets", "cullhull.convex_hull(b).nearest_facets(p)"),
    Call("Hull.support", "cullhull.convex_hull(b).support(p)"),
    Call("Hull.rays", "cullhull.convex_hull(b).rays(p, np.ones_like(a))", raises=rays),
    Call(
        "Hull.visible_from",
        "[cullhull.convex_hull(b).visible_from(list(q)) for q in np.asarray(p)]",
    ),
    Call("Hull.simplify", "cullhull.convex_hull(p).simplify(2.0)"),
    Call("Hull.shared_planes", "cullhull.convex_hull(p).shared_planes(0.5)"),
    Call("Hull.rounding_distance", "cullhull.convex_hull(p).rounding_distance()"),
    Call("Triangulation.find_simplex", "cullhull.delaunay(b).find_simplex(p)", arrays="all"),
    Call("Triangulation.nearest", "cullhull.delaunay(b).nearest(p)"),
    Call("Triangulation.barycentric", "cullhull.delaunay(b).barycentric(p)"),
    Call(
        "ClippedCells.corners",
        "(c := cullhull.voronoi(p).clip(low, high)) and [c.corners(i) for i in range(len(c))]",
        UP_TO_SPACE,
    ),
    Call(
        "ClippedCells.polygons",
        "(c := cullhull.voronoi(p).clip([low, [high[0], low[1]], high, (low + high) / 2, "
        "[low[0], high[1]]])) and [c.polygons(i) for i in range(len(c))]",
        PLANE,
    ),
    Call(
        "ClippedCells.faces",
        "(c := cullhull.voronoi(p).clip(low, high)) and [c.faces(i) for i in range(len(c))]",
        SPACE,
    ),
    Call("Hull.mesh", "cullhull.convex_hull(p).mesh()"),
    Call("HullBatch.mesh", "cullhull.convex_hulls([p, p]).mesh()"),
    Call("GroupHulls.mesh", "cullhull.hulls_by(p, np.zeros(len(a))).mesh()"),
    Call("Triangulation.mesh", "cullhull.delaunay(p).mesh()"),
    Call(
        "ConstrainedTriangulation.mesh",
        "cullhull.constrained_delaunay(p, [[0, 1]]).mesh()",
        every(PLANE, enough(2)),
    ),
    Call("AlphaShape.mesh", "cullhull.alpha_shape(p).mesh()"),
    Call("ClippedCells.mesh", "cullhull.voronoi(p).clip(low, high).mesh()", UP_TO_SPACE),
    Call("ConvexHull.mesh", "cullhull.ConvexHull(p).mesh()", raises=hull_as_scipy),
    Call("Delaunay.mesh", "cullhull.Delaunay(p).mesh()", raises=as_scipy),
    Call("Lists.lengths", "cullhull.convex_hull(p).facets.lengths()"),
    Call("Lists.tolist", "cullhull.convex_hull(p).facets.tolist()"),
)

#: Public names without a `Call`, and why.
_ERRORS = """BackendUnavailable BadFile Cancelled Error FileError InternalError InvalidArgument
    NotCertified NotFinite OutOfBudget QhullError""".split()
_RESULTS = """AlphaShape Certificate ClippedCells ConcaveHull ConstrainedTriangulation GroupHulls
    Hull HullBatch Lists Mesh NearestFacets Rays Simplified Triangulation VoronoiDiagram""".split()
_OF_DEVICES = """DeviceArray DeviceHull DeviceHullBatch convex_hull_on_device convex_hulls_on_device
    cuda_status""".split()
ELSEWHERE = {
    **dict.fromkeys(_ERRORS, "an error: the cells hold which set raises which"),
    "OptionWarning": "a warning: test_qhull_options",
    "ShapeWarning": "a warning: test_arrays",
    **dict.fromkeys(_RESULTS, "a result: made by a function, compared member by member"),
    **dict.fromkeys(_OF_DEVICES, "needs a device: tests/gpu"),
    "__version__": "a text",
    "convex_hull_plot_2d": "an output: the cells 'plot'",
    "delaunay_plot_2d": "an output: the cells 'plot'",
    "voronoi_plot_2d": "an output: the cells 'plot'",
    "generate": "makes points: across.py",
    "shapes": "makes points: across.py",
    "read": "takes files: the cells 'read' of across.py",
    "patch": "changes other packages: test_patch",
    "unpatch": "changes other packages: test_patch",
    "load_hull": "takes files: test_hull",
}

_DRAWN = """AlphaShape ClippedCells ConcaveHull ConstrainedTriangulation ConvexHull Delaunay
    GroupHulls Hull HullBatch HullState TolerantConvexHull TolerantDelaunay TolerantVoronoi
    Triangulation Voronoi VoronoiDiagram""".split()
_DIAGRAMS = ("HullState", "TolerantVoronoi", "Voronoi", "VoronoiDiagram")
_EXPORTED = tuple(kind for kind in _DRAWN if kind not in _DIAGRAMS)

_CLOSED = """Delaunay Voronoi HalfspaceIntersection TolerantConvexHull TolerantDelaunay
    TolerantVoronoi""".split()

#: Public methods of results without a `Call`, and why.
METHODS_ELSEWHERE = {
    **{f"{kind}.plot": "an output: the cells 'plot'" for kind in _DRAWN},
    **{f"{kind}.save": "an output: the cells 'save'" for kind in _DRAWN},
    **{f"{kind}.view": "starts the program, whose row is `view`" for kind in _DRAWN},
    **{
        f"{kind}.{way}": "an object of another package: test_exports"
        for kind in _EXPORTED
        for way in ("to_trimesh", "to_pyvista", "to_open3d", "to_shapely")
    },
    "ClippedCells.to_geopandas": "an object of another package: test_maps",
    "ConcaveHull.mesh": "inherited: AlphaShape.mesh",
    "TolerantConvexHull.mesh": "inherited: ConvexHull.mesh",
    "TolerantDelaunay.mesh": "inherited: Delaunay.mesh",
    "HullState.load": "an output: the cells 'save'",
    "HullStream.hull": "asked by HullStream.push",
    "HullStream.state": "asked by HullStream.extend",
    **{f"{kind}.close": "inherited: ConvexHull.close" for kind in _CLOSED},
    "TolerantDelaunay.lift_points": "inherited: Delaunay.lift_points",
    "TolerantDelaunay.plane_distance": "inherited: Delaunay.plane_distance",
    "ConcaveHull.polygons": "inherited: AlphaShape.polygons",
    **dict.fromkeys(
        ("GroupHulls.get", "GroupHulls.items", "GroupHulls.keys", "GroupHulls.values"),
        "of every mapping",
    ),
    **dict.fromkeys(
        (
            f"{c}.{m}"
            for c in ("HullBatch", "Lists", "Mesh", "NearestFacets", "Rays", "Simplified")
            for m in ("count", "index")
        ),
        "of every sequence",
    ),
}
