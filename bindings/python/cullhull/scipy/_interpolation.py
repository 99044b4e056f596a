"""Interpolation between scattered points, in the place of scipy.interpolate's."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import _core
from .._arguments import as_array, as_coordinates, as_point_set, is_doubles
from .._errors import InvalidArgument, NotFinite
from .._functions import convex_hull
from .._hull import Hull
from .._options import documented, settings
from .._triangulation import as_triangulation
from ._delaunay import DEFAULT_TOLERANCE, LARGEST_PULL, Delaunay, of_finite
from ._incremental import Lazy
from ._original import of_scipy


class _Interpolator:
    """What both share: points, values of any shape and type, questions of any shape."""

    points: npt.NDArray[np.float64]
    values: npt.NDArray[Any]
    values_shape: tuple[int, ...]
    is_complex: bool
    fill_value: float | complex
    #: What coordinates are divided by, after `offset` is taken from them; None without ``rescale``.
    scale: npt.NDArray[np.float64] | None
    offset: npt.NDArray[np.float64]
    _threads: int | None

    def _set_points(self, points: Any, rescale: bool) -> None:
        rows = as_point_set(_rows(points))
        if rows.shape[1] < 2:
            raise InvalidArgument("input data must be at least 2-D")
        array = np.ascontiguousarray(rows, dtype=np.float64)
        self.scale = None
        if rescale and len(array):
            self.offset = array.mean(axis=0)
            scale = np.ptp(array, axis=0)
            self.scale = np.where(scale > 0, scale, 1.0)
            array = (array - self.offset) / self.scale
        self.points = array

    def _settings(self) -> _core.Settings | None:
        return None if self._threads is None else settings({"threads": self._threads})

    def __repr__(self) -> str:
        n, d = self.points.shape
        each = f", values of shape {self.values_shape}" if self.values_shape else ""
        return f"<{type(self).__name__} of {n} points in {d}D{each}>"

    def _set_values(self, values: Any, fill_value: Any) -> None:
        self.values = as_array(values, "values")
        if self.values.ndim == 0 or len(self.values) != len(self.points):
            raise InvalidArgument("different number of values and points")
        self.values_shape = self.values.shape[1:]
        self.is_complex = np.iscomplexobj(self.values)
        self.fill_value = complex(fill_value) if self.is_complex else float(fill_value)

    def _questions(self, args: tuple[Any, ...]) -> npt.NDArray[np.float64]:
        d = self.points.shape[1]
        one = len(args) == 1 and is_doubles(args[0])
        xi = args[0] if one else as_coordinates(_rows(args, "xi"), "xi")
        if xi.ndim == 1 and (len(args) == 1 and not isinstance(args[0], tuple)) and xi.size % d == 0:
            xi = xi.reshape(-1, d)  # as SciPy: coordinates one after another
        if xi.ndim == 0 or xi.shape[-1] != d:
            raise InvalidArgument("number of dimensions in xi does not match x")
        return xi if self.scale is None else (xi - self.offset) / self.scale

    def _spread(
        self,
        xi: npt.NDArray[np.float64],
        inside: npt.NDArray[np.bool_],
        found: npt.NDArray[Any],
    ) -> npt.NDArray[Any]:
        """Answers in the shape of the questions; `found` those inside."""
        each = found.shape[1:]
        if len(found) == inside.size:
            return found.reshape(xi.shape[:-1] + each)
        out = np.full((inside.size, *each), self.fill_value, dtype=found.dtype)
        out[inside] = found
        return out.reshape(xi.shape[:-1] + each)


@documented("threads")
class _OnCells(_Interpolator):
    """Those that need a triangulation."""

    tri: Delaunay
    #: Where there is a limit: the most dimensions that the points may have.
    _most_dimensions: int | None = None

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
        given = as_triangulation(points)
        if given is None:
            self._set_points(points, rescale)
            self._require_few_dimensions()
            self.tri = Delaunay(self.points, threads=threads)
        else:
            if rescale:
                raise InvalidArgument(
                    "Rescaling is not supported when passing a Delaunay triangulation as "
                    "``points``."
                )
            if given.furthest_site or given.weights is not None:
                raise InvalidArgument(
                    "interpolation needs a Delaunay triangulation, neither weighted nor of the "
                    "furthest site"
                )
            self.scale = None
            self.tri = points if isinstance(points, Delaunay) else Delaunay._of(given)
            self.points = self.tri.points
            self._require_few_dimensions()
        self._set_values(values, fill_value)
        kind = np.complex128 if self.is_complex else np.float64
        rows = self.values.reshape(len(self.points), math.prod(self.values_shape))
        self.values = np.ascontiguousarray(rows, dtype=kind)
        self._prepare()

    def _prepare(self) -> None:
        """Makes what a pickle does not hold."""

    def _require_few_dimensions(self) -> None:
        dimension, most = self.points.shape[1], self._most_dimensions
        if most is not None and dimension > most:
            raise InvalidArgument(
                f"natural neighbours are of points in up to {most} dimensions, not in {dimension}"
            )

    def __call__(self, *args: Any, simplex_tolerance: float = 1.0) -> npt.NDArray[Any]:
        """The interpolated values at points.

        Parameters
        ----------
        args : (..., d) array, or d arrays that are broadcast together, or a tuple of such
            The points.
        simplex_tolerance : float
            As in SciPy 1.18: points outside the hull get a value where ``find_simplex`` with this
            multiple of its default tolerance finds a simplex. Inside, location is exact.

        Returns
        -------
        (...) + `values_shape` array
            float64 or complex128; ``fill_value`` outside the hull of the data points, and where a
            coordinate is NaN.

        Raises
        ------
        InvalidArgument (a ValueError), TypeError
            For another number of coordinates, or another type, and unless `simplex_tolerance` is
            positive.

        Examples
        --------
        >>> import cullhull, numpy as np
        >>> plane = cullhull.LinearNDInterpolator([[0, 0], [4, 0], [0, 4]], [0.0, 4.0, 8.0])
        >>> plane(np.array([0, 1, 2]), 1.0).tolist()         # x of three points, and y of all
        [2.0, 3.0, 4.0]
        """
        _require_positive(simplex_tolerance)
        return self._values(self._questions(args), simplex_tolerance * DEFAULT_TOLERANCE)

    def _values(self, xi: npt.NDArray[np.float64], tolerance: float) -> npt.NDArray[Any]:
        """The values at points that are looked up; `tolerance` of `find_simplex`."""
        raise NotImplementedError


class LinearNDInterpolator(_OnCells):
    """In place of `scipy.interpolate.LinearNDInterpolator`: linear on each Delaunay simplex.

    Which simplex contains a point is decided exactly. Calling the object interpolates. Pickles and
    copies.

    Parameters
    ----------
    points : (n, d) array, tuple of d arrays, `Delaunay` or `Triangulation`
        The data points, d >= 2.
    values : (n, ...) array of float or complex
        The values at the data points: numbers, or arrays of one shape.
    fill_value : float
        The value outside the hull of the data points.
    rescale : bool
        Divide each coordinate by its range before triangulating, which gives another triangulation:
        for coordinates in different units.

    Attributes
    ----------
    points : (n, d) float64; with `rescale` those that are triangulated
    values : (n, m) float64 or complex128: the m numbers of each value, in C order
    values_shape : tuple of int: the shape of a value
    is_complex : bool
    fill_value : float or complex
    tri : Delaunay
    scale : (d,) float64, or None without `rescale`
    offset : (d,) float64, only with `rescale`: a point x is looked up at ``(x - offset) / scale``

    Raises
    ------
    InvalidArgument, NotFinite (ValueErrors), QhullError
        As `Delaunay`; InvalidArgument also if the number of values is not that of the points.

    Examples
    --------
    >>> import cullhull
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    >>> height = cullhull.LinearNDInterpolator(square, [0.0, 0.0, 4.0, 0.0])
    >>> height([[0.75, 0.5], [2, 2]]).tolist(), float(height(0.5, 0.25))
    ([2.0, nan], 1.0)
    """

    def _values(self, xi: npt.NDArray[np.float64], tolerance: float) -> npt.NDArray[Any]:
        rows = xi if xi.ndim == 2 else xi.reshape(-1, xi.shape[-1])
        numbers, outside = self.values, [self.fill_value.real]
        if not (is_doubles(numbers) and numbers.flags.c_contiguous):
            if np.iscomplexobj(numbers):
                outside.append(self.fill_value.imag)
                numbers = np.ascontiguousarray(numbers, dtype=np.complex128).view(np.float64)
            else:
                numbers = np.ascontiguousarray(numbers, dtype=np.float64)
        native, width = self.tri.triangulation._cells, numbers.shape[1]
        more = (numbers, width, outside, tolerance, self._settings())
        try:
            found = native.linear(rows, *more)
        except NotFinite:
            found = of_finite(native.linear, rows, more, outside * (width // len(outside)))
        if tolerance > LARGEST_PULL:
            self._add_far(rows, found.reshape(-1, width), numbers, tolerance)
        if len(outside) == 2:
            found = found.view(np.complex128)
        return found.reshape(xi.shape[:-1] + self.values_shape)

    def _add_far(
        self,
        rows: npt.NDArray[np.float64],
        found: npt.NDArray[np.float64],
        numbers: npt.NDArray[np.float64],
        tolerance: float,
    ) -> None:
        """Sets the values of points in cells by a tolerance that no rounding asks for."""
        cells = self.tri._find_rows(rows, tolerance)
        far = np.flatnonzero(cells >= 0)
        shares = self.tri.triangulation.barycentric(rows[far], cells[far])
        corners = numbers[self.tri.triangulation.cells[cells[far]]]
        products = shares[:, :, np.newaxis] * corners
        products[shares == 0] = 0  # of a NaN, too
        found[far] = products.sum(axis=1)


class NaturalNDInterpolator(_OnCells):
    """Natural neighbour interpolation (Sibson) in 2 and 3 dimensions, with the interface of SciPy's
    interpolators.

    The value at a point is a weighted mean of the values of its natural neighbours. The weight of a
    neighbour is the area or volume that the point's Voronoi cell would take from the neighbour's
    cell. The result passes through all values, reproduces linear functions, and is smooth except at
    the data points. Each weight is within 2**-51 of the exact one. A point that is outside the hull
    by rounding alone, as is half of the middles of its edges, has the value of the border there.

    Parameters
    ----------
    points : (n, d) array, tuple of d arrays, `Delaunay` or `Triangulation`
        The data points; d is 2 or 3.
    values : (n, ...) array of float or complex
        The values at the data points: numbers, or arrays of one shape.
    fill_value : float
        The value outside the hull of the data points.
    rescale : bool
        Divide each coordinate by its range before triangulating, which gives other neighbours: for
        coordinates in different units.

    Attributes
    ----------
    points, values, values_shape, is_complex, fill_value, tri, scale, offset :
        as of `LinearNDInterpolator`

    Raises
    ------
    InvalidArgument, NotFinite (ValueErrors), QhullError
        As `Delaunay`; also for another number of values than of points, and for more than 3
        dimensions.

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

    _most_dimensions = 3

    def __getstate__(self) -> dict[str, Any]:
        made_again = ("_native", "_hull")
        return {name: v for name, v in self.__dict__.items() if name not in made_again}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._prepare()

    def _reals(self, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Imaginary parts beside the real ones."""
        return np.hstack([values.real, values.imag]) if self.is_complex else values

    def _prepare(self) -> None:
        parts = self._reals(self.values)
        self._components = parts.shape[1]
        self._native = _core.interpolator(
            self.tri.triangulation._cells,
            np.ascontiguousarray(parts, dtype=np.float64).reshape(-1),
            self._components,
            self._settings(),
        )

    def _values(self, xi: npt.NDArray[np.float64], tolerance: float) -> npt.NDArray[Any]:
        rows = np.ascontiguousarray(xi.reshape(-1, xi.shape[-1]))
        inside = np.asarray(np.isfinite(rows).all(axis=1))
        cells = self.tri.triangulation.find_simplex(rows[inside], threads=self._threads)
        inside[inside] = np.asarray(cells) >= 0
        edge = self._on_border(rows, np.flatnonzero(~inside), tolerance)
        inside[list(edge)] = True
        found: npt.NDArray[Any] = self._native.natural(rows[inside], np.nan, self._settings())
        found = found.reshape(-1, self._components)
        place = np.cumsum(inside) - 1
        for row, (ids, weights) in edge.items():
            found[place[row]] = weights @ self._reals(self.values[ids])
        if self.is_complex:
            half = self._components // 2
            found = found[:, :half] + 1j * found[:, half:]
        return self._spread(xi, inside, found.reshape(len(found), *self.values_shape))

    def _on_border(
        self, rows: npt.NDArray[np.float64], outside: npt.NDArray[np.intp], tolerance: float
    ) -> dict[int, tuple[npt.NDArray[np.int32], npt.NDArray[np.float64]]]:
        """Neighbours and weights of points that are outside by rounding alone, by row: the middle
        of an edge of the hull, for instance, is seldom a double."""
        found: dict[int, tuple[npt.NDArray[np.int32], npt.NDArray[np.float64]]] = {}
        cells = self._cells_at_border(rows[outside], tolerance)
        for row, cell in zip(outside[cells >= 0].tolist(), cells[cells >= 0].tolist()):
            corners = self.tri.triangulation.cells[cell]
            shares = self.tri.triangulation.barycentric(rows[row], cell)
            if rows.shape[1] > 2:  # a face has neighbours besides the cell's corners
                short = max(tolerance, -float(shares.min()))
                middle = self.points[corners].mean(axis=0)
                for pull in (8 * short, 64 * short):
                    ids, weights = self._native.natural_neighbours(
                        rows[row] + min(pull, 0.5) * (middle - rows[row])
                    )
                    if len(ids) > 0:
                        found[row] = ids, weights
                        break
            if row not in found:
                shares = np.maximum(shares, 0)
                order = np.argsort(corners)
                order = order[shares[order] > 0]
                found[row] = corners[order], shares[order] / shares.sum()
        return found

    def _cells_at_border(
        self, rows: npt.NDArray[np.float64], tolerance: float
    ) -> npt.NDArray[np.int32]:
        """The cells of points outside: of `find_simplex`, whose tolerance is a share of the cell's
        height, and of those that are as near as coordinates are rounded; -1 for others."""
        cells = self.tri._find_rows(rows, tolerance)
        left = np.flatnonzero((cells < 0) & np.isfinite(rows).all(axis=1))
        largest = max(float(np.abs(self.points).max()), np.finfo(np.float64).tiny)
        left = left[self._hull.distance(rows[left]) <= 4 * np.finfo(np.float64).eps * largest]
        middle, pull = self.points.mean(axis=0), 2.0**-50
        while len(left) > 0 and pull < 2.0**-10:
            pulled = rows[left] + pull * (middle - rows[left])
            cells[left] = self.tri.triangulation.find_simplex(pulled)
            left, pull = left[cells[left] < 0], 8 * pull
        return cells

    @Lazy
    def _hull(self) -> Hull:
        return convex_hull(self.points, threads=self._threads)

    def neighbours(self, point: Any) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.float64]]:
        """The natural neighbours of a point, and their weights.

        Parameters
        ----------
        point : (d,) array

        Returns
        -------
        (m,) int32 array, (m,) float64 array
            Indices of data points, ascending, and their weights, which add up to 1 within
            m * 2**-51. Both are empty outside the hull of the data points.

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
        row = np.ascontiguousarray(xi.reshape(1, -1))
        ids, weights = self._native.natural_neighbours(row[0])
        if len(ids) > 0:
            return ids, weights
        return self._on_border(row, np.zeros(1, dtype=np.intp), DEFAULT_TOLERANCE).get(
            0, (ids, weights)
        )


@documented("threads")
class NearestNDInterpolator(_Interpolator):
    """In place of `scipy.interpolate.NearestNDInterpolator`: the value of the nearest point.

    The nearest point is found exactly; of several nearest points the first is used. In more than 8
    dimensions, and for distances other than Euclidean, SciPy's cKDTree is used. Calling the object
    interpolates. Pickles and copies.

    Parameters
    ----------
    x : (n, d) array, or tuple of d arrays
        The data points, d >= 2.
    y : (n, ...) array
        The values at the data points: numbers, or arrays of one shape.
    rescale : bool
        Divide each coordinate by its range before searching: for coordinates in different units.
    tree_options : dict, optional
        Options of SciPy's cKDTree, where it is used.

    Attributes
    ----------
    points : (n, d) float64; with `rescale` those that are searched
    values : (n, ...) array, as it was passed
    values_shape : tuple of int: the shape of a value
    is_complex : bool
    tree : scipy.spatial.KDTree or cKDTree of `points`, as SciPy's, built on first use
    tri : None
    fill_value : NaN, float or complex
    scale : (d,) float64, or None without `rescale`
    offset : (d,) float64, only with `rescale`: a point x is looked up at ``(x - offset) / scale``

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
        self._set_values(y, np.nan)
        if len(self.points) == 0:
            raise InvalidArgument("No points given")
        self.tri = None
        self._nearby  # noqa: B018, tells which point is not finite

    def __call__(
        self,
        *args: Any,
        eps: float = 0.0,
        p: float = 2.0,
        distance_upper_bound: float = np.inf,
        workers: int = 1,
    ) -> npt.NDArray[Any]:
        """The value of the nearest data point at each of some points.

        Parameters
        ----------
        args : (..., d) array, or d arrays that are broadcast together, or a tuple of such
            The points. Finite.
        eps : float
            SciPy's tree may return a point that is farther than the nearest one by this fraction.
            Without effect where the tree is not used.
        p : float
            The Minkowski norm that measures distances: 2 is the Euclidean distance.
        distance_upper_bound : float
            The value is NaN where no data point is nearer than this.
        workers : int
            Threads that SciPy's tree uses.

        Returns
        -------
        (...) + `values_shape` array
            float64 or complex128.

        Raises
        ------
        InvalidArgument (a ValueError), TypeError
            For a NaN or an infinity, another number of coordinates, or another type.
        ImportError
            If SciPy's tree is needed and SciPy is not installed: ``pip install 'cullhull[scipy]'``.

        Examples
        --------
        >>> import cullhull
        >>> nearest = cullhull.NearestNDInterpolator([[0, 0], [4, 0], [0, 4]], [1, 2, 3])
        >>> nearest([[1, 0], [9, 9]], distance_upper_bound=5).tolist()
        [1.0, nan]
        """
        xi = self._questions(args)
        rows = xi if xi.ndim == 2 else xi.reshape(-1, xi.shape[-1])
        ids: npt.NDArray[Any] | None = None
        away: npt.NDArray[np.float64] | None = None
        if p == 2:
            ids = self._nearest_ids(rows)
        if ids is None:
            _require_finite(rows)
            away, ids = self.tree.query(
                rows, eps=eps, p=p, distance_upper_bound=distance_upper_bound, workers=workers
            )
            inside = np.isfinite(away)
        elif distance_upper_bound < np.inf:
            away = np.sqrt(((self.points[ids] - rows) ** 2).sum(axis=1))
            inside = away < distance_upper_bound
        found: npt.NDArray[Any] = self.values[ids if away is None else ids[inside]]
        if not np.iscomplexobj(found):
            found = found.astype(np.float64, copy=False)
        if away is None:
            return found.reshape(xi.shape[:-1] + found.shape[1:])
        return self._spread(xi, inside, found)

    def _nearest_ids(self, rows: npt.NDArray[np.float64]) -> npt.NDArray[np.int32] | None:
        """The nearest point of each of `rows`; None where SciPy's tree is to be asked."""
        if self._nearby is None:
            return None
        try:
            return self._nearby.nearest(rows, self._settings())
        except NotFinite:
            _require_finite(rows)
            raise

    def __getstate__(self) -> dict[str, Any]:
        return {name: v for name, v in self.__dict__.items() if name not in self._remade}

    #: What a copy makes again when it is asked for.
    _remade = frozenset({"tree", "_nearby"})

    @Lazy
    def _nearby(self) -> _core.NearestTree | None:
        """The points in a tree of our own; None in more dimensions than it takes."""
        return _core.nearest_tree(self.points, self._settings())

    @Lazy
    def tree(self) -> Any:
        """scipy.spatial.cKDTree of `points`, with `tree_options`; an ImportError without SciPy."""
        try:
            from scipy.spatial import KDTree, cKDTree

            import scipy
        except ImportError:
            raise ImportError(
                "in more than 8 dimensions, for p != 2 and as `tree` SciPy's tree is used, and SciPy "
                "is not installed: pip install 'cullhull[scipy]'"
            ) from None
        version = tuple(int(part) for part in scipy.__version__.split(".")[:2])
        tree = KDTree if version >= (1, 18) else cKDTree  # as SciPy's own attribute
        return tree(self.points, **self._tree_options)


@documented("threads")
def griddata(
    points: Any,
    values: Any,
    xi: Any,
    method: str = "linear",
    fill_value: Any = np.nan,
    rescale: bool = False,
    simplex_tolerance: float = 1.0,
    *,
    threads: int | None = None,
) -> npt.NDArray[Any]:
    """In place of `scipy.interpolate.griddata`: values at `xi` from values at scattered points.

    Parameters
    ----------
    points : (n, d) array, or tuple of d arrays
        The data points.
    values : (n, ...) array of float or complex
        The values at the data points: numbers, or arrays of one shape.
    xi : (..., d) array, or tuple of d arrays that are broadcast together
        The points at which to interpolate.
    method : 'linear', 'nearest', 'natural' or 'cubic'
        'natural' is `NaturalNDInterpolator`, which SciPy lacks. 'cubic', and every method of SciPy
        in one dimension, calls SciPy, which must be installed.
    fill_value : float
        The value outside the hull of the data points; 'nearest' ignores it.
    rescale : bool
        Divide each coordinate by its range first: for coordinates in different units.
    simplex_tolerance : float
        As of `LinearNDInterpolator`, for 'linear' and 'natural'; passed on to SciPy (1.18 or later)
        where the method is SciPy's.

    Returns
    -------
    array
        Of the shape of the points `xi`, followed by the shape of a value.

    Raises
    ------
    InvalidArgument, NotFinite (ValueErrors), QhullError
        As `LinearNDInterpolator`; InvalidArgument also for an unknown method, and unless
        `simplex_tolerance` is positive.
    ImportError
        If the method is SciPy's and SciPy is not installed.

    Examples
    --------
    >>> import cullhull
    >>> corners, heights = [[0, 0], [1, 0], [0, 1]], [0, 1, 2]
    >>> cullhull.griddata(corners, heights, [[0.25, 0.5], [1, 1]]).tolist()
    [1.25, nan]
    """
    _require_positive(simplex_tolerance)
    rows = as_coordinates(_rows(points))
    dimension = 1 if rows.ndim < 2 else rows.shape[-1]
    if (dimension == 1 and method in ("linear", "nearest", "cubic")) or (
        dimension == 2 and method == "cubic"
    ):
        theirs = of_scipy("scipy.interpolate", "griddata")
        if theirs is None:
            raise ImportError(
                f"method={method!r} in {dimension} dimension{'s'[: dimension - 1]} is SciPy's own, "
                "which is not installed: pip install 'cullhull[scipy]'"
            )
        tolerance: dict[str, float] = {}
        if simplex_tolerance != 1:
            tolerance["simplex_tolerance"] = simplex_tolerance
        found: npt.NDArray[Any] = theirs(
            rows,
            as_array(values, "values"),
            as_coordinates(_rows(xi, "xi"), "xi"),
            method,
            fill_value=fill_value,
            rescale=rescale,
            **tolerance,
        )
        return found
    if method == "nearest":
        return NearestNDInterpolator(rows, values, rescale=rescale, threads=threads)(xi)
    if method == "natural":
        natural = NaturalNDInterpolator(rows, values, fill_value, rescale, threads=threads)
        return natural(xi, simplex_tolerance=simplex_tolerance)
    if method == "linear":
        linear = LinearNDInterpolator(rows, values, fill_value, rescale, threads=threads)
        return linear(xi, simplex_tolerance=simplex_tolerance)
    raise InvalidArgument(
        f"Unknown interpolation method {method!r} for {dimension} dimensional data"
    )


def _require_positive(simplex_tolerance: float) -> None:
    if not simplex_tolerance > 0:
        raise InvalidArgument("simplex_tolerance must be positive")


def _require_finite(rows: npt.NDArray[np.float64]) -> None:
    if not np.isfinite(rows).all():
        raise InvalidArgument("'x' must be finite, check for nan or inf values")


def _rows(points: Any, what: str = "points") -> Any:
    """A tuple of coordinates, broadcast together, as one array; others as they are."""
    if isinstance(points, tuple) and len(points) == 1:
        return _rows(points[0], what)
    if isinstance(points, tuple):
        columns = np.broadcast_arrays(*(as_coordinates(column, what) for column in points))
        return np.stack(columns, axis=-1)
    return points
