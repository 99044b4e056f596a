"""The class that stands in for scipy.spatial.HalfspaceIntersection."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .. import _core
from .._arguments import as_points
from .._errors import InvalidArgument, qhull_error
from .._hull import Hull
from .._options import Budgeted, Unpack, require_known, settings, takes
from ._incremental import Incremental, Lazy
from ._qhull_options import parse


@takes(Budgeted)
class HalfspaceIntersection(Incremental):
    """In place of `scipy.spatial.HalfspaceIntersection`: the polyhedron that halfspaces bound.

    The dual points are rounded to doubles; the combinatorial result is exact for the halfspaces of
    these rounded points. Pickles and copies, also while incremental.

    Parameters
    ----------
    halfspaces : (m, d + 1) array
        Rows ``[a, b]`` of the inequalities ``a @ x + b <= 0``.
    interior_point : (d,) array, optional
        A point strictly inside all halfspaces. Linear programming finds one if it is not given.
    incremental : bool
        Allow `add_halfspaces`.
    qhull_options : str, optional
        As in `ConvexHull`; ``QGn`` raises, ``Qc`` and ``Qi`` have no effect.

    Attributes
    ----------
    ndim, nineq, npoints : int: d, m, m
    min_bound, max_bound : (d + 1,) float64: of the rows of halfspaces
    halfspaces : (m, d + 1) float64
    interior_point : (d,) float64
    intersections : (v, d) float64: the vertices of the polyhedron, one for each dual facet; not
        finite where the polyhedron is unbounded
    dual_points : (m, d) float64: ``-a / (a @ interior_point + b)`` of each row
    dual_facets : list of lists of int: the dual hull's facets, coplanar pieces merged
    dual_vertices : (w,) int64, ascending: halfspaces that bound the polyhedron
    dual_equations : (v, d + 1) float64: planes of the dual facets, outward unit normal and offset
    dual_area, dual_volume : float: of the dual hull
    is_bounded : bool: whether the polyhedron is bounded
    dual : the dual's native `Hull`
    polyhedron : the native `Hull` of `intersections`, if bounded

    Raises
    ------
    QhullError (a RuntimeError)
        If the interior point is not strictly inside a halfspace.
    InvalidArgument, NotFinite (ValueErrors), TypeError
        For another shape or type, a NaN or an infinity, and where no interior point is found.
    OutOfBudget (a MemoryError), KeyboardInterrupt

    Examples
    --------
    >>> import cullhull
    >>> square = [[-1.0, 0, 0], [0, -1, 0], [1, 0, -2], [0, 1, -2]]
    >>> cut = cullhull.HalfspaceIntersection(square, [1.0, 1.0])
    >>> cut
    <HalfspaceIntersection of 4 halfspaces in 2D: 4 vertices, bounded>
    >>> cut.intersections.tolist()
    [[0.0, 2.0], [0.0, 0.0], [2.0, 0.0], [2.0, 2.0]]
    """

    dual: Hull
    is_bounded: bool
    interior_point: npt.NDArray[np.float64]
    dual_points: npt.NDArray[np.float64]
    intersections: npt.NDArray[np.float64]

    def __init__(
        self,
        halfspaces: Any,
        interior_point: Any = None,
        incremental: bool = False,
        qhull_options: str | None = None,
        **options: Unpack[Budgeted],
    ) -> None:
        require_known(options, Budgeted)
        array = as_points(halfspaces, "halfspaces")
        if array.shape[0] == 0:
            raise InvalidArgument("No halfspaces given")
        self.ndim = array.shape[1] - 1
        if self.ndim < 2:
            raise InvalidArgument("Need at least 2-D data")
        if parse(qhull_options).good_point is not None:
            raise InvalidArgument("QGn leaves a point out, which halfspaces have no use for")
        self._choices = options
        if interior_point is not None:
            point = as_points(np.atleast_1d(interior_point), "interior_point", axes=1)
            if point.shape != (self.ndim,):
                raise InvalidArgument(
                    f"Feasible point must be a (ndim-1,) array: ({self.ndim},), not {point.shape}"
                )
            interior_point = point.astype(np.float64)
        self._open = bool(incremental)
        self._compute(array, interior_point)

    def _compute(
        self, halfspaces: npt.NDArray[Any], interior: npt.NDArray[np.float64] | None
    ) -> None:
        if interior is not None:
            _require_feasible(halfspaces, interior)
        point = None if interior is None else interior[np.newaxis, :]
        chosen = settings(self._choices)
        result = _core.intersect_halfspaces(halfspaces, point, chosen)
        self._array = halfspaces
        self.interior_point, self.dual_points, solid, self.is_bounded, self.intersections = result
        self.dual = Hull._of(solid)
        self._forget()

    def add_halfspaces(self, halfspaces: Any, restart: bool = False) -> None:
        """Adds halfspaces; only with ``incremental=True``.

        Parameters
        ----------
        halfspaces : (m, d + 1) array, or (d + 1,) for one
        restart : bool
            The result does not depend on it.

        Raises
        ------
        RuntimeError
            Not incremental, or closed.
        InvalidArgument, NotFinite (ValueErrors), QhullError
            As for the first halfspaces; nothing is added then.

        Examples
        --------
        >>> import cullhull
        >>> square = [[-1.0, 0, 0], [0, -1, 0], [1, 0, -2], [0, 1, -2]]
        >>> cut = cullhull.HalfspaceIntersection(square, [0.5, 0.5], incremental=True)
        >>> cut.add_halfspaces([1.0, 1.0, -2.0])
        >>> len(cut.intersections)
        3
        """
        self._require_open()
        array = as_points(np.atleast_2d(halfspaces), "halfspaces")
        if array.shape[1] != self.ndim + 1:
            raise InvalidArgument(f"`halfspaces` should have {self.ndim + 1} columns")
        everything = np.concatenate([self._array, array], dtype=np.float64)
        self._compute(everything, self.interior_point)

    def __repr__(self) -> str:
        return (
            f"<HalfspaceIntersection of {self.nineq} halfspaces in {self.ndim}D: "
            f"{np.isfinite(self.intersections).all(axis=1).sum()} vertices, "
            f"{'bounded' if self.is_bounded else 'unbounded'}>"
        )

    @Lazy
    def polyhedron(self) -> Hull:
        """The hull of `intersections`: its `Hull.mesh`, `Hull.plot` and `Hull.save` show and write
        the polyhedron. It is exact for the rounded vertices, so that a face may be several facets.
        Raises `InvalidArgument` if the polyhedron is unbounded.

        >>> import cullhull
        >>> square = [[-1.0, 0, 0], [0, -1, 0], [1, 0, -2], [0, 1, -2]]
        >>> cullhull.HalfspaceIntersection(square).polyhedron.volume
        4.0
        """
        if not self.is_bounded:
            raise InvalidArgument("an unbounded polyhedron is no hull of its vertices")
        chosen = settings(self._choices)
        return Hull._of(_core.convex_hull(self.intersections, chosen))

    @property
    def nineq(self) -> int:
        """Number of halfspaces."""
        return len(self._array)

    @property
    def npoints(self) -> int:
        """Number of dual points: of halfspaces."""
        return len(self._array)

    @property
    def min_bound(self) -> npt.NDArray[np.float64]:
        """(d + 1,) float64: the least entries of the rows."""
        bound: npt.NDArray[np.float64] = self.halfspaces.min(axis=0)
        return bound

    @property
    def max_bound(self) -> npt.NDArray[np.float64]:
        """(d + 1,) float64: the largest entries of the rows."""
        bound: npt.NDArray[np.float64] = self.halfspaces.max(axis=0)
        return bound

    @Lazy
    def halfspaces(self) -> npt.NDArray[np.float64]:
        """(m, d + 1) float64: the rows."""
        return np.ascontiguousarray(self._array, dtype=np.float64)

    @Lazy
    def dual_facets(self) -> list[list[int]]:
        """Lists of int: the dual hull's facets, coplanar pieces merged."""
        return self.dual.facets.tolist()

    @Lazy
    def dual_vertices(self) -> npt.NDArray[Any]:
        """(w,) int64, ascending: halfspaces that bound the polyhedron."""
        return np.sort(self.dual.vertices)

    @property
    def dual_equations(self) -> npt.NDArray[np.float64]:
        """(v, d + 1) float64: planes of the dual facets."""
        return self.dual.facet_planes

    @property
    def dual_area(self) -> float:
        """The dual hull's area."""
        return self.dual.area

    @property
    def dual_volume(self) -> float:
        """The dual hull's volume."""
        return self.dual.volume


def _require_feasible(halfspaces: npt.NDArray[Any], interior: npt.NDArray[np.float64]) -> None:
    """SciPy's error, and its name for the row at fault."""
    with np.errstate(all="ignore"):
        values = halfspaces[:, :-1] @ interior + halfspaces[:, -1]
    bad = np.flatnonzero(values >= 0)
    if bad.size:
        raise qhull_error()(
            f"feasible point is not clearly inside halfspace {bad[0]}: {halfspaces[bad[0]]}"
        )
