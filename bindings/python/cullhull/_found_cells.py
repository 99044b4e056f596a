"""What triangulations of every kind have in common."""

from __future__ import annotations

import os
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from . import _core
from ._answers import Mesh
from ._errors import InvalidArgument
from ._forms import (
    Picture,
    Rows,
    Surface,
    Volume,
    features,
    in_rows,
    places,
    polygon_geometry,
    require_drawable,
    require_plane,
    require_surface,
)
from ._native import Certified
from ._shown import Exported


def edges_of(cells: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """(e, 2): the edges of simplices, each once, ascending."""
    width = cells.shape[1]
    pairs = [cells[:, [i, j]] for i in range(width) for j in range(i + 1, width)]
    if not pairs:
        return np.empty((0, 2), dtype=cells.dtype)
    return np.unique(np.sort(np.concatenate(pairs), axis=1), axis=0)


class FoundCells(Exported, Certified):
    """A triangulation, of whatever kind."""

    __slots__ = ("_cells",)

    _slot = "_cells"
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

    def save(
        self, path: str | os.PathLike[str], heights: Any = None, *, format: str = ""
    ) -> None:
        """Writes the cells to a file: .json (everything), .vtk (up to 3D); of 2D points also
        .ply .obj .off .stl .glb .vtp .geojson .wkt.

        An error leaves no part of a file behind.

        Parameters
        ----------
        path : str or os.PathLike
            The extension selects the format. An existing file is replaced.
        heights : (n,) array, optional
            Third coordinates of 2D points, for meshes, .vtk and .json: a surface of terrain.
        format : str
            The format, whatever the extension.

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
        _core.save_cells(os.fspath(path), self._cells, rows, format)

    def mesh(self) -> Mesh:
        """The cells as a mesh: coordinates, and simplices that count their rows.

        Points that are vertices of no cell are left out. Time and memory are proportional to the
        number of points and cells.

        Returns
        -------
        Mesh
            ``vertices``, (v, d) float64, in the order of their indices, and ``faces``, (c, k + 1)
            int64: `cells` by rows of ``vertices``.

        Examples
        --------
        >>> import cullhull
        >>> vertices, faces = cullhull.delaunay([[0, 0], [0, 0], [4, 0], [0, 4]]).mesh()
        >>> vertices.tolist(), faces.tolist()
        ([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]], [[0, 1, 2]])
        """
        return self._mesh_of(self._cells.cells)[0]

    def _mesh_of(self, simplices: npt.NDArray[Any]) -> tuple[Mesh, npt.NDArray[Any]]:
        """Of some simplices of points, and the indices of their points, ascending."""
        ids = np.unique(simplices)
        vertices = np.ascontiguousarray(np.asarray(self.points)[ids], dtype=np.float64)
        return Mesh(vertices, places(ids, simplices)), ids

    # As others have it

    def _surface(self) -> Surface:
        cells = self._cells
        require_surface(cells.dimension, cells.affine_dimension, "a triangulation")
        if cells.affine_dimension == 3:
            raise InvalidArgument(
                "tetrahedra are no surface: to_pyvista() and to_open3d() take them, "
                "convex_hull() and alpha_shape() have a surface"
            )
        return self._triangles(cells.cells)

    def _triangles(self, triangles: npt.NDArray[Any]) -> Surface:
        (vertices, faces), ids = self._mesh_of(triangles)
        return Surface(vertices, ids, in_rows(faces), faces, np.arange(len(faces)))

    def _volume(self) -> Volume | None:
        cells = self._cells
        if cells.affine_dimension != 3 or cells.dimension != 3:
            return None
        (vertices, faces), ids = self._mesh_of(cells.cells)
        return Volume(vertices, ids, faces, {"cell_groups": cells.cell_groups})

    def _geometry(self) -> dict[str, Any]:
        cells = self._cells
        require_plane(cells.dimension, "a triangulation")
        triangles = [polygon_geometry([rows]) for rows in self._corners()]
        return features(triangles, cell=range(len(triangles)))

    def _corners(self) -> list[Rows]:
        """Of each triangle its corners."""
        if self._cells.affine_dimension != 2:
            return []
        return list(np.asarray(self.points, dtype=np.float64)[self._cells.cells])

    def _picture(self) -> Picture:
        cells = self._cells
        require_drawable(cells.dimension)
        if cells.affine_dimension == 2:
            return Picture([[rows] for rows in self._corners()])
        (vertices, _), ids = self._mesh_of(cells.cells)
        return Picture(segments=vertices[places(ids, edges_of(cells.cells))], dots=vertices)

    def _shape_count(self) -> int:
        return self._cells.cell_count

    def _rows_of_table(self) -> list[tuple[str, str]]:
        cells = self._cells
        return [
            ("points", f"{cells.point_count:,} in {cells.dimension}D"),
            ("affine dimension", str(cells.affine_dimension)),
            ("vertices", f"{cells.vertex_count:,}"),
            ("cells", f"{cells.cell_count:,}"),
            ("computed in", f"{cells.statistics['compute_seconds'] * 1e3:.3g} ms"),
        ]

    def _page(self) -> str:
        from ._pages import page_of_cells, page_of_surface

        volume = self._volume()
        if volume is None:
            return page_of_surface(self._surface(), None, self._table())
        boundary = places(volume.ids, self._cells.hull_facets)
        return page_of_cells(volume, boundary, self._table())
