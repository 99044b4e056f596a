"""Answers that have several parts."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ._compared import tuples_differ, tuples_equal


class NearestFacets(NamedTuple):
    """Answer of `Hull.nearest_facets`: one entry a point.

    Attributes
    ----------
    facets : (m,) int64
        The facet on which a nearest point of the boundary lies.
    distances : (m,) float64
        Euclidean distance to the boundary, negative inside; units of the points.

    Examples
    --------
    >>> import cullhull
    >>> hull = cullhull.convex_hull([[0, 0], [2, 0], [2, 2], [0, 2]])
    >>> hull.nearest_facets([[1, 5]]).distances
    array([3.])
    """

    #: (m,) int64: the facet on which a nearest point of the boundary lies.
    facets: npt.NDArray[np.int64]
    #: (m,) float64: Euclidean distance to the boundary, negative inside; units of the points.
    distances: npt.NDArray[np.float64]


class Rays(NamedTuple):
    """Answer of `Hull.rays`: where the lines origin + t * direction pass through, one entry each.

    Attributes
    ----------
    hit : (m,) bool
        Whether the line meets the hull at all.
    enter, exit : (m,) float64
        Parameters t of entry and exit, enter <= exit; 0 where there is no hit.
    enter_facets, exit_facets : (m,) int64
        Facets of entry and exit; -1 where there is no hit.

    Examples
    --------
    >>> import cullhull
    >>> hull = cullhull.convex_hull([[0, 0], [2, 0], [2, 2], [0, 2]])
    >>> hull.rays([-1, 1], [[1, 0], [0, 1]]).hit
    array([ True, False])
    """

    #: (m,) bool: whether the line meets the hull at all.
    hit: npt.NDArray[np.bool_]
    #: (m,) float64: parameters t of entry and exit, enter <= exit; 0 where there is no hit.
    enter: npt.NDArray[np.float64]
    exit: npt.NDArray[np.float64]
    #: (m,) int64: facets of entry and exit; -1 where there is no hit.
    enter_facets: npt.NDArray[np.int64]
    exit_facets: npt.NDArray[np.int64]


class Mesh(NamedTuple):
    """Answer of ``mesh()``: points, and simplices that count their rows.

    Attributes
    ----------
    vertices : (v, d) float64
        Coordinates of the points that the simplices have.
    faces : (m, k) int64
        Of each simplex its corners, as rows of `vertices`.

    Examples
    --------
    >>> import cullhull
    >>> mesh = cullhull.convex_hull([[0, 0], [1, 1], [4, 0], [0, 4]]).mesh()
    >>> mesh.vertices[mesh.faces[0]].tolist()
    [[0.0, 0.0], [0.0, 4.0]]
    """

    #: (v, d) float64: coordinates of the points that the simplices have.
    vertices: npt.NDArray[np.float64]
    #: (m, k) int64: of each simplex its corners, as rows of `vertices`.
    faces: npt.NDArray[np.int64]


for _kind in (NearestFacets, Rays, Mesh):
    setattr(_kind, "__eq__", tuples_equal)
    setattr(_kind, "__ne__", tuples_differ)
