"""What results have in common: pictures, files, pages, and the way to other packages."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ._answers import Mesh
from ._errors import InvalidArgument
from ._lists import Lists

if TYPE_CHECKING:
    from ._show import Page

Rows = npt.NDArray[np.float64]


class Surface(NamedTuple):
    """Polygons of points in the plane or in space."""

    points: Rows  # (v, d)
    ids: npt.NDArray[Any]  # (v,): the number of each of them in the result
    #: Places among `points`: simple polygons without holes, counter-clockwise seen from outside.
    polygons: Lists
    triangles: npt.NDArray[np.int64]  # (t, 3): the same area
    pieces: npt.NDArray[Any]  # (t,): triangles of one piece, a facet or a cell, share a number
    data: Mapping[str, npt.NDArray[Any]] = {}  # one value a polygon


class Volume(NamedTuple):
    """Cells of points in space."""

    points: Rows  # (v, 3)
    ids: npt.NDArray[Any]  # (v,)
    tetrahedra: npt.NDArray[np.int64]  # (t, 4): places among `points`
    data: dict[str, npt.NDArray[Any]]  # one value a cell


class Picture(NamedTuple):
    """What is drawn of a result."""

    polygons: Sequence[Sequence[Rows]] = ()  # rings: an outline, then holes
    segments: Sequence[Rows] | Rows = ()  # (2, d) each
    dots: Rows | None = None  # (m, d)
    frame: Rows | None = None  # (m, d): the picture reaches as far as these, if given


class Table(NamedTuple):
    """What a notebook shows beside the picture."""

    caption: str
    rows: Sequence[tuple[str, str]]


def places(ids: npt.NDArray[Any], numbers: npt.NDArray[Any]) -> npt.NDArray[np.int64]:
    """Of each of ``numbers`` its place in ``ids``, which holds all of them, each once."""
    order = np.argsort(ids, kind="stable")
    found: npt.NDArray[np.int64] = order[np.searchsorted(ids, numbers, sorter=order)]
    return found


def fan(corners: int) -> npt.NDArray[np.int64]:
    """The triangles of a convex polygon."""
    middle = np.arange(1, max(corners - 1, 1), dtype=np.int64)
    return np.column_stack([np.zeros_like(middle), middle, middle + 1])


def fans(polygons: Lists) -> npt.NDArray[np.int64]:
    """(t, 3): the triangles of convex polygons, those of each one after the other."""
    starts, items = np.asarray(polygons.offsets), np.asarray(polygons.items, dtype=np.int64)
    counts = np.maximum(np.diff(starts) - 2, 0)
    first = np.repeat(starts[:-1], counts)
    step = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts) + first + 1
    return np.column_stack([items[first], items[step], items[step + 1]])


def in_rows(numbers: npt.NDArray[Any]) -> Lists:
    """The rows of an array as lists."""
    count, width = numbers.shape
    return Lists(np.arange(count + 1, dtype=np.int64) * width, numbers.ravel())


class Shown:
    """The part of a result that draws it, writes it and shows it in a notebook."""

    __slots__ = ()

    def _picture(self) -> Picture:
        """What is drawn; raises `InvalidArgument` for other dimensions than 2 and 3."""
        raise NotImplementedError

    def _table(self) -> Table:
        raise NotImplementedError

    def _shape_count(self) -> int:
        """About how many shapes the picture has: a notebook shows none of very many."""
        raise NotImplementedError

    def _page(self) -> str:
        """An interactive page as HTML."""
        raise NotImplementedError

    def plot(self, ax: Any = None, **style: Any) -> Any:
        """Draws the result with Matplotlib: in the plane or in space.

        Areas are filled, cells of space drawn by their edges.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default the axes of a new figure. In 3D it needs
            ``projection="3d"``.
        style
            Keyword arguments of Matplotlib's collection: ``facecolor``, ``edgecolor``,
            ``linewidth``, ``alpha`` and so on.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ImportError
            If Matplotlib is not installed: ``pip install 'cullhull[plot]'``.
        InvalidArgument (a ValueError)
            If the points are neither 2D nor 3D.

        Examples
        --------
        >>> import cullhull
        >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]]
        >>> axes = cullhull.delaunay(square).plot(facecolor="lightblue")  # doctest: +SKIP
        """
        from . import _show

        return _show.plot(self._picture(), ax, style)

    def view(self, path: str | os.PathLike[str] | None = None, *, show: bool = True) -> Page:
        """Writes an interactive HTML page, and shows it.

        A notebook shows the page below the cell, in a frame; elsewhere a browser opens it. The
        page is one file that needs no network.

        Parameters
        ----------
        path : str or os.PathLike, optional
            Where to write the page; by default a temporary file.
        show : bool
            Open a browser, if this is no notebook.

        Returns
        -------
        str
            The path of the page. A notebook shows the page in its place.

        Raises
        ------
        BackendUnavailable (a RuntimeError)
            If the program was built without the viewer.
        InvalidArgument (a ValueError)
            If the points are neither 2D nor 3D, or too many for one page.

        Examples
        --------
        >>> import cullhull
        >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]]
        >>> cullhull.delaunay(square).view()  # doctest: +SKIP
        '/tmp/cullhull-xxxxxxxx.html'
        """
        from . import _show

        return _show.shown(self._page(), path, show)

    def _repr_html_(self) -> str:
        from . import _show

        picture = None
        if self._shape_count() <= _show.MOST_SHAPES:
            try:
                picture = self._picture()
            except InvalidArgument:  # neither 2D nor 3D
                pass
        return _show.html(self._table(), picture)


class Saved:
    """The part of a result that writes it to files."""

    __slots__ = ()

    def _write(self, path: str, format: str) -> None:
        raise NotImplementedError

    def save(self, path: str | os.PathLike[str], *, format: str = "") -> None:
        """Writes the result to a file, in every format that the program writes it in.

        An error leaves no part of a file behind.

        ============================ ===========================================================
        result                       formats
        ============================ ===========================================================
        `AlphaShape`, `ConcaveHull`  .json; in 2D and 3D .ply .obj .off .stl .glb .vtp .vtk;
                                     in 2D .geojson .wkt
        `ClippedCells`               in 2D and 3D .ply .obj .off .vtp; in 2D .geojson .wkt
        `VoronoiDiagram`             .json
        ============================ ===========================================================

        Parameters
        ----------
        path : str or os.PathLike
            The extension selects the format. An existing file is replaced.
        format : str
            The format, whatever the extension.

        Raises
        ------
        FileError (an OSError)
            If the operating system refuses to write the file.
        InvalidArgument or BadFile (ValueErrors)
            If the format is unknown, or cannot hold this result.

        Examples
        --------
        >>> import cullhull, os, tempfile
        >>> shape = cullhull.alpha_shape(cullhull.generate("disk", 200, 2))
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     shape.save(os.path.join(folder, "shape.geojson"))
        ...     os.listdir(folder)
        ['shape.geojson']
        """
        self._write(os.fspath(path), format)


class Exported(Shown):
    """The part of a result that converts it to objects of other packages."""

    __slots__ = ()

    def _surface(self) -> Surface:
        """Raises `InvalidArgument` where there is none."""
        raise NotImplementedError

    def _volume(self) -> Volume | None:
        """Cells of space; None for a result that is a surface."""
        return None

    def _geometry(self) -> dict[str, Any]:
        """What GeoJSON calls a geometry or a collection; `InvalidArgument` if not of the plane."""
        raise NotImplementedError

    def mesh(self) -> Mesh:
        """The result as a mesh: coordinates, and simplices that count their rows.

        ====================== =================================================================
        result                 simplices
        ====================== =================================================================
        `Hull`, `HullBatch`    the boundary, as `Hull.simplices`: triangles in 3D, edges in 2D
        `AlphaShape`           the boundary, as `AlphaShape.facets`
        `ClippedCells`         the boundary of every cell
        `Triangulation`        the cells: tetrahedra in 3D, triangles in 2D
        ====================== =================================================================

        Time and memory are proportional to the size of the mesh.

        Returns
        -------
        Mesh
            ``vertices``, a (v, d) float64 array of the points that the simplices have, and
            ``faces``, an (m, k) int64 array of rows of ``vertices``.

        Examples
        --------
        >>> import cullhull
        >>> points = [[0, 0], [1, 1], [4, 0], [0, 4]]        # the second one is inside
        >>> vertices, faces = cullhull.convex_hull(points).mesh()
        >>> vertices.tolist(), faces.tolist()
        ([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]], [[0, 2], [1, 0], [2, 1]])
        """
        raise NotImplementedError

    def to_trimesh(self) -> Any:
        """The result as a ``trimesh.Trimesh``.

        A hull, an alpha shape or a concave hull in 3D is its boundary, oriented outward, so that
        the mesh is watertight where the boundary is a closed surface. Results in 2D are triangles
        at z = 0. Clipped cells in 3D are closed surfaces, cell after cell. The vertex attribute
        ``point`` holds the index of each vertex among the points.

        Returns
        -------
        trimesh.Trimesh

        Raises
        ------
        ImportError
            If trimesh is not installed: ``pip install 'cullhull[mesh]'``.
        InvalidArgument (a ValueError)
            If the result has no surface: tetrahedra, points on a line, more than three dimensions.

        Examples
        --------
        >>> import cullhull
        >>> mesh = cullhull.convex_hull(cullhull.generate("ball", 100)).to_trimesh()  # doctest: +SKIP
        >>> mesh.is_watertight  # doctest: +SKIP
        True
        """
        from . import _convert

        return _convert.to_trimesh(self._surface())

    def to_pyvista(self) -> Any:
        """The result as an object of PyVista.

        Tetrahedra and clipped cells in 3D are a ``pyvista.UnstructuredGrid``, everything else is a
        ``pyvista.PolyData``: a hull keeps its merged facets as polygons. Results in 2D are at z = 0.
        The point data ``point`` holds the index of each vertex among the points; the cell data of
        clipped cells hold the index and the measure of each, those of tetrahedra their
        `Triangulation.cell_groups`.

        Returns
        -------
        pyvista.PolyData or pyvista.UnstructuredGrid

        Raises
        ------
        ImportError
            If PyVista is not installed: ``pip install 'cullhull[mesh]'``.
        InvalidArgument (a ValueError)
            If the result has no surface: points on a line, more than three dimensions.

        Examples
        --------
        >>> import cullhull
        >>> cullhull.convex_hull(cullhull.generate("ball", 100)).to_pyvista().plot()  # doctest: +SKIP
        """
        from . import _convert

        volume = self._volume()
        if volume is not None:
            return _convert.tetrahedra_to_pyvista(volume)
        return _convert.to_pyvista(self._surface())

    def to_open3d(self) -> Any:
        """The result as a mesh of Open3D.

        Tetrahedra are an ``open3d.geometry.TetraMesh``, everything else is an
        ``open3d.geometry.TriangleMesh`` as `to_trimesh` describes it.

        Returns
        -------
        open3d.geometry.TriangleMesh or open3d.geometry.TetraMesh

        Raises
        ------
        ImportError
            If Open3D is not installed: ``pip install 'cullhull[open3d]'``.
        InvalidArgument (a ValueError)
            If the result has no surface: points on a line, more than three dimensions.

        Examples
        --------
        >>> import cullhull
        >>> cullhull.convex_hull(cullhull.generate("ball", 100)).to_open3d()  # doctest: +SKIP
        TriangleMesh with 71 points and 138 triangles.
        """
        from . import _convert

        volume = self._volume()
        if volume is not None:
            return _convert.tetrahedra_to_open3d(volume)
        return _convert.to_open3d(self._surface())

    def to_shapely(self) -> Any:
        """The result as a geometry of Shapely: of points in the plane.

        ==================================== ===================================================
        result                               geometry
        ==================================== ===================================================
        `Hull`                               ``Polygon``; of points on a line ``LineString``, of
                                             equal ones ``Point``, of none an empty collection
        `ConcaveHull`                        ``Polygon``
        `AlphaShape`                         ``MultiPolygon``
        `Triangulation`                      ``GeometryCollection`` of triangles
        `ClippedCells`                       ``GeometryCollection``: part i is the cell of point i
        ==================================== ===================================================

        Returns
        -------
        shapely.Geometry

        Raises
        ------
        ImportError
            If Shapely is not installed: ``pip install 'cullhull[geo]'``.
        InvalidArgument (a ValueError)
            If the points are not 2D.

        Examples
        --------
        >>> import cullhull
        >>> cullhull.convex_hull([[0, 0], [2, 0], [0, 2]]).to_shapely().area  # doctest: +SKIP
        2.0
        """
        from . import _convert

        return _convert.to_shapely(self._geometry())

    @property
    def __geo_interface__(self) -> dict[str, Any]:
        """The result as GeoJSON, for GeoPandas, Folium, Shapely and others: of points in the plane.

        A hull, an alpha shape and a concave hull are a geometry; triangles and clipped cells are a
        ``FeatureCollection``. For other dimensions the attribute is absent (AttributeError).
        """
        try:
            return self._geometry()
        except InvalidArgument as error:
            raise AttributeError(str(error)) from None


def closed(ring: Rows) -> list[list[float]]:
    """A ring as GeoJSON has it: the first corner again at the end."""
    corners: list[list[float]] = ring.tolist()
    return [*corners, corners[0]]


def polygon_geometry(rings: Sequence[Rows]) -> dict[str, Any]:
    return {"type": "Polygon", "coordinates": [closed(ring) for ring in rings]}


def polygons_geometry(polygons: Sequence[Sequence[Rows]]) -> dict[str, Any]:
    """Of a single one a Polygon, else a MultiPolygon."""
    if len(polygons) == 1:
        return polygon_geometry(polygons[0])
    return multipolygon_geometry(polygons)


def multipolygon_geometry(polygons: Sequence[Sequence[Rows]]) -> dict[str, Any]:
    return {
        "type": "MultiPolygon",
        "coordinates": [[closed(ring) for ring in rings] for rings in polygons],
    }


def features(geometries: Sequence[dict[str, Any]], **properties: Any) -> dict[str, Any]:
    """A collection; each property is a list of one value a geometry."""
    names = list(properties)
    rows = zip(*properties.values()) if names else ((),) * len(geometries)
    return {
        "type": "FeatureCollection",
        "features": [
            {
                "type": "Feature",
                "properties": dict(zip(names, row)),
                "geometry": geometry,
            }
            for geometry, row in zip(geometries, rows)
        ],
    }


def require_plane(dimension: int, what: str) -> None:
    if dimension != 2:
        raise InvalidArgument(f"{what} of 2D points has a geometry; these are {dimension}D")


def require_surface(dimension: int, affine_dimension: int, what: str) -> None:
    """Raises unless there are polygons of points in the plane or in space."""
    if dimension not in (2, 3):
        raise InvalidArgument(f"{what} of 2D and 3D points has a surface; these are {dimension}D")
    if affine_dimension < 2:
        found = "on a line" if affine_dimension == 1 else "all equal or absent"
        raise InvalidArgument(f"{what} of points that are {found} has no surface")


def require_drawable(dimension: int) -> None:
    if dimension not in (2, 3):
        raise InvalidArgument(f"plot() draws results in 2D and 3D, not {dimension}D")
