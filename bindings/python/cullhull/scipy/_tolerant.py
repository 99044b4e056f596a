"""Stand-ins for scipy.spatial's classes in programs that assume Qhull's tolerances."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import _core
from .._errors import InvalidArgument
from .._lists import first_places
from .._options import Budgeted, Filtered, Unpack, settings, takes
from ._convex_hull import ConvexHull, raise_flat
from ._delaunay import Delaunay, Lifted
from ._incremental import Lazy
from ._merging import (
    MergedDiagram,
    Peeled,
    Scaled,
    boundary,
    merged_diagram,
    peel,
    rounding_distance,
)
from ._voronoi import Voronoi


def _checked(merge_distance: float | None) -> float | None:
    if merge_distance is None:
        return None
    merge_distance = float(merge_distance)
    if not 0 <= merge_distance < np.inf:
        raise InvalidArgument("merge_distance must be a finite number, not negative")
    return merge_distance


@takes(Filtered)
class TolerantConvexHull(ConvexHull):
    """`ConvexHull` within a stated distance, for programs that assume Qhull's tolerances.

    Points that lie in one plane but for their rounding make an exact hull with simplices of no
    area to speak of, and planes that differ in their last digits. Programs that drop such
    simplices, or compare planes, then see holes or too many faces. Here vertices within
    `merge_distance` of the hull of the others are dropped, and simplices whose vertices lie within
    it of one plane are given the same row of `equations`. What is claimed is exact: `hull` is the
    exact hull of the vertices that were kept, and no point given is farther from it than
    `distance`.

    Parameters
    ----------
    points, incremental, qhull_options : as of `ConvexHull`
    merge_distance : float, optional
        In the points' units; 0 drops nothing and merges nothing. If not given,
        ``hull.rounding_distance()``: what turning and shifting in doubles can do.
    strict : bool
        Raise `QhullError` for flat input, as SciPy does; here the default.

    Attributes
    ----------
    merge_distance : float
    dropped : int: vertices of the exact hull that were dropped
    distance : float: no point is farther from `hull`; at most `merge_distance`
    equations : (s, d + 1) float64: planes of facets of `hull`, so that no point is farther above
        one than `distance`; every vertex of a simplex is within `merge_distance` of its plane
    coplanar : with ``Qc`` the points within `merge_distance` of the boundary
    hull : the native `Hull` of the kept vertices; it is certified against those alone
    others : as of `ConvexHull`

    Examples
    --------
    >>> import numpy as np, cullhull
    >>> ring = [[np.cos(t), np.sin(t)] for t in np.arange(8) * np.pi / 4]
    >>> middle = np.add(ring, np.roll(ring, 1, axis=0)) / 2      # on the edges, but for rounding
    >>> hull = cullhull.TolerantConvexHull(np.vstack([ring, middle]))
    >>> len(hull.vertices), hull.distance < 1e-14
    (8, True)
    """

    merge_distance: float
    dropped: int
    distance: float

    def __init__(
        self,
        points: Any,
        incremental: bool = False,
        qhull_options: str | None = None,
        *,
        merge_distance: float | None = None,
        strict: bool = True,
        **options: Unpack[Filtered],
    ) -> None:
        self._asked = _checked(merge_distance)
        super().__init__(points, incremental, qhull_options, strict=strict, **options)

    def _grow(self, everything: npt.NDArray[Any], added: npt.NDArray[Any]) -> _core.Solid:
        # Vertices that were dropped before count again, and `hull` lacks them.
        return super()._grow(everything, everything if self._grower is None else added)

    def _settle(self, solid: _core.Solid) -> _core.Solid:
        distance = _core.rounding_distance(solid) if self._asked is None else self._asked
        kept, self.dropped, self.distance = _core.simplify(solid, distance, settings(self._choices))
        self.merge_distance = distance
        return kept

    @Lazy
    def equations(self) -> npt.NDArray[np.float64]:
        """(s, d + 1) float64: outward unit normal and offset of each simplex's shared plane."""
        shared = self.hull.shared_planes(self.merge_distance)
        return self.hull.facet_planes[shared[self.hull.simplex_facets]]

    def _sides(self) -> npt.NDArray[np.int8]:
        sides = super()._sides()
        near = np.abs(self.hull.distance(self._array)) <= self.merge_distance
        sides[near] = 0
        return sides


