"""Voronoi and power diagrams: the native face, and the class that stands in for SciPy's."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import Progress, as_points, settings
from ._answers import Mesh
from ._constrained import constrained_delaunay
from ._delaunay import Lifted, as_triangulation
from ._errors import InvalidArgument
from ._forms import (
    Picture,
    Rows,
    Surface,
    Table,
    fan,
    fans,
    features,
    polygons_geometry,
    require_drawable,
    require_plane,
    require_surface,
)
from ._incremental import Lazy
from ._lists import Lists, collector_paused
from ._native import Native
from ._shown import Exported, Saved, Shown
from ._triangulation import Triangulation, delaunay


def voronoi(
    points: Any,
    weights: Any = None,
    *,
    furthest_site: bool = False,
    threads: int | None = None,
    memory_budget: int | None = None,
    progress: Progress = None,
) -> VoronoiDiagram:
    """The Voronoi diagram of points in any dimension; with weights, the power diagram.

    Which regions meet is decided exactly: vertices that coincide are one vertex, however many
    points have the same distance from it. Time is that of `delaunay`, plus a time proportional to
    the number of cells.

    Parameters
    ----------
    points : (n, d) array, or a `Triangulation` or `Delaunay` of the points
        As in `delaunay`.
    weights, furthest_site : as in `delaunay`
    threads, memory_budget, progress : as in `convex_hull`

    Returns
    -------
    VoronoiDiagram

    Raises
    ------
    NotFinite, InvalidArgument (ValueErrors), TypeError
        As `delaunay`.
    OutOfBudget (a MemoryError), KeyboardInterrupt

    Examples
    --------
    >>> import cullhull
    >>> found = cullhull.voronoi([[0, 0], [2, 0], [2, 2], [0, 2]])
    >>> found.vertices.tolist(), found.ridge_points.tolist()
    ([[1.0, 1.0]], [[0, 1], [0, 3], [1, 2], [2, 3]])
    """
    chosen = settings(threads=threads, memory_budget=memory_budget, progress=progress)
    found = as_triangulation(points)
    if found is not None:
        if weights is not None or furthest_site:
            raise InvalidArgument("the triangulation has its weights and its kind already")
    else:
        found = delaunay(
            points,
            weights,
            furthest_site=furthest_site,
            threads=threads,
            memory_budget=memory_budget,
            progress=progress,
        )
    return VoronoiDiagram._of(found, _core.voronoi(found._cells, chosen))


class VoronoiDiagram(Shown, Saved, Native):
    """A Voronoi or power diagram, made by `voronoi`: the dual of a `Triangulation`.

    All arrays are read-only views of the result's own memory. It never changes; a pickle holds the
    triangulation, of which it is made again.

    Attributes
    ----------
    triangulation : Triangulation

    Raises
    ------
    TypeError
        When called: diagrams are made by `voronoi`.

    Examples
    --------
    >>> import cullhull
    >>> found = cullhull.voronoi([[0, 0], [2, 0], [0, 2], [2, 2], [1, 1]])
    >>> found
    <VoronoiDiagram of 5 points in 2D: 4 vertices, 8 ridges>
    >>> found.vertices.tolist(), found.regions[4].tolist(), found.regions[0].tolist()
    ([[1.0, 0.0], [0.0, 1.0], [2.0, 1.0], [1.0, 2.0]], [0, 2, 3, 1], [-1, 0, 1])
    """

    __slots__ = ("_diagram", "triangulation")

    #: The triangulation that it is dual to.
    triangulation: Triangulation
    _diagram: _core.Diagram

    _made_by = "diagrams are made by cullhull.voronoi"

    @classmethod
    def _of(cls, triangulation: Triangulation, diagram: _core.Diagram) -> VoronoiDiagram:
        result = object.__new__(cls)
        result.triangulation, result._diagram = triangulation, diagram
        return result

    def __copy__(self) -> VoronoiDiagram:
        return VoronoiDiagram._of(self.triangulation, self._diagram)

    def __reduce__(self) -> tuple[Any, ...]:
        return voronoi, (self.triangulation,)

    def _parts(self) -> tuple[Any, ...]:
        return (self.triangulation,)  # of which all else follows

    def __repr__(self) -> str:
        kind = "VoronoiDiagram" if self.triangulation.weights is None else "Power diagram"
        return (
            f"<{kind} of {self.triangulation.point_count} points in "
            f"{self.triangulation.dimension}D: {len(self.vertices)} vertices, "
            f"{len(self.ridge_points)} ridges>"
        )

    @property
    def points(self) -> npt.NDArray[Any]:
        """(n, d): the points as they were given, as `Triangulation.points`."""
        return self.triangulation.points

    @property
    def vertices(self) -> npt.NDArray[np.float64]:
        """(v, d) float64: vertex i is the centre of the sphere of the triangulation's cells of
        group i, each coordinate the nearest double; infinite beyond their range."""
        return self._diagram.vertices

    @property
    def ridge_points(self) -> npt.NDArray[np.int32]:
        """(r, 2) int32: pairs of points whose regions share a face; ascending, rows sorted."""
        return self._diagram.ridge_points

    @property
    def ridges(self) -> Lists:
        """The vertices of each face between two regions, -1 where it is unbounded. In 2D the one on
        the left of the way from the first point to the second, then the other; in 3D around that
        way by the right hand; otherwise ascending."""
        return Lists(self._diagram.ridge_offsets, self._diagram.ridge_vertices)

    @property
    def regions(self) -> Lists:
        """The vertices of the region of each point, -1 where it is unbounded; none for duplicates
        and hidden points. In 2D counter-clockwise, otherwise ascending."""
        return Lists(self._diagram.region_offsets, self._diagram.region_vertices)

    @property
    def ray_vertices(self) -> npt.NDArray[np.int32]:
        """(f,) int32: where the unbounded edges begin, one for each of the triangulation's
        `hull_facets`."""
        return self._diagram.ray_vertices

    @property
    def ray_directions(self) -> npt.NDArray[np.float64]:
        """(f, d) float64: where they lead; the largest component is between 0.5 and 1."""
        return self._diagram.ray_directions

    def clip(
        self,
        low: Any,
        high: Any = None,
        *,
        shapes: bool = True,
        threads: int | None = None,
        progress: Progress = None,
    ) -> ClippedCells:
        """The cells within a box, polygons or a convex region, in 1D, 2D and 3D.

        Every decision is exact: cells that share a corner have the same bits for it, vertices of
        the diagram have those of `vertices`, and no corner lies outside the box. Time is some
        microseconds a cell in 2D and some ten in 3D.

        Parameters
        ----------
        low, high : (d,) arrays
            The corners of a box. Or pass the region as `low` alone. In 2D: an (m, 2) array, the
            corners of a polygon in order, which need not be convex; a list of such arrays, the
            rings of polygons with holes and several parts, inside by the even-odd rule; or an
            object with a ``__geo_interface__``, such as a polygon of Shapely, a `ConcaveHull` or an
            `AlphaShape`. In 1D and 3D: an (m, d) array of points, whose convex hull is the region.
        shapes : bool
            Compute the corners and faces of the cells, not only their measures.
        threads, progress : as in `convex_hull`

        Returns
        -------
        ClippedCells

        Raises
        ------
        InvalidArgument, NotFinite (ValueErrors)
            For a region that is empty or flat, whose boundary crosses itself, and for d > 3.
        KeyboardInterrupt

        Examples
        --------
        >>> import cullhull
        >>> found = cullhull.voronoi([[0, 0], [2, 0], [0, 2], [2, 2], [1, 1]])
        >>> found.clip([0, 0], [2, 2]).measures.tolist()
        [0.5, 0.5, 0.5, 0.5, 2.0]
        >>> found.clip([[0, 0], [2, 0], [2, 2], [1, 1]]).measures.tolist()
        [0.25, 0.5, 0.0, 0.25, 1.0]
        """
        region: Any = (low,) if high is None else (low, high)
        return ClippedCells._of(self, self._clip(region, bool(shapes), threads, progress), region)

    def _picture(self) -> Picture:
        """In the plane the edges, unbounded ones as far as the picture reaches; in space the
        bounded faces."""
        found = self.triangulation
        require_drawable(found.dimension)
        sites = np.asarray(found.points, dtype=np.float64)
        vertices = self.vertices
        good = np.append(np.isfinite(vertices).all(axis=1), False)  # the last one is at infinity
        ridges = [ridge for ridge in self.ridges if len(ridge) and good[ridge].all()]
        if found.dimension == 3:
            faces = [[vertices[ridge]] for ridge in ridges if len(ridge) > 2]
            return Picture(faces, dots=sites, frame=sites)
        edges = [vertices[ridge] for ridge in ridges if len(ridge) == 2]
        return Picture(segments=edges + self._rays(good), dots=sites, frame=sites)

    def _rays(self, good: npt.NDArray[np.bool_]) -> list[Rows]:
        found = self.triangulation
        if found.affine_dimension != 2:
            return []
        starts = self.vertices[self.ray_vertices[good[self.ray_vertices]]]
        directions = self.ray_directions[good[self.ray_vertices]]
        sites = np.asarray(found.points, dtype=np.float64)
        low, high = sites.min(axis=0), sites.max(axis=0)
        away = np.maximum(np.abs(starts - low), np.abs(starts - high)).sum(axis=1)
        ends = starts + 4 * away[:, np.newaxis] * directions  # beyond all points
        return list(np.stack([starts, ends], axis=1))

    def _shape_count(self) -> int:
        return len(self.ridge_points)

    def _table(self) -> Table:
        found = self.triangulation
        return Table(
            "Voronoi diagram" if found.weights is None else "Power diagram",
            [
                ("points", f"{found.point_count:,} in {found.dimension}D"),
                ("vertices", f"{len(self.vertices):,}"),
                ("ridges", f"{len(self.ridge_points):,}"),
            ],
        )

    def _write(self, path: str, format: str) -> None:
        _core.save_diagram(path, self._diagram, format)

    def _page(self) -> str:
        return self._within_box()._page()

    def _within_box(self) -> ClippedCells:
        """The cells in the box of the points, a tenth wider, as the program clips them."""
        sites = np.asarray(self.points, dtype=np.float64)
        if len(sites) == 0:
            raise InvalidArgument("a diagram without points has no cells to view")
        low, high = sites.min(axis=0), sites.max(axis=0)
        margin = 0.1 * float((high - low).max()) or 1.0
        return self.clip(low - margin, high + margin)

    def _clip(
        self, region: tuple[Any, ...], shapes: bool, threads: int | None, progress: Progress
    ) -> _core.ClippedCells:
        cells, diagram = self.triangulation._cells, self._diagram
        chosen = settings(threads=threads, progress=progress)
        if len(region) == 2:
            low, high = (
                np.asarray(as_points(c, "corner", axes=1), dtype=np.float64).tolist()
                for c in region
            )
            return _core.clip_to_box(cells, diagram, low, high, shapes, chosen)
        rings = _rings(region[0])
        if rings is None:
            return _core.clip_to_hull(
                cells, diagram, as_points(region[0], "region"), shapes, chosen
            )
        if not rings:
            raise InvalidArgument("the region has no polygon")
        corners = np.concatenate(rings)
        offsets = np.cumsum([0, *map(len, rings)]).tolist()
        return _core.clip_to_polygons(cells, diagram, corners, offsets, shapes, chosen)


def _rings(region: Any) -> list[npt.NDArray[np.float64]] | None:
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


class ClippedCells(Exported, Saved, Native):
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
    _diagram: VoronoiDiagram
    _region: tuple[Any, ...]

    _made_by = "clipped cells are made by cullhull.VoronoiDiagram.clip"

    @classmethod
    def _of(
        cls, diagram: VoronoiDiagram, clipped: _core.ClippedCells, region: tuple[Any, ...]
    ) -> ClippedCells:
        result = object.__new__(cls)
        result._diagram, result._clipped = diagram, clipped
        # As numbers of its own: what was passed may change.
        rings = _rings(region[0]) if len(region) == 1 else None
        if rings is None:
            result._region = tuple(np.array(part) for part in region)
        else:
            result._region = ([ring.copy() for ring in rings],)
        return result

    def __copy__(self) -> ClippedCells:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        shapes = len(self._clipped.vertex_offsets) > 0
        return _clip_again, (self._diagram, self._region, shapes)

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
        rows: npt.NDArray[np.float64] = self._clipped.vertices[begin:end]
        return rows

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
        return Mesh(rows, np.column_stack([number, _following(self._clipped.ring_starts)]))

    def to_pyvista(self) -> Any:
        """The cells as an object of PyVista.

        In 3D a ``pyvista.UnstructuredGrid`` of polyhedra; in 2D a ``pyvista.PolyData`` of polygons
        at z = 0, those with dents or holes in triangles. The cell data ``point`` hold the index of each
        cell's point, ``measure`` its volume or area.

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
        from . import _convert

        if self._diagram.triangulation.dimension != 3:
            return _convert.to_pyvista(self._surface())
        self._require_shapes()
        faces = self._faces()
        starts = self._clipped.face_offsets.tolist()
        shown = [i for i, (a, b) in enumerate(zip(starts, starts[1:])) if b > a]
        polyhedra = [faces[starts[i] : starts[i + 1]] for i in shown]
        data = {"point": np.array(shown), "measure": self.measures[shown]}
        return _convert.polyhedra_to_pyvista(self._clipped.vertices, polyhedra, data)

    # As others have it

    def _require_shapes(self) -> None:
        if len(self._clipped.vertex_offsets) == 0:
            raise InvalidArgument("clip() was called with shapes=False")

    def _owners(self) -> npt.NDArray[np.int64]:
        """Of each corner the point of its cell."""
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
        """Of each polygon of each cell its rings, by rows of all corners."""
        rings, starts = self._clipped.polygon_rings.tolist(), self._clipped.ring_starts.tolist()
        return [
            [np.arange(starts[r], starts[r + 1]) for r in range(begin, end)]
            for begin, end in zip(rings, rings[1:])
        ]

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

    def _write(self, path: str, format: str) -> None:
        _core.save_clipped(path, self._clipped, format)

    def _page(self) -> str:
        from ._pages import page_of_surface

        surface = self._surface()
        return page_of_surface(
            surface, self.mesh().faces if surface.points.shape[1] == 2 else None, self._table()
        )

    def __len__(self) -> int:
        return len(self.measures)

    def __repr__(self) -> str:
        return f"<ClippedCells: {len(self)} cells>"


