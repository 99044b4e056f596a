"""Pictures of triangulations and diagrams in the plane, in the place of scipy.spatial's."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .._errors import InvalidArgument
from .._extras import needed
from .._hull import Hull
from .._triangulation import Triangulation
from ..scipy._delaunay import Delaunay


def _axes(points: npt.NDArray[np.float64], ax: Any, what: str) -> Any:
    if points.shape[1] != 2:
        raise InvalidArgument(f"{what} is not 2-D")
    if ax is None:
        ax = needed("matplotlib.pyplot", "a picture", "plot").figure().gca()
    return ax


def _frame(ax: Any, points: npt.NDArray[np.float64]) -> None:
    margin = 0.1 * np.ptp(points, axis=0)
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    ax.set_xlim(low[0], high[0])
    ax.set_ylim(low[1], high[1])


def convex_hull_plot_2d(hull: Any, ax: Any = None) -> Any:
    """In place of `scipy.spatial.convex_hull_plot_2d`: draws points in the plane and their hull.

    Parameters
    ----------
    hull : ConvexHull, of this package or SciPy, or the `Hull` of `convex_hull`
        A `Hull` keeps no points but its vertices, so only these are drawn.
    ax : matplotlib.axes.Axes, optional
        By default the axes of a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InvalidArgument (a ValueError)
        If the points are not 2D.
    ImportError
        If Matplotlib is not installed: ``pip install 'cullhull[plot]'``.

    Examples
    --------
    >>> import cullhull
    >>> cullhull.convex_hull_plot_2d(cullhull.ConvexHull([[0, 0], [1, 0], [0, 1]]))  # doctest: +SKIP
    <Figure size 640x480 with 1 Axes>
    """
    shown = hull.points
    ax = _axes(shown, ax, "Convex hull")
    collections = needed("matplotlib.collections", "convex_hull_plot_2d()", "plot")
    ax.plot(shown[:, 0], shown[:, 1], "o")
    rows = hull.vertex_index[hull.simplices] if isinstance(hull, Hull) else hull.simplices
    edges = [shown[simplex] for simplex in rows]
    ax.add_collection(collections.LineCollection(edges, colors="k", linestyle="solid"))
    if len(shown):
        _frame(ax, shown)
    return ax.figure


def delaunay_plot_2d(tri: Any, ax: Any = None) -> Any:
    """In place of `scipy.spatial.delaunay_plot_2d`: draws a triangulation in the plane.

    Parameters
    ----------
    tri : Delaunay, of this package or SciPy, or the `Triangulation` of `delaunay`
    ax : matplotlib.axes.Axes, optional
        A new figure's if not given.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InvalidArgument (a ValueError)
        In other dimensions, and for points on a line.
    ImportError
        Without Matplotlib.

    Examples
    --------
    >>> import cullhull
    >>> cullhull.delaunay_plot_2d(cullhull.Delaunay([[0, 0], [1, 0], [0, 1]]))  # doctest: +SKIP
    <Figure size 640x480 with 1 Axes>
    """
    if isinstance(tri, Triangulation):
        tri = Delaunay._of(tri)
    points = tri.points
    ax = _axes(points, ax, "Delaunay triangulation")
    ax.plot(points[:, 0], points[:, 1], "o")
    ax.triplot(points[:, 0], points[:, 1], tri.simplices.copy())
    _frame(ax, points)
    return ax.figure


def voronoi_plot_2d(
    vor: Any,
    ax: Any = None,
    *,
    show_points: bool = True,
    show_vertices: bool = True,
    line_colors: Any = "k",
    line_width: float = 1.0,
    line_alpha: float = 1.0,
    point_size: float | None = None,
) -> Any:
    """In place of `scipy.spatial.voronoi_plot_2d`: draws a diagram in the plane.

    Parameters
    ----------
    vor : Voronoi, of this package or SciPy
    ax : matplotlib.axes.Axes, optional
        A new figure's if not given.
    show_points, show_vertices : bool
    line_colors, line_width, line_alpha, point_size
        As Matplotlib takes them.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    As `delaunay_plot_2d`.

    Examples
    --------
    >>> import cullhull
    >>> square = [[0, 0], [1, 0], [0, 1], [1, 1]]
    >>> cullhull.voronoi_plot_2d(cullhull.Voronoi(square))  # doctest: +SKIP
    <Figure size 640x480 with 1 Axes>
    """
    points = vor.points
    ax = _axes(points, ax, "Voronoi diagram")
    from matplotlib.collections import LineCollection

    if show_points:
        ax.plot(points[:, 0], points[:, 1], ".", markersize=point_size)
    if show_vertices:
        ax.plot(vor.vertices[:, 0], vor.vertices[:, 1], "o")
    bounded, rays = _segments(vor)
    for lines, style in ((bounded, "solid"), (rays, "dashed")):
        ax.add_collection(
            LineCollection(
                lines, colors=line_colors, lw=line_width, alpha=line_alpha, linestyle=style
            )
        )
    _frame(ax, points)
    return ax.figure


def _segments(vor: Any) -> tuple[list[Any], list[Any]]:
    """Edges between vertices, and unbounded ones as far as a picture reaches."""
    points, middle = vor.points, vor.points.mean(axis=0)
    extent = np.ptp(points, axis=0)
    reach = extent.max() * abs(extent.max() / extent.min())
    bounded, rays = [], []
    for (a, b), ends in zip(vor.ridge_points, vor.ridge_vertices):
        finite = [v for v in ends if v >= 0]
        if len(finite) == len(ends):
            bounded.append(vor.vertices[finite])
            continue
        along = points[b] - points[a]
        normal = np.array([-along[1], along[0]]) / np.linalg.norm(along)
        outward = np.sign(((points[a] + points[b]) / 2 - middle) @ normal)
        if vor.furthest_site:
            outward = -outward
        begin = vor.vertices[finite[0]]
        rays.append([begin, begin + outward * reach * normal])
    return bounded, rays