@takes(Budgeted)
class _TolerantLifted(Lifted):
    """What `TolerantDelaunay` and `TolerantVoronoi` share: the distance, and cells dropped."""

    merge_distance: float

    def __init__(
        self,
        points: Any,
        furthest_site: bool = False,
        incremental: bool = False,
        qhull_options: str | None = None,
        *,
        merge_distance: float | None = None,
        **options: Unpack[Budgeted],
    ) -> None:
        self._asked = _checked(merge_distance)
        super().__init__(points, furthest_site, incremental, qhull_options, **options)

    def _compute(self, everything: npt.NDArray[Any], added: npt.NDArray[Any]) -> None:
        before = self.__dict__.copy()
        super()._compute(everything, added)
        self.merge_distance = (
            rounding_distance(self.points) if self._asked is None else self._asked
        )
        if self._asked is not None or self._options.joggled:
            return
        try:
            self._peeled
        except InvalidArgument:  # flat but for rounding: SciPy refuses such points
            self.__dict__.clear()
            self.__dict__.update(before)
            raise_flat(everything, self.ndim - 1, "Delaunay")

    def __repr__(self) -> str:
        return f"{super().__repr__()[:-1]}, within {self.merge_distance:.2g}>"

    @Lazy
    def _scaled(self) -> Scaled:
        return Scaled.of(self.points)

    @Lazy
    def _peeled(self) -> Peeled:
        return peel(self.triangulation, self._scaled, self._tolerance)

    @property
    def _tolerance(self) -> float:
        """The distance in the units of `_scaled`."""
        return float(self._scaled.down(self.merge_distance))


