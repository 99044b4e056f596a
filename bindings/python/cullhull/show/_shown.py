"""What results have in common: pictures, files, pages, and the way to other packages."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from .._answers import Mesh
from .._errors import InvalidArgument
from .._options import documented
from ._forms import Picture, Surface, Table, Volume

if TYPE_CHECKING:
    from ._pictures import Page


class Shown:
    """The part of a result that draws it, writes it and shows it in a notebook."""

    __slots__ = ()

    def _in_place(self) -> Shown:
        """The result that stands for this one in whatever of the following a class leaves to it."""
        raise NotImplementedError

    def _picture(self) -> Picture:
        """What is drawn; raises `InvalidArgument` for other dimensions than 2 and 3."""
        return self._in_place()._picture()

    def _table(self) -> Table:
        return self._in_place()._table()

    def _shape_count(self) -> int:
        """About how many shapes the picture has: a notebook shows none of very many."""
        return self._in_place()._shape_count()

    def _page(self) -> str:
        """An interactive page as HTML."""
        return self._in_place()._page()

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
        from . import _pictures

        return _pictures.plot(self._picture(), ax, style)

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
        from . import _pictures

        return _pictures.shown(self._page(), path, show)

    def _repr_html_(self) -> str:
        from . import _pictures

        picture = None
        if self._shape_count() <= _pictures.MOST_SHAPES:
            try:
                picture = self._picture()
            except InvalidArgument:  # neither 2D nor 3D
                pass
        return _pictures.html(self._table(), picture)


class Saved:
    """The part of a result that writes it to files."""

    __slots__ = ()

    def _write(self, path: str, format: str, crs: str = "") -> None:
        raise NotImplementedError

    @documented("path", "format", "crs")
    def save(
        self, path: str | os.PathLike[str], *, format: str = "", crs: str | None = None
    ) -> None:
        """Writes the result to a file, in every format that the program writes it in.

        An error leaves no part of a file behind.

        ============================ ===========================================================
        result                       formats
        ============================ ===========================================================
        `AlphaShape`, `ConcaveHull`  .json; in 2D and 3D .ply .obj .off .stl .glb .vtp .vtk;
                                     in 2D .geojson .wkt .gpkg .fgb .shp
        `HullBatch`                  .csv .json; in 2D .geojson .gpkg .fgb .shp: a record for each
                                     set, with the key ``set``
        `VoronoiDiagram`             .json
        ============================ ===========================================================

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
        from ..geo._maps import save_map  # with what writes files

        save_map(path, format, crs, self._write)


class Exported(Shown):
    """The part of a result that converts it to objects of other packages."""

    __slots__ = ()

    def _in_place(self) -> Exported:
        raise NotImplementedError

    def _surface(self) -> Surface:
        """Raises `InvalidArgument` where there is none."""
        return self._in_place()._surface()

    def _volume(self) -> Volume | None:
        """Cells of space; None for a result that is a surface."""
        return None

    def _geometry(self) -> dict[str, Any]:
        """What GeoJSON calls a geometry or a collection; `InvalidArgument` if not of the plane."""
        return self._in_place()._geometry()

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
        from . import _meshes

        return _meshes.to_trimesh(self._surface())

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
        from . import _meshes

        volume = self._volume()
        if volume is not None:
            return _meshes.tetrahedra_to_pyvista(volume)
        return _meshes.to_pyvista(self._surface())

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
        from . import _meshes

        volume = self._volume()
        if volume is not None:
            return _meshes.tetrahedra_to_open3d(volume)
        return _meshes.to_open3d(self._surface())

    def to_shapely(self) -> Any:
        """The result as a geometry of Shapely: of points in the plane.

        ==================================== ===================================================
        result                               geometry
        ==================================== ===================================================
        `Hull`                               ``Polygon``; of points on a line ``LineString``, of
                                             equal ones ``Point``, of none an empty collection
        `ConcaveHull`                        ``Polygon``; of points on a line ``LineString``, of
                                             equal ones ``Point``
        `AlphaShape`                         ``MultiPolygon``; of points on a line ``LineString``
                                             or ``MultiLineString``, of equal ones ``Point``
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
        from . import _meshes

        return _meshes.to_shapely(self._geometry())

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
