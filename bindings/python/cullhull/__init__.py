"""Exact convex hulls of very large point sets, in any dimension.

>>> import cullhull
>>> points = cullhull.generate("ball", 100_000, 3)
>>> hull = cullhull.convex_hull(points)
>>> hull.affine_dimension
3
>>> bool(hull.contains(points).all())
True

`convex_hull` is the native function; `ConvexHull` and `HalfspaceIntersection` stand in for SciPy's
classes of the same names, `TolerantConvexHull`, `TolerantDelaunay` and `TolerantVoronoi` for
programs that assume tolerances. docs/python.md in the source tree has the rest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._alpha_shapes import AlphaShape, ConcaveHull, alpha_radii, alpha_shape, concave_hull
from ._answers import Mesh, NearestFacets, Rays
from ._batches import (
    DeviceHullBatch,
    GrowingHull,
    HullBatch,
    convex_hulls,
    convex_hulls_on_device,
)
from ._clipped_cells import ClippedCells
from ._constrained import ConstrainedTriangulation, constrained_delaunay
from ._core import version as __version__
from ._device import DeviceArray, cuda_status
from ._errors import (
    BackendUnavailable,
    BadFile,
    Cancelled,
    Error,
    FileError,
    InternalError,
    InvalidArgument,
    NotCertified,
    NotFinite,
    OptionWarning,
    OutOfBudget,
    ShapeWarning,
)
from ._functions import certify, convex_hull, cull, generate, shapes
from ._graphs import gabriel_graph, minimum_spanning_tree, relative_neighbourhood_graph
from ._groups import GroupHulls, hulls_by
from ._hull import Hull, Simplified, load_hull
from ._lists import Lists
from ._native import Certificate
from ._streams import HullState, HullStream
from ._tracker import HullTracker
from ._triangulation import Triangulation, delaunay
from ._voronoi import VoronoiDiagram, voronoi
from .geo._read import read
from .scipy._convex_hull import ConvexHull
from .scipy._delaunay import Delaunay, tsearch
from .scipy._halfspaces import HalfspaceIntersection
from .scipy._interpolation import (
    LinearNDInterpolator,
    NaturalNDInterpolator,
    NearestNDInterpolator,
    griddata,
)
from .scipy._spherical import SphericalVoronoi
from .scipy._tolerant import TolerantConvexHull, TolerantDelaunay, TolerantVoronoi
from .scipy._voronoi import Voronoi
from .show._plots import convex_hull_plot_2d, delaunay_plot_2d, voronoi_plot_2d

if TYPE_CHECKING:

    class QhullError(Error, RuntimeError):
        """What SciPy reports with its error of the same name; a subclass of it where installed."""


__all__ = [
    "AlphaShape",
    "BackendUnavailable",
    "BadFile",
    "Cancelled",
    "Certificate",
    "ClippedCells",
    "ConcaveHull",
    "ConstrainedTriangulation",
    "ConvexHull",
    "Delaunay",
    "DeviceArray",
    "DeviceHullBatch",
    "Error",
    "FileError",
    "GroupHulls",
    "GrowingHull",
    "HalfspaceIntersection",
    "Hull",
    "HullBatch",
    "HullState",
    "HullStream",
    "HullTracker",
    "InternalError",
    "InvalidArgument",
    "LinearNDInterpolator",
    "Lists",
    "Mesh",
    "NaturalNDInterpolator",
    "NearestFacets",
    "NearestNDInterpolator",
    "NotCertified",
    "NotFinite",
    "OptionWarning",
    "OutOfBudget",
    "QhullError",
    "Rays",
    "ShapeWarning",
    "Simplified",
    "SphericalVoronoi",
    "TolerantConvexHull",
    "TolerantDelaunay",
    "TolerantVoronoi",
    "Triangulation",
    "Voronoi",
    "VoronoiDiagram",
    "__version__",
    "alpha_radii",
    "alpha_shape",
    "certify",
    "concave_hull",
    "constrained_delaunay",
    "convex_hull",
    "convex_hull_plot_2d",
    "convex_hulls",
    "convex_hulls_on_device",
    "cuda_status",
    "cull",
    "delaunay",
    "delaunay_plot_2d",
    "gabriel_graph",
    "generate",
    "griddata",
    "hulls_by",
    "load_hull",
    "minimum_spanning_tree",
    "read",
    "relative_neighbourhood_graph",
    "shapes",
    "tsearch",
    "voronoi",
    "voronoi_plot_2d",
]


def __getattr__(name: str) -> Any:
    if name == "QhullError":  # importing SciPy for it takes longer than most hulls
        from ._errors import qhull_error

        return qhull_error()
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
