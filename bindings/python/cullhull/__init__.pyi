"""The public names, for type checkers: at run time __init__.py loads each at its first use."""

from ._alpha_shapes import (
    AlphaShape as AlphaShape,
    ConcaveHull as ConcaveHull,
    alpha_radii as alpha_radii,
    alpha_shape as alpha_shape,
    concave_hull as concave_hull,
)
from ._answers import Mesh as Mesh, NearestFacets as NearestFacets, Rays as Rays
from ._batches import (
    DeviceHullBatch as DeviceHullBatch,
    GrowingHull as GrowingHull,
    HullBatch as HullBatch,
    convex_hulls as convex_hulls,
    convex_hulls_on_device as convex_hulls_on_device,
)
from ._clipped_cells import ClippedCells as ClippedCells
from ._constrained import (
    ConstrainedTriangulation as ConstrainedTriangulation,
    constrained_delaunay as constrained_delaunay,
)
from ._core import version as __version__
from ._device import DeviceArray as DeviceArray, cuda_status as cuda_status
from ._device_hull import (
    DeviceHull as DeviceHull,
    convex_hull_on_device as convex_hull_on_device,
)
from ._errors import (
    BackendUnavailable as BackendUnavailable,
    BadFile as BadFile,
    Cancelled as Cancelled,
    Error as Error,
    FileError as FileError,
    InternalError as InternalError,
    InvalidArgument as InvalidArgument,
    NotCertified as NotCertified,
    NotFinite as NotFinite,
    OptionWarning as OptionWarning,
    OutOfBudget as OutOfBudget,
    ShapeWarning as ShapeWarning,
)
from ._functions import (
    certify as certify,
    convex_hull as convex_hull,
    cull as cull,
    generate as generate,
    shapes as shapes,
)
from ._graphs import (
    gabriel_graph as gabriel_graph,
    minimum_spanning_tree as minimum_spanning_tree,
    relative_neighbourhood_graph as relative_neighbourhood_graph,
)
from ._groups import GroupHulls as GroupHulls, hulls_by as hulls_by
from ._hull import Hull as Hull, Simplified as Simplified, load_hull as load_hull
from ._lists import Lists as Lists
from ._native import Certificate as Certificate
from ._patch import patch as patch, unpatch as unpatch
from ._streams import HullState as HullState, HullStream as HullStream
from ._tracker import HullTracker as HullTracker
from ._triangulation import Triangulation as Triangulation, delaunay as delaunay
from ._voronoi import VoronoiDiagram as VoronoiDiagram, voronoi as voronoi
from .geo._read import read as read
from .scipy._convex_hull import ConvexHull as ConvexHull
from .scipy._delaunay import Delaunay as Delaunay, tsearch as tsearch
from .scipy._halfspaces import HalfspaceIntersection as HalfspaceIntersection
from .scipy._interpolation import (
    LinearNDInterpolator as LinearNDInterpolator,
    NaturalNDInterpolator as NaturalNDInterpolator,
    NearestNDInterpolator as NearestNDInterpolator,
    griddata as griddata,
)
from .scipy._spherical import SphericalVoronoi as SphericalVoronoi
from .scipy._tolerant import (
    TolerantConvexHull as TolerantConvexHull,
    TolerantDelaunay as TolerantDelaunay,
    TolerantVoronoi as TolerantVoronoi,
)
from .scipy._voronoi import Voronoi as Voronoi
from .show._plots import (
    convex_hull_plot_2d as convex_hull_plot_2d,
    delaunay_plot_2d as delaunay_plot_2d,
    voronoi_plot_2d as voronoi_plot_2d,
)

class QhullError(Error, RuntimeError):
    """What SciPy reports with its error of the same name; a subclass of it where installed."""
