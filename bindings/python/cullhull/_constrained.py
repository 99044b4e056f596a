"""Constrained Delaunay triangulations of the plane."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import as_point_set, refuse_mask
from ._errors import InvalidArgument, NotCertified
from ._found_cells import FoundCells
from ._native import Certificate
from ._options import Budgeted, Unpack, settings, takes
from .show._forms import Table


@takes(Budgeted)
def constrained_delaunay(
    points: Any,
    edges: Any,
    *,
    inside_only: bool = False,
    certify: bool = False,
    **options: Unpack[Budgeted],
) -> ConstrainedTriangulation:
    """The constrained Delaunay triangulation of points in the plane: it contains given edges.

    Every unconstrained edge is locally Delaunay, decided exactly. The result does not depend on the
    order of the edges: points on one circle are triangulated from their lowest index.

    Parameters
    ----------
    points : (n, 2) array
    edges : (m, 2) array of int
        Pairs of points. A point that lies exactly on an edge splits it; edges may overlap. An edge
        between two points of equal coordinates is ignored.
    inside_only : bool
        Keep only the triangles inside the outline that the edges form, by the even-odd rule: so the
        outline may have holes, and islands in them.
    certify : bool
        Check the result with an independent exact test, kept as ``result.certificate``.

    Returns
    -------
    ConstrainedTriangulation

    Raises
    ------
    NotFinite, InvalidArgument (ValueErrors), TypeError
        As `delaunay`; also if the points are not 2D, if an edge names an index that does not exist,
        and if two edges cross where there is no point; the message names them.
    OutOfBudget (a MemoryError), KeyboardInterrupt

    Examples
    --------
    >>> import cullhull
    >>> points = [[0, 0], [4, 0], [4, 1], [0, 1], [2, 0.9], [2, 0.1]]
    >>> found = cullhull.constrained_delaunay(points, [[3, 2], [0, 2]], certify=True)
    >>> found.cells.tolist(), found.pieces.tolist()
    ([[0, 1, 5], [0, 2, 4], [0, 4, 3], [0, 5, 2], [1, 2, 5], [2, 3, 4]], [[0, 2], [2, 3]])
    >>> cullhull.constrained_delaunay(points, [[0, 1], [1, 2], [2, 3], [3, 0]]).depths.tolist()
    [1, 1, 1, 1, 1, 1]
    """
    chosen = settings(options, Budgeted)
    array = as_point_set(points)
    refuse_mask(edges, "edges")
    pairs = np.asarray(edges)
    if pairs.size == 0:
        pairs = np.zeros((0, 2), dtype=np.int32)
    if pairs.ndim != 2 or pairs.shape[1] != 2:
        raise InvalidArgument(f"`edges` should be pairs of points, not of shape {pairs.shape}")
    if pairs.dtype.kind not in "iu":
        raise TypeError(f"`edges` should be whole numbers, not {pairs.dtype}")
    wrong = (pairs < 0) | (pairs >= len(array))
    if wrong.any():
        raise InvalidArgument(f"there is no point {pairs[wrong][0]} among {len(array)}")
    flat = np.ascontiguousarray(pairs, dtype=np.int32).reshape(-1)
    cells, pieces, sources, depths, certificate = _core.constrained(
        array, flat, bool(inside_only), bool(certify), chosen
    )
    if certify and not certificate:
        raise NotCertified(certificate.reason)
    return ConstrainedTriangulation(
        cells, pieces.reshape(-1, 2), sources, depths, certificate if certify else None
    )


class ConstrainedTriangulation(FoundCells):
    """A constrained Delaunay triangulation, made by `constrained_delaunay`.

    Attributes
    ----------
    pieces : (p, 2) int32 array
        The given edges, split at the points that lie on them, the lower index first; rows sorted.
    piece_sources : (p,) int32 array
        For each piece the lowest number of a given edge that contains it.
    depths : (c,) int32 array
        For each cell the smallest number of given edges to cross on a way to the outside; odd
        inside the outline.
    certificate : Certificate or None
        What ``certify=True`` found.

    Examples
    --------
    >>> import cullhull
    >>> square, edge = [[0, 0], [1, 0], [1, 1], [0, 1]], [[3, 1]]
    >>> found = cullhull.constrained_delaunay(square, edge)
    >>> found
    <ConstrainedTriangulation of 4 points: 2 cells, 1 constrained edge>
    >>> found.cells.tolist(), found.neighbours.tolist()
    ([[0, 1, 3], [1, 2, 3]], [[1, -1, -1], [-1, 0, -1]])
    """

    __slots__ = ("depths", "piece_sources", "pieces")

    def __init__(
        self,
        cells: _core.Cells,
        pieces: npt.NDArray[np.int32],
        piece_sources: npt.NDArray[np.int32],
        depths: npt.NDArray[np.int32],
        certificate: Certificate | None,
    ) -> None:
        self._cells, self.pieces, self.piece_sources = cells, pieces, piece_sources
        self.depths, self.certificate = depths, certificate

    def __copy__(self) -> ConstrainedTriangulation:
        lists = self.pieces, self.piece_sources, self.depths
        return ConstrainedTriangulation(self._cells, *lists, self.certificate)

    def __reduce__(self) -> tuple[Any, ...]:
        lists = self.pieces, self.piece_sources, self.depths
        return _of_state, (_core.state_of_cells(self._cells), *lists, self.certificate)

    def __repr__(self) -> str:
        n = len(self.pieces)
        return (
            f"<ConstrainedTriangulation of {self._cells.point_count} points: "
            f"{self._cells.cell_count} cells, {n} constrained edge{'' if n == 1 else 's'}>"
        )

    def _parts(self) -> tuple[Any, ...]:
        return self.points, self.cells, self.pieces, self.piece_sources, self.depths

    def _table(self) -> Table:
        rows = [*self._rows_of_table(), ("constrained edges", f"{len(self.pieces):,}")]
        if self.certificate is not None:
            rows.append(("certified", "yes" if self.certificate else "no"))
        return Table("Constrained Delaunay triangulation", rows)

    @property
    def cells(self) -> npt.NDArray[np.int32]:
        """(c, 3) int32: triangles, counter-clockwise from their lowest index; rows sorted. Points
        on one line: (c, 2), the steps from one to the next."""
        return self._cells.cells

    @property
    def neighbours(self) -> npt.NDArray[np.int32]:
        """(c, 3) int32: entry j is the cell opposite to vertex j, or -1."""
        return self._cells.neighbours

    @property
    def hull_facets(self) -> npt.NDArray[np.int32]:
        """(f, 2) int32: edges without a neighbour, counter-clockwise around what is left."""
        return self._cells.hull_facets

    @property
    def hidden(self) -> npt.NDArray[np.int32]:
        """(h,) int32, ascending: points that ``inside_only`` has left no cell at."""
        return self._cells.hidden


def _of_state(state: dict[str, Any], *rest: Any) -> ConstrainedTriangulation:
    return ConstrainedTriangulation(_core.cells_of_state(state), *rest)
