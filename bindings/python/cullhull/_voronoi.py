"""Voronoi and power diagrams: the native face, and the class that stands in for SciPy's."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import Progress, as_points, settings
from ._delaunay import Lifted, as_triangulation
from ._errors import InvalidArgument
from ._incremental import Lazy
from ._lists import Lists, collector_paused
from ._native import Native
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
    """The Voronoi diagram of points in any dimension; the power diagram, with weights.

    Which regions meet, and where, is exact: vertices that coincide are one, however many points
    are at the same distance.

    Parameters
    ----------
    points : (n, d) array, or a triangulation: of `delaunay` or a `Delaunay`
        As of `delaunay`.
    weights, furthest_site : as of `delaunay`
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


class VoronoiDiagram(Native):
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

    def __repr__(self) -> str:
        kind = "VoronoiDiagram" if self.triangulation.weights is None else "Power diagram"
        return (
            f"<{kind} of {self.triangulation.point_count} points in "
            f"{self.triangulation.dimension}D: {len(self.vertices)} vertices, "
            f"{len(self.ridge_points)} ridges>"
        )

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

        Exact: cells that meet in a corner have the same bits for it, corners of the diagram are
        those of `vertices`, and no corner is outside a box.

        Parameters
        ----------
        low, high : (d,) arrays
            A box. Or `low` alone is the region: in 2D an (m, 2) array, the corners of a polygon in
            order, which may have dents; a list of such arrays, rings of which an odd number
            surrounds what is inside, so that polygons may have holes and several parts; or anything
            with a ``__geo_interface__``, as shapely's polygons have. In 1D and 3D an (m, d) array,
            of whose points the convex hull is taken.
        shapes : bool
            Whether the cells' corners and faces are wanted, or only their measures.
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


class ClippedCells(Native):
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

    def __len__(self) -> int:
        return len(self.measures)

    def __repr__(self) -> str:
        return f"<ClippedCells: {len(self)} cells>"


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
