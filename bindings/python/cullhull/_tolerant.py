"""A stand-in for scipy.spatial.ConvexHull in programs that assume its tolerances."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._drop_in import ConvexHull
from ._errors import InvalidArgument
from ._incremental import Lazy


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
    points, incremental, qhull_options, backend, cull, threads, memory_budget, progress :
        as of `ConvexHull`
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
        **choices: Any,
    ) -> None:
        if merge_distance is not None:
            merge_distance = float(merge_distance)
            if not 0 <= merge_distance < np.inf:
                raise InvalidArgument("merge_distance must be a finite number, not negative")
        self._asked = merge_distance
        super().__init__(points, incremental, qhull_options, strict=strict, **choices)

    def add_points(self, points: Any, restart: bool = False) -> None:
        """Adds points; only with ``incremental=True``. Those dropped before count again.

        Parameters
        ----------
        points : (m, d) array
        restart : bool
            Compute the hull anew; the result is the same.

        Raises
        ------
        RuntimeError
            Not incremental, or closed.
        InvalidArgument, NotFinite (ValueErrors), QhullError
            As for the first points; nothing is added then.

        Examples
        --------
        >>> import cullhull
        >>> hull = cullhull.TolerantConvexHull([[0, 0], [1, 0], [0, 1]], incremental=True)
        >>> hull.add_points([[1, 1]])
        >>> hull.volume
        1.0
        """
        super().add_points(points, restart or self._grower is None)

    def _settle(self, solid: _core.Solid) -> _core.Solid:
        distance = _core.rounding_distance(solid) if self._asked is None else self._asked
        kept, self.dropped, self.distance = _core.simplify(solid, distance, self._settings())
        self.merge_distance = distance
        return kept

    @Lazy
    def equations(self) -> npt.NDArray[np.float64]:
        """(s, d + 1) float64: outward unit normal and offset of each simplex's shared plane."""
        shared = self.hull.shared_planes(self.merge_distance)
        planes: npt.NDArray[np.float64] = self.hull.facet_planes[shared[self.hull.simplex_facets]]
        return planes

    def _sides(self) -> npt.NDArray[np.int8]:
        sides = super()._sides()
        near = np.abs(self.hull.distance(self._array)) <= self.merge_distance
        sides[near] = 0
        return sides
