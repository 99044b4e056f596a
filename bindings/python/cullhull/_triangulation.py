"""Triangulations: what `delaunay` makes, and the questions one can ask it."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import as_point_set, as_points, as_questions
from ._errors import InvalidArgument, NotCertified
from ._found_cells import FoundCells
from ._native import Certificate
from ._options import Budgeted, Unpack, Watched, settings, takes
from .show._forms import Table


@takes(Budgeted)
def delaunay(
    points: Any,
    weights: Any = None,
    *,
    furthest_site: bool = False,
    certify: bool = False,
    **options: Unpack[Budgeted],
) -> Triangulation:
    """The exact Delaunay triangulation of points in any dimension; with weights, the regular one.

    The result is the same, bit for bit, for any number of threads and any layout of the points:
    points on one sphere are triangulated from their lowest index. Expected time is O(n log n) in 2D
    and about O(n log n) in 3D for evenly spread points; the number of cells, up to n^ceil(d/2),
    bounds it from below.

    Parameters
    ----------
    points : (n, d) array
        Read in place where `convex_hull` does so, and kept: change it only when you no longer need
        the triangulation's questions.
    weights : (n,) array, optional
        Compute the regular triangulation, the dual of the power diagram: point i is lifted to
        ``|x|**2 - weights[i]``. A point whose cell in the power diagram is empty is `hidden`.
    furthest_site : bool
        Compute the dual of the furthest-point Voronoi diagram; its vertices are those of the convex
        hull.
    certify : bool
        Check the result with an independent exact test, kept as ``result.certificate``.

    Returns
    -------
    Triangulation

    Raises
    ------
    NotFinite, InvalidArgument (ValueErrors), TypeError
        As `convex_hull`; also for another number of weights than of points.
    OutOfBudget (a MemoryError), KeyboardInterrupt

    Examples
    --------
    >>> import cullhull
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    >>> found = cullhull.delaunay(square, certify=True)
    >>> found.cells.tolist(), found.neighbours.tolist(), found.certificate
    ([[0, 1, 2], [0, 2, 3]], [[-1, 1, -1], [-1, -1, 0]], <Certificate: valid>)
    >>> found.cell_groups.tolist()                       # one circle
    [0, 0]
    >>> cullhull.delaunay([*square, [0.5, 0.5]], [0, 0, 0, 0, -1]).hidden.tolist()
    [4]
    """
    chosen = settings(options, Budgeted)
    array = as_point_set(points)
    heights = None
    if weights is not None:
        heights = np.ascontiguousarray(as_points(weights, "weights", axes=1), dtype=np.float64)
        if len(heights) != len(array):
            raise InvalidArgument(f"{len(array)} points have {len(heights)} weights")
    result = Triangulation._of(_core.triangulate(array, heights, bool(furthest_site), chosen))
    if certify:
        result.certificate = _core.certify_cells(result._cells, chosen)
        if not result.certificate:
            raise NotCertified(result.certificate.reason)
    return result


class Triangulation(FoundCells):
    """An exact Delaunay or regular triangulation, made by `delaunay`.

    Below, n is the number of points, d their dimension and k the dimension of the flat they span
    (`affine_dimension`): for k < d the points are triangulated inside their flat.

    All arrays are read-only views of the result's own memory. It never changes: copies share their
    memory, and a pickle holds the arrays and the points.

    Attributes
    ----------
    certificate : Certificate or None
        What ``certify=True`` found.

    Raises
    ------
    TypeError
        When called: triangulations are made by `delaunay`.

    Examples
    --------
    >>> import cullhull
    >>> found = cullhull.delaunay([[0, 0], [2, 0], [0, 2], [2, 2], [1, 1], [1, 1]])
    >>> found
    <Triangulation of 6 points in 2D: 5 vertices, 4 cells>
    >>> found.cells.tolist(), found.duplicates.tolist()
    ([[0, 1, 4], [0, 4, 2], [1, 3, 4], [2, 4, 3]], [[5, 4]])
    >>> found.hull_facets.tolist(), found.hull_cells.tolist()
    ([[0, 1], [1, 3], [2, 0], [3, 2]], [0, 2, 1, 3])
    """

    __slots__ = ()

    _made_by = "triangulations are made by cullhull.delaunay"

    def __reduce__(self) -> tuple[Any, ...]:
        return _of_state, (_core.state_of_cells(self._cells), self.certificate)

    def __repr__(self) -> str:
        kind = "Triangulation" if self.weights is None else "Regular triangulation"
        flat = "" if self.affine_dimension == self.dimension else f" ({self.affine_dimension}D)"
        return (
            f"<{kind} of {self.point_count} points in {self.dimension}D{flat}: "
            f"{self.vertex_count} vertices, {self.cell_count} cells>"
        )

    def __len__(self) -> int:
        return self.cell_count

    def _parts(self) -> tuple[Any, ...]:
        return self.points, self.weights, self.furthest_site, self.cells

    def _table(self) -> Table:
        rows = self._rows_of_table()
        if self.certificate is not None:
            rows.append(("certified", "yes" if self.certificate else "no"))
        return Table("Triangulation" if self.weights is None else "Regular triangulation", rows)

    # What it is

    @property
    def weights(self) -> npt.NDArray[np.float64] | None:
        """(n,) float64, or None where there are none."""
        return cast("npt.NDArray[np.float64] | None", self._cells.weights)

    @property
    def dimension(self) -> int:
        """d, the number of coordinates of a point."""
        return self._cells.dimension

    @property
    def affine_dimension(self) -> int:
        """k, the dimension of the flat the points span: -1 no points, 0 all equal, ..., d full."""
        return self._cells.affine_dimension

    @property
    def axes(self) -> npt.NDArray[np.int32]:
        """(k,) int32, ascending: axes onto which the flat projects one to one."""
        return self._cells.axes

    @property
    def point_count(self) -> int:
        """n, the number of points."""
        return self._cells.point_count

    @property
    def vertex_count(self) -> int:
        """Number of points that are vertices of cells: neither duplicates nor hidden."""
        return self._cells.vertex_count

    @property
    def cell_count(self) -> int:
        """Number of cells."""
        return self._cells.cell_count

    @property
    def furthest_site(self) -> bool:
        """Whether it is dual to the furthest-point Voronoi diagram."""
        return self._cells.furthest_site

    @property
    def statistics(self) -> dict[str, Any]:
        """How it was computed: decisions by rung (doubles, double-doubles, integers), ties, cells
        made on the way, threads, seconds."""
        return self._cells.statistics

    # What it consists of

    @property
    def cells(self) -> npt.NDArray[np.int32]:
        """(c, k + 1) int32: indices of each cell's vertices, ascending but for the last two, which
        are swapped where that orients it positively (in 2D counter-clockwise); rows sorted."""
        return self._cells.cells

    @property
    def neighbours(self) -> npt.NDArray[np.int32]:
        """(c, k + 1) int32: entry j is the cell opposite to vertex j, or -1."""
        return self._cells.neighbours

    @property
    def cell_groups(self) -> npt.NDArray[np.int32]:
        """(c,) int32: cells of one sphere share a number; numbers ascend by first cell."""
        return self._cells.cell_groups

    @property
    def equations(self) -> npt.NDArray[np.float64]:
        """(c, d + 2) float64: the plane of each of `cells` lifted to ``|x|**2``, with weights to
        ``|x|**2 - weight``: outward unit normal and offset, as ``equations`` of SciPy's Delaunay
        with ``qhull_options="Qc"``. Computed in doubles: not finite where a cell is flat for them.
        A new array. For k < d normals are those of the spheres whose centres lie in the flat.

        >>> import cullhull
        >>> found = cullhull.delaunay([[0, 0], [1, 0], [1, 1], [0, 1]])
        >>> normal, offset = found.equations[0, :-1], found.equations[0, -1]
        >>> bool(abs(normal @ [1, 1, 1**2 + 1**2] + offset) < 1e-15)    # point 2 is on it
        True
        """
        return self._cells.lifted_planes(self.cells, 1.0, 0.0)

    @property
    def hull_facets(self) -> npt.NDArray[np.int32]:
        """(f, k) int32: facets without a neighbour, oriented outward; rows sorted."""
        return self._cells.hull_facets

    @property
    def hidden(self) -> npt.NDArray[np.int32]:
        """(h,) int32, ascending: points that are neither vertices nor duplicates; none without
        weights or ``furthest_site``."""
        return self._cells.hidden

    # Questions

    @takes(Watched)
    def find_simplex(self, points: Any, **options: Unpack[Watched]) -> npt.NDArray[np.int32] | int:
        """The cell that each point is in, exactly.

        Parameters
        ----------
        points : (m, d) array, or (d,) for one
            Finite.

        Returns
        -------
        (m,) int32 array, or int
            On faces that cells share the lowest of their numbers; -1 outside, and for points off
            the flat of a flat triangulation.

        Raises
        ------
        InvalidArgument, NotFinite (ValueErrors)
            For another number of coordinates, a NaN or an infinity.
        KeyboardInterrupt

        Examples
        --------
        >>> import cullhull
        >>> found = cullhull.delaunay([[0, 0], [1, 0], [1, 1], [0, 1]])
        >>> found.find_simplex([[0.75, 0.5], [0.5, 0.75], [0.5, 0.5], [2, 0]]).tolist()
        [0, 1, 0, -1]
        """
        array, single = as_questions(points, self.dimension, "points", "triangulation")
        cells = self._cells.find(array, 0.0, settings(options, Watched))
        return int(cells[0]) if single else cells

    @takes(Watched)
    def nearest(self, points: Any, **options: Unpack[Watched]) -> npt.NDArray[np.int32] | int:
        """The vertex nearest to each point, exactly.

        Parameters
        ----------
        points : as of `find_simplex`

        Returns
        -------
        (m,) int32 array, or int
            Indices of points; of several that are nearest the lowest. With weights the one of least
            power, ``|x - p|**2 - weight``; for the furthest site the furthest one. -1 where the
            triangulation has no vertex.

        Raises
        ------
        InvalidArgument, NotFinite (ValueErrors), KeyboardInterrupt

        Examples
        --------
        >>> import cullhull
        >>> cullhull.delaunay([[0, 0], [1, 0], [0, 1]]).nearest([[2, 1], [0.5, 0.5]]).tolist()
        [1, 0]
        """
        array, single = as_questions(points, self.dimension, "points", "triangulation")
        ids = self._cells.nearest(array, settings(options, Watched))
        return int(ids[0]) if single else ids

    @takes(Watched)
    def barycentric(
        self, points: Any, cells: Any = None, **options: Unpack[Watched]
    ) -> npt.NDArray[np.float64]:
        """Each point as an affine combination of the corners of a cell.

        Parameters
        ----------
        points : (m, d) array, or (d,) for one
            Finite.
        cells : (m,) array of int, or int, optional
            Those of `find_simplex` if not given.

        Returns
        -------
        (m, k + 1) float64 array, or (k + 1,)
            In the order of the cell's vertices, each within 2**-50 of the exact one, relative to it
            where it is larger than 1; zero exactly where it is zero. NaN for a cell of -1.

        Raises
        ------
        InvalidArgument, NotFinite (ValueErrors), KeyboardInterrupt

        Examples
        --------
        >>> import cullhull
        >>> cullhull.delaunay([[0, 0], [1, 0], [0, 1]]).barycentric([0.25, 0.5]).tolist()
        [0.25, 0.25, 0.5]
        """
        array, single = as_questions(points, self.dimension, "points", "triangulation")
        chosen = settings(options, Watched)
        if cells is None:
            found = self._cells.find(array, 0.0, chosen)
        else:
            given = np.atleast_1d(cells)
            if given.dtype.kind not in "iu":
                raise InvalidArgument(f"cells should be integers, not {given.dtype}")
            wrong = (given < -1) | (given >= self.cell_count)
            if wrong.any():  # before the conversion, which would wrap it
                raise InvalidArgument(f"there is no cell {given[wrong][0]} of {self.cell_count}")
            found = np.ascontiguousarray(given, dtype=np.int32)
            if found.shape != (len(array),):
                raise InvalidArgument(f"{len(array)} points need as many cells")
        width = self.affine_dimension + 1
        rows = self._cells.barycentric(array, found, chosen).reshape(len(array), width)
        return rows[0] if single else rows

    @takes(Watched)
    def certify(self, **options: Unpack[Watched]) -> Certificate:
        """Checks this triangulation of its points with an independent exact test.

        Parameters
        ----------

        Returns
        -------
        Certificate
            True if it is proven.

        Raises
        ------
        KeyboardInterrupt

        Examples
        --------
        >>> import cullhull
        >>> bool(cullhull.delaunay(cullhull.generate("ball", 100)).certify())
        True
        """
        return _core.certify_cells(self._cells, settings(options, Watched))


def _of_state(state: dict[str, Any], certificate: Certificate | None) -> Triangulation:
    return Triangulation._of(_core.cells_of_state(state), certificate)


def as_triangulation(points: Any) -> Triangulation | None:
    """The native triangulation that a caller passes in the place of points, if it is one."""
    if isinstance(points, Triangulation):
        return points
    native = getattr(type(points), "_as_triangulation", None)  # of a `Delaunay`
    return None if native is None else native(points)


def triangulated(points: Any, **options: Unpack[Budgeted]) -> Triangulation:
    """The triangulation of points, or the one that is passed in their place."""
    found = as_triangulation(points)
    if found is None:
        return delaunay(points, **options)
    if found.weights is not None:
        raise InvalidArgument("this is of triangulations without weights")
    return found
