"""Cells of a triangulation as a mesh, a picture, a page and objects of other packages."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .. import _core
from .._answers import Mesh
from .._errors import InvalidArgument
from ._forms import (
    Picture,
    Rows,
    Surface,
    Volume,
    edges_of,
    features,
    in_rows,
    places,
    polygon_geometry,
    require_drawable,
    require_plane,
    require_surface,
)
from ._shown import Exported


class ShownCells(Exported):
    """The part of a triangulation that shows its cells."""

    __slots__ = ()

    def _native(self) -> _core.Cells:
        """The triangulation."""
        raise NotImplementedError

    def _cells_shown(self) -> npt.NDArray[np.int32]:
        """(c, k + 1): the cells that are shown."""
        return self._native().cells

    def _boundary(self) -> npt.NDArray[np.int32]:
        """(f, k): their facets without a neighbour."""
        return self._native().hull_facets

    def _groups(self) -> npt.NDArray[np.int32]:
        """(c,): the number of each cell's sphere."""
        return self._native().cell_groups

    def mesh(self) -> Mesh:
        """The cells as a mesh: coordinates, and simplices that count their rows.

        Points that are vertices of no cell are left out. Time and memory are proportional to the
        number of points and cells.

        Returns
        -------
        Mesh
            ``vertices``, (v, d) float64, in the order of their indices, and ``faces``, (c, k + 1)
            int64: the cells by rows of ``vertices``.

        Examples
        --------
        >>> import cullhull
        >>> vertices, faces = cullhull.delaunay([[0, 0], [0, 0], [4, 0], [0, 4]]).mesh()
        >>> vertices.tolist(), faces.tolist()
        ([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]], [[0, 1, 2]])
        """
        return self._mesh_of(self._cells_shown())[0]

    def _mesh_of(self, simplices: npt.NDArray[Any]) -> tuple[Mesh, npt.NDArray[Any]]:
        """A mesh of some simplices, and the indices of their points, ascending."""
        ids = np.unique(simplices)
        vertices = np.ascontiguousarray(np.asarray(self._native().points)[ids], dtype=np.float64)
        return Mesh(vertices, places(ids, simplices)), ids

    def _surface(self) -> Surface:
        require_surface(self._native().dimension, self._native().affine_dimension, "a triangulation")
        if self._native().affine_dimension == 3:
            raise InvalidArgument(
                "tetrahedra are no surface: to_pyvista() and to_open3d() take them, "
                "convex_hull() and alpha_shape() have a surface"
            )
        return self._triangles(self._cells_shown())

    def _triangles(self, triangles: npt.NDArray[Any]) -> Surface:
        (vertices, faces), ids = self._mesh_of(triangles)
        return Surface(vertices, ids, in_rows(faces), faces, np.arange(len(faces)))

    def _volume(self) -> Volume | None:
        if self._native().affine_dimension != 3 or self._native().dimension != 3:
            return None
        (vertices, faces), ids = self._mesh_of(self._cells_shown())
        return Volume(vertices, ids, faces, {"cell_groups": self._groups()})

    def _geometry(self) -> dict[str, Any]:
        require_plane(self._native().dimension, "a triangulation")
        triangles = [polygon_geometry([rows]) for rows in self._corners()]
        return features(triangles, cell=range(len(triangles)))

    def _corners(self) -> list[Rows]:
        """The corners of each triangle."""
        if self._native().affine_dimension != 2:
            return []
        return list(np.asarray(self._native().points, dtype=np.float64)[self._cells_shown()])

    def _picture(self) -> Picture:
        require_drawable(self._native().dimension)
        if self._native().affine_dimension == 2:
            return Picture([[rows] for rows in self._corners()])
        cells = self._cells_shown()
        (vertices, _), ids = self._mesh_of(cells)
        return Picture(segments=vertices[places(ids, edges_of(cells))], dots=vertices)

    def _shape_count(self) -> int:
        return len(self._cells_shown())

    def _page(self) -> str:
        from ._pages import page_of_cells, page_of_surface

        volume = self._volume()
        if volume is None:
            return page_of_surface(self._surface(), None, self._table())
        return page_of_cells(volume, places(volume.ids, self._boundary()), self._table())