@takes(Budgeted)
class TolerantDelaunay(_TolerantLifted, Delaunay):
    """`Delaunay` without flat simplices at the boundary, for programs that assume tolerances.

    Not exact, and never what another function uses. Points in one plane but for their rounding make
    an exact triangulation with simplices of no volume to speak of along the boundary. Here a
    simplex is dropped if one of its facets is at the boundary and its other corner is within
    `merge_distance` of that facet's plane; its other facets are at the boundary then, and so on
    until there is none. All other simplices are those of `Delaunay`: flat ones within stay, since
    without them there would be a hole.

    Parameters
    ----------
    points, furthest_site, incremental, qhull_options : as of `Delaunay`
    merge_distance : float, optional
        In the points' units; 0 drops nothing. If not given, 64 d^1.5 2^-53 times the largest
        coordinate, as of `TolerantConvexHull`.

    Attributes
    ----------
    merge_distance : float
    dropped : int: simplices of the exact triangulation that were dropped
    distance : float: the largest height of one that was, at most `merge_distance`
    coplanar : with ``Qc`` also points that are corners of dropped simplices alone
    triangulation : the native, exact `Triangulation`, with all simplices
    others : as of `Delaunay`, of the simplices that are left

    Raises
    ------
    InvalidArgument (a ValueError)
        As `Delaunay`; and where no simplex is thicker than a `merge_distance` that was given, when
        asked for it.
    QhullError (a RuntimeError)
        For too few points and for points in a flat, also but for their rounding, as SciPy.

    Examples
    --------
    >>> import cullhull
    >>> points = [[0, 0], [1, 1e-17], [2, 0], [1, 1]]       # three on a line, but for rounding
    >>> cullhull.Delaunay(points).simplices.tolist()
    [[0, 1, 3], [0, 2, 1], [1, 2, 3]]
    >>> found = cullhull.TolerantDelaunay(points)
    >>> found.simplices.tolist(), found.dropped, found.convex_hull.tolist()
    ([[0, 1, 3], [1, 2, 3]], 1, [[0, 1], [1, 2], [2, 3], [3, 0]])
    """

    @property
    def dropped(self) -> int:
        """Simplices of the exact triangulation that were dropped."""
        return int(self.triangulation.cell_count - self._peeled.kept.sum())

    @property
    def distance(self) -> float:
        """The largest height of a dropped simplex above the facet it was dropped through."""
        return self._peeled.distance

    @Lazy
    def _cells(self) -> npt.NDArray[np.int32]:
        return self.triangulation.cells[self._peeled.kept]

    @Lazy
    def _numbers(self) -> npt.NDArray[np.int32]:
        """The number here of each native cell's simplex, or -1; the last stands for no cell."""
        kept = self._peeled.kept
        number = np.full(len(kept) + 1, -1, dtype=np.int32)
        number[:-1][kept] = np.arange(kept.sum())
        return number

    @Lazy
    def _stand_ins(self) -> npt.NDArray[np.int32]:
        """The same, with a simplex beside it for a dropped cell: the lowest of those left, else of
        the ones that stand in for its neighbours."""
        number, neighbours = self._numbers.copy(), self.triangulation.neighbours
        missing = np.flatnonzero(~self._peeled.kept)
        while len(missing) > 0:
            beside = number[neighbours[missing]]
            found = np.where(beside < 0, np.iinfo(np.int32).max, beside).min(axis=1)
            known = (beside >= 0).any(axis=1)
            number[missing[known]] = found[known]
            missing = missing[~known]
            if not known.any():
                break
        return number

    @Lazy
    def neighbors(self) -> npt.NDArray[np.int32]:
        """(s, d + 1) int32: entry j is the simplex opposite to vertex j, or -1."""
        return self._numbers[
            self.triangulation.neighbours[self._peeled.kept]
        ]

    @Lazy
    def convex_hull(self) -> npt.NDArray[np.int32]:
        """(f, d) int32: indices of the vertices of the facets of the boundary."""
        return boundary(self._cells, self.neighbors)

    @Lazy
    def coplanar(self) -> npt.NDArray[np.int32]:
        """(c, 3) int32: each point that is no vertex, a simplex beside it, and that one's vertex
        nearest to it."""
        cells = self.triangulation.cells
        lost = np.setdiff1d(cells[~self._peeled.kept], self._cells)
        if not self._options.coplanar or len(lost) == 0:
            return Delaunay.coplanar._make(self)
        first = first_places(cells.ravel(), self.npoints) // cells.shape[1]
        beside = self._stand_ins[first[lost]]
        corners = self._cells[beside]
        away = np.abs(self.points[corners] - self.points[lost][:, np.newaxis]).max(axis=2)
        nearest = corners[np.arange(len(lost)), away.argmin(axis=1)]
        rows = [Delaunay.coplanar._make(self), np.column_stack([lost, beside, nearest])]
        return np.vstack(rows).astype(np.int32)

    def find_simplex(
        self, xi: Any, bruteforce: bool = False, tol: float | None = None
    ) -> npt.NDArray[np.int32]:
        """As `Delaunay.find_simplex`; for a point in a dropped simplex one beside it.

        Parameters
        ----------
        xi, bruteforce, tol : as of `Delaunay.find_simplex`

        Returns
        -------
        (...) int32 array

        Raises
        ------
        InvalidArgument (a ValueError)
            For another number of coordinates.

        Examples
        --------
        >>> import cullhull
        >>> int(cullhull.TolerantDelaunay([[0, 0], [1, 0], [0, 1]]).find_simplex([0.2, 0.2]))
        0
        """
        return self._stand_ins[super().find_simplex(xi, bruteforce, tol)]


    def save(
        self,
        path: str | os.PathLike[str],
        heights: Any = None,
        *,
        format: str = "",
        crs: str | None = None,
    ) -> None:
        """As `Delaunay.save`, if no simplex was dropped: files are of exact triangulations.

        Parameters
        ----------
        path, heights, format, crs : as of `Delaunay.save`

        Raises
        ------
        InvalidArgument (a ValueError)
            Where simplices were dropped; ``triangulation.save()`` writes all of them.
        FileError (an OSError), BadFile (a ValueError)
            As `Triangulation.save`.

        Examples
        --------
        >>> import cullhull
        >>> found = cullhull.TolerantDelaunay([[0, 0], [1, 1e-17], [2, 0], [1, 1]])
        >>> found.save("found.ply")
        Traceback (most recent call last):
        cullhull.InvalidArgument: 1 flat simplex was dropped; triangulation.save() writes all
        """
        if self.dropped:
            were = "simplex was" if self.dropped == 1 else "simplices were"
            raise InvalidArgument(
                f"{self.dropped} flat {were} dropped; triangulation.save() writes all"
            )
        super().save(path, heights, format=format, crs=crs)

    def _cells_shown(self) -> npt.NDArray[np.int32]:
        return self._cells

    def _boundary(self) -> npt.NDArray[np.int32]:
        return self.convex_hull

    def _groups(self) -> npt.NDArray[np.int32]:
        return self.triangulation.cell_groups[self._peeled.kept]


