"""Cells of a Voronoi diagram within a region, and the polygons that a region may consist of."""

from __future__ import annotations

import os
from operator import methodcaller
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from . import _core
from ._answers import Mesh
from ._arguments import as_points
from ._constrained import constrained_delaunay
from ._errors import InvalidArgument
from ._extras import needed
from ._lists import Lists
from ._native import Native
from ._options import documented
from ._triangulation import Triangulation
from .show._forms import (
    Picture,
    Surface,
    Table,
    fan,
    fans,
    features,
    following,
    polygons_geometry,
    require_drawable,
    require_plane,
    require_polygons,
    require_surface,
)
from .show._shown import Exported


class Clippable(Protocol):
    """A `VoronoiDiagram`, as far as its clipped cells use it."""

    @property
    def triangulation(self) -> Triangulation: ...
    @property
    def points(self) -> npt.NDArray[Any]: ...


class ClippedCells(Exported, Native):
    """Answer of `VoronoiDiagram.clip`: one cell a point.

    It never changes; a pickle holds the diagram's triangulation and the region, of which it is made
    again, with the same bits.

    Attributes
    ----------
    measures : (n,) float64
        Length, area or volume of each cell within the region; zero for duplicates, hidden points
        and cells outside. They add up to the region's.

    Raises
    ------
    TypeError
        When called: cells are made by `VoronoiDiagram.clip`.

    Examples
    --------
    >>> import cullhull
    >>> cells = cullhull.voronoi([[0, 0], [2, 0], [1, 2]]).clip([0, 0], [2, 2])
    >>> cells.corners(0).tolist(), cells.neighbours[0].tolist()
    ([[0.0, 0.0], [1.0, 0.0], [1.0, 0.75], [0.0, 1.25]], [-1, 1, 2, -1])
    """

    __slots__ = ("_clipped", "_diagram", "_region")

    _clipped: _core.ClippedCells
    _diagram: Clippable
    _region: tuple[Any, ...]

    _made_by = "clipped cells are made by cullhull.VoronoiDiagram.clip"

    @classmethod
    def _of(
        cls, diagram: Clippable, clipped: _core.ClippedCells, region: tuple[Any, ...]
    ) -> ClippedCells:
        result = object.__new__(cls)
        result._diagram, result._clipped = diagram, clipped
        # As numbers of its own: what was passed may change.
        rings = rings_of(region[0]) if len(region) == 1 else None
        if rings is None:
            result._region = tuple(np.array(part) for part in region)
        else:
            result._region = ([ring.copy() for ring in rings],)
        return result

    def __copy__(self) -> ClippedCells:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        shapes = len(self._clipped.vertex_offsets) > 0
        return methodcaller("clip", *self._region, shapes=shapes), (self._diagram,)

    def _parts(self) -> tuple[Any, ...]:
        cells = self._clipped
        return self._diagram, self.measures, cells.vertex_offsets, cells.vertices, cells.ring_starts

    @property
    def points(self) -> npt.NDArray[Any]:
        """(n, d): the points that the cells belong to, as `Triangulation.points`."""
        return self._diagram.points

    @property
    def measures(self) -> npt.NDArray[np.float64]:
        """(n,) float64: length, area or volume of each cell within the region."""
        return self._clipped.measures

    def corners(self, point: int) -> npt.NDArray[np.float64]:
        """(m, d) float64: the corners of a point's cell; in 2D ring by ring, as in `polygons`.

        Parameters
        ----------
        point : int
            Its index.

        >>> import cullhull
        >>> cullhull.voronoi([[0], [1]]).clip([-1], [3]).corners(1).tolist()
        [[0.5], [3.0]]
        """
        begin, end = self._range(self._clipped.vertex_offsets, point)
        return self._clipped.vertices[begin:end]

    def polygons(self, point: int) -> list[list[npt.NDArray[np.float64]]]:
        """In 2D the polygons that a point's cell consists of: one where the region is convex, else
        perhaps several, and none where it does not meet the cell. Each is a list of rings, (m, 2)
        float64: its outline, counter-clockwise, then its holes, clockwise; not closed.

        Parameters
        ----------
        point : int
            Its index.

        >>> import cullhull
        >>> cells = cullhull.voronoi([[1, 1], [3, 1]]).clip(
        ...     [[[0, 0], [4, 0], [4, 2], [0, 2]], [[0.5, 0.5], [1, 1], [0.5, 1]]]
        ... )
        >>> [ring.tolist() for ring in cells.polygons(0)[0]]
        [[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]], [[0.5, 0.5], [0.5, 1.0], [1.0, 1.0]]]
        """
        if self._diagram.triangulation.dimension != 2:
            raise InvalidArgument("polygons are of cells in 2D; in 3D there are faces")
        first, last = self._range(self._clipped.polygon_offsets, point)
        rings, starts = self._clipped.polygon_rings, self._clipped.ring_starts
        rows = self._clipped.vertices
        return [
            [rows[starts[r] : starts[r + 1]] for r in range(rings[g], rings[g + 1])]
            for g in range(first, last)
        ]

    def faces(self, point: int) -> list[list[int]]:
        """In 3D the faces of a point's cell: rows of its `corners`, counter-clockwise from outside.

        Parameters
        ----------
        point : int
            Its index.

        Raises
        ------
        InvalidArgument (a ValueError)
            In 1D and 2D, and where ``shapes=False`` left corners and faces out.

        >>> import cullhull
        >>> cells = cullhull.voronoi([[0, 0, 0], [1, 0, 0]]).clip([-1] * 3, [2] * 3)
        >>> len(cells.faces(0)), len(cells.corners(0))
        (6, 8)
        """
        if self._diagram.triangulation.dimension != 3:
            raise InvalidArgument("faces are of cells in 3D; in 2D there are polygons")
        begin, end = self._range(self._clipped.face_offsets, point)
        starts = self._clipped.face_starts[begin : end + 1].tolist()
        return [self._clipped.face_vertices[a:b].tolist() for a, b in zip(starts, starts[1:])]

    @property
    def neighbours(self) -> Lists:
        """The point across each face (in 2D each edge, from the corner where it begins), or -1 at
        the region's boundary."""
        faces = self._clipped.face_offsets
        return Lists(
            faces if len(faces) else self._clipped.vertex_offsets, self._clipped.neighbours
        )

    def _range(self, offsets: npt.NDArray[np.int64], point: int) -> tuple[int, int]:
        if len(offsets) == 0:
            raise InvalidArgument("clip() was called with shapes=False")
        if not 0 <= point < len(offsets) - 1:
            raise IndexError(f"point {point} of {len(offsets) - 1}")
        return int(offsets[point]), int(offsets[point + 1])

    def mesh(self) -> Mesh:
        """The boundary of every cell as a mesh: corners, and simplices that count them.

        In 2D the simplices are edges, counter-clockwise around a cell (clockwise around a hole); in
        3D they are triangles, counter-clockwise seen from outside; in 1D they are the ends. The
        corners of a cell follow one another, in the order of `corners`, so that a corner of several
        cells is repeated. Time and memory are proportional to the size of the mesh.

        Returns
        -------
        Mesh
            ``vertices``, (v, d) float64, and ``faces``, (m, d) int64.

        Raises
        ------
        InvalidArgument (a ValueError)
            Where ``shapes=False`` left the shapes out.

        Examples
        --------
        >>> import cullhull
        >>> cells = cullhull.voronoi([[0, 0], [2, 0]]).clip([0, 0], [2, 1])
        >>> vertices, faces = cells.mesh()
        >>> len(vertices), faces[:4].tolist()
        (8, [[0, 1], [1, 2], [2, 3], [3, 0]])
        """
        self._require_shapes()
        rows = self._clipped.vertices
        number = np.arange(len(rows), dtype=np.int64)
        if rows.shape[1] == 3:
            return Mesh(rows, fans(self._faces()))
        if rows.shape[1] == 1:
            return Mesh(rows, number[:, np.newaxis])
        return Mesh(rows, np.column_stack([number, following(self._clipped.ring_starts)]))

    def to_pyvista(self) -> Any:
        """The cells as an object of PyVista.

        In 3D a ``pyvista.UnstructuredGrid`` of polyhedra; in 2D a ``pyvista.PolyData`` of polygons
        at z = 0, those with dents or holes in triangles. The cell data ``point`` hold the index of
        each cell's point, ``measure`` its volume or area.

        Returns
        -------
        pyvista.UnstructuredGrid or pyvista.PolyData

        Raises
        ------
        ImportError
            If PyVista is not installed: ``pip install 'cullhull[mesh]'``.
        InvalidArgument (a ValueError)
            In 1D, and where ``shapes=False`` left the shapes out.

        Examples
        --------
        >>> import cullhull
        >>> cells = cullhull.voronoi(cullhull.generate("cube", 50)).clip([-1] * 3, [1] * 3)
        >>> cells.to_pyvista().n_cells  # doctest: +SKIP
        50
        """
        from .show import _meshes

        if self._diagram.triangulation.dimension != 3:
            return _meshes.to_pyvista(self._surface())
        self._require_shapes()
        faces = self._faces()
        starts = self._clipped.face_offsets.tolist()
        shown = [i for i, (a, b) in enumerate(zip(starts, starts[1:])) if b > a]
        polyhedra = [faces[starts[i] : starts[i + 1]] for i in shown]
        data = {"point": np.array(shown), "measure": self.measures[shown]}
        return _meshes.polyhedra_to_pyvista(self._clipped.vertices, polyhedra, data)

    # As others have it

    def _require_shapes(self) -> None:
        if len(self._clipped.vertex_offsets) == 0:
            raise InvalidArgument("clip() was called with shapes=False")

    def _owners(self) -> npt.NDArray[np.int64]:
        """The point whose cell each corner belongs to."""
        counts = np.diff(self._clipped.vertex_offsets)
        return np.repeat(np.arange(len(counts), dtype=np.int64), counts)

    def _faces(self) -> Lists:
        """In 3D the faces of all cells, by rows of all corners."""
        cells = self._clipped
        cell = np.repeat(cells.vertex_offsets[:-1], np.diff(cells.face_offsets))
        items = cells.face_vertices + np.repeat(cell, np.diff(cells.face_starts))
        return Lists(cells.face_starts, items)

    def _surface(self) -> Surface:
        self._require_shapes()
        rows = self._clipped.vertices
        require_surface(rows.shape[1], 2, "a diagram")
        owners = self._owners()
        if rows.shape[1] == 3:
            faces = self._faces()
            cell = np.repeat(np.arange(len(self)), np.diff(self._clipped.face_offsets))
            data = {"point": cell, "measure": self.measures[cell]}
            pieces = np.repeat(np.arange(len(faces)), faces.lengths() - 2)
            return Surface(rows, owners, faces, fans(faces), pieces, data)
        polygons: list[npt.NDArray[np.int64]] = []
        triangles: list[npt.NDArray[np.int64]] = [np.empty((0, 3), dtype=np.int64)]
        for rings in self._ring_numbers():
            if len(rings) == 1 and _is_convex(rows[rings[0]]):
                polygons.append(rings[0])
                triangles.append(rings[0][fan(len(rings[0]))])
            else:
                triangles.append(_triangles(rows, rings))
                polygons += list(triangles[-1])
        ends = np.cumsum([0, *map(len, polygons)])
        items = np.concatenate(polygons) if polygons else np.empty(0, dtype=np.int64)
        cell = owners[items[ends[:-1]]]
        data = {"point": cell, "measure": self.measures[cell]}
        whole = np.concatenate(triangles)
        return Surface(rows, owners, Lists(ends, items), whole, owners[whole[:, 0]], data)

    def _ring_numbers(self) -> list[list[npt.NDArray[np.int64]]]:
        """The rings of each polygon of each cell, by rows of all corners."""
        rings, starts = self._clipped.polygon_rings.tolist(), self._clipped.ring_starts.tolist()
        return [
            [np.arange(starts[r], starts[r + 1]) for r in range(begin, end)]
            for begin, end in zip(rings, rings[1:])
        ]

    def to_geopandas(self, data: Any = None, *, crs: Any = None) -> Any:
        """The cells as a table of GeoPandas: a row for each point.

        Parameters
        ----------
        data : GeoDataFrame or DataFrame, optional
            A row for each point, in the order of the points, such as the table that they come from:
            its columns (without geometries) and index are taken. A column of it comes in the place
            of one of ours that has its name.
        crs : anything that GeoPandas takes, optional
            The coordinate reference system; default: that of `data`.

        Returns
        -------
        geopandas.GeoDataFrame
            The columns ``point`` and ``area``, those of `data`, and ``geometry``: polygons, of points
            without a cell within the region empty ones.

        Raises
        ------
        ImportError
            If GeoPandas is not installed: ``pip install 'cullhull[geo]'``.
        InvalidArgument (a ValueError)
            If the points are not 2D, or `data` has another number of rows.

        Examples
        --------
        >>> import cullhull
        >>> cells = cullhull.voronoi([[0, 0], [2, 0], [1, 2]]).clip([0, 0], [2, 2])
        >>> cells.to_geopandas(crs="EPSG:25832").area.sum()  # doctest: +SKIP
        4.0
        """
        geopandas = needed("geopandas", "to_geopandas()", "geo")
        shapes = list(self.to_shapely().geoms)
        columns: dict[str, Any] = {"point": np.arange(len(self)), "area": self.measures}
        index = None
        if data is not None:
            if len(data) != len(self):
                raise InvalidArgument(f"data has {len(data)} rows, but there are {len(self)} cells")
            index = data.index
            if crs is None:
                crs = getattr(data, "crs", None)
            kept = [c for c in data.columns if str(data[c].dtype) != "geometry"]
            columns.update({c: data[c].array for c in kept})
        return geopandas.GeoDataFrame(columns, geometry=shapes, index=index, crs=crs)

    def _geometry(self) -> dict[str, Any]:
        require_plane(self._diagram.triangulation.dimension, "a diagram")
        cells = [polygons_geometry(self.polygons(i)) for i in range(len(self))]
        return features(cells, point=range(len(self)), area=self.measures.tolist())

    def _picture(self) -> Picture:
        require_drawable(self._diagram.triangulation.dimension)
        self._require_shapes()
        rows = self._clipped.vertices
        if rows.shape[1] == 3:
            return Picture([[rows[face]] for face in self._faces()])
        return Picture([[rows[ring] for ring in rings] for rings in self._ring_numbers()])

    def _shape_count(self) -> int:
        return len(self.measures) * self._diagram.triangulation.dimension

    def _table(self) -> Table:
        found = self._diagram.triangulation
        what = {1: "length", 2: "area", 3: "volume"}[found.dimension]
        return Table(
            "Voronoi cells" if found.weights is None else "Power cells",
            [
                ("points", f"{found.point_count:,} in {found.dimension}D"),
                ("cells in the region", f"{np.count_nonzero(self.measures):,}"),
                (what, f"{self.measures.sum():.6g}"),
            ],
        )

    @documented("path", "format", "crs")
    def save(
        self,
        path: str | os.PathLike[str],
        *,
        format: str = "",
        polygons: bool | None = None,
        crs: str | None = None,
    ) -> None:
        """Writes the cells: in 2D and 3D .ply .obj .off .vtp, in 2D .geojson .wkt .gpkg .fgb .shp.

        An error leaves no part of a file behind.

        Parameters
        ----------
        polygons : bool, optional
            Whether .ply, .obj, .off and .vtp hold the cells (in 3D their faces) as polygons, which
            have no holes there, or as triangles. By default triangles, which every program reads;
            polygons in .vtp.

        Raises
        ------
        FileError (an OSError)
            If the operating system refuses to write the file.
        InvalidArgument or BadFile (ValueErrors)
            If the format is unknown, or cannot hold these cells; for ``polygons`` with a format
            that has no choice.

        Examples
        --------
        >>> import cullhull, os, tempfile
        >>> cells = cullhull.voronoi([[0, 0], [2, 0], [1, 2]]).clip([0, 0], [2, 2])
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     cells.save(os.path.join(folder, "cells.off"), polygons=True)
        ...     print(open(os.path.join(folder, "cells.off")).readlines()[1].strip())
        13 3 13
        """
        require_polygons(path, format, polygons)
        cells = self._clipped
        from .geo._maps import save_map  # with what writes files

        save_map(path, format, crs, lambda p, f, c: _core.save_clipped(p, cells, f, polygons, c))

    def _page(self) -> str:
        from .show._pages import Sites, page_of_surface

        surface = self._surface()
        edges = self.mesh().faces if surface.points.shape[1] == 2 else None
        sites = Sites(self.points, self.measures)
        return page_of_surface(surface, edges, self._table(), sites)

    def __len__(self) -> int:
        return len(self.measures)

    def __repr__(self) -> str:
        return f"<ClippedCells: {len(self)} cells>"


