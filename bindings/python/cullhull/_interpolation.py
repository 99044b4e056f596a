"""Interpolation between scattered points, in the place of scipy.interpolate's."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import as_point_set, settings
from ._delaunay import Delaunay
from ._errors import InvalidArgument
from ._scipy import of_scipy
from ._triangulation import Triangulation, delaunay

#: Up to it nearest points are found by a triangulation; beyond it that has too many cells, and
#: SciPy's tree is asked.
_MOST_DIMENSIONS = 4


class _Interpolator:
    """What both share: points, values of any shape and type, questions of any shape."""

    points: npt.NDArray[np.float64]
    values: npt.NDArray[Any]
    #: What questions are shifted by and then divided by; None without ``rescale``.
    _offset: npt.NDArray[np.float64] | None = None
    _scale: npt.NDArray[np.float64] | None = None

    def _set_points(self, points: Any, rescale: bool) -> None:
        rows = as_point_set(_rows(points))
        if rows.shape[1] < 2:
            raise InvalidArgument("input data must be at least 2-D")
        array = np.ascontiguousarray(rows, dtype=np.float64)
        if rescale and len(array):
            self._offset = array.mean(axis=0)
            scale = np.ptp(array, axis=0)
            self._scale = np.where(scale > 0, scale, 1.0)
            array = (array - self._offset) / self._scale
        self.points = array

    def __repr__(self) -> str:
        n, d = self.points.shape
        shape = self.values.shape[1:]
        each = f", values of shape {shape}" if shape else ""
        return f"<{type(self).__name__} of {n} points in {d}D{each}>"

    def _set_values(self, values: Any) -> None:
        self.values = np.asarray(values)
        if self.values.ndim == 0 or len(self.values) != len(self.points):
            raise InvalidArgument("different number of values and points")

    def _questions(self, args: tuple[Any, ...]) -> npt.NDArray[np.float64]:
        d = self.points.shape[1]
        xi = np.asarray(_rows(args), dtype=np.float64)
        if xi.ndim == 1 and (len(args) == 1 and not isinstance(args[0], tuple)) and xi.size % d == 0:
            xi = xi.reshape(-1, d)  # as SciPy: coordinates one after another
        if xi.ndim == 0 or xi.shape[-1] != d:
            raise InvalidArgument("number of dimensions in xi does not match x")
        if self._scale is not None and self._offset is not None:
            xi = (xi - self._offset) / self._scale
        return xi

    def _spread(
        self,
        xi: npt.NDArray[np.float64],
        inside: npt.NDArray[np.bool_],
        found: npt.NDArray[Any],
        fill: Any,
    ) -> npt.NDArray[Any]:
        """Answers in the shape of the questions; `found` those inside."""
        out = np.full((inside.size, *self.values.shape[1:]), fill, dtype=found.dtype)
        out[inside] = found
        return out.reshape(xi.shape[:-1] + self.values.shape[1:])


class _OnCells(_Interpolator):
    """Those that need a triangulation."""

    tri: Delaunay

    def __init__(
        self,
        points: Any,
        values: Any,
        fill_value: Any = np.nan,
        rescale: bool = False,
        *,
        threads: int | None = None,
    ) -> None:
        self._threads = threads
        if isinstance(points, Triangulation):
            points = Delaunay._of(points)
        if isinstance(points, Delaunay):
            if rescale:
                raise InvalidArgument(
                    "Rescaling is not supported when passing a Delaunay triangulation as "
                    "``points``."
                )
            if points.furthest_site or points.triangulation.weights is not None:
                raise InvalidArgument(
                    "interpolation needs a Delaunay triangulation, neither weighted nor of the "
                    "furthest site"
                )
            self.tri, self.points = points, points.points
        else:
            self._set_points(points, rescale)
            self.tri = Delaunay(self.points, threads=threads)
        self._set_values(values)
        kind = np.complex128 if np.iscomplexobj(self.values) else np.float64
        self.values = np.ascontiguousarray(self.values, dtype=kind)
        self.fill_value = kind(fill_value)


class LinearNDInterpolator(_OnCells):
    """In place of `scipy.interpolate.LinearNDInterpolator`: linear on each simplex.

    Parameters
    ----------
    points : (n, d) array, tuple of d arrays, `Delaunay` or `Triangulation`
    values : (n, ...) array of float or complex
    fill_value : float
        The value outside the points' hull.
    rescale : bool
        Divide each coordinate by its range first; the triangulation is another then.
    threads : int, optional
        Threads to use; all the machine offers if not given.

    Attributes
    ----------
    points, values : the arrays
    tri : Delaunay
    fill_value : float or complex

    Raises
    ------
    InvalidArgument, NotFinite (ValueErrors), QhullError
        As `Delaunay`; also for another number of values than of points.

    Examples
    --------
    >>> import cullhull
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    >>> height = cullhull.LinearNDInterpolator(square, [0.0, 0.0, 4.0, 0.0])
    >>> height([[0.75, 0.5], [2, 2]]).tolist(), float(height(0.5, 0.25))
    ([2.0, nan], 1.0)
    """

    def __call__(self, *args: Any) -> npt.NDArray[Any]:
        """The values at points.

        Parameters
        ----------
        args : (..., d) array, or d arrays that are broadcast together, or a tuple of such

        Returns
        -------
        array of the points' shape and that of a value
            ``fill_value`` outside the hull.
        """
        xi = self._questions(args)
        rows = xi.reshape(-1, xi.shape[-1])
        cells = self.tri.find_simplex(rows)
        inside = cells >= 0
        if not inside.all():
            cells, rows = cells[inside], rows[inside]
        native = self.tri.triangulation
        shares = native.barycentric(rows, cells, threads=self._threads)
        corners = native.cells[cells]
        found = np.zeros((len(cells), *self.values.shape[1:]), dtype=self.values.dtype)
        shape = (-1, *(1,) * (self.values.ndim - 1))
        for j in range(corners.shape[1]):
            found += shares[:, j].reshape(shape) * self.values[corners[:, j]]
        return self._spread(xi, inside, found, self.fill_value)


class NaturalNDInterpolator(_OnCells):
    """Natural neighbour interpolation (Sibson) in 2 or 3 dimensions, called as SciPy's classes are.

    A value is the mean of those of its neighbours, weighted by what its Voronoi cell would take
    from theirs: smooth but at the points, through all values, and linear values stay linear. Each
    weight is within 2**-51 of the exact one.

    Parameters
    ----------
    points : (n, d) array, tuple of d arrays, `Delaunay` or `Triangulation`
        d is 2 or 3; of more dimensions where they span no more than 3.
    values : (n, ...) array of float or complex
    fill_value : float
        The value outside the points' hull.
    rescale : bool
        Divide each coordinate by its range first; neighbours are others then.
    threads : int, optional
        Threads to use; all the machine offers if not given.

    Attributes
    ----------
    points, values : the arrays
    tri : Delaunay
    fill_value : float or complex

    Raises
    ------
    InvalidArgument, NotFinite (ValueErrors), QhullError
        As `Delaunay`; also for another number of values than of points, and when called for points
        that span more than 3 dimensions.

    Examples
    --------
    >>> import cullhull
    >>> corners, heights = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 1]], [0.0, 0.0, 0.0, 0.0, 1.0]
    >>> height = cullhull.NaturalNDInterpolator(corners, heights)
    >>> height([[1, 1], [1, 0], [1, 0.5], [3, 3]]).tolist()
    [1.0, 0.0, 0.5, nan]
    >>> ids, weights = height.neighbours([1, 0.5])
    >>> ids.tolist(), weights.tolist()
    ([0, 1, 4], [0.25, 0.25, 0.5])
    """

    def __init__(
        self,
        points: Any,
        values: Any,
        fill_value: Any = np.nan,
        rescale: bool = False,
        *,
        threads: int | None = None,
    ) -> None:
        super().__init__(points, values, fill_value, rescale, threads=threads)
        self._prepare()

    def __getstate__(self) -> dict[str, Any]:
        return {name: v for name, v in self.__dict__.items() if name != "_native"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._prepare()

    def _prepare(self) -> None:
        n = len(self.values)
        parts = self.values.reshape(n, -1)
        if np.iscomplexobj(parts):
            parts = np.concatenate([parts.real, parts.imag], axis=1)
        self._components = parts.shape[1]
        self._native = _core.interpolator(
            self.tri.triangulation._cells,
            np.ascontiguousarray(parts, dtype=np.float64).reshape(-1),
            self._components,
            settings(threads=self._threads),
        )

    def __call__(self, *args: Any) -> npt.NDArray[Any]:
        """The values at points.

        Parameters
        ----------
        args : (..., d) array, or d arrays that are broadcast together, or a tuple of such

        Returns
        -------
        array of the points' shape and that of a value
            ``fill_value`` outside the hull.
        """
        xi = self._questions(args)
        rows = np.ascontiguousarray(xi.reshape(-1, xi.shape[-1]))
        # Exactly inside, as the weights are: SciPy's tolerance would let in points without any.
        inside = np.asarray(np.isfinite(rows).all(axis=1))
        cells = self.tri.triangulation.find_simplex(rows[inside], threads=self._threads)
        inside[inside] = np.asarray(cells) >= 0
        chosen = settings(threads=self._threads)
        found: npt.NDArray[Any] = self._native.natural(rows[inside], np.nan, chosen)
        found = found.reshape(-1, self._components)
        if np.iscomplexobj(self.values):
            half = self._components // 2
            found = found[:, :half] + 1j * found[:, half:]
        found = found.reshape(-1, *self.values.shape[1:])
        return self._spread(xi, inside, found, self.fill_value)

    def neighbours(self, point: Any) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.float64]]:
        """The points that a value comes from, and their weights.

        Parameters
        ----------
        point : (d,) array

        Returns
        -------
        (m,) int32 array, (m,) float64 array
            Indices, ascending, and weights that add up to 1 within m * 2**-51; both empty outside.

        Raises
        ------
        InvalidArgument, NotFinite (ValueErrors)
            For several points, another number of coordinates, a NaN or an infinity.

        Examples
        --------
        >>> import cullhull
        >>> of = cullhull.NaturalNDInterpolator([[0, 0], [1, 0], [0, 1]], [1, 2, 3])
        >>> of.neighbours([0.25, 0.5])[1].tolist()
        [0.25, 0.25, 0.5]
        """
        xi = self._questions((point,))
        if xi.shape[:-1] not in ((), (1,)):
            raise InvalidArgument("one point is asked about at a time")
        return self._native.natural_neighbours(np.ascontiguousarray(xi.reshape(-1)))


class NearestNDInterpolator(_Interpolator):
    """In place of `scipy.interpolate.NearestNDInterpolator`: the value of the nearest point.

    Nearest is decided exactly, and of several nearest points the first counts. In more than 4
    dimensions, and for other distances than Euclid's, SciPy's tree is asked.

    Parameters
    ----------
    x : (n, d) array, or tuple of d arrays
    y : (n, ...) array
    rescale : bool
        Divide each coordinate by its range first.
    tree_options : dict, optional
        Options of SciPy's tree, where it is asked.
    threads : int, optional
        Threads to use; all the machine offers if not given.

    Attributes
    ----------
    points, values : the arrays

    Raises
    ------
    InvalidArgument, NotFinite (ValueErrors)
        For another shape or type, a NaN or an infinity.

    Examples
    --------
    >>> import cullhull
    >>> nearest = cullhull.NearestNDInterpolator([[0, 0], [1, 0], [1, 1]], [1, 2, 3])
    >>> nearest([[0.1, 0], [9, 9]]).tolist()
    [1.0, 3.0]
    """

    def __init__(
        self,
        x: Any,
        y: Any,
        rescale: bool = False,
        tree_options: dict[str, Any] | None = None,
        *,
        threads: int | None = None,
    ) -> None:
        self._threads = threads
        self._tree_options = dict(tree_options or {})
        self._set_points(x, rescale)
        self._set_values(y)
        if len(self.points) == 0:
            raise InvalidArgument("No points given")
        self._native: Triangulation | None = None
        if self.points.shape[1] <= _MOST_DIMENSIONS:
            self._native = delaunay(self.points, threads=threads)

    def __call__(
        self,
        *args: Any,
        eps: float = 0.0,
        p: float = 2.0,
        distance_upper_bound: float = np.inf,
        workers: int = 1,
    ) -> npt.NDArray[Any]:
        """The values at points.

        Parameters
        ----------
        args : (..., d) array, or d arrays that are broadcast together, or a tuple of such
        eps : float
            Allows SciPy's tree to be wrong by that share.
        p : float
            Whose distance: 2 is Euclid's.
        distance_upper_bound : float
            NaN where no point is nearer than that.
        workers : int
            Threads of SciPy's tree.

        Returns
        -------
        array of the points' shape and that of a value
        """
        xi = self._questions(args)
        rows = xi.reshape(-1, xi.shape[-1])
        if not np.isfinite(rows).all():
            raise InvalidArgument("'x' must be finite, check for nan or inf values")
        if self._native is not None and p == 2:
            ids: npt.NDArray[Any] = np.asarray(self._native.nearest(rows, threads=self._threads))
            inside = np.ones(len(rows), dtype=bool)
            if distance_upper_bound < np.inf:
                away = np.sqrt(((self.points[ids] - rows) ** 2).sum(axis=1))
                inside = away < distance_upper_bound
        else:
            away, ids = self._tree().query(
                rows, eps=eps, p=p, distance_upper_bound=distance_upper_bound, workers=workers
            )
            inside = np.isfinite(away)
        found = self.values[ids[inside]]
        if not np.iscomplexobj(found):
            found = found.astype(np.float64)
        return self._spread(xi, inside, found, np.nan)

    def _tree(self) -> Any:
        try:
            from scipy.spatial import cKDTree
        except ImportError:
            raise ImportError(
                f"in more than {_MOST_DIMENSIONS} dimensions and for p != 2 SciPy's tree is asked, "
                "and SciPy is not installed"
            ) from None
        return cKDTree(self.points, **self._tree_options)


def griddata(
    points: Any,
    values: Any,
    xi: Any,
    method: str = "linear",
    fill_value: Any = np.nan,
    rescale: bool = False,
    *,
    threads: int | None = None,
) -> npt.NDArray[Any]:
    """In place of `scipy.interpolate.griddata`: values at `xi` from those at scattered points.

    Parameters
    ----------
    points : (n, d) array, or tuple of d arrays
    values : (n, ...) array of float or complex
    xi : (..., d) array, or tuple of d arrays that are broadcast together
    method : 'linear', 'nearest', 'natural' or 'cubic'
        'natural' is `NaturalNDInterpolator`, which SciPy lacks. 'cubic', and any of SciPy's in one
        dimension, is SciPy's own, which must be installed.
    fill_value : float
        The value outside the points' hull; 'nearest' has none.
    rescale : bool
        Divide each coordinate by its range first.
    threads : int, optional
        Threads to use; all the machine offers if not given.

    Returns
    -------
    array

    Raises
    ------
    InvalidArgument, NotFinite (ValueErrors), QhullError
        As `LinearNDInterpolator`; also for another method.

    Examples
    --------
    >>> import cullhull
    >>> corners, heights = [[0, 0], [1, 0], [0, 1]], [0, 1, 2]
    >>> cullhull.griddata(corners, heights, [[0.25, 0.5], [1, 1]]).tolist()
    [1.25, nan]
    """
    rows = np.asarray(_rows(points))
    dimension = 1 if rows.ndim < 2 else rows.shape[-1]
    if (dimension == 1 and method in ("linear", "nearest", "cubic")) or (
        dimension == 2 and method == "cubic"
    ):
        theirs = of_scipy("scipy.interpolate", "griddata")
        if theirs is None:
            raise ImportError(
                f"method={method!r} in {dimension} dimension{'s'[: dimension - 1]} is SciPy's own, "
                "which is not installed"
            )
        found: npt.NDArray[Any] = theirs(
            points, values, xi, method, fill_value=fill_value, rescale=rescale
        )
        return found
    if method == "nearest":
        return NearestNDInterpolator(rows, values, rescale=rescale, threads=threads)(xi)
    if method == "natural":
        return NaturalNDInterpolator(rows, values, fill_value, rescale, threads=threads)(xi)
    if method == "linear":
        return LinearNDInterpolator(rows, values, fill_value, rescale, threads=threads)(xi)
    raise InvalidArgument(
        f"Unknown interpolation method {method!r} for {dimension} dimensional data"
    )


def _rows(points: Any) -> Any:
    """A tuple of coordinates, broadcast together, as one array; others as they are."""
    if isinstance(points, tuple) and len(points) == 1:
        return _rows(points[0])
    if isinstance(points, tuple):
        columns = np.broadcast_arrays(*points)
        return np.stack([np.asarray(column, dtype=np.float64) for column in columns], axis=-1)
    return points
