"""Graphs of points that are near each other, from their Delaunay triangulation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._options import Unpack, Watched, require_known, settings, takes
from ._triangulation import triangulated


@takes(Watched)
def minimum_spanning_tree(points: Any, **options: Unpack[Watched]) -> npt.NDArray[np.int32]:
    """The Euclidean minimum spanning tree of points in any dimension.

    Lengths are compared exactly. Of equally long edges those of lower indices come first, so there
    is one result.

    Parameters
    ----------
    points : (n, d) array, or a triangulation: of `delaunay` or a `Delaunay`

    Returns
    -------
    (n - 1, 2) int32 array
        Edges, the lower index first; rows sorted. Points with the coordinates of another hang on
        that by edges of length zero.

    Raises
    ------
    NotFinite, InvalidArgument (ValueErrors), TypeError
        As `delaunay`; also for a triangulation of the furthest site or with hidden points.
    KeyboardInterrupt

    Examples
    --------
    >>> import cullhull
    >>> cullhull.minimum_spanning_tree([[0, 0], [2, 0], [0, 1], [2, 2]]).tolist()
    [[0, 1], [0, 2], [1, 3]]
    """
    return _graph(_core.minimum_spanning_tree, points, options)


@takes(Watched)
def gabriel_graph(points: Any, **options: Unpack[Watched]) -> npt.NDArray[np.int32]:
    """The Gabriel graph: points joined where no other is in the ball between them.

    The ball is the closed one whose diameter is the edge; decided exactly, in any dimension. Of
    points with equal coordinates only the first has edges.

    Parameters
    ----------
    points : (n, d) array, or a triangulation: of `delaunay` or a `Delaunay`

    Returns
    -------
    (m, 2) int32 array
        Edges, the lower index first; rows sorted.

    Raises
    ------
    NotFinite, InvalidArgument (ValueErrors), TypeError, KeyboardInterrupt
        As `minimum_spanning_tree`.

    Examples
    --------
    >>> import cullhull
    >>> cullhull.gabriel_graph([[0, 0], [1, 0], [1, 1], [0, 1]]).tolist()
    [[0, 1], [0, 3], [1, 2], [2, 3]]
    """
    return _graph(_core.gabriel_graph, points, options)


@takes(Watched)
def relative_neighbourhood_graph(points: Any, **options: Unpack[Watched]) -> npt.NDArray[np.int32]:
    """The relative neighbourhood graph: points joined where no third is nearer to both.

    Decided exactly, in any dimension. Of points with equal coordinates only the first has edges.

    Parameters
    ----------
    points : (n, d) array, or a triangulation: of `delaunay` or a `Delaunay`

    Returns
    -------
    (m, 2) int32 array
        Edges, the lower index first; rows sorted.

    Raises
    ------
    NotFinite, InvalidArgument (ValueErrors), TypeError, KeyboardInterrupt
        As `minimum_spanning_tree`.

    Examples
    --------
    >>> import cullhull
    >>> cullhull.relative_neighbourhood_graph([[0, 0], [3, 0], [1, 1]]).tolist()
    [[0, 2], [1, 2]]
    """
    return _graph(_core.relative_neighbourhood_graph, points, options)


def _graph(
    graph: Callable[..., npt.NDArray[np.int32]], points: Any, options: Watched
) -> npt.NDArray[np.int32]:
    require_known(options, Watched)
    found = triangulated(points, **options)
    edges = graph(found._cells, settings(options, Watched))
    return edges.reshape(-1, 2)
