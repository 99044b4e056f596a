"""Voronoi and power diagrams: what `voronoi` makes, and its cells within a region."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import as_points
from ._clipped_cells import ClippedCells, rings_of
from ._errors import InvalidArgument
from ._lists import Lists
from ._native import Native
from ._options import Budgeted, Unpack, Watched, require_known, settings, takes
from ._triangulation import Triangulation, as_triangulation, delaunay
from .show._forms import Picture, Rows, Table, require_drawable
from .show._shown import Saved, Shown


@takes(Budgeted)
def voronoi(
    points: Any, weights: Any = None, *, furthest_site: bool = False, **options: Unpack[Budgeted]
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
    require_known(options, Budgeted)
    found = as_triangulation(points)
    if found is not None:
        if weights is not None or furthest_site:
            raise InvalidArgument("the triangulation has its weights and its kind already")
    else:
        found = delaunay(points, weights, furthest_site=furthest_site, **options)
        memory_budget = options.get("memory_budget")
        if memory_budget is not None:  # the triangulation takes a part of it
            held = found.cells.nbytes + found.neighbours.nbytes
            options["memory_budget"] = max(1, memory_budget - held)
    chosen = settings(options, Budgeted)
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
    _made_of = ("triangulation", "_diagram")

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

    @takes(Watched)
    def clip(
        self, low: Any, high: Any = None, *, shapes: bool = True, **options: Unpack[Watched]
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
        clipped = self._clip(region, bool(shapes), settings(options, Watched))
        return ClippedCells._of(self, clipped, region)

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

    def _write(self, path: str, format: str, crs: str = "") -> None:
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
        self, region: tuple[Any, ...], shapes: bool, chosen: _core.Settings | None
    ) -> _core.ClippedCells:
        cells, diagram = self.triangulation._cells, self._diagram
        if len(region) == 2:
            low, high = (
                np.asarray(as_points(c, "corner", axes=1), dtype=np.float64).tolist()
                for c in region
            )
            return _core.clip_to_box(cells, diagram, low, high, shapes, chosen)
        rings = rings_of(region[0])
        if rings is None:
            return _core.clip_to_hull(
                cells, diagram, as_points(region[0], "region"), shapes, chosen
            )
        if not rings:
            raise InvalidArgument("the region has no polygon")
        corners = np.concatenate(rings)
        offsets = np.cumsum([0, *map(len, rings)]).tolist()
        return _core.clip_to_polygons(cells, diagram, corners, offsets, shapes, chosen)
