"""The class that stands in for scipy.spatial.Delaunay."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import _core
from .._arguments import as_array, as_coordinates, is_doubles
from .._errors import InvalidArgument, NotFinite
from .._options import Budgeted, Unpack, documented, require_known, settings, takes
from .._triangulation import Triangulation
from ..show._forms import Table
from ..show._shown_cells import ShownCells
from ._convex_hull import raise_flat
from ._incremental import IncrementalPoints, Lazy
from ._original import scipy_version
from ._qhull_options import QhullOptions, parse

#: SciPy's own where none are given: of triangulations that do not grow, and of others.
_DEFAULTS = QhullOptions(coplanar=True, scaled_last=True, at_infinity=True)
_DEFAULTS_INCREMENTAL = QhullOptions(coplanar=True)

#: `find_simplex`'s tolerance, as SciPy documents it. It decides nothing about the triangulation.
DEFAULT_TOLERANCE = 100 * np.finfo(np.float64).eps
#: The tolerance up to which the native search looks near enough: as a share of its way to the
#: middle, a point outside is moved that far.
LARGEST_PULL = 2.0**-20


def of_finite(
    ask: Callable[..., npt.NDArray[Any]],
    rows: npt.NDArray[np.float64],
    more: tuple[Any, ...],
    otherwise: list[Any],
) -> npt.NDArray[Any]:
    """``ask(rows, *more)`` for finite rows and `otherwise` for others, end to end."""
    finite = np.isfinite(rows).all(axis=1)
    answers = ask(rows[finite], *more)
    found = np.tile(np.array(otherwise, dtype=answers.dtype), (len(rows), 1))
    found[finite] = answers.reshape(np.count_nonzero(finite), len(otherwise))
    return found.ravel()


@takes(Budgeted)
class Lifted(IncrementalPoints):
    """What `Delaunay` and `Voronoi` share: points, options, adding, copies."""

    _target = "ones"

    def __init__(
        self,
        points: Any,
        furthest_site: bool = False,
        incremental: bool = False,
        qhull_options: str | None = None,
        **options: Unpack[Budgeted],
    ) -> None:
        require_known(options, Budgeted)
        array = self._take(points, incremental)
        if qhull_options is None:
            self._options = _DEFAULTS_INCREMENTAL if incremental else _DEFAULTS
        else:
            self._options = parse(qhull_options, lifted=True)
        if incremental and self._options.at_infinity:
            raise InvalidArgument("Qhull option 'Qz' is not for incremental use")
        self.furthest_site = bool(furthest_site)
        self._choices = options
        self._compute(array, array)

    def _compute(self, everything: npt.NDArray[Any], added: npt.NDArray[Any]) -> None:
        chosen = settings(self._choices)
        found = _core.triangulate(everything, None, self.furthest_site, chosen)
        if found.affine_dimension < self.ndim and not self._options.joggled:
            raise_flat(everything, found.affine_dimension, "Delaunay")
        if "_array" in self.__dict__:
            self._forget()
        self._array, self.triangulation = everything, Triangulation._of(found)


@takes(Budgeted)
class Delaunay(ShownCells, Lifted):
    """In place of `scipy.spatial.Delaunay`: the same attributes, exact, and faster.

    It can be pickled, copied and sent between processes, also while incremental.

    Parameters
    ----------
    points : (n, d) array, d >= 2
        Read in place where `convex_hull` does so.
    furthest_site : bool
        Compute the dual of the furthest-site Voronoi diagram.
    incremental : bool
        Allow `add_points`.
    qhull_options : str, optional
        As in SciPy, ``Qbb Qc Qz Q12`` if not given, ``Qc`` if incremental. ``Qbb`` and ``Qz`` set
        `paraboloid_scale` and `paraboloid_shift`; without ``Qc`` `coplanar` is empty. Other options
        are accepted or refused as in `ConvexHull`.

    Attributes
    ----------
    points : (n, d) float64
    simplices : (s, d + 1) int32: indices of points, oriented positively: in 2D counter-clockwise
    neighbors : (s, d + 1) int32: entry j is the simplex opposite to vertex j, -1 outside
    equations : (s, d + 2) float64: planes of the lifted simplices, unit normal and offset
    paraboloid_scale, paraboloid_shift : float: points are lifted to ``scale * |x|**2 + shift``
    transform : (s, d + 1, d) float64: maps to barycentric coordinates; NaN where nearly flat
    vertex_to_simplex : (n,) int32: a simplex of each vertex, -1 for points that are no vertices
    convex_hull : (f, d) int32: indices of the vertices of the facets of the convex hull
    coplanar : (c, 3) int32: points equal to others: index of the point, of a simplex, of the equal
        vertex
    vertex_neighbor_vertices : two int32 arrays: offsets (n + 1,) and indices of neighbours
    good : (s,) int32: ones
    ndim, npoints, nsimplex : int
    min_bound, max_bound : (d,) float64
    furthest_site : bool
    triangulation : the native `Triangulation`

    Raises
    ------
    InvalidArgument, NotFinite (ValueErrors), TypeError
        For another shape or type, no points, an unknown option, a NaN or an infinity.
    QhullError (a RuntimeError)
        If the points lie in a hyperplane. `delaunay` triangulates these.
    OutOfBudget (a MemoryError), KeyboardInterrupt

    Examples
    --------
    >>> import cullhull
    >>> found = cullhull.Delaunay([[0, 0], [2, 0], [2, 1], [0, 1], [1, 0.5]])
    >>> found
    <Delaunay of 5 points in 2D: 4 simplices>
    >>> found.simplices[found.find_simplex([1.5, 0.5])].tolist()
    [1, 2, 4]
    """

    @classmethod
    def _of(cls, found: Triangulation) -> Delaunay:
        """Over a native triangulation."""
        if found.affine_dimension < max(found.dimension, 2):
            raise InvalidArgument("a triangulation of points in a plane or a line, or of too few")
        result = cls.__new__(cls)
        result._options, result._choices, result._open = _DEFAULTS, {}, False
        result.ndim, result.furthest_site = found.dimension, found.furthest_site
        result._array, result.triangulation = found.points, found
        return result

    def __repr__(self) -> str:
        kind = type(self).__name__
        return f"<{kind} of {self.npoints} points in {self.ndim}D: {self.nsimplex} simplices>"

    def _as_triangulation(self) -> Triangulation:
        return self.triangulation

    @property
    def nsimplex(self) -> int:
        """Number of simplices."""
        return len(self._cells)

    @property
    def _cells(self) -> npt.NDArray[np.int32]:
        """What all attributes are made of; nobody changes it."""
        return self.triangulation.cells

    @Lazy
    def simplices(self) -> npt.NDArray[np.int32]:
        """(s, d + 1) int32: indices of the simplices' vertices."""
        return self._cells.copy()

    @Lazy
    def neighbors(self) -> npt.NDArray[np.int32]:
        """(s, d + 1) int32: entry j is the simplex opposite to vertex j, or -1."""
        return self.triangulation._cells.neighbours.copy()

    @Lazy
    def good(self) -> npt.NDArray[np.int32]:
        """(s,) int32, ones: without ``QGn`` all are good."""
        return np.ones(self.nsimplex, dtype=np.int32)

    @Lazy
    def _paraboloid(self) -> tuple[float, float]:
        """As Qhull's Qbb has it: lifted coordinates between 0 and the largest coordinate; the point
        at infinity, a tenth above all others, is among them."""
        if not self._options.scaled_last:
            return 1.0, 0.0
        return self.triangulation._cells.paraboloid(
            self._options.at_infinity and not self.furthest_site
        )

    @property
    def paraboloid_scale(self) -> float:
        """What the squared length of a point is multiplied with when it is lifted."""
        return self._paraboloid[0]

    @property
    def paraboloid_shift(self) -> float:
        """What is added then."""
        return self._paraboloid[1]

    @Lazy
    def equations(self) -> npt.NDArray[np.float64]:
        """(s, d + 2) float64: outward unit normal and offset of each lifted simplex."""
        return self.triangulation._cells.lifted_planes(self._cells, *self._paraboloid)

    @Lazy
    def transform(self) -> npt.NDArray[np.float64]:
        """(s, d + 1, d) float64: ``transform[i, :d] @ (x - transform[i, d])`` are the first d
        barycentric coordinates of x in simplex i; NaN where it is nearly flat."""
        return self.triangulation._cells.barycentric_maps(self._cells)

    @Lazy
    def vertex_to_simplex(self) -> npt.NDArray[np.int32]:
        """(n,) int32: the first simplex with each vertex; for a point equal to another, of that
        one; -1 for points that are no vertices."""
        return self.triangulation._cells.vertex_cells(self._cells)

    @Lazy
    def coplanar(self) -> npt.NDArray[np.int32]:
        """(c, 3) int32: each point that is no vertex because it equals one, a simplex with that
        vertex, and the vertex."""
        table = self.triangulation._cells.equal_points(self._cells)
        return table if self._options.coplanar else table[:0]

    @Lazy
    def convex_hull(self) -> npt.NDArray[np.int32]:
        """(f, d) int32: indices of the vertices of the facets of the convex hull."""
        return self.triangulation.hull_facets.copy()

    @Lazy
    def vertex_neighbor_vertices(self) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]:
        """Offsets (n + 1,) and indices, int32: the neighbours of vertex i are
        ``indices[offsets[i]:offsets[i + 1]]``, ascending."""
        return self.triangulation._cells.vertex_neighbours(self._cells)

    def find_simplex(
        self, xi: Any, bruteforce: bool = False, tol: float | None = None
    ) -> npt.NDArray[np.int32]:
        """The simplex that each point is in.

        Exact inside the hull; of several simplices that share a point it is the first. SciPy finds
        a simplex for points that are outside by rounding alone, and so does this method.

        Parameters
        ----------
        xi : (..., d) array
        bruteforce : bool
            Without effect.
        tol : float, optional
            A point outside the hull is in a simplex if none of its barycentric coordinates there is
            below ``-tol``. As in SciPy, 100 times the machine epsilon if not given; 0 finds exact
            containment alone.

        Returns
        -------
        (...) int32 array
            -1 outside, and for points that are not finite.

        Raises
        ------
        InvalidArgument (a ValueError)
            For another number of coordinates.

        Examples
        --------
        >>> import cullhull
        >>> found = cullhull.Delaunay([[0, 0], [1, 0], [1, 1], [0, 1]])
        >>> found.find_simplex([[[0.75, 0.5], [2, 2]]]).tolist()
        [[0, -1]]
        """
        x = self._as_questions(xi)
        rows = x if x.ndim == 2 else x.reshape(-1, self.ndim)
        cells = self._find_rows(rows, DEFAULT_TOLERANCE if tol is None else max(float(tol), 0.0))
        return cells if x.ndim == 2 else cells.reshape(x.shape[:-1])

    def _find_rows(self, rows: npt.NDArray[np.float64], tolerance: float) -> npt.NDArray[np.int32]:
        """The cells of rows in the exact triangulation."""
        ask = self.triangulation._cells.find
        try:
            cells = ask(rows, tolerance, None)
        except NotFinite:
            cells = of_finite(ask, rows, (tolerance, None), [-1])
        if tolerance > LARGEST_PULL:
            low, high = self.min_bound, self.max_bound
            margin = (self.ndim + 1) * tolerance * (high - low)
            near = (rows >= low - margin).all(axis=1) & (rows <= high + margin).all(axis=1)
            self._find_far(rows, cells, np.flatnonzero(near & (cells < 0)), tolerance)
        return cells

    def _find_far(
        self,
        rows: npt.NDArray[np.float64],
        cells: npt.NDArray[np.int32],
        places: npt.NDArray[np.intp],
        tolerance: float,
    ) -> None:
        """The same for tolerances that no rounding asks for: all cells at the hull are tried."""
        for cell in np.unique(self.triangulation.hull_cells):
            if len(places) == 0:
                return
            every = np.full(len(places), cell, dtype=np.int32)
            shares = self.triangulation.barycentric(rows[places], every)
            inside = (shares >= -tolerance).all(axis=1)
            cells[places[inside]] = cell
            places = places[~inside]

    def lift_points(self, x: Any) -> npt.NDArray[np.float64]:
        """Points lifted to the paraboloid.

        Parameters
        ----------
        x : (..., d) array

        Returns
        -------
        (..., d + 1) float64 array

        Raises
        ------
        InvalidArgument (a ValueError)
            For another number of coordinates.

        Examples
        --------
        >>> import cullhull
        >>> found = cullhull.Delaunay([[0, 0], [1, 0], [0, 1]], qhull_options="Qc")
        >>> found.lift_points([1, 2]).tolist()
        [1.0, 2.0, 5.0]
        """
        x = self._as_questions(x)
        scale, shift = self._paraboloid
        height = scale * (x**2).sum(axis=-1, keepdims=True) + shift
        return np.concatenate([x, height], axis=-1)

    def plane_distance(self, xi: Any) -> npt.NDArray[np.float64]:
        """Signed distances of lifted points to the planes of all lifted simplices.

        Parameters
        ----------
        xi : (..., d) array

        Returns
        -------
        (..., s) float64 array

        Raises
        ------
        InvalidArgument (a ValueError)
            As `lift_points`.

        Examples
        --------
        >>> import cullhull
        >>> found = cullhull.Delaunay([[0, 0], [1, 0], [0, 1]], qhull_options="Qc")
        >>> found.plane_distance([1, 1]).round(3).tolist()
        [0.0]
        """
        z = self.lift_points(xi)
        planes = self.equations
        return z @ planes[:, :-1].T + planes[:, -1]

    def _as_questions(self, x: Any) -> npt.NDArray[np.float64]:
        if is_doubles(x) and x.ndim and x.shape[-1] == self.ndim:
            rows: npt.NDArray[np.float64] = x
            return rows
        array = as_array(x, "xi")
        if array.ndim == 0:  # SciPy's error for what is no point at all
            raise IndexError("wrong dimensionality in xi")
        if array.shape[-1] != self.ndim:
            raise InvalidArgument("wrong dimensionality in xi")
        return as_coordinates(array, "xi")

    # As the native triangulation has it

    @documented("path", "format", "crs")
    def save(
        self,
        path: str | os.PathLike[str],
        heights: Any = None,
        *,
        format: str = "",
        crs: str | None = None,
    ) -> None:
        """Writes a file of the simplices: see `Triangulation.save`.

        Parameters
        ----------
        heights : (n,) array, optional
            Third coordinates of 2D points.

        Raises
        ------
        FileError (an OSError), InvalidArgument or BadFile (ValueErrors)
            As `Triangulation.save`.

        Examples
        --------
        >>> import cullhull, os, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     cullhull.Delaunay([[0, 0], [4, 0], [0, 4]]).save(os.path.join(folder, "a.wkt"))
        ...     print(open(os.path.join(folder, "a.wkt")).read().strip())
        GEOMETRYCOLLECTION (POLYGON ((0 0, 4 0, 0 4, 0 0)))
        """
        self.triangulation.save(path, heights, format=format, crs=crs)

    def _native(self) -> _core.Cells:
        return self.triangulation._cells

    def _table(self) -> Table:
        points = f"{self.npoints:,} in {self.ndim}D"
        rows = [("points", points), ("simplices", f"{self.nsimplex:,}")]
        return Table("Delaunay triangulation", rows)


def tsearch(tri: Delaunay, xi: Any) -> npt.NDArray[np.int32]:
    """In place of `scipy.spatial.tsearch`: ``tri.find_simplex(xi)``.

    As SciPy's it warns of its end (DeprecationWarning) where SciPy 1.18 or later is installed.

    Parameters
    ----------
    tri : Delaunay
    xi : (..., d) array

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
    >>> int(cullhull.tsearch(cullhull.Delaunay([[0, 0], [1, 0], [0, 1]]), [0.2, 0.2]))
    0
    """
    if scipy_version() >= (1, 18):
        warnings.warn(
            "`tsearch` is deprecated in SciPy 1.18 and will be removed in SciPy 1.22; "
            "use `Delaunay.find_simplex`",
            DeprecationWarning,
            stacklevel=2,
        )
    return tri.find_simplex(xi)
