"""Voronoi diagrams on a sphere."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .. import _core
from .._arguments import as_points
from .._errors import InvalidArgument, NotFinite
from .._lists import collector_paused
from ._convex_hull import ConvexHull


class SphericalVoronoi:
    """In place of `scipy.spatial.SphericalVoronoi`: the Voronoi diagram of points on a sphere.

    The vertices of the diagram lie above the facets of the exact convex hull of the points.

    Parameters
    ----------
    points : (n, d) array
        Points on the sphere.
    radius : float
        Of the sphere.
    center : (d,) array, optional
        Of the sphere; the origin if not given.
    threshold : float
        A fraction of the radius: how far points may be from the sphere, and how near to each other
        they count as equal; as in SciPy.

    Attributes
    ----------
    points : (n, d) float64
    radius : float
    center : (d,) float64
    vertices : (v, d) float64: one for each simplex of the hull
    regions : list of lists of int: the vertices of the region of each point

    Raises
    ------
    InvalidArgument (a ValueError)
        For points that are not on the sphere, equal, or all on one circle.
    NotFinite (a ValueError), TypeError
        As `ConvexHull`.

    Examples
    --------
    >>> import cullhull
    >>> found = cullhull.SphericalVoronoi(
    ...     [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]])
    >>> len(found.vertices), [len(region) for region in found.regions]
    (8, [4, 4, 4, 4, 4, 4])
    >>> found.calculate_areas().round(4).tolist()[:2]    # a sixth of the sphere
    [2.0944, 2.0944]
    """

    points: npt.NDArray[np.float64]
    regions: list[list[int]]

    def __init__(
        self, points: Any, radius: float = 1, center: Any = None, threshold: float = 1e-06
    ) -> None:
        if radius is None:
            raise InvalidArgument(
                "`radius` is `None`. Please provide a floating point number (i.e. `radius=1`)."
            )
        self.radius = float(radius)
        self.points = np.array(as_points(points), dtype=np.float64)
        self._dim = self.points.shape[1]
        self.center = np.zeros(self._dim) if center is None else np.array(center, dtype=float)
        if self.center.shape != (self._dim,):
            raise InvalidArgument(f"`center` should have {self._dim} coordinates")
        self._check(threshold * self.radius)
        hull = ConvexHull(self.points)
        self.vertices = self.radius * hull.equations[:, :-1] + self.center
        self._simplices = hull.simplices
        self._neighbors = hull.neighbors
        self.regions = self._simplices_at_points(None)

    def _check(self, nearness: float) -> None:
        if len(self.points) == 0:
            raise InvalidArgument("No points given")
        if not np.isfinite(self.points).all():
            raise NotFinite("points must be finite")
        rank = np.linalg.matrix_rank(self.points - self.points[0], tol=nearness)
        if rank < self._dim:
            raise InvalidArgument(f"Rank of input points must be at least {self._dim}")
        if _has_pair_within(self.points, nearness):
            raise InvalidArgument("Duplicate generators present.")
        away = np.linalg.norm(self.points - self.center, axis=1)
        if not np.abs(away - self.radius).max() < nearness:
            raise InvalidArgument("Radius inconsistent with generators.")

    def _simplices_at_points(self, neighbors: npt.NDArray[np.int32] | None) -> list[list[int]]:
        """Ascending, or by the neighbours in rings."""
        with collector_paused():
            return _core.simplices_at(self._simplices, neighbors, len(self.points), self._dim)

    def sort_vertices_of_regions(self) -> None:
        """Sorts the vertices of each of `regions` counter-clockwise, seen from outside, in place.

        Raises
        ------
        TypeError
            If the points are not 3D.

        Examples
        --------
        >>> import cullhull
        >>> found = cullhull.SphericalVoronoi(
        ...     [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]])
        >>> found.sort_vertices_of_regions()
        >>> found.regions[0]
        [0, 1, 2, 3]
        """
        if self._dim != 3:
            raise TypeError("Only supported for three-dimensional point sets")
        for region, ring in zip(self.regions, self._simplices_at_points(self._neighbors)):
            region[:] = ring  # in place, as SciPy's

    def calculate_areas(self) -> npt.NDArray[np.float64]:
        """The area of each region; in 2D the length of its arc.

        In 3D it sorts the vertices of the regions first.

        Returns
        -------
        (n,) float64 array
            In the square of the unit of the points (in 2D in their unit); they add up to the area
            of the sphere.

        Raises
        ------
        TypeError
            In more than three dimensions.

        Examples
        --------
        >>> import cullhull
        >>> found = cullhull.SphericalVoronoi([[1, 0], [0, 1], [-1, 0]])
        >>> found.calculate_areas().round(4).tolist()
        [2.3562, 1.5708, 2.3562]
        """
        if self._dim == 2:
            return self._lengths()
        if self._dim != 3:
            raise TypeError("Only supported for 2D and 3D point sets")
        self.sort_vertices_of_regions()
        sizes = [len(region) for region in self.regions]
        ends = np.cumsum(sizes)
        owner = np.repeat(np.arange(len(sizes)), sizes)
        here = np.array([v for region in self.regions for v in region], dtype=np.intp)
        following = np.roll(here, -1)
        last = ends[np.array(sizes) > 0] - 1
        following[last] = here[(ends - sizes)[np.array(sizes) > 0]]
        angles = _solid_angles(
            (self.points[owner] - self.center) / self.radius,
            (self.vertices[here] - self.center) / self.radius,
            (self.vertices[following] - self.center) / self.radius,
        )
        areas = np.bincount(owner, weights=angles, minlength=len(sizes)) * self.radius**2
        return np.asarray(areas, dtype=np.float64)

    def _lengths(self) -> npt.NDArray[np.float64]:
        """Half of the arc to each neighbour."""
        ends = (self.points[self._simplices] - self.center) / self.radius
        middle = (self.vertices - self.center) / self.radius
        # the way round by the middle, which may be the longer one
        half = np.arctan2(
            np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) / 2,
            ((ends[:, 0] + ends[:, 1]) / 2 * middle).sum(axis=1),
        )
        lengths = np.bincount(
            self._simplices.ravel(), weights=np.repeat(half, 2), minlength=len(self.points)
        )
        return np.asarray(lengths * self.radius, dtype=np.float64)

    def __repr__(self) -> str:
        return (
            f"<SphericalVoronoi of {len(self.points)} points in {self._dim}D: "
            f"{len(self.vertices)} vertices>"
        )


def _solid_angles(
    a: npt.NDArray[np.float64], b: npt.NDArray[np.float64], c: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Solid angles of triangles of unit vectors, counter-clockwise from outside (Van Oosterom and
    Strackee)."""
    volume = (a * np.cross(b, c)).sum(axis=1)
    rest = 1 + (a * b).sum(axis=1) + (b * c).sum(axis=1) + (c * a).sum(axis=1)
    angles: npt.NDArray[np.float64] = 2 * np.arctan2(volume, rest)
    return angles


def _has_pair_within(points: npt.NDArray[np.float64], distance: float) -> bool:
    """Whether two points are that near: along any direction they are at least as near, and along
    one that no symmetric set prefers few others are."""
    direction = np.cos(np.arange(1, points.shape[1] + 1) ** 2 * 0.7)
    direction /= np.linalg.norm(direction)
    along = points @ direction
    order = np.argsort(along)
    rows, along = points[order], along[order]
    slack = distance + 4 * np.finfo(float).eps * float(np.abs(points).max()) * points.shape[1]
    for step in range(1, len(rows)):
        near = np.flatnonzero(along[step:] - along[:-step] <= slack)
        if len(near) == 0:
            return False
        apart = np.linalg.norm(rows[near + step] - rows[near], axis=1)
        if (apart <= distance).any():
            return True
    return False