def _triangles(
    rows: npt.NDArray[np.float64], rings: list[npt.NDArray[np.int64]]
) -> npt.NDArray[np.int64]:
    """A polygon of the plane with dents or holes in triangles, whose corners are rows."""
    numbers = np.concatenate(rings)
    after = following(np.cumsum([0, *map(len, rings)]))
    edges = np.column_stack([np.arange(len(numbers)), after])
    found = constrained_delaunay(rows[numbers], edges, inside_only=True)
    return numbers[found.cells]


def _is_convex(ring: npt.NDArray[np.float64]) -> bool:
    edges = np.roll(ring, -1, axis=0) - ring
    after = np.roll(edges, -1, axis=0)
    return bool((edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0] >= 0).all())


def rings_of(region: Any) -> list[npt.NDArray[np.float64]] | None:
    """The rings of polygons; None for a single array of corners."""
    shape = getattr(region, "__geo_interface__", region)
    if isinstance(shape, dict):
        return _rings_of_geometry(shape)
    if isinstance(shape, (list, tuple)) and len(shape) > 0 and np.ndim(shape[0]) == 2:
        return [np.asarray(as_points(ring, "ring"), dtype=np.float64) for ring in shape]
    return None


def _rings_of_geometry(shape: Any) -> list[npt.NDArray[np.float64]]:
    if shape is None:
        return []
    kind = shape.get("type")
    if kind in ("FeatureCollection", "GeometryCollection"):
        parts = shape["features" if kind == "FeatureCollection" else "geometries"]
        return [ring for part in parts for ring in _rings_of_geometry(part)]
    if kind == "Feature":
        return _rings_of_geometry(shape["geometry"])
    if kind not in ("Polygon", "MultiPolygon"):
        raise InvalidArgument(f"a region of polygons is needed, not a {kind}")
    polygons = [shape["coordinates"]] if kind == "Polygon" else shape["coordinates"]
    return [
        np.asarray(ring, dtype=np.float64)[:, :2] for polygon in polygons for ring in polygon
    ]
