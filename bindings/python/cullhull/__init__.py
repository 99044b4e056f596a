"""Exact convex hulls of very large point sets, in any dimension.

>>> import cullhull
>>> points = cullhull.generate("ball", 100_000, 3)
>>> hull = cullhull.convex_hull(points)
>>> hull.affine_dimension
3
>>> bool(hull.contains(points).all())
True

`convex_hull` is the native function; `ConvexHull` and `HalfspaceIntersection` stand in for SciPy's
classes of the same names (`patch` puts them there), `TolerantConvexHull`, `TolerantDelaunay` and
`TolerantVoronoi` for programs that assume tolerances. docs/python.md in the source tree has the rest.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

from ._core import version as __version__

#: The public names of each module, which is loaded when one of them is first asked for: all of
#: them take longer than most hulls. __init__.pyi has them for type checkers.
_NAMES = {
    "._alpha_shapes": "AlphaShape ConcaveHull alpha_radii alpha_shape concave_hull",
    "._answers": "Mesh NearestFacets Rays",
    "._batches": "DeviceHullBatch GrowingHull HullBatch convex_hulls convex_hulls_on_device",
    "._clipped_cells": "ClippedCells",
    "._constrained": "ConstrainedTriangulation constrained_delaunay",
    "._device": "DeviceArray cuda_status",
    "._device_hull": "DeviceHull convex_hull_on_device",
    "._errors": (
        "BackendUnavailable BadFile Cancelled Error FileError InternalError InvalidArgument "
        "NotCertified NotFinite OptionWarning OutOfBudget ShapeWarning"
    ),
    "._functions": "certify convex_hull cull generate shapes",
    "._graphs": "gabriel_graph minimum_spanning_tree relative_neighbourhood_graph",
    "._groups": "GroupHulls hulls_by",
    "._hull": "Hull Simplified load_hull",
    "._lists": "Lists",
    "._native": "Certificate",
    "._patch": "patch unpatch",
    "._streams": "HullState HullStream",
    "._tracker": "HullTracker",
    "._triangulation": "Triangulation delaunay",
    "._voronoi": "VoronoiDiagram voronoi",
    ".geo._read": "read",
    ".scipy._convex_hull": "ConvexHull",
    ".scipy._delaunay": "Delaunay tsearch",
    ".scipy._halfspaces": "HalfspaceIntersection",
    ".scipy._interpolation": (
        "LinearNDInterpolator NaturalNDInterpolator NearestNDInterpolator griddata"
    ),
    ".scipy._spherical": "SphericalVoronoi",
    ".scipy._tolerant": "TolerantConvexHull TolerantDelaunay TolerantVoronoi",
    ".scipy._voronoi": "Voronoi",
    ".show._plots": "convex_hull_plot_2d delaunay_plot_2d voronoi_plot_2d",
}
_MODULES = {name: module for module, names in _NAMES.items() for name in names.split()}

__all__ = sorted([*_MODULES, "QhullError", "__version__"])


def __getattr__(name: str) -> Any:
    if name == "QhullError":  # importing SciPy for it takes longer than most hulls
        from ._errors import qhull_error

        return qhull_error()
    if name in ("geo", "scipy", "show"):
        return import_module(f".{name}", __name__)
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    found = globals()[name] = getattr(import_module(_MODULES[name], __name__), name)
    return found


def __dir__() -> list[str]:
    return __all__
