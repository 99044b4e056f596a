"""What triangulations of every kind have in common."""

from __future__ import annotations

import os
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from . import _core
from ._errors import InvalidArgument
from ._native import Certified
from ._options import documented
from .show._shown_cells import ShownCells


class FoundCells(ShownCells, Certified):
    """A triangulation, of whatever kind."""

    __slots__ = ("_cells",)

    _made_of = ("_cells", "certificate")
    _cells: _core.Cells

    @property
    def points(self) -> npt.NDArray[Any]:
        """(n, d): the points as they were given; not a copy where they were read in place."""
        return cast("npt.NDArray[Any]", self._cells.points)

    @property
    def hull_cells(self) -> npt.NDArray[np.int32]:
        """(f,) int32: the cell of each of `hull_facets`."""
        return self._cells.hull_cells

    @property
    def duplicates(self) -> npt.NDArray[np.int32]:
        """(m, 2) int32: points with the coordinates of another, and the one that stands in."""
        return self._cells.duplicates

    @documented("path", "format", "crs")
    def save(
        self,
        path: str | os.PathLike[str],
        heights: Any = None,
        *,
        format: str = "",
        crs: str | None = None,
    ) -> None:
        """Writes the cells to a file: .json (everything), .vtk (up to 3D); of 2D points also
        .ply .obj .off .stl .glb .vtp .geojson .wkt .gpkg .fgb .shp.

        An error leaves no part of a file behind.

        Parameters
        ----------
        heights : (n,) array, optional
            Third coordinates of 2D points, for meshes, .vtk and .json: a surface of terrain.

        Raises
        ------
        FileError (an OSError)
            If the operating system refuses to write the file.
        InvalidArgument or BadFile (ValueErrors)
            If the format is unknown, or cannot hold these cells or their heights.

        Examples
        --------
        >>> import cullhull, os, tempfile
        >>> found = cullhull.delaunay([[0, 0], [1, 0], [0, 1]])
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     found.save(os.path.join(folder, "terrain.ply"), heights=[5.0, 6.0, 5.5])
        ...     os.listdir(folder)
        ['terrain.ply']
        """
        rows = None
        if heights is not None:
            rows = np.ascontiguousarray(heights, dtype=np.float64)
            if rows.ndim != 1:
                raise InvalidArgument(f"heights should be one number a point, not {rows.shape}")
        from .geo._maps import save_map  # with what writes files

        save_map(path, format, crs, lambda p, f, c: _core.save_cells(p, self._cells, rows, f, c))

    def _native(self) -> _core.Cells:
        return self._cells

    def _rows_of_table(self) -> list[tuple[str, str]]:
        cells = self._cells
        return [
            ("points", f"{cells.point_count:,} in {cells.dimension}D"),
            ("affine dimension", str(cells.affine_dimension)),
            ("vertices", f"{cells.vertex_count:,}"),
            ("cells", f"{cells.cell_count:,}"),
            ("computed in", f"{cells.statistics['compute_seconds'] * 1e3:.3g} ms"),
        ]