def _following(starts: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Of each corner of rings the next one."""
    following = np.arange(1, int(starts[-1]) + 1 if len(starts) else 1, dtype=np.int64)
    filled = np.flatnonzero(np.diff(starts))
    following[starts[filled + 1] - 1] = starts[filled]
    return following


def _triangles(
    rows: npt.NDArray[np.float64], rings: list[npt.NDArray[np.int64]]
) -> npt.NDArray[np.int64]:
    """A polygon of the plane with dents or holes in triangles, whose corners are rows."""
    numbers = np.concatenate(rings)
    following = _following(np.cumsum([0, *map(len, rings)]))
    edges = np.column_stack([np.arange(len(numbers)), following])
    found = constrained_delaunay(rows[numbers], edges, inside_only=True)
    return numbers[found.cells]


def _is_convex(ring: npt.NDArray[np.float64]) -> bool:
    edges = np.roll(ring, -1, axis=0) - ring
    after = np.roll(edges, -1, axis=0)
    return bool((edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0] >= 0).all())


def _clip_again(diagram: VoronoiDiagram, region: tuple[Any, ...], shapes: bool) -> ClippedCells:
    return diagram.clip(*region, shapes=shapes)


class Voronoi(Lifted):
    """In place of `scipy.spatial.Voronoi`: the same attributes, exact, and faster.

    Pickles, copies and is sent between processes; also while incremental.

    Parameters
    ----------
    points : as of `Delaunay`
    furthest_site : bool
        The diagram of the furthest point.
    incremental : bool
        Allow `add_points`.
    qhull_options : str, optional
        As in SciPy ``Qbb Qc Qz`` if not given, ``Qc`` if incremental. With ``Qz`` there is an empty
        region, of a point at infinity; without ``Qc`` duplicates have no region. Others are
        accepted or refused as in `ConvexHull`.
    threads, memory_budget, progress : as in `convex_hull`

    Attributes
    ----------
    points : (n, d) float64
    vertices : (v, d) float64, each the nearest doubles; no two stand for one
    ridge_points : (r, 2) int32: pairs of points whose regions share a face
    ridge_vertices : list of lists of int: its vertices, in 2D and 3D in order; -1 is at infinity
    ridge_dict : dict from pairs of points to these lists
    regions : list of lists of int: the vertices of each region; in 2D in order
    point_region : (n,) int64: the region of each point; -1 if it has none
    ndim, npoints : int
    min_bound, max_bound : (d,) float64
    furthest_site : bool
    triangulation, diagram : the native `Triangulation` and `VoronoiDiagram`

    Raises
    ------
    InvalidArgument, NotFinite (ValueErrors), TypeError, OutOfBudget, KeyboardInterrupt
        As `ConvexHull`.
    QhullError (a RuntimeError)
        For points that lie in a plane or a line. `voronoi` accepts these.

    Examples
    --------
    >>> import cullhull
    >>> found = cullhull.Voronoi([[0, 0], [2, 0], [0, 2], [2, 2], [1, 1]])
    >>> found
    <Voronoi of 5 points in 2D: 4 vertices>
    >>> found.regions[found.point_region[4]]
    [0, 2, 3, 1]
    >>> found.ridge_dict[0, 4]
    [1, 0]
    """

    def __repr__(self) -> str:
        kind = type(self).__name__
        return f"<{kind} of {self.npoints} points in {self.ndim}D: {len(self.vertices)} vertices>"

    @Lazy
    def diagram(self) -> VoronoiDiagram:
        """The native diagram."""
        threads, _, progress = self._choices
        return voronoi(self.triangulation, threads=threads, progress=progress)

    @property
    def _shown(self) -> Any:
        """What the attributes are made of: a diagram's vertices, ridges and regions."""
        return self.diagram

    @Lazy
    def vertices(self) -> npt.NDArray[np.float64]:
        """(v, d) float64: coordinates of the vertices."""
        rows: npt.NDArray[np.float64] = self._shown.vertices.copy()
        return rows

    @Lazy
    def ridge_points(self) -> npt.NDArray[np.int32]:
        """(r, 2) int32: pairs of points whose regions share a face."""
        pairs: npt.NDArray[np.int32] = self._shown.ridge_points.copy()
        return pairs

    @Lazy
    def ridge_vertices(self) -> list[list[int]]:
        """For each of `ridge_points` the vertices of the face; -1 is at infinity."""
        lists: list[list[int]] = self._shown.ridges.tolist()
        return lists

    @Lazy
    def ridge_dict(self) -> dict[tuple[int, int], list[int]]:
        """From pairs of points, as in `ridge_points`, to lists of vertices."""
        first, second = self.ridge_points.T.tolist()
        with collector_paused():
            return dict(zip(zip(first, second), self.ridge_vertices))

    @Lazy
    def regions(self) -> list[list[int]]:
        """The vertices of each region; -1 is at infinity."""
        each = self._shown.regions.tolist()
        mine: list[list[int]] = [each[i] for i in self._sites.tolist()]
        return [[], *mine] if self._has_empty else mine

    @Lazy
    def point_region(self) -> npt.NDArray[np.int64]:
        """(n,) int64: the region of each point."""
        number = np.full(self.npoints, -1, dtype=np.int64)
        number[self._sites] = np.arange(len(self._sites)) + self._has_empty
        if self._options.coplanar:
            equal = self.triangulation.duplicates
            number[equal[:, 0]] = number[equal[:, 1]]
        return number

    @property
    def _sites(self) -> npt.NDArray[np.intp]:
        """Points that have a region of their own, be it empty."""
        site = np.ones(self.npoints, dtype=bool)
        site[self.triangulation.duplicates[:, 0]] = False
        return np.flatnonzero(site)

    @property
    def _has_empty(self) -> bool:
        """Whether the first region is that of the point at infinity."""
        return self._options.at_infinity and not self.furthest_site