@takes(Budgeted)
class TolerantVoronoi(_TolerantLifted, Voronoi):
    """`Voronoi` within a stated distance, for programs that assume Qhull's tolerances.

    Not exact, and never what another function uses. Points on one sphere but for their rounding,
    such as those mirrored at a wall, make an exact diagram with several vertices a rounding apart,
    and with ridges of no size to speak of between them. Here,

    - simplices that `TolerantDelaunay` drops have their vertex at infinity: -1;
    - vertices of two neighbouring simplices are one if the corner that each has alone is within
      `merge_distance` of the other's circumsphere; also through a chain of them. The one of the
      lowest number stays. Where only one simplex has its corner there, a flat one, it takes the
      other's vertex;
    - a ridge vanishes if fewer than d vertices and flat parts of the boundary are left to it:
      neighbouring facets of the boundary are one part if each is within `merge_distance` of the
      other's plane.

    Parameters
    ----------
    points, furthest_site, incremental, qhull_options : as of `Voronoi`
    merge_distance : float, optional
        In the points' units; 0 merges nothing. If not given, 64 d^1.5 2^-53 times the largest
        coordinate, as of `TolerantConvexHull`.

    Attributes
    ----------
    merge_distance : float
    dropped : int: vertices of the exact diagram that were merged with others or with infinity
    distance : float: by how much the distances of a vertex from the points around it differ at most
    vertices, ridge_points, ridge_vertices, ridge_dict, regions : as of `Voronoi`, merged
    triangulation, diagram : the native `Triangulation` and `VoronoiDiagram`, exact; pictures, pages
        and files are of this diagram
    others : as of `Voronoi`

    Raises
    ------
    InvalidArgument (a ValueError)
        As `Voronoi`; and where no simplex is thicker than a `merge_distance` that was given, when
        asked for it.
    QhullError (a RuntimeError)
        For too few points and for points in a flat, also but for their rounding, as SciPy.

    Examples
    --------
    >>> import cullhull, numpy as np
    >>> ring = [[np.cos(t), np.sin(t)] for t in np.arange(8) * np.pi / 4 + 0.1]
    >>> len(cullhull.Voronoi(ring).vertices) > 1          # they are on no circle but for rounding
    True
    >>> found = cullhull.TolerantVoronoi(ring)
    >>> len(found.vertices), len(found.ridge_points), found.distance < 1e-15
    (1, 8, True)
    """

    @Lazy
    def _shown(self) -> MergedDiagram:
        return merged_diagram(self.diagram, self._scaled, self._peeled, self._tolerance)

    @property
    def dropped(self) -> int:
        """Vertices of the exact diagram that were merged with others or with infinity."""
        return self._shown.dropped

    @property
    def distance(self) -> float:
        """By how much the distances of a vertex from the points around it differ at most."""
        return self._shown.distance
